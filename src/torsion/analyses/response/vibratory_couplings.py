"""Couplings by table over their own vibratory torque: the half range of all harmonic components that it leads to.

The reciprocal of the twist in one span is linear in its dynamic stiffness K, 1/u = a + b K, of every harmonic
component: two answers of the train give its torque K u at any K, so that all solutions of T = half range(K(T)) are
found by scanning every piece of the table, while the other couplings stand. Several couplings are solved one after
another until none changes; from some rounds on each goes half the way.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import pairwise

import numpy as np

from torsion.analyses.response.amplitudes import Components, Following, Response
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.response.solver import answer
from torsion.analyses.response.synthesis import half_range_of
from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import complex_stiffness
from torsion.findings import Work
from torsion.kernels.amplitude_equation import solutions
from torsion.kernels.stiffness_laws import StiffnessTable
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

    coupling: str = result("its name")
    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    torque: FloatArray = result(
        "N*m",
        "speed",
        "amplitude (zero to peak) of all harmonic components; of several solutions the largest",
    )
    smallest: FloatArray = result("N*m", "speed", "the smallest solution")
    number: IntArray = result(
        "", "speed", "solutions, as far as found between the points of the table"
    )
    stiffness: FloatArray = result("N*m/rad", "speed", "dynamic stiffness at `torque`")
    loss_factor: FloatArray = result("1", "speed", "loss factor at `torque`")
    residual: FloatArray = result(
        "1", "speed", "relative: amplitude at that stiffness against `torque`"
    )
    rounds: IntArray = result("", "speed", "rounds over all such couplings")
    settled: BoolArray = result(
        "", "speed", "it is an answer; no other speed has one", key="has_settled"
    )


@reported
class VibratoryTorques:
    """Couplings with such a table."""

    each: tuple[VibratoryTorque, ...] = result("couplings by table over vibratory torque", key="")


@dataclass(frozen=True)
class _Train:
    """A train with tables over vibratory torque, and what excites it."""

    system: System
    components: Components
    # One by one, each with sources that have a phase to each other.
    separate: Sequence[tuple[Fraction | None, FloatArray, Sources]]
    half_range: Callable[[ComplexArray], FloatArray]  # of phasors (points, components)
    tables: Mapping[int, StiffnessTable]

    def torques(
        self, span: int, torque: Mapping[int, FloatArray], points: IntArray, factor: complex = 1.0
    ) -> ComplexArray:
        """Return stiffness and torque (2, components, points) of a span at some points, its stiffness times a factor.

        torque: (all points,) N m of each span with a table; one beyond a table counts as its end.
        """
        components = self.components
        mean, ground = components.mean[:, points], components.ground[:, points]
        speed = None if components.speed is None else components.speed[points]
        covered = {
            tabled: np.clip(torque[tabled][points], *table.ends)
            for tabled, table in self.tables.items()
        }
        rows = []
        for _, every_w, source in self.separate:
            w = every_w[points]
            stiffness = {**complex_stiffness(self.system, w, mean, speed, covered)}
            stiffness[span] = stiffness[span] * factor
            solution = answer(self.system, w, source.at(points), ground, stiffness=stiffness)
            rows.append([stiffness[span], solution.torque[:, span]])
        return np.moveaxis(np.array(rows), 1, 0)

    def solved(
        self, span: int, torque: Mapping[int, FloatArray], points: IntArray
    ) -> tuple[FloatArray, IntArray]:
        """Return all solutions (points, most) N m of a span at some points, the largest first, and their number.

        Beyond those of a point its smallest stands. A torque beyond the table is found at the stiffness of its end.
        """
        table = self.tables[span]
        # (components, points): T = K/(K0/T0 + b (K - K0)); the reciprocal is 0 where nothing moves.
        first, torque_at_first = self.torques(span, torque, points)
        second, torque_at_second = self.torques(span, torque, points, 1.5 + 0.5j)
        moves = (torque_at_first != 0) & (torque_at_second != 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = first / torque_at_first
            slope = (second / torque_at_second - inverse) / (second - first)
        slope = np.where(moves, slope, 0.0)

        def phasors(size: FloatArray, point: IntArray) -> ComplexArray:
            covered = np.clip(size, *table.ends)
            stiffness = np.array(
                [table.complex_stiffness(covered, w[points[point]]) for _, w, _ in self.separate]
            )
            with np.errstate(divide="ignore", invalid="ignore"):
                change = slope[:, point] * (stiffness - first[:, point])
                torques = stiffness / (inverse[:, point] + change)
            return np.where(moves[:, point], torques, 0.0).T

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
        for piece, ends in enumerate(pairwise(edges)):
            samples = FIRST_SAMPLES if piece < len(begins) else SAMPLES
            begin, end = (np.full(len(points), edge) for edge in ends)
            roots.append(solutions(ratio, begin, end, samples))
        point, size = (np.concatenate(columns) for columns in zip(*roots, strict=True))
        order = np.lexsort((-size, point))
        number = np.bincount(point, minlength=len(points))
        rank_of_root = np.minimum(
            np.arange(int(number.max(initial=1))), np.maximum(number, 1)[:, None] - 1
        )
        first_root = np.searchsorted(point[order], all_points)[:, None]
        padded = np.append(size[order], np.nan)
        return padded[np.where(number[:, None] > 0, first_root + rank_of_root, -1)], number


def settled(system: System, components: Components, rank: int) -> Following:
    """Return every coupling at a solution of that rank, the largest first; where it has fewer, at its smallest.

    A torque beyond a table is found at the stiffness of its end; who reads a table that ends there refuses it.
    """
    separate, points = components.separate, components.ground.shape[1]
    half_range = partial(
        half_range_of,
        [order for order, _, _ in separate],
        by_magnitude=len(separate) > len(components.w),
    )
    tables = system.tables_over("vibratory torque")
    train = _Train(system, components, separate, half_range, tables)
    torque = {span: np.full(points, table.at[0]) for span, table in tables.items()}
    number = {span: np.ones(points, dtype=np.int64) for span in torque}
    rounds = np.zeros(points, dtype=np.int64)
    open_ = np.arange(points if separate else 0)
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

    # An answer is what the whole train confirms: |half range/torque - 1| (points, couplings).
    residual = np.zeros((points, len(torque)))
    for k, (span, size) in enumerate(torque.items() if separate else ()):
        phasors = train.torques(span, torque, np.arange(points))[1]
        lacks = np.abs(half_range(phasors.T) - size)
        residual[:, k] = lacks / np.maximum(size, np.finfo(float).tiny)
    is_settled: BoolArray = np.asarray((residual <= SETTLED).all(axis=1))
    is_settled[open_] = False
    for span, table in tables.items():
        torque[span] = np.where(
            is_settled, torque[span], np.clip(np.nan_to_num(torque[span]), *table.ends)
        )
    torques = np.array(list(torque.values())).T
    count_of = np.array(list(number.values())).T
    return Following(tuple(torque), torques, count_of, residual, rounds, is_settled)


def run(work: Work) -> None:
    """Put the couplings by table over vibratory torque where there is a response over speed."""
    response = work.get(Response)
    if response is None:
        work.log.without("vibratory torque of couplings by table", "no response over speed")
        return
    rows = []
    if (following := response.following) is not None:
        last = (response.others or (response,))[-1].following or following
        for k, span in enumerate(following.spans):
            torque = following.torque[:, k]
            stiffness, eta, _ = response.system.tables[span].values(torque)
            row = VibratoryTorque(
                response.system.spans[span].name,
                response.speed,
                torque,
                np.minimum(last.torque[:, k], torque),
                following.number[:, k],
                stiffness,
                eta,
                following.residual[:, k],
                following.rounds,
                following.settled,
            )
            rows.append(row)
    work.put(vibratory_torques=VibratoryTorques(tuple(rows)))
