"""Natural frequencies of many trains with closed loops or distributed shafts, side by side and proven by counts.

With H the flexibilities of L chords, P their torque pairs and D the dynamic stiffness of the tree at s = w^2, the
pivots of [[D, P], [P', -H]] in both orders give the count of the train: that of the tree, less the number of negative
eigenvalues of M = H + P' D^-1 P (Sylvester; Haynsworth 1968). For any angles q it is H + 2 P'q - q'D q + g'D^-1 g with
g = P - D q: with the static twists of stiff spans in q, and 0 in soft ones, nothing large cancels. One elimination from
the leaves to a root, the station with the most kinetic energy, gives D's pivots and g'D^-1 g.

Roundings of pivots are those of a train with other inertias and flexibilities, outweighed as in `sturm`, so that tree
and M are those of one train; those of M in it are carried along as a running error, by which M is leaned. The same
elimination at s (1 + i 1e-100) has the slope for Newton's steps. A train that is not proven is solved by itself.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.distributed.span_laws import Columns, Shafts
from torsion.kernels.loops import graph_modes, pairs, stiffest_tree
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sturm import SHARE_OF_LIMIT, count_below, expected_width, margins
from torsion.kernels.tree import Tree
from torsion.kernels.variant_modes import VariantModes, changes, middle_of, parts, toward

_UNIT_ROUNDOFF = 2.0**-53
_STEP = 1e-100  # relative, imaginary: beside it nothing changes but imaginary parts (Squire and Trapp 1998)
_STEPS = 12  # of Newton; 3 are usual, 9 beside a pole of the stiffness that the root sees
_HALVINGS = 14  # of a bracket of two octaves
_SETTLED = 1e-10  # relative step after which the next one is below rounding, beside a pole too
_FARTHEST = 0.3  # relative step beyond which one has left its mode
_WIDENED = (1.0, 4.0, 16.0)  # times the width in which counts are expected to enclose a frequency
_OF_CHORDS = 64.0  # times that width with chords: their running error is a bound, not an estimate
_WIDEST = 2.0**-39  # relative half width, 1.8e-12; one not proven in it is solved by itself
_ROUNDINGS = 10.0  # of a term of M or a load, besides those of sums: r, its products, h r, the torque passed on
_SOFT = 0.05  # of s h J, above which a span is soft
_EIGENVALUE = 8.0  # roundings of the eigenvalues of a matrix whose entries are below 1, times its size squared


@dataclass(frozen=True)
class Network:
    """Trains of one layout side by side: a tree with a column for each, and its chords."""

    tree: Tree  # flexibility and inertia (stations, trains); its laws are `Columns`
    pair: FloatArray  # (chords, stations) torques of each chord
    chord: FloatArray  # (chords, trains) rad/(N m)

    def chosen(self, trains: IntArray | BoolArray | slice) -> "Network":
        """Some of the trains."""
        tree, shafts = self.tree, self.tree.shafts
        if shafts is not None:
            place = np.arange(tree.flexibility.shape[1])[trains]
            laws = tuple(law.chosen(place) for law in shafts.laws if isinstance(law, Columns))
            shafts = replace(shafts, laws=laws)
        some = replace(tree, flexibility=tree.flexibility[:, trains], inertia=tree.inertia[:, trains], shafts=shafts)
        return replace(self, tree=some, chord=self.chord[:, trains])


@dataclass(frozen=True)
class _Way:
    """How to eliminate toward a root."""

    steps: list[tuple[int, int, int]]  # station, the one toward the root, the span between; the leaves first
    root: int
    twisted: FloatArray  # (chords, stations) torque of each pair through the span toward the root, where it twists q
    load: FloatArray  # (chords, stations) of the spans that q leaves untwisted


@dataclass(frozen=True)
class _Seen:
    """What is left at the root after elimination."""

    stiffness: NDArray[Any]  # (trains,) N m/rad of the open train
    load: NDArray[Any]  # (chords, trains) of the pairs
    matrix: NDArray[Any]  # (chords, chords, trains) rad/(N m), M without what the root adds
    negative: IntArray  # (trains,) pivots of all stations but the root
    size: FloatArray  # like `matrix`: sum of its terms without signs
    error: FloatArray  # like `matrix`: of roundings
    load_error: FloatArray  # like `load`


def network_modes(
    tree: Tree, flexibility: FloatArray, inertia: FloatArray, count: int,
    ends: tuple[IntArray, IntArray] = (np.empty(0, int), np.empty(0, int)), chord: FloatArray | None = None,
    factors: FloatArray | None = None,
) -> VariantModes:  # fmt: skip
    """As `variant_modes`, of trains with chords between the stations `ends`, of `chord` (chords, trains) rad/(N m).

    factors: (figures, trains) of the figures of the laws of `tree.shafts`, over what they are there. Columns that are
    not proven are those of the train by itself, with its bounds. Raises ValueError and SolveError as `variant_modes`.

    >>> ring, one = Tree(np.array([-1, 0, 1]), *np.zeros((2, 3)), np.zeros(3, dtype=bool)), np.ones((3, 2))
    >>> found = network_modes(ring, one / [1.0, 4.0], one, 2, (np.array([0]), np.array([2])), one[:1])
    >>> (found.frequency**2).round(12)  # 3 k of equal springs; with springs of 1, 4 and 4: 6 and 12
    array([[ 3.,  6.],
           [ 3., 12.]])
    """
    trains = flexibility.shape[1]
    chord = np.empty((0, trains)) if chord is None else chord
    if not np.all(chord > 0.0):
        raise ValueError("a chord needs a positive flexibility; put rigid spans into the tree")
    laws = _laws(tree, factors, trains)
    many = Network(replace(tree, flexibility=flexibility, inertia=inertia, shafts=laws), pairs(tree.size, *ends), chord)

    def alone(h: FloatArray, j: FloatArray, c: FloatArray, shafts: Shafts | None) -> TreeModes:
        own = replace(tree, flexibility=h, inertia=j, shafts=shafts)
        return graph_modes(own, *ends, c, count) if len(c) else tree_modes(own, count)

    middle = None if tree.shafts is None or factors is None else _shafts_of(tree.shafts, middle_of(factors))
    known = alone(middle_of(flexibility), middle_of(inertia), middle_of(chord), middle)
    if len(known.frequency) < count:
        raise ValueError(f"the trains have {len(known.frequency)} elastic modes, not {count}")
    mean = replace(tree, flexibility=middle_of(flexibility), inertia=middle_of(inertia), shafts=middle)
    torn, rows = _torn(many, mean, ends)
    bounds, number = np.empty((3, count, trains)), 0
    for part in parts(tree.size * (1 + len(chord)), trains):
        own = many.chosen(part)
        proven = np.zeros(own.chord.shape[1] if len(chord) else own.tree.flexibility.shape[1], dtype=np.bool_)
        if torn.tree.parents.count(-1) == 1:
            bounds[:, :, part], proven = _modes(torn.chosen(part), rows, own, mean, known, middle_of(chord))
        for column in (part.start + np.flatnonzero(~proven)).tolist():
            one = None if tree.shafts is None or factors is None else _shafts_of(tree.shafts, factors[:, column])
            found = alone(flexibility[:, column], inertia[:, column], chord[:, column], one)
            bounds[:, :, column] = found.frequency, found.lower, found.upper
            number += count
    frequency, lower, upper = bounds
    return VariantModes(frequency, lower, upper, number)


def counted_modes(found: TreeModes, tree: Tree, ends: tuple[IntArray, IntArray], chord: FloatArray) -> TreeModes:
    """Modes of one train with chords, with bounds that counts prove: each frequency is in its own, and none is missing.

    They stay as they are, with the bounds of their method, where counts do not enclose every one of them.
    """
    modes = len(found.frequency)
    own, one = replace(tree, flexibility=tree.flexibility[:, None], inertia=tree.inertia[:, None]), chord[:, None]
    torn, rows = _torn(Network(own, pairs(tree.size, *ends), one), tree, ends)
    if not modes or torn.tree.parents.count(-1) != 1:
        return found
    most = rows[np.argmax(tree.moving_inertia[:, None] * found.angle**2, axis=0)]  # what moves most of each mode
    passed = np.abs(found.torque * found.angle[tree.parent]).sum(axis=0) / found.frequency**2
    bounds, left = np.stack([found.frequency] * 2), np.arange(modes)
    for roots in (most[:1].repeat(modes), most):  # the first root is right for most of them
        for root in np.unique(roots[left]).tolist():
            some = left[roots[left] == root]
            columns = torn.chosen(np.zeros(len(some), dtype=np.int64))
            way = _way(columns, root, float(found.frequency[some[len(some) // 2]]) ** 2)
            w = found.frequency[some]
            bounds[:, some], proven = _enclosed(columns, w, passed[some] * w**2, some + found.rigid, way)
            left = np.setdiff1d(left, some[proven])
    if left.size:
        return found
    return replace(found, lower=bounds[0], upper=bounds[1], certified=True)


def _laws(tree: Tree, factors: FloatArray | None, trains: int) -> Shafts | None:
    """The shafts of all trains."""
    if tree.shafts is None:
        return None
    sizes = [law.figures.size for law in tree.shafts.laws]
    if factors is None or factors.shape != (sum(sizes), trains):
        raise ValueError(f"the laws of the shafts have {sum(sizes)} figures; expected factors of each for every train")
    own = np.split(factors, np.cumsum(sizes)[:-1])
    return replace(tree.shafts, laws=tuple(Columns.of(*one) for one in zip(tree.shafts.laws, own, strict=True)))


def _shafts_of(shafts: Shafts, factors: FloatArray) -> Shafts:
    """The shafts of one train, with `factors` (figures,)."""
    sizes = [law.figures.size for law in shafts.laws]
    own = np.split(factors[:, None], np.cumsum(sizes)[:-1])
    return replace(shafts, laws=tuple(Columns.of(*one).rows for one in zip(shafts.laws, own, strict=True)))


def _torn(many: Network, mean: Tree, ends: tuple[IntArray, IntArray]) -> tuple[Network, IntArray]:
    """The trains as trees of the stiffest spans, and the new number (stations,) of each given station."""
    if not len(many.chord):
        return many, np.arange(mean.size)
    tree = many.tree
    torn = stiffest_tree(mean, *ends, middle_of(many.chord))
    own = np.append(mean.parent >= 0, np.ones(len(many.chord), dtype=np.bool_))
    given, flexibility = np.concatenate([tree.flexibility, many.chord]), None
    flexibility = np.zeros((mean.size + len(torn.first), given.shape[1]))
    flexibility[torn.span[own]] = given[own]
    moved = np.empty_like(tree.inertia)
    moved[torn.station] = tree.inertia
    new = replace(torn.tree, flexibility=flexibility[: mean.size], inertia=moved)
    return Network(new, pairs(mean.size, torn.first, torn.second), flexibility[mean.size :]), torn.station


def _way(trains: Network, root: int, square: float) -> _Way:
    """Elimination near s = `square`: q follows the spans that are stiff beside the inertia at either end."""
    steps, sign = toward(trains.tree, root), trains.pair.copy()
    load, inertia, soft = np.zeros_like(sign), middle_of(trains.tree.moving_inertia), list[int]()
    for station, near, span in steps:
        sign[:, near] += sign[:, station]
        beside = max(inertia[station], inertia[near]) * square
        if len(sign) and middle_of(trains.tree.flexibility[[span]])[0] * beside > _SOFT:
            load[:, station] += sign[:, station]
            load[:, near] -= 0.0 if trains.tree.held[near] else sign[:, station]
            soft.append(station)
    twisted = sign.copy()
    twisted[:, soft] = 0.0
    return _Way(steps, root, twisted, load)


def _eliminated(trains: Network, square: NDArray[Any], way: _Way, lean: float = 0.0) -> _Seen:
    """All but the root at s = `square` (trains,); with `lean` +1 or -1 every rounding is outweighed, as in `sturm`."""
    tree, number, of_stiffness, of_laws = trains.tree, len(trains.chord), 0.0, square
    unit = (np.count_nonzero(way.twisted, axis=1).max(initial=0) + tree.most_children + _ROUNDINGS) * _UNIT_ROUNDOFF
    if lean:
        of_square, of_argument, of_stiffness = margins(tree, square)
        of_square, of_stiffness = of_square + 2.0 * _UNIT_ROUNDOFF, of_stiffness + 2.0 * _UNIT_ROUNDOFF  # other root
        of_laws, square = square * (1.0 + lean * of_argument), square * (1.0 + lean * of_square)
    a, h = tree.moving_inertia * square, tree.flexibility.astype(square.dtype)
    if tree.shafts is not None:
        h[tree.shafts.node], inner, outer = tree.shafts.at(of_laws)
        tree.add_ends(a, inner * square, outer * square)
    q, matrix = np.zeros((number, *a.shape), a.dtype), np.zeros((number, number, len(square)), a.dtype)
    matrix[np.arange(number), np.arange(number)] = trains.chord
    for station, near, span in reversed(way.steps if number else []):
        q[:, station] = way.twisted[:, station, None] * h[span] + (0.0 if tree.held[near] else q[:, near])
        matrix += (way.twisted[:, None, station] * way.twisted[None, :, station])[..., None] * h[span]
    size, z, own = np.abs(matrix), np.where(tree.held[:, None], np.inf, -a), a * q
    if number:
        matrix = matrix + np.einsum("kit,lit->klt", own, q)
        size = size + np.einsum("kit,lit->klt", np.abs(own), np.abs(q))
    f, e = own + way.load[:, :, None], unit * np.abs(own)
    error, negative = unit * size, np.zeros(len(square), dtype=np.int64)
    for i, near, span in way.steps:
        if tree.held[i]:
            through, passed, term = 1.0 / h[span], -q[:, i] / h[span], -_product(q[:, i], q[:, i] / h[span])
            if number:
                term = term - _product(q[:, i], f[:, i]) - _product(f[:, i], q[:, i])
            rest, own, share = 0.0, np.abs(q[:, i]), np.abs(1.0 / h[span])
            e[:, near] += unit * own * share
            error += unit * (_product(own, own) * share + 2.0 * _product(own, np.abs(f[:, i])))
        else:
            rest = 1.0 / (1.0 + h[span] * z[i])
            through, passed, weight = z[i] * rest, rest * f[:, i], h[span] * rest
            negative += rest.real < 0.0
            term = weight * _product(f[:, i], f[:, i])
            if lean:
                less = lean * of_stiffness * np.abs(through)
                through = through - less
                if number and not tree.held[near]:  # what is passed on less is as inertia of the next station
                    f[:, near] += less * q[:, near]
                    matrix = matrix + less * _product(q[:, near], q[:, near])
            if number and lean:
                own, room, share = np.abs(f[:, i]), e[:, i], np.abs(rest)
                error += np.abs(weight) * (_product(own + room, own + room) * (1.0 + unit) - _product(own, own))
                beside, torque = np.abs(q[:, near]), unit * np.abs(through)
                error += torque * _product(beside, beside)
                e[:, near] += share * (room + unit * own) + torque * beside
        z[near] += through
        if number:
            matrix, size = matrix + term, size + np.abs(term)
            f[:, near] += 0.0 if tree.held[near] else passed  # every span has a copy of a fixed station of its own
    return _Seen(
        z[way.root],
        f[:, way.root],
        matrix,
        negative,
        size,
        error + 3.0 * tree.size * _UNIT_ROUNDOFF * size,
        e[:, way.root],
    )


def _product(one: NDArray[Any], other: NDArray[Any]) -> NDArray[Any]:
    """(chords, chords, trains) of two (chords, trains)."""
    return np.asarray(one[:, None] * other[None, :])


def _count(trains: Network, w: FloatArray, lean: float, way: _Way) -> IntArray:
    """Frequencies below `w` (trains,) rad/s, rigid motions included: never less (+1) or never more (-1) than exact."""
    number = len(trains.chord)
    if not number:
        return count_below(trains.tree, w, bound=lean)
    with np.errstate(all="ignore"):
        seen = _eliminated(trains, w * w, way, lean)
        own, room, root = np.abs(seen.load), seen.load_error, np.abs(1.0 / seen.stiffness)
        last = _product(seen.load, seen.load) / seen.stiffness
        error = seen.error + root * (
            _product(own + room, own + room) - (1.0 - 4.0 * _UNIT_ROUNDOFF) * _product(own, own)
        )
        chord = np.arange(number)
        scale = np.sqrt((seen.size + np.abs(last))[chord, chord])
        matrix, error = ((one / _product(scale, scale)).transpose(2, 0, 1) for one in (seen.matrix + last, error))
        matrix[:, chord, chord] += lean * (error.sum(axis=2) + _EIGENVALUE * number**2 * _UNIT_ROUNDOFF)
    lost = ~np.isfinite(matrix).all(axis=(1, 2))
    matrix[lost] = lean * np.eye(number)
    below = (np.linalg.eigvalsh(matrix) < 0.0).sum(axis=1)
    found = seen.negative + (seen.stiffness < 0.0) - below
    return np.asarray(np.where(lost, trains.tree.size if lean > 0 else -1, found))


def _polished(trains: Network, start: FloatArray, way: _Way) -> FloatArray:
    """Frequency (trains,) rad/s after Newton's steps to where the dynamic stiffness that the root sees is zero."""
    square, left, some = start * start, np.arange(len(start)), trains
    for _ in range(_STEPS):
        here = square[left]
        with np.errstate(all="ignore"):
            seen = _eliminated(some, here * (1.0 + 1j * _STEP), way)
            stiffness = seen.stiffness + _through_chords(seen)
            change = -stiffness.real / (stiffness.imag / _STEP)
        change[~(np.abs(change) <= _FARTHEST)] = 0.0
        square[left] = here + here * change
        going = np.abs(change) > _SETTLED
        if not going.any():
            break
        left, some = left[going], some.chosen(going)
    return np.sqrt(square)


def _through_chords(seen: _Seen) -> NDArray[Any]:
    """What the chords add (trains,) to the stiffness that the root sees."""
    if len(seen.load) < 2:
        return np.asarray((seen.load**2 / seen.matrix[:, 0]).sum(axis=0) if len(seen.load) else 0.0)
    matrix, load = seen.matrix.transpose(2, 0, 1), seen.load.T[:, :, None]
    lost = ~(np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(load).all(axis=(1, 2)))
    matrix = np.where(lost[:, None, None], np.eye(len(seen.load)), matrix)
    try:
        return np.asarray((load * np.linalg.solve(matrix, load)).sum(axis=(1, 2)))
    except np.linalg.LinAlgError:  # of some train exactly; then all are solved by themselves
        return np.full(len(lost), np.nan, dtype=np.complex128)


def _modes(
    torn: Network, rows: IntArray, own: Network, mean: Tree, known: TreeModes, chord: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Frequencies and bounds (3, modes, trains) rad/s, and which trains are proven.

    torn: the trains that are eliminated, whose stations are `rows` of those given, `own`; known: modes of the `mean`.
    """
    start, passed, ways = [], [], []
    for mode, w in enumerate(known.frequency.tolist()):
        h, j = (one[:, 0] for one in replace(mean, inertia=mean.moving_inertia).at(np.array([w * w])))
        angle, torque = known.angle[:, mode], known.torque[:, mode].copy()
        if mean.shafts is not None:
            node = mean.shafts.node
            torque[node] = (angle[mean.parent[node]] - angle[node]) / h[node]
        all_h, all_j = _at(own.tree, w * w)
        moved = (torque**2 * h) @ changes(all_h, h) + w * w * (angle**2 * j) @ changes(all_j, j)
        if len(chord):
            moved = moved + (known.loop_torque[:, mode] ** 2 * chord) @ changes(own.chord, chord)
        start.append(w * np.exp(np.nan_to_num(-0.5 * moved / w**2)))
        ways.append(_way(torn, int(rows[np.argmax(j * angle**2)]), w * w))
        passed.append(np.abs(torque * angle[mean.parent]).sum() / w**2)
    bounds, proven = _proven(torn, np.stack(start), ways, np.array(passed), known.rigid)
    left = np.flatnonzero(~proven)
    if left.size:
        some = torn.chosen(left)
        near = np.stack([_bracketed(some, start[k][left], k + known.rigid, way) for k, way in enumerate(ways)])
        bounds[:, :, left], proven[left] = _proven(some, near, ways, np.array(passed), known.rigid)
    return bounds, proven


def _at(tree: Tree, square: float) -> tuple[FloatArray, FloatArray]:
    """Flexibility and inertia (stations, trains) at one s for all, a shaft a flexibility between two inertias."""
    h, j = tree.flexibility.copy(), tree.moving_inertia.copy()
    if tree.shafts is not None:
        h[tree.shafts.node], inner, outer = tree.shafts.at(np.full(h.shape[1], square))
        tree.add_ends(j, inner, outer)
    return h, j


def _bracketed(trains: Network, start: FloatArray, mode: int, way: _Way) -> FloatArray:
    """Frequencies (trains,) rad/s near the mode (from 0, rigid ones counted), by halving with counts about `start`."""
    low, high = 0.5 * start, 2.0 * start
    for _ in range(_HALVINGS):
        middle = np.sqrt(low * high)
        is_above = _count(trains, middle, 1.0, way) > mode
        low, high = np.where(is_above, low, middle), np.where(is_above, middle, high)
    return np.asarray(np.sqrt(low * high))


def _proven(
    trains: Network, start: FloatArray, ways: list[_Way], passed: FloatArray, rigid: int
) -> tuple[FloatArray, BoolArray]:
    """Frequencies and bounds (3, modes, trains) rad/s by Newton from `start`, and which trains are proven."""
    frequency = np.stack([_polished(trains, one, way) for one, way in zip(start, ways, strict=True)])
    order = np.argsort(frequency, axis=0)
    frequency, many = np.take_along_axis(frequency, order, axis=0), passed[order]
    bounds, proven = np.stack([frequency] * 3), np.isfinite(frequency).all(axis=0)
    for mode, (one, way) in enumerate(zip(frequency, ways, strict=True)):
        bounds[1:, mode], is_proven = _enclosed(trains, one, many[mode] * one**2, mode + rigid, way)
        proven &= is_proven
    return bounds, np.asarray(proven)


def _enclosed(
    trains: Network, frequency: FloatArray, passed: FloatArray, mode: int | IntArray, way: _Way
) -> tuple[FloatArray, BoolArray]:
    """Bounds (2, trains) rad/s of the mode (of each; from 0, rigid ones counted), and which of them are proven."""
    shafts, mode = trains.tree.shafts, np.broadcast_to(mode, frequency.shape)
    bounds, left, some = np.stack([frequency] * 2), np.arange(len(frequency)), trains
    half = expected_width(trains.tree, frequency, passed)
    half = np.minimum(half * (_OF_CHORDS if len(trains.chord) else 1.0), _WIDEST / _WIDENED[-1])
    top = np.inf if shafts is None else SHARE_OF_LIMIT * shafts.limit
    for times in _WIDENED:
        bounds[0, left], bounds[1, left] = (frequency[left] * (1.0 + sign * times * half[left]) for sign in (-1, 1))
        proven = (_count(some, bounds[0, left], 1, way) <= mode[left]) & (bounds[1, left] <= top)
        proven &= _count(some, bounds[1, left], -1, way) > mode[left]
        left = left[~proven]
        if not left.size:
            break
        some = some.chosen(~proven)
    is_proven = np.ones(len(frequency), dtype=np.bool_)
    is_proven[left] = False
    return bounds, is_proven
