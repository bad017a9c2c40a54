"""Error against run time: what was measured of every method, which methods no other beats, and which to take."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

NOTICEABLE = 0.01  # relative: of two errors that differ by less neither is the smaller
LEAST_SAMPLES = 2  # that have a spread


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
        """Of at least one run."""
        low, middle, high = (float(value) for value in np.quantile(samples, [0.25, 0.5, 0.75]))
        return cls(min(samples), low, middle, high, len(samples))


@dataclass(frozen=True)
class TimedRow:
    """One method with one division of the shafts: its errors and its repeated runs."""

    curve: str  # the method; rows of one method are one curve
    division: str  # in words
    size: int  # segments, elements or pieces of a shaft, or modes
    errors: tuple[float, ...]  # relative, one a column of the quantity; infinite where the method gives no value
    assembly: tuple[float, ...]  # s, of every run
    solve: tuple[float, ...]  # s, of every run

    @property
    def error(self) -> float:
        """The worst of its errors."""
        return max(self.errors)

    @property
    def total(self) -> Spread:
        """Assembly and solve of every run together."""
        return Spread.of([a + b for a, b in zip(self.assembly, self.solve, strict=True)])

    @property
    def assembly_spread(self) -> Spread:
        """Of the runs' assemblies."""
        return Spread.of(self.assembly)

    @property
    def solve_spread(self) -> Spread:
        """Of the runs' solves."""
        return Spread.of(self.solve)


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
    """The row of the least median time among those whose error keeps the tolerance; None where none does."""
    kept = [row for row in rows if row.error <= tolerance]
    return min(kept, key=lambda row: (row.total.median, row.error), default=None)


def as_fast(rows: Sequence[TimedRow], tolerance: float) -> tuple[TimedRow, ...]:
    """The other rows that keep the tolerance and whose middle half of runs overlaps that of the fastest."""
    best = fastest(rows, tolerance)
    if best is None or best.total.runs < LEAST_SAMPLES:
        return ()
    limit = best.total.three_quarters
    return tuple(row for row in rows if row is not best and row.error <= tolerance and row.total.quarter <= limit)


def unbeaten(rows: Sequence[TimedRow], bound: float = 0.0) -> tuple[TimedRow, ...]:
    """The Pareto set by rising time: each is more accurate than all that are faster.

    Errors below the `bound` of the reference are equal, and so are those that differ by less than NOTICEABLE.
    """
    found, least = [], math.inf
    for row in sorted(rows, key=lambda row: (row.total.median, row.error)):
        error = max(row.error, bound)
        if error < least * (1.0 - NOTICEABLE):
            found.append(row)
            least = error
    return tuple(found)
