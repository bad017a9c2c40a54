"""Universal joints: quantities over the revolution of the driving shaft."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import MOST_LINES, Lines, span

Drawn = tuple[str, str, float, Lines]  # quantity, unit, the size rounding is judged by, lines
WEIGHTS = (2.0, 1.1)  # of the first and the last line, so that lines that coincide are both seen
FLAT = 1e-9  # of the size by which rounding is judged: a smaller range is shown as a level line


def joint_turn(
    name: str, caption: str, *, angle: FloatArray, panels: Sequence[Drawn], quantity: str
) -> Figure:
    """angle: (angles,) deg, `quantity` says of which shaft; a line is (name, (angles,)) and keeps its pen."""
    names = list(dict.fromkeys(words for *_, lines in panels for words, _ in lines))[:MOST_LINES]
    weights = np.linspace(*WEIGHTS, max(len(names), 2)).tolist()
    x, made = span(Axis(quantity, "deg"), angle), []
    for says, unit, size, lines in panels:
        kept = [(words, values) for words, values in lines if words in names]
        drawn = tuple(
            Line(
                words,
                angle,
                values,
                names.index(words),
                words if len(kept) > 2 else "",
                "anywhere",
                weight=weights[names.index(words)],
            )
            for words, values in kept
        )
        made.append(
            Panel(x, _range(says, unit, size, kept), drawn, (Level("", 0.0, "zero"),), height=72.0)
        )
    return Figure(name, caption, tuple(made))


def _range(quantity: str, unit: str, size: float, lines: Lines) -> Axis:
    """The axis, which keeps rounding from filling a plot whose values do not vary."""
    low, high = (float(end([end(values) for _, values in lines])) for end in (np.min, np.max))
    if high - low > FLAT * size:
        return Axis(quantity, unit)
    room = (
        0.1 * max(abs(low), size) or 1.0
    )  # of values and a size that are all nothing: any, so that it is a range
    return Axis(quantity, unit, low - room, high + room)
