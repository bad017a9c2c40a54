"""The sketch of the train as SVG: discs as high as their inertia is large, shafts, couplings, gears and joints."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.output.drawing.curves import outline
from torsion.output.drawing.frame import MIDDLE, WIDTH
from torsion.output.drawing.pens import COLOURS, INK, Stroke
from torsion.output.drawing.text import shown, words
from torsion.output.drawing.words import SIZE, Room
from torsion.output.figures.figure import Disc, Link, Sketch
from torsion.output.figures.mode_shape import thinned

Points = Sequence[tuple[float, float]]
MANY = 60  # points and links from which lines are drawn thinner, and only some have words
MOST_LABELS = 24  # of points, and of links, where there are many
ROW = 2.9  # distance of the rows, in units of the layout
TALL, WIDEST = 45.0, 95.0  # px of a unit down, and at most across
LETTERS = 0.95  # units from the axis to the words
MOST_ROWS = 8  # of words above or below an axis
FILLS = {"motor": "#bcd5e8", "propeller": "#bfe3d5", "damper": "#ead2e0", "disc": "#dcdcdc"}
DOTTED = "1.6 2"


@dataclass(frozen=True)
class Look:
    """Of strokes or areas that become one element, and how near they are."""

    stroke: Stroke
    fill: str = "none"
    near: float = 2.0


class Sheet:
    """Strokes and areas in units of the layout; those of one look become one element."""

    def __init__(self, across: float, left: float, thickness: float) -> None:
        """across: px of a unit; left: unit at the left edge; thickness: by which widths of lines are multiplied."""
        self.across, self.left, self.thickness = across, left, thickness
        self.drawn: dict[Look, list[str]] = {}

    def at(self, x: float, y: float) -> tuple[float, float]:
        """px of a place; y goes up."""
        return (x - self.left) * self.across, -y * TALL

    def line(self, points: Points, width: float, dash: str = "", colour: str = INK, near: float = 2.0) -> None:
        """A line through places."""
        look = Look(Stroke(colour, width * self.thickness, dash), near=near)
        self.drawn.setdefault(look, []).append(self._path(points))

    def area(self, points: Points, fill: str, width: float, dash: str = "", near: float = 3.0) -> None:
        """A filled polygon."""
        look = Look(Stroke(INK, width * self.thickness, dash), fill, near)
        self.drawn.setdefault(look, []).append(self._path(points) + "z")

    def _path(self, points: Points) -> str:
        places = np.rint([[10.0 * one for one in self.at(x, y)] for x, y in points]).astype(np.int64)
        return outline([places[0].tolist(), *np.diff(places, axis=0).tolist()])

    def elements(self) -> list[str]:
        """From the farthest to the nearest."""
        return [
            f'<path d="{"".join(paths)}" fill="{look.fill}" {look.stroke.attributes(10.0)}/>'
            for look, paths in sorted(self.drawn.items(), key=lambda item: item[0].near)
        ]


def drawn(sketch: Sketch, top: float) -> tuple[float, str]:
    """Height in px and elements of the sketch below `top`."""
    places = [(one.x, one.row) for one in sketch.discs] + [end for one in sketch.links for end in (one.start, one.end)]
    x, rows = [x for x, _ in places] or [0.0, 1.0], [0.0, *(row for _, row in places)]
    number, wide = len(sketch.discs) + len(sketch.links), max(x) - min(x) + 1.0
    across = min(WIDTH / wide, WIDEST)
    sheet = Sheet(across, min(x) - 0.5 - (WIDTH / across - wide) / 2, min(1.0, MANY / max(number, 1)) ** 0.5)
    for link in sketch.links:
        DRAWINGS[link.kind](sheet, link)
    for disc in sketch.discs:
        _disc(sheet, disc)
    most = MOST_LABELS if number > MANY else number
    room = Room((-9e9, -9e9, 9e9, 9e9), np.zeros((0, 2)))
    middles = [((one.start[0] + one.end[0]) / 2, one.end[1], one.label) for one in sketch.links if one.label]
    discs = [(one.x, one.row, one.label) for one in sketch.discs if one.label]
    texts = _labels(sheet, room, discs, most, 1) + _labels(sheet, room, middles, most, -1)
    ends = [room_[1] for room_ in room.taken] + [sheet.at(0, _y(min(rows)) + LETTERS)[1]]
    feet = [room_[3] for room_ in room.taken] + [sheet.at(0, _y(max(rows)) - LETTERS)[1]]
    upper, lower = min(ends) - 3.0, max(feet) + 3.0
    body = f'<g transform="scale(.1)">{"".join(sheet.elements())}</g><g font-size="{SIZE:g}">{"".join(texts)}</g>'
    scale = f'data-left="{sheet.left:.6g}" data-across="{across:.6g}" data-row="{ROW * TALL:g}"'  # of a moving mode
    return lower - upper, f'<g class="sketch" {scale} transform="translate(0 {shown(top - upper)})">{body}</g>'


def _y(row: float) -> float:
    return -ROW * row


def _disc(sheet: Sheet, disc: Disc) -> None:
    y, half, thick = _y(disc.row), 0.25 + 0.55 * disc.size, 0.17
    if disc.is_held:
        _ground(sheet, disc.x, y, 0.5, vertical=True)
        return
    if disc.ring:
        tall = half + 0.13 + 0.12 * disc.ring
        _box(sheet, (disc.x, y), thick + 0.14, tall, "#ffffff", dash="4 2", near=2.9)
    _box(sheet, (disc.x, y), thick, half, FILLS.get(disc.kind, FILLS["disc"]))
    if disc.is_grounded:
        _zigzag(sheet, (disc.x, y - half), (disc.x, y - half - 0.45), 0.07)
        _ground(sheet, disc.x, y - half - 0.45, 0.2, vertical=False)


def _box(
    sheet: Sheet, place: tuple[float, float], width: float, half: float, fill: str, *, dash: str = "", near: float = 3.0
) -> None:
    """A rectangle around a place."""
    left, right, y = place[0] - width / 2, place[0] + width / 2, place[1]
    sheet.area([(left, y - half), (right, y - half), (right, y + half), (left, y + half)], fill, 1.1, dash, near)


def _ground(sheet: Sheet, x: float, y: float, half: float, *, vertical: bool) -> None:
    marks = np.linspace(-half, half, 6).tolist()
    sheet.line([(x, y - half), (x, y + half)] if vertical else [(x - half, y), (x + half, y)], 1.8)
    for mark in marks:
        first, last = (
            ((x, y + mark), (x + 0.12, y + mark - 0.14)) if vertical else ((x + mark, y), (x + mark - 0.07, y - 0.13))
        )
        sheet.line([first, last], 0.8)


def _zigzag(sheet: Sheet, start: tuple[float, float], end: tuple[float, float], size: float = 0.16) -> None:
    """A spring between two places."""
    along = np.array([0.0, 0.2, 0.26, 0.38, 0.5, 0.62, 0.74, 0.8, 1.0])
    across = np.array([0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.0]) * size
    span = np.subtract(end, start)
    normal = np.array([-span[1], span[0]]) / max(float(np.hypot(*span)), 1e-9)
    points = np.array(start) + along[:, None] * span + across[:, None] * normal
    sheet.line([(x, y) for x, y in points.tolist()], 1.2)


def _coupling(sheet: Sheet, link: Link) -> None:
    _zigzag(sheet, (link.start[0], _y(link.start[1])), (link.end[0], _y(link.end[1])))


def _shaft(sheet: Sheet, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), (_y(link.start[1]), _y(link.end[1]))
    first, last = (0.12 * share for share in link.taper)
    corners = [(x0, y[0] - first), (x0, y[0] + first), (x1, y[1] + last), (x1, y[1] - last)]
    sheet.area(corners, "#f3f3f3", 1.1, near=2.0)
    for sign in (-1, 1) if link.bore else ():
        ends = [(x0, y[0] + sign * first * link.bore), (x1, y[1] + sign * last * link.bore)]
        sheet.line(ends, 0.7, "3 2", near=3.0)


def _run(sheet: Sheet, link: Link) -> None:
    """Very many components: a row of thin discs with a break in the middle."""
    (x0, row), (x1, _), y = link.start, link.end, _y(link.start[1])
    cut, wide = 0.08 * (x1 - x0), x1 - x0
    middle = (x0 + x1) / 2
    for first, last in ((x0, middle - cut / 2), (middle + cut / 2, x1)):
        sheet.line([(first, y), (last, y)], 1.4)
    for share in (0.12, 0.24, 0.36, 0.64, 0.76, 0.88):
        _box(sheet, (x0 + share * wide, _y(row)), 0.1, 0.35, FILLS["disc"])
    for side in (-0.5, 0.5):
        sheet.line([(middle + side * cut - 0.05, y - 0.3), (middle + side * cut + 0.05, y + 0.3)], 1.2)


def _gear(sheet: Sheet, link: Link) -> None:
    """Two wheels that mesh; their heights follow the ratio."""
    (x0, row0), (x1, row1) = link.start, link.end
    small = 0.26
    driving, driven = (small, small / link.ratio) if link.ratio < 1 else (small * link.ratio, small)
    largest = max(driving, driven)
    driving, driven = (0.75 * half / largest if largest > 0.75 else half for half in (driving, driven))
    if row0 == row1:
        middle = (x0 + x1) / 2
        sheet.line([(x0, _y(row0)), (x1, _y(row1))], 1.4)
        _wheel(sheet, middle - 0.08, _y(row0), max(driving, 0.16))
        _wheel(sheet, middle + 0.08, _y(row1), max(driven, 0.16))
    else:
        sheet.line([(x0, _y(row0)), (x0, _y(row1)), (x1, _y(row1))], 0.9, DOTTED)
        _wheel(sheet, x1 - 0.1, _y(row1), max(driven, 0.16))


def _wheel(sheet: Sheet, x: float, y: float, half: float) -> None:
    """A wheel with its teeth."""
    _box(sheet, (x, y), 0.14, half, "#fbe3c8")
    for tooth in np.arange(-half + 0.08, half - 0.04, 0.08).tolist():
        sheet.line([(x - 0.07, y + tooth), (x + 0.07, y + tooth)], 0.7, near=3.1)


def _joint(sheet: Sheet, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), _y(link.start[1])
    middle = (x0 + x1) / 2
    for ends in ((x0, middle - 0.14), (middle + 0.14, x1)):
        sheet.line([(x, y) for x in ends], 1.4)
    for sign in (-1, 1):
        sheet.line([(middle - 0.14, y - sign * 0.26), (middle + 0.14, y + sign * 0.26)], 2.2, colour=COLOURS[1])
    sheet.area(
        [(middle - 0.04, y), (middle, y + 0.07), (middle + 0.04, y), (middle, y - 0.07)], "#ffffff", 1.1, near=4.0
    )


def _line(sheet: Sheet, link: Link) -> None:
    (x0, row0), (x1, row1) = link.start, link.end
    sheet.line([(x0, _y(row0)), (x0, _y(row1)), (x1, _y(row1))], 1.4, {"rigid": "", "tie": DOTTED}[link.kind])


def _labels(sheet: Sheet, room: Room, places: Sequence[tuple[float, float, str]], most: int, side: int) -> list[str]:
    """Texts above their axis (side 1) or below it, clear of each other, each with a line to its component."""
    found, colour = [], INK if side > 0 else "#33506b"
    for x, row, text in thinned(places, most):
        at, tip = sheet.at(x, _y(row) + side * LETTERS)
        word = room.place(text, np.array([[at, tip]]), gap=0.0, ways=(0,) if side > 0 else (5,), reach=MOST_ROWS)
        if word is not None:
            left, upper, right, lower = word.box
            foot, end = sheet.at(x, _y(row) + 0.3 * side)[1], lower if side > 0 else upper
            found.append(f'<path d="M{shown(at)} {shown(foot)}V{shown(end)}" stroke="#bbbbbb" stroke-width=".6"/>')
            found.append(words((left + right) / 2, (upper + lower) / 2 + 3.7, text, f'{MIDDLE} fill="{colour}"'))
    return found


DRAWINGS = {
    "shaft": _shaft,
    "coupling": _coupling,
    "gear": _gear,
    "joint": _joint,
    "rigid": _line,
    "tie": _line,
    "run": _run,
}
