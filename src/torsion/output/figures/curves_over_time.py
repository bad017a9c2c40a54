"""Torques and speeds over time."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import Lines, span

NEAR = 4.0  # times the largest value: the axis goes as far as a limit up to there
INSET = 0.04  # of the time on either side of the peak, in the second plot
FEWEST = 100  # samples of a motion whose peak has a plot of its own


def over_time(
    name: str,
    caption: str,
    *,
    time: FloatArray,
    lines: Lines,
    quantity: str,
    unit: str,
    limits: Sequence[tuple[str, float]] = (),
    has_peak: bool = False,
) -> Figure:
    """time: (samples,) s; lines: (name, (samples,)) and limits in `unit`; the peak is that of the first line."""
    drawn = tuple(Line(words, time, values, pen) for pen, (words, values) in enumerate(lines))
    size = max(float(np.nanmax(np.abs(line.y))) for line in drawn)
    levels = tuple(
        Level(words, limit, is_reached=abs(limit) <= NEAR * size) for words, limit in limits
    )
    panels = [
        Panel(span(Axis("time", "s"), time), Axis(quantity, unit), drawn, levels, height=130.0)
    ]
    if has_peak and time.size >= FEWEST:
        panels.append(_inset(time, drawn, levels, quantity, unit))
    return Figure(name, caption, tuple(panels))


def _inset(
    time: FloatArray, lines: tuple[Line, ...], levels: tuple[Level, ...], quantity: str, unit: str
) -> Panel:
    """The same lines near the peak of the first."""
    peak = float(time[np.nanargmax(np.abs(lines[0].y))])
    half = INSET * float(np.ptp(time))
    low, high = max(peak - half, float(time[0])), min(peak + half, float(time[-1]))
    inside = (time >= low) & (time <= high)
    cut = tuple(
        Line(line.name, line.x[inside], line.y[inside], line.pen, symbol="dot") for line in lines
    )
    return Panel(
        Axis("time near the peak", "s", low, high), Axis(quantity, unit), cut, levels, height=80.0
    )
