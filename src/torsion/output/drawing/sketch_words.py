"""Words of the sketch of the train: in even steps of a long one, or those that matter first where links are graded."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsion.output.drawing.frame import MIDDLE, WIDTH
from torsion.output.drawing.grades import BOLD, marked
from torsion.output.drawing.pens import BAD, INK
from torsion.output.drawing.sheet import Sheet, height
from torsion.output.drawing.text import HALO, shown, words
from torsion.output.drawing.words import GROWTH, SIZE, Box, Room, Word, width
from torsion.output.figures.figure import Link, Sketch, Use
from torsion.output.figures.mode_shape import thinned
from torsion.output.numbers import counted

LETTERS = 0.95  # units from the axis to the words
MOST_ROWS = 8  # of words above or below an axis
FEWER_ROWS = (
    2,
    3,
)  # of names of points above an axis and of words of links below it, where these are graded
SOFT = "#33506b"
COLOURS = {
    "✓": SOFT,
    "!": SOFT,
    "?": SOFT,
    "✗": BAD,
}  # of a row of words, by the sign of its verdict
APART = 13.0  # px between two signs
WIDER = 1.08  # bold letters than plain ones
LINE = "#999999"
Spread = tuple[float, float]  # px of the highest and the lowest
Places = Sequence[tuple[float, float, str]]  # x, row, words


def in_steps(sheet: Sheet, sketch: Sketch, most: int) -> tuple[Spread, list[str]]:
    """Names above and below the axes, about `most` of each in even steps."""
    room = Room((-9e9, -9e9, 9e9, 9e9), np.zeros((0, 2)))
    links = [(*_middle(link), link.label) for link in sketch.links if link.label]
    discs = [(one.x, one.row, one.label) for one in sketch.discs if one.label]
    texts = _labels(sheet, room, thinned(discs, most), 1) + _labels(
        sheet, room, thinned(links, most), -1
    )
    return _spread(sheet, sketch, room.taken), texts


def by_rank(sheet: Sheet, sketch: Sketch) -> tuple[Spread, list[str]]:
    """The worst place, then links by their rank, then points, as far as there is room; how many are left out."""
    room = Room((0.0, -9e9, WIDTH, 9e9), np.zeros((0, 2)))
    room.taken += _bodies(sheet, sketch)
    bodies, lines, texts = len(room.taken), list[str](), list[str]()
    if sketch.worst is not None:
        texts += _pointer(sheet, room, *sketch.worst)
    ranked = sorted((link for link in sketch.links if link.label and link.use), key=_rank)
    left_out, bad = 0, 0
    for link in ranked:
        x, row = _middle(link)
        word = next(
            filter(None, (_placed(sheet, room, (x, row, said), -1) for said in _said(link))), None
        )
        left_out += word is None
        if word is not None:
            lines.append(_leader(sheet, (x, row), word, -1))
            texts += _rows(word)
        elif link.use is not None and link.use.is_bad:
            bad += 1
    names = [(one.x, one.row, one.label) for one in sketch.discs if one.label]
    for name in sorted(names, key=lambda name: -_from_the_middle(name, names)):
        side, word = next(
            ((side, word) for side in (1, -1) if (word := _placed(sheet, room, name, side))),
            (1, None),
        )
        left_out += word is None
        if word is not None:
            lines.append(_leader(sheet, name[:2], word, side))
            texts += _rows(word)
    high, low = _spread(sheet, sketch, room.taken[bodies:])
    if left_out:
        low += 1.3 * SIZE
        said = f"Not labelled for want of room: {counted(left_out, 'component')}"
        said += f" (of these {bad} fail)." if bad else "."
        texts.append(words(4.0, low - 3.0, said, f' fill="{SOFT}"'))
    return (high, low), lines + _marks(sheet, sketch) + texts


def _said(link: Link) -> Iterator[str]:
    """Name and use; of what does not keep a limit also the worst line of its use alone."""
    use = link.use
    if use is None or not use.words:
        yield link.label
        return
    yield f"{link.label}\n{use.words}"
    short = next(
        (one for one in use.words.split("\n") if use.mark and one.startswith(use.mark)), ""
    )
    if short and short != use.words:
        yield f"{link.label}\n{short.removesuffix(':')}"


def _marks(sheet: Sheet, sketch: Sketch) -> list[str]:
    """Signs in the components that do not keep a limit, the worst of those that lie too close."""
    placed, made = list[tuple[float, float]](), list[str]()
    bad = sorted(
        (link for link in sketch.links if link.use is not None and link.use.is_bad), key=_rank
    )
    for link in bad:
        x, y = sheet.at(_middle(link)[0], height(_middle(link)[1]))
        if link.use is not None and all(abs(x - a) > APART or abs(y - b) > SIZE for a, b in placed):
            placed.append((x, y))
            made.append(marked(x, y, link.use.mark))
    return made


def _rank(link: Link) -> tuple[float, ...]:
    return link.use.rank if link.use is not None else ()


def _from_the_middle(name: tuple[float, float, str], names: Places) -> float:
    """Ends of the train matter more than what lies between them."""
    x = [one for one, _, _ in names]
    return abs(name[0] - (min(x) + max(x)) / 2)


def _middle(link: Link) -> tuple[float, float]:
    """x and row below or above which its words stand."""
    return (link.start[0] + link.end[0]) / 2, link.end[1]


def _bodies(sheet: Sheet, sketch: Sketch) -> Iterable[Box]:
    """px of discs and links, which words do not cover."""
    for disc in sketch.discs:
        (x, y), half = sheet.at(disc.x, height(disc.row)), (0.25 + 0.55 * disc.size) * sheet.down
        yield (x - 0.1 * sheet.across, y - half, x + 0.1 * sheet.across, y + half)
    for link in sketch.links:
        (left, y), (right, _) = (sheet.at(x, height(row)) for x, row in (link.start, link.end))
        if link.start[1] == link.end[1]:
            yield (left, y - 0.3 * sheet.down, right, y + 0.3 * sheet.down)


def _spread(sheet: Sheet, sketch: Sketch, taken: Iterable[Box]) -> Spread:
    """px from the highest to the lowest of words and axes."""
    rows = [
        0.0,
        *(row for link in sketch.links for _, row in (link.start, link.end)),
        *(d.row for d in sketch.discs),
    ]
    boxes = list(taken)
    high = min([box[1] for box in boxes] + [sheet.at(0, height(min(rows)) + LETTERS)[1]])
    return high, max([box[3] for box in boxes] + [sheet.at(0, height(max(rows)) - LETTERS)[1]])


def _labels(sheet: Sheet, room: Room, places: Places, side: int) -> list[str]:
    """Texts above their axis (side 1) or below it, clear of each other, each with a line to its component."""
    found, colour = [], INK if side > 0 else SOFT
    for x, row, text in places:
        at, tip = sheet.at(x, height(row) + side * LETTERS)
        word = room.place(
            text, np.array([[at, tip]]), gap=0.0, ways=(0,) if side > 0 else (5,), reach=MOST_ROWS
        )
        if word is not None:
            left, upper, right, lower = word.box
            foot, end = sheet.at(x, height(row) + 0.3 * side)[1], lower if side > 0 else upper
            found.append(
                f'<path d="M{shown(at)} {shown(foot)}V{shown(end)}" stroke="#bbbbbb" stroke-width=".6"/>'
            )
            found.append(
                words(
                    (left + right) / 2, (upper + lower) / 2 + 3.7, text, f'{MIDDLE} fill="{colour}"'
                )
            )
    return found


def _placed(sheet: Sheet, room: Room, place: tuple[float, float, str], side: int) -> Word | None:
    """Above or below the axis of its component, or beside that place; None where there is no room."""
    x, row, text = place
    at, tip = sheet.at(x, height(row) + side * LETTERS)
    half = GROWTH * max(map(width, text.split("\n"))) / 2 + 2
    at = min(max(at, half), max(WIDTH - half, half))
    reach, ways = (FEWER_ROWS[0], (0, 1, 2)) if side > 0 else (FEWER_ROWS[1], (5, 6, 7))
    return room.place(text, np.array([[at, tip]]), gap=0.0, ways=ways, reach=reach)


def _leader(sheet: Sheet, place: tuple[float, float], word: Word, side: int) -> str:
    """A thin line from a component to its words."""
    at, foot = sheet.at(place[0], height(place[1]) + 0.3 * side)
    left, upper, right, lower = word.box
    end, across = lower if side > 0 else upper, min(max(at, left + 4.0), right - 4.0)
    path = f"M{shown(at)} {shown(foot)}L{shown(across)} {shown(end)}"
    return f'<path d="{path}" stroke="{LINE}" stroke-width=".6" fill="none"/>'


def _rows(word: Word) -> list[str]:
    """The rows of a placed text, those behind the first in bold letters and the colour of their own verdict."""
    left, upper, right, lower = word.box
    rows = word.text.split("\n")
    step, colour, made = (lower - upper) / len(rows), INK, list[str]()
    for k, text in enumerate(rows):
        if k and text[:1] in COLOURS:  # else it goes on with the verdict before it
            colour = COLOURS[text[:1]]
        look = f'{MIDDLE}{HALO} fill="{colour}"{BOLD if k else ""}'
        made.append(words((left + right) / 2, upper + (k + 0.5) * step + 3.7, text, look))
    return made


def _pointer(sheet: Sheet, room: Room, place: tuple[float, float], use: Use) -> list[str]:
    """A triangle above a place, with words."""
    said, colour = use.words, BAD if use.is_bad else INK
    at, tip = sheet.at(place[0], height(place[1]) + LETTERS)
    half, top = WIDER * GROWTH * width(said) / 2 + 1, tip - 9.0 - GROWTH * SIZE
    middle = min(max(at, half), WIDTH - half)
    room.taken += [
        (at - 7.0, tip - 9.0, at + 7.0, tip + 2.0),
        (middle - half, top, middle + half, tip - 9.0),
    ]
    triangle = f'<path class="worst" d="M{shown(at)} {shown(tip + 2)}l-6-10h12z" fill="{colour}"/>'
    return [
        triangle,
        words(middle, top + GROWTH * SIZE / 2 + 3.7, said, f'{MIDDLE}{BOLD} fill="{colour}"'),
    ]
