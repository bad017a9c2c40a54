"""One quantity in all cases of a file over the speed, one line a case."""

from collections.abc import Mapping

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Figure, Line, Panel
from torsion.output.figures.ranges import MAIN, MOST_LINES, SPEED, amplitudes, span

Curve = tuple[
    FloatArray, FloatArray
]  # (points,) rpm, (points,) values; NaN where there is no answer


def curves(name: str, caption: str, drawn: Mapping[str, Curve], quantity: str, unit: str) -> Figure:
    """Draw one line a case, the first heavier; of many cases it and those that reach highest."""
    first, *highest_cases = drawn
    highest_cases = sorted(
        highest_cases, key=lambda key: -float(np.nanmax(np.append(drawn[key][1], 0.0)))
    )[: MOST_LINES - 1]
    chosen = [key for key in drawn if key == first or key in highest_cases]
    lines = tuple(
        Line(key, *drawn[key], pen, weight=MAIN if key == first else 1.0)
        for pen, key in enumerate(chosen)
    )
    x = span(SPEED, np.concatenate([line.x for line in lines]))
    return Figure(
        name, caption, (Panel(x, amplitudes(quantity, unit, [line.y for line in lines]), lines),)
    )
