"""Appendix: data sheets of machines, couplings and gears, as in the model file."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from torsion.analyses.tooth_forces import ToothForces
from torsion.findings import Findings
from torsion.model.lowering import Part
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, exact, given, given_rpm, number, scale
from torsion.output.reported_values import mean_torque_at_rated, rated

MOST_DIGITS = 8  # significant digits of a figure of the file
NO_FORCE = "Tooth forces not computed for {}: the file has no pitch diameter or no rated torque."
OVER_FREQUENCY = "over frequency"  # a limit with a table


def chapter(findings: Findings) -> Iterator[Block]:
    """One table for every kind of component that has a data sheet."""
    sheets = _machines, _couplings, _gears, _tooth_forces, _impellers
    tables = list(filter(None, (sheet(findings) for sheet in sheets)))
    if not tables:
        return
    yield Heading("Appendix: data sheets")
    yield from tables
    train, forces = findings.study.train, findings.get(ToothForces)
    meshes = {force.mesh for force in forces.meshes} if forces is not None else set()
    without = [
        mesh.name
        for mesh in train.constraints
        if train.parts[mesh.part].kind == "gear" and mesh.name not in meshes
    ]
    if without:
        yield Paragraph(NO_FORCE.format(", ".join(without)))


def _figure(value: float | None, factor: float = 1.0) -> str:
    return NONE if value is None else given(value * factor, MOST_DIGITS)


def _parts(findings: Findings, kind: str) -> list[tuple[int, Part]]:
    return list(findings.study.train.of_kind(kind))


def _sheet(titles: str, rows: Iterable[Iterable[Any]], caption: str) -> Table | None:
    """A table, None where it has no row."""
    listed = [tuple(row) for row in rows]
    return table(titles, listed, caption) if listed else None


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
    unit = scale("N m", torques.values())
    lumps = {lump.part: lump for lump in findings.study.train.inertias}
    ripples = [torque.path[:-2] for torque in findings.study.train.torques]
    rows = (
        (
            part.name,
            _figure(lumps[k].given) if k in lumps and np.isfinite(lumps[k].given) else NONE,
            _figure(machine.power, 1e-3),
            NONE if speed is None else given_rpm(speed * float(part.ratio)),
            unit.text(torques.get(k)),
            ripples.count(part.path),
        )
        for k, part, machine in machines
    )
    titles = "< Machine | J [kg m²] | Rated power [kW] | Rated speed [rpm] | "
    return _sheet(titles + f"Mean torque [{unit.unit}] | Ripple components", rows, "Machines")


def _couplings(findings: Findings) -> Table | None:
    """The ratings of their makers, stiffness and losses, of those that have more than a stiffness."""
    train, rows = findings.study.train, []
    springs = {
        spring.part: spring
        for spring in train.springs
        if train.parts[spring.part].kind == "coupling"
    }
    for k, part in _parts(findings, "coupling"):
        limits, spring = part.ratings, springs[k]
        stiffness = (
            "rigid" if spring.flexibility == 0 else given(1.0 / spring.flexibility, MOST_DIGITS)
        )
        if spring.table is not None:
            stiffness = spring.table.follows
        torques: tuple[float | None, ...] = (None,) * 3
        if limits is not None:
            torques = (limits.rated_torque, limits.vibratory_torque, limits.max_torque)
        heat, tolerance = (None, None) if limits is None else (limits.heat_limit, limits.tolerance)
        lost = 2.0 * np.pi * spring.loss_factor
        if not (
            any(torques)
            or (limits and limits.limit_anything)
            or tolerance
            or lost
            or spring.viscous
            or spring.table
        ):
            continue  # a spring, which the mass-elastic system has
        losses = number(lost) if lost else NONE, _figure(spring.viscous or None)
        figures = [*map(_figure, torques), _figure(heat)]
        if limits is not None and limits.vibratory_over_frequency is not None:
            figures[1] = OVER_FREQUENCY
        if limits is not None and limits.heat_over_frequency is not None:
            figures[-1] = OVER_FREQUENCY
        rows.append(
            (
                part.name,
                *figures,
                stiffness,
                _figure(tolerance, 100.0),
                *(losses if spring.table is None else (stiffness, stiffness)),
            )
        )
    return _sheet(
        "< Coupling | T_{KN} [N m] | T_{KW} [N m] | T_{Kmax} [N m] | P_{KW} [W] | k own [N m/rad] | "
        "Tolerance [%] | Relative damping ψ | Viscous c [N m s/rad]",
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
    unit, rows = scale("N m", torques.values()), []
    for mesh in findings.study.train.constraints:
        part = findings.study.train.parts[mesh.part]
        if part.kind == "gear":
            rows.append(
                (
                    mesh.name,
                    *(mesh.teeth or (NONE, NONE)),
                    exact(1 / mesh.ratio),
                    _figure(part.application_factor),
                    unit.text(torques.get(mesh.name)),
                    "rigid"
                    if mesh.flexibility == 0
                    else given(1.0 / mesh.flexibility, MOST_DIGITS),
                )
            )
    return _sheet(
        f"< Mesh | Teeth, driving | Teeth, driven | Ratio | K_{{A}} | Mean torque at rated speed, driving side "
        f"[{unit.unit}] | Mesh stiffness, driving side [N m/rad]",
        rows,
        "Gears",
    )


def _tooth_forces(findings: Findings) -> Table | None:
    """Size and nominal forces of every mesh with a pitch diameter."""
    forces = findings.get(ToothForces)
    meshes = () if forces is None else forces.meshes
    unit = scale("N", [force.tangential for force in meshes])
    rows = (
        (
            force.mesh,
            _figure(force.module, 1e3),
            _figure(np.degrees(force.helix)),
            _figure(np.degrees(force.pressure_angle)),
            number(force.diameter * 1e3),
            number(force.driven_diameter * 1e3),
            *map(unit.text, (force.tangential, force.radial, force.axial)),
        )
        for force in meshes
    )
    return _sheet(
        "< Mesh | m_{n} [mm] | Helix β [deg] | Pressure angle α_{n} [deg] | d driving [mm] | d driven [mm] | "
        f"F_{{t}} [{unit.unit}] | F_{{r}} [{unit.unit}] | F_{{a}} [{unit.unit}]",
        rows,
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
                    _figure(impeller.diameter),
                    *(_figure(value) for value in size),
                    _figure(impeller.inertia),
                    _figure(impeller.water),
                    _figure(wet),
                    machine.damping_model,
                    _figure(machine.damping_factor),
                )
            )
    return _sheet(
        "< Machine | Blades | D [m] | P/D | A_{E}/A_{0} | J dry [kg m²] | Entrained water [kg m²] | J wet [kg m²] | "
        "< Damping model | Damping factor",
        rows,
        "Propellers, pumps and fans",
    )
