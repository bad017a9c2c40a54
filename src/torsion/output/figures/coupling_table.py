"""Stiffness and loss factor of a coupling over what its table is over."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Line, Marks, Panel

ROOM = 0.015  # of the range, free beyond its ends for the symbols


def coupling_table(
    name: str,
    caption: str,
    *,
    over: Axis,
    at: FloatArray,
    stiffness: FloatArray,
    unit: str,
    loss_factor: FloatArray,
    modes: Sequence[tuple[float, float, str]] = (),
) -> Figure:
    """Return the curves of a table; at, stiffness (in `unit`), loss_factor: (points,); modes: place, stiffness, words."""
    room = ROOM * float(at[-1] - at[0])
    x = Axis(over.quantity, over.unit, float(at[0]) - room, float(at[-1]) + room)
    places, values = np.array([mode[:2] for mode in modes]).reshape(-1, 2).T
    marks = Marks(
        "modes", places, values, "disc", "natural", words=tuple(mode[2] for mode in modes)
    )
    curve = Line("stiffness", at, stiffness, symbol="box")
    panels = [Panel(x, Axis("stiffness", unit, low=0.0), (curve,), marks=(marks,) if modes else ())]
    if loss_factor.any():
        lines = (Line("loss factor", at, loss_factor, 1, symbol="box"),)
        panels.append(Panel(x, Axis("loss factor", "", low=0.0), lines, height=95.0))
    return Figure(name, caption, tuple(panels))
