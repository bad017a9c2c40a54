"""A torque over time from a file of two columns, time and torque, whose first line names their units."""

from pathlib import Path

from torsion.two_columns import Columns, pairs

TIME_AND_TORQUE = Columns(
    ("time", "torque"),
    ("s", "N*m"),
    "time [s], torque [N*m]",
    "0.5, 120",
    "a finite torque at a finite time from 0 on",
    0.0,
)


def torque_rows(file: Path) -> tuple[tuple[float, float], ...]:
    """(s, N m) of every row, times ascending; raises ValueError as `pairs` does."""
    return tuple((time, torque) for time, torque in pairs(file, TIME_AND_TORQUE))
