"""Chapter: the exact periodic response of a train with joints, beside the first-order one."""

from collections.abc import Iterator, Sequence

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.stability.first_order_compared import ComparedTorque, FirstOrderCompared
from torsion.analyses.stability.periodic_orbits import Found, PeriodicResponse
from torsion.arrays import BoolArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures.curves import (
    NO_MOTION,
    SPEED,
    amplitudes,
    barred_bands,
    rated_level,
    span,
    unanswered,
)
from torsion.output.figures.figure import Figure, Line, Marks, Panel, Symbol
from torsion.output.numbers import (
    RPM,
    counted,
    number,
    order,
    rpm,
)
from torsion.output.records import Place, along
from torsion.output.reported_values import (
    of_torsion,
    rated_rpm,
    unstable_rpm,
    worth_a_figure,
)
from torsion.output.stored.scene import Element, elements, torques
from torsion.results import listed

MOST_ROWS = 60
MOST_FIGURES = 6
MOST_ORDERS = 4  # in one figure
MOST_FLAGGED = 20  # speeds listed one by one
MODEL = (
    "The joints are modelled exactly, for any angle: Newton harmonic balance of the full equations of motion,"
    " with all multiples of the common order and the mean drive torque as unknowns. Amplitudes are zero to "
    "peak."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where no exact response was computed."""
    periodic = findings.get(PeriodicResponse)
    if periodic is None or findings.get(Response) is None:
        return
    rows = findings.need(FirstOrderCompared).each
    yield Heading("Exact periodic response")
    yield _introduction(findings, periodic)
    if judged := first_order_judged(findings):
        yield Paragraph(judged, "note")
    marks, flagged_rows = list[str](), list[tuple[Place, str]]()
    flagged = np.flatnonzero((periodic.status != Found.OK) | periodic.is_unstable).tolist()
    for k, place in zip(flagged, along(periodic, "speed", flagged), strict=True):
        reason = "more harmonics would be needed"
        if periodic.is_unstable[k]:
            reason = "unstable: the train does not settle in this motion"
        flagged_rows.append((place, periodic.why[k] or reason))
        marks.append("fail" if periodic.is_unstable[k] or periodic.why[k] else "note")
    if flagged:
        yield table(
            "speed: Speed [rpm]:7 | status_words: < Periodic motion | is_unstable: Unstable | growth: Growth rate [1/s]:3 | "
            "truncation: Omitted harmonic:2 | < Reason",
            flagged_rows,
            "Speeds with unreliable amplitudes, marked in the figures",
            marks=marks,
            most=MOST_FLAGGED,
        )
    if periodic.others is not None:
        speeds = listed(f"{rpm(speed)} rpm" for speed in np.unique(periodic.others.speed).tolist())
        yield Paragraph(
            f"At some peaks the equations have several periodic motions ({speeds}). The approach to the speed decides "
            "which one occurs; an unstable motion does not persist. Curves and tables show one of them; "
            "`periodic.others` of results.json has the others.",
            "note",
        )
    if rows:
        yield _table(rows)
        size = {
            element: max(row.exact for row in rows if row.component == element.name)
            for element in elements(findings.system)
            if any(row.component == element.name for row in rows)
        }
        drawn = worth_a_figure(findings, size, MOST_FIGURES)
        yield from (_figure(findings, element) for element in drawn)


def _introduction(findings: Findings, periodic: PeriodicResponse) -> Paragraph:
    truncation = periodic.truncation[np.isfinite(periodic.truncation)]
    harmonics = int(periodic.harmonics.max(initial=0))
    kept = (
        f"up to {harmonics} harmonics of the common period"
        if harmonics
        else "no periodic motion at any of them"
    )
    text = f"{MODEL} {counted(periodic.speed.size, 'speed')}, {kept}"
    if truncation.size:
        text += f"; estimated maximum omitted harmonic: {number(float(truncation.max()), 2)} of the largest"
    if np.isfinite(periodic.drive).any():
        ends = (number(float(end(periodic.drive))) for end in (np.nanmin, np.nanmax))
        text += f"; mean torque of the drive {' to '.join(ends)} N m"
    text += "."
    if any(line.order is None for line in findings.need(Response).lines):
        text += " Torques of fixed frequency are not included."
    return Paragraph(text)


def _table(rows: Sequence[ComparedTorque]) -> Table:
    ranked = sorted(rows, key=lambda row: row.order is not None)
    remarks = [
        "unstable there" if row.is_unstable else "coarse there" if row.is_coarse else ""
        for row in ranked
    ]
    orders = ["all" if row.order is None else order(row.order) for row in ranked]
    return table(
        "component: < Component -> | Order -> | first: First order [~N m] -> first order, ~ | first_speed: Speed [rpm] | "
        "exact: Exact [~N m] -> exact, ~ | exact_speed: Speed [rpm] -> at rpm | excess: Difference [%]:3+ -> % | "
        "< Remark ->",
        zip(ranked, orders, remarks, strict=True),
        "First order against exact: maximum torque over the speed range, of every order above 1 % and of the total (all)",
        marks=["fail" if remark else "" for remark in remarks],
        most=MOST_ROWS,
        short="Exact periodic response, maximum torque",
    )


def _figure(findings: Findings, element: Element) -> Figure:
    """Draw both methods at the orders of the joints and twice them: of two cross joints 2 and 4."""
    response, periodic = findings.need(Response), findings.need(PeriodicResponse)
    system, speed = findings.system, periodic.speed * RPM
    first, exact = response.amplitude(element.spans), element.largest(np.abs(periodic.torque))
    unit, orders = torques([exact]), [line.order for line in response.lines]
    of_joints = {
        n * system.stations[span.driving].ratio for span in system.spans for n, _ in span.error
    }
    lines, marks = list[Line](), list[Marks]()
    for order_shown in sorted({n * ratio for ratio in of_joints for n in (1, 2)})[:MOST_ORDERS]:
        if order_shown not in periodic.orders:
            continue
        words, pen = f"order {order(order_shown)}", len(lines)
        size = exact[:, periodic.orders.index(order_shown)] * unit.factor
        label = words.removeprefix("order ")
        lines.append(Line(f"{words}, exact", speed, size, pen, label, weight=1.7, symbol="dot"))
        if order_shown in orders:
            size_first = first[:, orders.index(order_shown)] * unit.factor
            lines.append(Line(f"{words}, first order", response.speed * RPM, size_first, pen + 1))
        flags: tuple[tuple[str, BoolArray, Symbol], ...] = (
            ("unstable motion", periodic.is_unstable, "cross"),
            ("not resolved", periodic.status == Found.COARSE, "box"),
        )
        for name, places, symbol in flags:
            marks.append(Marks(name, speed[places], size[places], symbol, "unstable"))
    _, unknown = unanswered(speed, periodic.status == Found.NONE, NO_MOTION)
    panel = Panel(
        span(SPEED, np.append(response.speed * RPM, speed)),
        amplitudes("torque amplitude", unit.unit, [line.y for line in lines]),
        tuple(lines),
        rated_level(rated_rpm(findings)),
        barred_bands((), unstable_rpm(findings)) + unknown,
        tuple(marks),
        height=140.0,
    )
    name = f"periodic-{element.part}-{element.spans[0]}"
    caption = f"Torque in {element.name}, orders of the joints, both methods"
    return of_torsion(findings, Figure(name, caption, (panel,)))


def first_order_judged(findings: Findings) -> str:
    """Return that the rules judge the first order, and how it misses the exact one; empty where there is only one."""
    compared = findings.get(FirstOrderCompared)
    if compared is None or not compared.each or not findings.study.rules:
        return ""
    totals = [row for row in compared.each if row.order is None] or compared.each
    text = "The rules judge the first-order response, not the exact periodic response."
    comparable = [row for row in totals if np.isfinite(row.excess)]
    worst = max(comparable, key=lambda row: row.excess, default=None)
    if worst is None:
        return text
    size = "total amplitude" if worst.order is None else f"amplitude of order {worst.order}"
    exact = f"{number(worst.exact)} N m at {rpm(worst.exact_speed)} rpm"
    first = f"{number(worst.first)} N m at {rpm(worst.first_speed)} rpm"
    excess = f"{'+' if worst.excess > 0 else ''}{number(100.0 * worst.excess, 3)}"
    return (
        f"{text} The maximum excess of the exact response is in {worst.component}: {size} {exact} against {first} of "
        f"the first order ({excess} %)."
    )
