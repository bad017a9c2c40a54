"""Spans of a train, and the shafts in segments with the groups that stand for many of them."""

from dataclasses import dataclass
from fractions import Fraction

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

    def station(self, k: int) -> Station:
        """The station at the end of segment k."""
        name = f"{self.bar.name} {k + 1}/{self.number}"
        return Station(name, self.bar.part, self.begin.ratio, self.begin.sense)

    def span(self, k: int) -> Span:
        name = self.bar.name if self.number == 1 else f"{self.bar.name} [{k + 1}]"
        driving = self.bar.driving if k == 0 else self.inside + k - 1
        return Span(
            name,
            self.bar.part,
            driving,
            self.bar.driven if k == self.number - 1 else self.inside + k,
        )

    @property
    def inner_stations(self) -> list[Station]:
        return [self.station(k) for k in range(self.number - 1)]

    @property
    def spans(self) -> list[Span]:
        """Segments, from the driving to the driven end."""
        return [self.span(k) for k in range(self.number)]

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
