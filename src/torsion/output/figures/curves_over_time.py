"""Torques and speeds over time, as the range of the samples of every column of the picture."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.curves_over_speed import over
from torsion.output.figures.style import pens

Array = NDArray[np.float64]


def over_time(name: str, *, time: Array, lines: Sequence[tuple[str, Array, Array]], quantity: str) -> str:
    """time: (columns,) s; lines: (label, least and greatest (columns,))."""
    with over(name, 2.4, time, quantity, quantity="time, s") as sheet:
        for (label, low, high), pen in zip(lines, pens(len(lines)), strict=True):
            sheet.axes[0].fill_between(time, low, high, color=pen["color"], alpha=0.5, linewidth=0)
            sheet.axes[0].plot(time, high, label=label, linewidth=0.7, **pen)
            if high is not low:
                sheet.axes[0].plot(time, low, linewidth=0.7, **pen)
    return sheet.svg
