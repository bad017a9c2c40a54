"""Natural frequencies over the speed with the orders that meet them: Campbell diagram, and whirl of a shaft."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Marks, Panel, Role
from torsion.output.figures.ranges import MOST_LINES, SPEED, Bands, barred_bands, rated_level
from torsion.output.numbers import number

Crossing = tuple[float, float, bool, str]  # rpm, Hz, inside the speed range, what meets what
SENSES: tuple[
    tuple[float, Role], ...
] = (  # least direction; an orbit between is nearly a straight line
    (0.1, "forward"),
    (-0.1, "nearly in a plane"),
    (-2.0, "backward"),
)
AHEAD = 1.6  # times the highest frequency that an order reaches: so far up a mode is shown though no order meets it


def campbell(
    name: str,
    caption: str,
    *,
    frequencies: Sequence[float],
    orders: Sequence[tuple[float, str]],
    crossings: Sequence[Crossing],
    speeds: tuple[float, float],
    rated: float | None,
    barred: Bands = (),
    curves: tuple[FloatArray, FloatArray] | None = None,
    spread: Sequence[tuple[float, float]] = (),
    of: str = "within the tolerances",
    tolerated: Bands = (),
) -> Figure:
    """Return the Campbell diagram.

    frequencies: Hz; orders: (per revolution, name); speeds, rated: rpm; spread: Hz, of each mode, of what is named.

    barred, tolerated: rpm, of the file's figures and over its tolerances.

    curves: speeds (points,) rpm and frequencies (modes, points) Hz, of modes that move over the speed.
    """
    inside = max((f for _, f, is_inside, _ in crossings if is_inside), default=0.0)
    reached = max((order for order, _ in orders), default=1.0) * speeds[1] / 60.0
    wanted = min(
        (f for f in frequencies if f > inside), default=inside or reached
    )  # one mode above what matters
    top = 1.12 * max(min(wanted, 1.15 * reached), inside, 0.25 * reached, 1e-9)
    right = speeds[1] * 1.12
    shown = [f for f in frequencies if f <= top][:MOST_LINES]
    modes = tuple(
        Level("", f, "plain", label=f"mode {k}: {number(f)} Hz")
        for k, f in enumerate(shown, start=1)
    )
    lines = []
    if curves is not None:
        modes = ()
        for k, mode in enumerate(curves[1][:MOST_LINES], start=1):
            lines.append(
                Line(
                    "",
                    curves[0],
                    np.where(mode <= top, mode, np.nan),
                    "plain",
                    f"mode {k}",
                    label_at="end",
                )
            )
    for pen, (order, words) in enumerate(orders[:MOST_LINES]):
        end = min(right, 60.0 * top / order)
        ends = np.array([0.0, end]), np.array([0.0, order * end / 60.0])
        lines.append(Line(words, *ends, pen, words.removeprefix("order "), label_at="end"))
    within = (Band(of, *ends, "spread", "y") for ends in spread[: len(shown)])
    moved = (Band("barred range over the tolerances", *ends, "spread") for ends in tolerated)
    bands = (Band("speed range", *speeds, "range"), *moved, *within, *barred_bands(barred))
    x, y = replace(SPEED, low=0.0, high=right), Axis("frequency", "Hz", low=0.0, high=top)
    levels = (*modes, *rated_level(rated))
    panel = Panel(
        x, y, tuple(lines), levels, bands, tuple(_met(crossings, right, top)), height=210.0
    )
    return Figure(name, caption, (panel,))


def whirl(
    name: str,
    caption: str,
    *,
    speed: FloatArray,
    frequency: FloatArray,
    direction: FloatArray,
    unstable: BoolArray,
    orders: Sequence[tuple[float, str]],
    crossings: Sequence[Crossing],
    rated: float | None,
) -> Figure:
    """Return the whirl diagram of a shaft.

    speed: (speeds,) rpm; frequency, Hz, direction and unstable: (speeds, modes).

    orders: (frequency of the order at the last speed, Hz; name).
    """
    first, last = float(speed[0]), float(speed[-1])
    right, top = 1.08 * last, _top(frequency, max(hertz for hertz, _ in orders), crossings)
    lines = [
        piece
        for column, sense in zip(frequency.T, direction.T, strict=True)
        for piece in _whirling(speed, column, sense)
    ]
    for hertz, words in orders:
        end = min(right, top / hertz * last)
        ends = np.array([0.0, end]), np.array([0.0, hertz * end / last])
        lines.append(Line("orders", *ends, "pale", words, label_at="end"))
    rows, columns = np.nonzero(unstable)
    grows = Marks("UNSTABLE", speed[rows], frequency[rows, columns], "cross", "unstable")
    x, y = (
        replace(SPEED, low=0.0, high=right),
        Axis("frequency of bending", "Hz", low=0.0, high=top),
    )
    marks = (grows, *_met(crossings, right, top))
    bands = (Band("speed range", first, last, "range"),)
    return Figure(
        name, caption, (Panel(x, y, tuple(lines), rated_level(rated), bands, marks, height=200.0),)
    )


def _whirling(speed: FloatArray, frequency: FloatArray, sense: FloatArray) -> Iterator[Line]:
    """Yield one mode in the pens of its senses; a piece reaches to the next speed, so that there is no gap."""
    above = np.inf
    for lowest, role in SENSES:
        is_sense = (sense >= lowest) & (sense < above)
        above = lowest
        if is_sense.any():
            shown = is_sense | np.append(False, is_sense[:-1])
            yield Line(role, speed, np.where(shown, frequency, np.nan), role)


def _met(crossings: Sequence[Crossing], right: float, top: float) -> Iterator[Marks]:
    """Yield the crossings that lie on the diagram, which goes from nothing to these two ends."""
    for inside, words in (
        (True, "critical speed in the range"),
        (False, "critical speed outside the range"),
    ):
        met = [
            crossing
            for crossing in crossings
            if crossing[2] == inside and crossing[0] <= right and crossing[1] <= top
        ]
        if met:
            x, y = np.array([crossing[:2] for crossing in met]).T
            words_of = tuple(crossing[3] for crossing in met)
            yield Marks(
                words,
                x,
                y,
                "disc" if inside else "cross",
                "plain" if inside else "outside",
                words=words_of,
            )


def _top(frequency: FloatArray, reached: float, crossings: Sequence[Crossing]) -> float:
    """Return the highest frequency shown: what the orders meet, and the modes near above it."""
    inside = max((hertz for _, hertz, is_inside, _ in crossings if is_inside), default=0.0)
    finite = frequency[np.isfinite(frequency)]
    lowest = float(finite.min()) if finite.size else 0.0
    near = finite[finite <= AHEAD * reached]
    return 1.1 * max(inside, float(near.max()) if near.size else 1.2 * lowest, reached)
