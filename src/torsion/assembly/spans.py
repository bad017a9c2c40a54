"""Spans of a train, and the shafts in segments with the groups that stand for many of them."""

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.shafts import area_along
from torsion.primitives import Bar, Station


@dataclass(frozen=True, slots=True)
class Span:
    """An elastic or rigid piece between two stations, or a mesh or joint."""

    name: str
    part: int
    driving: int
    driven: int
    ratio: Fraction = Fraction(1)  # speed of the driven / speed of the driving station
    error: tuple[
        tuple[int, complex], ...
    ] = ()  # of the driven angle, over the driving station's angle


@dataclass(frozen=True, slots=True)
class Row:
    """A shaft in segments: the rule for the stations between them and for their spans."""

    bar: Bar
    number: int  # of segments
    inside: int  # position of the first station between segments
    begin: Station  # at the driving end

    @property
    def inner_stations(self) -> list[Station]:
        """Stations at the ends of all segments but the last."""
        part, begin = self.bar.part, self.begin
        names = (f"{self.bar.name} {k}/{self.number}" for k in range(1, self.number))
        return [Station(name, part, begin.ratio, begin.sense) for name in names]

    @property
    def spans(self) -> list[Span]:
        """Segments, from the driving to the driven end."""
        name, count = self.bar.name, self.number
        names = [name] if count == 1 else [f"{name} [{k}]" for k in range(1, count + 1)]
        ends = pairwise(self.stations.tolist())
        return [Span(name, self.bar.part, *pair) for name, pair in zip(names, ends, strict=True)]

    @property
    def stations(self) -> IntArray:
        """(number + 1,) positions of all stations, from the driving to the driven one."""
        ends = np.arange(self.inside - 1, self.inside + self.number, dtype=np.int64)
        ends[0], ends[-1] = self.bar.driving, self.bar.driven
        return ends


@dataclass(frozen=True)
class Piece:
    """A part of a shaft with distributed inertia: the one of the given position among so many of equal length."""

    bar: Bar
    position: int
    number: int

    @property
    def length(self) -> float:
        return self.bar.length / self.number

    def polar_area_moment(self, x: FloatArray) -> FloatArray:
        """Return I_p in m4 at `x`, from 0 at the driving to 1 at the driven end of the piece."""
        return area_along(self.bar, (self.position + x) / self.number)
