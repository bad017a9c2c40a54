"""Chapter: the damping used, model and value of each; and what was taken as undamped."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse, Response
from torsion.analyses.steady import Steady
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, given, given_rpm, number
from torsion.output.reported_values import NOT_STATED, rated
from torsion.output.selection import damps, elements
from torsion.results import listed

MODEL = (
    "Internal damping of a loss factor η enters as k (1 + i η), with η = ψ/(2π) = 1/M, independent of frequency; "
    "viscous damping c as i ω c. Damping to ground acts on the deviation from the mean motion, at the speed of "
    "the component."
)
BARELY = 1e-4  # damping ratio: below what any real train has
GIVEN = {"psi": "ψ", "magnifier": "M", "loss_factor": "η", "viscous": "c", "damping": "c"}


def chapter(findings: Findings) -> Iterator[Block]:
    """Left out for an undamped train without a response; an undamped response says so."""
    system, response = findings.system, findings.get(Response)
    if not system.damps:
        if response is not None or findings.get(FrequencyResponse) is not None:
            yield Heading("Appendix: damping")
            yield Paragraph(
                "The train has no damping. At a resonance the response has no finite value.", "note"
            )
        return
    yield Heading("Appendix: damping")
    if by_mode := findings.study.train.modal_damping:
        ratios = listed([f"{number(100.0 * one)} %" for one in by_mode])
        of = (
            "every elastic mode"
            if len(by_mode) == 1
            else "the elastic modes in turn, the last of all above"
        )
        yield Paragraph(
            f"Damping ratio of {of}: {ratios}, in place of the damping of the components. The response is the sum "
            "over all "
            "modes with the exact static remainder."
        )
        return
    yield Paragraph(MODEL)
    yield from (one for one in (_elements(findings), _grounds(findings)) if one.rows)
    bare = [
        e.name
        for e in elements(system)
        if system.flexibility[e.spans[0]] > 0 and not damps(system, e)
    ]
    if bare:
        yield Paragraph(f"Undamped: {listed(bare)}.")
    damped = findings.get(DampedModes)
    if damped is not None and response is not None and (damped.damping_ratio < BARELY).any():
        weak = listed([str(k + 1) for k in np.flatnonzero(damped.damping_ratio < BARELY).tolist()])
        ratio = f"The damping ratio of mode {weak} is below {100 * BARELY:g} %"
        text = f"{ratio}: the amplitudes at its resonances are not reliable."
        yield Paragraph(text, "note")


def _elements(findings: Findings) -> Table:
    system = findings.system
    rows: list[tuple[float | str, ...]] = []
    for element in elements(system):
        if (table_of := system.tables.get(element.spans[0])) is not None:
            rows.append((element.name, *[table_of.follows] * 5))
        elif damps(system, element):
            eta, viscous = (
                float(law[element.spans[0]]) for law in (system.loss_factor, system.viscous)
            )
            losses = (eta, 2 * math.pi * eta, 1 / eta) if eta else [NONE] * 3
            rows.append((element.name, _as_given(findings, element.part), *losses, viscous or NONE))
    columns = "< Component | < Input | Loss factor η | Relative damping ψ | Magnifier M | Viscous c [N m s/rad]"
    return table(columns, rows, "Internal damping")


def _as_given(findings: Findings, part: int) -> str:
    own = findings.study.train.parts[part]
    if own.damping is not None:
        key, value = own.damping
        return f"{GIVEN[key]} = {given(value, 6)}"
    return f"material {own.shaft.material}" if own.is_bar and own.shaft else "input"


def _grounds(findings: Findings) -> Table:
    system, speed = findings.system, rated(findings)
    rows = []
    for damper in system.dampers:
        station = system.stations[damper.station]
        part = findings.study.train.parts[station.part]
        machine = part.machine
        model, factor = (
            ("viscous", None)
            if machine is None
            else (machine.damping_model, machine.damping_factor)
        )
        value = _value(findings, damper.station, speed)
        rows.append((station.name, model, given(factor), value, part.source or NOT_STATED))
    at = f" at {given_rpm(speed)} rpm" if speed is not None else ""
    return table(
        f"< Component | < Model | < Factor | Value{at} [N m s/rad] | < Source",
        rows,
        "Damping to ground",
    )


def _value(findings: Findings, station: int, speed: float | None) -> str:
    """At the rated speed; a constant needs none."""
    mine = [d for d in findings.system.dampers if d.station == station]
    if not any(d.needs_torque or d.speed_factor for d in mine):
        return number(sum(d.constant for d in mine))
    steady = findings.get(Steady)
    if speed is None:
        return "varies with speed"
    if steady is None and any(d.needs_torque for d in mine):
        return "varies with mean torque"
    if steady is None:
        at, mean, slope = np.array([speed]), np.array([]), None  # which no damper reads
    else:
        near = [int(np.argmin(np.abs(steady.speed - speed)))]
        at, mean = steady.speed[near], steady.applied[:, near]
        slope = None if steady.load_slope is None else steady.load_slope[:, near]
    return number(float(findings.system.ground_damping(at, mean, slope)[station, 0]))
