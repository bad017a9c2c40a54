"""Appendix: data sheets of machines, couplings and gears, as in the model file."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from torsion.analyses.tooth_forces import ToothForces
from torsion.findings import Findings
from torsion.model.parts import GearRating
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Table, table
from torsion.output.reported_values import mean_torque_at_rated, rated

NO_FORCE = "Tooth forces not computed for {}: the file has no pitch diameter or no rated torque."
OVER_FREQUENCY = "over frequency"  # a limit with a table


def chapter(findings: Findings) -> Iterator[Block]:
    """One table for every kind of component that has a data sheet."""
    sheets = _machines, _couplings, _gears, _tooth_forces, _impellers
    tables = list(filter(None, (sheet(findings) for sheet in sheets)))
    stated = [
        KeyValues((("Component", part.name), *part.data_sheet))
        for part in findings.study.train.parts
        if part.data_sheet and part.engine is None and part.compressor is None
    ]
    if not tables and not stated:
        return
    yield Heading("Appendix: data sheets")
    yield from tables
    yield from stated
    train, forces = findings.study.train, findings.get(ToothForces)
    meshes = {force.mesh for force in forces.meshes} if forces is not None else set()
    without = [
        mesh.name
        for mesh in train.constraints
        if train.parts[mesh.part].kind == "gear" and mesh.name not in meshes
    ]
    if without:
        yield Paragraph(NO_FORCE.format(", ".join(without)))


def stiffness_or_rigid(flexibility: float) -> float | str:
    """Return a stiffness (N m/rad), or the word for a flexibility of 0."""
    return 1.0 / flexibility if flexibility else "rigid"


def _sheet(titles: str, rows: Iterable[Any], caption: str) -> Table | None:
    """Return a table of values, None where it has no row."""
    values = list(rows)
    return table(titles, values, caption) if values else None


def _machines(findings: Findings) -> Table | None:
    """Power and speed at the rated point, with the mean torque of each there; bladed machines have their own table."""
    speed, applied = rated(findings), mean_torque_at_rated(findings)
    machines = [
        (k, part, part.machine)
        for k, part in enumerate(findings.study.train.parts)
        if part.machine is not None
        and part.is_point
        and part.impeller is None
        and part.propeller is None
    ]
    torques = dict[int, float]()
    if applied is not None:
        torques = {k: float(applied[0][part.stations[0]]) for k, part, _ in machines}
    inertias = {lump.part: lump.given for lump in findings.study.train.inertias}
    ripples = [torque.path[:-2] for torque in findings.study.train.torques]
    rows = (
        (
            part.name,
            inertias[k] if np.isfinite(inertias.get(k, np.inf)) else None,
            machine.power,
            None if speed is None else speed * float(part.ratio),
            torques.get(k),
            ripples.count(part.path),
        )
        for k, part, machine in machines
    )
    return _sheet(
        "< Machine | J [kg m²]:8g | Rated power [kW]:8g | Rated speed [rpm]:6g | Mean torque [~N m] | "
        "Ripple components",
        rows,
        "Machines",
    )


def _couplings(findings: Findings) -> Table | None:
    """The ratings of their makers, stiffness and losses, of those that have more than a stiffness."""
    train, rows = findings.study.train, []
    springs = {
        spring.part: spring
        for spring in train.springs
        if train.parts[spring.part].kind == "coupling"
    }
    for k, part in train.of_kind("coupling"):
        limits, spring = part.ratings, springs[k]
        if not (
            (limits and (limits.limit_anything or limits.tolerance))
            or spring.loss_factor
            or spring.viscous
            or spring.table
        ):
            continue  # a spring, which the mass-elastic system has
        names = ("rated_torque", "vibratory_torque", "max_torque", "heat_limit", "tolerance")
        *figures, tolerance = (getattr(limits, name, None) for name in names)
        cells: list[Any] = figures
        if limits is not None and limits.vibratory_over_frequency is not None:
            cells[1] = OVER_FREQUENCY
        if limits is not None and limits.heat_over_frequency is not None:
            cells[-1] = OVER_FREQUENCY
        stiffness, psi = stiffness_or_rigid(spring.flexibility), 2.0 * np.pi * spring.loss_factor
        values: tuple[Any, ...] = (stiffness, tolerance, psi or None, spring.viscous or None)
        if spring.table is not None:
            values = (spring.table.follows, tolerance, spring.table.follows, spring.table.follows)
        rows.append((part.name, *cells, *values))
    return _sheet(
        "< Coupling | T_{KN} [N m]:8g | T_{KW} [N m]:8g | T_{Kmax} [N m]:8g | P_{KW} [W]:8g | "
        "k own [N m/rad]:8g | Tolerance [%]:8g | Relative damping ψ | Viscous c [N m s/rad]:8g",
        rows,
        "Couplings: manufacturer's ratings, stiffness and damping",
    )


def _gears(findings: Findings) -> Table | None:
    """Teeth, ratio, application factor and the mean torque at the rated point, of every mesh."""
    system, means = findings.system, mean_torque_at_rated(findings)
    torques = {
        span.name: float(means[1][k])
        for k, span in enumerate(system.own_spans if means is not None else ())
        if means is not None and system.train.parts[span.part].kind == "gear"
    }
    parts = findings.study.train.parts
    rows = (
        (
            mesh.name,
            *(mesh.teeth or (None, None)),
            1 / mesh.ratio,
            getattr(parts[mesh.part].get(GearRating), "application_factor", None),
            torques.get(mesh.name),
            stiffness_or_rigid(mesh.flexibility),
        )
        for mesh in findings.study.train.constraints
        if parts[mesh.part].kind == "gear"
    )
    return _sheet(
        "< Mesh | Teeth, driving | Teeth, driven | Ratio | K_{A}:8g | Mean torque at rated speed, driving side [~N m] | "
        "Mesh stiffness, driving side [N m/rad]:8g",
        rows,
        "Gears",
    )


def _tooth_forces(findings: Findings) -> Table | None:
    """Size and nominal forces of every mesh with a pitch diameter."""
    forces = findings.get(ToothForces)
    return _sheet(
        "mesh: < Mesh | module: m_{n} [mm]:8g | helix: Helix β [deg]:8g | pressure_angle: Pressure angle α_{n} [deg]:8g | "
        "diameter: d driving [mm] | driven_diameter: d driven [mm] | tangential: F_{t} [~N] | radial: F_{r} [~N] | "
        "axial: F_{a} [~N]",
        () if forces is None else forces.meshes,
        "Tooth forces at the rated torque, without K_{A}: F_{t} = 2 T/d, F_{r} = F_{t} tan α_{n}/cos β, "
        "F_{a} = F_{t} tan β (ISO 6336-1, reference cylinder)",
    )


def _impellers(findings: Findings) -> Table | None:
    """Blades, size, dry and wet inertia and the model of the damping."""
    rows = []
    for part in findings.study.train.parts:
        impeller, screw, machine = part.impeller, part.propeller, part.machine
        if impeller is not None and machine is not None:
            wet = None if impeller.water is None else impeller.inertia + impeller.water
            size = (None, None) if screw is None else (screw.pitch_ratio, screw.area_ratio)
            rows.append(
                (
                    part.name,
                    impeller.blades,
                    impeller.diameter,
                    *size,
                    impeller.inertia,
                    impeller.water,
                    wet,
                    machine.damping_model,
                    machine.damping_factor,
                )
            )
    return _sheet(
        "< Machine | Blades | D [m]:8g | P/D:8g | A_{E}/A_{0}:8g | J dry [kg m²]:8g | Entrained water [kg m²]:8g | "
        "J wet [kg m²]:8g | < Damping model | Damping factor:8g",
        rows,
        "Propellers, pumps and fans",
    )
