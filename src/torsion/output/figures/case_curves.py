"""The same quantity in all cases of a file: one line a case over the speed, and frequencies over the cases."""

from collections.abc import Mapping, Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Line, Panel
from torsion.output.figures.ranges import MAIN, MOST_LINES, SPEED, amplitudes, span

WIDE = 10.0  # times the lowest frequency: with a higher one the axis is logarithmic
Curve = tuple[FloatArray, FloatArray]  # (points,) rpm, (points,) values; NaN where there is no answer


def curves(name: str, caption: str, drawn: Mapping[str, Curve], quantity: str, unit: str) -> Figure:
    """One line a case, the first heavier; of many cases it and those that reach highest."""
    first, *others = drawn
    others = sorted(others, key=lambda key: -float(np.nanmax(np.append(drawn[key][1], 0.0))))[: MOST_LINES - 1]
    chosen = [key for key in drawn if key == first or key in others]
    lines = tuple(Line(key, *drawn[key], pen, weight=MAIN if key == first else 1.0) for pen, key in enumerate(chosen))
    x = span(SPEED, np.concatenate([line.x for line in lines]))
    return Figure(name, caption, (Panel(x, amplitudes(quantity, unit, [line.y for line in lines]), lines),))


def frequencies(name: str, caption: str, cases: Sequence[str], values: FloatArray) -> Figure:
    """values: (cases, modes) Hz, NaN where a case has fewer modes."""
    at = np.arange(len(cases), dtype=float)
    lines = tuple(
        Line(f"mode {mode + 1}", at, column, mode, symbol="dot") for mode, column in enumerate(values.T[:MOST_LINES])
    )
    x = Axis("case", low=-0.5, high=len(cases) - 0.5, places=tuple(zip(at.tolist(), cases, strict=True)))
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    is_log = high > WIDE * low
    y = Axis("natural frequency", "Hz", low / 1.5 if is_log else 0.0, 1.5 * high if is_log else None, is_log=is_log)
    return Figure(name, caption, (Panel(x, y, lines, height=150.0),))
