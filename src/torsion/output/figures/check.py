"""Errors of the models against the exact one: of every mode, and of the response torques over the speed."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from torsion.output.figures.style import BAD, COLOURS, legend_below, page

Array = NDArray[np.float64]
LOWEST = 1e-16  # relative; an error below it is drawn there: it is rounding
QUANTITIES = ("error of frequency", "1 − MAC")
MARKERS = ("o", "s", "^", "D")


def modes(
    name: str, *, frequency: Sequence[tuple[str, Array]], shape: Sequence[tuple[str, Array]], tolerance: float
) -> str:
    """frequency, shape: (model, (modes,)) magnitudes of the relative errors; shape is 1 - MAC."""
    with page(name, 3.7, rows=2, sharex=True) as sheet:
        for axes, errors, quantity in zip(sheet.axes, (frequency, shape), QUANTITIES, strict=True):
            for k, (label, values) in enumerate(errors):
                at = np.arange(1, len(values) + 1)
                axes.plot(at, _drawn(values), label=label, linewidth=0.8, **_pen(k))
            _errors_axis(axes, [values for _, values in errors], tolerance)
            axes.set_ylabel(quantity)
        axes = sheet.axes[-1]
        axes.set_xlim(0.5, max(len(values) for _, values in frequency) + 0.5)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.set_xlabel("mode")
        legend_below(sheet)
    return sheet.svg


def torques(name: str, *, speed: Array, lines: Sequence[tuple[str, Array]], tolerance: float) -> str:
    """speed: (speeds,) rpm; lines: (model, (speeds,)) relative errors, NaN where there is none."""
    with page(name, 2.6) as sheet:
        axes = sheet.axes[0]
        for k, (label, values) in enumerate(lines):
            axes.plot(speed, _drawn(values), label=label, **{**_pen(k), "marker": ""})
        _errors_axis(axes, [values for _, values in lines], tolerance)
        axes.set_xlim(float(speed[0]), float(speed[-1]))
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel("error of torques")
        legend_below(sheet)
    return sheet.svg


def _drawn(values: Array) -> Array:
    """What is rounding, at its lowest place; what is no number or infinite, nowhere."""
    return np.where(np.isfinite(values), np.maximum(values, LOWEST), np.nan)


def _pen(place: int) -> dict[str, Any]:
    return {"color": COLOURS[place % len(COLOURS)], "marker": MARKERS[place % len(MARKERS)]}


def _errors_axis(axes: Axes, errors: Sequence[Array], tolerance: float) -> None:
    """Logarithms from the smallest error, or from rounding, to beyond the tolerance."""
    known = np.concatenate([_drawn(values) for values in errors])
    known = known[np.isfinite(known)]
    axes.axhline(tolerance, color=BAD, linewidth=0.9, linestyle=(0, (6, 2)), label="tolerance")
    axes.set_yscale("log")
    axes.set_ylim(0.3 * known.min(initial=tolerance), 4.0 * known.max(initial=tolerance))
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"1e{round(math.log10(value))}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
