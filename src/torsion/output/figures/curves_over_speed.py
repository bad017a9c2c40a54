"""Torques, stresses, bending and growth rates as curves over the speed, or over the frequency."""

from collections.abc import Sequence

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

STANDING = "nearly singular: next to a resonance that nothing damps"
NO_ANSWER = "singular: no answer"
NO_MOTION = "no periodic motion found"
SHARE = 0.98  # of the points lie within the colours of a map; the others have the last one
HEAD = 0.25  # of the height: room above a growth rate for the names of the ranges
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
    """speed, bad: (speeds,) rpm; lines: (name, (speeds,)) and synthesis in `unit`, NaN where there is no answer."""
    hidden, bands = unanswered(speed, bad)
    drawn = orders(speed, lines, hidden)
    values = [line.y for line in drawn]
    if synthesis is not None:
        values = [np.where(hidden, np.nan, synthesis)]
        drawn = (Line("total vibratory torque", speed, values[0], "synthesis"), *drawn)
    top = max(
        (float(np.max(one, where=np.isfinite(one), initial=0.0)) for one in values), default=0.0
    )
    near = [limit for _, limit in limits if limit <= NEAR * top]
    y = amplitudes("torque amplitude", unit, values, near)
    levels = tuple(Level(words, limit, is_reached=limit in near) for words, limit in limits)
    return Figure(
        name,
        caption,
        (
            Panel(
                span(SPEED, speed),
                y,
                drawn,
                levels + rated_level(rated),
                barred_bands(barred, unstable) + bands,
            ),
        ),
    )


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
    """Shear stress of one shaft; speed: (speeds,) rpm; stresses (speeds,) N/mm2, NaN where there is no limit.

    lines: (name, (speeds,)) of single orders. A stress far below its limit has a plot of its own below the other.
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
    x, behind, rated_at = span(SPEED, speed), barred_bands(barred) + bands, rated_level(rated)
    largest = float(np.max(total.y, where=np.isfinite(total.y), initial=0.0))
    least = min((float(np.nanmin(line.y)) for line in limits), default=0.0)
    if not largest < SMALL * least:
        y = amplitudes(*STRESS, [total.y], [float(np.nanmax(line.y)) for line in limits])
        return Figure(name, caption, (Panel(x, y, stresses + limits, rated_at, behind),))
    y = amplitudes(*STRESS, [total.y])
    both = Panel(
        x,
        Axis("stress and limits", "N/mm²", low=0.0),
        (total, *limits),
        rated_at,
        behind,
        height=75.0,
    )
    return Figure(name, caption, (both, Panel(x, y, stresses, rated_at, behind, height=105.0)))


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
    """Vibratory against mean torque in one gear mesh; speed: (speeds,) rpm; torques (speeds,) in `unit`."""
    hidden, bands = unanswered(speed, bad)
    good = np.where(hidden, np.nan, vibratory)
    lines = [Line("total vibratory torque", speed, good, "synthesis")]
    if mean is not None:
        lines.append(Line("mean torque", speed, mean, 0))
        over = np.where(good > mean, good, np.nan)
        if np.isfinite(over).any():
            lines.append(Line("torque reverses", speed, over, "limit", weight=0.0, base=mean))
    levels = (
        [Level("limit of the vibratory torque", limit, is_reached=True)]
        if limit is not None
        else []
    )
    y = amplitudes("mesh torque", unit, [good], [] if limit is None else [limit])
    return Figure(
        name,
        caption,
        (
            Panel(
                span(SPEED, speed),
                y,
                tuple(lines),
                (*levels, *rated_level(rated)),
                barred_bands(barred) + bands,
            ),
        ),
    )


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
    """frequency: (frequencies,) Hz; lines: (name, (frequencies,)) in `unit`; natural: Hz."""
    hidden, bands = unanswered(frequency, bad)
    drawn = [np.where(hidden | (values <= 0), np.nan, values) for _, values in lines[:MOST_LINES]]
    curves = tuple(
        Line(words, frequency, values, pen)
        for pen, ((words, _), values) in enumerate(zip(lines, drawn, strict=False))
    )
    levels = tuple(
        Level("natural frequencies", at, "natural", "x")
        for at in natural
        if frequency[0] <= at <= frequency[-1]
    )
    x = span(Axis("frequency", "Hz"), frequency)
    return Figure(
        name,
        caption,
        (Panel(x, amplitudes(quantity, unit, drawn), curves, levels, bands, height=150.0),),
    )


def periodic(
    name: str,
    caption: str,
    *,
    first_speed: FloatArray,
    speed: FloatArray,
    lines: Sequence[tuple[str, FloatArray | None, FloatArray]],
    unit: str,
    none: BoolArray,
    coarse: BoolArray,
    grows: BoolArray,
    unstable: Bands = (),
    rated: float | None = None,
) -> Figure:
    """Speeds in rpm; lines: (name, (first speeds,) or None, (speeds,)) in `unit`, NaN where there is no answer.

    none, coarse, grows: (speeds,) no periodic motion, not resolved, unstable.
    """
    _, bands = unanswered(speed, none, NO_MOTION)
    drawn, marks = list[Line](), list[Marks]()
    for k, (words, first, exact) in enumerate(lines):
        drawn.append(
            Line(
                f"{words}, exact",
                speed,
                exact,
                2 * k,
                words.removeprefix("order "),
                weight=1.7,
                symbol="dot",
            )
        )
        if first is not None:
            drawn.append(Line(f"{words}, first order", first_speed, first, 2 * k + 1))
        marks.append(Marks("unstable motion", speed[grows], exact[grows], "cross", "unstable"))
        marks.append(Marks("not resolved", speed[coarse], exact[coarse], "box", "unstable"))
    y = amplitudes("torque amplitude", unit, [line.y for line in drawn])
    x = span(SPEED, np.append(first_speed, speed))
    panel = Panel(
        x,
        y,
        tuple(drawn),
        rated_level(rated),
        barred_bands((), unstable) + bands,
        tuple(marks),
        height=140.0,
    )
    return Figure(name, caption, (panel,))


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
    """Curves of every order over its own speeds, rpm; panels: (quantity, unit, a curve for each order).

    near, singular: of every order (speeds,), its speeds that are not to be trusted. crossings: rpm of critical speeds.
    """
    levels = tuple(
        Level("critical speeds of these orders", at, "natural", "x") for at in crossings
    ) + rated_level(rated)
    bands = tuple(
        band
        for at, none in zip(speed, singular, strict=True)
        for band in unanswered(at, none, NO_ANSWER)[1]
    )
    made, x = [], span(SPEED, np.concatenate(list(speed)))
    for quantity, unit, curves in panels:
        lines, marks = [], []
        for k, (words, at, curve) in enumerate(zip(orders, speed, curves, strict=True)):
            sound = np.where(near[k] | singular[k], np.nan, curve)
            lines.append(Line(words, at, sound, k, words.split(",")[0].removeprefix("order ")))
            marks.append(Marks(STANDING, at[near[k]], curve[near[k]], "cross", "unstable"))
        y = amplitudes(quantity, unit, curves)
        made.append(Panel(x, y, tuple(lines), levels, bands, tuple(marks), height=90.0))
    return Figure(name, caption, tuple(made))


def stability(
    name: str,
    caption: str,
    *,
    speed: FloatArray,
    growth: FloatArray,
    unstable: Sequence[tuple[float, float, str]],
    rated: float | None = None,
) -> Figure:
    """speed: (speeds,) rpm; growth: (speeds,) 1/s, NaN where there is no periodic motion; unstable: rpm and name."""
    _, missing = unanswered(speed, ~np.isfinite(growth), NO_MOTION)
    ranges = tuple(
        Band("unstable range", low, high, "unstable", label=words) for low, high, words in unstable
    )
    inside = np.array(
        [any(low <= n <= high for low, high, _ in unstable) for n in speed.tolist()], dtype=bool
    )
    grows = inside & (growth > 0)
    line = Line("growth rate", speed, growth, "plain", symbol="dot")
    marks = (Marks("unstable", speed[grows], growth[grows], "disc", "unstable"),)
    levels = (Level("", 0.0, "zero", is_reached=True), *rated_level(rated))
    panel = Panel(
        span(SPEED, speed),
        _growth_axis(growth, has_names=bool(unstable)),
        (line,),
        levels,
        ranges + missing,
        marks,
        height=200.0,
    )
    return Figure(name, caption, (panel,))


def _growth_axis(growth: FloatArray, *, has_names: bool) -> Axis:
    """From the data, with room for names above them."""
    known = growth[np.isfinite(growth)]
    if not has_names or known.size == 0:
        return Axis("growth rate", "1/s")
    top, low = max(float(known.max()), 0.0), min(float(known.min()), 0.0)
    return Axis("growth rate", "1/s", high=top + HEAD * (top - low))


def stability_map(
    name: str,
    caption: str,
    *,
    speed: FloatArray,
    value: FloatArray,
    growth: FloatArray,
    quantity: str,
    unit: str,
    rated: float | None = None,
) -> Figure:
    """speed: (speeds,) rpm; value: (values,); growth: (speeds, values) 1/s, NaN where there is no periodic motion."""
    known = growth[np.isfinite(growth)]
    largest = float(np.quantile(np.abs(known), SHARE)) if known.size else 1.0
    cells = Cells(speed, value, growth.T, "growth rate", "1/s", largest or 1.0)
    behind = (
        (Band(NO_MOTION, float(speed[0]), float(speed[-1]), "no answer"),)
        if known.size < growth.size
        else ()
    )
    x, y = span(SPEED, speed), span(Axis(quantity, unit), value)
    return Figure(
        name, caption, (Panel(x, y, (), rated_level(rated), behind, cells=cells, height=190.0),)
    )
