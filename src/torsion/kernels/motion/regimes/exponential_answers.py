"""Answers of first-order coordinates to ramps and exponentials of time: exact at any time, without steps.

A coordinate y' = r y + t**k exp(p t) from rest answers, with d = p - r,
    I_k = integral over 0 < s < t of exp(r (t - s)) s**k exp(p s) ds,
    I_0 = (exp(p t) - exp(r t)) / d,   I_k = (t**k exp(p t) - k I_(k - 1)) / d,
and where |d t| is small I_k = t**(k + 1) exp(r t) (1/(k + 1) + d t/(k + 2) + ...), so that a resonance (d = 0) loses no
digit.
"""

import numpy as np
from numpy.polynomial.polynomial import polyval

from torsion.arrays import ComplexArray, FloatArray

SMALL = 0.5  # |d t| below which the series are taken; their TERMS are exact to rounding there
TERMS = 14
FACTORIALS = np.cumprod([1.0, *range(1, TERMS)])


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
            answer[near] = late ** (power + 1) * decay[near] * _series(small, power)
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


def _series(z: ComplexArray, power: int) -> ComplexArray:
    """Integral over 0 <= u <= 1 of u**power exp(z u), for |z| < SMALL."""
    return np.asarray(polyval(z, 1.0 / (FACTORIALS * (np.arange(1.0, TERMS + 1.0) + power))))
