"""Natural frequencies and mode shapes of a tree, each frequency with an enclosure that Sturm counts prove.

At angular frequency w the dynamic stiffness z of a station's branch, seen at it, is the sum of what the spans to its
children pass on, less w^2 J; a span of flexibility h passes on zz = z / (1 + h z). Eliminating the angle of a station
and the torque of a span has the pivots z and -(h + 1/z), so by Sylvester's law of inertia the count is the number of
negative z less the number of negative h + 1/z. Neither 0 nor infinity is a special case: h = 0, J = 0 and a fixed
station (z = inf) come out right in IEEE arithmetic. (Demmel and Gragg 1993 for the accuracy on trees.)

A distributed shaft is a flexibility between two inertias, all three functions of the frequency. Below the lowest
frequency of any shaft with both ends fixed (`Shafts.limit`) the count needs no correction (Wittrick and Williams 1971).
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.modes.mode_shapes import (
    ShaftModes,
    Shapes,
    TreeModes,
    orthogonalise,
    repeated_groups,
    repeated_shapes,
    shaft_energies,
    shape_sign,
    shapes_at,
)
from torsion.kernels.trees.tree import (
    Rigidity,
    Step,
    Tree,
    bends,
    cut,
    rigid_shapes,
    rigidity,
    with_reactions,
)
from torsion.sources import source

SHARE_OF_LIMIT = (
    0.95  # of the frequency from which counts of distributed shafts would need a correction
)
_OCTAVES = 332  # searched below the limit; with squares, end inertias and stiffnesses in range
_GRID = 2.0 ** np.arange(
    -166.0, 167.0
)  # rad/s, without limit; squares, times or over sensible inertias, stay in range
_POINTS = 15  # inside the bracket of one mode in one sweep of the multisection, at most
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
    w = np.atleast_1d(np.asarray(frequency, dtype=float))
    lean = np.broadcast_to(np.asarray(bound, dtype=float), w.shape)

    # Negative pivots z less negative pivots h + 1/z, which are those that pass on less; in blocks, so that memory stays
    # bounded.
    block, counts = max(_LEAST_BLOCK, _LARGEST_SWEEP // max(tree.size, 1)), list[IntArray]()
    for begin in range(0, max(len(w), 1), block):
        square, margin = np.square(w[begin : begin + block]), None
        of_laws = square
        if lean.any():
            side = lean[begin : begin + block]
            of_square, of_argument, of_stiffness = margins(tree, square)
            of_laws, margin = square * (1.0 + side * of_argument), side * of_stiffness
            square = square * (1.0 + side * of_square)
        station = 0.0 - tree.inertia_columns * square  # a difference, so that a zero is positive
        station[tree.held] = np.inf
        passed = np.empty_like(station)
        passed[:] = tree.flexibility.reshape(tree.size, -1)
        with np.errstate(divide="ignore", over="ignore", under="ignore"):
            if tree.shafts is not None:
                passed[tree.shafts.node], inner, outer = tree.shafts.at(of_laws)
                tree.add_ends(station, inner * -square, outer * -square)
            passed[tree.parent < 0] = 0.0
            pass_on(tree.steps, list(station), list(passed), margin)
        counts.append(((station < 0.0) & ~np.signbit(passed)).sum(axis=0))
    return np.concatenate(counts)


def margins(tree: Tree, square: FloatArray) -> tuple[FloatArray | float, float, float]:
    """Relative margins of a bound: of s = w^2 (m,) with inertias, of s in the laws of shafts, of what spans pass on."""
    siblings = tree.most_children
    of_square: FloatArray | float = _ROUNDINGS_OF_INERTIA + siblings + _ROUNDINGS_OF_FLEXIBILITY
    of_square, of_laws = of_square * _UNIT_ROUNDOFF, 0.0
    if tree.shafts is not None:
        of_ends = (siblings + _ROUNDINGS_OF_ENDS) * _UNIT_ROUNDOFF
        of_square, of_laws = of_square + of_ends + 2.0 * tree.shafts.rounding(square), _ARGUMENT
    return of_square, of_laws, (_ROUNDINGS_OF_STIFFNESS + siblings) * _UNIT_ROUNDOFF


def pass_on(
    steps: list[Step],
    stiffness: Sequence[FloatArray],
    through: Mapping[int, FloatArray] | Sequence[FloatArray],
    margin: FloatArray | float | None,
) -> None:
    """Add to stations (m,) N m/rad what spans pass on of those behind, 1/(h + 1/z), in place of h in `through` (m,).

    A little less, by `margin` (m,) of it, to outweigh roundings.
    """
    for station, near, span in steps:
        row = through[span]
        row += np.reciprocal(stiffness[station])
        np.reciprocal(row, row)
        if margin is not None:
            row *= 1.0 - np.sign(row) * margin
        stiffness[near] += row


def enclose(
    tree: Tree, frequency: FloatArray, rigid: int, passed: FloatArray | float = 0.0
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Bounds `lower`, `upper` (m,) rad/s of the modes rigid, rigid + 1, ... and which (m,) of them are proven.

    Mode j is proven by a count that exceeds the exact one at `lower` and is at most j, and one that the exact count
    exceeds at `upper` and is at least j + 1. `passed` (m,) N m of the shapes says in which width an enclosure is
    expected to succeed: see `expected_width`.
    """
    widest = max(_WIDEST, _WIDEST_A_STATION * tree.size)
    if tree.shafts is not None:
        widest = max(widest, _WIDEST_OF_SHAFTS)
    half = expected_width(tree, frequency, passed)

    # A shape next to a repeated frequency says nothing of the width.
    unlikely = ~(half <= widest)
    if unlikely.any():
        half[unlikely] = expected_width(tree, frequency, 0.0)[unlikely]
    left, proven = np.arange(len(frequency)), np.zeros(len(frequency), dtype=bool)
    lower = upper = frequency
    while len(left):
        lower, upper = frequency * (1.0 - half), frequency * (1.0 + half)
        w, side = np.concatenate((lower[left], upper[left])), np.repeat((1.0, -1.0), len(left))
        at_most, at_least = count_below(tree, w, bound=side).reshape(2, -1)
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
        # Every bracket is divided once, however many modes share it; they share its counts at the points inside.
        before = bracket[:, left]
        shared, which = np.unique(before, axis=1, return_inverse=True)
        many, (begin, end, below, up_to) = shared.shape[1], shared
        number = max(_POINTS_A_MODE, min(_COLUMNS // many, _POINTS * max(len(left) // many, 1)))
        inside = begin + (end - begin) * np.linspace(0.0, 1.0, number + 2)[1:-1, None]
        counts = count_below(tree, inside.ravel()).reshape(inside.shape)
        counts = np.clip(np.maximum.accumulate(counts, axis=0), below, up_to)
        ladder, counted = np.vstack([begin, inside, end]), np.vstack([below, counts, up_to])
        which = which.reshape(-1)
        above = (counted[:, which] <= mode[left]).sum(axis=0)
        low, high = ladder[above - 1, which], ladder[above, which]
        bracket[:, left] = low, high, counted[above - 1, which], counted[above, which]
        width = (high - low) / high
        if tolerance is None:
            done = ((before[3] - before[2] == 1) & (width <= _NEAR)) | (width <= _COINCIDENT)
        else:
            done = (width <= tolerance) | (high - low >= before[1] - before[0])
        left = left[~done]
    return bracket[0], bracket[1]


_SETTLED = (
    1e-15  # relative change of a frequency after which its shape is that of the final frequency
)
_STEPS = 6  # more, from a bracket; Rayleigh quotients converge cubically, Newton's steps of shafts less fast
_DENSE = 200  # stations up to which a decomposition finds a start sooner than counts (measured)
_SPREAD = 1e6  # of its values that it leaves right to about 1e-10
_TRUSTED = 0.1  # relative distance from such a start beyond which a step has left its mode
_BEYOND = 1e-2  # of the width of a bracket that a step may leave it by
_FULL_BISECTION = 2.0**-52


@source("WittrickWilliams1971")
def tree_modes(tree: Tree, count: int | None = None) -> TreeModes:
    """The lowest `count` elastic modes of a tree, or all.

    Frequencies closer than 1e-13 (relative) count as repeated: their shapes are one orthogonal set of many. Raises
    SolveError for a frequency that cannot be proven. Flexibilities must be finite, inertias not negative.

    With distributed shafts a mode above 0.95 times the lowest frequency of a shaft with both ends fixed raises SolveError.
    """
    bodies = rigidity(tree.static)
    rigid, wanted = len(bodies.free_roots), bodies.elastic if count is None else count
    if tree.shafts is None or not math.isfinite(tree.shafts.limit):
        wanted = min(wanted, bodies.elastic)

    # Rigid spans between fixed stations carry reactions only: they are put back at the end.
    solved = cut(tree, bodies)
    if wanted == 0:
        frequency = lower = upper = np.empty(0)
        shapes = shapes_at(tree, frequency)
    else:
        frequency, shapes = _polish(solved, *start_frequencies(tree, solved, bodies, wanted))
        frequency, lower, upper, wrong = _enclosed(solved, frequency, rigid, shapes.passed)
        if wrong.any():  # what bisection has corrected has another shape
            shapes = shapes_at(solved, frequency)

        # Repeated frequencies have one set of shapes; those of close ones are made orthogonal.
        groups = repeated_groups(frequency, ~np.isfinite(shapes.passed))
        if groups:
            shapes.put(np.concatenate(groups), repeated_shapes(solved, frequency, groups))
        orthogonalise(solved, frequency, shapes)
        shapes.scale(shape_sign(shapes.angle))
    torque, of_shafts = _torques(tree, bodies, frequency, shapes)
    rigid_angle = rigid_shapes(tree.static, bodies)
    return TreeModes(
        frequency, lower, upper, shapes.angle, torque, rigid, rigid_angle, shafts=of_shafts
    )


def start_frequencies(
    tree: Tree, solved: Tree, bodies: Rigidity, wanted: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Frequencies (wanted,) rad/s to begin with, ascending, and bounds within which steps from them are trusted.

    `solved` is the same train without rigid spans between fixed stations.
    """
    if tree.shafts is None and tree.size <= _DENSE:
        inertia = np.sqrt(tree.moving_inertia)[:, None] * bends(tree, bodies)[3]
        values = np.linalg.svd(inertia, compute_uv=False)[: bodies.elastic]
        if values[-1] * _SPREAD > values[0]:
            start = np.asarray(1.0 / values[:wanted], dtype=float)
            return start, start * (1.0 - _TRUSTED), start * (1.0 + _TRUSTED)
    low, high = brackets(solved, len(bodies.free_roots) + np.arange(wanted))
    room = _BEYOND * (high - low)
    return low + 0.5 * (high - low), low - room, high + room


def _polish(
    tree: Tree, frequency: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, Shapes]:
    """Frequencies (m,) after Rayleigh's steps within `low` and `high`, ascending, and the shapes that go with them."""
    shapes = shapes_at(tree, frequency)
    left, correction = np.arange(len(frequency)), shapes.correction
    for step in range(1 + _STEPS):
        if step:
            again = shapes_at(tree, frequency[left])
            shapes.put(left, again)
            correction = again.correction

        # Rayleigh's quotient gives the change of the square; the root of it without a difference.
        estimate = frequency[left]
        with np.errstate(invalid="ignore", over="ignore"):
            share = correction / (estimate * estimate)
            change = share / (1.0 + np.sqrt(1.0 + share))
            moved = estimate * (1.0 + change)

        # A step out of its bounds has gone to another mode: the enclosure will find that.
        inside = (moved >= low[left]) & (moved <= high[left])
        frequency[left[inside]] = moved[inside]
        left = left[inside & (np.abs(change) >= _SETTLED)]
        if not len(left):
            break
    if (frequency[1:] >= frequency[:-1]).all():
        return frequency, shapes
    order = np.argsort(frequency, kind="stable")
    return frequency[order], Shapes(*(values[..., order] for values in vars(shapes).values()))


def _enclosed(
    tree: Tree, frequency: FloatArray, rigid: int, passed: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Frequencies, bounds `lower` and `upper`, and which frequencies had to be found anew by bisection; all (m,)."""
    lower, upper, proven = enclose(tree, frequency, rigid, passed)
    wrong = ~proven
    if not proven.all():
        frequency = frequency.copy()
        low, high = brackets(tree, np.flatnonzero(wrong) + rigid, tolerance=_FULL_BISECTION)
        frequency[wrong] = low + 0.5 * (high - low)
        frequency.sort()
        lower, upper, proven = enclose(tree, frequency, rigid)
        if not proven.all():
            where = ", ".join(f"{w:.6g}" for w in frequency[~proven])
            remedy = (
                "divide the shafts more finely"
                if tree.shafts is not None
                else "request fewer modes, or `model: exact`"
            )
            raise SolveError(
                f"the natural frequencies near {where} rad/s could not be enclosed; {remedy}"
            )
    return frequency, lower, upper, wrong


def _torques(
    tree: Tree, bodies: Rigidity, frequency: FloatArray, shapes: Shapes
) -> tuple[FloatArray, ShaftModes | None]:
    """Torques (stations, m) at the root ends of the spans, and what distributed shafts add.

    With those of rigid spans between fixed stations; the inertia of a shaft takes its part of them.
    """
    if tree.shafts is None:
        return with_reactions(tree, bodies, shapes.torque), None
    node, square = tree.shafts.node, frequency * frequency
    torque, outer = shapes.torque.copy(), shapes.torque.copy()
    torque[node], outer[node] = shapes.inner, shapes.outer
    of_shafts, elastic_of_shafts = shaft_energies(
        tree, tree.shafts, square, shapes.angle, shapes.torque
    )
    kinetic = np.where(bodies.fixed, 0.0, tree.inertia)[:, None] * shapes.angle**2
    tree.add_ends(kinetic, 0.5 * of_shafts, 0.5 * of_shafts)
    elastic = tree.flexibility[:, None] * shapes.torque**2
    elastic[node] = elastic_of_shafts
    taken, by_shafts = np.zeros_like(torque), (outer - torque)[node]
    tree.add_ends(taken, by_shafts, np.zeros_like(by_shafts))
    outer = with_reactions(tree, bodies, outer, taken)
    springs = np.delete(np.arange(tree.size), node)
    torque[springs] = outer[springs]
    return torque, ShaftModes(outer, kinetic, elastic / square, of_shafts)
