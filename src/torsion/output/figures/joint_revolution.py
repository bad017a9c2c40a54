"""Quantities of universal joints over the revolution of the driving shaft, one plot a quantity, above each other."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from torsion.output.figures.style import GREY, MOST_LINES, legend_below, page, pens

Array = NDArray[np.float64]
Panel = tuple[str, float, Sequence[tuple[str, Array]]]  # axis with unit; the size rounding is judged by; lines
LINE_WIDTHS = (2.8, 1.1)  # of the first and the last line, so that lines that coincide are both seen
FLAT = 1e-9  # of the size by which rounding is judged: a smaller range is shown as a level line


def joint_turn(name: str, *, angle: Array, panels: Sequence[Panel], quantity: str) -> str:
    """angle: (angles,) deg, `quantity` says of which shaft; a line is (label, (angles,)) and keeps its pen."""
    labels = list(dict.fromkeys(label for _, _, lines in panels for label, _ in lines))[:MOST_LINES]
    widths = np.linspace(*LINE_WIDTHS, max(len(labels), 2))
    drawn = dict(zip(labels, zip(pens(len(labels)), widths, strict=False), strict=True))
    with page(name, 0.65 + 1.45 * len(panels), len(panels), sharex=True) as sheet:
        for axes, (says, size, lines) in zip(sheet.axes, panels, strict=True):
            for label, values in lines:
                if label in drawn:
                    pen, width = drawn[label]
                    axes.plot(angle, values, label=label, linewidth=width, **pen)
            axes.set_ylabel(says)
            _limits(axes, size, [values for label, values in lines if label in drawn])
        last = sheet.axes[-1]
        last.set_xlim(float(angle[0]), float(angle[-1]))
        last.set_xticks(_ticks(float(angle[-1])))
        last.set_xlabel(quantity)
        sheet.figure.align_ylabels()
        legend_below(sheet)
    return sheet.svg


def _limits(axes: Axes, size: float, values: Sequence[Array]) -> None:
    """Keep rounding from filling a plot whose values do not vary; mark zero where it lies inside."""
    low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
    if high - low <= FLAT * size:
        room = 0.1 * max(abs(low), size) or 1.0  # of values and a size that are all nothing: any, so that it is a range
        axes.set_ylim(low - room, high + room)
    elif low < 0.0 < high:
        axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)


def _ticks(last: float) -> Array:
    """Every 30 degrees of one revolution, and no more than 13 marks over many."""
    turns = max(1, round(last / 360.0))
    return np.arange(0.0, last + 1e-6, 30.0 * turns if turns <= 12 else 360.0 * np.ceil(turns / 12))
