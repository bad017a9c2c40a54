"""Mean torque of the elements over the speed."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.style import MOST_LINES, legend_below, page, pens, rated_line

Array = NDArray[np.float64]


def steady(
    name: str, *, speed: Array, lines: Sequence[tuple[str, Array]], unit: str, rated: float | None = None
) -> str:  # fmt: skip
    """speed: (speeds,) rpm; lines: (label, (speeds,)) in `unit`."""
    with page(name, 2.6) as sheet:
        axes = sheet.axes[0]
        for (label, values), pen in zip(lines[:MOST_LINES], pens(len(lines[:MOST_LINES])), strict=True):
            axes.plot(speed, values, label=label, **pen)
        rated_line(axes, rated)
        axes.set_xlim(float(speed[0]), float(speed[-1]))
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel(f"mean torque, {unit}")
        legend_below(sheet)
    return sheet.svg
