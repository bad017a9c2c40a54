"""Modes under torques that are ramps and exponentials of time: exact at any time, without steps.

A first-order coordinate y' = r y + f answers (level + slope t) exp(p t) in closed form, with d = p - r:
    y(t) = y(0) exp(r t) + level I0 + slope I1,   I0 = (exp(p t) - exp(r t)) / d,   I1 = (t exp(p t) - I0) / d,
and where |d t| is small I0 = t exp(r t) (1 + d t/2 + ...), I1 = t**2 exp(r t) (1/2 + d t/3 + ...), so that a resonance
(d = 0) loses no digit. A vibrating mode q'' + 2 zeta w q' + w**2 q = f is the coordinate y = q' - conj(r) q with
r = -zeta w + i w sqrt(1 - zeta**2); modes that damping couples are those of the eigenvectors of them all together, and
a rigid motion x'' = f follows by integration.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import factorial

import numpy as np
from numpy.polynomial.polynomial import polyval

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.torque_history import History, Term

SMALL = 0.5  # |d t| below which the series are taken; their TERMS are exact to rounding there
TERMS = 14


@dataclass(frozen=True)
class FirstOrder:
    """Coordinates y' = r y + f with their states at the begin of every interval of their torques."""

    root: ComplexArray  # (coordinates,) 1/s
    force: ComplexArray  # (coordinates, loads) of each load for 1 N m
    history: History
    state: ComplexArray  # (intervals, coordinates)

    def at(self, time: FloatArray) -> ComplexArray:
        """(coordinates, times) at times >= 0 (s) that ascend."""
        y = np.empty((len(self.root), len(time)), dtype=complex)
        for interval, columns, since in intervals(self.history, time):
            terms = self.history.terms[interval]
            y[:, columns] = _answer(self.root, self.force, self.state[interval], terms, since)
        return y


def first_order(
    root: ComplexArray, force: np.ndarray, history: History, start: ComplexArray
) -> FirstOrder:
    """The motion from a state (coordinates,) at time 0."""
    states = [np.asarray(start, dtype=complex)]
    for length, terms in zip(np.diff(history.begin), history.terms, strict=False):
        states.append(_answer(root, force, states[-1], terms, np.array([length]))[:, 0])
    return FirstOrder(root, force, history, np.array(states))


def intervals(history: History, time: FloatArray) -> list[tuple[int, slice, FloatArray]]:
    """Every interval that has some of the times, where they stand among them, and how long after its begin (s)."""
    edges = [*np.searchsorted(time, history.begin).tolist(), len(time)]
    return [
        (number, slice(first, last), time[first:last] - history.begin[number])
        for number, (first, last) in enumerate(pairwise(edges))
        if first < last
    ]


def _answer(
    root: ComplexArray,
    force: np.ndarray,
    state: ComplexArray,
    terms: tuple[Term, ...],
    time: FloatArray,
) -> ComplexArray:
    """(coordinates, times) from a state, at times (s) counted from it."""
    decay = np.exp(np.multiply.outer(root, time))
    y = state[:, None] * decay
    for rate in dict.fromkeys(term.rate for term in terms):
        alike = [term for term in terms if term.rate == rate]
        loads = [term.load for term in alike]
        level, slope = (force[:, loads] @ np.array([[term.level, term.slope] for term in alike])).T
        rises = bool(slope.any())
        first, second = _integrals(root, rate, time, decay, rises=rises)
        y += level[:, None] * first
        if rises:
            y += slope[:, None] * second
    return y


def _integrals(
    root: ComplexArray, rate: complex, time: FloatArray, decay: ComplexArray, *, rises: bool = True
) -> tuple[ComplexArray, ComplexArray]:
    """I0 and I1 of the module's text, (coordinates, times); where nothing `rises`, nothing in place of I1."""
    d = (rate - root)[:, None]
    z = d * time
    near = np.abs(z) < SMALL
    divisor = np.where(d == 0.0, 1.0, d)
    growth = np.exp(rate * time)
    first: ComplexArray = (growth - decay) / divisor
    second: ComplexArray = (
        (time * growth - first) / divisor if rises else np.empty((0, 0), dtype=complex)
    )
    if near.any():
        late, small = np.broadcast_to(time, z.shape)[near], z[near]
        first[near] = decay[near] * late * _series(small, 0)
        if rises:
            second[near] = decay[near] * late**2 * _series(small, 1)
    return first, second


def _series(z: ComplexArray, power: int) -> ComplexArray:
    """Integral over 0 <= u <= 1 of u**power exp(z u), for |z| < SMALL."""
    return np.asarray(
        polyval(z, [1.0 / (factorial(term) * (term + 1 + power)) for term in range(TERMS)])
    )


@dataclass(frozen=True)
class RigidMotion:
    """Motions x'' = f with speed and place at the begin of every interval of their torques."""

    force: FloatArray  # (motions, loads)
    history: History
    state: FloatArray  # (intervals, motions, 2): position and speed

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position and speed (motions, times) at times >= 0 (s) that ascend."""
        moved = np.empty((2, len(self.force), len(time)))
        for interval, columns, since in intervals(self.history, time):
            terms = self.history.terms[interval]
            moved[:, :, columns] = _moved(self.force, self.state[interval], terms, since)
        return moved[0], moved[1]


def rigid_motion(
    force: FloatArray, history: History, position: FloatArray, speed: FloatArray
) -> RigidMotion:
    """The motion from a position and speed (motions,) at time 0."""
    states = [np.stack([position, speed], axis=1)]
    for length, terms in zip(np.diff(history.begin), history.terms, strict=False):
        states.append(_moved(force, states[-1], terms, np.array([length]))[:, :, 0].T)
    return RigidMotion(force, history, np.array(states))


def _moved(
    force: FloatArray, state: FloatArray, terms: tuple[Term, ...], time: FloatArray
) -> FloatArray:
    """(2, motions, times) position and speed, at times (s) counted from a state."""
    position = state[:, :1] + state[:, 1:] * time
    speed = np.broadcast_to(state[:, 1:], position.shape)
    for term in terms:
        acting = force[:, [term.load]]
        once, twice = _integrals_of_rigid(term, time)
        position, speed = position + acting * twice.real, speed + acting * once.real
    return np.stack([position, speed])


def _integrals_of_rigid(term: Term, time: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """First and second integral over time of a term, (times,)."""
    if term.rate == 0.0:
        level, gained = term.level, term.slope * time
        return time * (level + gained / 2.0), time**2 * (level / 2.0 + gained / 6.0)
    zero, rate = np.zeros(1, dtype=complex), term.rate
    unit = np.ones((1, len(time)), dtype=complex)
    first, ramp = (row[0] for row in _integrals(zero, rate, time, unit))
    near = np.abs(rate * time) < SMALL
    # Integrals of I0 = (exp(p t) - 1)/p and I1 = (t exp(p t) - I0)/p.
    of_first = (first - time) / rate
    of_ramp = (ramp - of_first) / rate
    if near.any():
        small, late = rate * time[near], time[near]
        of_first[near] = late**2 * (_series(small, 0) - _series(small, 1))
        of_ramp[near] = late**3 * (_series(small, 1) - _series(small, 2))
    return term.level * first + term.slope * ramp, term.level * of_first + term.slope * of_ramp
