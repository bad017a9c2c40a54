"""Vibratory against mean torque in one gear mesh over the speed."""

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.style import (
    BAD,
    COLOURS,
    INK,
    amplitude_axis,
    hatch,
    legend_below,
    page,
    ranges,
    rated_line,
)

Array = NDArray[np.float64]


def gear(
    name: str, *, speed: Array, vibratory: Array, mean: Array | None, bad: NDArray[np.bool_], unit: str,
    limit: float | None = None, rated: float | None = None, barred: tuple[tuple[float, float], ...] = (),
) -> str:  # fmt: skip
    """speed: (speeds,) rpm; torques (speeds,) in `unit`."""
    with page(name, 2.75) as sheet:
        axes = sheet.axes[0]
        ranges(axes, barred)
        good = np.where(hatch(axes, speed, bad), np.nan, vibratory)
        axes.plot(speed, good, color=INK, linewidth=1.6, label="vibratory torque (synthesis)")
        if mean is not None:
            axes.plot(speed, mean, color=COLOURS[0], label="mean torque")
            lifts = good > mean
            axes.fill_between(
                speed, mean, good, where=lifts, color=BAD, alpha=0.25, linewidth=0, label="torque reverses"
            )
        if limit is not None:
            axes.axhline(limit, color=BAD, linewidth=1.0, linestyle=(0, (5, 2)), label="limit of the vibratory torque")
        rated_line(axes, rated)
        axes.set_xlim(float(speed[0]), float(speed[-1]))
        amplitude_axis(axes, [good])
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel(f"mesh torque, {unit}")
        legend_below(sheet)
    return sheet.svg
