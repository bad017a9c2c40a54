"""Appendix: the data that the calculation used: mass-elastic system, data sheets, damping and excitations."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse, Response
from torsion.analyses.system_data import SystemData, system_data
from torsion.analyses.tooth_forces import ToothForces
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, table
from torsion.output.numbers import given_rpm, number, symbols
from torsion.output.reported_values import rated
from torsion.output.stored.scene import damps, elements
from torsion.results import listed

MASS_ELASTIC = (
    "Own: at the speed of the component; of an elastic element at its driving end. Referred: to the reference speed, "
    "J i² and k i² with the speed ratio i. An infinite inertia is fixed, an infinite stiffness rigid. "
)
LUMPED = "The inertia of a shaft is lumped at the ends of its segments."
DISTRIBUTED = (
    "The inertia of a shaft is distributed. The tables give half of each segment to each end."
)
DAMPING = (
    "Internal damping of a loss factor η enters as k (1 + i η), with η = ψ/(2π) = 1/M, independent of frequency; "
    "viscous damping c as i ω c. Damping to ground acts on the deviation from the mean motion, at the speed of "
    "the component."
)
BY_MODE = "in place of the damping of the components. The response is the sum over all modes with the exact static remainder."
NO_DAMPING = "The train has no damping. At a resonance the response has no finite value."
BARELY = 1e-4  # damping ratio: below what any real train has
MOST_NAMED = 60  # harmonic components


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield one appendix with a table for every kind of data that the train has."""
    data, forces = findings.get(SystemData) or system_data(findings), findings.get(ToothForces)
    yield Heading("Appendix: mass-elastic system")
    where = LUMPED if findings.system.bars is None else DISTRIBUTED
    yield Paragraph(MASS_ELASTIC + where)
    remarks: dict[str, list[str]] = {}
    for part in findings.study.train.parts:
        if part.remark:
            remarks.setdefault(part.remark, []).append(part.name)
    for remark, names in remarks.items():
        yield Paragraph(f"{listed(names)}: {symbols(remark)}.", "note")

    tables = (
        (
            (
                "station: < Station | component: < Inertia of | given: J given [kg m²]:8g? | given_ratio: Given at i:? | "
                "inertia: J own [kg m²]:8g | ratio: Speed ratio i | referred: J referred [kg m²]:7"
            ),
            data.inertias,
            f"Inertias as given; whole train {number(data.total, 7)} kg m² referred",
        ),
        (
            (
                "component: < Component | begin: < From | end: < To | given: k given [~N m/rad]:8g? | "
                "given_ratio: Given at i:? | stiffness: k own [~N m/rad]:8g | ratio: i | "
                "referred: k referred [~N m/rad]:7g | loss_factor: Loss factor η:? | "
                "viscous: Viscous c [N m s/rad]:? | source: < Damping as given:?"
            ),
            data.elements,
            "Elastic elements",
        ),
        (
            (
                "shaft: < Shaft | outer: d [mm]:8g? | outer_driven: d driven end [mm]:8g? | bore: d_{i} [mm]:8g? | "
                "bore_driven: d_{i} driven end [mm]:8g? | mesh: < Mesh:? | length: Length [mm]:8g | "
                "modulus: W_{p} [mm³]:7 | inertia: J of the shaft [kg m²]:8g | material: < Material | "
                "shear_modulus: G [GPa]:8g | density: ρ [kg/m³]:8g | pieces: Pieces"
            ),
            data.shafts,
            "Dimensions of the shafts (for a cone, the smallest W_{p})",
        ),
        (
            (
                "mesh: < Mesh | driving_teeth: Teeth, driving:? | driven_teeth: Teeth, driven:? | ratio: Ratio | "
                "application_factor: K_{A}:8g?"
            ),
            data.gears,
            "Gears",
        ),
        (
            (
                "mesh: < Mesh | module: m_{n} [mm]:8g | helix: Helix β [deg]:8g | "
                "pressure_angle: Pressure angle α_{n} [deg]:8g | diameter: d driving [mm] | "
                "driven_diameter: d driven [mm] | tangential: F_{t} [~N] | radial: F_{r} [~N] | axial: F_{a} [~N]"
            ),
            () if forces is None else forces.meshes,
            (
                "Tooth forces at the rated torque, without K_{A}: F_{t} = 2 T/d, F_{r} = F_{t} tan α_{n}/cos β, "
                "F_{a} = F_{t} tan β (ISO 6336-1, reference cylinder)"
            ),
        ),
        (
            (
                "machine: < Machine | blades: Blades:? | diameter: D [m]:8g? | pitch_ratio: P/D:8g? | "
                "area_ratio: A_{E}/A_{0}:8g? | dry: J dry [kg m²]:8g | water: Entrained water [kg m²]:8g? | "
                "wet: J wet [kg m²]:8g?"
            ),
            data.impellers,
            "Propellers, pumps and fans",
        ),
    )
    yield from (table(*sheet) for sheet in tables if sheet[1])
    for part in findings.study.train.parts:
        if part.data_sheet and part.engine is None and part.compressor is None:
            yield KeyValues((("Component", part.name), *part.data_sheet))
    yield from _damping(findings, data)
    yield from _excitations(findings, data)


def _damping(findings: Findings, data: SystemData) -> Iterator[Block]:
    """Yield models and values; nothing for an undamped train without a response."""
    system, response = findings.system, findings.get(Response)
    if not system.damps and response is None and findings.get(FrequencyResponse) is None:
        return
    yield Heading("Damping", 2)
    if not system.damps:
        yield Paragraph(NO_DAMPING, "note")
        return
    if by_mode := findings.study.train.modal_damping:
        ratios = listed([f"{number(100.0 * ratio)} %" for ratio in by_mode])
        modes = "the elastic modes in turn, the last of all above"
        if len(by_mode) == 1:
            modes = "every elastic mode"
        yield Paragraph(f"Damping ratio of {modes}: {ratios}, {BY_MODE}")
        return
    undamped = [
        element.name
        for element in elements(system)
        if system.flexibility[element.spans[0]] > 0 and not damps(system, element)
    ]
    yield Paragraph(DAMPING + (f" Undamped: {listed(undamped)}." if undamped else ""))
    if data.ground:
        speed = rated(findings)
        point = "" if speed is None else f" at {given_rpm(speed)} rpm"
        yield table(
            "station: < Component | model: < Model | factor: Factor:g? | value: Value [N m s/rad] | source: < Source",
            data.ground,
            f"Damping to ground{point}",
        )
    damped = findings.get(DampedModes)
    if damped is not None and response is not None:
        weak = np.flatnonzero(damped.damping_ratio < BARELY) + 1
        if weak.size:
            yield Paragraph(
                f"The damping ratio of mode {listed(map(str, weak))} is below {100 * BARELY:g} %: the amplitudes at "
                "its resonances are not reliable.",
                "note",
            )


def _excitations(findings: Findings, data: SystemData) -> Iterator[Block]:
    """Yield the torques and the harmonic components of the response; joints have their own chapter."""
    train, response = findings.study.train, findings.get(Response)
    angled = [f"{mesh.name} (order {mesh.error[0][0]})" for mesh in train.constraints if mesh.error]
    if not train.torques and not angled:
        return
    yield Heading("Excitations", 2)
    if data.torques:
        yield table(
            "name: < Component | order: Order, own shaft:o? | reference_order: Order, reference:o? | "
            "frequency: Frequency [Hz]:g? | torque: Amplitude [~N m]:g? | of_mean: Share of mean torque [%]:6g? | "
            "transmission_error: Transmission error [µrad]:? | rated: Amplitude at rated speed [~N m]:? | "
            "phase: Phase [deg]:g | source: < Source",
            data.torques,
            "Harmonic torques; a torque by table, and its points, are in the input",
        )
    sentences = [
        f"{kind} of {listed(names)}: see their chapter."
        for kind, names in (
            ("Cylinders", [part.name for part in train.parts if part.engine is not None]),
            ("Throws", [part.name for part in train.parts if part.compressor is not None]),
        )
        if names
    ]
    if angled:
        sentences.append(
            f"Joints that excite the train, with the order of their driving shaft: {listed(angled)}."
        )
    if response is not None and response.lines:
        axis = findings.study.reference
        names = listed([line.named(axis) for line in response.lines], ", ", MOST_NAMED)
        sentences.append(
            f"Harmonic components of the response, per revolution of {axis}: {names}. Contributions of one order are "
            "added as phasors."
        )
    if sentences:
        yield Paragraph(" ".join(sentences))
