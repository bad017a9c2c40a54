"""Words in a drawing: their widths, and places at which they cover neither each other nor the lines."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from html import escape

import numpy as np

from torsion.arrays import FloatArray

Box = tuple[float, float, float, float]  # left, top, right, bottom, px
SIZE = 10.5  # px of the letters of axes and keys
GROWTH = (
    1.25  # times which letters may be enlarged (on narrow screens) and still be clear of each other
)
# Adobe, Helvetica AFM (1990): widths of the signs 32 to 126 in 1/1000 of the size
WIDTHS = re.findall(
    r"\d+",
    """
    278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556
    556 556 278 278 584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 556 833 722 778
    667 778 722 667 611 722 667 944 667 667 611 278 278 278 469 556 333 556 556 500 556 556 278 556
    556 222 222 500 222 833 556 556 556 556 333 500 278 556 500 722 500 500 500 334 260 334 584
""",
)
SUPERSCRIPTS, LATIN = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹", 0x0500  # signs behind the second are as wide as high
DIRECTIONS = (
    (0, -1),
    (1, -1),
    (-1, -1),
    (1, 0),
    (-1, 0),
    (0, 1),
    (1, 1),
    (-1, 1),
)  # from the point to the words
MESH = 3.0  # px, to which the points of curves are counted
REACH = 5  # rows of letters away from its point, at most
COVERED, APART, ELSEWHERE = (
    4.0,
    10.0,
    13.0,
)  # costs of a point covered, a row of distance, another point than the first


def width(text: str, size: float = SIZE) -> float:
    """Return the width of a text in px.

    >>> width("mm", 10.0)
    16.66
    """
    return sum(map(_letter_width, text)) * size / 1000.0


@cache
def _letter_width(letter: str) -> int:
    """Return the width of a letter in thousandths of its size."""
    code = ord(letter)
    if 32 <= code <= 126:
        return int(WIDTHS[code - 32])
    if letter in SUPERSCRIPTS:
        return 340
    return 580 if code < LATIN else 1000


def fitted(text: str, most: float) -> str:
    """Return a text, cut where it is wider than so many px.

    >>> fitted("a shaft", 100.0), fitted("a long name of a shaft", 60.0)
    ('a shaft', 'a long na…')
    """
    if width(text) <= most:
        return text
    while text and width(text.rstrip() + "…") > most:
        text = text[:-1]
    return text.rstrip() + "…"


@dataclass(frozen=True)
class Word:
    """A text with the box that it fills; `foot` is what it belongs to where that is not beside it."""

    text: str
    box: Box
    foot: tuple[float, float] | None = None


class Room:
    """A rectangle in which words find their places, one after another; what is placed is kept."""

    def __init__(self, box: Box, curves: FloatArray) -> None:
        """Set the box; curves: (points, 2) px, which words should not cover."""
        self.box = np.array(box)
        self.taken: list[Box] = []
        finite = curves[np.isfinite(curves).all(axis=1)]
        size = [1, 1]  # an infinite box of no curves has no mesh
        if len(finite):
            size = np.maximum(np.ceil((self.box[2:] - self.box[:2]) / MESH) + 1, 1).tolist()
        mesh = [
            np.arange(count + 1) * MESH + start for count, start in zip(size, box, strict=False)
        ]
        number, _, _ = np.histogram2d(finite[:, 0], finite[:, 1], bins=mesh)
        # Points to the left and above.
        self.before = np.pad(number.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))

    def place(
        self,
        text: str,
        points: FloatArray,
        *,
        gap: float = 3.0,
        ways: Sequence[int] = range(8),
        reach: int = REACH,
        elsewhere: float = ELSEWHERE,
    ) -> Word | None:
        """Return the best free place of a text, in one row or more, beside one of (points, 2) px; None if there is none.

        ways: the DIRECTIONS from a point that will do; elsewhere: what another point than the first costs. Away from
        its point, with a line to it, only the first is tried.
        """
        rows = text.split("\n")
        half = np.array([GROWTH * max(map(width, rows)) / 2 + 1, GROWTH * SIZE * len(rows) / 2])
        allowed, rank = np.array([DIRECTIONS[way] for way in ways]), np.arange(len(points))
        cost = np.where(rank > 0, elsewhere + 0.3 * rank, 0.0)[:, None] + 0.3 * np.arange(len(ways))
        best, lowest = None, np.inf
        for row in range(reach):
            # For every point and direction the box, and the covered points of curves, infinite without room.
            feet, away = points if row == 0 else points[:1], gap + 2.0 * half[1] * row
            sideways = np.where(allowed[:, 1] == 0, away, 0.0)
            size = np.column_stack([half[0] + sideways, np.full(len(allowed), half[1] + away)])
            middle = (feet[:, None, :] + allowed * size).reshape(-1, 2)
            boxes = np.hstack([middle - half, middle + half])
            free = ((boxes[:, :2] >= self.box[:2]) & (boxes[:, 2:] <= self.box[2:])).all(axis=1)
            if self.taken:
                placed = np.array(self.taken)
                clear = boxes[:, None, :2] >= placed[:, 2:]
                clear |= boxes[:, None, 2:] <= placed[:, :2]
                free &= np.logical_and.reduce(clear.any(axis=2), axis=1)
            # Points of curves between two corners, to a mesh.
            before, inner = self.before, half / GROWTH
            (x0, y0), (x1, y1) = (
                np.clip(np.rint((corner - self.box[:2]) / MESH), 0, np.array(before.shape) - 1)
                .astype(np.int64)
                .T
                for corner in (middle - inner, middle + inner)
            )
            covered = before[x1, y1] - before[x0, y1] - before[x1, y0] + before[x0, y0]
            covered = np.where(free, covered, np.inf)
            costs = COVERED * covered + cost[: len(feet)].ravel() + APART * row
            choice = int(np.argmin(costs))
            if costs[choice] < lowest:
                lowest = float(costs[choice])
                foot = tuple(points[0].tolist()) if row else None
                best = Word(text, tuple(boxes[choice].tolist()), foot)
            if lowest < APART * (row + 1):
                break
        if best is not None:
            self.taken.append(best.box)
        return best


SUBSCRIPT = re.compile(r"_\{([^{}]*)\}")
HALO = ' stroke="#ffffff" stroke-width="2.6" stroke-linejoin="round" paint-order="stroke"'  # of words over lines
FORBIDDEN = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")  # in XML 1.0


def shown(value: float) -> str:
    """Return a length in px, to a hundredth.

    >>> shown(12.5), shown(3.0), shown(-0.001)
    ('12.5', '3', '0')
    """
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def clean(text: str) -> str:
    """Return a text for an attribute or an element: escaped, and without the signs that XML forbids."""
    return escape(FORBIDDEN.sub("�", text))


def plain(text: str) -> str:
    """Return a text without the marks of subscripts."""
    return SUBSCRIPT.sub(r"\1", text)


def words(x: float, y: float, text: str, more: str = "") -> str:
    """Return a text at a place, its subscripts lowered; more: further attributes."""
    inside = SUBSCRIPT.sub(
        r'<tspan dy="2.5" font-size="75%">\1</tspan><tspan dy="-2.5">&#8203;</tspan>', clean(text)
    )
    return f'<text x="{shown(x)}" y="{shown(y)}"{more}>{inside}</text>'
