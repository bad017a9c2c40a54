"""A sheet in units of the layout of the train, on which its sketch is drawn."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.output.drawing.curves import outline
from torsion.output.drawing.grades import hatched
from torsion.output.drawing.pens import GRADES, INK, MARKED, Stroke
from torsion.output.figures.figure import Use

Points = Sequence[tuple[float, float]]
ROW = 2.9  # distance of the rows, in units of the layout
TALL = 45.0  # px of a unit down


@dataclass(frozen=True)
class Look:
    """Of strokes or areas that become one element, and how near they are."""

    stroke: Stroke
    fill: str = "none"
    near: float = 2.0


class Sheet:
    """Strokes and areas in units of the layout; those of one look become one element."""

    def __init__(self, across: float, left: float, thickness: float, down: float = TALL) -> None:
        """Set the scale; across, down: px of a unit; left: unit at the left edge; thickness: factor on widths of lines."""
        self.across, self.down, self.left, self.thickness = across, down, left, thickness
        self.drawn: dict[Look, list[str]] = {}

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return the px of a place; y goes up."""
        return (x - self.left) * self.across, -y * self.down

    def line(
        self, points: Points, width: float, dash: str = "", colour: str = INK, near: float = 2.0
    ) -> None:
        """Draw a line through places in units of the layout."""
        look = Look(Stroke(colour, width * self.thickness, dash), near=near)
        self.drawn.setdefault(look, []).append(self._path(points))

    def area(
        self, points: Points, fill: str, width: float, dash: str = "", near: float = 3.0
    ) -> None:
        """Draw a filled polygon in units of the layout."""
        look = Look(Stroke(INK, width * self.thickness, dash), fill, near)
        self.drawn.setdefault(look, []).append(self._path(points) + "z")

    def graded(self, corners: Points, use: Use | None, *, near: float) -> None:
        """Draw a polygon in the colour and the pattern of a grade, if there is one.

        Its hatching fills the middle of its corners' heights.
        """
        if use is None:
            return
        self.area(corners, GRADES[use.grade].fill, 1.1, near=near)
        places = np.array([[10.0 * length for length in self.at(x, y)] for x, y in corners])
        x, y = np.sort(places[:, 0]), np.sort(places[:, 1])
        look, path = hatched((x[1], y[1], x[2], y[2]), use.grade)
        if path:
            self.drawn.setdefault(Look(look, near=near + 0.05), []).append(path)
        if use.mark:
            self.drawn.setdefault(Look(MARKED, near=5.0), []).append(self._path(corners) + "z")

    def _path(self, points: Points) -> str:
        places = np.rint([[10.0 * length for length in self.at(x, y)] for x, y in points]).astype(
            np.int64
        )
        return outline([places[0].tolist(), *np.diff(places, axis=0).tolist()])

    def elements(self) -> list[str]:
        """Return the elements from the farthest to the nearest."""
        return [
            f'<path d="{"".join(paths)}" fill="{look.fill}" {look.stroke.attributes(10.0)}/>'
            for look, paths in sorted(self.drawn.items(), key=lambda item: item[0].near)
        ]


def height(row: float) -> float:
    """Return the units up of the axis of a row."""
    return -ROW * row
