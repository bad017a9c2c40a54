"""All solutions of A = twist(A), the amplitude of a vibration whose stiffness depends on it.

The curve of a resonance that bends has several at one speed. A / twist(A) is sampled over the whole range; every sign
change of its logarithm and every dip between three samples is followed to rounding.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.bracketed_search import find_root

SAMPLES = 240  # of a whole range
VALUES = 2**18  # of samples computed at once
TOLERANCE = 2e-16  # of the logarithm of an amplitude
GOLDEN = 0.3819660112501051  # (3 - sqrt 5)/2
NARROWED = 45  # times by 0.618: to 4e-10 of two samples, where a minimum is flat to rounding
LARGEST = 1e4  # rad: no twist of a shaft; beyond it a solution is taken as unbounded
Ratio = Callable[
    [FloatArray, IntArray], FloatArray
]  # amplitude (any,) rad of columns (any,) to A / twist(A)


@dataclass(frozen=True)
class Amplitudes:
    """The solutions of every column; none where the number is 0."""

    largest: FloatArray  # (columns,) rad
    smallest: FloatArray  # (columns,) rad
    nearest: FloatArray  # (columns,) rad, to an amplitude that is given
    number: IntArray  # (columns,)

    def having(self, other_amplitudes: "Amplitudes", columns: IntArray) -> "Amplitudes":
        """Return the same with other amplitudes in some columns."""
        copied = {key: values.copy() for key, values in vars(self).items()}
        for key, values in copied.items():
            values[columns] = getattr(other_amplitudes, key)
        return Amplitudes(**copied)


def amplitudes(
    ratio: Ratio, bottom: FloatArray, top: FloatArray, near: FloatArray, samples: int = SAMPLES
) -> Amplitudes:
    """Return every solution between `bottom` and `top` (columns,) rad, which the samples divide evenly in the logarithm."""
    column, roots = solutions(ratio, bottom, top, samples)
    largest = np.zeros(len(bottom))
    smallest = np.full(len(bottom), np.inf)
    number = np.zeros(len(bottom), dtype=int)
    np.maximum.at(largest, column, roots)
    np.minimum.at(smallest, column, roots)
    np.add.at(number, column, 1)
    order = np.lexsort((np.abs(np.log(roots / near[column])), column))
    nearest = np.zeros(len(bottom))
    where, begin = np.unique(column[order], return_index=True)
    nearest[where] = roots[order][begin]
    return Amplitudes(largest, np.where(number > 0, smallest, 0.0), nearest, number)


def solutions(
    ratio: Ratio, bottom: FloatArray, top: FloatArray, samples: int
) -> tuple[IntArray, FloatArray]:
    """Return the column and amplitude of every solution, as of `amplitudes`."""
    columns = np.arange(len(bottom))
    steps = np.linspace(0.0, 1.0, samples)[:, None]
    sampled = np.exp(np.log(bottom) * (1.0 - steps) + np.log(top) * steps)
    rows = max(VALUES // max(len(bottom), 1), 1)
    parts = [sampled[begin : begin + rows] for begin in range(0, samples, rows)]
    ratios = np.concatenate(
        [ratio(part.ravel(), np.tile(columns, len(part))).reshape(part.shape) for part in parts]
    )
    step, column = np.nonzero((ratios[:-1] < 1.0) != (ratios[1:] < 1.0))
    low, high = sampled[step, column], sampled[step + 1, column]
    begin, middle, end, dip_column = _dips(ratio, sampled, ratios)
    column = np.concatenate([column, dip_column, dip_column])
    low, high = np.concatenate([low, begin, middle]), np.concatenate([high, middle, end])
    if not len(low):
        return column, low

    # In the logarithm of the amplitude over the lower bound; at its end exactly the upper one, where the sign is known.
    end = np.log(high / low)
    growth = find_root(
        lambda growth: np.log(ratio(np.where(growth < end, low * np.exp(growth), high), column)),
        np.zeros(len(low)),
        end,
        tolerance=TOLERANCE,
    )
    return column, np.asarray(low * np.exp(growth))


def _dips(
    ratio: Ratio, sampled: FloatArray, ratios: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Begin, middle and end of every dip below 1 between samples that all lie above, which bracket two solutions.

    And the columns that they are in.
    """
    step, column = np.nonzero(
        (ratios[1:-1] >= 1.0) & (ratios[1:-1] <= ratios[:-2]) & (ratios[1:-1] <= ratios[2:])
    )
    begin, end = sampled[step, column], sampled[step + 2, column]
    if not step.size:
        return begin, begin, end, column
    low, high = np.log(begin), np.log(end)
    left, right = low + GOLDEN * (high - low), high - GOLDEN * (high - low)
    values = [ratio(np.exp(inner), column) for inner in (left, right)]
    for _ in range(NARROWED):
        down = values[0] < values[1]
        low, high = np.where(down, low, left), np.where(down, right, high)
        moved = np.where(down, low + GOLDEN * (high - low), high - GOLDEN * (high - low))
        value = ratio(np.exp(moved), column)
        left, right = np.where(down, moved, right), np.where(down, left, moved)
        values = [np.where(down, value, values[1]), np.where(down, values[0], value)]
    middle = np.exp(np.where(values[0] < values[1], left, right))
    deep = np.minimum(*values) < 1.0
    return begin[deep], middle[deep], end[deep], column[deep]
