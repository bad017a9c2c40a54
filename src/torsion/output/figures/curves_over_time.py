"""Torques and speeds over time."""

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Line, Panel
from torsion.output.figures.ranges import Lines, span


def over_time(name: str, caption: str, *, time: FloatArray, lines: Lines, quantity: str, unit: str) -> Figure:
    """time: (samples,) s; lines: (name, (samples,)) in `unit`."""
    drawn = tuple(Line(words, time, values, pen) for pen, (words, values) in enumerate(lines))
    return Figure(name, caption, (Panel(span(Axis("time", "s"), time), Axis(quantity, unit), drawn, height=130.0),))
