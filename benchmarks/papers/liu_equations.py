"""Equations of Liu et al. (2023) as printed and as they must be; r joint angle, a driving angle, rad.

Their zero of a is the normal of the plane of the shafts (convention N) from (2) and (4) on; the other zero is 90
degrees away (convention P).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def pins(r: float, a: Array, b: Array) -> tuple[Array, Array]:
    """Directions Oa and Ob of (1), (angles, 3), that make the driven shaft (0, cos r, -sin r)."""
    none = np.zeros_like(a)
    first = np.stack((np.cos(a), none, np.sin(a)), axis=-1)
    return first, np.stack((-np.sin(b), np.cos(b) * np.sin(r), np.cos(b) * np.cos(r)), axis=-1)


def angle_printed(r: float, a: ArrayLike) -> Array:
    """(3): tan b = tan a/cos r, said to follow from (2)."""
    return np.arctan2(np.sin(a), np.cos(a) * np.cos(r))


def angle_right(r: float, a: ArrayLike) -> Array:
    """(4), which does follow: tan b = cos r tan a."""
    return np.arctan2(np.sin(a) * np.cos(r), np.cos(a))


def ratio_printed(r: float, a: ArrayLike) -> Array:
    """(5): cos r/(1 - sin(r)^2 cos(a)^2), said to be the derivative of (4)."""
    return np.cos(r) / (1.0 - (np.sin(r) * np.cos(a)) ** 2)


def ratio_right(r: float, a: ArrayLike) -> Array:
    """The derivative of (4): sine in place of cosine."""
    return np.cos(r) / (1.0 - (np.sin(r) * np.sin(a)) ** 2)


def acceleration_printed(r: float, a: ArrayLike, speed: float, gain: float) -> Array:
    """(6), the derivative of (5) as printed."""
    below = 1.0 - (np.sin(r) * np.cos(a)) ** 2
    swing = np.sin(r) ** 2 * np.cos(r) * np.sin(2.0 * np.asarray(a)) / below**2
    return -swing * speed**2 + np.cos(r) / below * gain


def acceleration_right(r: float, a: ArrayLike, speed: float, gain: float) -> Array:
    """The second derivative of (4): a plus sign and sines."""
    below = 1.0 - (np.sin(r) * np.sin(a)) ** 2
    swing = np.sin(r) ** 2 * np.cos(r) * np.sin(2.0 * np.asarray(a)) / below**2
    return swing * speed**2 + np.cos(r) / below * gain


def two_joints(
    r: float, a: Array, first: float, second: float, *, counted_from_zero: bool
) -> Array:
    """(9), (10): speed ratio of two equal joints in one plane, phases `first` and `second` of their driving forks.

    The driven fork's angle b stands in (10): counted from the fork's own zero less `first` it is right; counted from
    where the fork is at a = 0, as the text reads, it is not.
    """
    x = a + first
    lead = np.arctan2(np.sin(x), np.cos(x) * np.cos(r))
    start = np.arctan2(np.sin(first), np.cos(first) * np.cos(r)) if counted_from_zero else first
    return ratio_printed(r, x) * ratio_printed(r, lead - start + second)


def driving_couple(r: float, a: ArrayLike, torque: float) -> Array:
    """(13a): M1 = -T1 cos a tan r."""
    return -torque * np.cos(a) * np.tan(r)


def driven_couple_printed(r: float, a: ArrayLike, torque: float) -> Array:
    """(13b): M2 = -T1 sin(a)^2 sin r/sin b, 0/0 where a = 0."""
    return -torque * np.sin(a) ** 2 * np.sin(r) / np.sin(angle_right(r, a))


def driven_couple_right(r: float, a: ArrayLike, torque: float) -> Array:
    """(13b) without the quotient: -T1 tan r sin a sqrt(1 - sin(r)^2 sin(a)^2)."""
    return -torque * np.tan(r) * np.sin(a) * np.sqrt(1.0 - (np.sin(r) * np.sin(a)) ** 2)


def driven_torque_printed(r: float, a: ArrayLike, torque: float) -> Array:
    """(13c): T2 = T1 (1 - sin(r)^2 cos(a)^2)/cos r."""
    return torque * (1.0 - (np.sin(r) * np.cos(a)) ** 2) / np.cos(r)


def driven_torque_right(r: float, a: ArrayLike, torque: float) -> Array:
    """T2 = T1 (1 - sin(r)^2 sin(a)^2)/cos r."""
    return torque * (1.0 - (np.sin(r) * np.sin(a)) ** 2) / np.cos(r)
