"""Sturm counts: how many natural frequencies lie below a given one; and where these lie, proven by such counts.

At angular frequency w the dynamic stiffness z of a station's branch, seen at it, is the sum of what the spans to its
children pass on, less w^2 J; a span of flexibility h passes on zz = z / (1 + h z). Eliminating the angle of a station
and the torque of a span has the pivots z and -(h + 1/z), so by Sylvester's law of inertia the count is the number of
negative z less the number of negative h + 1/z. Neither 0 nor infinity is a special case: h = 0, J = 0 and a fixed
station (z = inf) come out right in IEEE arithmetic. (Demmel and Gragg 1993 for the accuracy on trees.)

A distributed shaft is a flexibility between two inertias, all three functions of the frequency. Below the lowest
frequency of any shaft with both ends fixed (`Shafts.limit`) the count needs no correction (Wittrick and Williams 1971).
"""

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.tree import Tree

SHARE_OF_LIMIT = (
    0.95  # of the frequency from which counts of distributed shafts would need a correction
)
_OCTAVES = 332  # searched below the limit; with squares, end inertias and stiffnesses in range
_GRID = 2.0 ** np.arange(
    -166.0, 167.0
)  # rad/s, without limit; squares, times or over sensible inertias, stay in range
_POINTS = 15  # inside the bracket of one mode in one sweep of the multisection
_COLUMNS = 512  # frequencies in one sweep above which points cost more than sweeps (measured)
_POINTS_A_MODE = 3  # at least
_NEAR = 1e-2  # relative width of a bracket from which a mode alone in it, divided once more, is polished
_COINCIDENT = 1e-7  # relative width at which counts no longer separate modes
_NARROWEST = (
    2.0**-51
)  # relative half width first tried where nothing else is known, two units in the last place
_WIDEST = (
    2.0**-39
)  # 1.8e-12, after 12 doublings of the narrowest; a value not proven then is taken to be wrong
_WIDEST_A_STATION = 2.0**-51  # the same of long chains, whose roundings add up
_WIDEST_OF_SHAFTS = 2.0**-36  # 1.5e-11, for the rounding of their laws is in it too
_OVER_MARGIN = 1.25  # for the roundings that a margin outweighs: with it most enclosures succeed at once (measured)
_UNIT_ROUNDOFF = 2.0**-53
# Roundings that a bound has to outweigh, one unit each, and one more for every child of the station they enter:
_ROUNDINGS_OF_INERTIA = 5  # w^2, its margin, the product with J
_ROUNDINGS_OF_FLEXIBILITY = 3  # z and 1/z, seen as an error of h
_ROUNDINGS_OF_STIFFNESS = 6  # the same z and 1/z, h + 1/z, its reciprocal and its margin
_ROUNDINGS_OF_ENDS = 3  # sums of the end inertias of shafts
_ARGUMENT = (
    16 * _UNIT_ROUNDOFF
)  # relative, of s in the laws: w^2, the travel time of a shaft, the modes of an element
_LARGEST_SWEEP = 2**21  # stations times frequencies kept at once; 16 MB an array
_LEAST_BLOCK = 64  # frequencies in one sweep, however many stations


def count_below(tree: Tree, frequency: ArrayLike, *, bound: ArrayLike = 0) -> IntArray:
    """Number of natural frequencies (rigid motions included) strictly below each `frequency` (m,), rad/s.

    With `bound` = 0 every count is that of a train whose inertias and flexibilities differ by a few units of
    rounding. With +1 it is never less, with -1 never more than the exact count of the given train: every rounding is
    outweighed by more, or less, inertia and flexibility, in which the count is monotone. `bound` may differ for
    each frequency (m,). Flexibilities must be finite.

    The rounding of the law of a shaft is outweighed as stated by it: proven for linear elements, found by comparison
    with many digits for all others.
    """
    w = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    lean = np.broadcast_to(np.asarray(bound, dtype=np.float64), w.shape)
    return _count(tree, w, lean if lean.any() else None)


def count_bounds(tree: Tree, low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
    """A count never less than the exact one at each of `low` (m,) rad/s, and one never more at each of `high` (m,)."""
    number = len(low)
    lean = np.ones(2 * number)
    lean[number:] = -1.0
    count = _count(tree, np.concatenate((low, high)), lean)
    return count[:number], count[number:]


def margins(tree: Tree, square: FloatArray) -> tuple[FloatArray | float, float, float]:
    """Relative margins of a bound: of s = w^2 (m,) with inertias, of s in the laws of shafts, of what spans pass on."""
    siblings = tree.most_children
    of_square: FloatArray | float = _ROUNDINGS_OF_INERTIA + siblings + _ROUNDINGS_OF_FLEXIBILITY
    of_square, of_laws = of_square * _UNIT_ROUNDOFF, 0.0
    if tree.shafts is not None:
        of_ends = (tree.most_children + _ROUNDINGS_OF_ENDS) * _UNIT_ROUNDOFF
        of_square, of_laws = of_square + of_ends + 2.0 * tree.shafts.rounding(square), _ARGUMENT
    return of_square, of_laws, (_ROUNDINGS_OF_STIFFNESS + siblings) * _UNIT_ROUNDOFF


def _count(tree: Tree, w: FloatArray, lean: FloatArray | None) -> IntArray:
    """Negative pivots z less negative pivots h + 1/z at each `w` (m,), in blocks, so that memory stays bounded.

    `lean` (m,) is the direction in which every rounding is outweighed.
    """
    block = max(_LEAST_BLOCK, _LARGEST_SWEEP // max(tree.size, 1))
    parts = [slice(begin, begin + block) for begin in range(0, max(len(w), 1), block)]
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        return np.concatenate(
            [_negative(tree, w[part], None if lean is None else lean[part]) for part in parts]
        )


def _negative(tree: Tree, w: FloatArray, lean: FloatArray | None) -> IntArray:
    """Negative z less negative h + 1/z at each `w` (m,); the latter are those that pass on less."""
    square, margin = w * w, None
    of_laws = square
    if lean is not None:
        of_square, of_argument, of_stiffness = margins(tree, square)
        of_laws, margin = square * (1.0 + lean * of_argument), lean * of_stiffness
        square = square * (1.0 + lean * of_square)
    station = 0.0 - tree.inertia_columns * square  # a difference, so that a zero is positive
    station[tree.held] = np.inf
    passed = np.empty_like(station)
    passed[:] = tree.flexibility_columns
    if tree.shafts is not None:
        passed[tree.shafts.node], inner, outer = tree.shafts.at(of_laws)
        tree.add_ends(station, inner * -square, outer * -square)

    # A span of flexibility h passes on 1/(h + 1/z) of what the station shows, a little less to outweigh roundings.
    stiffness, through = list(station), list(passed)
    for i, parent in zip(range(tree.size - 1, -1, -1), reversed(tree.parents), strict=True):
        if parent < 0:
            through[i].fill(0.0)
            continue
        through[i] += np.reciprocal(stiffness[i])
        np.reciprocal(through[i], through[i])
        if margin is not None:
            through[i] *= 1.0 - np.sign(through[i]) * margin
        stiffness[parent] += through[i]
    return np.asarray(((station < 0.0) & ~np.signbit(passed)).sum(axis=0))


def enclose(
    tree: Tree, frequency: FloatArray, rigid: int, passed: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Bounds `lower`, `upper` (m,) rad/s of the modes rigid, rigid + 1, ... and which (m,) of them are proven.

    Mode j is proven by a count that exceeds the exact one at `lower` and is at most j, and one that the exact count
    exceeds at `upper` and is at least j + 1. `passed` (m,) N m of the shapes says in which width an enclosure is
    expected to succeed: see `expected_width`.
    """
    widest = max(_WIDEST, _WIDEST_A_STATION * tree.size)
    if tree.shafts is not None:
        widest = max(widest, _WIDEST_OF_SHAFTS)
    half = expected_width(tree, frequency, 0.0 if passed is None else passed)

    # A shape next to a repeated frequency says nothing of the width.
    unlikely = ~(half <= widest)
    if unlikely.any():
        half[unlikely] = expected_width(tree, frequency, 0.0)[unlikely]
    left, proven = np.arange(len(frequency)), np.zeros(len(frequency), dtype=np.bool_)
    lower = upper = frequency
    while len(left):
        lower, upper = frequency * (1.0 - half), frequency * (1.0 + half)
        at_most, at_least = count_bounds(tree, lower[left], upper[left])
        proven[left] = (at_most <= left + rigid) & (at_least > left + rigid)

        # What is not proven is tried in twice the width.
        half = np.where(proven, half, 2.0 * half)
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


def brackets(
    tree: Tree, mode: IntArray, *, tolerance: float | None = None
) -> tuple[FloatArray, FloatArray]:
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
        raise SolveError(
            "a natural frequency lies outside 1e-50..1e50 rad/s; check the units of inertia and stiffness"
        )
    bracket = np.array([grid[above - 1], grid[above], count[above - 1], count[above]])
    left = np.arange(len(mode))
    while len(left):
        before = bracket[:, left]
        bracket[:, left] = _refined(tree, mode[left], before)
        low, high, *_ = bracket[:, left]
        width = (high - low) / high
        if tolerance is None:
            done = ((before[3] - before[2] == 1) & (width <= _NEAR)) | (width <= _COINCIDENT)
        else:
            done = (width <= tolerance) | (high - low >= before[1] - before[0])
        left = left[~done]
    return bracket[0], bracket[1]


def _refined(tree: Tree, mode: IntArray, bracket: FloatArray) -> FloatArray:
    """Narrower brackets of `mode` (m,): each divided by points in proportion to the modes that share it.

    `found` (4, m): bounds rad/s, and the counts at them.
    """
    _, first, which, sharing = np.unique(
        bracket[0], return_index=True, return_inverse=True, return_counts=True
    )
    number = np.maximum(
        min(_POINTS, max(_POINTS_A_MODE, _COLUMNS // len(mode))), _POINTS_A_MODE * sharing
    )
    inside = [
        a + (b - a) * (np.arange(1, n + 1) / (n + 1))
        for a, b, n in zip(*bracket[:2, first], number, strict=True)
    ]
    counts = np.split(count_below(tree, np.concatenate(inside)), np.cumsum(number)[:-1])
    members = np.split(np.argsort(which.reshape(-1), kind="stable"), np.cumsum(sharing)[:-1])
    narrower = bracket.copy()
    for (low, high, below, up_to), places, count, rows in zip(
        bracket[:, first].T, inside, counts, members, strict=True
    ):
        ladder = np.concatenate(([low], places, [high]))
        counted = np.concatenate(
            ([below], np.clip(np.maximum.accumulate(count), below, up_to), [up_to])
        )
        above = np.searchsorted(counted, mode[rows], side="right")
        narrower[:, rows] = ladder[above - 1], ladder[above], counted[above - 1], counted[above]
    return narrower
