"""Chapter: critical speeds, order by mode, and the Campbell diagram."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed
from torsion.analyses.modes.tolerances import Tolerances
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import frequencies_over_speed
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import NONE, RPM, counted, given_rpm, number, order, rpm
from torsion.output.reported_values import barred_rpm, rated, rated_rpm, reference, tolerated_rpm
from torsion.what_if.sweep.sweep_results import Sweep

MOST_IN_SUMMARY = 3  # on the terminal without `-v`
MOST_ORDERS = 12  # in the figure
MOST_ROWS = 60
IN_RANGE = "Critical speeds in the speed range"
Crossings = tuple[CriticalSpeed, ...]


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where no order excites or no speed range is given."""
    speeds, found = findings.study.operation.speeds, findings.need(CriticalSpeeds).crossings
    if not found or speeds is None:
        return
    yield Heading("Critical speeds")
    yield Paragraph(
        f"A critical speed is a speed of {reference(findings)} at which an order excites a mode. The speed range "
        f"{given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm has {sum(c.is_inside for c in found)} of "
        f"{counted(len(found), 'critical speed')}."
    )
    if any(c.is_inside for c in found):
        yield _list(found, rated(findings), reference(findings))
    by_torque = findings.get(FrequenciesOverSpeed)
    met = {c.order for c in found if c.is_inside}
    every = {c.order for c in found}
    shown = sorted(sorted(every, key=lambda one: (one not in met, one))[:MOST_ORDERS])
    capped = f" (lines of {len(shown)} of {len(every)} orders)" if len(shown) < len(every) else ""
    crossings = [
        (c.speed * RPM, c.frequency, c.is_inside, _words(c, rated(findings)))
        for c in found
        if c.is_inside or c.order in shown
    ]
    yield of_torsion(
        findings,
        frequencies_over_speed.campbell(
            "campbell",
            f"Campbell diagram{capped}",
            frequencies=findings.need(Modes).frequency.tolist(),
            orders=[(float(one), f"order {order(one)}") for one in shown],
            crossings=crossings,
            speeds=(speeds.first * RPM, speeds.last * RPM),
            rated=rated_rpm(findings),
            barred=barred_rpm(findings),
            tolerated=tolerated_rpm(findings),
            curves=None if by_torque is None else (by_torque.speed * RPM, by_torque.frequency),
            **({} if by_torque is not None else _spread(findings)),
        ),
    )


def _spread(findings: Findings) -> dict[str, Any]:
    """Hz, the band of each mode by tolerances, which is proven, or else that of most variants of a sweep."""
    found, swept = findings.get(Tolerances), findings.get(Sweep)
    if found is not None:
        return {"spread": list(zip(found.lower.tolist(), found.upper.tolist(), strict=True))}
    if swept is not None and swept.method != "grid":
        ends = list(zip(swept.low.tolist(), swept.high.tolist(), strict=True))
        return {
            "spread": [one for one in ends if np.isfinite(one).all()],
            "of": "95 % of the variants",
        }
    return {}


def matrix(findings: Findings) -> Iterator[Table]:
    """Yield the matrix of critical speeds, order by mode, if there is any."""
    crossings = (
        findings.need(CriticalSpeeds).crossings if findings.get(CriticalSpeeds) is not None else ()
    )
    if crossings and findings.study.operation.speeds is not None:
        yield _matrix(crossings, reference(findings))


def _matrix(found: Crossings, reference: str) -> Table:
    """Order by mode; orders count from the component `reference`."""
    modes = sorted({c.mode for c in found})
    at = {(c.order, c.mode): rpm(c.speed) + (" *" if c.is_inside else "") for c in found}
    titles = "Order | < Excited by" + "".join(f" | Mode {mode} [rpm]" for mode in modes)
    named = {c.order: c.line.named(reference) for c in found}
    rows = [
        (order(one), named[one], *(at.get((one, mode), NONE) for mode in modes))
        for one in sorted(named)
    ]
    return table(titles, rows, "Critical speeds, order by mode (* in the speed range)")


def _words(one: CriticalSpeed, speed: float | None) -> str:
    """What a point of the Campbell diagram is, with its distance from the rated speed (rad/s)."""
    margin = f", {_distance(one, speed)} % from rated" if speed else ""
    cause = f"order {order(one.order)} excites mode {one.mode} at {number(one.frequency)} Hz"
    return f"critical speed {rpm(one.speed)} rpm: {cause}{margin}"


def _distance(one: CriticalSpeed, speed: float) -> str:
    return number(100 * (one.speed / speed - 1), 3)


def _summary(inside: list[CriticalSpeed], reference: str) -> str:
    """The lowest critical speeds in the range in one sentence."""
    if not inside:
        return ""
    lowest = [
        f"{rpm(one.speed)} rpm ({one.line.named(reference)}, mode {one.mode})"
        for one in inside[:MOST_IN_SUMMARY]
    ]
    more = f", and {len(inside) - MOST_IN_SUMMARY} more" if len(inside) > MOST_IN_SUMMARY else ""
    return f"{IN_RANGE}: {', '.join(lowest)}{more}"


def _list(found: Crossings, speed: float | None, reference: str) -> Table:
    """The critical speeds in the range, and how far they lie from the rated speed (rad/s)."""
    distance = "Distance from rated [%] | " if speed else ""
    inside = sorted((c for c in found if c.is_inside), key=lambda c: c.speed)
    rows = []
    for c in inside[:MOST_ROWS]:
        own = [_distance(c, speed)] if speed else []
        rows.append(
            (
                rpm(c.speed),
                order(c.order),
                c.mode,
                number(c.frequency),
                *own,
                c.line.named(reference),
            )
        )
    rest = f" (the lowest {MOST_ROWS} of {len(inside)})" if len(inside) > MOST_ROWS else ""
    return table(
        f"Critical speed [rpm] -> rpm | Order -> | Mode -> | Frequency [Hz] | {distance}< Excited by ->",
        rows,
        IN_RANGE + rest,
        short=IN_RANGE,
        summary=_summary(inside, reference),
    )
