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

from torsion.kernels.centre import by_layers, hung_from_the_middle
from torsion.kernels.layers import add_children
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree

_UNIT_ROUNDOFF = 2.0**-53
# Roundings that a bound has to outweigh, one unit each, and one more for every child of the station they enter:
_ROUNDINGS_OF_INERTIA = 5  # w^2, its margin, the product with J
_ROUNDINGS_OF_FLEXIBILITY = 3  # z and 1/z, seen as an error of h
_ROUNDINGS_OF_STIFFNESS = 6  # the same z and 1/z, h + 1/z, its reciprocal and its margin
_LARGEST_SWEEP = 2**21  # stations times frequencies held at once; 16 MB an array
_MOST_IN_BYTE = 255
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
    swept = tree if tree.is_ready else by_layers(tree).tree
    return _count(swept, w, _margins(swept, np.broadcast_to(np.asarray(bound, dtype=np.float64), w.shape)))


def count_bounds(tree: Tree, low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
    """A count never less than the exact one at each of `low` (m,) rad/s, and one never more at each of `high` (m,)."""
    number, swept = len(low), tree if tree.is_ready else hung_from_the_middle(tree).tree
    lean = np.ones(2 * number)
    lean[number:] = -1.0
    count = _count(swept, np.concatenate((low, high)), _margins(swept, lean))
    return count[:number], count[number:]


def _count(tree: Tree, w: FloatArray, margins: "_Margins | None") -> IntArray:
    """Negative pivots z less negative pivots h + 1/z at each `w` (m,), in blocks, so that memory stays bounded."""
    negative = _bound_in_chain if tree.is_chain and margins is not None else _negative
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


def _negative(tree: Tree, square: FloatArray, margin: FloatArray | None) -> IntArray:
    """Negative z less negative h + 1/z at each `square` (m,) of a frequency; the latter are those that pass on less."""
    station, size = tree.own_stiffness(square), tree.size
    passed = np.empty((size + 1, len(square)))
    passed[:size] = tree.flexibility[:, None]
    passed[size] = 0.0
    if tree.is_swept_by_stations:
        _by_stations(tree, station, passed, margin)
    else:
        _by_layers(tree, station, passed, margin)
    is_counted = station < 0.0
    is_counted &= ~np.signbit(passed[:size])
    return _sum_of_rows(is_counted)


def _by_stations(tree: Tree, station: FloatArray, passed: FloatArray, margin: FloatArray | None) -> None:
    """Fill `station` and `passed` from the leaves inward, one station after another."""
    seen, through, add = list(station), list(passed), np.add
    for i, parent in zip(range(tree.size - 1, -1, -1), reversed(tree.parents), strict=True):
        if parent >= 0:
            _pass_on(seen[i], through[i], margin)
            add(seen[parent], through[i], seen[parent])
        else:
            through[i].fill(0.0)


def _by_layers(tree: Tree, station: FloatArray, passed: FloatArray, margin: FloatArray | None) -> None:
    """Fill `station` and `passed` from the leaves inward, layer by layer."""
    room, reciprocal, add = np.empty_like(station), np.reciprocal, np.add
    passed[: tree.parents.count(-1)] = 0.0
    for layer in reversed(tree.layers or ()):
        through, factor = passed[layer.stations], room[layer.stations]
        reciprocal(station[layer.stations], factor)
        add(through, factor, through)
        reciprocal(through, through)
        if margin is not None:
            _lessen(through, margin, factor)
        add_children(layer, passed, station[layer.above])


def _bound_in_chain(tree: Tree, square: FloatArray, margin: FloatArray | None) -> IntArray:
    """Like `_negative`, from both ends of a chain to its middle, side by side: half as many operations.

    Not for a plain count: its zero pivots, where a frequency is met exactly, would depend on where the sweep ends.
    """
    stations, columns = tree.size, len(square)
    arm, first = (stations - 1) // 2, (stations - 1) % 2
    own = tree.own_stiffness(square)
    single = np.full(columns, tree.flexibility[first])
    if first:  # the near arm is longer by one station
        _pass_on(own[0], single, margin)
        own[1] += single
    station, span = np.empty((2, arm, 2, columns))
    station[:, 0], station[:, 1] = own[first : first + arm], own[: stations - 1 - arm : -1]
    span[:, 0] = tree.flexibility[first + 1 : first + 1 + arm, None]
    span[:, 1] = tree.flexibility[: stations - 1 - arm : -1, None]
    both, passed = None if margin is None else np.concatenate((margin, margin)), np.zeros(2 * columns)
    for z, through in zip(station.reshape(arm, 2 * columns), span.reshape(arm, 2 * columns), strict=True):
        np.add(z, passed, z)
        _pass_on(z, through, both)
        passed = through
    own[first + arm] += passed[:columns] + passed[columns:]
    number = _sum_of_rows(np.greater(station.reshape(-1, columns) < 0.0, np.signbit(span.reshape(-1, columns))))
    if first:
        number += (own[0] < 0.0) & ~np.signbit(single)
    number += own[first + arm] < 0.0
    return number


def _pass_on(stiffness: FloatArray, through: FloatArray, margin: FloatArray | None) -> None:
    """Turn `through` (m,), a flexibility h, into what its span passes on of a `stiffness` z (m,): 1/(h + 1/z)."""
    inverse = np.reciprocal(stiffness)
    np.add(through, inverse, through)
    np.reciprocal(through, through)
    if margin is not None:
        _lessen(through, margin, inverse)


def _lessen(through: FloatArray, margin: FloatArray, factor: FloatArray) -> None:
    """Make `through` (stations, m) less by the relative `margin` (m,); `factor` (stations, m) is room to work in."""
    np.sign(through, factor)
    np.multiply(factor, margin, factor)
    np.subtract(_ONE, factor, factor)
    np.multiply(through, factor, through)


def _sum_of_rows(rows: BoolArray) -> IntArray:
    """Number of rows (m,) that are true, by sums of bytes, which do not overflow."""
    number = np.zeros(rows.shape[1], dtype=np.int64)
    for begin in range(0, len(rows), _MOST_IN_BYTE):
        number += np.add.reduce(rows[begin : begin + _MOST_IN_BYTE].view(np.uint8), axis=0, dtype=np.uint8)
    return number
