"""Sturm counts of a tree with bars, below the lowest frequency of any bar with both ends held.

As for a plain tree (`counts`), with flexibility and inertia of the bars as functions of frequency: below that limit the
count of the pi is the count of the continuum (Wittrick and Williams 1971, whose correction is zero there). A bound
outweighs the rounding of the laws too: the dynamic stiffness of a bar falls with the frequency, with its flexibility
and with its end inertias, so that each may be made larger, or smaller, by more than it can be wrong.
"""

import numpy as np

from torsion.kernels.bars.tree import BarTree
from torsion.kernels.counts import roundings
from torsion.kernels.tree import FloatArray, IntArray

_UNIT_ROUNDOFF = 2.0**-53
ARGUMENT = 16 * _UNIT_ROUNDOFF  # relative, of s in the laws: w^2, the travel time of a bar or the modes of an element
_LARGEST_SWEEP = 2**20  # stations times frequencies held at once; 8 MB an array
_LEAST_BLOCK = 64  # frequencies in one sweep, however many stations


def count_below(train: BarTree, frequency: FloatArray) -> IntArray:
    """Number of natural frequencies (rigid motions included) strictly below each `frequency` (m,), rad/s."""
    return _count(train, frequency, None)


def count_bounds(train: BarTree, low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
    """A count never less than the exact one at each of `low` (m,) rad/s, and one never more at each of `high` (m,).

    Exact up to the stated rounding of the laws, which is proven for linear elements and found by comparison with many
    digits for all others.
    """
    number = len(low)
    lean = np.ones(2 * number)
    lean[number:] = -1.0
    count = _count(train, np.concatenate((low, high)), lean)
    return count[:number], count[number:]


def margins(train: BarTree, square: FloatArray) -> tuple[FloatArray, float]:
    """Relative margins of a bound: of s (m,), that of the laws included, and of the stiffness that a span passes on."""
    plain, stiffness = roundings(train.tree)
    ends = (train.tree.most_children + 3) * _UNIT_ROUNDOFF  # sums of end inertias
    return plain + ends + 2.0 * train.bars.rounding(square), stiffness


def _count(train: BarTree, w: FloatArray, lean: FloatArray | None) -> IntArray:
    block = max(_LEAST_BLOCK, _LARGEST_SWEEP // max(train.tree.size, 1))
    parts = [slice(begin, begin + block) for begin in range(0, len(w), block)]
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        found = [_negative(train, w[part], None if lean is None else lean[part]) for part in parts]
    return np.concatenate(found) if found else np.empty(0, dtype=np.int64)


def _negative(train: BarTree, w: FloatArray, lean: FloatArray | None) -> IntArray:
    """Negative pivots z less negative pivots h + 1/z at each `w` (m,)."""
    square, margin = w * w, None
    if lean is not None:
        of_square, of_stiffness = margins(train, square)
        margin = lean * of_stiffness
        flexibility, inner, outer = train.bars.at(square * (1.0 + lean * ARGUMENT))
        square = square * (1.0 + lean * of_square)
    else:
        flexibility, inner, outer = train.bars.at(square)
    station = train.tree.own_stiffness(square)
    minus = -square
    train.add_ends(station, inner * minus, outer * minus)
    span = np.ones_like(station)
    seen, pivots, h, parents = list(station), list(span), train.flexibilities(flexibility), train.tree.parents
    reciprocal, add, passed = np.reciprocal, np.add, np.empty_like(w)
    for i in range(train.tree.size - 1, -1, -1):
        parent = parents[i]
        if parent < 0:
            continue
        pivot, inward = pivots[i], seen[parent]
        reciprocal(seen[i], pivot)
        add(pivot, h[i], pivot)
        reciprocal(pivot, passed)
        if margin is not None:
            np.multiply(passed, 1.0 - np.sign(passed) * margin, passed)
        add(inward, passed, inward)
    number: IntArray = np.add.reduce(station < 0.0, axis=0, dtype=np.int64)
    number -= np.add.reduce(span < 0.0, axis=0, dtype=np.int64)
    return number
