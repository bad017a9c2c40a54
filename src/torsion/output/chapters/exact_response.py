"""Chapter: the exact periodic response of a train with joints, beside the first-order one."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import rounding
from torsion.analyses.response.synthesis import common_cycle, extremes
from torsion.analyses.stability.periodic_orbits import Found, PeriodicResponse
from torsion.arrays import BoolArray, FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures.curves_over_speed import NO_MOTION
from torsion.output.figures.figure import Figure, Line, Marks, Panel, Symbol
from torsion.output.figures.ranges import (
    SPEED,
    amplitudes,
    barred_bands,
    rated_level,
    span,
    unanswered,
)
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import (
    RPM,
    counted,
    number,
    order,
    rpm,
)
from torsion.output.reported_values import (
    amplitude,
    rated_rpm,
    synthesis,
    unstable_rpm,
    without,
    worth_a_figure,
)
from torsion.output.selection import Element, elements, highest, largest, torques
from torsion.results import listed

MOST_ROWS = 60
MOST_FIGURES = 6
MOST_ORDERS = 4  # in one figure
MOST_FLAGGED = 20  # speeds listed one by one
SMALLEST = 0.01  # of an element's largest torque: smaller orders are not compared
WORDS = {Found.OK: "ok", Found.COARSE: "coarse", Found.NONE: "none found"}
Point = tuple[float, int]  # N m, position of the speed
MODEL = (
    "The joints are modelled exactly, for any angle: Newton harmonic balance of the full equations of motion,"
    " with all multiples of the common order and the mean drive torque as unknowns. Amplitudes are zero to "
    "peak."
)


@dataclass(frozen=True)
class Compared:
    """The largest torque of an element over the speeds, by both methods; order None is the half range of all orders."""

    element: Element
    order: Fraction | None
    first: Point | None  # in the response; None where it has no reliable largest value
    exact: Point  # in the periodic response

    @property
    def excess(self) -> float:
        """(exact - first order)/first order; NaN where the first order is missing or nothing."""
        if self.first is None or self.first[0] == 0:
            return np.nan
        return self.exact[0] / self.first[0] - 1.0


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where no exact response was computed."""
    periodic = findings.get(PeriodicResponse)
    if periodic is None or findings.get(Response) is None:
        return
    rows = compared(findings)
    yield Heading("Exact periodic response")
    yield _introduction(findings, periodic)
    if judged := first_order_judged(findings):
        yield Paragraph(judged, "note")
    yield from _flagged_table(periodic)
    if periodic.others is not None:
        speeds = listed(
            [f"{rpm(speed)} rpm" for speed in np.unique(periodic.others.speed).tolist()]
        )
        yield Paragraph(
            f"At some peaks the equations have several periodic motions ({speeds}). The approach to the speed decides "
            "which one occurs; an unstable motion does not persist. Curves and tables show one of them; "
            "`periodic.others` of results.json has the others.",
            "note",
        )
    if rows:
        yield _table(findings, rows)
        size: dict[Element, float] = {}
        for row in rows:
            size[row.element] = max(row.exact[0], size.get(row.element, row.exact[0]))
        yield from (
            _figure(findings, element) for element in worth_a_figure(findings, size, MOST_FIGURES)
        )


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
        smallest_drive, largest_drive = (
            number(float(np.nanmin(periodic.drive))),
            number(float(np.nanmax(periodic.drive))),
        )
        text += f"; mean torque of the drive {smallest_drive} to {largest_drive} N m"
    left_out = any(line.order is None for line in findings.need(Response).lines)
    return Paragraph(
        text + "." + (" Torques of fixed frequency are not included." if left_out else "")
    )


def _flagged_table(periodic: PeriodicResponse) -> Iterator[Table]:
    """The speeds without a periodic motion, with a coarse or an unstable one; nothing where there is none."""
    rows, marks = [], []
    flagged = np.flatnonzero((periodic.status != Found.OK) | periodic.is_unstable).tolist()
    for k in flagged:
        state, reason = WORDS[periodic.status[k]], "more harmonics would be needed"
        if periodic.is_unstable[k]:
            state += ", unstable"
            reason = "unstable: the train does not settle in this motion"
        growth = None if periodic.growth is None else periodic.growth[k]
        omitted, why = periodic.truncation[k], periodic.why[k] or reason
        rows.append((periodic.speed[k], state, growth, omitted, why))
        marks.append("fail" if periodic.is_unstable[k] or periodic.why[k] else "note")
    if rows:
        yield table(
            "Speed [rpm]:d | < Periodic motion | Growth rate [1/s]:3 | Omitted harmonic:2 | < Reason",
            rows,
            "Speeds with unreliable amplitudes, marked in the figures",
            marks=marks,
            most=MOST_FLAGGED,
        )


def _table(findings: Findings, compared: tuple[Compared, ...]) -> Table:
    response, exact = findings.need(Response), findings.need(PeriodicResponse)
    rows = []
    for row in sorted(compared, key=lambda row: row.order is not None):
        first: tuple[float | None, float | None] = None, None
        if row.first is not None:
            first = row.first[0], response.speed[row.first[1]]
        torque, k = row.exact
        remark = "coarse there" if exact.status[k] != Found.OK else ""
        remark = "unstable there" if exact.is_unstable[k] else remark
        line = "all" if row.order is None else order(row.order)
        name = row.element.name
        rows.append((name, line, *first, torque, exact.speed[k], row.excess, remark))
    return table(
        "< Component -> | Order -> | First order [~N m] -> first order, ~ | Speed [rpm] | Exact [~N m] -> exact, ~ | "
        "Speed [rpm] -> at rpm | Difference [%]:3+ -> % | < Remark ->",
        rows,
        "First order against exact: maximum torque over the speed range, of every order above 1 % and of the total (all)",
        marks=["fail" if row[-1] else "" for row in rows],
        most=MOST_ROWS,
        short="Exact periodic response, maximum torque",
    )


def _figure(findings: Findings, element: Element) -> Figure:
    """Draw both methods at the orders of the joints and twice them: of two cross joints 2 and 4."""
    response, periodic = findings.need(Response), findings.need(PeriodicResponse)
    system, speed = findings.system, periodic.speed * RPM
    first, exact = amplitude(findings, element.spans), element.largest(np.abs(periodic.torque))
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


def exact_half_range(findings: Findings, spans: Sequence[int]) -> FloatArray:
    """Return (speeds,) N m: largest half range of all orders together, true to phase; NaN where nothing was found."""
    periodic = findings.need(PeriodicResponse)
    turns, harmonics = common_cycle(list(periodic.orders))
    torque = periodic.torque[:, :, list(spans)].swapaxes(1, 2)
    if turns == 0:
        return np.asarray(np.abs(torque).sum(axis=2).max(axis=1))
    is_known = periodic.status != Found.NONE
    half, shape = np.full(len(periodic.speed), np.nan), (is_known.sum(), len(spans))
    upper, lower = extremes(torque[is_known].reshape(math.prod(shape), len(harmonics)), harmonics)
    half[is_known] = ((upper - lower) / 2.0).reshape(shape).max(axis=1)
    return half


def compared(findings: Findings) -> tuple[Compared, ...]:
    """Return every element that carries torque: all orders together (where no torque has a fixed frequency), then each."""
    if findings.get(Response) is None or findings.get(PeriodicResponse) is None:
        return ()
    nothing = rounding(findings)
    return tuple(
        row
        for element in elements(findings.system)
        for row in _compared(findings, element, nothing[list(element.spans)])
    )


def _compared(findings: Findings, element: Element, nothing: FloatArray) -> Iterator[Compared]:
    """nothing: (spans,) N m, below which a torque is rounding and reported as 0."""
    spans, orders = element.spans, [line.order for line in findings.need(Response).lines]
    periodic = findings.need(PeriodicResponse)
    exact = element.largest(np.abs(periodic.torque))
    if (top := highest(exact)) == 0.0:
        return

    def point(values: FloatArray) -> Point | None:
        row = largest(sizes := without(values, nothing))
        return None if row is None else (float(sizes[row]), row)

    def exact_point(values: FloatArray) -> Point:
        """Of the speeds with a periodic motion."""
        row = int(np.nanargmax(sizes := without(values, nothing)))
        return float(sizes[row]), row

    if None not in orders:
        half = exact_point(exact_half_range(findings, spans))
        yield Compared(element, None, point(synthesis(findings, spans)), half)
    first = amplitude(findings, spans)
    for k, rank in enumerate(periodic.orders):
        mine = point(first[:, orders.index(rank)]) if rank in orders else None
        exact_largest = exact_point(exact[:, k])
        if max(mine or exact_largest, exact_largest)[0] >= SMALLEST * top:
            yield Compared(element, rank, mine, exact_largest)


def first_order_judged(findings: Findings) -> str:
    """Return that the rules judge the first order, and how it misses the exact one; empty where there is only one."""
    rows = compared(findings)
    if not rows or not findings.study.rules:
        return ""
    totals = [row for row in rows if row.order is None] or rows
    text = "The rules judge the first-order response, not the exact periodic response."
    comparable = [row for row in totals if np.isfinite(row.excess)]
    worst = max(comparable, key=lambda row: row.excess, default=None)
    if worst is None or worst.first is None:
        return text
    size = "total amplitude" if worst.order is None else f"amplitude of order {worst.order}"
    exact, first = (
        f"{number(torque)} N m at {rpm(float(speed[k]))} rpm"
        for (torque, k), speed in (
            (worst.exact, findings.need(PeriodicResponse).speed),
            (worst.first, findings.need(Response).speed),
        )
    )
    excess = f"{'+' if worst.excess > 0 else ''}{number(100.0 * worst.excess, 3)}"
    return (
        f"{text} The maximum excess of the exact response is in {worst.element.name}: {size} {exact} against {first} of "
        f"the first order ({excess} %)."
    )
