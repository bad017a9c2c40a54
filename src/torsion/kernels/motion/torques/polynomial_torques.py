"""Torques that are polynomials over a step, by their values at Gauss points, and the exact answer to them.

A coordinate y' = r y + f answers f from rest after a time t with t times the sum over k of c_k A_k(r t), where c_k are
the Legendre coefficients of f between 0 and t, and
    A_k(z) = integral over 0 <= x <= 1 of exp(z (1 - x)) P_k(2 x - 1):
by Gauss quadrature where |z| is moderate, else by parts, whose terms then fall.
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
# (orders, coefficients, coefficients) of every derivative of a series
_derived = np.pad(legendre.legder(np.eye(POINTS)), ((0, 1), (0, 0)))
DERIVED = np.stack([np.linalg.matrix_power(_derived, order) for order in range(POINTS)])
# A motion without root turns by so much t**2 under the first two coefficients, and not under the others.
TURNED: FloatArray = np.array([1.0 / 2.0, -1.0 / 6.0])
FAR = 16.0  # |z| from which the integrals by parts lose nothing
# |z| below which so many points are exact to rounding: n of them take the exponential as a polynomial of degree
# 2 n - POINTS, which errs by 2 (|z|/4)^k/k! at k = 2 n - POINTS + 1 (Chebyshev): 5e-18, 4e-20 and 2e-17
RULES = [(1.0, 10), (4.0, 14), (FAR, 20)]


def _rule(points: int) -> tuple[FloatArray, FloatArray]:
    """The upper half of an even number of Gauss points, (points, 1), and weights (coefficients, points)."""
    nodes, weights = (row[points // 2 :] for row in legendre.leggauss(points))
    return nodes[:, None] / 2.0, weights / 2.0 * legendre.legvander(nodes, POINTS - 1).T


_rules = [(highest, *_rule(points)) for highest, points in RULES]
# (coefficients, orders) derivatives by x of P_k(2 x - 1) at both ends
_signs = (-1.0) ** np.arange(POINTS)
_at_begin = np.stack([2.0**order * _signs @ DERIVED[order] for order in range(POINTS)], axis=1)
_at_end = np.abs(_at_begin)


def value(series: np.ndarray, share: FloatArray) -> np.ndarray:
    """(..., points) of series (coefficients, ..., points or 1) at shares of their step (points,)."""
    return np.asarray(legendre.legval(2.0 * share - 1.0, series, tensor=False))


def cut_short(series: FloatArray, share: FloatArray) -> FloatArray:
    """Series (coefficients, torques, points) that cover shares (points,) of the step of series as of `value`."""
    basis = legendre.legvander(2.0 * np.multiply.outer(NODES, share) - 1.0, POINTS - 1)
    if series.shape[2] == 1:
        values = basis @ series[:, :, 0]
        return np.asarray(np.tensordot(SERIES, values, 1).transpose(0, 2, 1))
    return np.asarray(np.tensordot(SERIES, np.einsum("ntk,krt->nrt", basis, series), 1))


def answers(z: ComplexArray) -> ComplexArray:
    """A_k(z), (coefficients, ...).

    >>> answers(np.zeros(1))[:2, 0].real.round(12) + 0.0  # to a constant, and to 2 x - 1
    array([1., 0.])
    """
    answer, size, lowest = np.empty((POINTS, *z.shape), dtype=complex), np.abs(z), 0.0
    for highest, beyond, weights in _rules:
        chosen = (size >= lowest) & (size < highest)
        if chosen.any():
            # Points as far before the middle as behind it: one exponential is the other's reciprocal.
            before = np.exp(beyond * z[chosen])
            behind, middle = 1.0 / before, np.exp(0.5 * z[chosen])
            answer[::2, chosen] = middle * (weights[::2] @ (before + behind))
            answer[1::2, chosen] = middle * (weights[1::2] @ (behind - before))
        lowest = highest
    far = size >= FAR
    if far.any():
        # Sum over the derivatives d of P_k, (d(0) exp(z) - d(1))/z^(order + 1).
        powers = (1.0 / z[far]) ** np.arange(1, POINTS + 1)[:, None]
        answer[:, far] = (_at_begin @ powers) * np.exp(z[far]) - _at_end @ powers
    return answer
