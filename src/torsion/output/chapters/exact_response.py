"""Chapter: the exact periodic response of a train with joints, beside the first-order one."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.synthesis import common_cycle, extremes
from torsion.analyses.stability.periodic_orbits import Found, PeriodicResponse
from torsion.arrays import BoolArray, FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves_over_speed
from torsion.output.figures.figure import Figure
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import (
    NONE,
    RPM,
    Scale,
    counted,
    distinct_texts,
    number,
    order,
    rpm,
    scale,
)
from torsion.output.reported_values import (
    amplitude,
    rated_rpm,
    rounding,
    synthesis,
    unstable_rpm,
    without,
    worth_a_figure,
)
from torsion.output.selection import Element, elements, highest, largest, torques

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
    found = findings.get(PeriodicResponse)
    if found is None or findings.get(Response) is None:
        return
    rows = compared(findings)
    yield Heading("Exact periodic response")
    yield _introduction(findings, found)
    if judged := first_order_judged(findings):
        yield Paragraph(judged, "note")
    if (bad := _flagged(found)).any():
        yield _flagged_table(found, np.flatnonzero(bad).tolist())
    if found.others is not None:
        yield Paragraph(
            "At some peaks the equations have several periodic motions. The approach to the speed decides which one "
            "occurs; an unstable motion does not persist. Curves and tables show the motion called `reported`.",
            "note",
        )
        yield table(
            "Speed [rpm] | < Motion | Maximum torque amplitude [N m] | Order | < in | Growth rate [1/s]",
            _motions(findings, found, found.others),
            "Periodic motions found at the same speed, at the highest peaks",
        )
    if rows:
        unit = scale(
            "N m", [point[0] for row in rows for point in (row.first or row.exact, row.exact)]
        )
        yield _table(findings, rows, unit)
        size: dict[Element, float] = {}
        for row in rows:
            size[row.element] = max(row.exact[0], size.get(row.element, row.exact[0]))
        yield from (
            _figure(findings, element) for element in worth_a_figure(findings, size, MOST_FIGURES)
        )


def _introduction(findings: Findings, found: PeriodicResponse) -> Paragraph:
    known = found.truncation[np.isfinite(found.truncation)]
    harmonics = int(found.harmonics.max(initial=0))
    kept = (
        f"up to {harmonics} harmonics of the common period"
        if harmonics
        else "no periodic motion at any of them"
    )
    text = f"{MODEL} {counted(found.speed.size, 'speed')}, {kept}"
    if known.size:
        text += (
            f"; estimated maximum omitted harmonic: {number(float(known.max()), 2)} of the largest"
        )
    if np.isfinite(found.drive).any():
        least, most = number(float(np.nanmin(found.drive))), number(float(np.nanmax(found.drive)))
        text += f"; mean torque of the drive {least} to {most} N m"
    left_out = any(line.order is None for line in findings.need(Response).lines)
    return Paragraph(
        text + "." + (" Torques of fixed frequency are not included." if left_out else "")
    )


def _flagged(found: PeriodicResponse) -> BoolArray:
    """(speeds,) the exact response has no value, a coarse one, or one that small deviations leave."""
    return np.asarray((found.status != Found.OK) | found.is_unstable)


def _flagged_table(found: PeriodicResponse, bad: Sequence[int]) -> Table:
    """The speeds without a periodic motion, with a coarse or an unstable one."""
    rows, marks, shown = [], [], bad[:MOST_FLAGGED]
    for place, speed in enumerate(distinct_texts((found.speed[shown] * RPM).tolist())):
        k = shown[place]
        unstable = bool(found.is_unstable[k])
        growth = NONE if found.growth is None else number(float(found.growth[k]), 3)
        why = found.why[k] or (
            "unstable: the train does not settle in this motion"
            if unstable
            else "more harmonics would be needed"
        )
        state = WORDS[found.status[k]] + (", unstable" if unstable else "")
        rows.append((speed, state, growth, number(float(found.truncation[k]), 2), why))
        marks.append("fail" if unstable or found.why[k] else "note")
    rest = f"; the first {MOST_FLAGGED} of {len(bad)}" if len(bad) > MOST_FLAGGED else ""
    return table(
        "Speed [rpm] | < Periodic motion | Growth rate [1/s] | Omitted harmonic | < Reason",
        rows,
        f"Speeds with unreliable amplitudes, marked in the figures{rest}",
        marks=marks,
    )


def _motions(
    findings: Findings, found: PeriodicResponse, others: PeriodicResponse
) -> Iterator[tuple[str, ...]]:
    """Every motion at the speeds at which several were found, by its largest amplitude, the reported one first."""
    for speed in np.unique(others.speed).tolist():
        here = [("reported", found, int(np.flatnonzero(found.speed == speed)[0]))]
        here += [("another", others, k) for k in np.flatnonzero(others.speed == speed).tolist()]
        for name, motion, row in here:
            size = {
                e: np.abs(motion.torque[row][:, list(e.spans)]).max(axis=1)
                for e in elements(findings.system)
            }
            element = max(size, key=lambda one: float(size[one].max()))
            rank = int(size[element].argmax())
            growth = NONE if motion.growth is None else number(float(motion.growth[row]), 3)
            torque, where = number(float(size[element][rank])), element.name
            yield (
                rpm(float(motion.speed[row])),
                name,
                torque,
                order(motion.orders[rank]),
                where,
                growth,
            )


def _table(findings: Findings, compared: tuple[Compared, ...], unit: Scale) -> Table:
    response, exact = findings.need(Response), findings.need(PeriodicResponse)
    bad = _flagged(exact)
    rows = []
    for row in sorted(compared, key=lambda row: row.order is not None)[:MOST_ROWS]:
        both = [
            (NONE, NONE) if point is None else (unit.text(point[0]), rpm(float(speed[point[1]])))
            for point, speed in ((row.first, response.speed), (row.exact, exact.speed))
        ]
        remark = ""
        if bad[row.exact[1]]:
            remark = "unstable there" if exact.is_unstable[row.exact[1]] else "coarse there"
        change = _signed(row.excess) if np.isfinite(row.excess) else NONE
        line = "all" if row.order is None else order(row.order)
        rows.append((row.element.name, line, *both[0], *both[1], change, remark))
    rest = f"; {MOST_ROWS} of {len(compared)} rows" if len(compared) > MOST_ROWS else ""
    return table(
        f"< Component -> | Order -> | First order [{unit.unit}] -> first order, {unit.unit} | Speed [rpm] | "
        f"Exact [{unit.unit}] -> exact, {unit.unit} | Speed [rpm] -> at rpm | Difference [%] -> % | < Remark ->",
        rows,
        "First order against exact: maximum torque over the speed range, of every order above 1 % and of the total "
        f"(all){rest}",
        marks=["fail" if row[-1] else "" for row in rows],
        short="Exact periodic response, maximum torque",
    )


def _figure(findings: Findings, element: Element) -> Figure:
    """At the orders of the joints and twice them: of two cross joints 2 and 4."""
    response, found, system = (
        findings.need(Response),
        findings.need(PeriodicResponse),
        findings.system,
    )
    first, exact = amplitude(findings, element.spans), exact_amplitude(findings, element.spans)
    unit, lines = torques([exact]), [line.order for line in response.lines]
    joints = {
        n * system.stations[span.driving].ratio for span in system.spans for n, _ in span.error
    }
    pairs = [
        (
            f"order {order(n)}",
            first[:, lines.index(n)] * unit.factor if n in lines else None,
            exact[:, found.orders.index(n)] * unit.factor,
        )
        for n in sorted({n * order for order in joints for n in (1, 2)})[:MOST_ORDERS]
        if n in found.orders
    ]
    return of_torsion(
        findings,
        curves_over_speed.periodic(
            f"periodic-{element.part}-{element.spans[0]}",
            f"Torque in {element.name}, orders of the joints, both methods",
            first_speed=response.speed * RPM,
            speed=found.speed * RPM,
            lines=pairs,
            unit=unit.unit,
            none=found.status == Found.NONE,
            coarse=found.status == Found.COARSE,
            grows=found.is_unstable,
            unstable=unstable_rpm(findings),
            rated=rated_rpm(findings),
        ),
    )


def exact_amplitude(findings: Findings, spans: Sequence[int]) -> FloatArray:
    """(speeds, orders) N m: largest exact amplitude in the spans; NaN where no periodic motion was found."""
    return np.asarray(np.abs(findings.need(PeriodicResponse).torque[:, :, list(spans)]).max(axis=2))


def exact_half_range(findings: Findings, spans: Sequence[int]) -> FloatArray:
    """(speeds,) N m: largest half range of all orders together, true to phase; NaN where nothing was found."""
    found = findings.need(PeriodicResponse)
    turns, harmonics = common_cycle(list(found.orders))
    torque = found.torque[:, :, list(spans)].swapaxes(1, 2)
    if turns == 0:
        return np.asarray(np.abs(torque).sum(axis=2).max(axis=1))
    known = found.status != Found.NONE
    out, shape = np.full(len(found.speed), np.nan), (known.sum(), len(spans))
    highest, lowest = extremes(torque[known].reshape(math.prod(shape), len(harmonics)), harmonics)
    out[known] = ((highest - lowest) / 2.0).reshape(shape).max(axis=1)
    return out


def compared(findings: Findings) -> tuple[Compared, ...]:
    """Every element that carries torque: all orders together (where no torque has a fixed frequency), then each."""
    if findings.get(Response) is None or findings.get(PeriodicResponse) is None:
        return ()
    nothing = rounding(findings)
    return tuple(
        row
        for element in elements(findings.system)
        for row in _compared(findings, element, nothing)
    )


def _compared(findings: Findings, element: Element, nothing: FloatArray) -> Iterator[Compared]:
    """nothing: (spans,) N m, below which a torque is rounding and reported as 0."""
    spans, orders = element.spans, [line.order for line in findings.need(Response).lines]
    here = nothing[list(spans)]
    first, exact = without(amplitude(findings, spans), here), exact_amplitude(findings, spans)
    top = highest(exact)
    if top == 0.0:
        return
    if None not in orders:
        half = without(exact_half_range(findings, spans), here)
        yield Compared(
            element, None, _largest(without(synthesis(findings, spans), here)), _largest_found(half)
        )
    for k, one in enumerate(findings.need(PeriodicResponse).orders):
        mine = None if one not in orders else _largest(first[:, orders.index(one)])
        found = _largest_found(without(exact[:, k], here))
        if max(mine or found, found)[0] >= SMALLEST * top:
            yield Compared(element, one, mine, found)


def _largest(values: FloatArray) -> Point | None:
    at = largest(values)
    return None if at is None else (float(values[at]), at)


def _largest_found(values: FloatArray) -> Point:
    """Of the speeds with a periodic motion."""
    at = int(np.nanargmax(values))
    return float(values[at]), at


def first_order_judged(findings: Findings) -> str:
    """That the rules judge the first order, and by how much it misses the exact one; empty where there is only one."""
    rows = compared(findings)
    if not rows or not findings.study.rules:
        return ""
    together = [row for row in rows if row.order is None] or rows
    text = "The rules judge the first-order response, not the exact periodic response."
    worst = max(
        (row for row in together if np.isfinite(row.excess)),
        key=lambda row: row.excess,
        default=None,
    )
    if worst is None or worst.first is None:
        return text
    response, exact = findings.need(Response), findings.need(PeriodicResponse)
    return (
        f"{text} The maximum excess of the exact response is in {worst.element.name}: "
        f"{'total amplitude' if worst.order is None else f'amplitude of order {worst.order}'} "
        f"{number(worst.exact[0])} N m at {rpm(float(exact.speed[worst.exact[1]]))} rpm against "
        f"{number(worst.first[0])} N m at {rpm(float(response.speed[worst.first[1]]))} rpm of the first order "
        f"({_signed(worst.excess)} %)."
    )


def _signed(share: float) -> str:
    """A relative difference in percent, with its sign."""
    return ("+" if share > 0 else "") + number(100.0 * share, 3)
