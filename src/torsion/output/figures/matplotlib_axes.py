"""The plots of a figure drawn by matplotlib, for papers: lines, limits, ranges and marks."""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.errors import refusal
from torsion.output.drawing.pens import BANDS, stroke
from torsion.output.figures.figure import Axis, Figure, Panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INCH = 96.0  # px of a panel's height
WIDTH = 6.3  # in, the text of A4


def draw_plots(figure: Figure, axes: "Axes | Sequence[Axes] | None" = None) -> "tuple[Axes, ...]":
    """Draw each plot of a figure into its axes, by default into new ones below each other; return the axes.

    Raises ImportError without matplotlib, InputError if the figure has no plot or another number of them than axes.
    """
    if not figure.plots:
        raise refusal(
            f"the figure '{figure.name}' has no axes, so matplotlib cannot draw it", "use its `svg`"
        )
    if axes is None:
        try:
            from matplotlib import pyplot
        except ImportError:
            raise ImportError("to_matplotlib needs matplotlib: pip install matplotlib") from None
        heights = [panel.height for panel in figure.plots]
        size = (WIDTH, 1.0 + sum(heights) / INCH)
        _, grid = pyplot.subplots(
            len(heights), squeeze=False, figsize=size, height_ratios=heights, layout="constrained"
        )
        axes = grid[:, 0].tolist()
    targets = tuple(axes) if isinstance(axes, Sequence | np.ndarray) else (axes,)
    if len(targets) != len(figure.plots):
        raise refusal(
            f"the figure '{figure.name}' has {len(figure.plots)} plots for {len(targets)} axes"
        )
    for panel, target in zip(figure.plots, targets, strict=True):
        _draw(panel, target)
    return targets


def _draw(panel: Panel, axes: "Axes") -> None:
    if panel.cells is not None:
        cells = panel.cells
        mesh = axes.pcolormesh(cells.x, cells.y, cells.values, shading="nearest", cmap="cividis")
        title = f"{cells.quantity}, {cells.unit}" if cells.unit else cells.quantity
        axes.figure.colorbar(mesh, ax=axes, label=_text(title))
    for band in panel.bands:
        span = axes.axvspan if band.axis == "x" else axes.axhspan
        span(band.low, band.high, color=BANDS[band.kind][0], label=_text(band.name) or None)
    for line in panel.lines:
        look: dict[str, Any] = {"linewidth": 1.2 * line.weight, "color": stroke(line.pen).colour}
        (drawn,) = axes.plot(line.x, line.y, label=_text(line.name) or None, **look)
        if line.base is not None:
            axes.fill_between(line.x, line.base, line.y, color=drawn.get_color(), alpha=0.2)
    for level in panel.levels:
        rule = axes.axvline if level.axis == "x" else axes.axhline
        look = {"linestyle": "--", "linewidth": 0.9, "color": stroke(level.pen).colour}
        rule(level.value, label=_text(level.name) or None, **look)
    for marks in panel.marks:
        axes.plot(marks.x, marks.y, "o", markersize=4, label=_text(marks.name) or None)
    _scale(panel.x, axes, "x")
    _scale(panel.y, axes, "y")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize="small")


def _scale(axis: Axis, axes: "Axes", name: str) -> None:
    """Set title, ends and numbers of one axis."""
    settings: dict[str, Any] = {f"{name}label": _text(axis.title)}
    if axis.is_log:
        settings[f"{name}scale"] = "log"
    if axis.places:
        settings[f"{name}ticks"] = [value for value, _ in axis.places]
        settings[f"{name}ticklabels"] = [_text(words) for _, words in axis.places]
    axes.set(**settings)
    ends = (axis.high, axis.low) if axis.is_reversed else (axis.low, axis.high)
    axes.set(**{f"{name}lim": ends})


def _text(words: str) -> str:
    """Return words of a figure with their subscripts as matplotlib writes them."""
    return re.sub(r"_\{(.*?)\}", r"$_{\\mathrm{\1}}$", words.replace("$", r"\$"))
