"""Error against run time, both logarithmic: one curve a method, one point a division of the shafts."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from torsion.output.figures.style import BAD, COLOURS, GREY, INK, legend_below, page

Array = NDArray[np.float64]
Curve = tuple[str, str, int, Array, Array, Array, Array]  # label, family, degree; (points,) ms median, quartiles; error
LEAST = 1.2e-16  # an error of 0 is drawn here, at half the rounding unit
DEGREES = 10  # of the shades of finite elements
FAMILIES: dict[str, dict[str, Any]] = {
    "lumped": {"color": COLOURS[0], "marker": "o", "linewidth": 1.8},
    "fem": {"marker": ".", "linewidth": 0.9},
    "exact": {"color": INK, "marker": "*", "markersize": 11, "linestyle": "none", "zorder": 6},
    "modal": {"color": COLOURS[3], "marker": "^", "linestyle": "--"},
    "corrected": {"color": "#7b3294", "marker": "v", "linestyle": "--"},
    "dense": {"color": BAD, "marker": "x", "linestyle": ":", "linewidth": 1.5},
}


def study(
    name: str, *, curves: Sequence[Curve], tolerance: float, bound: float, best: tuple[float, float] | None = None
) -> str:
    """tolerance, bound (of the reference): relative errors; best: time (ms) and error of the recommended point."""
    with page(name, 4.4) as sheet:
        axes = sheet.axes[0]
        for label, family, degree, time, low, high, error in curves:
            style = dict(FAMILIES[family])
            if family == "fem":
                style["color"] = mpl.colormaps["YlOrBr"](0.35 + 0.6 * degree / DEGREES)
            spread = np.stack([time - low, high - time])
            drawn = np.maximum(error, LEAST)
            axes.errorbar(time, drawn, xerr=spread, elinewidth=0.6, capsize=1.5, label=label, **style)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.axhline(tolerance, color=GREY, linewidth=1.0, linestyle=(0, (5, 2)), label="tolerance")
        if best is not None:
            axes.plot(
                [best[0]], [max(best[1], LEAST)], "o", color=COLOURS[2], markersize=13, fillstyle="none",
                markeredgewidth=2.0, label="recommended", zorder=7,
            )  # fmt: skip
        _ranges(axes, curves, bound)
        axes.set_xlabel("run time, ms: median of assembly and solve together; bars: the middle half of the runs")
        axes.set_ylabel("relative error")
        legend_below(sheet)
    return sheet.svg


def _ranges(axes: Axes, curves: Sequence[Curve], bound: float) -> None:
    """Whole decades on both axes, and the stretch in which the reference itself is in doubt."""
    floor = LEAST / 3.0
    largest = max((float(curve[6].max()) for curve in curves), default=1.0)
    axes.set_ylim(floor, max(10.0 * largest, 1.0))
    doubt = "below the bound of the reference"
    axes.axhspan(floor, max(bound, LEAST), facecolor="#e9e9e9", linewidth=0, zorder=0, label=doubt)
    axes.yaxis.set_major_locator(LogLocator(10.0, numticks=12))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(FuncFormatter(_two_and_five))
    axes.yaxis.set_major_formatter(FuncFormatter(_power))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _two_and_five(value: float, _: int | None = None) -> str:
    digit = round(value / 10.0 ** np.floor(np.log10(value) + 1e-9))
    return f"{value:g}" if digit in (2, 5) else ""


def _power(value: float, _: int | None = None) -> str:
    """A power of ten, above 1e-4 in per cent."""
    return f"{100.0 * value:g} %" if value > 0.9e-4 else f"{value:.0e}".replace("-", "−")
