"""Couplings by table over their own vibratory torque: the half range of all harmonic components that it leads to.

The reciprocal of the twist in one span is linear in its dynamic stiffness K, 1/u = a + b K, of every harmonic
component: two answers of the train give its torque K u at any K, so that all solutions of T = half range(K(T)) are
found by scanning every piece of the table, while the other couplings stand. Several couplings are solved one after
another until none changes; from some rounds on each goes half the way.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.analyses.response.amplitudes import Components, Following
from torsion.analyses.response.solver import answer
from torsion.analyses.response.synthesis import half_range_of
from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import complex_stiffness
from torsion.kernels.amplitude_equation import solutions

ROUNDS, HALF_WAY = 120, 20  # over several couplings; from the second on a torque goes half the way
CHANGED = 1e-12  # relative, of a torque in a round: less than that has settled
SETTLED = 1e-9  # most residual of what counts as an answer
SAMPLES = 48  # of a piece of a table, evenly in the logarithm
FIRST_SAMPLES, FIRST = 24, 0.01  # of a piece that begins at no torque, below that share of it
SMALLEST = 1e-9  # of the last torque of a table: below it the stiffness is that of no vibration


@dataclass(frozen=True)
class _Torque:
    """The torque of a span in every harmonic component, at any stiffness of it: T = K/(K0/T0 + b (K - K0))."""

    first: ComplexArray  # (components, points) N m/rad, K0
    inverse: ComplexArray  # (components, points) 1/rad, K0/T0; 0 where nothing moves
    slope: ComplexArray  # (components, points) 1/(N m)

    def at(self, stiffness: ComplexArray, point: IntArray) -> ComplexArray:
        """(rows, components) N m, of rows each at a point and of stiffness (components, rows)."""
        inverse = self.inverse[:, point]
        with np.errstate(divide="ignore", invalid="ignore"):
            torque = stiffness / (
                inverse + self.slope[:, point] * (stiffness - self.first[:, point])
            )
        return np.where(inverse != 0, torque, 0.0).T


class _Train:
    """The components one by one, each with sources that have a phase to each other."""

    def __init__(self, system: System, known: Components) -> None:
        self.system, self.mean, self.ground, self.speed = (
            system,
            known.mean,
            known.ground,
            known.speed,
        )
        self.tables = system.tables_over("vibratory torque")
        each = [
            (order, w, one)
            for order, w, apart in zip(known.orders, known.w, known.apart, strict=True)
            for one in apart
        ]
        self.orders = [order for order, _, _ in each]
        self.by_magnitude = len(each) > len(known.w)
        self.w, self.sources = [w for _, w, _ in each], [one for _, _, one in each]
        self.points = self.ground.shape[1]

    def torques(
        self, span: int, stiffness: Mapping[int, ComplexArray], k: int, at: IntArray
    ) -> ComplexArray:
        """(points,) N m of a span in one component, at points `at`; stiffness: as of `answer`."""
        one, w = self.sources[k], self.w[k][at]
        return answer(self.system, w, one.at(at), self.ground[:, at], stiffness=stiffness).torque[
            :, span
        ]

    def stiffness(
        self, k: int, torque: Mapping[int, FloatArray], at: IntArray
    ) -> dict[int, ComplexArray]:
        """Of every span with a table in one component, at points `at`; torque: (points,) N m, within the tables."""
        covered = {
            span: np.clip(torque[span][at], table.at[0], table.at[-1])
            for span, table in self.tables.items()
        }
        speed = None if self.speed is None else self.speed[at]
        return complex_stiffness(self.system, self.w[k][at], self.mean[:, at], speed, covered)

    def trial(self, span: int, torque: Mapping[int, FloatArray], at: IntArray) -> _Torque:
        """Of a span at points `at`, the others as they stand."""
        rows = []
        for k in range(len(self.w)):
            known = self.stiffness(k, torque, at)
            first = known[span]
            second = first * (1.5 + 0.5j)
            torques = [self.torques(span, {**known, span: own}, k, at) for own in (first, second)]
            with np.errstate(divide="ignore", invalid="ignore"):
                inverse, other = first / torques[0], second / torques[1]
                slope = (other - inverse) / (second - first)
            still = (torques[0] == 0) | (torques[1] == 0)
            rows.append([first, np.where(still, 0.0, inverse), np.where(still, 0.0, slope)])
        return _Torque(*np.moveaxis(np.array(rows), 1, 0))

    def solved(
        self, span: int, torque: Mapping[int, FloatArray], at: IntArray
    ) -> tuple[FloatArray, IntArray]:
        """All solutions (points, most) N m of a span at points `at`, the largest first, and how many there are.

        Beyond those of a point its smallest stands. A torque beyond the table is found at the stiffness of its end.
        """
        table, trial = self.tables[span], self.trial(span, torque, at)
        w = np.array([one[at] for one in self.w])

        def phasors(size: FloatArray, point: IntArray) -> ComplexArray:
            own = np.clip(size, table.at[0], table.at[-1])
            return trial.at(
                np.array([table.complex_stiffness(own, one[point]) for one in w]), point
            )

        def half_range(found: ComplexArray) -> FloatArray:
            return half_range_of(self.orders, found, by_magnitude=self.by_magnitude)

        def ratio(size: FloatArray, point: IntArray) -> FloatArray:
            """Torque over half range; where bounds of that decide which is larger, over one of them."""
            found = phasors(size, point)
            least, most = np.sqrt((np.abs(found) ** 2).sum(axis=1) / 2.0), np.abs(found).sum(axis=1)
            of = np.where(size > most, least, most)
            near = np.flatnonzero((size >= least) & (size <= most))
            of[near] = half_range(found[near])
            with np.errstate(divide="ignore"):
                return np.asarray(size / of)

        every = np.arange(len(at))
        begins = [] if table.at[0] > 0 else [SMALLEST * table.at[-1]]
        edges = [*begins, table.at[0] or FIRST * table.at[1], *table.at[1:]]
        low, high = (half_range(phasors(np.full(len(at), edges[end]), every)) for end in (0, -1))
        below, above = np.flatnonzero(low <= edges[0]), np.flatnonzero(high > edges[-1])
        found = [(below, low[below]), (above, high[above])]
        for piece, (begin, end) in enumerate(pairwise(edges)):
            samples = FIRST_SAMPLES if piece < len(begins) else SAMPLES
            ends = np.full(len(at), begin), np.full(len(at), end)
            found.append(solutions(ratio, *ends, samples))
        point, size = (np.concatenate(one) for one in zip(*found, strict=True))
        order = np.lexsort((-size, point))
        point, size = point[order], size[order]
        number = np.bincount(point, minlength=len(at))
        place = np.minimum(
            np.arange(max(number.max(initial=1), 1)), np.maximum(number, 1)[:, None] - 1
        )
        first = np.searchsorted(point, every)
        padded = np.append(size, np.nan)
        return padded[np.where(number[:, None] > 0, first[:, None] + place, -1)], number

    def residual(self, torque: Mapping[int, FloatArray]) -> FloatArray:
        """(points, couplings) |half range/torque - 1| by the answer of the whole train."""
        every, made = np.arange(self.points), []
        for span, size in torque.items():
            phasors = [
                self.torques(span, self.stiffness(k, torque, every), k, every)
                for k in range(len(self.w))
            ]
            half = half_range_of(self.orders, np.array(phasors).T, by_magnitude=self.by_magnitude)
            made.append(np.abs(half - size) / np.maximum(size, np.finfo(float).tiny))
        return np.array(made).T


def settled(system: System, known: Components, rank: int) -> Following:
    """Every coupling at a solution of that rank, the largest first; where it has fewer, at its smallest.

    A torque beyond a table is found at the stiffness of its end; who reads a table that ends there refuses it.
    """
    train = _Train(system, known)
    torque = {span: np.full(train.points, table.at[0]) for span, table in train.tables.items()}
    number = {span: np.ones(train.points, dtype=np.int64) for span in torque}
    open_, rounds = (
        np.arange(train.points if train.w else 0),
        np.zeros(train.points, dtype=np.int64),
    )
    for count in range(ROUNDS):
        changed = np.zeros(len(open_), dtype=bool)
        for span, size in torque.items():
            every, number[span][open_] = train.solved(span, torque, open_)
            new, before = every[:, min(rank, every.shape[1] - 1)], size[open_]
            if count >= HALF_WAY:
                new = np.sqrt(new * before)
            changed |= ~(np.abs(new - before) <= CHANGED * before)
            size[open_] = new
        rounds[open_] += 1
        open_ = open_[changed & (len(torque) > 1)]
        if not open_.size:
            break
    residual = train.residual(torque) if train.w else np.zeros((train.points, len(torque)))
    is_settled: BoolArray = np.asarray((residual <= SETTLED).all(axis=1))
    is_settled[open_] = False
    for span, table in train.tables.items():
        torque[span] = np.where(
            is_settled, torque[span], np.clip(np.nan_to_num(torque[span]), *table.ends)
        )
    found, count_of = np.array(list(torque.values())).T, np.array(list(number.values())).T
    return Following(tuple(torque), found, count_of, residual, rounds, is_settled)
