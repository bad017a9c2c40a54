"""Figures of the pages: curves over one axis, in panels above each other, drawn in the look of the program's own."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.output.drawing.svg import svg
from torsion.output.figures import figure
from torsion.output.figures.figure import Axis, Figure, Line, Marks

Array = NDArray[np.float64]
DRAWN = 8  # digits: the file is the same wherever it is drawn
INCH = 96.0  # px


@dataclass(frozen=True)
class Panel:
    """One plot: what its axis says, its lines by label, points with words (x, y, words), and dots (label, x, y)."""

    axis: str
    lines: Sequence[tuple[str, ArrayLike]]
    marks: Sequence[tuple[float, float, str]] = field(default=())
    dots: Sequence[tuple[str, ArrayLike, ArrayLike]] = field(default=())


def curves(name: str, x: Array, along: str, panels: Sequence[Panel], *, height: float = 1.9) -> str:
    """SVG of lines over x; a line keeps its pen from panel to panel. height: of a panel, inch."""
    labels = list(dict.fromkeys(label for panel in panels for label, _ in panel.lines))
    unit = "deg" if along.endswith(", degrees") else ""
    axis = Axis(along.removesuffix(", degrees"), unit, float(x[0]), float(x[-1]))
    return svg(
        Figure(
            name,
            name.replace("_", " "),
            tuple(_panel(panel, x, axis, labels, height) for panel in panels),
        )
    )


def _panel(panel: Panel, x: Array, axis: Axis, labels: list[str], height: float) -> figure.Panel:
    lines = tuple(
        Line(
            label,
            x,
            np.broadcast_to(np.round(np.asarray(values, dtype=float), DRAWN), x.shape),
            labels.index(label),
        )
        for label, values in panel.lines
    )
    marks = [
        Marks("", *(np.array([one]) for one in place), labels=(words,))
        for *place, words in panel.marks
    ]
    for label, *places in panel.dots:
        marks.append(
            Marks(label, *(np.round(np.asarray(one, dtype=float), DRAWN) for one in places), "dot")
        )
    return figure.Panel(
        axis, Axis(panel.axis), lines, marks=tuple(marks), height=INCH * height - 30.0
    )
