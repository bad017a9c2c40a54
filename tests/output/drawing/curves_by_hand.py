"""Curves of any numbers, as chapters draw them of results: for tests of drawings."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.curves import (
    MOST_LINES,
    SPEED,
    TOTAL,
    Bands,
    Crossing,
    Lines,
    amplitudes,
    barred_bands,
    highest_shown,
    met,
    orders,
    rated_level,
    span,
    unanswered,
    whirling,
)
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Marks, Panel, Role
from torsion.output.numbers import number

STANDING = "nearly singular: next to a resonance that nothing damps"
NO_ANSWER = "singular: no answer"
SMALL = 0.1  # of the limit: a smaller stress has a plot of its own, as it would lie on the axis
STRESS = ("shear stress amplitude", "N/mm²")
NEAR = 4.0  # times the largest value: a limit up to there is on the axis


def torque(
    name: str,
    caption: str,
    *,
    speed: FloatArray,
    lines: Lines,
    synthesis: FloatArray | None,
    bad: BoolArray,
    unit: str,
    limits: Sequence[tuple[str, float]] = (),
    rated: float | None = None,
    barred: Bands = (),
    unstable: Bands = (),
) -> Figure:
    """Return the torque of one element over the speed: its orders, and their total where there is one.

    speed, bad: (speeds,) rpm; lines: (name, (speeds,)) and synthesis in `unit`, NaN where there is no answer.
    """
    hidden, bands = unanswered(speed, bad)
    drawn = orders(speed, lines, hidden)
    values = [line.y for line in drawn]
    if synthesis is not None:
        values = [np.where(hidden, np.nan, synthesis)]
        drawn = (Line(TOTAL, speed, values[0], "synthesis"), *drawn)
    near = [limit for _, limit in limits if limit <= NEAR * max(map(_highest, values), default=0.0)]
    levels = tuple(Level(words, limit, is_reached=limit in near) for words, limit in limits)
    panel = Panel(
        span(SPEED, speed),
        amplitudes("torque amplitude", unit, values, near),
        drawn,
        levels + rated_level(rated),
        barred_bands(barred, unstable) + bands,
    )
    return Figure(name, caption, (panel,))


def stress(
    name: str,
    caption: str,
    *,
    speed: FloatArray,
    synthesis: FloatArray,
    bad: BoolArray,
    lines: Lines = (),
    continuous: FloatArray | None = None,
    transient: FloatArray | None = None,
    rated: float | None = None,
    barred: Bands = (),
) -> Figure:
    """Return the shear stress of one shaft; a stress far below its limit has a plot of its own below the other.

    speed: (speeds,) rpm; stresses (speeds,) N/mm2, NaN where there is no limit; lines: (name, (speeds,)) of orders.
    """
    hidden, bands = unanswered(speed, bad)
    total = Line("total stress", speed, np.where(hidden, np.nan, synthesis), "synthesis")
    stresses = (total, *orders(speed, lines, hidden))
    given: tuple[tuple[str, FloatArray | None, Role], ...] = (
        ("limit τ_{C}, continuous", continuous, "limit"),
        ("limit τ_{T}, passing rapidly", transient, "second limit"),
    )
    limits = tuple(
        Line(words, speed, values, pen)
        for words, values, pen in given
        if values is not None and np.any(np.isfinite(values))
    )
    x, levels, behind = span(SPEED, speed), rated_level(rated), barred_bands(barred) + bands
    lowest = min((float(np.nanmin(line.y)) for line in limits), default=0.0)
    if not _highest(total.y) < SMALL * lowest:
        y = amplitudes(*STRESS, [total.y], [float(np.nanmax(line.y)) for line in limits])
        return Figure(name, caption, (Panel(x, y, stresses + limits, levels, behind),))
    both, y = Axis("stress and limits", "N/mm²", low=0.0), amplitudes(*STRESS, [total.y])
    return Figure(
        name,
        caption,
        (
            Panel(x, both, (total, *limits), levels, behind, height=75.0),
            Panel(x, y, stresses, levels, behind, height=105.0),
        ),
    )


def _highest(values: FloatArray) -> float:
    return float(np.max(values, where=np.isfinite(values), initial=0.0))


def gear(
    name: str,
    caption: str,
    *,
    speed: FloatArray,
    vibratory: FloatArray,
    mean: FloatArray | None,
    bad: BoolArray,
    unit: str,
    limit: float | None = None,
    rated: float | None = None,
    barred: Bands = (),
) -> Figure:
    """Return vibratory and mean torque in one gear mesh; speed: (speeds,) rpm; torques (speeds,) in `unit`."""
    hidden, bands = unanswered(speed, bad)
    total = np.where(hidden, np.nan, vibratory)
    lines = [Line(TOTAL, speed, total, "synthesis")]
    if mean is not None:
        lines.append(Line("mean torque", speed, mean, 0))
        over = np.where(total > mean, total, np.nan)
        if np.isfinite(over).any():
            lines.append(Line("torque reverses", speed, over, "limit", weight=0.0, base=mean))
    limits = [] if limit is None else [limit]
    levels = [Level("limit of the vibratory torque", value, is_reached=True) for value in limits]
    panel = Panel(
        span(SPEED, speed),
        amplitudes("mesh torque", unit, [total], limits),
        tuple(lines),
        (*levels, *rated_level(rated)),
        barred_bands(barred) + bands,
    )
    return Figure(name, caption, (panel,))


def frequency(
    name: str,
    caption: str,
    *,
    frequency: FloatArray,
    lines: Lines,
    bad: BoolArray,
    quantity: str,
    unit: str,
    natural: Sequence[float] = (),
) -> Figure:
    """Return the strongest curves over the frequency.

    frequency: (frequencies,) Hz; lines: (name, (frequencies,)) in `unit`; natural: Hz.
    """
    hidden, bands = unanswered(frequency, bad)
    drawn = [np.where(hidden | (values <= 0), np.nan, values) for _, values in lines[:MOST_LINES]]
    curves = tuple(
        Line(words, frequency, values, pen)
        for pen, ((words, _), values) in enumerate(zip(lines, drawn, strict=False))
    )
    levels = tuple(
        Level("natural frequencies", hertz, "natural", "x")
        for hertz in natural
        if frequency[0] <= hertz <= frequency[-1]
    )
    x = span(Axis("frequency", "Hz"), frequency)
    return Figure(
        name,
        caption,
        (Panel(x, amplitudes(quantity, unit, drawn), curves, levels, bands, height=150.0),),
    )


def bending(
    name: str,
    caption: str,
    *,
    speed: Sequence[FloatArray],
    orders: Sequence[str],
    panels: Sequence[tuple[str, str, Sequence[FloatArray]]],
    near: Sequence[BoolArray],
    singular: Sequence[BoolArray],
    rated: float | None,
    crossings: Sequence[float],
) -> Figure:
    """Return curves of every order over its own speeds, rpm; panels: (quantity, unit, a curve for each order).

    near, singular: of every order (speeds,), its speeds that are not to be trusted. crossings: rpm of critical speeds.
    """
    levels = tuple(
        Level("critical speeds of these orders", critical, "natural", "x") for critical in crossings
    ) + rated_level(rated)
    bands = tuple(
        band
        for speeds, unanswerable in zip(speed, singular, strict=True)
        for band in unanswered(speeds, unanswerable, NO_ANSWER)[1]
    )
    made, x = [], span(SPEED, np.concatenate(list(speed)))
    for quantity, unit, curves in panels:
        lines, marks = [], []
        for k, (words, speeds, curve) in enumerate(zip(orders, speed, curves, strict=True)):
            sound = np.where(near[k] | singular[k], np.nan, curve)
            lines.append(Line(words, speeds, sound, k, words.split(",")[0].removeprefix("order ")))
            marks.append(Marks(STANDING, speeds[near[k]], curve[near[k]], "cross", "unstable"))
        y = amplitudes(quantity, unit, curves)
        made.append(Panel(x, y, tuple(lines), levels, bands, tuple(marks), height=90.0))
    return Figure(name, caption, tuple(made))


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
        x, y, tuple(lines), levels, bands, tuple(met(crossings, right, top)), height=210.0
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
    right, top = 1.08 * last, highest_shown(frequency, max(hertz for hertz, _ in orders), crossings)
    lines = [
        piece
        for column, sense in zip(frequency.T, direction.T, strict=True)
        for piece in whirling(speed, column, sense)
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
    marks = (grows, *met(crossings, right, top))
    bands = (Band("speed range", first, last, "range"),)
    return Figure(
        name, caption, (Panel(x, y, tuple(lines), rated_level(rated), bands, marks, height=200.0),)
    )
