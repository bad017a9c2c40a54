"""A linear motion z' = A z that lasts while its switching functions stay positive: its steps, and what ends it.

A block of steps is one product with cached rows. An interval between two samples is looked at more closely where a
function has changed its sign, and where it may have dipped below zero and risen again (it falls at the left end, rises
at the right one, and a tangent reaches zero between); there z is a Taylor polynomial, the functions are polynomials,
and the root is exact to rounding.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from torsion.arrays import BoolArray, FloatArray

STEPS = 64  # of a block
PARTS = 4  # samples of the switching functions in a step
NEAR = 16  # samples that are looked at before the others of a block: most events come soon
ORDER = 16  # of the polynomials over a part: 0.5 rad of the fastest mode, 0.5**17/17! = 2e-20
RADIANS = 2.0  # of the fastest mode in a step
SHARES = np.linspace(0.0, 1.0, 9)  # of a part, where its polynomials are sampled
POWERS = SHARES[:, None] ** np.arange(ORDER + 1)
SLOPES = np.concatenate([np.zeros((9, 1)), POWERS[:, :-1] * np.arange(1, ORDER + 1)], axis=1)
LAST_TERM = 1e-19  # of the first one
ROUNDING = 1e-13  # of the largest coefficient: a function below zero by less is at zero


@dataclass(frozen=True)
class Regime:
    """One linear motion; `events` are positive while it lasts."""

    matrix: FloatArray  # (states, states) 1/s
    events: FloatArray  # (functions, states)
    torque: FloatArray  # (elements, states) N m, of every element
    elastic: FloatArray  # (elements, states) sqrt(N m): half its square is the energy stored in the element
    step: float  # s
    catches_dips: bool = True

    @property
    def part(self) -> float:
        """s, between two samples of the switching functions."""
        return self.step / PARTS

    @cached_property
    def steps(self) -> FloatArray:
        """(STEPS + 1, states, states) exp(A j h)."""
        powers = [np.eye(len(self.matrix)), expm(self.matrix * self.step)]
        for _ in range(STEPS - 1):
            powers.append(powers[1] @ powers[-1])
        return np.array(powers)

    @cached_property
    def parts(self) -> FloatArray:
        """(PARTS, states, states) exp(A j h / PARTS)."""
        return np.array([expm(self.matrix * (self.part * part)) for part in range(PARTS)])

    @cached_property
    def _samples(self) -> FloatArray:
        """(samples * 2 * functions, states): every function, and its rate of change, at every sample of a block."""
        rows = [np.stack([self.events, self.events @ self.matrix])]
        for _ in range(STEPS * PARTS):
            rows.append(rows[-1] @ self.parts[1])
        return np.array(rows).reshape(-1, len(self.matrix))

    @cached_property
    def _coefficients(self) -> FloatArray:
        """((ORDER + 1) * functions, states): of the polynomials over a part, in shares of it."""
        rows = [self.events]
        for power in range(1, ORDER + 1):
            rows.append(rows[-1] @ self.matrix * (self.part / power))
        return np.concatenate(rows)

    def after(self, z: FloatArray, time: float) -> FloatArray:
        """The state after a time of one block at most."""
        part = min(int(time / self.part), STEPS * PARTS - 1)
        start, rest = self._at(z, part), max(time - part * self.part, 0.0)
        term, power, bound = start, 0, 1.0
        while bound > LAST_TERM and power < ORDER:
            power += 1
            bound *= RADIANS * rest / (self.step * power)
            term = self.matrix @ term * (rest / power)
            start = start + term
        return start

    def _at(self, z: FloatArray, part: int) -> FloatArray:
        """The state after a number of parts."""
        whole, rest = divmod(part, PARTS)
        start = self.steps[whole] @ z if whole else z
        return np.asarray(self.parts[rest] @ start if rest else start)

    def moved(self, z: FloatArray, time: FloatArray) -> FloatArray:
        """States (states, columns), each after a time (columns,) of one step at most."""
        whole = np.minimum((time / self.part).astype(int), PARTS - 1)
        start = z.copy()
        for part in range(1, PARTS):
            if (here := whole == part).any():
                start[:, here] = self.parts[part] @ z[:, here]
        rest, found = time - whole * self.part, start
        for power in range(ORDER, 0, -1):
            found = start + self.matrix @ found * (rest / power)
        return found

    def first_event(self, z: FloatArray, time: float) -> tuple[float, int] | None:
        """When within a time of one block at most a switching function falls below zero, and which."""
        functions, number = len(self.events), min(int(np.ceil(time / self.part)), STEPS * PARTS)
        for first, last in ((0, min(NEAR, number)), (NEAR, number)):
            if not functions or first >= number:
                break
            rows = self._samples[2 * functions * first : 2 * functions * (last + 1)]
            value, rate = (rows @ z).reshape(-1, 2, functions).transpose(1, 0, 2)
            looked_at = np.minimum(value[1:], value[:-1]) <= 0.0
            if self.catches_dips:
                looked_at |= _may_dip(value, rate * self.part)
            for part in (np.flatnonzero(looked_at.any(axis=1)) + first).tolist():
                found = self._root(self._at(z, part), self.catches_dips)
                if found is not None and part * self.part + found[0] <= time:
                    return part * self.part + found[0], found[1]
        return None

    def _root(self, z: FloatArray, dips: bool) -> tuple[float, int] | None:
        """The first root within a part, s from its begin."""
        polynomials = (self._coefficients @ z).reshape(ORDER + 1, -1)
        value, slope = POWERS @ polynomials, SLOPES @ polynomials
        rounding = ROUNDING * np.abs(polynomials).max(axis=0) + 1e-15 * (np.abs(self.events) @ np.abs(z))
        crossed = value[1:] < -rounding
        if dips:
            crossed |= (slope[:-1] < 0.0) & (slope[1:] > 0.0)
        best: tuple[float, int] | None = None
        for which in np.flatnonzero(crossed.any(axis=0)).tolist():
            for at in np.flatnonzero(crossed[:, which]).tolist():
                share = _crossing(polynomials[:, which], at, value[at : at + 2, which], float(rounding[which]))
                if share is not None:
                    if best is None or share * self.part < best[0]:
                        best = share * self.part, which
                    break
        return best


def _may_dip(value: FloatArray, rise: FloatArray) -> BoolArray:
    """(samples - 1, functions) where a function may fall below zero and rise again between two samples.

    rise: (samples, functions) its rate of change times the length between samples.
    """
    left, right = value[:-1] + rise[:-1] < 0.0, value[1:] - rise[1:] < 0.0
    return np.asarray((rise[:-1] < 0.0) & (rise[1:] > 0.0) & (left | right))


def _crossing(polynomial: FloatArray, at: int, ends: FloatArray, rounding: float) -> float | None:
    """The root between two shares, where the function falls below zero there; 0 where it leaves from zero at once."""
    low, high = float(SHARES[at]), float(SHARES[at + 1])
    slopes = polynomial[1:] * np.arange(1, len(polynomial))
    if ends[1] >= -rounding:  # it may dip between
        high = _root_between(slopes, low, high)
        if _value(polynomial, high) >= -rounding:
            return None
    if abs(ends[0]) <= rounding:  # it may rise from zero first
        turns = np.roots(slopes[::-1])
        turns = np.sort(turns.real[(turns.imag == 0.0) & (turns.real > low) & (turns.real < high)])
        tops = [turn for turn in turns.tolist() if _value(polynomial, turn) > max(float(ends[0]), 0.0)]
        if tops:
            return _root_between(polynomial, tops[0], high)
    return low if ends[0] <= 0.0 else _root_between(polynomial, low, high)


def _root_between(polynomial: FloatArray, low: float, high: float) -> float:
    found: float = brentq(lambda share: _value(polynomial, share), low, high, xtol=1e-18, rtol=1e-15)
    return found


def _value(polynomial: FloatArray, share: float) -> float:
    """By Horner's scheme."""
    total = 0.0
    for coefficient in polynomial[::-1].tolist():
        total = total * share + coefficient
    return total
