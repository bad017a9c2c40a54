"""Torques over time as sums of pieces, each a ramp times an exponential, and cut at the times where one begins or ends.

>>> ramp = Piece(0.0, 2.0, 1.0, 3.0)  # 1 N m at 0 s, 7 N m at 2 s, nothing afterwards
>>> value([ramp], np.array([0.0, 1.0, 2.5])).tolist()
[1.0, 4.0, 0.0]
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Piece:
    """Re (level + slope * t) exp(rate * t) for begin <= time < end, t = time - begin."""

    begin: float  # s
    end: float  # s, may be infinite
    level: complex  # N m at its begin
    slope: complex = 0.0  # N m/s
    rate: complex = 0.0  # 1/s


@dataclass(eq=False)
class Acting:
    """Terms (level + slope t) exp(rate t) of loads that act together, t from the begin of an interval: each (terms,).

    by_rate: every rate with its terms, and 2 where one of them has a slope, else 1. kind: the same for terms that differ
    in levels and slopes alone.
    """

    load: IntArray
    level: ComplexArray  # N m
    slope: ComplexArray  # N m/s
    rate: ComplexArray  # 1/s

    def __post_init__(self) -> None:
        self.by_rate = list[tuple[complex, IntArray, int]]()
        for rate in dict.fromkeys(self.rate.tolist()):
            terms = np.flatnonzero(self.rate == rate)
            self.by_rate.append((rate, terms, 1 + int(self.slope[terms].any())))
        counts = (count for *_, count in self.by_rate)
        self.kind = (*self.load.tolist(), *self.rate.tolist(), *counts)

    def later(self, since: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Levels and slopes (terms, times) as they are counted from times since the begin of the interval (s)."""
        growth = np.exp(np.multiply.outer(self.rate, since))
        slope = self.slope[:, None]
        return (self.level[:, None] + slope * since) * growth, slope * growth


@dataclass(frozen=True)
class History:
    """The torques of loads over time, by intervals throughout which the same pieces act."""

    begin: FloatArray  # (intervals,) s, ascending from 0
    acting: tuple[Acting, ...]  # in each interval


def value(pieces: Iterable[Piece], time: FloatArray) -> FloatArray:
    """(times,) N m, the sum of the pieces."""
    total = np.zeros(len(time))
    for piece in pieces:
        inside = (time >= piece.begin) & (time < piece.end)
        late = time[inside] - piece.begin
        total[inside] += np.real((piece.level + piece.slope * late) * np.exp(piece.rate * late))
    return total


def history(loads: Sequence[Sequence[Piece]]) -> History:
    """The pieces of every load, cut where any of them begins or ends."""
    ends = {end for pieces in loads for piece in pieces for end in (piece.begin, piece.end)}
    begin = np.unique([0.0, *(end for end in ends if 0.0 < end < math.inf)])
    intervals = [dict[tuple[int, complex], ComplexArray]() for _ in begin]
    for load, pieces in enumerate(loads):
        for piece in pieces:
            first, last = np.searchsorted(begin, (max(piece.begin, 0.0), piece.end)).tolist()
            for start, sums in zip(begin[first:last].tolist(), intervals[first:last], strict=True):
                late, rate = start - piece.begin, complex(piece.rate)
                both = np.array([piece.level + piece.slope * late, piece.slope], dtype=complex)
                both *= np.exp(rate * late)
                terms = [(rate, both)]
                if both.imag.any() or rate.imag:  # its real part: half of it and its conjugate
                    terms = [(rate, both / 2.0), (rate.conjugate(), both.conj() / 2.0)]
                for term_rate, term in terms:
                    sums.setdefault((load, term_rate), np.zeros(2, dtype=complex))
                    sums[load, term_rate] += term
    acting = []
    for sums in intervals:
        load_of, rate_of = (np.array([key[k] for key in sums]) for k in (0, 1))
        level, slope = np.array(list(sums.values())).reshape(-1, 2).T
        acting.append(Acting(load_of.astype(np.int64), level, slope, rate_of.astype(complex)))
    return History(begin, tuple(acting))
