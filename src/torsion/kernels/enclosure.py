"""Proof of natural frequencies by counts: enclosures around given values, and bisection where nothing is known."""

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.counts import count_below, count_bounds, roundings
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree

_NARROWEST = 2.0**-51  # relative half width first tried where nothing else is known, two units in the last place
_DOUBLINGS = 12  # a value that is not proven then is taken to be wrong
_WIDEST = 2.0**-39  # 1.8e-12, after 12 doublings of the narrowest
_OVER_MARGIN = 1.25  # for the roundings that a margin outweighs: with it most proofs succeed at once (measured)
_GRID = 2.0 ** np.arange(-166.0, 167.0)  # rad/s; their squares, times or over any sensible inertia, stay in range
_POINTS = 15  # points inside each bracket in one sweep of the multisection


def enclose(
    tree: Tree, frequency: FloatArray, rigid: int, width: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Bounds `lower`, `upper` (m,) rad/s of the modes rigid, rigid + 1, ... and which (m,) of them are proven.

    Mode j is proven by a count that exceeds the exact one at `lower` and is at most j, and one that the exact count
    exceeds at `upper` and is at least j + 1. `width` (m,) is the relative half width to begin with.
    """
    half = np.full(len(frequency), _NARROWEST) if width is None else np.where(width <= _WIDEST, width, _NARROWEST)
    lower, upper, left = frequency * (1.0 - half), frequency * (1.0 + half), np.arange(len(frequency))
    proven = _are_proven(tree, lower, upper, left + rigid)
    for _ in range(_DOUBLINGS):
        if proven.all():
            break
        half *= 2.0
        left = np.flatnonzero(~proven & (half <= _WIDEST))
        low, high = frequency[left] * (1.0 - half[left]), frequency[left] * (1.0 + half[left])
        good = _are_proven(tree, low, high, left + rigid)
        done = left[good]
        lower[done], upper[done], proven[done] = low[good], high[good], True
    return lower, upper, proven


def expected_width(tree: Tree, frequency: FloatArray, passed: FloatArray) -> FloatArray:
    """Relative half width (m,) in which a proof of each frequency (m,) is expected to succeed, to first order.

    A margin d of the stiffness that a span passes on moves w^2 by d times torque times angle at the parent, whose sum
    over the spans is `passed` (m,) N m for shapes of generalised inertia 1; one of all inertias by d w^2.
    """
    square, stiffness = roundings(tree)
    return _NARROWEST + _OVER_MARGIN * 0.5 * (square + stiffness * passed / frequency**2)


def _are_proven(tree: Tree, low: FloatArray, high: FloatArray, mode: IntArray) -> BoolArray:
    """Whether each `low` (m,) is proven to be below `mode` (m,), and each `high` above it."""
    at_most, at_least = count_bounds(tree, low, high)
    proven: BoolArray = (at_most <= mode) & (at_least > mode)
    return proven


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
