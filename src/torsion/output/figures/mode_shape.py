"""One mode over the train: the angle and the torque, each relative to its largest value."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Marks, Moving, Panel, Stops

MOST_TICKS = 40  # along the train, about; of more, those in even steps
MOST_DOTS = 200  # stations that are marked: more would be a line
ROOM = 0.03  # of the train, beyond its ends


def mode(
    name: str,
    caption: str,
    *,
    x: FloatArray,
    row: FloatArray,
    ends: IntArray,
    marked: BoolArray,
    angle: FloatArray,
    torque: FloatArray,
    ticks: Sequence[tuple[float, str]],
    stations: Sequence[str] = (),
    spans: Sequence[str] = (),
) -> Figure:
    """Return the figure of a mode at one speed.

    x, row, marked (with a dot), angle: (stations,); ends: (spans, 2) stations; torque: (spans,).

    stations, spans: names of the marked stations and of all spans, for the cursor.
    """
    line = np.rint(row[ends[:, 1]]).astype(int) if len(ends) else np.zeros(0, dtype=int)
    across = x[ends]
    hangs = across[:, 0] == across[:, 1]
    numbers = sorted(set(line[~hangs].tolist()), key=lambda row: (abs(row), -row))
    upper, lower = list[Line](), list[Line]()
    for index, number in enumerate(numbers):
        mine = (line == number) & ~hangs
        words = "" if len(numbers) == 1 else "main line" if number == 0 else f"branch {index}"
        upper.append(Line(words, *_joined(x, angle, ends[mine]), index))
        # The torque of each span as a step over its length, broken where no span is.
        left, right = across[mine].min(axis=1), across[mine].max(axis=1)
        order = np.argsort(left, kind="stable")
        edges, size = (
            np.column_stack([left, right])[order].ravel(),
            np.repeat(torque[mine][order], 2),
        )
        gaps = np.flatnonzero(np.diff(edges) > 1e-9 * max(float(np.ptp(edges)), 1.0))
        gaps = gaps[gaps % 2 == 1] + 1  # between one span's end and the next one's start
        edges, size = np.insert(edges, gaps, np.nan), np.insert(size, gaps, np.nan)
        lower.append(Line(words, edges, size, index, base=0.0 * size))
    marks = list[Marks]()
    if hangs.any():
        upper.append(Line("", *_joined(x, angle, ends[hangs]), "natural"))
        words = "of no length here: ring, ground, side wheel, step"
        marks.append(Marks(words, across[hangs, 0], torque[hangs], "diamond", "outside"))
    room = ROOM * (float(np.ptp(x)) or 1.0)
    ends_of_axis = float(x.min()) - room, float(x.max()) + room
    along = Axis("", "", *ends_of_axis, places=tuple(ticks[:: -(-len(ticks) // MOST_TICKS) or 1]))
    shown = marked & (np.count_nonzero(marked) <= MOST_DOTS)
    dots = Marks("", x[shown], angle[shown], "dot", "plain")
    points = Stops(x[marked], angle[marked], tuple(stations)) if stations else None
    middles = Stops(across.mean(axis=1), torque, tuple(spans)) if spans else None
    zero, panels = (Level("", 0.0, "zero"),), []
    for what, lines, symbols, stops, height in (
        ("angle", upper, [dots], points, 72.0),
        ("torque", lower, marks, middles, 58.0),
    ):
        y, drawn = Axis(f"{what} / largest", "", -1.1, 1.1), (tuple(lines), zero)
        panels.append(Panel(along, y, *drawn, marks=tuple(symbols), stops=stops, height=height))
    return Figure(name, caption, tuple(panels), Moving(x, row, angle, ends, marked))


def _joined(x: FloatArray, y: FloatArray, ends: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return spans (spans, 2) as one line, broken where one does not start at the end of the one before."""
    first = np.ones(len(ends), dtype=bool)
    first[1:] = ends[1:, 0] != ends[:-1, 1]
    stations = np.insert(ends[:, 1], np.flatnonzero(first), ends[first, 0])
    starts = np.flatnonzero(first) + np.arange(int(first.sum()))
    return np.insert(x[stations], starts[1:], np.nan), np.insert(y[stations], starts[1:], np.nan)
