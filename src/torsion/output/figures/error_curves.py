"""Relative errors on logarithmic axes: of every mode, of torques over the speed, and of every method over run time."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from torsion.arrays import FloatArray
from torsion.output.figures.curves_over_speed import over
from torsion.output.figures.style import BAD, COLOURS, GREY, INK, plots

# label, family, degree; (points,) ms median, quartiles; error
Curve = tuple[str, str, int, FloatArray, FloatArray, FloatArray, FloatArray]
Errors = Sequence[tuple[str, FloatArray]]  # model, magnitudes of its relative errors
LEAST = 1.2e-16  # an error below half the rounding unit is drawn there: it is rounding
MARKERS = ("o", "s", "^", "D")
SIGNS = "os^Dv<>pPXhd"  # of methods of integration
DEGREES = 10  # of the shades of finite elements
FAMILIES: dict[str, dict[str, Any]] = {
    "lumped": {"color": COLOURS[0], "marker": "o", "linewidth": 1.8},
    "fem": {"marker": ".", "linewidth": 0.9},
    "exact": {"color": INK, "marker": "*", "markersize": 11, "linestyle": "none", "zorder": 6},
    "modal": {"color": COLOURS[3], "marker": "^", "linestyle": "--"},
    "corrected": {"color": "#7b3294", "marker": "v", "linestyle": "--"},
    "dense": {"color": BAD, "marker": "x", "linestyle": ":", "linewidth": 1.5},
    "integration": {"linewidth": 0.9},
    "peer": {"color": COLOURS[1], "marker": "s"},
}


def modes(sheet: Figure, *, frequency: Errors, shape: Errors, tolerance: float) -> None:
    """frequency, shape: of every mode; shape is 1 - MAC."""
    upper, lower = plots(sheet, 3.7, rows=2, sharex=True)
    for axes, errors, quantity in ((upper, frequency, "error of frequency"), (lower, shape, "1 − MAC")):
        for k, (label, values) in enumerate(errors):
            at = np.arange(1, len(values) + 1)
            axes.plot(at, _drawn(values), label=label, linewidth=0.8, **_pen(k))
        _around(axes, [values for _, values in errors], tolerance)
        axes.set_ylabel(quantity)
    lower.set_xlim(0.5, max(len(values) for _, values in frequency) + 0.5)
    lower.xaxis.set_major_locator(MaxNLocator(integer=True))
    lower.set_xlabel("mode")


def torques(sheet: Figure, *, speed: FloatArray, lines: Errors, tolerance: float) -> None:
    """speed: (speeds,) rpm; lines: (speeds,), NaN where there is none."""
    with over(sheet, 2.6, speed, "error of torques") as axes:
        for k, (label, values) in enumerate(lines):
            axes.plot(speed, _drawn(values), label=label, **{**_pen(k), "marker": ""})
        _around(axes, [values for _, values in lines], tolerance)


def run_times(
    sheet: Figure, *, curves: Sequence[Curve], tolerance: float, bound: float, best: tuple[float, float] | None = None
) -> None:
    """tolerance, bound (of the reference): relative errors; best: time (ms) and error of the recommended point."""
    (axes,) = plots(sheet, 4.4)
    error_over_time(axes, curves, bound)
    axes.axhline(tolerance, color=GREY, linewidth=1.0, linestyle=(0, (5, 2)), label="tolerance")
    if best is not None:
        ring: dict[str, Any] = {"markersize": 13, "fillstyle": "none", "markeredgewidth": 2.0, "zorder": 7}
        axes.plot([best[0]], [max(best[1], LEAST)], "o", color=COLOURS[2], label="recommended", **ring)
    axes.set_xlabel("run time, ms: median of assembly and solve together; ranges: the middle half of the runs")
    axes.set_ylabel("relative error")


def error_over_time(axes: Axes, curves: Sequence[Curve], bound: float = 0.0) -> None:
    """One curve a method, one point a discretisation; grey where the reference itself is in doubt."""
    for label, family, degree, time, low, high, error in curves:
        style = dict(FAMILIES[family])
        if family == "fem":
            style["color"] = mpl.colormaps["YlOrBr"](0.35 + 0.6 * degree / DEGREES)
        elif family == "integration":
            style |= {"color": COLOURS[degree % len(COLOURS)], "marker": SIGNS[degree % len(SIGNS)], "markersize": 5}
        spread = np.stack([time - low, high - time])
        axes.errorbar(time, _drawn(error), xerr=spread, elinewidth=0.6, capsize=1.5, label=label, **style)
    doubt = "below the bound of the reference"
    axes.axhspan(LEAST / 3.0, max(bound, LEAST), facecolor="#e9e9e9", linewidth=0, zorder=0, label=doubt)
    largest = max((float(curve[6].max()) for curve in curves), default=1.0)
    error_axis(axes, LEAST / 3.0, max(10.0 * largest, 1.0))
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(FuncFormatter(_two_and_five))


def error_axis(axes: Axes, low: float, high: float) -> None:
    """Logarithms with the decades alone in numbers."""
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(LogLocator(10.0, numticks=12))
    axes.yaxis.set_major_formatter(FuncFormatter(_power))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _around(axes: Axes, errors: Sequence[FloatArray], tolerance: float) -> None:
    """The axis from the smallest error, or from rounding, to beyond the tolerance, which is drawn."""
    known = np.concatenate([_drawn(values) for values in errors])
    known = known[np.isfinite(known)]
    axes.axhline(tolerance, color=BAD, linewidth=0.9, linestyle=(0, (6, 2)), label="tolerance")
    error_axis(axes, 0.3 * known.min(initial=tolerance), 4.0 * known.max(initial=tolerance))


def _drawn(values: FloatArray) -> FloatArray:
    """What is rounding, at its lowest place; what is no number or infinite, nowhere."""
    return np.where(np.isfinite(values), np.maximum(values, LEAST), np.nan)


def _pen(place: int) -> dict[str, Any]:
    return {"color": COLOURS[place % len(COLOURS)], "marker": MARKERS[place % len(MARKERS)]}


def _two_and_five(value: float, _: int | None = None) -> str:
    digit = round(value / 10.0 ** np.floor(np.log10(value) + 1e-9))
    return f"{value:g}" if digit in (2, 5) else ""


def _power(value: float, _: int | None = None) -> str:
    """A power of ten, above 1e-4 in per cent."""
    return f"{100.0 * value:g} %" if value > 0.9e-4 else f"{value:.0e}".replace("-", "−")
