"""The plant sketch: discs as high as their inertia is large, shafts, couplings, gears and joints in their places."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from torsion.output.figures.style import COLOURS, INK, plots, thinned

Look = tuple[tuple[str, Any], ...]
Points = list[tuple[float, float]]
MANY = 60  # points and links from which lines are drawn thinner, and only some are labelled
MOST_LABELS = 24  # of points, and of links, where there are many
ROW = 2.9  # distance of the rows, in the unit of the places
FILLS = {"motor": "#bcd5e8", "propeller": "#bfe3d5", "damper": "#ead2e0", "disc": "#dcdcdc"}


@dataclass(frozen=True)
class Disc:
    """A point of the train as it is drawn."""

    x: float
    row: float
    size: float  # 0..1 by the logarithm of the inertia
    label: str
    kind: str
    is_held: bool = False
    is_grounded: bool = False  # a spring to ground
    ring: float = 0.0  # size of a damper's ring


@dataclass(frozen=True)
class Link:
    """A link of the train as it is drawn."""

    kind: str  # shaft, coupling, gear, joint, rigid, tie (down to a branch)
    start: tuple[float, float]  # x, row
    end: tuple[float, float]
    label: str = ""
    bore: float = 0.0  # of a shaft: bore / diameter
    taper: tuple[float, float] = (1.0, 1.0)  # of a shaft: relative diameters at its ends
    ratio: float = 1.0  # of a gear: speed of the driven / speed of the driving wheel


class Pen:
    """Strokes and areas; those of one look become one element of the figure, in the order of the first of each."""

    def __init__(self, axes: Axes, thickness: float = 1.0) -> None:
        """thickness: by which all widths of lines are multiplied."""
        self.axes, self.thickness = axes, thickness
        self._strokes: dict[Look, list[Points]] = {}
        self._areas: dict[Look, list[Points]] = {}

    def stroke(self, x: Sequence[float], y: Sequence[float], **look: Any) -> None:
        """A line through places."""
        self._strokes.setdefault(tuple(look.items()), []).append(list(zip(x, y, strict=True)))

    def area(self, corners: Points, **look: Any) -> None:
        """A filled polygon."""
        self._areas.setdefault(tuple(look.items()), []).append(corners)

    def put(self) -> None:
        """Draw everything."""
        for look, lines in self._strokes.items():
            points = np.array([point for line in lines for point in [*line, (np.nan, np.nan)]][:-1])
            self.axes.plot(*points.T, **self._scaled(look))
        for look, areas in self._areas.items():
            outlines = [Path([*corners, corners[0]], closed=True) for corners in areas]
            self.axes.add_patch(PathPatch(Path.make_compound_path(*outlines), **self._scaled(look)))

    def _scaled(self, look: Look) -> dict[str, Any]:
        return {key: value * self.thickness if key in ("lw", "markersize") else value for key, value in look}


def sketch(sheet: Figure, *, points: Sequence[Mapping[str, Any]], links: Sequence[Mapping[str, Any]]) -> None:
    """The train from its driving end, branches on lower rows, not to scale: the fields of every Disc and Link."""
    discs, lines = [Disc(**point) for point in points], [Link(**link) for link in links]
    places = [(disc.x, disc.row) for disc in discs] + [end for link in lines for end in (link.start, link.end)]
    x, rows = [x for x, _ in places] or [0.0, 1.0], [0.0, *(row for _, row in places)]
    top, low, number = min(rows), max(rows), len(discs) + len(lines)
    (axes,) = plots(sheet, 0.55 + 1.45 * (1.0 + low - top))
    axes.axis("off")
    pen = Pen(axes, min(1.0, MANY / max(number, 1)) ** 0.5)
    for link in lines:
        DRAWINGS[link.kind](pen, link)
    for disc in discs:
        _disc(pen, disc)
    most = MOST_LABELS if number > MANY else number
    middles = [((line.start[0] + line.end[0]) / 2, line.end[1], line.label) for line in lines if line.label]
    _labels(pen, [(disc.x, disc.row, disc.label) for disc in discs], most, 0.65, va="bottom", color=INK)
    _labels(pen, middles, most, -0.55, va="top", color="#33506b")
    pen.put()
    axes.set_xlim(min(x) - 0.5, max(x) + 0.5)
    axes.set_ylim(_y(low) - 1.55, _y(top) + 1.5)


def _y(row: float) -> float:
    return -ROW * row


def _disc(pen: Pen, disc: Disc) -> None:
    y, half, thick = _y(disc.row), 0.25 + 0.55 * disc.size, 0.17
    if disc.is_held:
        _ground(pen, disc.x, y, 0.5, vertical=True)
        return
    if disc.ring:
        tall = half + 0.13 + 0.12 * disc.ring
        _box(pen, disc.x, y, thick + 0.14, tall, "white", ls="--", zorder=2.9)
    _box(pen, disc.x, y, thick, half, FILLS.get(disc.kind, FILLS["disc"]))
    if disc.is_grounded:
        _zigzag(pen, (disc.x, y - half), (disc.x, y - half - 0.45), 0.07)
        _ground(pen, disc.x, y - half - 0.45, 0.2, vertical=False)


def _box(pen: Pen, x: float, y: float, width: float, half: float, fill: str, **look: Any) -> None:
    """A rectangle around a place."""
    left, right = x - width / 2, x + width / 2
    corners = [(left, y - half), (right, y - half), (right, y + half), (left, y + half)]
    pen.area(corners, **{"facecolor": fill, "edgecolor": INK, "lw": 0.8, "zorder": 3, **look})


def _ground(pen: Pen, x: float, y: float, half: float, *, vertical: bool) -> None:
    marks = np.linspace(-half, half, 6)
    if vertical:
        pen.stroke([x, x], [y - half, y + half], color=INK, lw=1.4)
        for mark in marks:
            pen.stroke([x, x + 0.12], [y + mark, y + mark - 0.14], color=INK, lw=0.6)
    else:
        pen.stroke([x - half, x + half], [y, y], color=INK, lw=1.4)
        for mark in marks:
            pen.stroke([x + mark, x + mark - 0.07], [y, y - 0.13], color=INK, lw=0.6)


def _zigzag(pen: Pen, start: tuple[float, float], end: tuple[float, float], size: float = 0.16) -> None:
    """A spring between two places."""
    along = np.array([0.0, 0.2, 0.26, 0.38, 0.5, 0.62, 0.74, 0.8, 1.0])
    across = np.array([0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.0]) * size
    span = np.subtract(end, start)
    normal = np.array([-span[1], span[0]]) / max(float(np.hypot(*span)), 1e-9)
    points = np.array(start) + along[:, None] * span + across[:, None] * normal
    pen.stroke(points[:, 0].tolist(), points[:, 1].tolist(), color=INK, lw=0.9, solid_joinstyle="miter")


def _coupling(pen: Pen, link: Link) -> None:
    _zigzag(pen, (link.start[0], _y(link.start[1])), (link.end[0], _y(link.end[1])))


def _shaft(pen: Pen, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), (_y(link.start[1]), _y(link.end[1]))
    first, last = (0.12 * share for share in link.taper)
    corners = [(x0, y[0] - first), (x0, y[0] + first), (x1, y[1] + last), (x1, y[1] - last)]
    pen.area(corners, facecolor="#f3f3f3", edgecolor=INK, lw=0.8, zorder=2)
    for sign in (-1, 1) if link.bore else ():
        ends = [y[0] + sign * first * link.bore, y[1] + sign * last * link.bore]
        pen.stroke([x0, x1], ends, color=INK, lw=0.5, ls=(0, (3, 2)), zorder=3)


def _gear(pen: Pen, link: Link) -> None:
    """Two wheels that mesh; their heights follow the ratio."""
    (x0, row0), (x1, row1) = link.start, link.end
    small = 0.26
    driving, driven = (small, small / link.ratio) if link.ratio < 1 else (small * link.ratio, small)
    largest = max(driving, driven)
    driving, driven = (0.75 * half / largest if largest > 0.75 else half for half in (driving, driven))
    if row0 == row1:
        middle = (x0 + x1) / 2
        pen.stroke([x0, x1], [_y(row0), _y(row1)], color=INK, lw=1.1)
        _wheel(pen, middle - 0.08, _y(row0), max(driving, 0.16))
        _wheel(pen, middle + 0.08, _y(row1), max(driven, 0.16))
    else:
        pen.stroke([x0, x0, x1], [_y(row0), _y(row1), _y(row1)], color=INK, lw=0.7, ls=(0, (1, 2)))
        _wheel(pen, x1 - 0.1, _y(row1), max(driven, 0.16))


def _wheel(pen: Pen, x: float, y: float, half: float) -> None:
    _box(pen, x, y, 0.14, half, "#fbe3c8", lw=0.7, hatch="-----")


def _joint(pen: Pen, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), _y(link.start[1])
    middle = (x0 + x1) / 2
    pen.stroke([x0, middle - 0.14], [y, y], color=INK, lw=1.1)
    pen.stroke([middle + 0.14, x1], [y, y], color=INK, lw=1.1)
    for sign in (-1, 1):
        pen.stroke([middle - 0.14, middle + 0.14], [y - sign * 0.26, y + sign * 0.26], color=COLOURS[1], lw=1.8)
    pen.stroke([middle], [y], marker="o", ls="none", color="white", markeredgecolor=COLOURS[1], markersize=4, zorder=4)


def _line(pen: Pen, link: Link) -> None:
    (x0, row0), (x1, row1) = link.start, link.end
    style = {"rigid": "-", "tie": (0, (1, 2))}[link.kind]
    pen.stroke([x0, x0, x1], [_y(row0), _y(row1), _y(row1)], color=INK, lw=1.1, ls=style)


def _labels(pen: Pen, places: Sequence[tuple[float, float, str]], most: int, room: float, **look: Any) -> None:
    """Texts above their row, or below it where the room is negative, by turns on two heights: clear of neighbours."""
    side, number = np.sign(room), Counter[float]()
    for x, row, text in thinned(places, most):
        foot = _y(row) + 0.3 * side
        tip = foot + room + 0.28 * side * (number[row] % 2)
        number[row] += 1
        pen.axes.text(x, tip, text, ha="center", fontsize=7.5, **look)
        pen.stroke([x, x], [foot, tip], color="#bbbbbb", lw=0.4, zorder=0)


DRAWINGS = {"shaft": _shaft, "coupling": _coupling, "gear": _gear, "joint": _joint, "rigid": _line, "tie": _line}
