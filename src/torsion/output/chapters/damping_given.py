"""Chapter: the damping used, model and value of each; and what was taken as undamped."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse, Response
from torsion.analyses.steady import Steady
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import given, given_rpm, number
from torsion.output.reported_values import NOT_STATED, rated
from torsion.output.selection import damps, elements
from torsion.results import listed

MODEL = (
    "Internal damping of a loss factor η enters as k (1 + i η), with η = ψ/(2π) = 1/M, independent of frequency; "
    "viscous damping c as i ω c. Damping to ground acts on the deviation from the mean motion, at the speed of "
    "the component."
)
BY_MODE = "in place of the damping of the components. The response is the sum over all modes with the exact static remainder."
BARELY = 1e-4  # damping ratio: below what any real train has
GIVEN = {"psi": "ψ", "magnifier": "M", "loss_factor": "η", "viscous": "c", "damping": "c"}


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield nothing for an undamped train without a response; an undamped response is noted."""
    system, response = findings.system, findings.get(Response)
    has_response = response is not None or findings.get(FrequencyResponse) is not None
    if not (system.damps or has_response):
        return
    yield Heading("Appendix: damping")
    if not system.damps:
        text = "The train has no damping. At a resonance the response has no finite value."
        yield Paragraph(text, "note")
        return
    if by_mode := findings.study.train.modal_damping:
        ratios = listed([f"{number(100.0 * ratio)} %" for ratio in by_mode])
        modes = "the elastic modes in turn, the last of all above"
        if len(by_mode) == 1:
            modes = "every elastic mode"
        yield Paragraph(f"Damping ratio of {modes}: {ratios}, {BY_MODE}")
        return

    yield Paragraph(MODEL)
    for made in (_internal_damping(findings), _ground_damping(findings)):
        if made.values:
            yield made
    undamped = [
        element.name
        for element in elements(system)
        if system.flexibility[element.spans[0]] > 0 and not damps(system, element)
    ]
    if undamped:
        yield Paragraph(f"Undamped: {listed(undamped)}.")
    damped = findings.get(DampedModes)
    if damped is not None and response is not None:
        weak = np.flatnonzero(damped.damping_ratio < BARELY) + 1
        if weak.size:
            yield Paragraph(
                f"The damping ratio of mode {listed(map(str, weak))} is below {100 * BARELY:g} %: the amplitudes at "
                "its resonances are not reliable.",
                "note",
            )


def _internal_damping(findings: Findings) -> Table:
    system, rows = findings.system, list[tuple[object, ...]]()
    for element in elements(system):
        span, part = element.spans[0], findings.study.train.parts[element.part]
        if span in system.tables:
            rows.append((element.name, *[system.tables[span].follows] * 5))
        elif damps(system, element):
            source = f"material {part.shaft.material}" if part.is_bar and part.shaft else "input"
            if part.damping is not None:
                key, value = part.damping
                source = f"{GIVEN[key]} = {given(value, 6)}"
            eta = float(system.loss_factor[span])
            losses = (eta, 2 * math.pi * eta, 1 / eta) if eta else (None,) * 3
            rows.append((element.name, source, *losses, system.viscous[span] or None))
    columns = "< Component | < Input | Loss factor η | Relative damping ψ | Magnifier M | Viscous c [N m s/rad]"
    return table(columns, rows, "Internal damping")


def _ground_damping(findings: Findings) -> Table:
    system, speed, rows = findings.system, rated(findings), []
    for station in (damper.station for damper in system.dampers):
        part = findings.study.train.parts[system.stations[station].part]
        model, factor = "viscous", None
        if part.machine is not None:
            model, factor = part.machine.damping_model, part.machine.damping_factor
        value = _value(findings, station, speed)
        name, source = system.stations[station].name, part.source or NOT_STATED
        rows.append((name, model, given(factor), value, source))
    point = f" at {given_rpm(speed)} rpm" if speed is not None else ""
    titles = f"< Component | < Model | < Factor | Value{point} [N m s/rad] | < Source"
    return table(titles, rows, "Damping to ground")


def _value(findings: Findings, station: int, speed: float | None) -> float | str:
    """Return the damping to ground of a station at the rated speed; a constant needs no speed."""
    dampers = [damper for damper in findings.system.dampers if damper.station == station]
    needs_torque = any(damper.needs_torque for damper in dampers)
    if not (needs_torque or any(damper.speed_factor for damper in dampers)):
        return sum(damper.constant for damper in dampers)
    steady = findings.get(Steady)
    if speed is None:
        return "varies with speed"
    if steady is None and needs_torque:
        return "varies with mean torque"
    speeds, mean, slope = np.array([speed]), np.array([]), None  # which no damper reads
    if steady is not None:
        nearest = [int(np.argmin(np.abs(steady.speed - speed)))]
        speeds, mean = steady.speed[nearest], steady.applied[:, nearest]
        slope = None if steady.load_slope is None else steady.load_slope[:, nearest]
    return float(findings.system.ground_damping(speeds, mean, slope)[station, 0])
