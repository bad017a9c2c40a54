"""What several chapters read from the findings."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import nearest_mode
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.figures.figure import Criticals, Figure
from torsion.output.numbers import NONE, RPM, given, given_rpm, number, order
from torsion.output.stored.scene import Element
from torsion.rules.verdict_line import BarredRange, Checks, distinct_ranges

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import Lateral
    from torsion.analyses.lateral.tilt_stability import Tilting
    from torsion.analyses.stability.stability_over_speed import Stability

Band = tuple[float, float]
UNDAMPED = (
    "the response has no reliable finite value (undamped resonance). The report states no amplitude at these "
    "speeds and "
    "no maximum over the range. Give the damping of the train."
)
CONVERSION = 1e-12  # relative: rounding between rad/s and rpm


def rated(findings: Findings) -> float | None:
    """Return the rated speed, rad/s of the reference component; None without one."""
    point = findings.study.operation.rated
    return None if point is None else point.speed


def speed_range(findings: Findings) -> str:
    """Return the range of speeds of the operation; empty where none is given."""
    speeds = findings.study.operation.speeds
    return "" if speeds is None else f"{given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"


def rated_rpm(findings: Findings) -> float | None:
    """Return the rated speed in rpm; None without one."""
    speed = rated(findings)
    return None if speed is None else speed * RPM


def barred(findings: Findings) -> tuple[BarredRange, ...]:
    """Return the barred ranges that the verdicts stand on, each once, in rising order."""
    checks = findings.need(Checks).lines
    bands = distinct_ranges(band for check in checks for band in check.barred)
    return tuple(sorted(bands, key=lambda band: (band.lower, band.upper)))


def barred_rpm(findings: Findings) -> tuple[Band, ...]:
    """Return the barred ranges as bands of rpm, overlapping ones as one."""
    bands: list[Band] = []
    for band in barred(findings):
        low, high = band.lower * RPM, band.upper * RPM
        if bands and low <= bands[-1][1]:
            bands[-1] = (bands[-1][0], max(bands[-1][1], high))
        else:
            bands.append((low, high))
    return tuple(bands)


def band_words(band: Band) -> str:
    """Return a range in rpm, widened to tenths so that nothing of it is lost."""
    return "{} to {} rpm".format(*widened(band))


def widened(band: Band, within: Band = (-math.inf, math.inf)) -> tuple[str, str]:
    """Return both ends of a range in rpm, rounded down and up to a tenth, but not beyond two speeds (rpm).

    What the conversion of units adds does not widen it.
    """
    low = math.floor(10.0 * band[0] * (1.0 + CONVERSION)) / 10.0
    high = math.ceil(10.0 * band[1] * (1.0 - CONVERSION)) / 10.0
    return (
        given(within[0], 6) if low < within[0] else f"{low:.1f}",
        given(within[1], 6) if high > within[1] else f"{high:.1f}",
    )


def harmonic_name(response: Response, index: int, word: str = "") -> str:
    """Return the name of a component: '2' of an order, after a word where one is given, or '40 Hz'."""
    line = response.lines[index]
    return (
        f"{word}{order(line.order)}" if line.order is not None else f"{number(line.frequency)} Hz"
    )


def worth_a_figure(
    findings: Findings, torque: Mapping[Element, float], count: int
) -> list[Element]:
    """Return the elements with the largest torque (N m) referred to one speed, in their order; rigid ones only for a gear."""
    shown = [e for e in torque if findings.system.flexibility[e.spans[0]] > 0 or e.kind == "gear"]
    strong = sorted(shown, key=lambda e: -torque[e] * e.ratio)[:count]
    return [e for e in shown if e in strong]


def synthesis(findings: Findings, spans: Sequence[int]) -> FloatArray:
    """Return the amplitude (speeds,) N m of all lines together, largest of the spans; NaN where it is not known."""
    if findings.get(Synthesis) is None:
        return np.zeros(0)
    size = findings.need(Synthesis).half_range[:, list(spans)].max(axis=1)
    return np.where(findings.need(Response).unreliable | ~np.isfinite(size), np.nan, size)


def responds(findings: Findings) -> bool:
    """Return whether there is a response over speed, and something excites it."""
    return findings.get(Synthesis) is not None and bool(findings.need(Response).lines)


def orders_together(findings: Findings) -> str:
    """Return in words of which harmonic components the synthesis is made."""
    some = findings.get(Response) is not None and findings.need(Response).left_out
    return "the orders requested" if some else "all orders"


def unstable_rpm(findings: Findings) -> tuple[Band, ...]:
    """Return the unstable ranges of speed, rpm: of the train, then of the tilt of shafts."""
    stability: Stability | None = findings.results.get(
        "stability"
    )  # its class is not loaded where there is none
    ranges: Sequence[Any] = () if stability is None else stability.ranges
    tilts = (band for _, tilting in tilted(findings) for band in tilting.zones)
    return tuple((band.first * RPM, band.last * RPM) for band in (*ranges, *tilts))


def tilted(findings: Findings) -> "tuple[tuple[str, Tilting], ...]":
    """Return every shaft whose tilt was looked at, by its name."""
    lateral: Lateral | None = findings.results.get("lateral")
    shafts = () if lateral is None else lateral.shafts
    return tuple((shaft.name, shaft.tilting) for shaft in shafts if shaft.tilting is not None)


def joint_model(findings: Findings) -> str:
    """Return what the joint model says of its own error, in a sentence; empty without joints."""
    error = (
        0.0
        if findings.get(Response) is None
        else float(np.nanmax(findings.need(Response).joint_error, initial=0.0))
    )
    if error == 0:
        return ""
    if error > 1:
        return (
            "At some resonances the estimated error of the first-order joint model exceeds 100 %. The amplitudes "
            "of these "
            "peaks are not valid."
        )
    return f"The first-order joint model estimates its own relative error as at most {number(100 * error, 2)} %."


def mode_of(findings: Findings, barred: BarredRange) -> str:
    """Return the mode that the order of a barred range excites at its critical speed."""
    if barred.order is None:
        return NONE
    mode = nearest_mode(findings, float(barred.order) * barred.critical / (2.0 * math.pi))
    return NONE if mode is None else str(mode)


if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import ShaftFound
    from torsion.analyses.lateral.whirl import Critical


def of_torsion(findings: Findings, figure: Figure) -> Figure:
    """Return the figure with every critical speed of the train, in the speed range or not."""
    result = findings.get(CriticalSpeeds)
    crossings = () if result is None else result.crossings
    orders = {crossing.order: order(crossing.order) for crossing in crossings}
    return _with(figure, "critical speed", crossings, orders, rated_rpm(findings))


def of_bending(shaft: "ShaftFound", figure: Figure) -> Figure:
    """Return the figure with every critical speed of the bending of its shaft."""
    orders = {crossing.order: str(crossing.order) for crossing in shaft.critical}
    return _with(figure, f"critical speed of bending of {shaft.name}", shaft.critical, orders, None)


def _with(
    figure: Figure,
    of: str,
    crossings: "Sequence[CriticalSpeed | Critical]",
    orders: Mapping[Any, str],
    rated: float | None,
) -> Figure:
    if not crossings:
        return figure
    row_of = {order_value: k for k, order_value in enumerate(orders)}
    return replace(
        figure,
        criticals=Criticals(
            of,
            np.array([crossing.speed * RPM for crossing in crossings]),
            np.array([crossing.frequency for crossing in crossings]),
            np.array([crossing.mode for crossing in crossings]),
            np.array([row_of[crossing.order] for crossing in crossings]),
            tuple(f"order {words}" for words in orders.values()),
            rated,
        ),
    )
