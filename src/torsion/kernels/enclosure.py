"""Where the natural frequencies lie, by Sturm counts: brackets, bisection, proven enclosures around given values."""

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.sturm import count_below, count_bounds, margins
from torsion.kernels.tree import Tree

SHARE_OF_LIMIT = 0.95  # of the frequency from which counts of distributed shafts would need a correction
_OCTAVES = 332  # searched below the limit; with squares, end inertias and stiffnesses in range
_GRID = 2.0 ** np.arange(-166.0, 167.0)  # rad/s, without limit; squares, times or over sensible inertias, stay in range
_POINTS = 15  # inside the bracket of one mode in one sweep of the multisection
_COLUMNS = 512  # frequencies in one sweep above which points cost more than sweeps (measured)
_POINTS_A_MODE = 3  # at least
_NEAR = 1e-2  # relative width of a bracket from which a mode alone in it, divided once more, is polished
_COINCIDENT = 1e-7  # relative width at which counts no longer separate modes
_NARROWEST = 2.0**-51  # relative half width first tried where nothing else is known, two units in the last place
_WIDEST = 2.0**-39  # 1.8e-12, after 12 doublings of the narrowest; a value not proven then is taken to be wrong
_WIDEST_OF_SHAFTS = 2.0**-36  # 1.5e-11, for the rounding of their laws is in it too
_OVER_MARGIN = 1.25  # for the roundings that a margin outweighs: with it most enclosures succeed at once (measured)


def enclose(
    tree: Tree, frequency: FloatArray, rigid: int, passed: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Bounds `lower`, `upper` (m,) rad/s of the modes rigid, rigid + 1, ... and which (m,) of them are proven.

    Mode j is proven by a count that exceeds the exact one at `lower` and is at most j, and one that the exact count
    exceeds at `upper` and is at least j + 1. `passed` (m,) N m of the shapes says in which width an enclosure is
    expected to succeed: see `expected_width`.
    """
    widest = _WIDEST if tree.shafts is None else _WIDEST_OF_SHAFTS
    half = expected_width(tree, frequency, 0.0 if passed is None else passed)
    unlikely = ~(half <= widest)
    if unlikely.any():
        half[unlikely] = expected_width(tree, frequency, 0.0)[unlikely]
    (lower, upper), left = np.empty((2, len(frequency))), np.arange(len(frequency))
    proven = np.zeros(len(frequency), dtype=np.bool_)
    while len(left):
        lower[left], upper[left] = frequency[left] * (1.0 - half[left]), frequency[left] * (1.0 + half[left])
        at_most, at_least = count_bounds(tree, lower[left], upper[left])
        proven[left] = (at_most <= left + rigid) & (at_least > left + rigid)
        half *= 2.0
        left = np.flatnonzero(~proven & (half <= widest))
    return lower, upper, proven


def expected_width(tree: Tree, frequency: FloatArray, passed: FloatArray | float) -> FloatArray:
    """Relative half width (m,) in which an enclosure of each frequency (m,) should succeed, to first order.

    A margin d of the stiffness that a span passes on moves w^2 by d times torque times angle at the parent, whose sum
    over the spans is `passed` (m,) N m for shapes of generalised inertia 1; one of all inertias by d w^2.
    """
    square = frequency**2
    of_square, of_laws, of_stiffness = margins(tree, square)
    with np.errstate(invalid="ignore", over="ignore"):
        moved: FloatArray = of_square + of_laws + of_stiffness * passed / square
    return _NARROWEST + _OVER_MARGIN * 0.5 * moved


def bisect(tree: Tree, mode: IntArray, *, tolerance: float) -> FloatArray:
    """Middles (m,) rad/s of the `brackets` of the modes `mode` (m,), of the relative width `tolerance`."""
    low, high = brackets(tree, mode, tolerance=tolerance)
    return low + 0.5 * (high - low)


def brackets(tree: Tree, mode: IntArray, *, tolerance: float | None = None) -> tuple[FloatArray, FloatArray]:
    """Bounds (m,) rad/s of the modes `mode` (m,), ascending, counted from 0 with the rigid ones.

    To a relative `tolerance`, by default near enough to polish. All brackets are divided by one sweep over the tree.
    Raises SolveError for a mode above the limit of distributed shafts, or outside 1e-50..1e50 rad/s.
    """
    top = np.inf if tree.shafts is None else SHARE_OF_LIMIT * tree.shafts.limit
    grid = top * 2.0 ** np.arange(-float(_OCTAVES), 1.0) if np.isfinite(top) else _GRID
    count = np.maximum.accumulate(count_below(tree, grid))
    above = np.searchsorted(count, mode, side="right")
    if np.isfinite(top) and np.any(above == len(grid)):
        raise SolveError(
            f"only {np.count_nonzero(above < len(grid))} of the requested natural frequencies lie below {top:.6g} rad/s"
            ", for which the pieces of the shafts are short enough; divide the shafts more finely, or request"
            " fewer modes"
        )
    if np.any((above == 0) | (above == len(grid))):
        raise SolveError("a natural frequency lies outside 1e-50..1e50 rad/s; check the units of inertia and stiffness")
    found = np.array([grid[above - 1], grid[above], count[above - 1], count[above]])
    left = np.arange(len(mode))
    while len(left):
        before = found[:, left]
        found[:, left] = _refined(tree, mode[left], before)
        low, high, *_ = found[:, left]
        width = (high - low) / high
        if tolerance is None:
            done = ((before[3] - before[2] == 1) & (width <= _NEAR)) | (width <= _COINCIDENT)
        else:
            done = (width <= tolerance) | (high - low >= before[1] - before[0])
        left = left[~done]
    return found[0], found[1]


def _refined(tree: Tree, mode: IntArray, found: FloatArray) -> FloatArray:
    """Narrower brackets of `mode` (m,): each divided by points in proportion to the modes that share it.

    `found` (4, m): bounds rad/s, and the counts at them.
    """
    _, first, which, sharing = np.unique(found[0], return_index=True, return_inverse=True, return_counts=True)
    number = np.maximum(min(_POINTS, max(_POINTS_A_MODE, _COLUMNS // len(mode))), _POINTS_A_MODE * sharing)
    inside = [a + (b - a) * (np.arange(1, n + 1) / (n + 1)) for a, b, n in zip(*found[:2, first], number, strict=True)]
    counts = np.split(count_below(tree, np.concatenate(inside)), np.cumsum(number)[:-1])
    members = np.split(np.argsort(which.reshape(-1), kind="stable"), np.cumsum(sharing)[:-1])
    narrower = found.copy()
    for (low, high, below, up_to), places, count, rows in zip(found[:, first].T, inside, counts, members, strict=True):
        ladder = np.concatenate(([low], places, [high]))
        known = np.concatenate(([below], np.clip(np.maximum.accumulate(count), below, up_to), [up_to]))
        above = np.searchsorted(known, mode[rows], side="right")
        narrower[:, rows] = ladder[above - 1], ladder[above], known[above - 1], known[above]
    return narrower
