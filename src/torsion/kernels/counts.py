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
_ROUNDINGS_OF_FLEXIBILITY = 4  # z and 1/z, seen as an error of h, and the margin of h
_ROUNDINGS_OF_STIFFNESS = 6  # the same z and 1/z, h + 1/z, its reciprocal and its margin
_STATIONS_FOR_LEVELS = 4  # average stations a level above which sweeping level by level is the faster (measured)
_FREQUENCIES_FOR_LEVELS = 200  # beyond which one station is enough work for one numpy call (measured)
_LARGEST_SWEEP = 2**21  # stations times frequencies held at once; 16 MB an array
_LEAST_BLOCK = 64  # frequencies in one sweep, however many stations


def count_below(tree: Tree, frequency: ArrayLike, *, bound: ArrayLike = 0) -> IntArray:
    """Number of natural frequencies (rigid motions included) strictly below each `frequency` (m,), rad/s.

    With `bound` = 0 every count is that of a train whose inertias and flexibilities differ by a few units of
    rounding. With +1 it is never less, with -1 never more than the exact count of the given train: every rounding is
    outweighed by more, or less, inertia and flexibility, in which the count is monotone. `bound` may differ for
    each frequency (m,). Flexibilities must be finite.
    """
    w = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    lean = np.broadcast_to(np.asarray(bound, dtype=np.float64), w.shape)
    by_levels = tree.size > len(tree.levels) * _STATIONS_FOR_LEVELS and len(w) <= _FREQUENCIES_FOR_LEVELS
    block = max(_LEAST_BLOCK, _LARGEST_SWEEP // max(tree.size, 1))
    count = np.zeros(len(w), dtype=np.int64)
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        for begin in range(0, len(w), block):
            part = slice(begin, begin + block)
            pivots = _pivots_by_levels if by_levels else _pivots_by_stations
            station, span = pivots(tree, w[part], _margins(tree, lean[part]))
            count[part] = np.count_nonzero(station < 0.0, axis=0) - np.count_nonzero(span < 0.0, axis=0)
    return count


@dataclass(frozen=True)
class _Margins:
    """Factors (m,) by which a count is made a bound."""

    inertia: FloatArray
    flexibility: FloatArray
    negative_stiffness: FloatArray
    positive_stiffness: FloatArray


def _margins(tree: Tree, lean: FloatArray) -> _Margins | None:
    """Factors that outweigh every rounding in the direction `lean` (m,); None where no bound is asked for."""
    if not lean.any():
        return None
    siblings = tree.most_children
    stiffness = lean * ((_ROUNDINGS_OF_STIFFNESS + siblings) * _UNIT_ROUNDOFF)
    return _Margins(
        inertia=1.0 + lean * ((_ROUNDINGS_OF_INERTIA + siblings) * _UNIT_ROUNDOFF),
        flexibility=1.0 + lean * (_ROUNDINGS_OF_FLEXIBILITY * _UNIT_ROUNDOFF),
        negative_stiffness=1.0 + stiffness,
        positive_stiffness=1.0 - stiffness,
    )


def _own(tree: Tree, w: FloatArray, margins: _Margins | None) -> FloatArray:
    """Dynamic stiffness (stations, m) of each station alone; written as a difference, so that a zero is positive."""
    square = w * w if margins is None else w * w * margins.inertia
    return tree.rest_stiffness[:, None] - np.multiply.outer(tree.moving_inertia, square)


def _pivots_by_stations(tree: Tree, w: FloatArray, margins: _Margins | None) -> tuple[FloatArray, FloatArray]:
    """z (stations, m) and h + 1/z (stations, m; 1 at a root), one station after another."""
    station, span = _own(tree, w, margins), np.ones((tree.size, len(w)))
    flexibility = list(
        tree.flexibility if margins is None else np.multiply.outer(tree.flexibility, margins.flexibility)
    )
    seen, pivot, passed, parents = list(station), list(span), np.empty(len(w)), tree.parent.tolist()
    for i in range(tree.size - 1, -1, -1):
        if parents[i] >= 0:
            np.reciprocal(seen[i], out=pivot[i])
            np.add(pivot[i], flexibility[i], out=pivot[i])
            np.reciprocal(pivot[i], out=passed)
            if margins is not None:
                passed *= np.where(passed < 0.0, margins.negative_stiffness, margins.positive_stiffness)
            np.add(seen[parents[i]], passed, out=seen[parents[i]])
    return station, span


def _pivots_by_levels(tree: Tree, w: FloatArray, margins: _Margins | None) -> tuple[FloatArray, FloatArray]:
    """Like `_pivots_by_stations`, all stations of equal distance from the root at once."""
    station, span = _own(tree, w, margins), np.ones((tree.size, len(w)))
    for family in tree.families[:0:-1]:
        h = tree.flexibility[family.stations, None]
        pivot = (h if margins is None else h * margins.flexibility) + 1.0 / station[family.stations]
        span[family.stations] = pivot
        passed = 1.0 / pivot
        if margins is not None:
            passed *= np.where(passed < 0.0, margins.negative_stiffness, margins.positive_stiffness)
        station[family.parents] += np.add.reduceat(passed, family.first, axis=0)
    return station, span
