"""Chapter: the damping used, model and value of each; and what was taken as undamped."""

import math

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse, Response
from torsion.analyses.steady import Steady
from torsion.assembly.system import System
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import elements
from torsion.output.numbers import NONE, given, given_rpm, number
from torsion.output.reported_values import rated

MODEL = (
    "Internal damping of a loss factor η enters as k (1 + i η), with η = ψ/(2π) = 1/M, independent of frequency; "
    "viscous damping c as i ω c. Damping to ground acts on the deviation from the mean motion, at the component's own "
    "speed."
)
BARELY = 1e-4  # damping ratio: below what any real train has
GIVEN = {"psi": "ψ", "magnifier": "M", "loss_factor": "η", "viscous": "c", "damping": "c"}


def chapter(findings: Findings) -> list[Block]:
    """Left out for an undamped train without a response; an undamped response says so."""
    system = findings.system
    if not system.damps:
        if findings.get(Response) is None and findings.get(FrequencyResponse) is None:
            return []
        text = (
            "Nothing in the train takes energy out: at a resonance the response has no finite value and is not printed."
        )
        return [Heading("Damping"), Paragraph(text, "note")]
    blocks: list[Block] = [Heading("Damping"), Paragraph(MODEL)]
    blocks += [table for table in (_elements(findings), _grounds(findings)) if table.rows]
    bare = [e.name for e in elements(system) if system.flexibility[e.spans[0]] > 0 and not _damps(system, e.spans[0])]
    if bare:
        blocks.append(Paragraph(f"Taken as undamped: {', '.join(bare)}."))
    weak = _barely_damped(findings)
    if weak:
        ratio = f"The damping ratio of mode {weak} is below {100 * BARELY:g} %"
        text = f"{ratio}: amplitudes at its resonances rest on next to no damping and are no prediction."
        blocks.append(Paragraph(text, "note"))
    return blocks


def _barely_damped(findings: Findings) -> str:
    """Modes that the damping given hardly damps."""
    if findings.get(DampedModes) is None or findings.get(Response) is None:
        return ""
    return ", ".join(str(k + 1) for k in np.flatnonzero(findings.need(DampedModes).damping_ratio < BARELY).tolist())


def _damps(system: System, span: int) -> bool:
    return bool(system.loss_factor[span] > 0 or system.viscous[span] > 0)


def _elements(findings: Findings) -> Table:
    system = findings.system
    rows = []
    for element in elements(system):
        first = element.spans[0]
        if not _damps(system, first):
            continue
        eta, viscous = float(system.loss_factor[first]), float(system.viscous[first])
        rows.append((
            element.name, _as_given(findings, element.part), number(eta) if eta else NONE,
            number(2 * math.pi * eta) if eta else NONE, number(1 / eta) if eta else NONE,
            number(viscous) if viscous else NONE,
        ))  # fmt: skip
    columns = head("< Element | < As given | Loss factor η | Relative damping ψ | Magnifier M | Viscous c [N m s/rad]")
    return Table(columns, tuple(rows), "Internal damping")


def _as_given(findings: Findings, part: int) -> str:
    own = findings.study.train.parts[part]
    if own.damping is not None:
        key, value = own.damping
        return f"{GIVEN[key]} = {given(value, 6)}"
    return "input" if own.shaft is None else f"material {own.shaft.material}"


def _grounds(findings: Findings) -> Table:
    system, speed = findings.system, rated(findings)
    at = f" at {given_rpm(speed)} rpm" if speed is not None else ""
    columns = head(f"< At | < Model | < Factor | Value{at} [N m s/rad] | < Source")
    rows = []
    for damper in system.dampers:
        station = system.stations[damper.station]
        part = findings.study.train.parts[station.part]
        screw = part.propeller
        model, factor = ("viscous", None) if screw is None else (screw.damping_model, screw.damping_factor)
        rows.append((
            station.name, model, NONE if factor is None else given(factor), _value(findings, damper.station, speed),
            part.source or "input",
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Damping to ground")


def _value(findings: Findings, station: int, speed: float | None) -> str:
    """At the rated speed; a constant needs none."""
    mine = [d for d in findings.system.dampers if d.station == station]
    if all(d.torque_factor == 0 and d.speed_factor == 0 for d in mine):
        return number(sum(d.constant for d in mine))
    steady = findings.get(Steady)
    if speed is None:
        return "varies with speed"
    near = 0 if steady is None else int(np.argmin(np.abs(steady.speed - speed)))
    if steady is None and any(d.torque_factor for d in mine):
        return "varies with mean torque"
    mean = np.zeros((len(findings.system.stations), 1)) if steady is None else steady.applied[:, near : near + 1]
    at = np.array([speed if steady is None else steady.speed[near]])
    return number(float(findings.system.ground_damping(at, mean)[station, 0]))
