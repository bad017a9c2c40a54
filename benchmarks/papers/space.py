"""Joints as bodies in space: pins, velocities and moments as vectors, without any formula of a joint's angle.

The truth with which printed equations are compared; nothing of torsion is used here. Axes: the driving shaft runs along
y, the plane of the shafts is y-z, its normal is x.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vectors = NDArray[np.float64]  # (..., 3)
AXIS, NORMAL = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
STEP = 1e-30  # of the complex step: its square is lost, so that the derivative is exact to rounding


def rotated(vector: ArrayLike, axis: ArrayLike, angle: ArrayLike) -> Vectors:
    """A vector turned about a unit axis square to it or not (Rodrigues); angles (...), rad."""
    about, given, turned = np.asarray(axis), np.asarray(vector), np.asarray(angle)[..., None]
    along = np.sum(about * given, axis=-1, keepdims=True) * about
    result: Vectors = (
        along + np.cos(turned) * (given - along) + np.sin(turned) * np.cross(about, given)
    )
    return result


def _stacked(*vectors: Vectors) -> Vectors:
    """Vectors as columns of matrices, (..., 3, columns)."""
    return np.stack(np.broadcast_arrays(*vectors), axis=-1)


def _ratio(pin: Vectors, before: Vectors, behind: Vectors) -> Vectors:
    """Driven speed: the cross turns about its own pins only, before + u pin = w behind + v (behind x pin)."""
    matrix = _stacked(np.broadcast_to(behind, pin.shape), np.cross(behind, pin), -pin)
    return np.linalg.solve(matrix, np.broadcast_to(before, pin.shape)[..., None])[..., 0, 0]


@dataclass(frozen=True)
class Cross:
    """One joint at driving angles counted from the plane's normal."""

    driven_angle: Vectors  # rad, from where the driven pin stands at 0; modulo 2 pi
    ratio: Vectors
    curvature: Vectors  # derivative of the ratio by the driving angle
    driven_torque: Vectors  # for a driving torque of 1
    driving_couple: Vectors  # on the driving shaft, about axis x pin
    driven_couple: Vectors  # on the driven shaft, about axis x pin


def cross(driving: ArrayLike, angle: float) -> Cross:
    """A cross joint from its two pins: square to each other, each fixed in its yoke; moments square to both pins."""
    behind = np.array([0.0, np.cos(angle), np.sin(angle)])
    turned = np.asarray(driving, dtype=float)
    pin = rotated(NORMAL, AXIS, turned)
    other = np.cross(behind, pin)
    other /= np.linalg.norm(other, axis=-1, keepdims=True)
    moment = np.cross(pin, other)
    moment = moment / (moment @ AXIS)[..., None]
    zero = np.cross(behind, NORMAL)
    bent = moment @ AXIS, np.sum(moment * np.cross(AXIS, pin), axis=-1)
    return Cross(
        driven_angle=np.arctan2(other @ np.cross(behind, zero), other @ zero),
        ratio=_ratio(pin, AXIS, behind),
        curvature=np.imag(_ratio(rotated(NORMAL, AXIS, turned + 1j * STEP), AXIS, behind)) / STEP,
        driven_torque=moment @ behind,
        driving_couple=-bent[1],
        driven_couple=np.sum(moment * np.cross(behind, other), axis=-1),
    )


def line_ratio(
    driving: ArrayLike, angles: ArrayLike, planes: ArrayLike, phases: ArrayLike
) -> Vectors:
    """Last speed / first speed of a line of cross joints, each shaft and yoke placed in space; driving (...), rad.

    `planes`: from joint to joint about the shaft between; `phases`: from driven yoke to the next driving yoke; of the
    first joint from the plane of its shafts to its driving yoke at driving angle 0.
    """
    turned, normal, before = np.asarray(driving, dtype=float), NORMAL, AXIS
    speed, yoke = (
        np.ones_like(turned),
        np.broadcast_to(np.cross(before, normal), (*turned.shape, 3)),
    )
    for rank, (angle, plane, phase) in enumerate(zip(angles, planes, phases, strict=True)):  # type: ignore[call-overload]
        normal = rotated(normal, before, plane)
        pin = rotated(yoke, before, phase if rank else turned + phase)
        behind = rotated(before, normal, angle)
        speed = speed * _ratio(pin, before, behind)
        yoke = np.cross(behind, pin)
        yoke /= np.linalg.norm(yoke, axis=-1, keepdims=True)
        before = behind
    return speed
