"""Torques over time as sums of pieces, each a ramp times an exponential, and cut at the times where one begins or ends.

>>> ramp = Piece(0.0, 2.0, 1.0, 3.0)  # 1 N m at 0 s, 7 N m at 2 s, nothing afterwards
>>> value([ramp], np.array([0.0, 1.0, 2.5])).tolist()
[1.0, 4.0, 0.0]
"""

import cmath
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Piece:
    """Re (level + slope * t) exp(rate * t) for begin <= time < end, t = time - begin."""

    begin: float  # s
    end: float  # s, may be infinite
    level: complex  # N m at its begin
    slope: complex = 0.0  # N m/s
    rate: complex = 0.0  # 1/s

    def moved(self, begin: float) -> "Piece":
        """The same from a later begin."""
        late = begin - self.begin
        factor = cmath.exp(self.rate * late)
        level = (self.level + self.slope * late) * factor
        return replace(self, begin=begin, level=level, slope=self.slope * factor)


@dataclass(frozen=True, slots=True)
class Term:
    """(level + slope * t) exp(rate * t) of one load, t from the begin of an interval; no real part is taken."""

    load: int
    level: complex
    slope: complex
    rate: complex


@dataclass(frozen=True)
class History:
    """The torques of loads over time, by intervals throughout which the same pieces act."""

    begin: FloatArray  # (intervals,) s, ascending from 0
    terms: tuple[tuple[Term, ...], ...]  # of each interval


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
    terms: list[list[Term]] = [[] for _ in begin]
    for load, pieces in enumerate(loads):
        for piece in pieces:
            first, last = np.searchsorted(begin, (max(piece.begin, 0.0), piece.end)).tolist()
            for interval in range(first, last):
                terms[interval] += _complex_terms(load, piece.moved(float(begin[interval])))
    return History(begin, tuple(map(tuple, terms)))


def _complex_terms(load: int, piece: Piece) -> tuple[Term, ...]:
    """Terms whose sum is the real part of the piece: itself where it is real, else half of it and its conjugate."""
    level, slope, rate = complex(piece.level), complex(piece.slope), complex(piece.rate)
    if not (level.imag or slope.imag or rate.imag):
        return (Term(load, level, slope, rate),)
    half = Term(load, level / 2.0, slope / 2.0, rate)
    return half, Term(load, half.level.conjugate(), half.slope.conjugate(), rate.conjugate())
