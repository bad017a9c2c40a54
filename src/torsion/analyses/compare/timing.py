"""Error against run time: methods timed in turn, which of them no other beats, and which to take.

All have their turn in every round, so that a slow minute of the machine falls on all alike.
"""

import gc
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf
from time import perf_counter
from typing import Any

import numpy as np

from torsion.errors import SolveError
from torsion.findings import Progress, silent

NOTICEABLE = 0.01  # relative: of two errors that differ by less neither is the smaller
ROUNDING = 1e-12  # relative error from which a finer discretisation cannot show more than rounding


@dataclass(frozen=True)
class Spread:
    """Repeated runs in a few numbers, seconds."""

    least: float
    quarter: float
    median: float
    three_quarters: float
    runs: int

    @classmethod
    def of(cls, samples: Sequence[float]) -> "Spread":
        """Summarise the seconds of at least one run."""
        low, middle, high = (float(value) for value in np.quantile(samples, [0.25, 0.5, 0.75]))
        return cls(min(samples), low, middle, high, len(samples))


@dataclass(frozen=True)
class TimedRow:
    """One method with one discretisation of the shafts: its errors and its repeated runs."""

    curve: str  # the method; rows of one method are one curve
    division: str  # in words
    size: int  # segments, elements or pieces of a shaft
    errors: tuple[
        float, ...
    ]  # relative, one a column of the quantity; infinite where the method gives no value
    assembly: tuple[float, ...]  # s, of every run
    solve: tuple[float, ...]  # s, of every run

    @property
    def error(self) -> float:
        """The largest error over all columns of the quantity."""
        return max(self.errors)

    @property
    def total(self) -> Spread:
        """Assembly and solve of every run together."""
        return Spread.of([a + b for a, b in zip(self.assembly, self.solve, strict=True)])


@dataclass(frozen=True)
class TimedQuantity:
    """A quantity, computed in many ways."""

    key: str  # a stable identifier
    title: str
    meaning: str  # what the error is of and relative to, in sentences
    reference: str  # in sentences
    bound: float  # estimated error of the reference itself, relative
    highest: float  # Hz, up to which the quantity was compared
    columns: tuple[str, ...]  # what each of the errors of a row is of
    rows: tuple[TimedRow, ...]
    remarks: tuple[str, ...] = ()  # what was not run, and why


@dataclass(frozen=True)
class Timings:
    """Everything that the study of run times found."""

    tolerance: float  # relative
    quantities: tuple[TimedQuantity, ...]
    remarks: tuple[str, ...]
    rounds: int  # in which every method had its turn
    machine: tuple[tuple[str, str], ...]


def fastest(rows: Sequence[TimedRow], tolerance: float) -> TimedRow | None:
    """Return the row of the least median time among those whose error keeps the tolerance; None where none does."""
    kept = [row for row in rows if row.error <= tolerance]
    return min(kept, key=lambda row: (row.total.median, row.error), default=None)


def unbeaten(rows: Sequence[TimedRow], bound: float = 0.0) -> tuple[TimedRow, ...]:
    """Return the Pareto set by rising time: each is more accurate than all that are faster.

    Errors below the `bound` of the reference are equal, and so are those that differ by less than NOTICEABLE.
    """
    rows_kept = []
    lowest = math.inf
    for row in sorted(rows, key=lambda row: (row.total.median, row.error)):
        error = max(row.error, bound)
        if error < lowest * (1.0 - NOTICEABLE):
            rows_kept.append(row)
            lowest = error
    return tuple(rows_kept)


@dataclass(frozen=True)
class Candidate:
    """One way to compute a quantity, a model with a discretisation or a method, in two steps that are timed apart."""

    curve: str  # candidates of one method are one curve, ever finer
    division: str  # in words
    size: int  # segments, elements or pieces of a shaft
    assemble: Callable[[], Any]
    solve: Callable[[Any], Any]  # of what was assembled
    errors: Callable[[Any], tuple[float, ...]]  # of the answer, relative


@dataclass(frozen=True, kw_only=True)
class Pace:
    """How often candidates are run."""

    rounds: int  # in which every candidate has its turn
    seconds: float = 0.0  # rounds go on until so long
    longest: float = inf  # s of one run, after which a curve has no finer discretisation
    runs: int = 5  # at most, while it has its turn
    turn: float = 0.01  # s, filled with runs of a fast candidate
    slow: float = 0.3  # s of one run, from which a candidate has its turn in `slow_rounds` alone
    slow_rounds: int = 3  # 0: the run that warms up is its only sample
    clock: Callable[[], float] = perf_counter


@dataclass(frozen=True, kw_only=True)
class Effort(Pace):
    """How much is run."""

    segments: int  # lumped, most a shaft
    unknowns: int  # of finite elements, most a shaft: degree times elements
    degrees: tuple[int, ...]
    speeds: int


FULL = Effort(
    rounds=7,
    longest=1.5,
    segments=1024,
    unknowns=128,
    degrees=tuple(range(1, 11)),
    speeds=25,
)
QUICK = Effort(
    rounds=3,
    longest=0.3,
    segments=256,
    unknowns=24,
    degrees=(1, 2, 4, 8),
    speeds=9,
)


@dataclass
class _Trial:
    candidate: Candidate
    errors: tuple[float, ...]
    first: tuple[float, float]  # s, assembly and solve of the run that warmed up
    runs: list[tuple[float, float]] = field(default_factory=list)  # the same of all others


def timed(
    curves: Sequence[Sequence[Candidate]], pace: Pace, what: str = "", progress: Progress = silent
) -> tuple[tuple[TimedRow, ...], tuple[str, ...]]:
    """Return the rows of all curves, and what was not run, in words.

    Each candidate is run once for its errors, which warms up as well; then all have their turn in every round. A curve
    ends where a run takes longer than `pace.longest` or where two discretisations in a row err by rounding alone.
    """
    trials = []
    remarks = []
    for number, curve in enumerate(curves):
        progress(f"{what}: errors", 0.3 * number / len(curves))
        of_curve = []
        for candidate in curve:
            try:
                answer, *first = run(candidate, pace.clock)
                if sum(first) > pace.longest:  # the first run of all loads what a method needs
                    answer, *first = run(candidate, pace.clock)
            except (SolveError, np.linalg.LinAlgError) as error:
                remarks.append(f"{candidate.curve}, {candidate.division}: {error}")
                break
            of_curve.append(_Trial(candidate, candidate.errors(answer), (first[0], first[1])))
            unrun = len(curve) - len(of_curve)
            remark = f"{candidate.curve}: finer discretisations are not run ({unrun}), as "
            if unrun and sum(first) > pace.longest:
                remarks.append(f"{remark}one run of {candidate.division} takes {sum(first):.2g} s.")
                break
            last_two = of_curve[-2:]
            if unrun and len(last_two) > 1 and all(max(t.errors) < ROUNDING for t in last_two):
                remarks.append(f"{remark}only rounding is left.")
                break
        trials += of_curve

    start = pace.clock()
    turn = 0
    while turn < pace.rounds or pace.clock() - start < pace.seconds:
        turning = [
            trial for trial in trials if turn < pace.slow_rounds or sum(trial.first) <= pace.slow
        ]
        if not turning:
            break
        gc.collect()
        for number, trial in enumerate(turning):
            share = (turn + number / len(turning)) / pace.rounds
            progress(f"{what}: times", min(0.3 + 0.7 * share, 1.0))
            # A fast candidate runs as often as fits into its turn.
            fitting = int(pace.turn / max(sum(trial.first), 1e-9))
            for _ in range(max(1, min(pace.runs, fitting))):
                trial.runs.append(run(trial.candidate, pace.clock)[1:])
        turn += 1
    rows = []
    for trial in trials:  # of all runs, or of the first alone if there is no other
        assembly, solve = zip(*trial.runs or [trial.first], strict=True)
        of = trial.candidate
        rows.append(TimedRow(of.curve, of.division, of.size, trial.errors, assembly, solve))
    return tuple(rows), tuple(remarks)


def run(
    candidate: Candidate, clock: Callable[[], float] = perf_counter
) -> tuple[Any, float, float]:
    """Return the answer, and seconds of assembly and solve; no garbage is collected meanwhile."""
    was = gc.isenabled()
    gc.disable()
    try:
        start = clock()
        assembled = candidate.assemble()
        between = clock()
        answer = candidate.solve(assembled)
        return answer, between - start, clock() - between
    finally:
        if was:
            gc.enable()
