"""Universal joints: quantities over the revolution of the driving shaft, and the index of fluctuation of a line."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from torsion.arrays import FloatArray
from torsion.output.figures.style import BAD, COLOURS, GREY, MOST_LINES, WIDTH, pens, plots

Point = tuple[float, float]  # deg, %
Panel = tuple[str, float, Sequence[tuple[str, FloatArray]]]  # axis with unit; the size rounding is judged by; lines
LINE_WIDTHS = (2.8, 1.1)  # of the first and the last line, so that lines that coincide are both seen
FULL = 359.0  # deg: from here on the values of an index go around the shaft
FLAT = 1e-9  # of the size by which rounding is judged: a smaller range is shown as a level line


def joint_turn(sheet: Figure, *, angle: FloatArray, panels: Sequence[Panel], quantity: str) -> None:
    """angle: (angles,) deg, `quantity` says of which shaft; a line is (label, (angles,)) and keeps its pen."""
    labels = list(dict.fromkeys(label for _, _, lines in panels for label, _ in lines))[:MOST_LINES]
    widths = np.linspace(*LINE_WIDTHS, max(len(labels), 2))
    drawn = dict(zip(labels, zip(pens(len(labels)), widths, strict=False), strict=True))
    every = plots(sheet, 0.65 + 1.45 * len(panels), len(panels), sharex=True)
    for axes, (says, size, lines) in zip(every, panels, strict=True):
        for label, values in lines:
            if label in drawn:
                pen, width = drawn[label]
                axes.plot(angle, values, label=label, linewidth=width, **pen)
        axes.set_ylabel(says)
        _limits(axes, size, [values for label, values in lines if label in drawn])
    last = every[-1]
    last.set_xlim(float(angle[0]), float(angle[-1]))
    last.set_xticks(_ticks(float(angle[-1])))
    last.set_xlabel(quantity)
    sheet.align_ylabels()


def _limits(axes: Axes, size: float, values: Sequence[FloatArray]) -> None:
    """Keep rounding from filling a plot whose values do not vary; mark zero where it lies inside."""
    low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
    if high - low <= FLAT * size:
        room = 0.1 * max(abs(low), size) or 1.0  # of values and a size that are all nothing: any, so that it is a range
        axes.set_ylim(low - room, high + room)
    elif low < 0.0 < high:
        axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)


def _ticks(last: float) -> FloatArray:
    """Every 30 degrees of one revolution, and no more than 13 marks over many."""
    turns = max(1, round(last / 360.0))
    return np.arange(0.0, last + 1e-6, 30.0 * turns if turns <= 12 else 360.0 * np.ceil(turns / 12))


def joint_index(
    sheet: Figure, *, values: FloatArray, index: FloatArray, quantity: str, present: Point, best: Point
) -> None:
    """Index of fluctuation against a phase, plane or angle of a line: around the shaft and on a straight axis.

    values: (values,) deg; index: (values,) %; quantity: what is varied, with its unit.
    """
    sheet.set_size_inches(WIDTH, 3.35)
    grid = sheet.add_gridspec(1, 2, width_ratios=(1.0, 1.25))
    around: Any = sheet.add_subplot(grid[0, 0], projection="polar")
    straight = sheet.add_subplot(grid[0, 1])
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
