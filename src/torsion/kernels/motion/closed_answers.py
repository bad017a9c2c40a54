"""Answers of first-order coordinates to ramps, exponentials and polynomials of time: exact at any time, without steps.

A coordinate y' = r y + t**k exp(p t) from rest answers, with d = p - r,
    I_k = integral over 0 < s < t of exp(r (t - s)) s**k exp(p s) ds,
    I_0 = (exp(p t) - exp(r t)) / d,   I_k = (t**k exp(p t) - k I_(k - 1)) / d,
and where |d t| is small I_k = t**(k + 1) exp(r t) (1/(k + 1) + d t/(k + 2) + ...), so that a resonance (d = 0) loses no
digit. Torques that are polynomials over a step are given by their values at Gauss points; y' = r y + f answers f from
rest after a time t with t times the sum over k of c_k A_k(r t), where c_k are the Legendre coefficients of f between 0
and t, and
    A_k(z) = integral over 0 <= x <= 1 of exp(z (1 - x)) P_k(2 x - 1):
by Gauss quadrature where |z| is moderate, else by parts, whose terms then fall.
"""

import numpy as np
from numpy.polynomial import legendre
from numpy.polynomial.polynomial import polyval

from torsion.arrays import ComplexArray, FloatArray

POINTS = 8  # of a step: the order is twice as high; 4 points need six times as many steps and more
_x, _w = legendre.leggauss(POINTS)
NODES: FloatArray = (_x + 1.0) / 2.0  # shares of the step
ENDS: FloatArray = np.append(NODES, 1.0)
# (coefficients, nodes): Legendre series over the step of values at the nodes
SERIES: FloatArray = (np.arange(POINTS)[:, None] + 0.5) * _w * legendre.legvander(_x, POINTS - 1).T
AT_END = SERIES.sum(axis=0)[
    :, None
]  # (nodes, 1): a torque at the end of a step, of those at the nodes
# (orders, coefficients, coefficients) of every derivative of a series
_derived = np.pad(legendre.legder(np.eye(POINTS)), ((0, 1), (0, 0)))
DERIVED = np.stack([np.linalg.matrix_power(_derived, order) for order in range(POINTS)])
# A motion without root turns by so much t**2 under the first two coefficients, and not under the others.
TURNED: FloatArray = np.array([1.0 / 2.0, -1.0 / 6.0])
SMALL = 0.5  # |d t| below which the series are taken; their TERMS are exact to rounding there
TERMS = 14
FACTORIALS = np.cumprod([1.0, *range(1, TERMS)])
FAR = 16.0  # |z| from which the integrals by parts lose nothing
# |z| below which so many points are exact to rounding: n of them take the exponential as a polynomial of degree
# 2 n - POINTS, which errs by 2 (|z|/4)^k/k! at k = 2 n - POINTS + 1 (Chebyshev): 5e-18, 4e-20 and 2e-17
RULES = [(1.0, 10), (4.0, 14), (FAR, 20)]


_rules = []  # upper half of an even number of Gauss points, (points, 1), and weights (coefficients, points)
for _highest, _points in RULES:
    _x, _w = (row[_points // 2 :] for row in legendre.leggauss(_points))
    _weights = _w / 2.0 * legendre.legvander(_x, POINTS - 1).T
    _rules.append((_highest, _x[:, None] / 2.0, _weights))
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


def answers(z: ComplexArray | FloatArray) -> ComplexArray:
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


def exponential_answers(
    root: ComplexArray, rate: complex, time: FloatArray, count: int, decay: ComplexArray
) -> list[ComplexArray]:
    """I_0 and as many more as make `count`, each (coordinates, times); decay: exp(root time).

    >>> answers = exponential_answers(np.zeros(1), 0.0, np.array([2.0]), 3, np.ones((1, 1)))
    >>> [round(float(answer[0, 0].real), 12) for answer in answers]  # t, t**2/2, t**3/3
    [2.0, 2.0, 2.666666666667]
    """
    d = (rate - root)[:, None]
    z = d * time
    near = np.abs(z) < SMALL
    divisor = np.where(d == 0.0, 1.0, d)
    growth = np.exp(rate * time)
    answers = [np.asarray((growth - decay) / divisor)]
    for power in range(1, count):
        answers.append(np.asarray((time**power * growth - power * answers[-1]) / divisor))
    if near.any():
        late, small = np.broadcast_to(time, z.shape)[near], z[near]
        for power, answer in enumerate(answers):
            # The integral over 0 <= u <= 1 of u**power exp(z u).
            series = polyval(small, 1.0 / (FACTORIALS * (np.arange(1.0, TERMS + 1.0) + power)))
            answer[near] = late ** (power + 1) * decay[near] * series
    return answers


def answers_and_turning(
    root: ComplexArray, rate: complex, time: FloatArray, count: int, decay: ComplexArray
) -> tuple[list[ComplexArray], list[np.ndarray]]:
    """The answers, and `count` positions (times,) of motions without root, whose speeds answer."""
    if rate == 0.0:
        turned = [time ** (k + 2) / ((k + 1) * (k + 2)) for k in range(count)]
    else:
        none, alone = np.zeros(1, dtype=complex), np.ones((1, len(time)), dtype=complex)
        speed = exponential_answers(none, rate, time, count + 1, alone)
        turned = [time * speed[k][0] - speed[k + 1][0] for k in range(count)]
    return exponential_answers(root, rate, time, count, decay), turned
