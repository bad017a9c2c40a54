"""What is reported of a train with very long shafts: groups of many segments in place of each segment."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsion.assembly.system import System
from torsion.kernels.tree import FloatArray, IntArray


@dataclass(frozen=True)
class SegmentGroups:
    """The stations and spans that are reported; all but the shafts that are too long are reported whole.

    Of a group of segments its outer station and its first span are reported; sums are over the group.
    """

    system: System
    first_station: IntArray  # (reported stations,) position of the first of each group
    first_span: IntArray  # (reported spans,)
    longest: int  # segments in a group

    @property
    def stations(self) -> IntArray:
        """(reported stations,) their positions in the system."""
        return np.append(self.first_station[1:], len(self.system.stations)) - 1

    @property
    def spans(self) -> IntArray:
        """(reported spans,) their positions in the system."""
        return self.first_span

    @property
    def last_span(self) -> IntArray:
        """(reported spans,) position of the last of each group."""
        return np.append(self.first_span, len(self.system.spans))[1:] - 1

    @property
    def is_whole(self) -> bool:
        """Nothing is left out."""
        return self.longest == 1

    @property
    def ends(self) -> IntArray:
        """(reported spans, 2) driving and driven station of each reported span or group, as positions in `stations`."""
        both = np.column_stack([self.system.driving[self.first_span], self.system.driven[self.last_span]])
        return np.asarray(np.searchsorted(self.stations, both), dtype=np.int64)

    def names(self) -> list[str]:
        """(reported spans,) names; of a group with its first and its last segment."""
        spans = self.system.spans
        return [
            spans[a].name if a == b else f"{spans[a].name[:-1]}..{spans[b].name.rpartition('[')[2]}"
            for a, b in zip(self.first_span.tolist(), self.last_span.tolist(), strict=True)
        ]

    def over_stations(self, values: FloatArray) -> FloatArray:
        """Sums over groups of values (stations, ...)."""
        return values if self.is_whole else np.add.reduceat(values, self.first_station, axis=0)

    def over_spans(self, values: FloatArray) -> FloatArray:
        """Sums over groups of values (spans, ...)."""
        return values if self.is_whole else np.add.reduceat(values, self.first_span, axis=0)

    def place(self, spans: list[int]) -> list[int]:
        """Positions among the reported spans of told `spans` of the system."""
        return [int(place) for place in np.searchsorted(self.first_span, spans)]


def grouped(system: System, most: int) -> SegmentGroups:
    """At most about `most` groups of segments of every shaft; its last segment is one of its own."""
    stations, spans, longest = [_upto(system.own_stations)], [_upto(len(system.own_spans))], 1
    station, span = system.own_stations, len(system.own_spans)
    for row in system.rows:
        step = 1 if row.number <= most else -(-(row.number - 1) // most)
        starts = np.arange(0, row.number - 1, step, dtype=np.int64)
        stations.append(station + starts)
        spans.append(span + np.append(starts, row.number - 1))
        station, span, longest = station + row.number - 1, span + row.number, max(longest, step)
    return SegmentGroups(system, np.concatenate(stations), np.concatenate(spans), longest)


def _upto(number: int) -> NDArray[np.int64]:
    return np.arange(number, dtype=np.int64)
