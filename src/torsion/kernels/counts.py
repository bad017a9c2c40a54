"""Sturm counts: how many natural frequencies lie below a given one, by one sweep from the leaves to the roots.

At angular frequency w the dynamic stiffness z of everything outward of a station, seen at it, is the sum of what its
outward spans pass on, less w^2 J; a span of flexibility h passes on zz = z / (1 + h z). Eliminating the angle of a
station and the torque of a span has the pivots z and -(h + 1/z), so by Sylvester's law of inertia the count is the
number of negative z less the number of negative h + 1/z. Neither 0 nor infinity is a special case: h = 0, J = 0 and
a held station (z = inf) come out right in IEEE arithmetic. (Demmel and Gragg 1993 for the accuracy on trees.)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsion.kernels.tree import FloatArray, IntArray, Tree

_UNIT_ROUNDOFF = 2.0**-53
# Roundings that a bound has to outweigh, one unit each, and one more for every child of the station they enter:
_ROUNDINGS_OF_INERTIA = 5  # w^2, its margin, the product with J
_ROUNDINGS_OF_FLEXIBILITY = 3  # z and 1/z, seen as an error of h
_ROUNDINGS_OF_STIFFNESS = 6  # the same z and 1/z, h + 1/z, its reciprocal and its margin
_STATIONS_FOR_LEVELS = 4  # average stations a level above which sweeping level by level is the faster (measured)
_FREQUENCIES_FOR_LEVELS = 200  # beyond which one station is enough work for one numpy call (measured)
_LARGEST_SWEEP = 2**21  # stations times frequencies held at once; 16 MB an array
_ONE = np.ones(())
_LEAST_BLOCK = 64  # frequencies in one sweep, however many stations


def count_below(tree: Tree, frequency: ArrayLike, *, bound: ArrayLike = 0) -> IntArray:
    """Number of natural frequencies (rigid motions included) strictly below each `frequency` (m,), rad/s.

    With `bound` = 0 every count is that of a train whose inertias and flexibilities differ by a few units of
    rounding. With +1 it is never less, with -1 never more than the exact count of the given train: every rounding is
    outweighed by more, or less, inertia and flexibility, in which the count is monotone. `bound` may differ for
    each frequency (m,). Flexibilities must be finite.
    """
    w = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    return _count(tree, w, _margins(tree, np.broadcast_to(np.asarray(bound, dtype=np.float64), w.shape)))


def count_bounds(tree: Tree, low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
    """A count never less than the exact one at each of `low` (m,) rad/s, and one never more at each of `high` (m,)."""
    number = len(low)
    lean = np.ones(2 * number)
    lean[number:] = -1.0
    count = _count(tree, np.concatenate((low, high)), _margins(tree, lean))
    return count[:number], count[number:]


def _count(tree: Tree, w: FloatArray, margins: "_Margins | None") -> IntArray:
    """Negative pivots z less negative pivots h + 1/z at each `w` (m,)."""
    negative = _negative_by_stations
    if tree.is_chain and margins is not None:
        negative = _bound_in_chain
    elif len(w) <= _FREQUENCIES_FOR_LEVELS and tree.size > (tree.depth + 1) * _STATIONS_FOR_LEVELS:
        negative = _negative_by_levels
    square = w * w if margins is None else w * w * margins.square
    stiffness = None if margins is None else margins.stiffness
    block = max(_LEAST_BLOCK, _LARGEST_SWEEP // max(tree.size, 1))
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        if len(w) <= block:
            return negative(tree, square, stiffness)
        parts = [slice(begin, begin + block) for begin in range(0, len(w), block)]
        return np.concatenate(
            [negative(tree, square[part], None if stiffness is None else stiffness[part]) for part in parts]
        )


def _negative(rows: FloatArray) -> IntArray:
    """Number of negative values (m,) in `rows` (..., m)."""
    number: IntArray = np.add.reduce(rows < 0.0, axis=tuple(range(rows.ndim - 1)), dtype=np.int64)
    return number


@dataclass(frozen=True)
class _Margins:
    """By how much, relatively, a count at each frequency (m,) is made a bound."""

    square: FloatArray  # 1 + that of the inertias and flexibilities, which the count knows by their product only
    stiffness: FloatArray  # of what a span passes on; positive makes less of it


def _margins(tree: Tree, lean: FloatArray) -> _Margins | None:
    """What outweighs every rounding in the direction `lean` (m,); None where no bound is asked for."""
    if not lean.any():
        return None
    square, stiffness = roundings(tree)
    return _Margins(1.0 + lean * square, lean * stiffness)


def roundings(tree: Tree) -> tuple[float, float]:
    """Relative margins of a bound: of the square of the frequency, and of the stiffness that a span passes on."""
    siblings = 2 if tree.is_chain else tree.most_children
    square = _ROUNDINGS_OF_INERTIA + siblings + _ROUNDINGS_OF_FLEXIBILITY
    return square * _UNIT_ROUNDOFF, (_ROUNDINGS_OF_STIFFNESS + siblings) * _UNIT_ROUNDOFF


def _pass(z: FloatArray, flexibility: FloatArray, margin: FloatArray | None, pivot: FloatArray) -> FloatArray:
    """What a span passes on of `z` (m,), made less by the relative `margin` (m,); `pivot` (m,) becomes h + 1/z."""
    np.reciprocal(z, pivot)
    np.add(pivot, flexibility, pivot)
    passed: FloatArray = np.reciprocal(pivot)
    if margin is not None:
        factor = np.sign(passed)
        np.multiply(factor, margin, factor)
        np.subtract(_ONE, factor, factor)
        np.multiply(passed, factor, passed)
    return passed


def _negative_by_stations(tree: Tree, square: FloatArray, margin: FloatArray | None) -> IntArray:
    """Negative z less negative h + 1/z at each `square` (m,) of a frequency, one station after another."""
    station = tree.own_stiffness(square)
    span = np.ones_like(station)
    seen, pivot, flexibility, parents = list(station), list(span), tree.flexibilities, tree.parents
    for i in range(tree.size - 1, -1, -1):
        if parents[i] >= 0:
            inward = seen[parents[i]]
            np.add(inward, _pass(seen[i], flexibility[i], margin, pivot[i]), inward)
    return _negative(station) - _negative(span)


def _bound_in_chain(tree: Tree, square: FloatArray, margin: FloatArray | None) -> IntArray:
    """Like `_negative_by_stations`, from both ends of a chain to its middle, side by side: half as many operations.

    Not for a plain count: its zero pivots, where a frequency is met exactly, would depend on where the sweep ends.
    """
    stations, columns = tree.size, len(square)
    arm, first = (stations - 1) // 2, (stations - 1) % 2
    own = tree.own_stiffness(square)
    single = np.ones(columns)
    if first:  # the near arm is longer by one station
        own[1] += _pass(own[0], tree.flexibilities[1], margin, single)
    station, span, spans = np.empty((3, arm, 2, columns))
    station[:, 0], station[:, 1] = own[first : first + arm], own[: stations - 1 - arm : -1]
    spans[:, 0] = tree.flexibility[first + 1 : first + 1 + arm, None]
    spans[:, 1] = tree.flexibility[: stations - 1 - arm : -1, None]
    both, passed = None if margin is None else np.stack((margin, margin)), np.zeros((2, columns))
    for z, flexibility, pivot in zip(station, spans, span, strict=True):
        np.add(z, passed, z)
        passed = _pass(z, flexibility, both, pivot)
    own[first + arm] += passed[0] + passed[1]
    ends = own[:1] if first else own[:0]
    middle = own[first + arm : first + arm + 1]
    return _negative(station) + _negative(ends) + _negative(middle) - _negative(span) - (single < 0.0)


def _negative_by_levels(tree: Tree, square: FloatArray, margin: FloatArray | None) -> IntArray:
    """Like `_negative_by_stations`, all stations of equal distance from the root at once."""
    station = tree.own_stiffness(square)
    span = np.ones_like(station)
    for family in tree.families[:0:-1]:
        pivot = np.empty((len(family.stations), len(square)))
        passed = _pass(station[family.stations], tree.flexibility[family.stations, None], margin, pivot)
        span[family.stations] = pivot
        station[family.parents] += np.add.reduceat(passed, family.first, axis=0)
    return _negative(station) - _negative(span)
