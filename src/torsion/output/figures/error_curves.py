"""Relative errors of models on logarithmic axes: of every mode, and of torques over the speed."""

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel, Symbol
from torsion.output.figures.ranges import SPEED, Lines, span

LEAST = 1.2e-16  # an error below half the rounding unit is drawn there: it is rounding
SYMBOLS: tuple[Symbol, ...] = ("disc", "square", "triangle", "diamond")


def modes(name: str, caption: str, *, frequency: Lines, shape: Lines, tolerance: float) -> Figure:
    """Draw errors by mode; frequency, shape: (model, (modes,) magnitudes of relative errors), shape is 1 - MAC."""
    x = Axis("mode", "", 0.5, max(len(errors) for _, errors in frequency) + 0.5, is_whole=True)
    panels = []
    for quantity, errors in (("error of frequency", frequency), ("1 − MAC", shape)):
        numbers = [(model, np.arange(1.0, len(values) + 1), values) for model, values in errors]
        lines = tuple(
            Line(model, mode, drawn_error(values), pen, symbol=SYMBOLS[pen % len(SYMBOLS)])
            for pen, (model, mode, values) in enumerate(numbers)
        )
        panels.append(_panel(x, quantity, lines, tolerance))
    return Figure(name, caption, tuple(panels))


def torques(
    name: str, caption: str, *, speed: FloatArray, lines: Lines, tolerance: float
) -> Figure:
    """Draw errors over speed: (speeds,) rpm; lines: (model, (speeds,)), NaN where there is none."""
    drawn = tuple(
        Line(model, speed, drawn_error(values), pen) for pen, (model, values) in enumerate(lines)
    )
    return Figure(
        name, caption, (_panel(span(SPEED, speed), "error of torques", drawn, tolerance),)
    )


def drawn_error(values: FloatArray) -> FloatArray:
    """Return rounding as the lowest drawn error, and NaN for what is no number or infinite."""
    return np.where(np.isfinite(values), np.maximum(values, LEAST), np.nan)


def _panel(x: Axis, quantity: str, lines: tuple[Line, ...], tolerance: float) -> Panel:
    """Return the plot from the smallest error, or from rounding, to beyond the tolerance."""
    errors = np.concatenate([np.array([tolerance]), *(line.y for line in lines)])
    low, high = 0.3 * float(np.nanmin(errors)), 4.0 * float(np.nanmax(errors))
    y = Axis(quantity, "", low, high, is_log=True, is_error=True)
    return Panel(x, y, lines, (Level("tolerance", tolerance),))
