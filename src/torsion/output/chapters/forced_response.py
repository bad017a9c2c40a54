"""Chapter: the response over the speed range: peaks, torque of each order and all together, angles."""

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.over_speed import requested_orders
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, head
from torsion.output.chapters.resonance_peaks import peaks
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import NONE, RPM, Scale, counted, degrees, exact, number, order, rpm, scale
from torsion.output.reported_values import (
    amplitude,
    barred_rpm,
    joint_model,
    judged,
    orders_together,
    rated_rpm,
    reference,
    rounding,
    synthesis,
    unreliable,
    unstable_rpm,
    without,
    worth_a_figure,
)
from torsion.output.selection import NO_VALUE, highest, largest, strongest, torques

MOST_LINES = 8  # orders in one figure
MOST_FIGURES = 12


def chapter(findings: Findings) -> list[Block]:
    """Nothing without a response over speed."""
    response = findings.get(Response)
    if response is None or not response.lines:
        return []
    found = [e for e in elements(findings.system) if np.any(np.abs(response.torque[:, :, list(e.spans)]) > 0)]
    unit = torques(amplitude(findings, e.spans) for e in found)
    title = Heading("Response over the speed range")
    blocks: list[Block] = [title, _introduction(findings, response), _status(findings, response)]
    if found:
        blocks.extend([_summary(findings, found, unit), peaks(findings, found, unit), _angles(findings, response)])
    drawn = worth_a_figure(findings, {e: highest(amplitude(findings, e.spans)) for e in found}, MOST_FIGURES)
    blocks += [_figure(findings, element) for element in drawn]
    if len(drawn) < len(found):
        rest = ", ".join(e.name for e in found if e not in drawn)
        blocks.append(Paragraph(f"Without a figure, as they follow the others or carry less: {rest}."))
    return blocks


def _introduction(findings: Findings, response: Response) -> Paragraph:
    requested, extra = int(response.requested.sum()), int((~response.requested).sum())
    made = findings.get(Synthesis)
    cycle, parts = "", "the components of the orders requested" if response.left_out else "all harmonic components"
    if made is not None:
        cycle = (
            f" The synthesis is the half range of {parts} together, true to phase, over the common cycle of "
            f"{exact(made.turns)} revolution{'' if made.turns <= 1 else 's'} of {reference(findings)}."
            if made.turns
            else " The components have no common cycle; the synthesis is the sum of their magnitudes, which is a bound."
        )
    text = (
        f"{counted(len(response.lines), 'harmonic component')} at {counted(requested, 'speed')} as requested and "
        f"{extra} more placed around the resonances{' and where the rules judge' if judged(findings) else ''}, so "
        "that no peak falls between two speeds. Amplitudes are half ranges; torques are those of a section, elastic "
        f"and damping part together, at the element's own speed.{cycle}"
    )
    if response.left_out:
        names = "; ".join(f"order {order(line.order)} ({', '.join(line.sources)})" for line in response.left_out)
        text += f" Left out of all that follows, as `orders` does not name it: {names}."
    elif requested_orders(findings.study) is not None:
        text += " All orders are reported, not only those that `orders` names, as the rules judge them together."
    return Paragraph(text + (f" Note on the speeds: {response.remark}." if response.remark else ""))


def _status(findings: Findings, response: Response) -> Paragraph:
    reliable = response.residual[(response.status == Status.OK) & np.isfinite(response.residual)]
    bad = int(unreliable(findings).sum())
    text = f"Largest relative equilibrium residual of the solution: {number(float(reliable.max(initial=0.0)), 2)}."
    text = f"{text} {joint_model(findings)}".strip()
    if bad == 0:
        return Paragraph(text)
    text += (
        f" At {counted(bad, 'speed')} a harmonic component is near-singular or singular: no amplitude can be stated "
        "there, and none as the largest over the range, since it grows without limit towards an undamped resonance. "
        "These speeds are hatched in the figures and left out of the table of peaks."
    )
    return Paragraph(text, "note")


def _summary(findings: Findings, found: list[Element], unit: Scale) -> Table:
    response, made = findings.need(Response), findings.get(Synthesis)
    mean = scale("N m", np.abs(response.mean).max(axis=0).tolist())
    columns = head(
        f"< Element -> | Synthesis, half range [{unit.unit}] -> {unit.unit} | At speed [rpm] -> at rpm | "
        f"Largest order there | Its torque [{unit.unit}] | RMS [{unit.unit}] | Sum of magnitudes [{unit.unit}] | "
        f"Mean [{mean.unit}]"
    )
    rows, nothing = [], rounding(findings)
    for element in found:
        here = nothing[list(element.spans)]
        half, parts = (without(one(findings, element.spans), here) for one in (synthesis, amplitude))
        at = largest(half)
        if at is None or made is None:
            rows.append((element.name, NO_VALUE, *[NONE] * 6))
            continue
        line = int(np.nanargmax(parts[at]))
        span = element.spans[int(np.argmax(made.half_range[at, list(element.spans)]))]
        if half[at] == 0.0:
            rows.append((element.name, "0", NONE, NONE, "0", "0", "0", mean.text(float(response.mean[at, span]))))
            continue
        rows.append((
            element.name, unit.text(float(half[at])), rpm(float(response.speed[at])), _line(response, line),
            unit.text(float(parts[at, line])), unit.text(float(made.rms[at, span])),
            unit.text(float(made.bound[at, span])), mean.text(float(response.mean[at, span])),
        ))  # fmt: skip
    together = orders_together(findings)
    caption = f"Largest vibratory torque of every element over the speed range, {together}"
    return Table(columns, tuple(rows), caption, short=f"Largest vibratory torque, {together}")


def _line(response: Response, index: int) -> str:
    line = response.lines[index]
    return order(line.order) if line.order is not None else f"{number(line.frequency)} Hz"


def _angles(findings: Findings, response: Response) -> Table:
    columns = head(
        "< Station | Largest amplitude [deg] | Amplitude [rad] | Order | At speed [rpm] | Speed amplitude [rpm]"
    )
    rows = []
    for index, station in enumerate(findings.study.train.stations):
        if station.is_ground:
            continue
        size = np.where(response.status == Status.OK, np.abs(response.angle[:, :, index]), np.nan)
        at = largest(size.ravel())
        if at is None:
            rows.append((station.name, NO_VALUE, *[NONE] * 4))
            continue
        speed, line = divmod(at, size.shape[1])
        angle = float(size[speed, line])
        amplitude = angle * float(response.frequency[speed, line]) * 60.0
        rows.append((
            station.name, degrees(angle), number(angle), _line(response, line), rpm(float(response.speed[speed])),
            number(amplitude),
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Largest angular amplitude of any one order, each at its own speed of rotation")


def _figure(findings: Findings, element: Element) -> Figure:
    response = findings.need(Response)
    parts, half = amplitude(findings, element.spans), synthesis(findings, element.spans)
    ratings = findings.study.train.parts[element.part].ratings
    limit = None if ratings is None else ratings.vibratory_torque
    unit = torques([parts])
    lines = [(f"order {_line(response, k)}" if response.lines[k].order is not None else _line(response, k),
              parts[:, k] * unit.factor) for k in strongest(parts, MOST_LINES)]  # fmt: skip
    values = {
        "speed": response.speed * RPM, "lines": lines, "bad": unreliable(findings), "unit": unit.unit,
        "synthesis": half * unit.factor if len(response.lines) > 1 and len(half) else None,
        "limits": [] if limit is None else [("permissible vibratory torque (maker)", limit * unit.factor)],
        "rated": rated_rpm(findings), "barred": barred_rpm(findings), "unstable": unstable_rpm(findings),
    }  # fmt: skip
    rest = (
        f" (the {len(lines)} strongest of {parts.shape[1]} harmonic components)" if len(lines) < parts.shape[1] else ""
    )
    name = f"torque-{element.part}-{element.spans[0]}"
    return Figure(name, f"Vibratory torque in {element.name}, {element.kind}{rest}", "torque", values)
