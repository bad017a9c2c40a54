"""Natural frequencies of trains with closed loops, many side by side, each proven by counts.

From the modes of the middle train every other begins at what shares of energy say, as in `variant_modes`. Rayleigh's
quotients of what `modal_way` finds beside it lead to its modes, and the counts of `network_counts` about the angles of
the mode enclose them, toward one root or another. A train that is not proven then is solved by itself.
"""

from dataclasses import replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.modes.loops import graph_modes, stiffest_tree
from torsion.kernels.modes.mode_shapes import TreeModes
from torsion.kernels.modes.natural_modes import expected_width
from torsion.kernels.modes.network_counts import Network, Way, modal_way, network_count
from torsion.kernels.modes.variant_modes import (
    VariantModes,
    enclosed,
    middle_of,
    parts,
    ritz_values,
    toward,
)
from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import pairs

_FURTHER = 12  # modes of the middle train beside those wanted, by which all others begin at first
_STEPS = 6  # of Rayleigh; 3 are usual
_SETTLED = 1e-13  # relative step of the square, after which a train is at rest
# Times the width that counts without chords need: a running error is a bound.
_OF_CHORDS = (16.0, 256.0)
_OF_MODES = (4.0, 32.0, 256.0)  # the same about the angles of the mode
_ROOTS = 6  # at most to be tried
_FEW_CHORDS = 16  # up to which all roots are tried; with more, a root that proves no mode is the last (measured)
# Whose eigenvalues round by less than _WIDEST, _EIGENVALUE L^2 2^-53; more are not counted.
_MOST_CHORDS = 45
_WIDEST = 2.0**-39  # relative half width, 1.8e-12; one not proven in it is solved by itself
_SOFT = 0.05  # of s h J, above which a span is soft


def network_modes(
    tree: Tree,
    flexibility: FloatArray,
    inertia: FloatArray,
    count: int,
    ends: tuple[IntArray, IntArray],
    chord: FloatArray,
) -> VariantModes:
    """As `variant_modes`, of trains with chords between the stations `ends`, of `chord` (chords, trains) rad/(N m).

    Columns that are not proven are those of the train by itself, with its bounds. Raises ValueError and SolveError as
    `variant_modes`.

    >>> ring, one = Tree(np.array([-1, 0, 1]), *np.zeros((2, 3)), np.zeros(3, dtype=bool)), np.ones((3, 2))
    >>> found = network_modes(ring, one / [1.0, 4.0], one, 2, (np.array([0]), np.array([2])), one[:1])
    >>> (found.frequency**2).round(12)  # 3 k of equal springs; with springs of 1, 4 and 4: 6 and 12
    array([[ 3.,  6.],
           [ 3., 12.]])
    """
    trains = flexibility.shape[1]
    if not np.all(chord > 0.0):
        raise ValueError("a chord needs a positive flexibility; put rigid spans into the tree")
    many = Network(
        replace(tree, flexibility=flexibility, inertia=inertia), pairs(tree.size, *ends), chord
    )
    mean = replace(tree, flexibility=middle_of(flexibility), inertia=middle_of(inertia))
    middle_modes = graph_modes(mean, *ends, middle_of(chord))
    elastic, rigid = len(middle_modes.frequency), middle_modes.rigid
    if elastic < count:
        raise ValueError(f"the trains have {elastic} elastic modes, not {count}")
    torn, root, passed = _torn(many, mean, ends, middle_modes, count)
    is_counted = torn.tree.parents.count(-1) == 1 and len(chord) <= _MOST_CHORDS
    bounds, number = np.empty((3, count, trains)), 0
    for part in parts(tree.size * (1 + len(chord)) * count, trains):
        # All modes of the middle train, which lose nothing, are for those that fewer do not prove.
        left = np.arange(part.start, part.stop)
        for further in sorted({min(count + _FURTHER, elastic), elastic}):
            if not (is_counted and left.size):
                break
            some = many.columns(left)
            chords = some.chord, middle_of(chord)
            start = ritz_values(some.tree, mean, middle_modes, further, chords)[:count]

            # Every mode of every train is a column.
            mode, column = (index.ravel() for index in np.indices(start.shape))
            each_bounds, proven = enclosed_each(
                torn.columns(left[column]), start.ravel(), passed[mode], mode + rigid, root
            )
            bounds[:, :, left] = each_bounds.reshape(3, *start.shape)
            left = left[~proven.reshape(start.shape).all(axis=0)]
        for column in left.tolist():
            train = many.tree.columns(column)
            modes_alone = counted_modes(train, *ends, chord[:, column], count)
            bounds[:, :, column] = modes_alone.frequency, modes_alone.lower, modes_alone.upper
            number += count
    frequency, lower, upper = bounds
    return VariantModes(frequency, lower, upper, number)


def counted_modes(
    tree: Tree, first: IntArray, second: IntArray, flexibility: FloatArray, count: int | None = None
) -> TreeModes:
    """As `graph_modes`, with bounds by counts and `certified` True where these enclose every mode.

    Not where parts of the train have no span between them, nor where counts do not say which mode it is in 1.8e-12, as
    with more than _MOST_CHORDS loops.

    >>> ring = Tree(np.array([-1, 0, 1]), np.array([0.0, 1.0, 1.0]), np.ones(3), np.zeros(3, dtype=bool))
    >>> found = counted_modes(ring, np.array([0]), np.array([2]), np.ones(1))
    >>> found.certified, bool((found.lower < np.sqrt(3.0)).all() and (found.upper > np.sqrt(3.0)).all())
    (True, True)
    """
    modes_found = graph_modes(tree, first, second, flexibility, count)
    modes = len(modes_found.frequency)
    if modes_found.certified or not modes or len(first) > _MOST_CHORDS:
        return modes_found
    single = Network(
        replace(tree, flexibility=tree.flexibility[:, None], inertia=tree.inertia[:, None]),
        pairs(tree.size, first, second),
        flexibility[:, None],
    )
    # Counts need a tree, whose loops are closed by what the elimination carries of each chord.
    torn, root, passed = _torn(single, tree, (first, second), modes_found, modes)
    if torn.tree.parents.count(-1) != 1:
        return modes_found
    bounds, proven = enclosed_each(
        torn.columns(np.zeros(modes, dtype=np.int64)),
        modes_found.frequency,
        passed,
        np.arange(modes) + modes_found.rigid,
        root,
    )
    if not proven.all():
        return modes_found
    _, lower, upper = bounds
    return replace(
        modes_found,
        frequency=np.clip(modes_found.frequency, lower, upper),
        lower=lower,
        upper=upper,
        certified=True,
    )


def _torn(
    many: Network, mean: Tree, ends: tuple[IntArray, IntArray], modes: TreeModes, count: int
) -> tuple[Network, int, FloatArray]:
    """The trains as trees of the stiffest spans; the station of most energy, and `passed` over s, of `modes` of `mean`."""
    tree = many.tree
    torn = stiffest_tree(mean, *ends, middle_of(many.chord))
    is_used = np.append(mean.parent >= 0, np.ones(len(many.chord), dtype=bool))
    given, flexibility = np.concatenate([tree.flexibility, many.chord]), None
    flexibility = np.zeros((mean.size + len(torn.first), given.shape[1]))
    flexibility[torn.span[is_used]] = given[is_used]
    moved = np.empty_like(tree.inertia)
    moved[torn.station] = tree.inertia
    new = replace(torn.tree, flexibility=flexibility[: mean.size], inertia=moved)
    energy = (mean.moving_inertia[:, None] * modes.angle[:, :count] ** 2).sum(axis=1)
    passed = np.abs(modes.torque * modes.angle[mean.parent]).sum(axis=0) / modes.frequency**2
    pair = pairs(mean.size, torn.first, torn.second)
    return (
        Network(new, pair, flexibility[mean.size :]),
        int(torn.station[np.argmax(energy)]),
        passed,
    )


def _way(trains: Network, root: int, square: float) -> Way:
    """Elimination near s = `square`: q follows the spans that are stiff beside the inertia at either end."""
    steps, sign = toward(trains.tree, root), trains.pair.copy()
    load, inertia, soft = np.zeros_like(sign), middle_of(trains.tree.moving_inertia), list[int]()
    carries = np.asarray(trains.pair.any(axis=0))
    carries[root] = True
    for station, near, span in steps:
        # A station at a chord's end, or between one and the root, carries its share; all others are eliminated alone.
        carries[near] |= carries[station]
        sign[:, near] += sign[:, station]
        stiffest = max(inertia[station], inertia[near]) * square
        if len(sign) and middle_of(trains.tree.flexibility[[span]])[0] * stiffest > _SOFT:
            load[:, station] += sign[:, station]
            load[:, near] -= 0.0 if trains.tree.held[near] else sign[:, station]
            soft.append(station)
    twisted = sign.copy()
    twisted[:, soft] = 0.0
    core = np.array([*(station for station, _, _ in steps if carries[station]), root])
    position = dict(zip(core.tolist(), range(len(core)), strict=True))
    sign, twisted, load = (values[:, core, None] for values in (sign, twisted, load))
    return Way(
        trains,
        [step for step in steps if not carries[step[0]]],
        [(position[i], position[near], span) for i, near, span in steps if carries[i]],
        core,
        sign,
        twisted,
        load,
        lift=np.zeros((len(sign), 1)),
        basis=np.eye(len(sign))[:, :, None],
    )


def enclosed_each(
    trains: Network, frequency: FloatArray, passed: FloatArray, mode: IntArray, root: int
) -> tuple[FloatArray, BoolArray]:
    """Better frequencies and bounds (3, m) rad/s, each with its own train and `mode`, and which are proven.

    Roots are tried until all are: each has its own resonances of parts of the torn tree, beside which counts are less
    sure.
    """
    bounds, proven = np.stack([frequency] * 3), np.zeros(len(frequency), dtype=bool)
    near, ends = frequency.copy(), np.flatnonzero(trains.pair.any(axis=0) & ~trains.tree.held)
    heaviest = ends[np.argsort(-trains.tree.moving_inertia[ends].sum(axis=1), kind="stable")]
    for station in dict.fromkeys([*heaviest[:_ROOTS].tolist(), root]):
        proven_before = proven.sum()
        for attempt in ("about the mode", "with static angles", "with static angles as given"):
            left = np.flatnonzero(~proven)
            if not left.size:
                return bounds, proven
            if attempt == "with static angles as given":
                # A step beside a node at a chord may have left its mode.
                left = left[np.abs(near[left] - frequency[left]) > _WIDEST * frequency[left]]
                near[left] = frequency[left]
                if not left.size:
                    continue
            some = trains.columns(left)
            way = static = _way(some, station, float(near[left].max()) ** 2)
            at_rest = np.zeros(len(left), dtype=bool)
            for _ in range(_STEPS if attempt == "about the mode" else 0):
                way, square = modal_way(static, near[left] ** 2)
                step = np.where(at_rest, 0.0, square / near[left] ** 2 - 1.0)
                near[left] *= np.sqrt(1.0 + step)
                at_rest |= np.abs(step) <= _SETTLED
                if at_rest.all():
                    break
            bounds[0, left] = near[left]
            widened = _OF_CHORDS if way.terms is None else _OF_MODES
            width = expected_width(some.tree, near[left], passed[left] * near[left] ** 2)
            bounds[1:, left], proven[left] = enclosed(
                way,
                network_count,
                near[left],
                np.minimum(width, _WIDEST / widened[-1]),
                mode[left],
                widened,
            )
        if len(trains.chord) > _FEW_CHORDS and proven.sum() == proven_before:
            break
    return bounds, proven
