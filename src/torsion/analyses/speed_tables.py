"""Tables of torque over speed: straight between their rows, and refused where they do not cover the speeds."""

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError

Table = tuple[tuple[float, float], ...]  # rad/s, N m
SAME_SPEED = 1e-9  # relative: a speed that lies outside a table by less was written in another unit


def interpolated(table: Table, speed: FloatArray, about: Fault) -> FloatArray:
    """Return torque (speeds,) N m from a table over speed, linear between its rows and never beyond them.

    `about` names the table and its place; raises InputError where the table does not cover the speeds.
    """
    if faults := uncovered(table, speed, about):
        raise InputError(faults)
    rows = np.array(table, dtype=np.float64)
    return np.interp(speed, rows[:, 0], rows[:, 1])


def uncovered(table: Table, speed: FloatArray, about: Fault) -> list[Fault]:
    """Return the fault of a table that does not cover the speeds (rad/s); none where it does."""
    first = table[0][0]
    last = table[-1][0]
    if not speed.size or (
        speed.min() >= first * (1 - SAME_SPEED) and speed.max() <= last * (1 + SAME_SPEED)
    ):
        return []
    covers = (
        f"covers {in_rpm(first)} to {in_rpm(last)}, the speeds run from {in_rpm(speed.min())} to "
    )
    hint = "extend the table, or narrow the speeds; nothing is extrapolated"
    return [Fault(about.path, f"{about.message} {covers}{in_rpm(speed.max())}", hint)]


def in_rpm(speed: float) -> str:
    """Return a speed (rad/s) in words, per minute."""
    return f"{speed * 30.0 / np.pi:.6g} rpm"
