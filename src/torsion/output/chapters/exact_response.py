"""Chapter: the exact periodic response of a train with joints, beside the first-order one."""

from collections.abc import Iterator, Sequence

import numpy as np

from torsion.analyses.motion.periodic_orbits import Found, PeriodicResponse
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, table
from torsion.output.elastic_elements import Element
from torsion.output.first_order_and_exact import (
    WORDS,
    Compared,
    compared,
    exact_amplitude,
    first_order_judged,
    flagged,
    other_motions,
    signed,
)
from torsion.output.numbers import NONE, RPM, Scale, counted, distinct_texts, number, order, rpm, scale
from torsion.output.reported_values import amplitude, rated_rpm, unstable_rpm, worth_a_figure
from torsion.output.selection import torques

MOST_ROWS = 60
MOST_FIGURES = 6
MOST_ORDERS = 4  # in one figure
MOST_FLAGGED = 20  # speeds listed one by one
MODEL = (
    "The joints as they are, at any angle: Newton harmonic balance on the train's full equations of motion, with "
    "every multiple of the common order and the drive's mean torque as unknown. Amplitudes are half ranges."
)


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
    if flagged(findings).any():
        yield _flagged(found, np.flatnonzero(flagged(findings)).tolist())
    if found.others is not None:
        yield Paragraph(
            "At some peaks the equations have several periodic motions. Which of them the train settles in depends on "
            "how it comes there; where deviations grow it does not stay. The curves and tables hold the one called "
            "`reported`.", "note"
        )  # fmt: skip
        yield table(
            "Speed [rpm] | < Motion | Largest torque amplitude [N m] | Order | < in | Growth of deviations [1/s]",
            [
                (rpm(one.speed), one.name, one.torque, order(one.order), one.where, number(one.growth, 3))
                for one in other_motions(findings)
            ],
            "Periodic motions found at the same speed, at the highest peaks",
        )
    if rows:
        unit = scale("N m", [point[0] for row in rows for point in (row.first, row.exact) if point is not None])
        yield _table(findings, rows, unit)
        size: dict[Element, float] = {}
        for row in rows:
            if row.exact is not None:
                size[row.element] = max(size.get(row.element, 0.0), row.exact[0])
        yield from (_figure(findings, element) for element in worth_a_figure(findings, size, MOST_FIGURES))


def _introduction(findings: Findings, found: PeriodicResponse) -> Paragraph:
    known = found.truncation[np.isfinite(found.truncation)]
    harmonics = int(found.harmonics.max(initial=0))
    kept = f"up to {harmonics} harmonics of the common period" if harmonics else "no periodic motion at any of them"
    text = f"{MODEL} {counted(found.speed.size, 'speed')}, {kept}"
    if known.size:
        text += f"; largest harmonic left out, estimated: {number(float(known.max()), 2)} of the largest kept"
    if np.isfinite(found.drive).any():
        least, most = number(float(np.nanmin(found.drive))), number(float(np.nanmax(found.drive)))
        text += f"; mean torque of the drive {least} to {most} N m"
    left_out = any(line.order is None for line in findings.need(Response).lines)
    return Paragraph(text + "." + (" Torques of fixed frequency are left out of it." if left_out else ""))


def _flagged(found: PeriodicResponse, bad: Sequence[int]) -> Table:
    """The speeds without a periodic motion, with a coarse or an unstable one."""
    rows, marks, shown = [], [], bad[:MOST_FLAGGED]
    for k, speed in zip(shown, distinct_texts((found.speed[shown] * RPM).tolist()), strict=True):
        unstable = bool(found.is_unstable[k])
        growth = NONE if found.growth is None else number(float(found.growth[k]), 3)
        why = found.why[k] or ("small deviations grow: the train does not settle in this motion" if unstable else
                               "more harmonics would be needed")  # fmt: skip
        state = WORDS[found.status[k]] + (", unstable" if unstable else "")
        rows.append((speed, state, growth, number(float(found.truncation[k]), 2), why))
        marks.append("fail" if unstable or found.why[k] else "note")
    rest = f"; the first {MOST_FLAGGED} of {len(bad)}" if len(bad) > MOST_FLAGGED else ""
    return table(
        "Speed [rpm] | < Periodic motion | Growth of deviations [1/s] | Harmonic left out | < Why",
        rows,
        f"Speeds whose amplitudes are not to be relied on; they are marked in the figures{rest}",
        marks=marks,
    )


def _table(findings: Findings, compared: tuple[Compared, ...], unit: Scale) -> Table:
    response, exact, bad = findings.need(Response), findings.need(PeriodicResponse), flagged(findings)
    rows = []
    for row in sorted(compared, key=lambda row: row.order is not None)[:MOST_ROWS]:
        both = [
            (NONE, NONE) if point is None else (unit.text(point[0]), rpm(float(speed[point[1]])))
            for point, speed in ((row.first, response.speed), (row.exact, exact.speed))
        ]
        remark = "" if row.exact is not None else "no periodic motion"
        if row.exact is not None and bad[row.exact[1]]:
            remark = "unstable there" if exact.is_unstable[row.exact[1]] else "coarse there"
        change = signed(row.excess) if np.isfinite(row.excess) else NONE
        line = "all" if row.order is None else order(row.order)
        rows.append((row.element.name, line, *both[0], *both[1], change, remark))
    rest = f"; {MOST_ROWS} of {len(compared)} rows" if len(compared) > MOST_ROWS else ""
    return table(
        f"< Element -> | Order -> | First order [{unit.unit}] -> first order, {unit.unit} | At speed [rpm] | "
        f"Exact [{unit.unit}] -> exact, {unit.unit} | At speed [rpm] -> at rpm | Difference [%] -> % | < Remark ->",
        rows,
        "First order against exact: largest torque over the speed range, of every order above 1 % and (all) of the "
        f"sum true to phase{rest}",
        marks=["fail" if row[-1] else "" for row in rows],
        short="Exact periodic response, largest torque",
    )


def _figure(findings: Findings, element: Element) -> Figure:
    """At the orders of the joints and twice them: of two cross joints 2 and 4."""
    response, found, system = findings.need(Response), findings.need(PeriodicResponse), findings.system
    first, exact = amplitude(findings, element.spans), exact_amplitude(findings, element.spans)
    unit, lines = torques([exact]), [line.order for line in response.lines]
    joints = {n * system.stations[span.driving].ratio for span in system.spans for n, _ in span.error}
    pairs = [
        (
            f"order {order(n)}",
            first[:, lines.index(n)] * unit.factor if n in lines else None,
            exact[:, found.orders.index(n)] * unit.factor,
        )
        for n in sorted({n * order for order in joints for n in (1, 2)})[:MOST_ORDERS]
        if n in found.orders
    ]
    values = {
        "first_speed": response.speed * RPM, "speed": found.speed * RPM, "lines": pairs, "unit": unit.unit,
        "none": found.status == Found.NONE, "coarse": found.status == Found.COARSE, "grows": found.is_unstable,
        "unstable": unstable_rpm(findings), "rated": rated_rpm(findings),
    }  # fmt: skip
    name = f"periodic-{element.part}-{element.spans[0]}"
    return Figure(name, f"Torque in {element.name} by both methods, orders of the joints", "periodic", values)
