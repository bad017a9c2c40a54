"""Equations of Ma, Yu and Han (2011), each restored from its neighbours, and the closed form they lead to; rad.

a, b: joint angles; x: driving angle from the plane of the first joint; psi = phase - plane of the second joint.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def behind(angle: float, x: ArrayLike) -> Array:
    """(1), (2): speed ratio of one joint, cos a/(1 - sin(a)^2 cos(x)^2)."""
    return np.cos(angle) / (1.0 - (np.sin(angle) * np.cos(x)) ** 2)


def lead(angle: float, x: ArrayLike) -> Array:
    """(4): tan dx = (1 - cos a) tan x/(cos a + tan(x)^2), in sines and cosines, so that no tangent has a pole."""
    sine, cosine = np.sin(x), np.cos(x)
    return np.arctan2((1.0 - np.cos(angle)) * sine * cosine, np.cos(angle) * cosine**2 + sine**2)


def output(a: float, b: float, phase: float, plane: float, x: ArrayLike) -> Array:
    """(3), (5): last speed / first speed, the second joint's angle being x + dx + 90 degrees + phase - plane."""
    second = np.asarray(x) + lead(a, x) + np.pi / 2.0 + phase - plane
    return behind(a, x) * behind(b, second)


def index(speeds: ArrayLike) -> float:
    """(6): (largest - smallest)/driving speed."""
    return float(np.ptp(np.asarray(speeds)))


def closed_index(a: float, b: float, psi: ArrayLike) -> Array:
    """2 sinh R, cosh R = cosh p cosh q - sinh p sinh q cos 2 psi, p = ln(1/cos a), q = ln(1/cos b)."""
    p, q = -np.log(np.cos(a)), -np.log(np.cos(b))
    return 2.0 * np.sinh(
        np.arccosh(
            np.cosh(p) * np.cosh(q) - np.sinh(p) * np.sinh(q) * np.cos(2.0 * np.asarray(psi))
        )
    )
