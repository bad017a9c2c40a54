"""The data of the system as the calculation has them: inertias, elastic elements, shafts, gears, propellers, damping.

Every other analysis starts from these values; here they stand as people read them, one row an item of the file.
"""

import math
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from torsion.assembly.elements import Element, damps, elements
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.assembly.segments import bar_segments
from torsion.errors import InputError
from torsion.findings import Results, Work
from torsion.model.parts import GearRating, MachineRecord
from torsion.primitives import Inertia, SectionMesh
from torsion.results import reported, result
from torsion.user_files import without_controls

if TYPE_CHECKING:
    from torsion.analyses.steady import Steady


GIVEN_AS = {"psi": "ψ", "magnifier": "M", "loss_factor": "η", "viscous": "c", "damping": "c"}


@reported
class ComponentRow:
    """A component of the train."""

    name: str = result("its name")
    kind: str = result("its kind, as the file names it")
    ratio: Fraction = result("its speed / reference speed; of a gear that of its driving wheel")
    speed: float | None = result("rad/s", "its speed at the rated point; null without one")
    source: str | None = result("where its data come from; null if the file does not say")
    note: str | None = result("note of the file, or null")


@reported
class InertiaRow:
    """An inertia that a component gives a station."""

    station: str = result("name of the station; of the inner segments of a shaft its own")
    component: str = result("component, and which of its inertias")
    given: float | None = result(
        "kg*m**2", "as in the file, where values are referred; null elsewhere", key="given_kg_m2"
    )
    given_ratio: Fraction | None = result("speed / reference speed at which it is given")
    inertia: float = result("kg*m**2", "at its own speed; null where fixed", key="inertia_kg_m2")
    ratio: Fraction = result("speed of the station / reference speed", key="speed_ratio")
    referred: float = result(
        "kg*m**2", "to the reference speed; null where fixed", key="referred_kg_m2"
    )


@reported
class ElasticRow:
    """Stiffness and damping of an elastic element."""

    component: str = result("name of a coupling, shaft, mesh or joint")
    begin: str = result("station at its driving end")
    end: str = result("station at its driven end")
    given: float | None = result(
        "N*m/rad", "stiffness as in the file, where values are referred; null elsewhere"
    )
    given_ratio: Fraction | None = result("speed / reference speed at which it is given")
    stiffness: float | None = result(
        "N*m/rad", "static, at the driving station's speed; null where rigid or of a table"
    )
    ratio: Fraction = result("speed of the driving station / reference speed")
    referred: float | None = result("N*m/rad", "stiffness referred to the reference speed")
    loss_factor: float | None = result("1", "eta of k (1 + i eta); null without")
    viscous: float | None = result("N*m*s/rad", "viscous damping; null without")
    source: str = result("how damping or a table is given; empty for no damping")


@reported
class ShaftRow:
    """Dimensions of a shaft, or of a section of it."""

    shaft: str = result("its name")
    outer: float | None = result("m", "outer diameter at the driving end; null for a mesh")
    outer_driven: float | None = result("m", "the same at the driven end of a cone; else null")
    bore: float | None = result("m", "bore at the driving end; null for a mesh")
    bore_driven: float | None = result("m", "the same at the driven end of a conical bore")
    mesh: str | None = result("file of the mesh of its section, or null")
    length: float = result("m", "length")
    modulus: float = result(
        "m**3", "smallest polar section modulus W_p, for nominal stress", key="section_modulus_m3"
    )
    inertia: float = result("kg*m**2", "of the whole shaft", key="inertia_kg_m2")
    material: str = result("name of its material")
    shear_modulus: float = result("Pa", "G of the material")
    density: float = result("kg/m**3", "density of the material", key="density_kg_per_m3")
    pieces: int = result("segments, elements or pieces that it is divided into")


@reported
class GearRow:
    """Teeth of a gear mesh."""

    mesh: str = result("name of the mesh")
    driving_teeth: int | None = result("teeth of the driving wheel")
    driven_teeth: int | None = result("teeth of the driven wheel")
    ratio: Fraction = result("speed of the driving / speed of the driven wheel")
    application_factor: float | None = result("1", "K_A")


@reported
class ImpellerRow:
    """Size and inertia of a propeller, pump or fan."""

    machine: str = result("its name")
    blades: int | None = result("number of blades")
    diameter: float | None = result("m", "diameter D")
    pitch_ratio: float | None = result("1", "P/D of a propeller")
    area_ratio: float | None = result("1", "A_E/A_0 of a propeller")
    dry: float = result("kg*m**2", "inertia in air", key="dry_kg_m2")
    water: float | None = result("kg*m**2", "entrained water", key="water_kg_m2")
    wet: float | None = result("kg*m**2", "dry + entrained water", key="wet_kg_m2")


@reported
class GroundDamping:
    """A damping to ground."""

    station: str = result("name of the station")
    model: str = result("viscous, or the model of the machine")
    factor: float | None = result("1", "factor of the model")
    value: float | None = result(
        "N*m*s/rad", "at the rated speed; null where it varies and is not known there"
    )
    source: str | None = result("where its value comes from")


@reported
class TorqueRow:
    """A harmonic torque of the file."""

    name: str = result("component that it acts on")
    order: Fraction | None = result("per revolution of its shaft; null at a frequency")
    reference_order: Fraction | None = result("per revolution of the reference")
    frequency: float | None = result("Hz", "fixed frequency; null for an order, or for every one")
    torque: float | None = result("N*m", "constant part of its amplitude")
    of_mean: float | None = result("1", "part of its amplitude / mean torque")
    transmission_error: float | None = result("rad", "of a mesh, at its driving wheel")
    rated: float | None = result("N*m", "amplitude at the rated speed; null if unknown")
    phase: float = result("rad", "its phase")
    source: str | None = result("where its values come from")


@reported
class SystemData:
    """What the system consists of."""

    components: tuple[ComponentRow, ...] = result("components, in the order of the file")
    inertias: tuple[InertiaRow, ...] = result("inertias, those of shafts at their ends")
    total: float = result(
        "kg*m**2", "sum of the referred inertias that are not fixed", key="total_kg_m2"
    )
    elements: tuple[ElasticRow, ...] = result("elastic elements")
    shafts: tuple[ShaftRow, ...] = result("shafts")
    gears: tuple[GearRow, ...] = result("gear meshes")
    impellers: tuple[ImpellerRow, ...] = result("propellers, pumps and fans")
    ground: tuple[GroundDamping, ...] = result("damping to ground")
    torques: tuple[TorqueRow, ...] = result("harmonic torques but for those of cylinders")


def run(work: Work) -> None:
    """Put the data of the system."""
    work.put(system_data=system_data(work))


def system_data(evidence: Results) -> SystemData:
    """Return the data of a system, at the rated speed where they vary and mean torques are known."""
    system = evidence.system
    train = evidence.study.train
    rated = evidence.study.operation.rated
    impellers = []
    for part in train.parts:
        if (impeller := part.impeller) is not None:
            screw = part.propeller
            wet = None if impeller.water is None else impeller.inertia + impeller.water
            size = (None, None) if screw is None else (screw.pitch_ratio, screw.area_ratio)
            row = part.name, impeller.blades, impeller.diameter, *size
            impellers.append(ImpellerRow(*row, impeller.inertia, impeller.water, wet))
    gears = []
    for mesh in train.constraints:
        part = train.parts[mesh.part]
        if part.kind == "gear":
            factor = getattr(part.get(GearRating), "application_factor", None)
            driving, driven = mesh.teeth or (None, None)
            gears.append(GearRow(mesh.name, driving, driven, 1 / mesh.ratio, factor))
    components = []
    for part in train.parts:
        speed = None if rated is None else rated.speed * float(part.ratio)
        origin = speed, part.source, part.note
        components.append(ComponentRow(part.name, part.kind, part.ratio, *origin))
    inertias = tuple(_inertias(evidence))
    return SystemData(
        components=tuple(components),
        inertias=inertias,
        total=sum(row.referred for row in inertias if math.isfinite(row.referred)),
        elements=tuple(_elastic_row(evidence, element) for element in elements(system)),
        shafts=tuple(_shafts(evidence)),
        gears=tuple(gears),
        impellers=tuple(impellers),
        ground=tuple(_ground(evidence)),
        torques=tuple(_torques(evidence)),
    )


def _inertias(evidence: Results) -> Iterator[InertiaRow]:
    """Yield by station what components give it, then what the shafts that end there do; inner segments last."""
    train = evidence.system.train
    lumps = list(train.inertias)
    inner = []
    for bar in train.bars:
        driving, *between, driven = bar_segments(bar, evidence.system.segments[bar.name])[
            1
        ].tolist()
        lumps.append(Inertia(bar.driving, driving, bar.part, "driving end"))
        lumps.append(Inertia(bar.driven, driven, bar.part, "driven end"))
        inner.append((bar.name, Inertia(bar.driving, sum(between), bar.part, "between ends")))

    named = [(train.stations[lump.station].name, lump) for lump in lumps]
    named.sort(key=lambda pair: pair[1].station)
    for name, lump in [*named, *inner]:
        station = train.stations[lump.station]
        if station.is_ground or not lump.inertia:
            continue
        part = evidence.study.train.parts[lump.part]
        given: tuple[float | None, Fraction | None] = None, None
        if evidence.study.train.has_referred_figures and math.isfinite(lump.given):
            # Of the driven wheel of a gear the value is given at the driving side.
            ratio = part.ratio if part.referred_to is None else part.referred_to
            given = lump.given, station.ratio if lump.given == lump.inertia else ratio
        words = f"{part.name}, {lump.what}" if lump.what else part.name
        referred = lump.inertia * float(station.ratio) ** 2
        yield InertiaRow(name, words, *given, lump.inertia, station.ratio, referred)


def _elastic_row(evidence: Results, element: Element) -> ElasticRow:
    system = evidence.system
    span = element.spans[0]
    train = evidence.study.train
    part = train.parts[element.part]
    table = system.tables.get(span)
    flexibility = float(system.flexibility[list(element.spans)].sum())
    driving = system.spans[span].driving
    driven = system.spans[element.spans[-1]].driven
    ratio = system.stations[driving].ratio
    given: tuple[float | None, Fraction | None] = None, None
    stiffness = None
    if flexibility < math.inf and table is None:
        stiffness = 1 / flexibility if flexibility else math.inf
        if flexibility and train.has_referred_figures and not part.is_bar:
            given_ratio = ratio if part.referred_to is None else part.referred_to
            given = float(ratio / given_ratio) ** 2 * stiffness, given_ratio
    source = ""
    is_linear = table is None and damps(system, element)
    if table is not None:
        source = "by table" if table.key == "table" else f"by {table.over}"
    elif part.damping is not None:
        key, value = part.damping
        source = f"{GIVEN_AS[key]} = {value:.6g}"
    elif is_linear:
        source = f"material {part.shaft.material}" if part.is_bar and part.shaft else "input"
    return ElasticRow(
        element.name,
        system.stations[driving].name,
        system.stations[driven].name,
        *given,
        stiffness,
        ratio,
        None if stiffness is None else stiffness * element.ratio**2,
        loss_factor=(float(system.loss_factor[span]) or None) if is_linear else None,
        viscous=(float(system.viscous[span]) or None) if is_linear else None,
        source=source,
    )


def _shafts(evidence: Results) -> Iterator[ShaftRow]:
    train = evidence.study.train
    for requested, bar in zip(train.bars, evidence.system.train.bars, strict=True):
        section = requested.section
        is_round = section is None
        material = train.shaft(requested).material
        is_mesh = isinstance(section, SectionMesh)
        yield ShaftRow(
            shaft=bar.name,
            outer=None if is_mesh else bar.outer[0],
            outer_driven=None if is_mesh or bar.outer[0] == bar.outer[1] else bar.outer[1],
            bore=bar.bore[0] if is_round else None,
            bore_driven=None if not is_round or bar.bore[0] == bar.bore[1] else bar.bore[1],
            mesh=without_controls(section.file) if isinstance(section, SectionMesh) else None,
            length=bar.length,
            modulus=stress_modulus(bar),
            inertia=float(bar_segments(bar, evidence.system.segments[bar.name])[1].sum()),
            material=material,
            # A hub or a step raises the G of the calculation.
            shear_modulus=train.materials[material].shear_modulus,
            density=bar.density,
            pieces=evidence.system.segments[bar.name],
        )


def _ground(evidence: Results) -> Iterator[GroundDamping]:
    """Yield the damping to ground of every damper, at the rated speed where it varies."""
    system = evidence.system
    rated = evidence.study.operation.rated
    steady: Steady | None = evidence.results.get("mean")
    for station in dict.fromkeys(damper.station for damper in system.dampers):
        part = evidence.study.train.parts[system.stations[station].part]
        dampers = [damper for damper in system.dampers if damper.station == station]
        needs_torque = any(damper.needs_torque for damper in dampers)
        value = None
        if not needs_torque and not any(damper.speed_factor for damper in dampers):
            value = sum(damper.constant for damper in dampers)
        elif rated is not None and steady is not None:
            nearest = [int(np.argmin(np.abs(steady.speed - rated.speed)))]
            mean = steady.speed[nearest], steady.applied[:, nearest], steady.load_slope[:, nearest]
            value = float(system.ground_damping(*mean)[station, 0])
        elif rated is not None and not needs_torque:
            value = float(system.ground_damping(np.array([rated.speed]), np.array([]))[station, 0])
        machine = part.machine or MachineRecord(is_driver=False)
        model = machine.damping_model, machine.damping_factor
        yield GroundDamping(system.stations[station].name, *model, value, part.source)


def _torques(evidence: Results) -> Iterator[TorqueRow]:
    """Yield the harmonic torques; the amplitude at the rated speed is None where it is not known there."""
    study = evidence.study
    rated = study.operation.rated
    for torque in study.train.torques:
        if torque.cylinder is not None:
            continue
        ratio = evidence.system.stations[torque.station].ratio
        at_rated = None
        ends = [row[0] for row in torque.table or ((0.0,), (math.inf,))]
        if (
            torque.mesh is None
            and rated is not None
            and ends[0] <= rated.speed * float(ratio) <= ends[-1]
        ):
            speed = np.array([rated.speed])
            steady = None
            from torsion.analyses.response.harmonic_components import amplitude
            from torsion.analyses.steady import steady_if_known

            with suppress(InputError):  # the table of the load may not reach to it
                steady = steady_if_known(study, evidence.system, speed) if torque.of_mean else None
            if steady is not None or not torque.of_mean:
                at_rated = float(np.abs(amplitude(evidence.system, torque, speed, steady))[0])
        is_constant = torque.mesh is None and not (torque.of_mean or torque.table)
        yield TorqueRow(
            name=torque.name,
            order=torque.order,
            reference_order=None if torque.order is None else torque.order * ratio,
            frequency=torque.frequency,
            torque=torque.torque if is_constant else torque.torque or None,
            of_mean=torque.of_mean or None,
            transmission_error=None if torque.mesh is None else torque.mesh[1],
            rated=at_rated,
            phase=torque.phase,
            source=torque.source,
        )
