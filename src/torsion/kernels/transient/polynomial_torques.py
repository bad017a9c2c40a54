"""Torques that are polynomials over a step, by their values at Gauss points, and the exact answer to them.

A coordinate y' = r y + f answers f(s), 0 <= s <= share of a step of length h, with h share times the integral over
0 <= x <= 1 of exp(z (1 - x)) f(share x), z = r h share: by Gauss quadrature where |z| is moderate, else by parts, whose
terms then fall.
"""

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import ComplexArray, FloatArray

POINTS = 8  # of a step: the order is twice as high; 4 points need six times as many steps and more
_x, _w = legendre.leggauss(POINTS)
NODES: FloatArray = (_x + 1.0) / 2.0  # shares of the step
ENDS: FloatArray = np.append(NODES, 1.0)
# (coefficients, nodes): Legendre series over the step of values at the nodes
SERIES: FloatArray = (np.arange(POINTS)[:, None] + 0.5) * _w * legendre.legvander(_x, POINTS - 1).T
FAR = 16.0  # |z| from which the integrals by parts lose nothing
_y, _v = legendre.leggauss(28)  # exact to rounding below FAR: the remainder is about FAR/2 to the 49th over 49!
QUADRATURE, WEIGHTS = (_y + 1.0) / 2.0, _v / 2.0


def value(series: np.ndarray, share: FloatArray) -> np.ndarray:
    """(..., points) of series (coefficients, ..., points or 1) at shares of their step (points,)."""
    return np.asarray(legendre.legval(2.0 * share - 1.0, series, tensor=False))


def integrals(series: FloatArray, share: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First and second integral from the begin of a step of length 1, (..., points), of series as of `value`."""
    once = legendre.legint(series, lbnd=-1.0) / 2.0
    return value(once, share), value(legendre.legint(once, lbnd=-1.0) / 2.0, share)


def answers(z: ComplexArray, share: FloatArray, force: np.ndarray, series: np.ndarray) -> ComplexArray:
    """The integral of exp(z (1 - x)) f(share x) over 0 <= x <= 1, (coordinates, points).

    z: (coordinates, points); share: (points,); f is `force` (coordinates, torques) times the torques whose series are
    (coefficients, torques, points).
    """
    found = np.empty(z.shape, dtype=complex)
    near = np.abs(z) < FAR
    close, far = near.any(axis=1), ~near.all(axis=1)
    if close.any():
        found[close] = _by_quadrature(z[close], share, force[close], series)
    if far.any():
        whole = near[far]
        by_parts = _by_parts(np.where(whole, FAR, z[far]), share, force[far], series)
        found[far] = np.where(whole, found[far], by_parts)
    return found


def _by_quadrature(z: ComplexArray, share: FloatArray, force: np.ndarray, series: np.ndarray) -> ComplexArray:
    total = np.zeros(z.shape, dtype=complex)
    for at, weight in zip(QUADRATURE.tolist(), WEIGHTS.tolist(), strict=True):
        total += (force @ (weight * value(series, share * at))) * np.exp(z * (1.0 - at))
    return total


def _by_parts(z: ComplexArray, share: FloatArray, force: np.ndarray, series: np.ndarray) -> ComplexArray:
    """Sum over k of (f_k(0) exp(z) - f_k(1))/z^(k+1), f_k the k-th derivative by x."""
    total, decay, factor = np.zeros(z.shape, dtype=complex), np.exp(z), 1.0 / z
    none = np.zeros_like(share)
    for _ in range(POINTS):
        total += factor * ((force @ value(series, none)) * decay - force @ value(series, share))
        series = legendre.legder(series)
        factor = factor * (2.0 * share / z)
    return total
