"""Relative errors on logarithmic axes: of every mode, of torques over the speed, and of every method over run time."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Marks, Panel, Symbol
from torsion.output.figures.ranges import SPEED, Lines, span

# name, family, degree or number of the method among its like; (points,) ms median, quartiles; error
Curve = tuple[str, str, int, FloatArray, FloatArray, FloatArray, FloatArray]
LEAST = 1.2e-16  # an error below half the rounding unit is drawn there: it is rounding
SYMBOLS: tuple[Symbol, ...] = ("disc", "square", "triangle", "diamond")
SIGNS: tuple[Symbol, ...] = (  # of methods of integration, in turn
    *SYMBOLS,
    "down",
    "box",
    "cross",
    "open triangle",
    "plus",
    "open diamond",
)
FAMILIES: dict[str, tuple[Symbol, float]] = {  # symbol, and weight of the line
    "lumped": ("disc", 1.4),
    "fem": ("dot", 0.8),
    "exact": ("star", 0.0),
    "modal": ("triangle", 1.0),
    "corrected": ("down", 1.0),
    "dense": ("cross", 1.2),
    "peer": ("square", 1.0),
}
TOLERANCE = "tolerance"


def modes(name: str, caption: str, *, frequency: Lines, shape: Lines, tolerance: float) -> Figure:
    """frequency, shape: (model, (modes,) magnitudes of relative errors); shape is 1 - MAC."""
    x = Axis("mode", "", 0.5, max(len(values) for _, values in frequency) + 0.5, is_whole=True)
    both = (("error of frequency", frequency), ("1 − MAC", shape))
    return Figure(
        name,
        caption,
        tuple(
            Panel(
                x,
                _around(quantity, errors, tolerance),
                tuple(
                    Line(
                        model,
                        np.arange(1.0, len(values) + 1),
                        drawn_error(values),
                        k,
                        symbol=SYMBOLS[k % len(SYMBOLS)],
                    )
                    for k, (model, values) in enumerate(errors)
                ),
                (Level(TOLERANCE, tolerance),),
                height=130.0,
            )
            for quantity, errors in both
        ),
    )


def torques(
    name: str, caption: str, *, speed: FloatArray, lines: Lines, tolerance: float
) -> Figure:
    """speed: (speeds,) rpm; lines: (model, (speeds,)), NaN where there is none."""
    drawn = tuple(
        Line(model, speed, drawn_error(values), k) for k, (model, values) in enumerate(lines)
    )
    levels = (Level(TOLERANCE, tolerance),)
    return Figure(
        name,
        caption,
        (Panel(span(SPEED, speed), _around("error of torques", lines, tolerance), drawn, levels),),
    )


def run_times(
    name: str,
    caption: str,
    *,
    curves: Sequence[Curve],
    tolerance: float,
    bound: float,
    best: tuple[float, float] | None = None,
) -> Figure:
    """tolerance, bound (of the reference): relative errors; best: time (ms) and error of the recommended point."""
    words = "run time: median of assembly and solve together; ranges: the middle half of the runs"
    found = error_over_time(Axis(words, "ms", is_log=True), "relative error", curves, bound)
    ring = []
    if best is not None:
        ring.append(
            Marks(
                "recommended", np.array([best[0]]), np.array([max(best[1], LEAST)]), "ring", "best"
            )
        )
    levels = (Level(TOLERANCE, tolerance, "natural"),)
    return Figure(
        name,
        caption,
        (Panel(found.x, found.y, found.lines, levels, found.bands, tuple(ring), height=320.0),),
    )


def error_over_time(x: Axis, quantity: str, curves: Sequence[Curve], bound: float = 0.0) -> Panel:
    """One curve a method, one point a discretisation; grey where the reference itself is in doubt."""
    lines = []
    for pen, (name, family, degree, time, low, high, error) in enumerate(curves):
        symbol, weight = FAMILIES.get(family, (SIGNS[degree % len(SIGNS)], 0.8))
        gap = np.full_like(time, np.nan)
        lines.append(Line(name, time, drawn_error(error), pen, symbol=symbol, weight=weight))
        spread = np.column_stack([low, high, gap]).ravel(), np.repeat(drawn_error(error), 3)
        lines.append(Line("", *spread, pen, weight=0.5))
    least, largest = LEAST / 3.0, max((float(curve[6].max()) for curve in curves), default=1.0)
    doubt = Band("below the bound of the reference", least, max(bound, LEAST), "doubt", "y")
    y = Axis(quantity, "", least, max(10.0 * largest, 1.0), is_log=True, is_error=True)
    return Panel(x, y, tuple(lines), bands=(doubt,), height=270.0)


def drawn_error(values: FloatArray) -> FloatArray:
    """What is rounding, at its lowest place; what is no number or infinite, nowhere."""
    return np.where(np.isfinite(values), np.maximum(values, LEAST), np.nan)


def _around(quantity: str, errors: Lines, tolerance: float) -> Axis:
    """The axis from the smallest error, or from rounding, to beyond the tolerance."""
    known = np.concatenate([drawn_error(values) for _, values in errors])
    known = known[np.isfinite(known)]
    low, high = 0.3 * float(known.min(initial=tolerance)), 4.0 * float(known.max(initial=tolerance))
    return Axis(quantity, "", low, high, is_log=True, is_error=True)
