"""Natural frequencies over the speed with the orders that meet them: Campbell diagram, and whirl of a shaft."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.curves_over_speed import Bands, over
from torsion.output.figures.style import BAD, COLOURS, GREY, INK, MOST_LINES, PALE, pens, ranges

Crossing = tuple[float, float, bool]  # rpm, Hz, inside the speed range
Marks = tuple[tuple[bool, str, str, str], ...]  # inside the speed range, marker, colour, label
BACKGROUND = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6}
CRITICAL: Marks = ((True, "o", COLOURS[1], "critical speed in the range"), (False, "x", "#888888", "outside the range"))
CRITICAL_OF_WHIRL: Marks = (
    (True, "o", INK, "critical speed in the range"), (False, "o", "#999999", "critical speed outside the range"),
)  # fmt: skip
SENSES: tuple[tuple[float, str, dict[str, Any]], ...] = (
    # least direction, label, pen; an orbit between the limits is nearly a straight line
    (0.1, "forward", {"color": COLOURS[0], "linestyle": "-", "zorder": 2.0}),
    (-0.1, "nearly in a plane", {"color": COLOURS[2], "linestyle": "-.", "zorder": 2.1}),
    (-2.0, "backward", {"color": COLOURS[1], "linestyle": "--", "zorder": 2.2}),
)
AHEAD = 1.6  # times the highest frequency that an order reaches: so far up a mode is shown though no order meets it


def campbell(
    sheet: Figure, *, frequencies: Sequence[float], orders: Sequence[tuple[float, str]],
    crossings: Sequence[Crossing], speeds: tuple[float, float], rated: float | None, barred: Bands = (),
) -> None:  # fmt: skip
    """frequencies: Hz; orders: (per revolution, label); crossings: (rpm, Hz, inside the range); speeds, rated: rpm."""
    inside = max((f for _, f, is_inside in crossings if is_inside), default=0.0)
    reached = max((order for order, _ in orders), default=1.0) * speeds[1] / 60.0
    wanted = min((f for f in frequencies if f > inside), default=inside or reached)  # one mode above what matters
    top = 1.12 * max(min(wanted, 1.15 * reached), inside, 0.25 * reached, 1e-9)
    right = speeds[1] * 1.12
    with over(sheet, 4.1, np.array([0.0, right]), "frequency, Hz", rated=rated) as axes:
        axes.axvspan(*speeds, facecolor=PALE, linewidth=0, label="speed range", zorder=0)
        ranges(axes, barred)
        for index, frequency in enumerate([f for f in frequencies if f <= top][:MOST_LINES]):
            axes.axhline(frequency, color=INK, linewidth=1.0)
            axes.annotate(f"mode {index + 1}: {frequency:.5g} Hz", (0.0, frequency), xytext=(4, 2.5),
                          textcoords="offset points", fontsize=7.5, zorder=6, bbox=BACKGROUND)  # fmt: skip
        for (order, label), pen in zip(orders[:MOST_LINES], pens(MOST_LINES), strict=False):
            end = min(right, 60.0 * top / order)
            axes.plot([0.0, end], [0.0, order * end / 60.0], linewidth=1.0, **pen)
            axes.annotate(label, (end, order * end / 60.0), xytext=(2, 1), textcoords="offset points",
                          fontsize=7.5, color=pen["color"], annotation_clip=False)  # fmt: skip
        _met(axes, crossings, CRITICAL, right, top)


def whirl(
    sheet: Figure, *, speed: FloatArray, frequency: FloatArray, direction: FloatArray, unstable: BoolArray,
    orders: Sequence[tuple[float, str]], crossings: Sequence[Crossing], rated: float | None,
) -> None:  # fmt: skip
    """speed: (speeds,) rpm; frequency, Hz, direction and unstable: (speeds, modes).

    orders: (frequency of the order at the last speed, Hz; label).
    """
    first, last = float(speed[0]), float(speed[-1])
    right, top = 1.08 * last, _top(frequency, max(at for at, _ in orders), crossings)
    with over(sheet, 3.6, np.array([0.0, right]), "frequency of bending, Hz", rated=rated) as axes:
        axes.axvspan(first, last, facecolor=PALE, linewidth=0, label="speed range", zorder=0)
        for column, sense in zip(frequency.T, direction.T, strict=True):
            _whirling(axes, speed, column, sense)
        if np.any(unstable):
            rows, columns = np.nonzero(unstable)
            pen: dict[str, Any] = {"color": BAD, "linestyle": "none", "label": "UNSTABLE", "zorder": 6}
            axes.plot(speed[rows], frequency[rows, columns], "x", **pen)
        for at, label in orders:
            end = at * right / last
            axes.plot([0.0, right], [0.0, end], color=GREY, linewidth=0.9, linestyle="-")
            share = min(1.0, top / end)
            axes.annotate(label, (share * right, share * end), xytext=(-8, 2), textcoords="offset points",
                          ha="right", fontsize=7.5, color=INK)  # fmt: skip
        _met(axes, crossings, CRITICAL_OF_WHIRL, right, top)


def _whirling(axes: Axes, speed: FloatArray, frequency: FloatArray, sense: FloatArray) -> None:
    """One mode in the pens of its senses; a piece reaches to the next speed, so that no gap stands between two."""
    above = np.inf
    for least, label, pen in SENSES:
        here = (sense >= least) & (sense < above)
        above = least
        if here.any():
            shown = here | np.append(False, here[:-1])
            axes.plot(speed, np.where(shown, frequency, np.nan), label=label, **pen)


def _met(axes: Axes, crossings: Sequence[Crossing], marks: Marks, right: float, top: float) -> None:
    """The crossings that lie on the diagram, which goes from nothing to these two."""
    for inside, marker, colour, label in marks:
        met = [(rpm, hertz) for rpm, hertz, is_in in crossings if is_in == inside and rpm <= right and hertz <= top]
        if met:
            axes.plot(*np.array(met).T, marker, color=colour, linestyle="none", label=label, zorder=5)
    axes.set_ylim(0.0, top)


def _top(frequency: FloatArray, reached: float, crossings: Sequence[Crossing]) -> float:
    """What the orders meet, and of the modes above it those near."""
    inside = max((hertz for _, hertz, is_inside in crossings if is_inside), default=0.0)
    known = frequency[np.isfinite(frequency)]
    lowest = float(known.min()) if known.size else 0.0
    near = known[known <= AHEAD * reached]
    return 1.1 * max(inside, float(near.max()) if near.size else 1.2 * lowest, reached)
