"""Natural frequencies of many trains with closed loops side by side: a tree with a column for each, and its chords.

With H the flexibilities of L chords, P their torque pairs and D the dynamic stiffness of the tree at s = w^2, the
pivots of [[D, P], [P', -H]] in both orders give the count of the train with loops: that of the tree, less the number
of negative eigenvalues of M = H + P' D^-1 P (Sylvester; Haynsworth 1968). With x and t the angles and torques under a
pair, an error eps in all figures moves an entry of M on its diagonal by at most eps E, E = H + sum h t^2 + s sum J x^2,
and M by L eps diag(E); at a mode that is 2 eps of s. Beside a resonance of the tree that its chords hardly feel, x and
t lose digits: E takes in the twists around the loop, times sum s J/|Z| of the stations.

Frequencies are found by inverse iteration with Rayleigh's quotient from the modes of the geometric middle.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.loops import LoopedTrain, around, graph_modes, pairs, stiffest_tree
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.reduction import cut, rigidity
from torsion.kernels.sensitivities import frequency_sensitivity
from torsion.kernels.sturm import count_below, expected_width
from torsion.kernels.tree import Tree
from torsion.kernels.two_sides import forced, two_sides
from torsion.kernels.variant_modes import VariantModes, changes, middle_of, parts, variant_modes

_UNIT_ROUNDOFF = 2.0**-53
_ROUNDINGS = 8.0  # of M, relative to E, and one more for each station; several times what many digits have shown
_BESIDE = 1.0 + 2.0**-16  # times a frequency, where its shape is found: at it, digits would be lost
_STEPS = 8  # of inverse iteration; 3 are usual
_SETTLED = 1e-9  # relative step after which the next one is below rounding: shapes gain four digits a step
_FARTHEST = 0.3  # relative step beyond which one has left its mode
_WIDENED = (1.0, 8.0, 256.0)  # times the width in which counts are expected to enclose it
_WIDEST = 1e-11  # relative half width; a frequency not proven in it may be wrong in digits that matter
_HALVINGS = 60  # of a bracket about a frequency that was found by itself
_AROUND = 1e-3  # relative, first half width of that bracket


@dataclass(frozen=True)
class _Trains:
    """Trains side by side, and the chords that close their loops."""

    tree: Tree
    sign: FloatArray  # (chords, stations) way of each chord's loop through the tree
    pair: FloatArray  # (chords, stations) torques of each
    chord: FloatArray  # (chords, trains) rad/(N m)

    def columns(self, chosen: IntArray | BoolArray) -> "_Trains":
        tree = self.tree
        some = replace(tree, flexibility=tree.flexibility[:, chosen], inertia=tree.inertia[:, chosen])
        return replace(self, tree=some, chord=self.chord[:, chosen])


@dataclass(frozen=True)
class _Torn:
    """The open trains at a frequency each, under a pair of unit torques in place of each chord."""

    respond: Callable[[FloatArray], tuple[FloatArray, FloatArray]]  # of the open trains
    angle: FloatArray  # (chords, stations, trains) rad/(N m)
    torque: FloatArray  # (chords, stations, trains)
    matrix: FloatArray  # (trains, chords, chords) rad/(N m), M
    resonance: FloatArray  # (trains,) about s over the distance to the nearest resonance of the open train
    twist: Callable[[FloatArray], FloatArray]  # around each loop (trains, chords) of torques (stations, trains)


def looped_variant_modes(
    tree: Tree,
    flexibility: FloatArray,
    inertia: FloatArray,
    ends: tuple[IntArray, IntArray],
    chord: FloatArray,
    count: int,
) -> VariantModes:
    """As `variant_modes`, of trains with chords between the stations `ends`, of `chord` (chords, trains) rad/(N m).

    Every mode is proven by counts, up to the stated rounding of M, which is found by comparison with many digits.
    Raises ValueError as `variant_modes`, and for a chord without flexibility; SolveError for a mode not enclosed.

    >>> ring, one = Tree(np.array([-1, 0, 1]), *np.zeros((2, 3)), np.zeros(3, dtype=bool)), np.ones((3, 2))
    >>> found = looped_variant_modes(ring, one / [1.0, 4.0], one, (np.array([0]), np.array([2])), one[:1], 2)
    >>> (found.frequency**2).round(12)  # 3 k of equal springs; with springs of 1, 4 and 4: 6 and 12
    array([[ 3.,  6.],
           [ 3., 12.]])
    """
    if not np.all(chord > 0.0):
        raise ValueError("a chord needs a positive flexibility; put rigid spans into the tree")
    mean = replace(tree, flexibility=middle_of(flexibility), inertia=middle_of(inertia))
    torn = stiffest_tree(mean, *ends, middle_of(chord))
    h, chord, j = _renumbered(tree, torn, np.concatenate([flexibility, chord]), inertia)
    if not len(torn.first):  # the loops go only through fixed stations
        return variant_modes(torn.tree, h, j, count)
    torn = replace(torn, tree=cut(torn.tree, rigidity(torn.tree)))
    modes = graph_modes(torn.tree, torn.first, torn.second, torn.flexibility, count)
    if len(modes.frequency) < count:
        raise ValueError(f"the trains have {len(modes.frequency)} elastic modes, not {count}")
    start = _starts(torn, modes, h, chord, j)
    bounds, alone = np.empty((3, count, chord.shape[1])), 0
    sign, pair = around(torn.tree, torn.first, torn.second), pairs(tree.size, torn.first, torn.second)
    pair = np.where(torn.tree.held, 0.0, pair)
    for part in parts(tree.size, chord.shape[1]):
        trains = _Trains(replace(torn.tree, flexibility=h[:, part], inertia=j[:, part]), sign, pair, chord[:, part])
        bounds[:, :, part], proven = _modes(trains, start[:, part], modes)
        left = np.flatnonzero(~proven)
        if left.size:
            bounds[:, :, part.start + left] = _by_themselves(trains.columns(left), torn, count, modes.rigid)
            alone += left.size * count
    frequency, lower, upper = bounds
    return VariantModes(frequency, lower, upper, alone)


def _renumbered(
    tree: Tree, torn: LoopedTrain, given: FloatArray, inertia: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Flexibility of the spans and of the chords of a torn train, and its inertia, from those `given`."""
    own = np.append(tree.parent >= 0, np.ones(len(given) - tree.size, dtype=np.bool_))
    flexibility, moved = np.zeros_like(given), np.empty_like(inertia)
    flexibility[torn.span[own]], moved[torn.station] = given[own], inertia
    return flexibility[: tree.size], flexibility[tree.size : tree.size + len(torn.first)], moved


def _starts(torn: LoopedTrain, modes: TreeModes, h: FloatArray, chord: FloatArray, j: FloatArray) -> FloatArray:
    """Frequencies (modes, trains) rad/s as the shares of energy say of those of the middle."""
    tree, by = torn.tree, frequency_sensitivity(torn.tree, modes, torn.flexibility)
    moved = by.inertia.T @ changes(j, tree.moving_inertia) - by.stiffness.T @ changes(h, tree.flexibility)
    moved -= by.chord.T @ changes(chord, torn.flexibility)
    return np.asarray(modes.frequency[:, None] * np.exp(moved))


def _torn(trains: _Trains, w: FloatArray) -> _Torn:
    """At `w` (trains,) rad/s."""
    tree = trains.tree
    sides = two_sides(tree, w)

    def respond(load: FloatArray) -> tuple[FloatArray, FloatArray]:
        return forced(tree, sides, load)

    def twist(torque: FloatArray) -> FloatArray:
        return np.asarray((trains.sign @ (tree.flexibility * torque)).T)

    units = [respond(np.repeat(row[:, None], len(w), axis=1)) for row in trains.pair]
    matrix = np.stack([-twist(torque) for _, torque in units], axis=2)
    chord = np.arange(len(units))
    matrix[:, chord, chord] += trains.chord.T
    angle, torque = (np.stack(own) for own in zip(*units, strict=True))
    resonance = (tree.moving_inertia * w**2 / np.abs(sides.total)).sum(axis=0)
    return _Torn(respond, angle, torque, matrix, resonance, twist)


def _terms(trains: _Trains, torn: _Torn, square: FloatArray) -> FloatArray:
    """What roundings of M are relative to (chords, trains) rad/(N m): E, and all twists near a resonance."""
    tree, way = trains.tree, np.abs(trains.sign)
    loop = trains.chord + way @ tree.flexibility_columns
    loop += np.einsum("ci,cit->ct", way, np.abs(tree.flexibility * torn.torque))
    energy = (tree.flexibility * torn.torque**2).sum(axis=1)
    energy += square * (tree.moving_inertia * torn.angle**2).sum(axis=1)
    return np.asarray(trains.chord + energy + loop * torn.resonance)


def _count(trains: _Trains, w: FloatArray, bound: int) -> IntArray:
    """Frequencies below `w` (trains,) rad/s, rigid motions included: never less (+1) or never more (-1) than exact."""
    tree, number = trains.tree, len(trains.pair)
    with np.errstate(all="ignore"):
        torn = _torn(trains, w)
        room = number * (_ROUNDINGS + tree.size) * _UNIT_ROUNDOFF * _terms(trains, torn, w**2)
        matrix, chord = 0.5 * (torn.matrix + torn.matrix.transpose(0, 2, 1)), np.arange(number)
        matrix[:, chord, chord] += bound * room.T
        lost = ~np.isfinite(matrix).all(axis=(1, 2))
    matrix[lost] = bound * np.eye(number)
    negative = (np.linalg.eigvalsh(matrix) < 0.0).sum(axis=1) if number > 1 else matrix[:, 0, 0] < 0.0
    return np.asarray(count_below(tree, w, bound=bound) - negative)


def _modes(trains: _Trains, start: FloatArray, known: TreeModes) -> tuple[FloatArray, BoolArray]:
    """Frequencies and bounds (3, modes, trains) rad/s from `start` (modes, trains), and which trains are proven."""
    settled = [_settled(trains, one, known.angle[:, [mode]]) for mode, one in enumerate(start)]
    frequency, passed = (np.stack(own) for own in zip(*settled, strict=True))
    order = np.argsort(frequency, axis=0)
    frequency, passed = (np.take_along_axis(own, order, axis=0) for own in (frequency, passed))
    bounds, proven = np.stack([frequency] * 3), np.ones(start.shape[1], dtype=np.bool_)
    for mode, one in enumerate(frequency):
        bounds[1:, mode], is_proven = _enclosed(trains, one, passed[mode], mode + known.rigid)
        proven &= is_proven
    return bounds, proven


def _settled(trains: _Trains, start: FloatArray, shape: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frequency (trains,) rad/s by inverse iteration from a shape, and its sum of |torque| |angle at the parent|."""
    frequency, passed, left, some = start.copy(), np.zeros(len(start)), np.arange(len(start)), trains
    angle = np.repeat(shape, len(start), axis=1)
    for _ in range(_STEPS):
        here, inertia, parent = frequency[left] * _BESIDE, some.tree.moving_inertia, some.tree.parent
        with np.errstate(all="ignore"):
            torn, load = _torn(some, here), inertia * angle
            found, torque = torn.respond(load)
            chord = _solved(torn.matrix, torn.twist(torque))
            found = found + np.einsum("ct,cst->st", chord, torn.angle)
            torque = torque + np.einsum("ct,cst->st", chord, torn.torque)
            mass = (inertia * found**2).sum(axis=0)
            share = (load * found).sum(axis=0) / mass / here**2
            change = share / (1.0 + np.sqrt(1.0 + share))
            change[~(np.abs(change) <= _FARTHEST)] = 0.0
            turned = found / np.sqrt(mass)
            passed[left] = (np.abs(torque) * np.abs(found[parent])).sum(axis=0) / mass
        moved = here * (1.0 + change)
        going = np.asarray(np.abs(moved - frequency[left]) > _SETTLED * moved)
        frequency[left] = moved
        if not going.any():
            break
        left, some = left[going], some.columns(going)
        angle = turned[:, going]
    return frequency, np.where(np.isfinite(passed), passed, 0.0)


def _solved(matrix: FloatArray, twist: FloatArray) -> FloatArray:
    """Torques (chords, trains) of the chords from the twists (trains, chords) around the open loops."""
    if twist.shape[1] == 1:
        return np.asarray(twist.T / matrix[:, 0].T)
    usable = np.asarray(np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(twist).all(axis=1))
    safe = np.where(usable[:, None, None], matrix, np.eye(twist.shape[1]))
    safe[np.linalg.slogdet(safe)[0] == 0.0] = np.eye(twist.shape[1])
    return np.asarray(np.linalg.solve(safe, twist[:, :, None])[:, :, 0].T)


def _enclosed(trains: _Trains, frequency: FloatArray, passed: FloatArray, mode: int) -> tuple[FloatArray, BoolArray]:
    """Bounds (2, trains) rad/s of the mode (from 0, rigid ones counted), and which of them are proven."""
    bounds, left, some = np.stack([frequency] * 2), np.arange(len(frequency)), trains
    half = expected_width(trains.tree, frequency, passed)
    half = half + 1.25 * len(trains.pair) * (_ROUNDINGS + trains.tree.size) * _UNIT_ROUNDOFF
    for times in _WIDENED:
        bounds[0, left], bounds[1, left] = (frequency[left] * (1.0 + sign * times * half[left]) for sign in (-1, 1))
        proven = (_count(some, bounds[0, left], 1) <= mode) & (_count(some, bounds[1, left], -1) > mode)
        proven &= times * half[left] <= _WIDEST
        left = left[~proven]
        if not left.size:
            break
        some = some.columns(~proven)
    is_proven = np.ones(len(frequency), dtype=np.bool_)
    is_proven[left] = False
    return bounds, is_proven


def _by_themselves(trains: _Trains, torn: LoopedTrain, count: int, rigid: int) -> FloatArray:
    """Frequencies and bounds (3, modes, trains) rad/s of trains solved one by one, enclosed by halving with counts."""
    bounds = np.empty((3, count, trains.chord.shape[1]))
    for k, chord in enumerate(trains.chord.T):
        own = replace(torn.tree, flexibility=trains.tree.flexibility[:, k], inertia=trains.tree.inertia[:, k])
        bounds[0, :, k] = graph_modes(own, torn.first, torn.second, chord, count).frequency
    for mode, frequency in enumerate(bounds[0]):
        for row, bound in ((1, 1), (2, -1)):
            bounds[row, mode] = _edge(trains, frequency, mode + rigid, bound)
    return bounds


def _edge(trains: _Trains, frequency: FloatArray, mode: int, bound: int) -> FloatArray:
    """The nearest (trains,) rad/s to each frequency that counts prove to lie below (+1) or above (-1) the mode."""

    def is_beyond(w: FloatArray) -> BoolArray:
        count = _count(trains, w, bound)
        return np.asarray(count <= mode if bound > 0 else count > mode)

    near, far = np.zeros(len(frequency)), np.full(len(frequency), _AROUND)
    while not (found := is_beyond(frequency * (1.0 - bound * far))).all():
        if (far >= 1.0).any():
            raise SolveError("natural frequencies of a train with loops could not be enclosed; request fewer modes")
        far = np.where(found, far, 2.0 * far)
    for _ in range(_HALVINGS):
        half = np.where(near > 0.0, np.sqrt(near * far), far * 2.0**-10)
        found = is_beyond(frequency * (1.0 - bound * half))
        near, far = np.where(found, near, half), np.where(found, half, far)
        if (far <= 1.5 * np.maximum(near, _UNIT_ROUNDOFF)).all():
            break
    return np.asarray(frequency * (1.0 - bound * far))
