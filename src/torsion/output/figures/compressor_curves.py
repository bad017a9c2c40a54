"""Compressors: pressures of the ends over the crank angle, and the torque that each throw takes."""

from collections.abc import Mapping, Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import span


def pressures(
    name: str, caption: str, curves: Sequence[tuple[str, FloatArray, FloatArray]]
) -> Figure:
    """Of every end its name, angles (deg) and pressures (`bar`)."""
    x = span(
        Axis("crank angle from the dead centre of the head end", "deg"),
        np.concatenate([one[1] for one in curves]),
    )
    lines = tuple(Line(own, at, size, k, weight=1.5) for k, (own, at, size) in enumerate(curves))
    return Figure(name, caption, (Panel(x, Axis("pressure, absolute", "bar", low=0.0), lines),))


def effort(
    name: str, caption: str, angle: FloatArray, throws: Mapping[str, FloatArray], unit: str
) -> Figure:
    """Torques (angles,) of every throw, and their sum with its mean."""
    lines = [Line(own, angle, torque, k + 1) for k, (own, torque) in enumerate(throws.items())]
    whole = np.sum(list(throws.values()), axis=0)
    if len(lines) > 1:
        lines.insert(0, Line("all throws", angle, whole, 0, weight=2.0))
    levels = (
        Level("", 0.0, "zero"),
        Level("mean", float(whole[:-1].mean()), "rated", label="mean"),
    )
    panel = Panel(
        span(Axis("crank angle from reference angle zero", "deg"), angle),
        Axis("torque", unit),
        tuple(lines),
        levels,
    )
    return Figure(name, caption, (panel,))
