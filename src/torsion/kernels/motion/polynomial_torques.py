"""Torques that are polynomials over a step, by their values at Gauss points, and the exact answer to them.

A coordinate y' = r y + f answers f(s), 0 <= s <= share of a step of length h, with h share times the integral over
0 <= x <= 1 of exp(z (1 - x)) f(share x), z = r h share: by Gauss quadrature where |z| is moderate, else by parts, whose
terms then fall.
"""

from functools import cache

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import BoolArray, ComplexArray, FloatArray

POINTS = 8  # of a step: the order is twice as high; 4 points need six times as many steps and more
_x, _w = legendre.leggauss(POINTS)
NODES: FloatArray = (_x + 1.0) / 2.0  # shares of the step
ENDS: FloatArray = np.append(NODES, 1.0)
# (coefficients, nodes): Legendre series over the step of values at the nodes
SERIES: FloatArray = (np.arange(POINTS)[:, None] + 0.5) * _w * legendre.legvander(_x, POINTS - 1).T
# (coefficients, coefficients) of every derivative of a series
_derived = np.pad(legendre.legder(np.eye(POINTS)), ((0, 1), (0, 0)))
DERIVED = [np.linalg.matrix_power(_derived, order) for order in range(POINTS)]
# (coefficients, coefficients) of the second integral from the begin of a step of length 1
TWICE: FloatArray = np.asarray(legendre.legint(np.eye(POINTS), 2, lbnd=-1.0) / 4.0)
FAR = 16.0  # |z| from which the integrals by parts lose nothing
# |z| below which so many points are exact to rounding: n of them take the exponential as a polynomial of degree
# 2 n - POINTS, which errs by 2 (|z|/4)^k/k! at k = 2 n - POINTS + 1 (Chebyshev): 2e-18, 2e-17 and 2e-18
RULES = ((1.0, 10), (4.0, 13), (FAR, 21))
BLOCK = 20_000  # values of the exponential at a time


def value(series: np.ndarray, share: FloatArray) -> np.ndarray:
    """(..., points) of series (coefficients, ..., points or 1) at shares of their step (points,)."""
    return np.asarray(legendre.legval(2.0 * share - 1.0, series, tensor=False))


def second_integral(series: FloatArray, share: FloatArray) -> FloatArray:
    """From the begin of a step of length 1, (..., points), of series as of `value`."""
    return value(np.tensordot(TWICE, series, 1), share)


def answers(
    z: ComplexArray, share: FloatArray, force: np.ndarray, series: np.ndarray
) -> ComplexArray:
    """The integral of exp(z (1 - x)) f(share x) over 0 <= x <= 1, (coordinates, points).

    z: (coordinates, points); share: (points,); f is `force` (coordinates, torques) times the torques whose series are
    (coefficients, torques, points).
    """
    answer, size, lowest = np.empty(z.shape, dtype=complex), np.abs(z), 0.0
    far = (size >= FAR).any(axis=1)
    if far.any():
        answer[far] = _by_parts(np.where(size[far] < FAR, FAR, z[far]), share, force[far], series)
    for highest, points in RULES:
        chosen = (size >= lowest) & (size < highest)
        if chosen.any():
            answer[chosen] = _by_quadrature(chosen, points, z, share, force, series)
        lowest = highest
    return answer


def _by_quadrature(
    chosen: BoolArray,
    points: int,
    z: ComplexArray,
    share: FloatArray,
    force: np.ndarray,
    series: np.ndarray,
) -> ComplexArray:
    """The integrals that are chosen, by Gauss's rule of so many points."""
    rows, columns = np.nonzero(chosen)
    used, columns = np.unique(columns, return_inverse=True)
    z, share, series, forces = z[chosen], share[used], series[..., used], force[rows].T
    total, size = np.zeros(len(z), dtype=complex), max(1, BLOCK // len(z))
    nodes, weights = _gauss(points)
    for k in range(0, points, size):
        node = nodes[k : k + size, None]
        torques = value(series, node[..., None] * share)[..., columns]  # (nodes, torques, chosen)
        total += weights[k : k + size] @ (
            np.sum(forces * torques, axis=1) * np.exp(z * (1.0 - node))
        )
    return total


@cache
def _gauss(points: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights (points,) of an interval from 0 to 1."""
    nodes, weights = legendre.leggauss(points)
    return (nodes + 1.0) / 2.0, weights / 2.0


def _by_parts(
    z: ComplexArray, share: FloatArray, force: np.ndarray, series: np.ndarray
) -> ComplexArray:
    """Sum over k of (f_k(0) exp(z) - f_k(1))/z^(k+1), f_k the k-th derivative by x."""
    total, decay, factor = np.zeros(z.shape, dtype=complex), np.exp(z), 1.0 / z
    none = np.zeros_like(share)
    for _ in range(POINTS):
        total += factor * ((force @ value(series, none)) * decay - force @ value(series, share))
        series = legendre.legder(series)
        factor = factor * (2.0 * share / z)
    return total
