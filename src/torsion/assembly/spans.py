"""Spans, and the stations and spans of a train; those inside of a shaft in segments are made when they are read."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar, overload

import numpy as np

from torsion.arrays import IntArray
from torsion.primitives import Bar, Station

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Span:
    """An elastic or rigid piece between two stations, or a mesh or joint."""

    name: str
    part: int
    driving: int
    driven: int
    ratio: Fraction = Fraction(1)  # speed of the driven / speed of the driving station
    error: tuple[tuple[int, complex], ...] = ()  # of the driven angle, over the driving station's angle


@dataclass(frozen=True, slots=True)
class Row:
    """A shaft in segments: the rule for the stations between them and for their spans."""

    bar: Bar
    number: int  # of segments, or of groups of them
    inside: int  # position of the first station between segments
    begin: Station  # at the driving end
    edges: tuple[int, ...] = ()  # of a row of segment groups: the first segment of each group, and their whole number

    def station(self, k: int) -> Station:
        """The station at the end of segment, or group, k."""
        place = f"{self.edges[k + 1]}/{self.edges[-1]}" if self.edges else f"{k + 1}/{self.number}"
        return Station(f"{self.bar.name} {place}", self.bar.part, self.begin.ratio, self.begin.sense)

    def span(self, k: int) -> Span:
        """Segment, or group, k."""
        first, last = (self.edges[k] + 1, self.edges[k + 1]) if self.edges else (k + 1, k + 1)
        place = f"{first}" if first == last else f"{first}..{last}"
        name = self.bar.name if self.number == 1 else f"{self.bar.name} [{place}]"
        driving = self.bar.driving if k == 0 else self.inside + k - 1
        return Span(name, self.bar.part, driving, self.bar.driven if k == self.number - 1 else self.inside + k)

    @property
    def stations(self) -> IntArray:
        """(number + 1,) positions of all stations, from the driving to the driven one."""
        ends = np.arange(self.inside - 1, self.inside + self.number, dtype=np.int64)
        ends[0], ends[-1] = self.bar.driving, self.bar.driven
        return ends


class Runs(Sequence[T]):
    """Things one after another: a `head` that is there, then runs of so many that a rule makes one by one."""

    def __init__(self, head: Sequence[T], runs: Sequence[tuple[int, Callable[[int], T]]]) -> None:
        self.head, self._runs = tuple(head), tuple(runs)
        self._size = len(self.head) + sum(number for number, _ in self._runs)

    def __len__(self) -> int:
        return self._size

    def __iter__(self) -> Iterator[T]:
        yield from self.head
        for number, made in self._runs:
            yield from map(made, range(number))

    @overload
    def __getitem__(self, at: int) -> T: ...
    @overload
    def __getitem__(self, at: slice) -> tuple[T, ...]: ...
    def __getitem__(self, at: int | slice) -> T | tuple[T, ...]:
        if isinstance(at, slice):
            return tuple(self._at(k) for k in range(*at.indices(self._size)))
        place = at + self._size if at < 0 else at
        if not 0 <= place < self._size:
            raise IndexError(f"position {at} of {self._size}")
        return self._at(place)

    def _at(self, place: int) -> T:
        if place < len(self.head):
            return self.head[place]
        place -= len(self.head)
        for number, made in self._runs:
            if place < number:
                return made(place)
            place -= number
        raise IndexError(place)
