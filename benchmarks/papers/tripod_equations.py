"""Equations of Chang and Li as printed and as they must be, to first order in radius/arm, for a driving torque of 1.

g joint angle, x driving angle from the normal of the shafts' plane, share = radius/arm (lambda/L); rad.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def driven_torque_printed(g: float, x: ArrayLike, share: float) -> Array:
    """(9) with the sign of the denominator that (10) has."""
    return -2.0 / (2.0 + _wave(g, x, share))


def driven_torque_right(g: float, x: ArrayLike, share: float) -> Array:
    """-2 L/(2 L - 3 lambda tan(g/2)^2 tan g sin 3x)."""
    return -2.0 / (2.0 - _wave(g, x, share))


def couple_printed(g: float, x: ArrayLike, share: float) -> Array:
    """(10): V1 with a plus sign in the denominator."""
    return _couple_above(g, x, share) / (np.sin(g) * np.tan(g) * (2.0 + _wave(g, x, share)))


def couple_right(g: float, x: ArrayLike, share: float) -> Array:
    """(10) with a minus sign: equal to (1/i - cos g)/sin g, i the speed ratio."""
    return _couple_above(g, x, share) / (np.sin(g) * np.tan(g) * (2.0 - _wave(g, x, share)))


def twin_printed(g: float) -> tuple[float, float]:
    """(14): V1, V2 of the twin bearing, the sign of Ti turned."""
    return (-1.0 - np.cos(g)) / np.sin(g), np.sin(g) + (1.0 + np.cos(g)) * np.cos(g) / np.sin(g)


def twin_right(g: float) -> tuple[float, float]:
    """(14): both are tan(g/2)."""
    return (1.0 - np.cos(g)) / np.sin(g), np.sin(g) + (-1.0 + np.cos(g)) * np.cos(g) / np.sin(g)


def _wave(g: float, x: ArrayLike, share: float) -> Array:
    """3 lambda/L tan(g/2)^2 tan g sin 3x."""
    return 3.0 * share * np.tan(g / 2.0) ** 2 * np.tan(g) * np.sin(3.0 * np.asarray(x))


def _couple_above(g: float, x: ArrayLike, share: float) -> Array:
    """[2 L (tan g - sin g) + 3 lambda tan(g/2)^2 tan g sin g sin 3x]/L."""
    return 2.0 * (np.tan(g) - np.sin(g)) + np.sin(g) * _wave(g, x, share)
