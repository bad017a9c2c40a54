"""Counts of the natural frequencies of trains with closed loops, many side by side.

With H the flexibilities of L chords, P their torque pairs and D the dynamic stiffness of the tree at s = w^2, the
pivots of [[D, P], [P', -H]] in both orders give the count of the train: that of the tree, less the number of negative
eigenvalues of M = H + P' D^-1 P (Sylvester; Haynsworth 1968). For any angles q it is H + P'q + q'P - q'D q + g'D^-1 g
with g = P - D q. Static: q has the twists of stiff spans and none of soft ones, so that nothing large cancels. Modal:
q is the response to the chord torques of a mode, so that g is of rounding only, and a resonance of a part of the torn
tree, beside which D^-1 g is large, matters no more. One elimination from the leaves to a root gives D's pivots and
g'D^-1 g.

Roundings of pivots are those of a train with other inertias and flexibilities, outweighed as in `sturm`, so that tree
and M are those of one train; those of M in it are carried along as a running error, by which M is leaned.
"""

from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.modes.natural_modes import margins, pass_on
from torsion.kernels.trees.tree import Step, Tree

_UNIT_ROUNDOFF = 2.0**-53
_ROUNDINGS = 10.0  # of a term of M or a load, besides those of sums: r, its products, h r, the torque passed on
# Of what a span passes on, less its margin, if 1 + h z is taken to be that of another h.
_OF_STIFFNESS = 5.0
_FARTHEST = 0.5  # relative change of a square beyond which a step has left its mode
_EIGENVALUE = 8.0  # roundings of the eigenvalues of a matrix whose entries are below 1, times its size squared


@dataclass(frozen=True)
class Network:
    """Trains of one layout side by side: a tree with a column for each, and its chords."""

    tree: Tree  # flexibility and inertia (stations, trains)
    pair: FloatArray  # (chords, stations) torques of each chord
    chord: FloatArray  # (chords, trains) rad/(N m)

    def columns(self, trains: IntArray | BoolArray | slice) -> "Network":
        """Return the network of some trains, by position or mask."""
        return replace(self, tree=self.tree.columns(trains), chord=self.chord[:, trains])


@dataclass(frozen=True)
class Way:
    """How to eliminate trains toward a root, with angles q of the tree for each chord; the last axis: 1 or trains.

    Branches carry nothing of the chords; they come first, into the dynamic stiffness of the stations of the `core`.
    """

    trains: Network
    branches: list[Step]  # the leaves first
    steps: list[Step]  # the same by position in the core
    core: IntArray  # stations between the ends of chords, and between these and the root, which is the last
    sign: FloatArray  # (chords, core, .) torque of each pair through the span toward the root
    torque: FloatArray  # (chords, core, .) of q in the same spans
    load: FloatArray  # (chords, core, .) of the pairs, less those torques
    lift: FloatArray  # (chords, .) angle of the root in q
    basis: FloatArray  # (chords, chords, .) chord torques in place of unit ones
    terms: FloatArray | None = (
        None  # (chords, core, trains) like `load`: sum of its terms without signs; of modes
    )

    def columns(self, trains: IntArray | BoolArray | slice) -> "Way":
        """Return the way of some trains, by position or mask."""
        names = ("sign", "torque", "load", "lift", "basis", "terms")
        rows = {name: getattr(self, name)[..., trains] for name in names if self.terms is not None}
        return replace(self, trains=self.trains.columns(trains), **rows)

    def modal(
        self, fixed: list[bool], chord_torque: FloatArray, torque: FloatArray, lift: FloatArray
    ) -> "Way":
        """With the shape of a mode as q of its `chord_torque` (chords, trains), in place of the largest of them.

        torque: (core, trains) in the spans toward the root; lift: (trains,) angle of the root.
        """
        number, trains = chord_torque.shape
        largest, column = np.argmax(np.abs(chord_torque), axis=0), np.arange(trains)
        scale = chord_torque[largest, column]
        basis = np.repeat(np.eye(number)[:, :, None], trains, axis=2)
        basis[largest, :, column] = (chord_torque / scale).T
        sign = np.einsum("klt,lst->kst", basis, self.sign)
        bound = np.einsum("klt,lst->kst", np.abs(basis), np.abs(self.sign))
        q, lifts = np.broadcast_to(self.torque, sign.shape).copy(), np.zeros((number, trains))
        q[largest, :, column], lifts[largest, column] = (torque / scale).T, lift / scale
        load, terms = sign - q, bound + np.abs(q)
        for station, near, _ in self.steps:
            if not fixed[near]:
                load[:, near] -= sign[:, station] - q[:, station]
                terms[:, near] += bound[:, station] + np.abs(q[:, station])
        return replace(self, sign=sign, torque=q, load=load, lift=lifts, basis=basis, terms=terms)


def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """(chords, chords, trains) of two (chords, trains)."""
    return left[:, None] * right[None, :]


class Elimination:
    """All but the root at s = `square` (trains,); with `lean` +1 or -1 every rounding is outweighed, as in `sturm`.

    `stiffness` (core, trains) N m/rad: each as it was eliminated, that of the root last; `inertia`: less what it was
    before, branches included, 0 where fixed; `load` (chords, core, trains) of g; `at_root`: the last of both; `matrix`
    (chords, chords, trains) rad/(N m): M without what the root adds; `negative` (trains,): pivots of all stations but
    the root. With `lean`, `size` is the sum of the terms of `matrix` without signs, and `error`, `load_error` are of
    roundings.
    """

    def __init__(self, way: Way, square: FloatArray, lean: float = 0.0) -> None:
        tree = way.trains.tree
        self.way, self.lean, self.fixed = way, lean, tree.held[way.core].tolist()
        self.margin = 0.0
        if lean:
            of_square, _, of_stiffness = margins(tree, square)
            # The root is another one, which may have one child more.
            self.margin = of_stiffness + 2.0 * _UNIT_ROUNDOFF
            square = square * (1.0 + lean * (of_square + 2.0 * _UNIT_ROUNDOFF))
        self.flexibility, self.number = tree.flexibility, len(way.trains.chord)
        station = np.where(tree.held[:, None], np.inf, 0.0 - tree.moving_inertia * square)
        branch, _, spans = np.array(way.branches, dtype=np.int64).reshape(-1, 3).T
        through = tree.flexibility[spans]
        rows = dict(zip(spans.tolist(), through, strict=True))
        pass_on(way.branches, list(station), rows, lean * self.margin if lean else None)
        self.negative = ((station[branch] < 0.0) & ~np.signbit(through)).sum(axis=0)
        self.stations, self.stiffness = station, station[way.core]
        self.inertia = np.where(tree.held[way.core, None], 0.0, -self.stiffness)
        self._begin()
        for core_station, near, span in way.steps:
            (self._past_fixed if self.fixed[core_station] else self._past_free)(
                core_station, near, tree.flexibility[span]
            )
        self.at_root = self.stiffness[-1], self.load[:, -1]
        if lean:
            self.error += 3.0 * len(way.core) * _UNIT_ROUNDOFF * self.size

    def _begin(self) -> None:
        """M of q alone, and the loads that q leaves."""
        way, a, h, basis = self.way, self.inertia, self.flexibility, self.way.basis
        trains = way.trains
        spans = np.count_nonzero(way.torque.any(axis=2), axis=1).max(initial=0)
        # Of a product of loads, or one passed on; and with the roundings of q.
        self.term = (2 * trains.tree.most_children + _ROUNDINGS) * _UNIT_ROUNDOFF
        self.unit = self.term + spans * _UNIT_ROUNDOFF
        self.q = np.zeros((self.number, *a.shape))
        self.q[:, -1] = way.lift
        self.matrix = np.einsum("klt,lt,mlt->kmt", basis, trains.chord, basis)
        for station, near, span in reversed(way.steps):
            s, t = way.sign[:, station], way.torque[:, station]
            self.q[:, station] = t * h[span] + (0.0 if self.fixed[near] else self.q[:, near])
            self.matrix += (product(s, t) + product(t, s) - product(t, t)) * h[span]
        inertia_load = a * self.q
        self.load = inertia_load + way.load
        self.matrix += np.einsum("kit,lit->klt", inertia_load, self.q)
        if not self.lean:
            return

        # Sums of the terms of q without signs, and the roundings that follow from them.
        self.reach = np.zeros_like(self.q)
        self.reach[:, -1] = np.abs(way.lift)
        a, basis = np.abs(a), np.abs(basis)
        self.size = np.einsum("klt,lt,mlt->kmt", basis, trains.chord, basis)
        for station, near, span in reversed(way.steps):
            s, t = np.abs(way.sign[:, station]), np.abs(way.torque[:, station])
            self.reach[:, station] = t * h[span]
            if not self.fixed[near]:
                self.reach[:, station] += self.reach[:, near]
            self.size += h[span] * (product(s, t) if way.terms is None else product(s + t, s + t))
        inertia_load = a * self.reach
        self.size += np.einsum("kit,lit->klt", inertia_load, self.reach)
        self.error, self.load_error = self.unit * self.size, self.unit * inertia_load
        if way.terms is not None:
            self.load_error += self.unit * way.terms

    def _past_fixed(self, i: int, near: int, h: FloatArray) -> None:
        share = 1.0 / h
        self.stiffness[near] += share
        q, f = self.q[:, i], self.load[:, i]
        term = product(q, q * share) + product(q, f) + product(f, q)
        self.matrix -= term
        if self.lean:
            bound = self.reach[:, i]
            load_error = self.unit * (bound * share + np.abs(f)) + self.load_error[:, i]
            self.size += np.abs(term)
            self.error += product(bound, load_error) + product(load_error, bound)
        if not self.fixed[near]:
            self.load[:, near] -= q * share
            if self.lean:
                self.load_error[:, near] += 2.0 * self.unit * self.reach[:, i] * share

    def _past_free(self, i: int, near: int, h: FloatArray) -> None:
        f, z = self.load[:, i], self.stiffness[i]
        transfer = 1.0 / (1.0 + h * z)
        through, term = z * transfer, h * transfer * product(f, f)
        self.negative += transfer < 0.0
        self.matrix += term
        if self.lean:
            size, room = np.abs(f), self.load_error[:, i]
            self.size += np.abs(term)
            self.error += np.abs(h * transfer) * (
                product(size + room, size + room) * (1.0 + self.term) - product(size, size)
            )
            lessening = self.lean * self.margin * np.abs(through)
            through = through - lessening
            if not self.fixed[near]:
                # What is passed on less is as inertia of the next station; `amount`: by how much that is not right.
                q, room = self.q[:, near], self.unit * self.reach[:, near]
                largest, amount = np.abs(q) + room, _OF_STIFFNESS * _UNIT_ROUNDOFF * np.abs(through)
                self.load[:, near] += lessening * q
                self.matrix += lessening * product(q, q)
                extra = amount * largest + np.abs(lessening) * room
                self.error += product(extra, largest) + product(largest, extra)
                passed_error = self.load_error[:, i] + self.term * size
                self.load_error[:, near] += np.abs(transfer) * passed_error + extra
        self.stiffness[near] += through
        if not self.fixed[near]:  # every span has a copy of a fixed station of its own
            self.load[:, near] += transfer * f


def network_count(way: Way, w: FloatArray, *, bound: float) -> IntArray:
    """Frequencies below `w` (trains,) rad/s, rigid motions included: never less (+1) or never more (-1) than exact."""
    number = len(way.trains.chord)
    with np.errstate(all="ignore"):
        seen = Elimination(way, w * w, bound)
        stiffness, load = seen.at_root
        size, room, root = np.abs(load), seen.load_error[:, -1], np.abs(1.0 / stiffness)
        last = product(load, load) / stiffness
        error = seen.error + root * (
            product(size + room, size + room) - (1.0 - 4.0 * _UNIT_ROUNDOFF) * product(size, size)
        )
        chord = np.arange(number)
        scale = np.sqrt((seen.size + np.abs(last))[chord, chord])
        matrix, error = (
            (values / product(scale, scale)).transpose(2, 0, 1)
            for values in (seen.matrix + last, error)
        )
        matrix[:, chord, chord] += bound * (
            error.sum(axis=2) + _EIGENVALUE * number**2 * _UNIT_ROUNDOFF
        )
    lost = ~np.isfinite(matrix).all(axis=(1, 2))
    matrix[lost] = bound * np.eye(number)
    below = (np.linalg.eigvalsh(matrix) < 0.0).sum(axis=1)
    total = seen.negative + (stiffness < 0.0) - below
    return np.where(lost, way.trains.tree.size if bound > 0 else -1, total)


def modal_way(way: Way, square: FloatArray) -> tuple[Way, FloatArray]:
    """The static `way` with q of the mode near s = `square` (trains,), and Rayleigh's s (trains,) of it."""
    tree = way.trains.tree
    with np.errstate(all="ignore"):
        seen = Elimination(way, square)
        stiffness, load = seen.at_root
        chord_torque = _least_chord_torques(seen.matrix + product(load, load) / stiffness)
        f, q, torque = (
            np.einsum("kt,kst->st", chord_torque, np.broadcast_to(values, seen.load.shape))
            for values in (seen.load, seen.q, way.torque)
        )
        angle = np.zeros_like(f)
        angle[-1] = f[-1] / stiffness
        for i, near, span in reversed(way.steps):
            h, near_angle = seen.flexibility[span], 0.0 if seen.fixed[near] else angle[near]
            if seen.fixed[i]:
                angle[i] = -q[i]
                torque[i] += (angle[i] - near_angle) / h
            else:
                transfer = 1.0 / (1.0 + h * seen.stiffness[i])
                angle[i] = transfer * (near_angle + h * f[i])
                torque[i] += transfer * (f[i] - seen.stiffness[i] * near_angle)
        lift = angle[-1]
        lost = ~np.isfinite(np.vstack([torque, lift, chord_torque])).all(axis=0)
        torque[:, lost], lift, chord_torque[:, lost] = 0.0, np.where(lost, 0.0, lift), 1.0
        modal = way.modal(seen.fixed, chord_torque, torque, lift)
        seen_with_mode = Elimination(modal, square)
        row, column = np.argmax(np.abs(chord_torque), axis=0), np.arange(len(square))
        stiffness, load = seen_with_mode.at_root
        matrix = (seen_with_mode.matrix + product(load, load) / stiffness)[row, row, column]

        # The inertia of a branch as its station in the core turns it.
        inertia = tree.moving_inertia * square
        for station, near, span in way.branches:
            inertia[near] += (
                inertia[station] / (1.0 + seen.flexibility[span] * seen.stations[station]) ** 2
            )
        turned = seen_with_mode.q[row, :, column].T
        change = -matrix / (np.where(tree.held[:, None], 0.0, inertia)[way.core] * turned**2).sum(
            axis=0
        )
    is_near = np.isfinite(change) & (np.abs(change) < _FARTHEST)
    return modal, np.where(is_near, square * (1.0 + change), square)


def _least_chord_torques(matrix: FloatArray) -> FloatArray:
    """Chord torques (chords, trains) for which M (chords, chords, trains) is least beside its diagonal."""
    scale = 1.0 / np.sqrt(np.abs(np.einsum("kkt->kt", matrix)))
    scaled = (matrix * product(scale, scale)).transpose(2, 0, 1)
    lost = ~np.isfinite(scaled).all(axis=(1, 2))
    scaled[lost], scale[:, lost] = np.eye(len(matrix)), 1.0
    values, vectors = np.linalg.eigh(scaled)
    smallest = np.argmin(np.abs(values), axis=1)
    return np.asarray(vectors[np.arange(len(vectors)), :, smallest].T * scale)
