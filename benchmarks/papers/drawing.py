"""Figures of the pages: curves over one axis, in panels above each other, drawn in the look of the program's own."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from torsion.output.figures.style import INK, page, pens, plots

Array = NDArray[np.float64]
ROUNDING = 1e-9  # relative: a smaller range is a level line
DRAWN = 8  # digits: the file is the same wherever it is drawn


@dataclass(frozen=True)
class Panel:
    """One plot: what its axis says, its lines by label, points with words (x, y, words), and dots (label, x, y)."""

    axis: str
    lines: Sequence[tuple[str, ArrayLike]]
    marks: Sequence[tuple[float, float, str]] = field(default=())
    dots: Sequence[tuple[str, ArrayLike, ArrayLike]] = field(default=())


def curves(name: str, x: Array, along: str, panels: Sequence[Panel], *, height: float = 1.9, step: float = 45) -> str:
    """SVG of lines over x, ticks of x every `step`; a line keeps its pen from panel to panel."""
    return page(name, _curves, x=x, along=along, panels=panels, height=height, step=step)


def _curves(sheet: Figure, *, x: Array, along: str, panels: Sequence[Panel], height: float, step: float) -> None:
    labels = list(dict.fromkeys(label for panel in panels for label, _ in panel.lines))
    drawn = dict(zip(labels, pens(len(labels)), strict=True))
    every = plots(sheet, 0.7 + height * len(panels), len(panels), sharex=True)
    for axes, panel in zip(every, panels, strict=True):
        for label, values in panel.lines:
            axes.plot(x, np.broadcast_to(np.round(values, DRAWN), x.shape), label=label, **drawn[label])
        for place, value, words in panel.marks:
            axes.plot(place, value, "o", color=INK, zorder=5)
            above = all(value >= np.max(values) * (1.0 - ROUNDING) for _, values in panel.lines)
            axes.annotate(words, (place, value), (9, 5 if above else -6), textcoords="offset points")
        for label, places, values in panel.dots:
            axes.plot(places, np.round(values, DRAWN), ".", color=INK, label=label, zorder=5)
        _level(axes)
        axes.set_ylabel(panel.axis)
    last = every[-1]
    last.set_xlim(float(x[0]), float(x[-1]))
    last.set_xticks(np.arange(step * np.ceil(x[0] / step), float(x[-1]) + 1e-6 * step, step))
    last.set_xlabel(along)
    sheet.align_ylabels()


def _level(axes: Axes) -> None:
    """Keep rounding from filling a plot whose values do not vary."""
    low, high = axes.dataLim.intervaly
    if high - low <= ROUNDING * max(abs(low), abs(high)):
        axes.set_ylim(low - 0.05 * abs(low) - 1e-3, high + 0.05 * abs(high) + 1e-3)
