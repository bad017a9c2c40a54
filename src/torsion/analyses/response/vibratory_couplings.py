"""Couplings by table over their own vibratory torque: the half range of all harmonic components that it leads to.

The reciprocal of the twist in one span is linear in its dynamic stiffness K, 1/u = a + b K, of every harmonic
component: two answers of the train give its torque K u at any K, so that all solutions of T = half range(K(T)) are
found by scanning every piece of the table, while the other couplings stand. Several couplings are solved one after
another until none changes; from some rounds on each goes half the way.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from torsion.analyses.response.amplitudes import Components, Following, Response
from torsion.analyses.response.solver import answer
from torsion.analyses.response.synthesis import half_range_of
from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import complex_stiffness
from torsion.findings import Work
from torsion.kernels.amplitude_equation import solutions
from torsion.results import reported, result

ROUNDS, HALF_WAY = 120, 20  # over several couplings; from the second on a torque goes half the way
CHANGED = 1e-12  # relative, of a torque in a round: less than that has settled
SETTLED = 1e-9  # most residual of what counts as an answer
SAMPLES = 48  # of a piece of a table, evenly in the logarithm
FIRST_SAMPLES, FIRST = 24, 0.01  # of a piece that begins at no torque, below that share of it
SMALLEST = 1e-9  # of the last torque of a table: below it the stiffness is that of no vibration


@reported
class VibratoryTorque:
    """One coupling over the speed."""

    coupling: str = result("", "its name")
    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    torque: FloatArray = result(
        "N*m",
        ("speed",),
        "amplitude (zero to peak) of all harmonic components; of several solutions the largest",
    )
    smallest: FloatArray = result("N*m", ("speed",), "the smallest solution")
    number: IntArray = result(
        "", ("speed",), "solutions, as far as found between the points of the table"
    )
    stiffness: FloatArray = result("N*m/rad", ("speed",), "dynamic stiffness at `torque`")
    loss_factor: FloatArray = result("1", ("speed",), "loss factor at `torque`")
    residual: FloatArray = result(
        "1", ("speed",), "relative: amplitude at that stiffness against `torque`"
    )
    rounds: IntArray = result("", ("speed",), "rounds over all such couplings")
    settled: BoolArray = result(
        "", ("speed",), "it is an answer; no other speed has one", key="has_settled"
    )


@reported
class VibratoryTorques:
    """Couplings with such a table."""

    each: tuple[VibratoryTorque, ...] = result(
        "", "couplings by table over vibratory torque", key=""
    )


@dataclass(frozen=True)
class _Torque:
    """The torque of a span in every harmonic component, at any stiffness of it: T = K/(K0/T0 + b (K - K0))."""

    first: ComplexArray  # (components, points) N m/rad, K0
    inverse: ComplexArray  # (components, points) 1/rad, K0/T0; 0 where nothing moves
    slope: ComplexArray  # (components, points) 1/(N m)

    def at(self, stiffness: ComplexArray, point: IntArray) -> ComplexArray:
        """Return torques (rows, components) N m, of rows each at a point and of stiffness (components, rows)."""
        inverse = self.inverse[:, point]
        with np.errstate(divide="ignore", invalid="ignore"):
            change = self.slope[:, point] * (stiffness - self.first[:, point])
            torque = stiffness / (inverse + change)
        return np.where(inverse != 0, torque, 0.0).T


class _Train:
    """The components one by one, each with sources that have a phase to each other."""

    def __init__(self, system: System, components: Components) -> None:
        self.system = system
        self.mean = components.mean
        self.speed = components.speed
        self.ground = components.ground
        self.points = components.ground.shape[1]
        self.tables = system.tables_over("vibratory torque")
        self.separate = components.separate
        self.half_range = partial(
            half_range_of,
            [order for order, _, _ in self.separate],
            by_magnitude=len(self.separate) > len(components.w),
        )

    def torques(
        self, span: int, stiffness: Mapping[int, ComplexArray], k: int, points: IntArray
    ) -> ComplexArray:
        """Return the torque (points,) N m of a span in component k, at some points; stiffness: as of `answer`."""
        _, w, source = self.separate[k]
        ground = self.ground[:, points]
        result = answer(self.system, w[points], source.at(points), ground, stiffness=stiffness)
        return result.torque[:, span]

    def stiffness(
        self, k: int, torque: Mapping[int, FloatArray], points: IntArray
    ) -> dict[int, ComplexArray]:
        """Return the stiffness of every span with a table in component k, at some points.

        torque: (all points,) N m of each span; one beyond a table counts as its end.
        """
        covered = {
            span: np.clip(torque[span][points], *table.ends) for span, table in self.tables.items()
        }
        speed = None if self.speed is None else self.speed[points]
        w = self.separate[k][1][points]
        return complex_stiffness(self.system, w, self.mean[:, points], speed, covered)

    def trial(self, span: int, torque: Mapping[int, FloatArray], points: IntArray) -> _Torque:
        """Return the torque of a span at some points, the others as they stand."""
        rows = []
        for k in range(len(self.separate)):
            stiffness_of = self.stiffness(k, torque, points)
            first = stiffness_of[span]
            second = first * (1.5 + 0.5j)
            torques = [
                self.torques(span, {**stiffness_of, span: own_stiffness}, k, points)
                for own_stiffness in (first, second)
            ]
            with np.errstate(divide="ignore", invalid="ignore"):
                inverse = first / torques[0]
                slope = (second / torques[1] - inverse) / (second - first)
            still = (torques[0] == 0) | (torques[1] == 0)
            rows.append([first, np.where(still, 0.0, inverse), np.where(still, 0.0, slope)])
        return _Torque(*np.moveaxis(np.array(rows), 1, 0))

    def solved(
        self, span: int, torque: Mapping[int, FloatArray], points: IntArray
    ) -> tuple[FloatArray, IntArray]:
        """Return all solutions (points, most) N m of a span at some points, the largest first, and their number.

        Beyond those of a point its smallest stands. A torque beyond the table is found at the stiffness of its end.
        """
        table = self.tables[span]
        trial = self.trial(span, torque, points)

        def phasors(size: FloatArray, point: IntArray) -> ComplexArray:
            covered = np.clip(size, *table.ends)
            chosen = points[point]
            stiffness = [table.complex_stiffness(covered, w[chosen]) for _, w, _ in self.separate]
            return trial.at(np.array(stiffness), point)

        def ratio(size: FloatArray, point: IntArray) -> FloatArray:
            """Return torque over half range; where bounds of that decide which is larger, over one of them."""
            torques = phasors(size, point)
            magnitude = np.abs(torques)
            lowest = np.sqrt((magnitude**2).sum(axis=1) / 2.0)
            highest = magnitude.sum(axis=1)
            divisor = np.where(size > highest, lowest, highest)
            near = np.flatnonzero((size >= lowest) & (size <= highest))
            divisor[near] = self.half_range(torques[near])
            with np.errstate(divide="ignore"):
                return np.asarray(size / divisor)

        all_points = np.arange(len(points))
        begins = [] if table.at[0] > 0 else [SMALLEST * table.at[-1]]
        edges = [*begins, table.at[0] or FIRST * table.at[1], *table.at[1:]]
        low, high = (
            self.half_range(phasors(np.full(len(points), edge), all_points))
            for edge in (edges[0], edges[-1])
        )
        below = np.flatnonzero(low <= edges[0])
        above = np.flatnonzero(high > edges[-1])
        roots = [(below, low[below]), (above, high[above])]
        for piece, (begin, end) in enumerate(pairwise(edges)):
            samples = FIRST_SAMPLES if piece < len(begins) else SAMPLES
            ends = np.full(len(points), begin), np.full(len(points), end)
            roots.append(solutions(ratio, *ends, samples))
        point, size = (np.concatenate(columns) for columns in zip(*roots, strict=True))
        order = np.lexsort((-size, point))
        point = point[order]
        size = size[order]
        number = np.bincount(point, minlength=len(points))
        rank_of_root = np.minimum(
            np.arange(max(number.max(initial=1), 1)), np.maximum(number, 1)[:, None] - 1
        )
        first = np.searchsorted(point, all_points)
        padded = np.append(size, np.nan)
        return padded[np.where(number[:, None] > 0, first[:, None] + rank_of_root, -1)], number

    def residual(self, torque: Mapping[int, FloatArray]) -> FloatArray:
        """Return |half range/torque - 1| (points, couplings) by the answer of the whole train."""
        all_points = np.arange(self.points)
        residuals = []
        for span, size in torque.items():
            phasors = [
                self.torques(span, self.stiffness(k, torque, all_points), k, all_points)
                for k in range(len(self.separate))
            ]
            half = self.half_range(np.array(phasors).T)
            residuals.append(np.abs(half - size) / np.maximum(size, np.finfo(float).tiny))
        return np.array(residuals).T


def settled(system: System, components: Components, rank: int) -> Following:
    """Return every coupling at a solution of that rank, the largest first; where it has fewer, at its smallest.

    A torque beyond a table is found at the stiffness of its end; who reads a table that ends there refuses it.
    """
    train = _Train(system, components)
    torque = {span: np.full(train.points, table.at[0]) for span, table in train.tables.items()}
    number = {span: np.ones(train.points, dtype=np.int64) for span in torque}
    rounds = np.zeros(train.points, dtype=np.int64)
    open_ = np.arange(train.points if train.separate else 0)
    for count in range(ROUNDS):
        changed = np.zeros(len(open_), dtype=bool)
        for span, size in torque.items():
            roots, number[span][open_] = train.solved(span, torque, open_)
            new = roots[:, min(rank, roots.shape[1] - 1)]
            before = size[open_]
            if count >= HALF_WAY:
                new = np.sqrt(new * before)
            changed |= ~(np.abs(new - before) <= CHANGED * before)
            size[open_] = new
        rounds[open_] += 1
        open_ = open_[changed & (len(torque) > 1)]
        if not open_.size:
            break
    residual = np.zeros((train.points, len(torque)))
    if train.separate:
        residual = train.residual(torque)
    is_settled: BoolArray = np.asarray((residual <= SETTLED).all(axis=1))
    is_settled[open_] = False
    for span, table in train.tables.items():
        torque[span] = np.where(
            is_settled, torque[span], np.clip(np.nan_to_num(torque[span]), *table.ends)
        )
    torques = np.array(list(torque.values())).T
    count_of = np.array(list(number.values())).T
    return Following(tuple(torque), torques, count_of, residual, rounds, is_settled)


def vibratory_torques(response: Response) -> VibratoryTorques:
    """Return the couplings by table over vibratory torque of a response over speed."""
    following = response.following
    rows = []
    if following is None:
        return VibratoryTorques(())
    last = response.others[-1].following if response.others else following
    for k, span in enumerate(following.spans):
        stiffness, eta, _ = response.system.tables[span].values(following.torque[:, k])
        smallest = (following if last is None else last).torque[:, k]
        rows.append(
            VibratoryTorque(
                response.system.spans[span].name,
                response.speed,
                following.torque[:, k],
                np.minimum(smallest, following.torque[:, k]),
                following.number[:, k],
                stiffness,
                eta,
                following.residual[:, k],
                following.rounds,
                following.settled,
            )
        )
    return VibratoryTorques(tuple(rows))


def run(work: Work) -> None:
    """Put the couplings where there is a response over speed."""
    response = work.get(Response)
    if response is None:
        work.log.without("vibratory torque of couplings by table", "no response over speed")
        return
    work.put(vibratory_torques=vibratory_torques(response))
