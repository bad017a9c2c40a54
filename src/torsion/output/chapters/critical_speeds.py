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
from torsion.output.numbers import RPM, counted, number, order, rpm
from torsion.output.reported_values import (
    barred_rpm,
    rated_rpm,
    reference,
    speed_range,
    tolerated_rpm,
)
from torsion.what_if.sweep.sweep_results import Sweep

MOST_IN_SUMMARY = 3  # on the terminal without `-v`
MOST_ORDERS = 12  # in the figure
MOST_ROWS = 60
IN_RANGE = "Critical speeds in the speed range"


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield nothing where no order excites or no speed range is given."""
    speeds, crossings = findings.study.operation.speeds, findings.need(CriticalSpeeds).crossings
    if not crossings or speeds is None:
        return
    inside = [crossing for crossing in crossings if crossing.is_inside]
    yield Heading("Critical speeds")
    yield Paragraph(
        f"A critical speed is a speed of {reference(findings)} at which an order excites a mode. The speed range "
        f"{speed_range(findings)} has {len(inside)} of "
        f"{counted(len(crossings), 'critical speed')}."
    )
    if inside:
        yield _in_range(findings, inside)

    # Orders that meet a mode in the range come first, then the lowest.
    met, orders = ({crossing.order for crossing in some} for some in (inside, crossings))
    shown = sorted(sorted(orders, key=lambda order: (order not in met, order))[:MOST_ORDERS])
    capped = f" (lines of {len(shown)} of {len(orders)} orders)" if len(shown) < len(orders) else ""
    by_torque = findings.get(FrequenciesOverSpeed)
    yield of_torsion(
        findings,
        frequencies_over_speed.campbell(
            "campbell",
            f"Campbell diagram{capped}",
            frequencies=findings.need(Modes).frequency.tolist(),
            orders=[(float(value), f"order {order(value)}") for value in shown],
            crossings=[
                (
                    crossing.speed * RPM,
                    crossing.frequency,
                    crossing.is_inside,
                    _point_words(crossing, rated_rpm(findings)),
                )
                for crossing in crossings
                if crossing.is_inside or crossing.order in shown
            ],
            speeds=(speeds.first * RPM, speeds.last * RPM),
            rated=rated_rpm(findings),
            barred=barred_rpm(findings),
            tolerated=tolerated_rpm(findings),
            curves=None if by_torque is None else (by_torque.speed * RPM, by_torque.frequency),
            **({} if by_torque is not None else _spread(findings)),
        ),
    )


def _spread(findings: Findings) -> dict[str, Any]:
    """Return the band of each mode (Hz): the proven one of tolerances, or that of most variants of a sweep."""
    tolerances, sweep = findings.get(Tolerances), findings.get(Sweep)
    if tolerances is not None:
        return {"spread": np.transpose([tolerances.lower, tolerances.upper]).tolist()}
    if sweep is not None and sweep.method != "grid":
        bands = np.transpose([sweep.low, sweep.high])
        return {
            "spread": bands[np.isfinite(bands).all(axis=1)].tolist(),
            "of": "95 % of the variants",
        }
    return {}


def matrix(findings: Findings) -> Iterator[Table]:
    """Yield the matrix of critical speeds, order by mode, if there is any."""
    result = findings.get(CriticalSpeeds)
    if result is None or not result.crossings or findings.study.operation.speeds is None:
        return
    by_place = {(crossing.order, crossing.mode): crossing for crossing in result.crossings}
    lines = {crossing.order: crossing.line for crossing in result.crossings}
    modes = sorted({mode for _, mode in by_place})
    titles = (f" | {k}.speed: Mode {mode} [rpm]" for k, mode in enumerate(modes, 1))
    yield table(
        f"Order:o | < Excited by{''.join(titles)}",
        [
            (
                *(by_place.get((value, mode)) for mode in modes),
                value,
                line.named(reference(findings)),
            )
            for value, line in sorted(lines.items())
        ],
        f"Critical speeds, order by mode; the speed range is {speed_range(findings)}",
    )


def _point_words(crossing: CriticalSpeed, rated: float | None) -> str:
    """Return the words of a point of the Campbell diagram, with its distance from the rated speed, if there is one."""
    words = f"critical speed {rpm(crossing.speed)} rpm: order {order(crossing.order)} excites mode {crossing.mode}"
    words += f" at {number(crossing.frequency)} Hz"
    if rated and crossing.margin is not None:
        words += f", {number(100 * crossing.margin, 3)} % from rated"
    return words


def _in_range(findings: Findings, inside: list[CriticalSpeed]) -> Table:
    """Return the critical speeds in the range, and how far they lie from the rated speed."""
    inside = sorted(inside, key=lambda crossing: crossing.speed)
    names = [crossing.line.named(reference(findings)) for crossing in inside]
    lowest = [
        f"{rpm(crossing.speed)} rpm ({name}, mode {crossing.mode})"
        for crossing, name in zip(inside[:MOST_IN_SUMMARY], names, strict=False)
    ]
    if len(inside) > MOST_IN_SUMMARY:
        lowest[-1] += f", and {len(inside) - MOST_IN_SUMMARY} more"
    omitted = f" (the lowest {MOST_ROWS} of {len(inside)})" if len(inside) > MOST_ROWS else ""
    margin = "margin: Distance from rated [%]:3 | " * (rated_rpm(findings) is not None)
    return table(
        "speed: Critical speed [rpm] -> rpm | order: Order:o -> | mode: Mode -> | frequency: Frequency [Hz] | "
        f"{margin}< Excited by ->",
        list(zip(inside[:MOST_ROWS], names, strict=False)),
        IN_RANGE + omitted,
        short=IN_RANGE,
        summary=f"{IN_RANGE}: {', '.join(lowest)}",
    )
