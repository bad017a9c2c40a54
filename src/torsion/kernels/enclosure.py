"""Proof of natural frequencies by counts: enclosures around given values, and bisection where nothing is known."""

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.counts import count_below
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree

_NARROWEST = 2.0**-51  # relative half width first tried, two units in the last place
_DOUBLINGS = 12  # widest: 1.8e-12; a value that is not proven then is taken to be wrong
_COUNTS_AT_ONCE = 400  # widths are tried together while all their frequencies fit in one cheap sweep
_GRID = 2.0 ** np.arange(-166.0, 167.0)  # rad/s; their squares, times or over any sensible inertia, stay in range
_POINTS = 15  # points inside each bracket in one sweep of the multisection


def enclose(tree: Tree, frequency: FloatArray, rigid: int) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Bounds `lower`, `upper` (m,) rad/s of the modes rigid, rigid + 1, ... and which (m,) of them are proven.

    Mode j is proven by a count that exceeds the exact one at `lower` and is at most j, and one that the exact count
    exceeds at `upper` and is at least j + 1.
    """
    lower, upper, proven = frequency.copy(), frequency.copy(), np.zeros(len(frequency), dtype=bool)
    doubling = 0
    while doubling <= _DOUBLINGS and not proven.all():
        left = np.flatnonzero(~proven)
        tried = min(max(1, _COUNTS_AT_ONCE // (2 * len(left))), _DOUBLINGS + 1 - doubling, 4)
        width = _NARROWEST * 2.0 ** np.arange(doubling, doubling + tried)[:, None]
        low, high = frequency[left] * (1.0 - width), frequency[left] * (1.0 + width)
        sure_low, sure_high = _proofs(tree, low, high, left + rigid)
        for below, above, good_low, good_high in zip(low, high, sure_low, sure_high, strict=True):
            good = good_low & good_high & ~proven[left]
            lower[left[good]], upper[left[good]], proven[left[good]] = below[good], above[good], True
        doubling += tried
    return lower, upper, proven


def _proofs(tree: Tree, low: FloatArray, high: FloatArray, mode: IntArray) -> tuple[BoolArray, BoolArray]:
    """Whether each `low` (widths, m) is proven to be below `mode` (m,), and each `high` above it."""
    both = np.concatenate([low.ravel(), high.ravel()])
    count = count_below(tree, both, bound=np.repeat([1.0, -1.0], low.size)).reshape(2, *low.shape)
    return count[0] <= mode, count[1] > mode


def bisect(tree: Tree, mode: IntArray, *, tolerance: float) -> FloatArray:
    """Frequencies (m,) rad/s of the modes `mode` (m,), counted from 0 with the rigid ones, to a relative `tolerance`.

    All brackets are divided by 16 in one sweep over the tree. Raises SolveError for a frequency outside 1e-50..1e50.
    """
    count = count_below(tree, _GRID)
    above = np.searchsorted(np.maximum.accumulate(count), mode, side="right")
    if np.any(above == 0) or np.any(above == len(_GRID)):
        raise SolveError("a natural frequency lies outside 1e-50..1e50 rad/s; check the units of inertia and stiffness")
    low, high = _GRID[above - 1], _GRID[above]
    fraction = np.arange(1, _POINTS + 1) / (_POINTS + 1)
    rows = np.arange(len(mode))
    while np.any(high - low > tolerance * high):
        inside = low[:, None] + (high - low)[:, None] * fraction
        not_above = count_below(tree, inside.ravel()).reshape(inside.shape) <= mode[:, None]
        position = np.count_nonzero(np.logical_and.accumulate(not_above, axis=1), axis=1)
        ladder = np.column_stack([low, inside, high])
        narrower = ladder[rows, position + 1] - ladder[rows, position] < high - low
        if not narrower.any():
            break
        low, high = ladder[rows, position], ladder[rows, position + 1]
    return low + 0.5 * (high - low)
