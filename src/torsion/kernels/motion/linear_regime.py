"""A linear motion z' = A z that lasts while its switching functions stay positive: its steps, and what ends it.

A regime may be met briefly and once, so that it keeps little: exp(A h) - 1 of a short part h, and its squares as they
are needed. States at the begin of many parts are products of these, each twice as many as the one before. A part is
looked at more closely where a function is below zero at an end of it, or a tangent at one end is below zero at the
other; there z is a Taylor polynomial, the functions are polynomials, and the root is exact to rounding.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.first_root import first_root

STEPS = 64  # of a block
PARTS = 4  # in a step; a power of 2
BLOCK = STEPS * PARTS
LOOKS = (0, 16, 64, BLOCK)  # parts of a block that are looked at together: most events come soon
DEPTH = 4  # the Taylor polynomial has DEPTH**2 terms: 0.5 rad of the fastest mode in a part, 0.5**16/16! = 7e-19
TERMS = DEPTH**2
ORDERS = np.arange(float(TERMS))
FACTORIALS = np.cumprod([1.0, *range(1, TERMS)])
RADIANS = 2.0  # of the fastest mode in a step
ROUNDING = 1e-13  # of the largest coefficient: a function below zero by less is at zero
EXACT = 1e-15  # of the terms of a function, whose sum it knows no better
SQUARINGS = 5  # of a matrix whose spectral radius is sought


@dataclass(frozen=True)
class Regime:
    """One linear motion; `events` are positive while it lasts."""

    matrix: FloatArray  # (states, states) 1/s
    events: FloatArray  # (functions, states)
    torque: FloatArray  # (elements, states) N m, of every element
    elastic: FloatArray  # (elements, states) sqrt(N m): half its square is the energy stored in the element
    step: float  # s

    @cached_property
    def part(self) -> float:
        """s, after which the motion is looked at."""
        return self.step / PARTS

    @cached_property
    def _low(self) -> FloatArray:
        """(DEPTH + 1, states, states) powers of A part."""
        powers = [np.eye(len(self.matrix)), self.matrix * self.part]
        for _ in range(DEPTH - 1):
            powers.append(powers[-1] @ powers[1])
        return np.array(powers)

    @cached_property
    def _wide(self) -> FloatArray:
        """(states, (DEPTH - 1) * states) powers of A part from the first on, beside each other."""
        return np.concatenate(self._low[1:-1], axis=1)

    @cached_property
    def _gains(self) -> list[FloatArray]:
        """(states, states) exp(A part) - 1, which knows slow motions better than exp, and on to twice the time."""
        low, gain = self._low, np.zeros_like(self.matrix)
        for first in range(TERMS - DEPTH, -1, -DEPTH):
            weight = 1.0 / FACTORIALS[first : first + DEPTH]
            gain = np.tensordot(weight[not first :], low[not first : -1], axes=1) + low[-1] @ gain
        return [gain]

    def _gain(self, level: int) -> FloatArray:
        """(states, states) exp(A part 2**level) - 1."""
        while len(self._gains) <= level:
            gain = self._gains[-1]
            self._gains.append(2.0 * gain + gain @ gain)
        return self._gains[level]

    @cached_property
    def _transposed(self) -> dict[int, FloatArray]:
        """(states, states) the transpose of exp(A part 2**level), by level."""
        return {}

    def over_step(self, z: FloatArray) -> FloatArray:
        """States (states, columns) after one step."""
        return np.asarray(z + self._gain(PARTS.bit_length() - 1) @ z)

    @cached_property
    def _tests(self) -> FloatArray:
        """(states, tests * functions): every function at both ends of a part, and where the tangents there lead."""
        events, rise = self.events, self.events @ self._low[1]
        last = (row + row @ self._gain(0) for row in (events, events - rise))
        return np.ascontiguousarray(np.concatenate([events, events + rise, *last]).T)

    @cached_property
    def _polynomials(self) -> FloatArray:
        """(functions, TERMS, states): of the polynomials over a part, in shares of it."""
        rows = [self.events @ self._low[:-1]]  # (DEPTH, functions, states)
        for _ in range(DEPTH - 1):
            rows.append(rows[-1] @ self._low[-1])
        terms = np.concatenate(rows) / FACTORIALS[:, None, None]
        return np.ascontiguousarray(terms.transpose(1, 0, 2))

    @cached_property
    def _sizes(self) -> FloatArray:
        """Magnitudes of the rows of the switching functions, (functions, states)."""
        return np.abs(self.events)

    def _after_parts(self, z: FloatArray, part: int) -> FloatArray:
        """The state after a number of parts."""
        for level in range(part.bit_length()):
            if part >> level & 1:
                z = z + self._gain(level).dot(z)
        return z

    def _begins(self, z: FloatArray, number: int) -> FloatArray:
        """(number, states) at the begin of as many parts from a state on."""
        begins, filled, level = np.empty((number, len(z))), 1, 0
        begins[0] = z
        while filled < number:
            if level not in self._transposed:
                gain = np.ascontiguousarray(self._gain(level).T)
                self._transposed[level] = gain + np.eye(len(z))
            added = min(filled, number - filled)
            begins[:added].dot(self._transposed[level], out=begins[filled : filled + added])
            filled, level = filled + added, level + 1
        return begins

    def after(self, z: FloatArray, time: float) -> FloatArray:
        """The state after a time of one block at most."""
        part = min(int(time / self.part), BLOCK - 1)
        rows, last = np.empty((DEPTH, len(z))), self._low[-1]
        rows[0] = self._after_parts(z, part)
        for row in range(1, DEPTH):
            last.dot(rows[row - 1], out=rows[row])
        weight = max(time / self.part - part, 0.0) ** ORDERS / FACTORIALS
        group = weight.reshape(DEPTH, DEPTH).T.dot(rows)
        return np.asarray(group[0] + self._wide.dot(group[1:].ravel()))

    def moved(self, z: FloatArray, time: FloatArray) -> FloatArray:
        """States (states, columns), each after a time (columns,) of one block at most."""
        parts = np.minimum((time / self.part).astype(int), BLOCK - 1)
        start = z.copy()
        for level in range(int(parts.max(initial=0)).bit_length()):
            columns = (parts >> level & 1).astype(bool)
            if columns.any():
                start[:, columns] += self._gain(level) @ start[:, columns]
        share, moved = np.maximum(time / self.part - parts, 0.0), start
        for power in range(TERMS - 1, 0, -1):
            moved = start + self._low[1] @ moved * (share / power)
        return moved

    def first_event(self, z: FloatArray, time: float) -> tuple[float, int] | None:
        """When within a time of one block at most a switching function falls below zero, and which."""
        number = min(math.ceil(time / self.part), BLOCK) if len(self.events) else 0
        for first, last in pairwise(LOOKS):
            if first >= number:
                break
            begins = self._begins(self._after_parts(z, first), min(last, number) - first)
            below = begins.dot(self._tests) <= 0.0
            for part in below.any(axis=1).nonzero()[0].tolist():
                functions = {test % len(self.events) for test in below[part].nonzero()[0].tolist()}
                root = self._root(begins[part], functions)
                if root is not None and (late := (first + part + root[0]) * self.part) <= time:
                    return late, root[1]
        return None

    def _root(self, z: FloatArray, functions: set[int]) -> tuple[float, int] | None:
        """The first root within a part, in shares of it, of some of the functions."""
        size, best = np.abs(z), None
        for function in functions:
            polynomial = self._polynomials[function].dot(z).tolist()
            terms = float(self._sizes[function].dot(size))
            share = first_root(polynomial, ROUNDING * max(map(abs, polynomial)) + EXACT * terms)
            if share is not None and (best is None or share < best[0]):
                best = share, function
        return best


def fastest(matrix: FloatArray) -> float:
    """No less than the spectral radius of a matrix, and little more: the root of the norm of a high power of it."""
    logarithm, power = 0.0, matrix
    for squaring in range(SQUARINGS + 1):
        size = float(np.linalg.norm(power))
        if not size:
            return 0.0
        logarithm += math.log(size) / 2.0**squaring
        power = power / size @ (power / size)
    return math.exp(logarithm)
