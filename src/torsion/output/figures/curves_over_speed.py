"""Torques, stresses, bending and growth rates as curves over the speed, or over the frequency."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.figure import Axis, Band, Cells, Figure, Level, Line, Marks, Panel, Role
from torsion.output.figures.ranges import (
    MOST_LINES,
    SPEED,
    Bands,
    Lines,
    amplitudes,
    barred_bands,
    orders,
    rated_level,
    span,
    unanswered,
)
from torsion.output.numbers import RPM

STANDING = "nearly singular: next to a resonance that nothing damps"
NO_ANSWER = "singular: no answer"
NO_MOTION = "no periodic motion found"
SHARE = 0.98  # of the points lie within the colours of a map; the others have the last one
HEAD = 0.25  # of the height: room above a growth rate for the names of the ranges
SMALL = 0.1  # of the limit: a smaller stress has a plot of its own, as it would lie on the axis
STRESS = ("shear stress amplitude", "N/mm²")
TOTAL = "total vibratory torque"
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


def stability(
    name: str,
    caption: str,
    speed: FloatArray,
    growth: FloatArray,
    ranges: Sequence[Any],
    rated: float | None,
) -> Figure:
    """Return the growth rate over the speed, with room above it for the names of the unstable ranges.

    speed: (speeds,) rad/s; growth: (speeds,) 1/s, NaN where there is no periodic motion; rated: rpm.
    """
    growth, grows = np.asarray(growth), np.zeros(len(speed), dtype=bool)
    _, bands = unanswered(x := speed * RPM, ~np.isfinite(growth), NO_MOTION)
    unstable = list[Band]()
    for band in ranges:
        ends = band.first * RPM, band.last * RPM
        unstable.append(Band("unstable range", *ends, "unstable", label=band.name))
        grows |= (speed >= band.first) & (speed <= band.last) & (growth > 0)
    values = np.append(growth[np.isfinite(growth)], 0.0)
    room = HEAD * float(np.ptp(values))
    panel = Panel(
        span(SPEED, x),
        Axis("growth rate", "1/s", high=float(values.max()) + room if room and ranges else None),
        (Line("growth rate", x, growth, "plain", symbol="dot"),),
        (Level("", 0.0, "zero", is_reached=True), *rated_level(rated)),
        (*unstable, *bands),
        (Marks("unstable", x[grows], growth[grows], "disc", "unstable"),),
        height=200.0,
    )
    return Figure(name, caption, (panel,))


def stability_map(
    caption: str,
    speed: FloatArray,
    axis: Axis,
    value: FloatArray,
    growth: FloatArray,
    rated: float | None,
) -> Figure:
    """Return the growth rate as colours; speed: (speeds,) rad/s; value: (values,); growth: (speeds, values) 1/s or NaN."""
    finite, x = growth[np.isfinite(growth)], speed * RPM
    largest = float(np.quantile(np.abs(finite), SHARE)) if finite.size else 1.0
    cells = Cells(x, value, growth.T, "growth rate", "1/s", largest or 1.0)
    unknown = Band(NO_MOTION, float(x[0]), float(x[-1]), "no answer")
    bands = (unknown,) if finite.size < growth.size else ()
    axes = span(SPEED, x), span(axis, value)
    panel = Panel(*axes, (), rated_level(rated), bands, cells=cells, height=190.0)
    return Figure("stability-map", caption, (panel,))
