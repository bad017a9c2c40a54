"""Couple of a universal joint on the rigid, misaligned shaft that it drives: exact, linearised, for small angles.

Axes i, j, k stand still: k is the driven shaft at rest, i the normal of the plane of both shafts, `tilt` the angle
between them, so that the driving shaft runs along j sin(tilt) + k cos(tilt). Two angles move the driven shaft: `first`
about i, then `second` about the axis that j has become. `turned` is the driving angle, 0 with the driving pin along i
(convention N). Matrices and vectors stand for (first, second).
"""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray


class Couple(Protocol):
    """A 2 x 2 matrix of the couple, / its torque, at driving angles and a tilt (rad)."""

    def __call__(self, turned: ArrayLike, tilt: float) -> FloatArray:
        """(..., 2, 2), minus the derivative of the couple with respect to the two angles: a stiffness."""


def frame(first: ArrayLike, second: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Axes of the driven shaft that turn with it but do not spin, each (..., 3): across, across, along."""
    a, b = np.broadcast_arrays(np.asarray(first, dtype=float), np.asarray(second, dtype=float))
    none = np.zeros_like(a)
    return (
        np.stack((np.cos(b), np.sin(a) * np.sin(b), -np.cos(a) * np.sin(b)), axis=-1),
        np.stack((none, np.cos(a), np.sin(a)), axis=-1),
        np.stack((np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)), axis=-1),
    )


def moment(turned: ArrayLike, tilt: float, first: ArrayLike, second: ArrayLike) -> FloatArray:
    """(..., 3) on the driven shaft for a driving torque of 1, about its own axes of `frame`; the last is its torque.

    M = (z - (a.z) a)/(K.z) with the driven direction z, the driving pin a, the driving direction K (Zhu and Wang,
    eq. 3): the cross is without mass and friction, so that M is square to both of its pins.
    """
    x = np.asarray(turned, dtype=float)
    pin = np.stack((np.cos(x), np.sin(x) * np.cos(tilt), -np.sin(x) * np.sin(tilt)), axis=-1)
    axes = frame(first, second)
    lean = [np.sum(pin * axis, axis=-1) for axis in axes]
    along = np.sin(tilt) * axes[2][..., 1] + np.cos(tilt) * axes[2][..., 2]
    parts = np.broadcast_arrays(-lean[2] * lean[0], -lean[2] * lean[1], 1.0 - lean[2] ** 2)
    return np.asarray(np.stack(parts, axis=-1) / along[..., None])


def forcing(turned: ArrayLike, tilt: float) -> FloatArray:
    """(..., 2) couple / torque on the shaft at rest: tan/2 sin 2x and sin/2 (1 - cos 2x)."""
    twice = 2.0 * np.asarray(turned, dtype=float)
    return np.stack((0.5 * np.tan(tilt) * np.sin(twice), 0.5 * np.sin(tilt) * (1.0 - np.cos(twice))), axis=-1)


def linearised(turned: ArrayLike, tilt: float) -> FloatArray:
    """(..., 2, 2) minus the derivative of `moment`: Zhu and Wang, eq. 7, with sec and two more entries corrected."""
    sine, cosine = np.sin(2.0 * np.asarray(turned, dtype=float)), np.cos(2.0 * np.asarray(turned, dtype=float))
    c, double = np.cos(tilt), np.cos(2.0 * tilt)
    upper = ((1.0 + double) + (3.0 - double) * cosine) / (2.0 * c)
    return _matrices(-sine / c**2, upper, -c * (1.0 - cosine), sine)


def small_angle(turned: ArrayLike, tilt: float = 0.0) -> FloatArray:
    """(..., 2, 2) `linearised` at no tilt: minus eq. 8 of Zhu and Wang, E0 sin 2x + E1 cos 2x + E2, in its right sign.

    The constant part, [[0, 1], [-1, 0]], is circulatory: it comes from no potential and feeds energy in.
    """
    return small_angle_part(turned, sine=1.0, cosine=1.0, constant=1.0)


def small_angle_part(turned: ArrayLike, *, sine: float, cosine: float, constant: float) -> FloatArray:
    """`small_angle` with its parts in sin 2x, cos 2x and the constant one scaled: what each does alone."""
    s, c = sine * np.sin(2.0 * np.asarray(turned, dtype=float)), cosine * np.cos(2.0 * np.asarray(turned, dtype=float))
    return _matrices(-s, constant + c, -(constant - c), s)


def _matrices(*entries: ArrayLike) -> FloatArray:
    rows = np.broadcast_arrays(*entries)
    return 0.5 * np.stack(rows, axis=-1).reshape(*rows[0].shape, 2, 2)


def accelerations(
    angles: FloatArray, rates: FloatArray, moments: FloatArray, spin: ArrayLike, polar: float
) -> FloatArray:
    """(..., 2) second derivatives of the two angles of a rigid shaft turning about a fixed point, exact.

    moments: (..., 2) / transverse inertia, about the first two axes of `frame`; spin: speed about the third, rad/s;
    polar: polar / transverse inertia.
    """
    sine, cosine = np.sin(angles[..., 1]), np.cos(angles[..., 1])
    one, two = rates[..., 0], rates[..., 1]
    turning = polar * np.asarray(spin, dtype=float)
    first = (moments[..., 0] + 2.0 * one * two * sine - turning * two) / cosine
    second = moments[..., 1] - one**2 * sine * cosine + turning * one * cosine
    return np.stack((first, second), axis=-1)


def bearing(
    angles: FloatArray, rates: FloatArray, stiffness: ArrayLike, damping: ArrayLike, length: float
) -> FloatArray:
    """(..., 2) moment, N m, of a bearing `length` m from the joint; its stiffness N/m, damping N s/m along i and j."""
    a, b = angles[..., 0], angles[..., 1]
    across, over, _ = frame(a, b)
    place = length * np.stack((np.sin(b), -np.sin(a) * np.cos(b)), axis=-1)
    one, two = rates[..., 0], rates[..., 1]
    speed = length * np.stack((np.cos(b) * two, -np.cos(a) * np.cos(b) * one + np.sin(a) * np.sin(b) * two), axis=-1)
    force = -np.asarray(stiffness) * place - np.asarray(damping) * speed
    return length * np.stack(
        (-np.sum(force * over[..., :2], axis=-1), np.sum(force * across[..., :2], axis=-1)), axis=-1
    )
