"""Chapter: critical speeds, order by mode, and the Campbell diagram."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures.curves import (
    MOST_LINES,
    SPEED,
    Crossing,
    barred_bands,
    met,
    rated_level,
)
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Panel
from torsion.output.numbers import RPM, counted, number, order, rpm
from torsion.output.reported_values import (
    barred,
    barred_rpm,
    of_torsion,
    rated_rpm,
    speed_range,
)

MOST_IN_SUMMARY = 3  # on the terminal without `-v`
MOST_ORDERS = 12  # in the figure
AROUND = (
    1.12  # times the last speed, and the highest frequency that matters: so far the figure goes
)
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
        f"A critical speed is a speed of {findings.study.reference} at which an order excites a mode. The speed range "
        f"{speed_range(findings)} has {len(inside)} of "
        f"{counted(len(crossings), 'critical speed')}."
    )
    if inside:
        inside = sorted(inside, key=lambda crossing: crossing.speed)
        names = [crossing.line.named(findings.study.reference) for crossing in inside]
        lowest = [
            f"{rpm(crossing.speed)} rpm ({name}, mode {crossing.mode})"
            for crossing, name in zip(inside[:MOST_IN_SUMMARY], names, strict=False)
        ]
        if len(inside) > MOST_IN_SUMMARY:
            lowest[-1] += f", and {len(inside) - MOST_IN_SUMMARY} more"
        omitted = f" (the lowest {MOST_ROWS} of {len(inside)})" if len(inside) > MOST_ROWS else ""
        margin = "margin: Distance from rated [%]:3 | " * (rated_rpm(findings) is not None)
        yield table(
            "speed: Critical speed [rpm] -> rpm | order: Order:o -> | mode: Mode -> | frequency: Frequency [Hz] | "
            f"{margin}< Excited by ->",
            list(zip(inside[:MOST_ROWS], names, strict=False)),
            IN_RANGE + omitted,
            short=IN_RANGE,
            summary=f"{IN_RANGE}: {', '.join(lowest)}",
        )

    # Orders that meet a mode in the range come first, then the lowest.
    met_inside, orders = ({crossing.order for crossing in some} for some in (inside, crossings))
    shown = sorted(sorted(orders, key=lambda order: (order not in met_inside, order))[:MOST_ORDERS])
    capped = f" (lines of {len(shown)} of {len(orders)} orders)" if len(shown) < len(orders) else ""
    figure = _campbell(findings, (speeds.first * RPM, speeds.last * RPM), shown)
    yield of_torsion(findings, replace(figure, caption=f"Campbell diagram{capped}"))


def _campbell(findings: Findings, speeds: tuple[float, float], orders: list[Fraction]) -> Figure:
    """Draw natural frequencies, the lines of some orders, and critical speeds; speeds: rpm, ends of the range."""
    crossings = findings.need(CriticalSpeeds).crossings
    frequencies = findings.need(Modes).frequency
    by_torque = findings.results.get("frequencies_over_speed")
    inside = max((crossing.frequency for crossing in crossings if crossing.is_inside), default=0.0)
    reached, right = float(max(orders)) * speeds[1] / 60.0, AROUND * speeds[1]
    # One mode above what matters.
    wanted = float(frequencies[frequencies > inside].min(initial=np.inf))
    wanted = wanted if math.isfinite(wanted) else inside or reached
    top = AROUND * max(min(wanted, 1.15 * reached), inside, 0.25 * reached, 1e-9)

    lines, modes, bands = list[Line](), list[Level](), [Band("speed range", *speeds, "range")]
    for band in barred(findings):
        if math.isfinite(band.tolerance_lower):  # it covers the critical speed at every tolerance
            ends = band.tolerance_lower * RPM, band.tolerance_upper * RPM
            bands.append(Band("barred range over the tolerances", *ends, "spread"))
    if by_torque is None:
        shown = frequencies[frequencies <= top][:MOST_LINES].tolist()
        for k, hertz in enumerate(shown, 1):
            modes.append(Level("", hertz, "plain", label=f"mode {k}: {number(hertz)} Hz"))
        of, spread = _spread(findings)
        bands += [Band(of, *ends, "spread", "y") for ends in spread[: len(shown)]]
    else:
        for k, mode in enumerate(by_torque.frequency[:MOST_LINES], 1):
            hertz, x = np.where(mode <= top, mode, np.nan), by_torque.speed * RPM
            lines.append(Line("", x, hertz, "plain", f"mode {k}", label_at="end"))
    for pen, value in enumerate(orders):
        end = np.array([0.0, min(right, 60.0 * top / float(value))])
        words = order(value)
        hertz = float(value) * end / 60.0
        lines.append(Line(f"order {words}", end, hertz, pen, words, label_at="end"))
    points, rated = list[Crossing](), rated_rpm(findings)
    for crossing in crossings:
        if crossing.is_inside or crossing.order in orders:
            words = f"critical speed {rpm(crossing.speed)} rpm: order {order(crossing.order)} excites mode "
            words += f"{crossing.mode} at {number(crossing.frequency)} Hz"
            if rated and crossing.margin is not None:
                words += f", {number(100 * crossing.margin, 3)} % from rated"
            place = crossing.speed * RPM, crossing.frequency
            points.append((*place, crossing.is_inside, words))
    panel = Panel(
        replace(SPEED, low=0.0, high=right),
        Axis("frequency", "Hz", low=0.0, high=top),
        tuple(lines),
        (*modes, *rated_level(rated)),
        (*bands, *barred_bands(barred_rpm(findings))),
        tuple(met(points, right, top)),
        height=210.0,
    )
    return Figure("campbell", "Campbell diagram", (panel,))


def _spread(findings: Findings) -> tuple[str, list[tuple[float, float]]]:
    """Return what the band of each mode (Hz) is: the proven one of tolerances, or that of most variants of a sweep."""
    tolerances, sweep = (findings.results.get(name) for name in ("tolerances", "sweep"))
    if tolerances is not None:
        bands = np.transpose([tolerances.lower, tolerances.upper])
        return "within the tolerances", bands.tolist()
    if sweep is not None and sweep.method != "grid":
        bands = np.transpose([sweep.low, sweep.high])
        return "95 % of the variants", bands[np.isfinite(bands).all(axis=1)].tolist()
    return "", []


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
                line.named(findings.study.reference),
            )
            for value, line in sorted(lines.items())
        ],
        f"Critical speeds, order by mode; the speed range is {speed_range(findings)}",
    )
