"""What figures have in common: ranges without an answer, the rated speed, and an axis of amplitudes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.figure import (
    Axis,
    Band,
    Cells,
    Figure,
    Level,
    Line,
    Marks,
    Panel,
    Role,
    runs,
)
from torsion.output.numbers import RPM

Bands = tuple[tuple[float, float], ...]
Lines = Sequence[tuple[str, FloatArray]]
SPEED = Axis("speed of the reference component", "rpm")
NO_RELIABLE_ANSWER = "no reliable answer here"
LEAST = 2e-3  # of the axis: the width of a range about a single speed, so that it can be seen
LOGARITHMIC = 30.0  # times the median: a larger peak makes the axis logarithmic
MOST_DECADES = 1e7  # from the lowest to the highest value of a logarithmic axis
MAIN = 1.8  # times the width of other lines: of the one that matters most
MOST_LINES = 12  # in one figure
MOST_ORDERS, LARGEST = (
    8,
    7,
)  # orders in one figure; of more the largest and the envelope of the others


def unanswered(
    x: FloatArray, bad: BoolArray, name: str = NO_RELIABLE_ANSWER
) -> tuple[BoolArray, tuple[Band, ...]]:
    """Return ranges where `bad` holds, from neighbour to neighbour, and (points,) those inside, which are left blank."""
    inside, bands = np.array(bad, dtype=bool), list[Band]()
    narrowest = float(x[-1] - x[0]) * LEAST
    for first, last in runs(inside.copy()):
        left, right = float(x[max(first - 1, 0)]), float(x[min(last + 1, len(x) - 1)])
        if right - left < narrowest:
            middle = (left + right) / 2
            left, right = middle - narrowest / 2, middle + narrowest / 2
        inside |= (x > left) & (x < right)
        bands.append(Band(name, left, right, "no answer"))
    return inside, tuple(bands)


def barred_bands(barred: Bands, unstable: Bands = ()) -> tuple[Band, ...]:
    """Return the bands of the barred and the unstable ranges of speed, rpm."""
    return (
        *(Band("barred range", low, high, "barred") for low, high in barred),
        *(Band("unstable range", low, high, "unstable") for low, high in unstable),
    )


def rated_level(rated: float | None) -> tuple[Level, ...]:
    """Return the rated speed, rpm, where there is one."""
    return () if rated is None else (Level("rated speed", rated, "rated", "x"),)


def amplitudes(
    quantity: str, unit: str, values: Sequence[FloatArray], limits: Sequence[float] = ()
) -> Axis:
    """Return an axis from zero, or in logarithms where a resonance would leave all else on the axis; as far as the limits."""
    known = np.concatenate([np.zeros(0), *map(np.ravel, values)])
    positive = known[np.isfinite(known) & (known > 0)]
    if positive.size == 0 or positive.max() <= LOGARITHMIC * np.median(positive):
        return Axis(quantity, unit, low=0.0)
    largest = float(positive.max())
    low = max(float(positive.min()), largest / MOST_DECADES) / 1.5
    high = max([2.0 * largest, *(1.5 * limit for limit in limits)])
    return Axis(quantity, unit, low, high, is_log=True)


def orders(x: FloatArray, lines: Lines, hidden: BoolArray) -> tuple[Line, ...]:
    """Return one line an order, its number at its peak; the order with the largest value is heavier.

    Of more than MOST_ORDERS the largest are drawn, and at every place the largest value of the others. An order of
    nothing is left out.
    """
    drawn = [(name, np.where(hidden, np.nan, values)) for name, values in lines]
    sizes = [float(np.max(values, where=np.isfinite(values), initial=0.0)) for _, values in drawn]
    ranked = [k for k in sorted(range(len(sizes)), key=lambda k: -sizes[k]) if sizes[k] > 0]
    shown = ranked if len(ranked) <= MOST_ORDERS else ranked[:LARGEST]
    drawn_lines = []
    for pen, k in enumerate(sorted(shown)):
        name, values = drawn[k]
        weight = MAIN if len(sizes) > 1 and k == ranked[0] else 1.0
        label = name.removeprefix("order ")
        drawn_lines.append(Line(name, x, values, pen, label, weight=weight))
    if remaining := ranked[len(shown) :]:
        largest = np.fmax.reduce([drawn[k][1] for k in remaining])
        drawn_lines.append(Line(f"envelope of the other {len(remaining)}", x, largest, "pale"))
    return tuple(drawn_lines)


def span(axis: Axis, x: FloatArray) -> Axis:
    """Return the axis from the first to the last value."""
    return Axis(axis.quantity, axis.unit, float(np.min(x)), float(np.max(x)))


NO_MOTION = "no periodic motion found"
SHARE = 0.98  # of the points lie within the colours of a map; the others have the last one
HEAD = 0.25  # of the height: room above a growth rate for the names of the ranges
TOTAL = "total vibratory torque"


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


NEAR = 4.0  # times the largest value: the axis goes as far as a limit up to there
INSET = 0.04  # of the time on either side of the peak, in the second plot
FEWEST = 100  # samples of a motion whose peak has a plot of its own


def over_time(
    name: str,
    caption: str,
    time: FloatArray,
    lines: Lines,
    axis: Axis,
    limits: Sequence[tuple[str, float]] = (),
    *,
    has_peak: bool = False,
) -> Figure:
    """Draw lines over time (samples,) s, and once more near the peak of the first; limits are in the unit of the axis."""
    drawn = tuple(Line(words, time, values, pen) for pen, (words, values) in enumerate(lines))
    size = max(float(np.nanmax(np.abs(line.y))) for line in drawn)
    levels = tuple(
        Level(words, limit, is_reached=abs(limit) <= NEAR * size) for words, limit in limits
    )
    panels = [Panel(span(Axis("time", "s"), time), axis, drawn, levels)]
    if has_peak and time.size >= FEWEST:
        peak, half = float(time[np.nanargmax(np.abs(drawn[0].y))]), INSET * float(np.ptp(time))
        low, high = max(peak - half, float(time[0])), min(peak + half, float(time[-1]))
        inside = (time >= low) & (time <= high)
        near = tuple(
            replace(line, x=time[inside], y=line.y[inside], symbol="dot") for line in drawn
        )
        x = Axis("time near the peak", "s", low, high)
        panels.append(Panel(x, axis, near, levels, height=80.0))
    return Figure(name, caption, tuple(panels))


Drawn = tuple[Axis, float, Lines]  # axis, the size by which rounding is judged, lines
WEIGHTS = (2.0, 1.1)  # of the first and the last line, so that lines that coincide are both seen
FLAT = 1e-9  # of the size by which rounding is judged: a smaller range is shown as a level line


def joint_turn(
    name: str, caption: str, angle: FloatArray, panels: Sequence[Drawn], joint: str
) -> Figure:
    """Draw lines (name, (angles,)), each with its pen, over the angle (rad) of the shaft upstream of a joint."""
    names = list(dict.fromkeys(words for *_, lines in panels for words, _ in lines))[:MOST_LINES]
    weights = np.linspace(*WEIGHTS, max(len(names), 2)).tolist()
    turn, made = np.degrees(angle), []
    x = span(Axis(f"angle of the shaft upstream of {joint}", "deg"), turn)
    for axis, size, lines in panels:
        kept = [(names.index(words), words, values) for words, values in lines if words in names]
        drawn = tuple(
            Line(words, turn, y, k, words * (len(kept) > 2), "anywhere", weight=weights[k])
            for k, words, y in kept
        )
        low, high = (float(end([end(y) for *_, y in kept])) for end in (np.min, np.max))
        # Rounding is kept from filling a plot whose values do not vary.
        room = 0.1 * max(abs(low), size) or 1.0
        flat = replace(axis, low=low - room, high=high + room)
        y_axis = axis if high - low > FLAT * size else flat
        made.append(Panel(x, y_axis, drawn, (Level("", 0.0, "zero"),), height=72.0))
    return Figure(name, caption, tuple(made))


Crossing = tuple[float, float, bool, str]  # rpm, Hz, inside the speed range, what meets what
SENSES: tuple[
    tuple[float, Role], ...
] = (  # least direction; an orbit between is nearly a straight line
    (0.1, "forward"),
    (-0.1, "nearly in a plane"),
    (-2.0, "backward"),
)
AHEAD = 1.6  # times the highest frequency that an order reaches: so far up a mode is shown though no order meets it


def whirling(speed: FloatArray, frequency: FloatArray, sense: FloatArray) -> Iterator[Line]:
    """Yield one mode in the pens of its senses; a piece reaches to the next speed, so that there is no gap."""
    above = np.inf
    for lowest, role in SENSES:
        is_sense = (sense >= lowest) & (sense < above)
        above = lowest
        if is_sense.any():
            shown = is_sense | np.append(False, is_sense[:-1])
            yield Line(role, speed, np.where(shown, frequency, np.nan), role)


def met(crossings: Sequence[Crossing], right: float, top: float) -> Iterator[Marks]:
    """Yield the crossings that lie on the diagram, which goes from nothing to these two ends."""
    for inside in (True, False):
        met = [
            (rpm, hertz, words)
            for rpm, hertz, is_inside, words in crossings
            if is_inside == inside and rpm <= right and hertz <= top
        ]
        if met:
            x, y, words = zip(*met, strict=True)
            name = f"critical speed {'in' if inside else 'outside'} the range"
            marks = Marks(name, np.array(x), np.array(y), words=words)
            yield marks if inside else replace(marks, symbol="cross", pen="outside")


def highest_shown(frequency: FloatArray, reached: float, crossings: Sequence[Crossing]) -> float:
    """Return the highest frequency shown: what the orders meet, and the modes near above it."""
    inside = max((hertz for _, hertz, is_inside, _ in crossings if is_inside), default=0.0)
    finite = frequency[np.isfinite(frequency)]
    lowest = float(finite.min()) if finite.size else 0.0
    near = finite[finite <= AHEAD * reached]
    return 1.1 * max(inside, float(near.max()) if near.size else 1.2 * lowest, reached)
