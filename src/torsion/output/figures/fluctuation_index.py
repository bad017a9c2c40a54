"""Index of fluctuation of a line of joints against a phase, plane or angle: around the shaft and on a straight axis."""

import math
from typing import Any

import numpy as np
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from torsion.output.figures.style import BAD, COLOURS, legend_below, page

Array = NDArray[np.float64]
Point = tuple[float, float]  # deg, %
FULL = 359.0  # deg: from here on the values go around the shaft


def joint_index(name: str, *, values: Array, index: Array, quantity: str, present: Point, best: Point) -> str:
    """values: (values,) deg; index: (values,) %; quantity: what is varied, with its unit."""
    with page(name, 3.35) as sheet:
        sheet.figure.delaxes(sheet.axes[0])
        grid = sheet.figure.add_gridspec(1, 2, width_ratios=(1.0, 1.25))
        around: Any = sheet.figure.add_subplot(grid[0, 0], projection="polar")
        straight = sheet.figure.add_subplot(grid[0, 1])
        sheet.axes[:] = [straight]
        for axes, scale in ((around, math.pi / 180.0), (straight, 1.0)):
            axes.plot(scale * values, index, color=COLOURS[0], label="index of fluctuation, %")
            for (at, size), marker, colour, label in (
                (present, "s", BAD, f"present: {present[0]:.4g}°, {present[1]:.4g} %"),
                (best, "o", COLOURS[2], f"best: {best[0]:.4g}°, {best[1]:.4g} %"),
            ):
                axes.plot([scale * at], [size], marker, color=colour, linestyle="none", markersize=6, label=label,
                          clip_on=False, zorder=6)  # fmt: skip
        _around(around, float(min(values[0], present[0], best[0])), float(max(values[-1], present[0], best[0])))
        straight.set_xlim(float(values[0]), float(values[-1]))
        straight.set_ylim(bottom=0.0)
        if values[-1] - values[0] > FULL:
            straight.set_xticks(np.arange(values[0], values[-1] + 1.0, 60.0))
        straight.set_xlabel(quantity)
        straight.set_ylabel("index of fluctuation, %")
        legend_below(sheet)
    return sheet.svg


def _around(axes: PolarAxes, first: float, last: float) -> None:
    """Only the sector that the values fill; zero in the middle."""
    axes.set_rmin(0.0)
    if last - first < FULL:
        axes.set_thetamin(first)
        axes.set_thetamax(last)
    axes.set_rlabel_position(min(last, 67.5))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.tick_params(labelsize=7)
    axes.grid(linewidth=0.4)
