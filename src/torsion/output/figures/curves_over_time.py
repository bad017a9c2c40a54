"""Torques and speeds over time, as the range of the samples of every column of the picture."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from torsion.arrays import FloatArray
from torsion.output.figures.curves_over_speed import over
from torsion.output.figures.style import pens


def over_time(
    sheet: Figure, *, time: FloatArray, lines: Sequence[tuple[str, FloatArray, FloatArray]], quantity: str
) -> None:
    """time: (columns,) s; lines: (label, least and greatest (columns,))."""
    with over(sheet, 2.4, time, quantity, quantity="time, s") as axes:
        for (label, low, high), pen in zip(lines, pens(len(lines)), strict=True):
            axes.fill_between(time, low, high, color=pen["color"], alpha=0.5, linewidth=0)
            axes.plot(time, high, label=label, linewidth=0.7, **pen)
            if high is not low:
                axes.plot(time, low, linewidth=0.7, **pen)
