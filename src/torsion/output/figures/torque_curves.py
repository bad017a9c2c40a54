"""Vibratory torque of one element over the speed: each order, and all of them together."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.style import BAD, INK, amplitude_axis, hatch, legend_below, page, pens, ranges, rated_line

Array = NDArray[np.float64]


def torque(
    name: str, *, speed: Array, lines: Sequence[tuple[str, Array]], synthesis: Array | None, bad: NDArray[np.bool_],
    unit: str, limits: Sequence[tuple[str, float]] = (), rated: float | None = None,
    barred: tuple[tuple[float, float], ...] = (), unstable: tuple[tuple[float, float], ...] = (),
) -> str:  # fmt: skip
    """speed, bad: (speeds,) rpm; lines: (label, (speeds,)) and synthesis in `unit`, NaN where there is no answer."""
    with page(name, 2.75) as sheet:
        axes = sheet.axes[0]
        ranges(axes, barred)
        ranges(axes, unstable, "unstable range")
        hidden = hatch(axes, speed, bad)
        lines = [(label, np.where(hidden, np.nan, values)) for label, values in lines]
        synthesis = None if synthesis is None else np.where(hidden, np.nan, synthesis)
        for (label, values), pen in zip(lines, pens(len(lines)), strict=True):
            axes.plot(speed, values, label=label, linewidth=1.0, **pen)
        if synthesis is not None:
            axes.plot(speed, synthesis, color=INK, linewidth=1.7, label="synthesis (half range)")
        for label, limit in limits:
            if limit <= 4.0 * axes.get_ylim()[1]:
                axes.axhline(limit, color=BAD, linewidth=1.0, linestyle=(0, (5, 2)), label=label)
        rated_line(axes, rated)
        axes.set_xlim(float(speed[0]), float(speed[-1]))
        amplitude_axis(axes, [synthesis] if synthesis is not None else [values for _, values in lines])
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel(f"torque amplitude, {unit}")
        legend_below(sheet)
    return sheet.svg
