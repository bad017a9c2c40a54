"""Natural frequencies of trains with closed loops, many side by side, each proven by counts.

From the modes of the middle train every other begins at what shares of energy say, as in `variant_modes`. Newton's
steps make the dynamic stiffness zero that is seen at the station with the most kinetic energy; the same elimination at
s (1 + i 1e-100) has the slope. What the counts of `network_counts` do not enclose with static angles is bracketed
anew if it is another mode, then enclosed with the angles of its mode, toward one root or another. A train that is not
proven then is solved by itself.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.chords import pairs
from torsion.kernels.loops import graph_modes, stiffest_tree
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.network_counts import Elimination, Network, Way, modal_way, network_count
from torsion.kernels.sturm import expected_width
from torsion.kernels.tree import Tree
from torsion.kernels.variant_modes import (
    Selection,
    VariantModes,
    changes,
    enclosed,
    middle_of,
    parts,
    toward,
)

_STEP = 1e-100  # relative, imaginary: beside it nothing changes but imaginary parts (Squire and Trapp 1998)
_STEPS = 12  # of Newton; 3 are usual, 9 beside a pole of the stiffness that the root sees
_HALVINGS = 14  # of a bracket of two octaves
_SETTLED = 1e-10  # relative step after which the next one is below rounding, beside a pole too
_FARTHEST = 0.3  # relative step beyond which one has left its mode
_OF_CHORDS = (
    16.0,
    256.0,
)  # times the width that counts without chords need: a running error is a bound
_OF_MODES = (4.0, 32.0, 256.0)  # the same about the angles of the mode
_BESIDE = 1e-7  # relative half width that says whether a mode is the right one
_ROOTS = 6  # at most to be tried
_FEW_CHORDS = 16  # up to which all roots are tried; with more, a root that proves no mode is the last (measured)
_MOST_CHORDS = (
    45  # whose eigenvalues round by less than _WIDEST, _EIGENVALUE L^2 2^-53; more are not counted
)
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
    middle_modes = counted_modes(mean, *ends, middle_of(chord), count)
    if len(middle_modes.frequency) < count:
        raise ValueError(
            f"the trains have {len(middle_modes.frequency)} elastic modes, not {count}"
        )
    torn, rows = _torn(many, mean, ends)
    bounds, number = np.empty((3, count, trains)), 0
    for part in parts(tree.size * (1 + len(chord)), trains):
        some = many.chosen(part)
        proven = np.zeros(some.chord.shape[1], dtype=np.bool_)
        if torn.tree.parents.count(-1) == 1:
            bounds[:, :, part], proven = _modes(
                torn.chosen(part), rows, some, mean, middle_modes, middle_of(chord)
            )
        for column in (part.start + np.flatnonzero(~proven)).tolist():
            train = replace(tree, flexibility=flexibility[:, column], inertia=inertia[:, column])
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
    torn, rows = _torn(single, tree, (first, second))
    if torn.tree.parents.count(-1) != 1:
        return modes_found
    energy = (tree.moving_inertia[:, None] * modes_found.angle**2).sum(axis=1)
    passed = (
        np.abs(modes_found.torque * modes_found.angle[tree.parent]).sum(axis=0)
        / modes_found.frequency**2
    )
    bounds, proven = enclosed_each(
        torn.chosen(np.zeros(modes, dtype=np.int64)),
        modes_found.frequency,
        passed,
        np.arange(modes) + modes_found.rigid,
        int(rows[np.argmax(energy)]),
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


def _torn(many: Network, mean: Tree, ends: tuple[IntArray, IntArray]) -> tuple[Network, IntArray]:
    """The trains as trees of the stiffest spans, and the new number (stations,) of each given station."""
    tree = many.tree
    torn = stiffest_tree(mean, *ends, middle_of(many.chord))
    is_used = np.append(mean.parent >= 0, np.ones(len(many.chord), dtype=np.bool_))
    given, flexibility = np.concatenate([tree.flexibility, many.chord]), None
    flexibility = np.zeros((mean.size + len(torn.first), given.shape[1]))
    flexibility[torn.span[is_used]] = given[is_used]
    moved = np.empty_like(tree.inertia)
    moved[torn.station] = tree.inertia
    new = replace(torn.tree, flexibility=flexibility[: mean.size], inertia=moved)
    return Network(
        new, pairs(mean.size, torn.first, torn.second), flexibility[mean.size :]
    ), torn.station


def _way(trains: Network, root: int, square: float) -> Way:
    """Elimination near s = `square`: q follows the spans that are stiff beside the inertia at either end."""
    steps, sign = toward(trains.tree, root), trains.pair.copy()
    load, inertia, soft = np.zeros_like(sign), middle_of(trains.tree.moving_inertia), list[int]()
    for station, near, span in steps:
        sign[:, near] += sign[:, station]
        stiffest = max(inertia[station], inertia[near]) * square
        if len(sign) and middle_of(trains.tree.flexibility[[span]])[0] * stiffest > _SOFT:
            load[:, station] += sign[:, station]
            load[:, near] -= 0.0 if trains.tree.held[near] else sign[:, station]
            soft.append(station)
    twisted = sign.copy()
    twisted[:, soft] = 0.0
    return Way(
        steps, root, sign[..., None], twisted[..., None], load[..., None], np.zeros((len(sign), 1))
    )


def _polished(trains: Network, start: FloatArray, way: Way) -> FloatArray:
    """Frequency (trains,) rad/s after Newton's steps to where the dynamic stiffness that the root sees is zero."""
    square, left, some = start * start, np.arange(len(start)), trains
    for _ in range(_STEPS):
        squares = square[left]
        with np.errstate(all="ignore"):
            seen = Elimination(some, squares * (1.0 + 1j * _STEP), way)
            stiffness = seen.at_root[0] + _through_chords(seen)
            change = -stiffness.real / (stiffness.imag / _STEP)
        change[~(np.abs(change) <= _FARTHEST)] = 0.0
        square[left] = squares + squares * change
        going = np.abs(change) > _SETTLED
        if not going.any():
            break
        left, some = left[going], some.chosen(going)
    return np.sqrt(square)


def _through_chords(seen: Elimination) -> NDArray[Any]:
    """What the chords add (trains,) to the stiffness that the root sees."""
    loads = seen.at_root[1]
    if len(loads) < 2:
        return np.asarray((loads**2 / seen.matrix[:, 0]).sum(axis=0))
    matrix, load = seen.matrix.transpose(2, 0, 1), loads.T[:, :, None]
    lost = ~(np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(load).all(axis=(1, 2)))
    matrix = np.where(lost[:, None, None], np.eye(len(loads)), matrix)
    try:
        return np.asarray((load * np.linalg.solve(matrix, load)).sum(axis=(1, 2)))
    except np.linalg.LinAlgError:  # of some train exactly; then all are solved by themselves
        return np.full(len(lost), np.nan, dtype=np.complex128)


def _modes(
    torn: Network,
    rows: IntArray,
    given: Network,
    mean: Tree,
    middle_modes: TreeModes,
    chord: FloatArray,
) -> tuple[FloatArray, BoolArray]:
    """Frequencies and bounds (3, modes, trains) rad/s, and which trains are proven.

    torn: the trains that are eliminated, whose stations are `rows` of those given, `own`; known: modes of the `mean`.
    """
    start, passed, ways = [], [], []
    h, j = mean.flexibility, mean.moving_inertia
    for mode, w in enumerate(middle_modes.frequency.tolist()):
        angle, torque = middle_modes.angle[:, mode], middle_modes.torque[:, mode]
        loop_torque = middle_modes.loop_torque[:, mode]
        moved = (torque**2 * h) @ changes(given.tree.flexibility, h)
        moved += w * w * (angle**2 * j) @ changes(given.tree.moving_inertia, j)
        moved += (loop_torque**2 * chord) @ changes(given.chord, chord)
        start.append(w * np.exp(np.nan_to_num(-0.5 * moved / w**2)))
        ways.append(_way(torn, int(rows[np.argmax(j * angle**2)]), w * w))
        passed.append(np.abs(torque * angle[mean.parent]).sum() / w**2)
    return _proven(torn, np.stack(start), ways, np.array(passed), middle_modes.rigid)


def _bracketed(trains: Network, start: FloatArray, mode: int, way: Way) -> FloatArray:
    """Frequencies (trains,) rad/s near the mode (from 0, rigid ones counted), by halving with counts about `start`."""
    low, high = 0.5 * start, 2.0 * start
    for _ in range(_HALVINGS):
        middle = np.sqrt(low * high)
        is_above = network_count(trains, middle, 1.0, way) > mode
        low, high = np.where(is_above, low, middle), np.where(is_above, middle, high)
    return np.asarray(np.sqrt(low * high))


def _proven(
    trains: Network, start: FloatArray, ways: list[Way], passed: FloatArray, rigid: int
) -> tuple[FloatArray, BoolArray]:
    """Frequencies and bounds (3, modes, trains) rad/s by Newton from `start`, and which trains are proven."""
    frequency = np.stack(
        [_polished(trains, mode_start, way) for mode_start, way in zip(start, ways, strict=True)]
    )
    order = np.argsort(frequency, axis=0)
    frequency, passed = np.take_along_axis(frequency, order, axis=0), passed[order]
    bounds, proven = np.stack([frequency] * 3), np.zeros(frequency.shape, dtype=np.bool_)
    for k, (hertz, way) in enumerate(zip(frequency, ways, strict=True)):
        bounds[1:, k], proven[k] = _enclosed(trains, hertz, passed[k], k + rigid, way)
    mode, column = np.nonzero(~proven)
    if mode.size:
        some, near, way = trains.chosen(column), frequency[mode, column], ways[mode[0]]
        is_beside = _enclosed(some, near, passed[mode, column], mode + rigid, way, half=_BESIDE)[1]
        for k in np.unique(mode[~is_beside]).tolist():
            lost = (mode == k) & ~is_beside
            lost_trains = trains.chosen(column[lost])
            near[lost] = _polished(
                lost_trains,
                _bracketed(lost_trains, start[k, column[lost]], k + rigid, ways[k]),
                ways[k],
            )
        enclosed_modes = enclosed_each(some, near, passed[mode, column], mode + rigid, way.root)
        bounds[:, mode, column], proven[mode, column] = enclosed_modes
    return bounds, np.asarray(proven.all(axis=0))


def enclosed_each(
    trains: Network, frequency: FloatArray, passed: FloatArray, mode: IntArray, root: int
) -> tuple[FloatArray, BoolArray]:
    """Better frequencies and bounds (3, m) rad/s, each with its own train and `mode`, and which are proven.

    Roots are tried until all are: each has its own resonances of parts of the torn tree, beside which counts are less
    sure.
    """
    bounds, proven = np.stack([frequency] * 3), np.zeros(len(frequency), dtype=np.bool_)
    near = frequency.copy()
    for station in _roots(trains.tree, root):
        proven_before = proven.sum()
        for is_modal in (True, False):
            left = np.flatnonzero(~proven)
            if not left.size:
                return bounds, proven
            some = trains.chosen(left)
            way = _way(some, station, float(near[left].max()) ** 2)
            if is_modal:
                way, square = modal_way(some, near[left] ** 2, way)
                near[left] = np.sqrt(square)
            bounds[0, left] = near[left]
            bounds[1:, left], proven[left] = _enclosed(
                some, near[left], passed[left], mode[left], way
            )
        if len(trains.chord) > _FEW_CHORDS and proven.sum() == proven_before:
            break
    return bounds, proven


def _roots(tree: Tree, root: int) -> list[int]:
    """Some stations, as far from each other as can be, from `root`."""
    far, chosen = np.full(tree.size, np.inf), [root]
    while len(chosen) < min(_ROOTS, tree.size):
        away = {chosen[-1]: 0.0}
        for station, near, _ in reversed(toward(tree, chosen[-1])):
            away[station] = away[near] + 1.0
        far = np.minimum(far, [away.get(station, 0.0) for station in range(tree.size)])
        far[tree.held] = 0.0
        chosen.append(int(np.argmax(far)))
    return chosen


def _enclosed(
    trains: Network,
    frequency: FloatArray,
    passed: FloatArray,
    mode: int | IntArray,
    way: Way,
    half: float = 0.0,
) -> tuple[FloatArray, BoolArray]:
    """Bounds (2, trains) rad/s of the mode (from 0, rigid ones counted), and which of them are proven.

    half: relative half width, by default that in which success is expected, up to the widest.
    """
    widened: tuple[float, ...] = _OF_CHORDS if way.basis is None else _OF_MODES
    width = np.minimum(
        expected_width(trains.tree, frequency, passed * frequency**2), _WIDEST / widened[-1]
    )
    if half:
        width, widened = np.full(len(frequency), half), (1.0,)

    def counted(left: Selection, w: FloatArray, lean: float) -> IntArray:
        return network_count(trains.chosen(left), w, lean, way.chosen(left))

    return enclosed(counted, frequency, width, mode, widened)
