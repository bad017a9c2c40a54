"""Growth rate of small deviations: over the speed, and over the speed and one more quantity."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.curves_over_speed import SPEED, over
from torsion.output.figures.style import BAD, GREY, INK, hatch, legend_below, page, rated_line

Array = NDArray[np.float64]
COLOURS = "RdBu_r"
HEAD = 0.25  # of the height: room above the curve for the names of the ranges
SHARE = 0.98  # of the points lie within the colours of a map; the others have the last one


def stability(
    name: str, *, speed: Array, growth: Array, unstable: Sequence[tuple[float, float, str]], rated: float | None = None
) -> str:
    """speed: (speeds,) rpm; growth: (speeds,) 1/s, NaN where there is no periodic motion; unstable: rpm and name."""
    missing = ~np.isfinite(growth)
    bands = [(tuple((low, high) for low, high, _ in unstable), "unstable range")]
    with over(name, 3.0, speed, "growth rate, 1/s", rated=rated, bands=bands) as sheet:
        axes = sheet.axes[0]
        if np.any(missing):
            hatch(axes, speed, missing, "no periodic motion found")
        axes.axhline(0.0, color=GREY, linewidth=0.9)
        axes.plot(speed, growth, color=INK, linewidth=1.1, marker=".", markersize=3, label="growth rate")
        grows = growth > 0
        inside = np.array([any(low <= n <= high for low, high, _ in unstable) for n in speed.tolist()], dtype=bool)
        if np.any(grows & inside):
            axes.plot(speed[grows & inside], growth[grows & inside], ".", color=BAD, markersize=4, label="unstable")
        low_end, top = axes.get_ylim()
        if unstable:
            top += HEAD * (top - low_end)
            axes.set_ylim(low_end, top)
        for k, (low, high, words) in enumerate(unstable):
            axes.annotate(words, ((low + high) / 2.0, top), xytext=(0, -2 - 10 * (k % 3)), textcoords="offset points",
                          fontsize=7.5, ha="center", va="top", color=BAD)  # fmt: skip
    return sheet.svg


def stability_map(
    name: str, *, speed: Array, value: Array, growth: Array, quantity: str, rated: float | None = None
) -> str:
    """speed: (speeds,) rpm; value: (values,); growth: (speeds, values) 1/s, NaN where there is no periodic motion."""
    known = growth[np.isfinite(growth)]
    limit = float(np.quantile(np.abs(known), SHARE)) if known.size else 1.0
    with page(name, 3.6) as sheet:
        axes = sheet.axes[0]
        axes.patch.set(facecolor="white", edgecolor=BAD, hatch="////")  # seen where there is no value
        axes.grid(visible=False)
        drawn = axes.pcolormesh(
            speed, value, np.ma.masked_invalid(growth.T), cmap=COLOURS, vmin=-limit, vmax=limit, shading="nearest",
            rasterized=True,
        )  # fmt: skip
        if known.size and known.min() < 0 < known.max():
            axes.contour(speed, value, np.ma.masked_invalid(growth.T), levels=[0.0], colors=INK, linewidths=1.1)
        rated_line(axes, rated)
        axes.set_xlabel(SPEED)
        axes.set_ylabel(quantity)
        bar = sheet.figure.colorbar(drawn, ax=axes, extend="both")
        bar.set_label("growth rate, 1/s (red: unstable)")
        legend_below(sheet)
    return sheet.svg
