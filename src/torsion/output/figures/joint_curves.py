"""Universal joints: quantities over the revolution of the driving shaft."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import MOST_LINES, Lines, span

Drawn = tuple[Axis, float, Lines]  # axis, the size by which rounding is judged, lines
WEIGHTS = (2.0, 1.1)  # of the first and the last line, so that lines that coincide are both seen
FLAT = 1e-9  # of the size by which rounding is judged: a smaller range is shown as a level line


def joint_turn(
    name: str, caption: str, angle: FloatArray, panels: Sequence[Drawn], joint: str
) -> Figure:
    """Draw lines (name, (angles,)), each with its pen, over the angle (rad) of the shaft upstream of a joint."""
    names = list(dict.fromkeys(words for *_, lines in panels for words, _ in lines))[:MOST_LINES]
    weights = np.linspace(*WEIGHTS, max(len(names), 2)).tolist()
    turn, made = np.degrees(angle), []
    x = span(Axis(f"angle of the shaft upstream of {joint}", "deg"), turn)
    for axis, size, lines in panels:
        kept = [(names.index(words), words, values) for words, values in lines if words in names]
        drawn = tuple(
            Line(words, turn, y, k, words * (len(kept) > 2), "anywhere", weight=weights[k])
            for k, words, y in kept
        )
        low, high = (float(end([end(y) for *_, y in kept])) for end in (np.min, np.max))
        # Rounding is kept from filling a plot whose values do not vary.
        room = 0.1 * max(abs(low), size) or 1.0
        flat = replace(axis, low=low - room, high=high + room)
        y_axis = axis if high - low > FLAT * size else flat
        made.append(Panel(x, y_axis, drawn, (Level("", 0.0, "zero"),), height=72.0))
    return Figure(name, caption, tuple(made))
