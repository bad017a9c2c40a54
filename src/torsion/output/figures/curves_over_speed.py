"""Torques, stresses, bending and growth rates as curves over the speed, or over the frequency."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Band, Cells, Figure, Level, Line, Marks, Panel
from torsion.output.figures.ranges import (
    SPEED,
    rated_level,
    span,
    unanswered,
)
from torsion.output.numbers import RPM

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
