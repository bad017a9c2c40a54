"""Torques and speeds over time."""

from collections.abc import Sequence
from dataclasses import replace

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
