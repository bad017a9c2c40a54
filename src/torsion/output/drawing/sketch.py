"""The sketch of the train as SVG: discs as high as their inertia is large, shafts, couplings, gears and joints."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from torsion.output.drawing.curves import outline
from torsion.output.drawing.frame import MIDDLE, WIDTH
from torsion.output.drawing.grades import BOLD, hatched, key
from torsion.output.drawing.pens import BAD, COLOURS, GRADES, INK, MARKED, Stroke
from torsion.output.drawing.words import GROWTH, HALO, SIZE, Box, Room, shown, width, words
from torsion.output.figures.figure import Link, Place, Sketch, Use
from torsion.output.numbers import counted

Points = Sequence[tuple[float, float]]
ROW = 2.9  # distance of the rows, in units of the layout
TALL = 45.0  # px of a unit down


@dataclass(frozen=True)
class Sheet:
    """Strokes and areas in units of the layout; those of one look become one element."""

    across: float  # px of a unit
    left: float  # unit at the left edge
    thickness: float  # factor on the widths of lines
    down: float  # px of a unit
    drawn: dict[tuple[float, str, Stroke], list[str]] = field(
        default_factory=dict
    )  # paths by nearness, fill, look

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return the px of a place; y goes up."""
        return (x - self.left) * self.across, -y * self.down

    def line(
        self,
        points: Points,
        width: float,
        dash: str = "",
        colour: str = INK,
        near: float = 2.0,
        *,
        fill: str = "",
    ) -> None:
        """Draw a line through places in units of the layout, or a polygon with a fill."""
        look = near, fill or "none", Stroke(colour, width * self.thickness, dash)
        self.drawn.setdefault(look, []).append(self._path(points) + "z" * bool(fill))

    def graded(self, corners: Points, use: Use | None, *, near: float) -> None:
        """Draw a polygon in the colour and the pattern of a grade, if there is one.

        Its hatching fills the middle of its corners' heights.
        """
        if use is None:
            return
        self.line(corners, 1.1, near=near, fill=GRADES[use.grade].fill)
        places = np.array([[10.0 * length for length in self.at(x, y)] for x, y in corners])
        x, y = np.sort(places, axis=0).T
        look, path = hatched((x[1], y[1], x[2], y[2]), use.grade)
        if path:
            self.drawn.setdefault((near + 0.05, "none", look), []).append(path)
        if use.mark:
            outlines = self.drawn.setdefault((5.0, "none", MARKED), [])
            outlines.append(self._path(corners) + "z")

    def _path(self, points: Points) -> str:
        places = np.rint([[10.0 * length for length in self.at(x, y)] for x, y in points]).astype(
            np.int64
        )
        return outline([places[0].tolist(), *np.diff(places, axis=0).tolist()])


def height(row: float) -> float:
    """Return the units up of the axis of a row."""
    return -ROW * row


LETTERS = 0.95  # units from the axis to the words
REACH = {1: 2, -1: 3}  # rows of names of points above an axis, of words of links below it
WAYS = {1: (0, 1, 2), -1: (5, 6, 7)}  # directions of both from their component
SOFT = "#33506b"
VERDICT_COLOURS = {
    "✓": SOFT,
    "!": SOFT,
    "?": SOFT,
    "✗": BAD,
}  # of a row, by the sign of its verdict
WIDER = 1.08  # bold letters than plain ones
LINE = "#999999"


def place_words(sheet: Sheet, sketch: Sketch) -> tuple[tuple[float, float], list[str]]:
    """Place the words of the worst place, then of links by rank, then of points, as far as there is room.

    Returns the highest and the lowest px of words and axes, and the SVG elements; the number of components without
    words is one of them.
    """
    room = Room((0.0, -9e9, WIDTH, 9e9), np.zeros((0, 2)))
    room.taken += _bodies(sheet, sketch)
    bodies, lines, texts = len(room.taken), list[str](), list[str]()
    if sketch.worst is not None:  # a triangle above the place, with words
        (position, row), use = sketch.worst
        text, colour = use.words, BAD if use.mark else INK
        x, tip = sheet.at(position, height(row) + LETTERS)
        half, top = WIDER * GROWTH * width(text) / 2 + 1, tip - 9.0 - GROWTH * SIZE
        middle = min(max(x, half), WIDTH - half)
        room.taken += [
            (x - 7.0, tip - 9.0, x + 7.0, tip + 2.0),
            (middle - half, top, middle + half, tip - 9.0),
        ]
        triangle = f"M{shown(x)} {shown(tip + 2)}l-6-10h12z"
        texts.append(f'<path class="worst" d="{triangle}" fill="{colour}"/>')
        look = f'{MIDDLE}{BOLD} fill="{colour}"'
        texts.append(words(middle, top + GROWTH * SIZE / 2 + 3.7, text, look))

    omitted = failures = 0
    labelled = (link for link in sketch.links if link.label)
    for link in sorted(labelled, key=lambda link: link.use.rank if link.use else ()):
        middle_of_link = (link.start[0] + link.end[0]) / 2, link.end[1]
        is_placed = _label(sheet, room, middle_of_link, _words(link), (-1,), lines, texts)
        omitted += not is_placed
        failures += not is_placed and link.use is not None and bool(link.use.mark)
    named = [disc for disc in sketch.discs if disc.label]
    ends = [disc.x for disc in named]
    # Ends of the train matter more than what lies between them.
    for disc in sorted(named, key=lambda disc: -abs(disc.x - (min(ends) + max(ends)) / 2)):
        omitted += not _label(sheet, room, (disc.x, disc.row), [disc.label], (1, -1), lines, texts)

    rows = [row for link in sketch.links for _, row in (link.start, link.end)]
    rows += [0.0, *(disc.row for disc in sketch.discs)]
    boxes = room.taken[bodies:]
    high = min(sheet.at(0, height(min(rows)) + LETTERS)[1], *(box[1] for box in boxes), np.inf)
    low = max(sheet.at(0, height(max(rows)) - LETTERS)[1], *(box[3] for box in boxes), -np.inf)
    if omitted:
        low += 1.3 * SIZE
        sentence = f"Not labelled for want of room: {counted(omitted, 'component')}"
        sentence += f" (of these {failures} fail)." if failures else "."
        texts.append(words(4.0, low - 3.0, sentence, f' fill="{SOFT}"'))
    return (high, low), lines + texts


def _words(link: Link) -> Iterator[str]:
    """Yield name and use; for a failed limit then the name with the worst line of its use only."""
    use = link.use
    if use is None or not use.words:
        yield link.label
        return
    yield f"{link.label}\n{use.words}"
    failed = (line for line in use.words.split("\n") if use.mark and line.startswith(use.mark))
    worst = next(failed, "")
    if worst and worst != use.words:
        yield f"{link.label}\n{worst.removesuffix(':')}"


def _bodies(sheet: Sheet, sketch: Sketch) -> Iterator[Box]:
    """Yield the boxes of discs and links in px, which words do not cover."""
    for disc in sketch.discs:
        (x, y), half = sheet.at(disc.x, height(disc.row)), (0.25 + 0.55 * disc.size) * sheet.down
        yield (x - 0.1 * sheet.across, y - half, x + 0.1 * sheet.across, y + half)
    for link in sketch.links:
        (left, y), (right, _) = (sheet.at(x, height(row)) for x, row in (link.start, link.end))
        if link.start[1] == link.end[1]:
            yield (left, y - 0.3 * sheet.down, right, y + 0.3 * sheet.down)


def _label(
    sheet: Sheet,
    room: Room,
    position: Place,
    texts: Iterable[str],
    sides: Sequence[int],
    lines: list[str],
    elements: list[str],
) -> bool:
    """Place the first text that has room above (side 1) or below the axis, with a line to it; return whether any has.

    All rows of the text but the first are in bold letters and the colour of their own verdict.
    """
    for text, side in ((text, side) for text in texts for side in sides):
        across, tip = sheet.at(position[0], height(position[1]) + side * LETTERS)
        half = GROWTH * max(map(width, text.split("\n"))) / 2 + 2
        foot = np.array([[min(max(across, half), max(WIDTH - half, half)), tip]])
        word = room.place(text, foot, gap=0.0, ways=WAYS[side], reach=REACH[side])
        if word is None:
            continue
        left, upper, right, lower = word.box
        start, begin = sheet.at(position[0], height(position[1]) + 0.3 * side)
        end, across = lower if side > 0 else upper, min(max(start, left + 4.0), right - 4.0)
        path = f"M{shown(start)} {shown(begin)}L{shown(across)} {shown(end)}"
        lines.append(f'<path d="{path}" stroke="{LINE}" stroke-width=".6" fill="none"/>')
        rows, colour = text.split("\n"), INK
        step = (lower - upper) / len(rows)
        for k, row in enumerate(rows):
            if k:  # without a sign it continues the verdict before it
                colour = VERDICT_COLOURS.get(row[:1], colour)
            look = f'{MIDDLE}{HALO} fill="{colour}"{BOLD if k else ""}'
            elements.append(words((left + right) / 2, upper + (k + 0.5) * step + 3.7, row, look))
        return True
    return False


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
    """Return height in px and elements of the sketch below `top`, as wide as the figure, or less if it is short."""
    places = [(disc.x, disc.row) for disc in sketch.discs] + [
        end for link in sketch.links for end in (link.start, link.end)
    ]
    x, rows = zip(*places or [(0.0, 0.0), (1.0, 0.0)], strict=True)
    number, wide = len(sketch.discs) + len(sketch.links), max(x) - min(x) + 1.0
    across, thickness = min(WIDTH / wide, WIDEST), min(1.0, MANY / max(number, 1)) ** 0.5
    high, left = ROW * (max(rows) - min(rows)), min(x) - 0.5 - (WIDTH / across - wide) / 2
    down = TALL if sketch.height is None or not high else min(TALL, sketch.height / high)

    sheet = Sheet(across, left, thickness, down)
    for link in sketch.links:
        (_gear if link.kind == "gear" else _link)(sheet, link)
    for disc in sketch.discs:
        y, half, thick = height(disc.row), 0.25 + 0.55 * disc.size, 0.17
        if disc.is_held:
            _ground(sheet, disc.x, y, 0.5, vertical=True)
            continue
        if disc.ring:
            tall = half + 0.13 + 0.12 * disc.ring
            _box(sheet, (disc.x, y), thick + 0.14, tall, "#ffffff", dash="4 2", near=2.9)
        _box(sheet, (disc.x, y), thick, half, FILLS[disc.role])
        if disc.is_grounded:
            _zigzag(sheet, (disc.x, y - half), (disc.x, y - half - 0.45), 0.07)
            _ground(sheet, disc.x, y - half - 0.45, 0.2, vertical=False)
    elements = [  # from the farthest to the nearest
        f'<path d="{"".join(paths)}" fill="{fill}" {look.attributes(10.0)}/>'
        for (_, fill, look), paths in sorted(sheet.drawn.items(), key=lambda item: item[0][0])
    ]
    (upper, lower), texts = place_words(sheet, sketch)
    upper, lower = upper - 3.0, lower + 3.0
    below, legend = key(
        [link.use for link in sketch.links if link.use is not None], lower - upper + top
    )
    body = f'<g transform="scale(.1)">{"".join(elements)}</g><g font-size="{SIZE:g}">{"".join(texts)}</g>'
    scale = f'data-left="{sheet.left:.6g}" data-across="{sheet.across:.6g}" data-row="{ROW * sheet.down:g}"'  # of modes
    placed = f'<g class="sketch" {scale} transform="translate(0 {shown(top - upper)})">{body}</g>{legend}'
    return lower - upper + below, placed


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
    left, right = middle[0] - width / 2, middle[0] + width / 2
    sheet.line(_corners(left, right, middle[1], half), 1.1, dash, near=near, fill=fill)


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


def _corners(left: float, right: float, y: float, half: float) -> Points:
    return [(left, y - half), (right, y - half), (right, y + half), (left, y + half)]


def _link(sheet: Sheet, link: Link) -> None:
    """Draw a shaft, coupling, crank or joint, or the line of a rigid link."""
    (x0, row0), (x1, row1) = link.start, link.end
    y0, y1, middle, use = height(row0), height(row1), (x0 + x1) / 2, link.use
    match link.kind:
        case "shaft":
            first, last = ((0.12 if use is None else GRADED) * share for share in link.taper)
            corners = [(x0, y0 - first), (x0, y0 + first), (x1, y1 + last), (x1, y1 - last)]
            if use is None:
                sheet.line(corners, 1.1, fill="#f3f3f3")
            sheet.graded(corners, use, near=2.0)
            for sign in (-1, 1) if link.bore else ():
                ends = [(x0, y0 + sign * first * link.bore), (x1, y1 + sign * last * link.bore)]
                sheet.line(ends, 0.7, "3 2", near=3.0)
        case "coupling":
            edge = 0.18 * (x1 - x0)
            sheet.graded(_corners(x0 + edge, x1 - edge, (y0 + y1) / 2, BED), use, near=1.5)
            _zigzag(sheet, (x0, y0), (x1, y1))
        case "crank":  # two webs and the pin between them, off the axis
            webs = middle - PIN * (x1 - x0), middle + PIN * (x1 - x0)
            sheet.graded(_corners(*webs, y0 + WEB / 2, BED), use, near=1.5)
            sheet.line([(x0, y0), (webs[0], y0)], 1.4)
            sheet.line([(webs[1], y0), (x1, y0)], 1.4)
            for x in webs:
                _box(sheet, (x, y0 + WEB / 2), 0.1, BED, "#f3f3f3")
            sheet.line([(webs[0] + 0.05, y0 + WEB), (webs[1] - 0.05, y0 + WEB)], 2.2)
        case "joint":
            colour = "#ffffff" if use is not None and use.grade == "over" else COLOURS[1]
            sheet.graded(_corners(middle - JOINT, middle + JOINT, y0, BED + 0.1), use, near=1.5)
            for begin, end in ((x0, middle - 0.14), (middle + 0.14, x1)):
                sheet.line([(begin, y0), (end, y0)], 1.4)
            for up in (-0.26, 0.26):
                cross = [(middle - 0.14, y0 - up), (middle + 0.14, y0 + up)]
                sheet.line(cross, 2.2, colour=colour)
            pin = [
                (middle - 0.04, y0),
                (middle, y0 + 0.07),
                (middle + 0.04, y0),
                (middle, y0 - 0.07),
            ]
            sheet.line(pin, 1.1, near=4.0, fill="#ffffff")
        case _:  # rigid, or a tie
            sheet.line([(x0, y0), (x0, y1), (x1, y1)], 1.4, DOTTED * (link.kind == "tie"))


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
