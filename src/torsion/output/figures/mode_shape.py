"""One mode over the train: the angle and the torque, each relative to its largest value."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.output.figures.style import COLOURS, GREY, INK, plots, thinned

MOST_TICKS = 40  # along the train


def mode(
    sheet: Figure, *, x: FloatArray, row: FloatArray, ends: IntArray, marked: BoolArray, angle: FloatArray,
    torque: FloatArray, ticks: Sequence[tuple[float, str]],
) -> None:  # fmt: skip
    """x, row, marked (with a dot), angle: (stations,); ends: (spans, 2) stations; torque: (spans,); at one speed."""
    line = np.rint(row[ends[:, 1]]).astype(int) if len(ends) else np.zeros(0, dtype=int)
    upper, lower = plots(sheet, 3.1, 2, sharex=True, height_ratios=(1.15, 1.0))
    for axes in (upper, lower):
        axes.axhline(0.0, color=INK, linewidth=0.6)
        axes.set_ylim(-1.12, 1.12)
        axes.set_yticks([-1.0, -0.5, 0.0, 0.5, 1.0])
    across = x[ends]
    hangs = across[:, 0] == across[:, 1]
    numbers = sorted(set(line[~hangs].tolist()), key=lambda row: (abs(row), -row))
    for index, number in enumerate(numbers):
        mine = (line == number) & ~hangs
        colour = COLOURS[index % len(COLOURS)]
        label = None if len(numbers) == 1 else "main line" if number == 0 else f"branch {index}"
        upper.plot(*_broken(across[mine], angle[ends[mine]]), color=colour, label=label)
        _torques(lower, across[mine], torque[mine], colour)
    if hangs.any():
        upper.plot(*_broken(across[hangs], angle[ends[hangs]]), color=GREY, linewidth=0.7, linestyle=":")
        lower.plot(across[hangs, 0], torque[hangs], "D", color=GREY, markersize=3, label="ring, ground, side wheel")
    upper.plot(x[marked], angle[marked], "o", color=INK, markersize=2.6, zorder=5)
    upper.set_ylabel("angle / largest")
    lower.set_ylabel("torque / largest")
    shown = thinned(ticks, MOST_TICKS)
    lower.set_xticks([at for at, _ in shown], [text for _, text in shown], rotation=30, ha="right", fontsize=7.5)
    lower.tick_params(axis="x", color=GREY)


def _broken(across: FloatArray, up: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Pieces (spans, 2) as one line that is broken between them."""
    gap = np.full((len(across), 1), np.nan)
    return np.hstack([across, gap]).ravel(), np.hstack([up, gap]).ravel()


def _torques(axes: Axes, across: FloatArray, torque: FloatArray, colour: str) -> None:
    """Torque of each span as a step over its length."""
    left, right = across.min(axis=1), across.max(axis=1)
    order = np.argsort(left, kind="stable")
    edges = np.column_stack([left, right])[order].ravel()
    size = np.repeat(torque[order], 2)
    apart = np.flatnonzero(np.diff(edges) > 1e-9 * max(float(np.ptp(edges)), 1.0))
    apart = apart[apart % 2 == 1] + 1  # gaps between one span's end and the next one's start
    edges, size = np.insert(edges, apart, np.nan), np.insert(size, apart, np.nan)
    axes.fill_between(edges, size, color=colour, alpha=0.25, linewidth=0)
    axes.plot(edges, size, color=colour)
