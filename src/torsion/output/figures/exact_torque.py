"""Torque amplitude of one element over the speed, to the first order and exactly."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.style import BAD, INK, amplitude_axis, hatch, legend_below, page, pens, ranges, rated_line

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
FIRST = ("--", ":", "-.")  # dashes of the first order


def periodic(
    name: str, *, first_speed: Array, speed: Array, lines: Sequence[tuple[str, Array | None, Array]], unit: str,
    none: Flags, coarse: Flags, grows: Flags, unstable: tuple[tuple[float, float], ...] = (),
    rated: float | None = None,
) -> str:  # fmt: skip
    """Speeds in rpm; lines: (label, (first speeds,) or None, (speeds,)) in `unit`, NaN where there is no answer.

    none, coarse, grows: (speeds,) no periodic motion, not resolved, unstable.
    """
    with page(name, 2.9) as sheet:
        axes = sheet.axes[0]
        ranges(axes, unstable, "unstable range")
        if np.any(none):
            hatch(axes, speed, none, "no periodic motion found")
        for k, ((label, first, exact), pen) in enumerate(zip(lines, pens(len(lines)), strict=True)):
            colour = pen["color"]
            axes.plot(speed, exact, color=colour, linewidth=2.2, alpha=0.45, label=f"{label}, exact")
            axes.plot(speed, exact, ".", color=colour, markersize=3, label="speeds solved")
            if first is not None:
                axes.plot(first_speed, first, color=INK, linewidth=0.9, linestyle=FIRST[k % len(FIRST)],
                          label=f"{label}, first order", zorder=4)  # fmt: skip
            for flags, marker, words in ((grows, "x", "unstable motion"), (coarse, "s", "not resolved")):
                if np.any(flags):
                    axes.plot(speed[flags], exact[flags], marker, color=BAD, fillstyle="none", linestyle="none",
                              label=words, zorder=5)  # fmt: skip
        rated_line(axes, rated)
        axes.set_xlim(float(min(speed[0], first_speed[0])), float(max(speed[-1], first_speed[-1])))
        drawn = [value for _, first, exact in lines for value in (first, exact) if value is not None]
        amplitude_axis(axes, drawn or [np.zeros(1)])
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel(f"torque amplitude, {unit}")
        legend_below(sheet)
    return sheet.svg
