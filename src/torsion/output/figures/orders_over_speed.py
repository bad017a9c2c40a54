"""Orders of a torque while the speed changes: curves, and a waterfall in shades that are dark where it is large."""

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Cells, Figure, Panel
from torsion.output.figures.ranges import Lines, amplitudes, span
from torsion.output.figures.ranges import orders as drawn_orders

DECADES = 3.0  # below the largest amplitude that shades show
TORQUE = "torque amplitude"


def orders(
    name: str, caption: str, *, over: Axis, x: FloatArray, lines: Lines, unit: str
) -> Figure:
    """Return curves over x: (windows,) ascending, on the axis `over`; lines: (name, (windows,) in `unit`)."""
    drawn = drawn_orders(x, lines, np.zeros(len(x), dtype=bool))
    y = amplitudes(TORQUE, unit, [values for _, values in lines])
    return Figure(name, caption, (Panel(span(over, x), y, drawn),))


def waterfall(
    name: str,
    caption: str,
    *,
    over: Axis,
    y: FloatArray,
    order: FloatArray,
    amplitude: FloatArray,
    reference: str,
    unit: str,
) -> Figure:
    """Return the cells of y: (windows,) on the axis `over`; order: (orders,); amplitude: (windows, orders) in `unit`."""
    largest = float(amplitude.max(initial=0.0)) or 1.0
    cells = Cells(order, y, amplitude, TORQUE, unit, largest, DECADES)
    x = Axis(f"order of {reference}", "", 0.0, float(order[-1]))
    return Figure(name, caption, (Panel(x, span(over, y), cells=cells, height=210.0),))
