"""Spans of a train, and the shafts in segments with the groups that stand for many of them."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.arrays import FloatArray, IntArray
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
    number: int  # of segments, or of groups of them
    inside: int  # position of the first station between segments
    begin: Station  # at the driving end
    edges: tuple[
        int, ...
    ] = ()  # of a row of segment groups: the first segment of each group, and their whole number

    def station(self, k: int) -> Station:
        """The station at the end of segment, or group, k."""
        label = f"{self.edges[k + 1]}/{self.edges[-1]}" if self.edges else f"{k + 1}/{self.number}"
        return Station(
            f"{self.bar.name} {label}", self.bar.part, self.begin.ratio, self.begin.sense
        )

    def span(self, k: int) -> Span:
        first, last = (self.edges[k] + 1, self.edges[k + 1]) if self.edges else (k + 1, k + 1)
        label = f"{first}" if first == last else f"{first}..{last}"
        name = self.bar.name if self.number == 1 else f"{self.bar.name} [{label}]"
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
class SegmentGroups:
    """The stations and spans that stand for all of a system; all but the shafts of too many segments are kept whole.

    Of a group of segments its outer station and its first span stand for it; sums are over the group.
    """

    stations: IntArray  # (stations kept,) their positions in the system
    spans: IntArray  # (spans kept,) likewise
    kept: tuple[Span, ...]  # (spans kept,) every span or group, between positions in `stations`
    longest: int  # segments in a group

    @property
    def first_station(self) -> IntArray:
        """(stations kept,) position of the first of each group."""
        return np.append(0, self.stations[:-1] + 1)

    @property
    def ends(self) -> IntArray:
        """(spans kept, 2) driving and driven station of each span or group, as positions in `stations`."""
        return np.array(
            [(span.driving, span.driven) for span in self.kept], dtype=np.int64
        ).reshape(-1, 2)

    @property
    def is_whole(self) -> bool:
        """Whether no segments are joined to groups."""
        return self.longest == 1

    def names(self) -> list[str]:
        """(spans kept,) names; of a group with its first and its last segment."""
        return [span.name for span in self.kept]

    def over_stations(self, values: FloatArray) -> FloatArray:
        """Sums over groups of values (stations, ...)."""
        return values if self.is_whole else np.add.reduceat(values, self.first_station, axis=0)

    def over_spans(self, values: FloatArray) -> FloatArray:
        """Sums over groups of values (spans, ...)."""
        return values if self.is_whole else np.add.reduceat(values, self.spans, axis=0)

    def place(self, spans: list[int]) -> list[int]:
        """Positions among the spans kept of some `spans` of the system that are kept."""
        return [int(position) for position in np.searchsorted(self.spans, spans)]
