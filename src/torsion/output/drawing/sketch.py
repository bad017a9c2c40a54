"""The sketch of the train as SVG: discs as high as their inertia is large, shafts, couplings, gears and joints."""

import numpy as np

from torsion.output.drawing import sketch_words
from torsion.output.drawing.frame import WIDTH
from torsion.output.drawing.grades import key
from torsion.output.drawing.pens import COLOURS
from torsion.output.drawing.sheet import ROW, TALL, Points, Sheet, height
from torsion.output.drawing.text import shown
from torsion.output.drawing.words import SIZE
from torsion.output.figures.figure import Disc, Link, Sketch

MANY = 60  # points and links from which lines are drawn thinner
WIDEST = 95.0  # px of a unit across, at most
WEB, PIN = (
    0.42,
    0.3,
)  # units: height of a crank's pin above the axis, and half the way between its webs
JOINT = 0.24  # units: half width of the area behind a joint
GRADED, BED = (
    0.18,
    0.27,
)  # units: half thickness of a shaft, and of the area behind a coupling, that has a grade
FILLS = {  # by the role that the class of a component states
    "driver": "#bcd5e8",
    "load": "#cfe0b8",
    "fluid": "#bfe3d5",
    "absorber": "#ead2e0",
    "throw": "#e3ddc6",
    "": "#dcdcdc",
}
DOTTED = "1.6 2"


def drawn(sketch: Sketch, top: float) -> tuple[float, str]:
    """Return height in px and elements of the sketch below `top`."""
    sheet = _sheet(sketch)
    for link in sketch.links:
        DRAWINGS[link.kind](sheet, link)
    for disc in sketch.discs:
        _disc(sheet, disc)
    spread, texts = sketch_words.place_words(sheet, sketch)
    upper, lower = spread[0] - 3.0, spread[1] + 3.0
    below, legend = key(
        [link.use for link in sketch.links if link.use is not None], lower - upper + top
    )
    body = f'<g transform="scale(.1)">{"".join(sheet.elements())}</g><g font-size="{SIZE:g}">{"".join(texts)}</g>'
    scale = f'data-left="{sheet.left:.6g}" data-across="{sheet.across:.6g}" data-row="{ROW * sheet.down:g}"'  # of modes
    placed = f'<g class="sketch" {scale} transform="translate(0 {shown(top - upper)})">{body}</g>{legend}'
    return lower - upper + below, placed


def _sheet(sketch: Sketch) -> Sheet:
    """Return a sheet as wide as the figure, or less if the train is short."""
    places = [(disc.x, disc.row) for disc in sketch.discs] + [
        end for link in sketch.links for end in (link.start, link.end)
    ]
    x, rows = [x for x, _ in places] or [0.0, 1.0], [row for _, row in places] or [0.0]
    number, wide = len(sketch.discs) + len(sketch.links), max(x) - min(x) + 1.0
    across, thickness = min(WIDTH / wide, WIDEST), min(1.0, MANY / max(number, 1)) ** 0.5
    high, left = ROW * (max(rows) - min(rows)), min(x) - 0.5 - (WIDTH / across - wide) / 2
    down = TALL if sketch.height is None or not high else min(TALL, sketch.height / high)
    return Sheet(across, left, thickness, down)


def _disc(sheet: Sheet, disc: Disc) -> None:
    y, half, thick = height(disc.row), 0.25 + 0.55 * disc.size, 0.17
    if disc.is_held:
        _ground(sheet, disc.x, y, 0.5, vertical=True)
        return
    if disc.ring:
        tall = half + 0.13 + 0.12 * disc.ring
        _box(sheet, (disc.x, y), thick + 0.14, tall, "#ffffff", dash="4 2", near=2.9)
    _box(sheet, (disc.x, y), thick, half, FILLS[disc.role])
    if disc.is_grounded:
        _zigzag(sheet, (disc.x, y - half), (disc.x, y - half - 0.45), 0.07)
        _ground(sheet, disc.x, y - half - 0.45, 0.2, vertical=False)


def _box(
    sheet: Sheet,
    middle: tuple[float, float],
    width: float,
    half: float,
    fill: str,
    *,
    dash: str = "",
    near: float = 3.0,
) -> None:
    """Draw a rectangle around a place, as wide and half as high as given."""
    left, right, y = middle[0] - width / 2, middle[0] + width / 2, middle[1]
    sheet.area(_corners(left, right, y, half), fill, 1.1, dash, near)


def _ground(sheet: Sheet, x: float, y: float, half: float, *, vertical: bool) -> None:
    marks = np.linspace(-half, half, 6).tolist()
    sheet.line([(x, y - half), (x, y + half)] if vertical else [(x - half, y), (x + half, y)], 1.8)
    for mark in marks:
        first, last = (
            ((x, y + mark), (x + 0.12, y + mark - 0.14))
            if vertical
            else ((x + mark, y), (x + mark - 0.07, y - 0.13))
        )
        sheet.line([first, last], 0.8)


def _zigzag(
    sheet: Sheet, start: tuple[float, float], end: tuple[float, float], size: float = 0.16
) -> None:
    """Draw a spring as a zigzag between two places."""
    along = np.array([0.0, 0.2, 0.26, 0.38, 0.5, 0.62, 0.74, 0.8, 1.0])
    across = np.array([0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.0]) * size
    span = np.subtract(end, start)
    normal = np.array([-span[1], span[0]]) / max(float(np.hypot(*span)), 1e-9)
    points = np.array(start) + along[:, None] * span + across[:, None] * normal
    sheet.line([(x, y) for x, y in points.tolist()], 1.2)


def _coupling(sheet: Sheet, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), (height(link.start[1]), height(link.end[1]))
    edge = 0.18 * (x1 - x0)
    sheet.graded(_corners(x0 + edge, x1 - edge, sum(y) / 2, BED), link.use, near=1.5)
    _zigzag(sheet, (x0, y[0]), (x1, y[1]))


def _crank(sheet: Sheet, link: Link) -> None:
    """Draw two webs and the pin between them, off the axis."""
    (x0, x1), y = (link.start[0], link.end[0]), height(link.start[1])
    middle, top = (x0 + x1) / 2, y + WEB
    webs = (middle - PIN * (x1 - x0), middle + PIN * (x1 - x0))
    sheet.graded(_corners(*webs, y + WEB / 2, BED), link.use, near=1.5)
    for first, last in ((x0, webs[0]), (webs[1], x1)):
        sheet.line([(first, y), (last, y)], 1.4)
    for x in webs:
        _box(sheet, (x, y + WEB / 2), 0.1, BED, "#f3f3f3")
    sheet.line([(webs[0] + 0.05, top), (webs[1] - 0.05, top)], 2.2)


def _corners(left: float, right: float, y: float, half: float) -> Points:
    return [(left, y - half), (right, y - half), (right, y + half), (left, y + half)]


def _shaft(sheet: Sheet, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), (height(link.start[1]), height(link.end[1]))
    first, last = ((0.12 if link.use is None else GRADED) * share for share in link.taper)
    corners = [(x0, y[0] - first), (x0, y[0] + first), (x1, y[1] + last), (x1, y[1] - last)]
    if link.use is None:
        sheet.area(corners, "#f3f3f3", 1.1, near=2.0)
    else:
        sheet.graded(corners, link.use, near=2.0)
    for sign in (-1, 1) if link.bore else ():
        ends = [(x0, y[0] + sign * first * link.bore), (x1, y[1] + sign * last * link.bore)]
        sheet.line(ends, 0.7, "3 2", near=3.0)


def _gear(sheet: Sheet, link: Link) -> None:
    """Draw two wheels that mesh; their heights follow the ratio."""
    (x0, row0), (x1, row1) = link.start, link.end
    small = 0.26
    driving, driven = (small, small / link.ratio) if link.ratio < 1 else (small * link.ratio, small)
    largest = max(driving, driven)
    driving, driven = (
        0.75 * half / largest if largest > 0.75 else half for half in (driving, driven)
    )
    if row0 == row1:
        middle = (x0 + x1) / 2
        half = max(driving, driven, 0.16) + 0.12
        sheet.graded(_corners(x0, x1, height(row0), half), link.use, near=1.5)
        sheet.line([(x0, height(row0)), (x1, height(row1))], 1.4)
        _wheel(sheet, middle - 0.08, height(row0), max(driving, 0.16))
        _wheel(sheet, middle + 0.08, height(row1), max(driven, 0.16))
    else:
        sheet.line([(x0, height(row0)), (x0, height(row1)), (x1, height(row1))], 0.9, DOTTED)
        half = max(driven, 0.16) + 0.12
        sheet.graded(_corners(x1 - 0.3, x1 + 0.1, height(row1), half), link.use, near=1.5)
        _wheel(sheet, x1 - 0.1, height(row1), max(driven, 0.16))


def _wheel(sheet: Sheet, x: float, y: float, half: float) -> None:
    """Draw a wheel with its teeth around a place."""
    _box(sheet, (x, y), 0.14, half, "#fbe3c8")
    for tooth in np.arange(-half + 0.08, half - 0.04, 0.08).tolist():
        sheet.line([(x - 0.07, y + tooth), (x + 0.07, y + tooth)], 0.7, near=3.1)


def _joint(sheet: Sheet, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), height(link.start[1])
    middle, colour = (x0 + x1) / 2, COLOURS[1]
    if link.use is not None and link.use.grade == "over":
        colour = "#ffffff"
    sheet.graded(_corners(middle - JOINT, middle + JOINT, y, BED + 0.1), link.use, near=1.5)
    for ends in ((x0, middle - 0.14), (middle + 0.14, x1)):
        sheet.line([(x, y) for x in ends], 1.4)
    for sign in (-1, 1):
        sheet.line(
            [(middle - 0.14, y - sign * 0.26), (middle + 0.14, y + sign * 0.26)], 2.2, colour=colour
        )
    sheet.area(
        [(middle - 0.04, y), (middle, y + 0.07), (middle + 0.04, y), (middle, y - 0.07)],
        "#ffffff",
        1.1,
        near=4.0,
    )


def _line(sheet: Sheet, link: Link) -> None:
    (x0, row0), (x1, row1) = link.start, link.end
    sheet.line(
        [(x0, height(row0)), (x0, height(row1)), (x1, height(row1))],
        1.4,
        {"rigid": "", "tie": DOTTED}[link.kind],
    )


DRAWINGS = {
    "shaft": _shaft,
    "coupling": _coupling,
    "gear": _gear,
    "joint": _joint,
    "crank": _crank,
    "rigid": _line,
    "tie": _line,
}
