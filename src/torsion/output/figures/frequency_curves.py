"""Amplitudes over a frequency range."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures.style import GREY, MOST_LINES, amplitude_axis, hatch, legend_below, page, pens

Array = NDArray[np.float64]


def frequency(
    name: str, *, frequency: Array, lines: Sequence[tuple[str, Array]], bad: NDArray[np.bool_], quantity: str,
    natural: Sequence[float] = (),
) -> str:  # fmt: skip
    """frequency: (frequencies,) Hz; lines: (label, (frequencies,)); quantity: what the axis says, with its unit."""
    with page(name, 3.0) as sheet:
        axes = sheet.axes[0]
        hidden = hatch(axes, frequency, bad)
        for at in natural:
            if frequency[0] <= at <= frequency[-1]:
                axes.axvline(at, color=GREY, linewidth=0.5, linestyle=":", label="natural frequencies")
        for (label, values), pen in zip(lines[:MOST_LINES], pens(len(lines[:MOST_LINES])), strict=True):
            axes.plot(frequency, np.where(hidden | (values <= 0), np.nan, values), label=label, linewidth=1.0, **pen)
        amplitude_axis(axes, [np.where(hidden, np.nan, values) for _, values in lines])
        axes.set_xlim(float(frequency[0]), float(frequency[-1]))
        axes.set_xlabel("frequency, Hz")
        axes.set_ylabel(quantity)
        legend_below(sheet)
    return sheet.svg
