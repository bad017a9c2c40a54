"""A single-bearing tripod as bodies in space: three lines, three arms, three contact forces; solved numerically.

The truth for the tripod's printed equations; nothing of torsion is used here. Axes: n, d x n, d of the driving shaft;
lengths in units of the arm L.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

Array = NDArray[np.float64]
NORMAL, SHAFT = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
PLACES = 2.0 * np.pi / 3.0 * np.arange(3)


@dataclass(frozen=True)
class Tripod:
    """One position; torque and couples for a driving torque of 1, as the joint puts them on the shafts."""

    error: float  # driven minus driving angle, rad
    driven_torque: float
    normal: float  # couple on the driving shaft about n
    inplane: float  # couple on the driving shaft about d x n
    driven_inplane: float
    force: float  # across the driving shaft, times L


@cache
def tripod(driving: float, angle: float, share: float) -> Tripod:
    """The joint at a driving angle counted from n; `share` is radius/L."""
    outgoing = np.array([0.0, -np.sin(angle), np.cos(angle)])

    def body(unknown: Array) -> tuple[Array, Array, Array]:
        """Shaft between joint and pivot, arms, points of the lines, of two tilts and the error."""
        shaft = outgoing + unknown[0] * NORMAL + unknown[1] * np.array([0.0, np.cos(angle), 0.0])
        shaft = shaft / np.linalg.norm(shaft)
        turn = _least_turn(outgoing, shaft) @ _least_turn(SHAFT, outgoing)
        return shaft, _spokes(driving + unknown[2]) @ turn.T, share * _spokes(driving)

    def gaps(unknown: Array) -> Array:
        shaft, arms, lines = body(unknown)
        return np.sum(np.cross(arms, SHAFT) * (lines - (outgoing - shaft)), axis=-1) / share

    found = root(gaps, np.zeros(3), tol=1e-13)
    if np.abs(found.fun).max() > 1e-11:
        raise ArithmeticError("the arms do not meet their lines")
    shaft, arms, lines = body(found.x)
    return _statics(float(found.x[2]), outgoing, shaft, arms, lines)


def _statics(error: float, outgoing: Array, shaft: Array, arms: Array, lines: Array) -> Tripod:
    """Contact forces square to arm and line; the pivot passes a moment in the plane that bisects its shafts."""
    centre = outgoing - shaft
    push = np.cross(arms, SHAFT)
    reach = np.sum((lines - centre)[:, :2] * arms[:, :2], axis=-1) / np.sum(
        arms[:, :2] ** 2, axis=-1
    )
    contact = centre + reach[:, None] * arms
    about = np.cross(contact - outgoing, push)
    size = np.linalg.solve(about.T, shaft + outgoing)
    moment, force = size @ np.cross(contact, push), size @ push
    moment, force = moment / moment[2], force / moment[2]
    return Tripod(
        error=error,
        driven_torque=float(moment @ outgoing),
        normal=float(-moment[0]),
        inplane=float(-moment[1]),
        driven_inplane=float(moment @ np.cross(outgoing, NORMAL)),
        force=float(np.hypot(force[0], force[1])),
    )


def _spokes(angle: float) -> Array:
    return np.stack((np.cos(angle + PLACES), np.sin(angle + PLACES), np.zeros(3)), axis=-1)


def _least_turn(start: Array, end: Array) -> Array:
    """Rotation matrix about start x end that brings one unit vector to the other."""
    x, y, z = np.cross(start, end)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix: Array = np.eye(3) + skew + skew @ skew / (1.0 + start @ end)
    return matrix
