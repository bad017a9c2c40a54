"""What ends a regime: the first of its switching functions that falls below zero.

The motion is read at the ends of short parts. A part is looked at more closely where a function is below zero at an end
of it, or a tangent at one end is below zero at the other; there the functions are Taylor polynomials, and the root is
exact to rounding.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.regimes.first_root import first_root
from torsion.kernels.motion.regimes.linear_regime import Moved, Regime
from torsion.kernels.motion.regimes.sampled_rows import Rows, rows_of

LOOKS = (0, 16, 64, 256)  # parts that are looked at together: most events come soon
BLOCK = LOOKS[-1]
RADIANS = 0.5  # of the fastest motion in a part: 0.5**16/16! = 7e-19
TERMS = 16  # of a Taylor polynomial
ORDERS = np.arange(float(TERMS))
FACTORIALS = np.cumprod([1.0, *range(1, TERMS)])
ROUNDING = 1e-13  # of the largest coefficient: a function below zero by less is at zero
EXACT = 2e-15  # of the terms of a function, whose sum it knows no better

Motion = Callable[[float, int], Moved]


def looks(number: int) -> Iterator[tuple[int, int]]:
    """First and last of the parts that are looked at together, of as many in all."""
    ends = [*LOOKS, *range(2 * BLOCK, number + BLOCK, BLOCK)]
    for first, last in pairwise(ends):
        if first < number:
            yield first, min(last, number)


@dataclass
class Watch:
    """The switching functions of a regime."""

    regime: Regime

    @cached_property
    def rows(self) -> Rows:
        """(functions, ...)"""
        return rows_of(self.regime, self.regime.events)

    @cached_property
    def sizes(self) -> FloatArray:
        """(functions, rows) magnitudes."""
        return np.abs(self.regime.events)

    def first_event(
        self, motion: Motion, time: FloatArray, values: FloatArray, length: float
    ) -> tuple[float, int, Moved] | None:
        """When (s since the start, up to a length) a function falls below zero between some times, and which.

        values: (2 functions, times) functions and their rates. motion: gives the motion at a time, with so many
        derivatives of its inputs. Last stands the motion at the event.
        """
        part = float(time[1] - time[0])
        value, rise = values[: len(values) // 2], values[len(values) // 2 :] * part
        below = (value[:, :-1] <= 0.0) | (value[:, 1:] <= 0.0)
        below |= (value + rise)[:, :-1] <= 0.0
        below |= (value - rise)[:, 1:] <= 0.0
        for number in np.flatnonzero(below.any(axis=0)).tolist():
            functions = np.flatnonzero(below[:, number]).tolist()
            root = self._root(motion(float(time[number]), TERMS + 1), part, functions)
            if root is not None and (late := float(time[number]) + root[0] * part) <= length:
                return late, *root[1:]
        return None

    def _root(
        self, moved: Moved, part: float, functions: list[int]
    ) -> tuple[float, int, Moved] | None:
        """The first root of some of the functions within a part that begins so, in shares of it; the motion there."""
        regime, rows = self.regime, self.rows
        inputs = np.concatenate([moved.inputs, moved.input_rates[:, 0]], axis=1)
        pushed = (regime.force @ inputs[:, : TERMS - 1]).T
        derivatives = np.empty((TERMS, len(moved.y)), dtype=complex)
        derivatives[0] = moved.y[:, 0]
        for order in range(1, TERMS):
            derivatives[order] = regime.root * derivatives[order - 1] + pushed[order - 1]
        y = derivatives.T
        turned = np.concatenate([moved.turned, y[: len(moved.turned), :-1].real], axis=1)
        terms = (rows.by_y @ y).real + rows.by_turned @ turned
        terms += rows.by_inputs[0] @ inputs[:, :TERMS] + rows.by_inputs[1] @ inputs[:, 1:]
        values = [regime.positions(moved), regime.speeds(moved.y), inputs[:, :1], inputs[:, 1:2]]
        size = EXACT * (self.sizes @ np.abs(np.concatenate(values)))[:, 0]
        size += EXACT * (np.abs(rows.by_y) @ np.abs(moved.y))[:, 0]
        weight = part**ORDERS / FACTORIALS
        terms *= weight
        best: tuple[float, int] | None = None
        for function in functions:
            polynomial = terms[function].tolist()
            rounding = ROUNDING * max(map(abs, polynomial)) + float(size[function])
            share = first_root(polynomial, rounding)
            if share is not None and (best is None or share < best[0]):
                best = share, function
        if best is None:
            return None
        weight = weight * best[0] ** ORDERS
        there = Moved(
            np.asarray(y @ weight, dtype=complex)[:, None],
            np.asarray(turned @ weight)[:, None],
            np.asarray(inputs[:, :TERMS] @ weight)[:, None],
            moved.input_rates,
        )
        return *best, there
