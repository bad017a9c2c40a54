"""Vibratory shear stress of one shaft over the speed, with the limits of the class rule."""

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


def stress(
    name: str, *, speed: Array, synthesis: Array, bad: NDArray[np.bool_], continuous: Array | None = None,
    transient: Array | None = None, rated: float | None = None, barred: tuple[tuple[float, float], ...] = (),
) -> str:  # fmt: skip
    """speed: (speeds,) rpm; stresses (speeds,) N/mm2, NaN where there is no limit."""
    with page(name, 2.75) as sheet:
        axes = sheet.axes[0]
        ranges(axes, barred)
        good = np.where(hatch(axes, speed, bad), np.nan, synthesis)
        axes.plot(speed, good, color=INK, linewidth=1.6, label="stress (synthesis)")
        if continuous is not None:
            axes.plot(speed, continuous, color=BAD, label="limit τ_C, continuous")
        if transient is not None and np.any(np.isfinite(transient)):
            axes.plot(speed, transient, color=COLOURS[1], linestyle="--", label="limit τ_T, passing rapidly")
        rated_line(axes, rated)
        axes.set_xlim(float(speed[0]), float(speed[-1]))
        amplitude_axis(axes, [good])
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel("shear stress amplitude, N/mm²")
        legend_below(sheet)
    return sheet.svg
