"""What ends a regime: the first of its switching functions that falls below zero.

The motion is read at the ends of short parts. A part is looked at more closely where a function is below zero at an end
of it, or a tangent at one end is below zero at the other; there the functions are Taylor polynomials, and the root is
exact to rounding.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.first_root import first_root
from torsion.kernels.motion.linear_regime import Kept, Moved, Regime
from torsion.kernels.motion.modal_loads import Start, inputs_at

LOOKS = (0, 16, 64, 256)  # parts that are looked at together: most events come soon
BLOCK = LOOKS[-1]
RADIANS = 0.5  # of the fastest motion in a part: 0.5**16/16! = 7e-19
TERMS = 16  # of a Taylor polynomial
ORDERS = np.arange(float(TERMS))
FACTORIALS = np.cumprod([1.0, *range(1, TERMS)])
ROUNDING = 1e-13  # of the largest coefficient: a function below zero by less is at zero
EXACT = 2e-15  # of the terms of a function, whose sum it knows no better


def looks(number: int) -> Iterator[tuple[int, int]]:
    """First and last of the parts that are looked at together, of as many in all."""
    ends = [*LOOKS, *range(2 * BLOCK, number + BLOCK, BLOCK)]
    for first, last in pairwise(ends):
        if first < number:
            yield first, min(last, number)


@dataclass
class Watch:
    """The switching functions of a regime in parts of a length (s)."""

    regime: Regime
    part: float
    kept: dict[int, Kept] = field(default_factory=dict)

    @cached_property
    def rows(self) -> tuple[ComplexArray, FloatArray, FloatArray, FloatArray]:
        """(functions, ..) by coordinates, by what nothing holds, by inputs and by their rates."""
        regime, n, m = self.regime, self.regime.train.motions, self.regime.train.inputs
        position, speed, inputs, rates = np.split(regime.events, [n, 2 * n, 2 * n + m], axis=1)
        by_inputs = inputs + position @ regime.constraint
        return regime.reading(position, speed), position @ regime.free, by_inputs, rates

    @cached_property
    def has_rates(self) -> bool:
        """A function is of rates of inputs."""
        return bool(self.rows[3].any())

    @cached_property
    def sizes(self) -> FloatArray:
        """(functions, rows) magnitudes."""
        return np.abs(self.regime.events)

    def first_event(
        self, start: Start, first: int, last: int, length: float
    ) -> tuple[float, int, Moved] | None:
        """When (s since the start, up to a length) a function falls below zero within some parts, and which.

        Last stands the motion then.
        """
        regime, (by_y, by_turned, by_inputs, by_rates) = self.regime, self.rows
        time = self.part * np.arange(first, last + 1.0)
        # Answers of a whole look are the same from every start.
        is_whole = (first, last) in pairwise(LOOKS)
        kept = self.kept.setdefault(first, {}) if is_whole else None
        moved = regime.moved(start, time, kept, 3)
        number = len(moved.turned)
        rates = moved.input_rates
        value = (by_y @ moved.y).real + by_turned @ moved.turned + by_inputs @ moved.inputs
        rise = (by_y @ regime.rates_of(moved)).real + by_turned @ moved.y[:number].real
        rise += by_inputs @ rates[:, :, 0]
        if self.has_rates:
            value += by_rates @ rates[:, :, 0]
            rise += by_rates @ rates[:, :, 1]
        rise *= self.part
        below = (value[:, :-1] <= 0.0) | (value[:, 1:] <= 0.0)
        below |= (value + rise)[:, :-1] <= 0.0
        below |= (value - rise)[:, 1:] <= 0.0
        for part in np.flatnonzero(below.any(axis=0)).tolist():
            functions = np.flatnonzero(below[:, part]).tolist()
            column = Moved(moved.y[:, part], moved.turned[:, part], moved.inputs[:, part], rates)
            root = self._root(start, column, float(time[part]), functions)
            if root is not None and (late := float(time[part]) + root[0] * self.part) <= length:
                return late, *root[1:]
        return None

    def _root(
        self, start: Start, moved: Moved, time: float, functions: list[int]
    ) -> tuple[float, int, Moved] | None:
        """The first root of some of the functions within a part, in shares of it; the motion there."""
        regime, (by_y, by_turned, by_inputs, by_rates) = self.regime, self.rows
        inputs = inputs_at(regime.train, start, np.array([time]), TERMS + 1)[:, 0]
        y = np.empty((len(moved.y), TERMS), dtype=complex)
        y[:, 0], pushed = moved.y, regime.force @ inputs[:, : TERMS - 1]
        for order in range(1, TERMS):
            y[:, order] = regime.root * y[:, order - 1] + pushed[:, order - 1]
        turned = np.concatenate([moved.turned[:, None], y[: len(moved.turned), :-1].real], axis=1)
        terms = (by_y @ y).real + by_turned @ turned + by_inputs @ inputs[:, :TERMS]
        column = Moved(
            moved.y[:, None], moved.turned[:, None], moved.inputs[:, None], moved.input_rates
        )
        values = [regime.positions(column), regime.speeds(column.y), inputs[:, :1], inputs[:, 1:2]]
        size = EXACT * (self.sizes @ np.abs(np.concatenate(values))[:, 0])
        size += EXACT * (np.abs(by_y) @ np.abs(moved.y))
        if self.has_rates:
            terms += by_rates @ inputs[:, 1:]
        weight = self.part**ORDERS / FACTORIALS
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
