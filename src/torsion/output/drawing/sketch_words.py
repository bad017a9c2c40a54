"""Words of the sketch of the train: where there is no room for all, those that matter most."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsion.output.drawing.frame import MIDDLE, WIDTH
from torsion.output.drawing.grades import BOLD
from torsion.output.drawing.pens import BAD, INK
from torsion.output.drawing.sheet import Sheet, height
from torsion.output.drawing.text import HALO, shown, words
from torsion.output.drawing.words import GROWTH, SIZE, Box, Room, Word, width
from torsion.output.figures.figure import Link, Sketch, Use
from torsion.output.numbers import counted

LETTERS = 0.95  # units from the axis to the words
REACH = {1: 2, -1: 3}  # rows of names of points above an axis, of words of links below it
WAYS = {1: (0, 1, 2), -1: (5, 6, 7)}  # directions of both from their component
SOFT = "#33506b"
COLOURS = {"✓": SOFT, "!": SOFT, "?": SOFT, "✗": BAD}  # of a row, by the sign of its verdict
WIDER = 1.08  # bold letters than plain ones
LINE = "#999999"
Spread = tuple[float, float]  # px of the highest and the lowest
Place = tuple[float, float]  # x, row


def place_words(sheet: Sheet, sketch: Sketch) -> tuple[Spread, list[str]]:
    """Place the words of the worst place, then of links by rank, then of points, as far as there is room.

    Returns the spread of the words in px and the SVG elements; the number of components without words is one of them.
    """
    room = Room((0.0, -9e9, WIDTH, 9e9), np.zeros((0, 2)))
    room.taken += _bodies(sheet, sketch)
    bodies, lines, texts = len(room.taken), list[str](), list[str]()
    if sketch.worst is not None:
        texts += _pointer(sheet, room, *sketch.worst)

    omitted = failures = 0
    for link in sorted((link for link in sketch.links if link.label), key=_rank):
        is_placed = _label(sheet, room, _middle(link), _words(link), (-1,), lines, texts)
        omitted += not is_placed
        failures += not is_placed and link.use is not None and link.use.is_bad
    named = [disc for disc in sketch.discs if disc.label]
    ends = [disc.x for disc in named]
    # Ends of the train matter more than what lies between them.
    for disc in sorted(named, key=lambda disc: -abs(disc.x - (min(ends) + max(ends)) / 2)):
        omitted += not _label(sheet, room, (disc.x, disc.row), [disc.label], (1, -1), lines, texts)

    high, low = _spread(sheet, sketch, room.taken[bodies:])
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


def _rank(link: Link) -> tuple[float, ...]:
    return link.use.rank if link.use is not None else ()


def _middle(link: Link) -> Place:
    """Return x and row below or above which the words of a link stand."""
    return (link.start[0] + link.end[0]) / 2, link.end[1]


def _bodies(sheet: Sheet, sketch: Sketch) -> Iterable[Box]:
    """Yield the boxes of discs and links in px, which words do not cover."""
    for disc in sketch.discs:
        (x, y), half = sheet.at(disc.x, height(disc.row)), (0.25 + 0.55 * disc.size) * sheet.down
        yield (x - 0.1 * sheet.across, y - half, x + 0.1 * sheet.across, y + half)
    for link in sketch.links:
        (left, y), (right, _) = (sheet.at(x, height(row)) for x, row in (link.start, link.end))
        if link.start[1] == link.end[1]:
            yield (left, y - 0.3 * sheet.down, right, y + 0.3 * sheet.down)


def _spread(sheet: Sheet, sketch: Sketch, boxes: Sequence[Box]) -> Spread:
    """Return the highest and the lowest px of words and axes."""
    ends = [end for link in sketch.links for end in (link.start, link.end)]
    rows = [0.0, *(row for _, row in ends), *(disc.row for disc in sketch.discs)]
    top, foot = (
        sheet.at(0, height(row) + letters)[1]
        for row, letters in ((min(rows), LETTERS), (max(rows), -LETTERS))
    )
    return min([top, *(box[1] for box in boxes)]), max([foot, *(box[3] for box in boxes)])


def _label(
    sheet: Sheet,
    room: Room,
    position: Place,
    texts: Iterable[str],
    sides: Sequence[int],
    lines: list[str],
    elements: list[str],
) -> bool:
    """Place the first text that has room above (side 1) or below the axis, with a line to it; return whether any has."""
    for text in texts:
        for side in sides:
            across, tip = sheet.at(position[0], height(position[1]) + side * LETTERS)
            half = GROWTH * max(map(width, text.split("\n"))) / 2 + 2
            across = min(max(across, half), max(WIDTH - half, half))
            foot = np.array([[across, tip]])
            word = room.place(text, foot, gap=0.0, ways=WAYS[side], reach=REACH[side])
            if word is not None:
                lines.append(_leader(sheet, position, word, side))
                elements += _rows(word)
                return True
    return False


def _leader(sheet: Sheet, position: Place, word: Word, side: int) -> str:
    """Return a thin line from a component to its words."""
    start, foot = sheet.at(position[0], height(position[1]) + 0.3 * side)
    left, upper, right, lower = word.box
    end, across = lower if side > 0 else upper, min(max(start, left + 4.0), right - 4.0)
    path = f"M{shown(start)} {shown(foot)}L{shown(across)} {shown(end)}"
    return f'<path d="{path}" stroke="{LINE}" stroke-width=".6" fill="none"/>'


def _rows(word: Word) -> list[str]:
    """Return the rows of a placed text, all but the first in bold letters and the colour of their own verdict."""
    left, upper, right, lower = word.box
    rows = word.text.split("\n")
    step, colour, elements = (lower - upper) / len(rows), INK, list[str]()
    for k, text in enumerate(rows):
        if k and text[:1] in COLOURS:  # else it continues the verdict before it
            colour = COLOURS[text[:1]]
        look = f'{MIDDLE}{HALO} fill="{colour}"{BOLD if k else ""}'
        elements.append(words((left + right) / 2, upper + (k + 0.5) * step + 3.7, text, look))
    return elements


def _pointer(sheet: Sheet, room: Room, position: Place, use: Use) -> list[str]:
    """Return a triangle above a place, with words."""
    text, colour = use.words, BAD if use.is_bad else INK
    x, tip = sheet.at(position[0], height(position[1]) + LETTERS)
    half, top = WIDER * GROWTH * width(text) / 2 + 1, tip - 9.0 - GROWTH * SIZE
    middle = min(max(x, half), WIDTH - half)
    room.taken += [
        (x - 7.0, tip - 9.0, x + 7.0, tip + 2.0),
        (middle - half, top, middle + half, tip - 9.0),
    ]
    triangle = f'<path class="worst" d="M{shown(x)} {shown(tip + 2)}l-6-10h12z" fill="{colour}"/>'
    look = f'{MIDDLE}{BOLD} fill="{colour}"'
    return [triangle, words(middle, top + GROWTH * SIZE / 2 + 3.7, text, look)]
