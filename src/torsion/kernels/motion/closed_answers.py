"""Answers of first-order coordinates to polynomials of time and exponentials: exact at any time, without steps.

A coordinate y' = r y + s**k exp(p s) from rest answers after a time t with t**(k + 1) exp(p t) A_k(z), z = (r - p) t,
    A_k(z) = integral over 0 <= x <= 1 of exp(z (1 - x)) x**k,
    A_0 = (exp(z) - 1) / z,   A_k = (k A_(k - 1) - 1) / z,
and where |z| is small the last of these is a series, from which A_(k - 1) = (1 + z A_k) / k follow, so that a resonance
(z = 0) loses no digit. Torques that are polynomials over a step are given by their values at Gauss points, whose Legendre
coefficients fall where the step is accurate; the powers of the share of the step then lose nothing either.
"""

from math import comb

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
# (powers, coefficients): the same by powers of the share s of the step, of P_n(2 s - 1). A product with the series
# comes first: high coefficients are small, and so are what their large factors leave of rounding.
POWERS: FloatArray = np.array(
    [
        [(-1.0) ** (n + k) * comb(n, k) * comb(n + k, k) for n in range(POINTS)]
        for k in range(POINTS)
    ]
)
# of the number of answers: |z| below which the series is taken; TERMS of it are exact to rounding there
NEAR = 0.5
TERMS = 26


def value(polynomial: np.ndarray, share: FloatArray) -> np.ndarray:
    """(..., points) of polynomials (powers, ..., points or 1) at shares of their step (points,)."""
    return np.asarray(polyval(share, polynomial, tensor=False))


def answers(
    root: ComplexArray, rate: complex, time: FloatArray, count: int, decay: ComplexArray
) -> ComplexArray:
    """exp(rate time) A_k, (count, coordinates, times), to `count` powers of the share of a time; decay: exp(root time).

    >>> answers(np.zeros(1), 0.0, np.array([2.0]), 3, np.ones((1, 1))).real.ravel().round(12)
    array([1.        , 0.5       , 0.333333333333])
    """
    z = np.multiply.outer(root - rate, time)
    growth = np.broadcast_to(np.exp(rate * time), z.shape).ravel()
    answer, flat, is_near = (
        np.empty((count, z.size), dtype=complex),
        z.ravel(),
        np.abs(z) < NEAR * count,
    )
    if (near := np.flatnonzero(is_near)).size:
        small, grown = flat[near], growth[near]
        last, square = (
            np.zeros((2, near.size), dtype=complex),
            small * small,
        )  # even terms, odd ones
        for pair in np.cumprod(1.0 / np.arange(count, count + TERMS)).reshape(-1, 2, 1)[::-1]:
            last *= square
            last += pair
        last = grown * (last[0] + small * last[1])
        answer[-1][near] = last
        for power in range(count - 1, 0, -1):
            last = (grown + small * last) / power
            answer[power - 1][near] = last
    if (far := np.flatnonzero(~is_near)).size:
        grown, inverse = growth[far], 1.0 / flat[far]
        last = (decay.ravel()[far] - grown) * inverse
        answer[0][far] = last
        for power in range(1, count):
            last = (power * last - grown) * inverse
            answer[power][far] = last
    return answer.reshape(count, *z.shape)


def turning(rate: complex, time: FloatArray, count: int) -> np.ndarray:
    """(count, times or 1) share of time**(k + 2) by which a motion without root, whose speed answers, turns."""
    power = np.arange(count)[:, None]
    if rate == 0.0:
        return np.asarray(1.0 / ((power + 1.0) * (power + 2.0)))
    none, alone = np.zeros(1, dtype=complex), np.ones((1, len(time)), dtype=complex)
    speed = answers(none, rate, time, count + 1, alone)[:, 0]
    return np.asarray(speed[:-1] - speed[1:])
