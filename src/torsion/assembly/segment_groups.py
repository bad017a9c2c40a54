"""Segment groups: what stands for the segments of shafts that have too many to report each.

A condensed system has groups in place of segments. Between its ends a group is exactly the chain of its segments, so
that angles and torques at its ends are those of the whole system.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.spans import Row, Runs
from torsion.assembly.system import System

if TYPE_CHECKING:
    from torsion.kernels.distributed.segment_chains import SegmentChains

MOST_GROUPS = 2000  # of a shaft: more segments than that are condensed to about so many groups


@dataclass(frozen=True)
class SegmentGroups:
    """The stations and spans that stand for all of a system; all but the shafts of too many segments are kept whole.

    Of a group of segments its outer station and its first span stand for it; sums are over the group.
    """

    system: System
    first_station: IntArray  # (stations kept,) position of the first of each group
    first_span: IntArray  # (spans kept,)
    longest: int  # segments in a group

    @property
    def stations(self) -> IntArray:
        """(stations kept,) their positions in the system."""
        return np.append(self.first_station[1:], len(self.system.stations)) - 1

    @property
    def spans(self) -> IntArray:
        """(spans kept,) their positions in the system."""
        return self.first_span

    @property
    def last_span(self) -> IntArray:
        """(spans kept,) position of the last of each group."""
        return np.append(self.first_span, len(self.system.spans))[1:] - 1

    @property
    def is_whole(self) -> bool:
        """Nothing is left out."""
        return self.longest == 1

    @property
    def ends(self) -> IntArray:
        """(spans kept, 2) driving and driven station of each span or group, as positions in `stations`."""
        both = np.column_stack([self.system.driving[self.first_span], self.system.driven[self.last_span]])
        return np.asarray(np.searchsorted(self.stations, both), dtype=np.int64)

    def names(self) -> list[str]:
        """(spans kept,) names; of a group with its first and its last segment."""
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
        """Positions among the spans kept of some `spans` of the system that are kept."""
        return [int(place) for place in np.searchsorted(self.first_span, spans)]

    def chains(self, spans: IntArray, ratio: FloatArray) -> "SegmentChains":
        """The segments of the groups at `spans` (groups,) of those kept, referred by their speed ratio (groups,)."""
        from torsion.kernels.distributed.segment_chains import SegmentChains

        first, last = self.first_span[spans], self.last_span[spans]
        segment = first[:, None] + np.arange(self.longest)
        there = segment <= last[:, None]
        segment = np.minimum(segment, last[:, None])
        flexibility = np.where(there, self.system.flexibility[segment] / ratio[:, None] ** 2, 0.0)
        inside = self.system.lumped_inertia[self.system.driven[segment]] * ratio[:, None] ** 2
        none = np.zeros(len(spans), dtype=bool)
        return SegmentChains(flexibility, np.where(segment < last[:, None], inside, 0.0), none)


def segment_groups(system: System, most: int) -> SegmentGroups:
    """At most about `most` groups of every shaft; its last segment is one of its own."""
    stations, spans, longest = [_upto(system.own_stations)], [_upto(len(system.own_spans))], 1
    station, span = system.own_stations, len(system.own_spans)
    for row in system.rows:
        starts = _starts(row, most)
        stations.append(station + starts[:-1])
        spans.append(span + starts)
        step = int(starts[1]) if row.number > 1 else 1
        station, span, longest = station + row.number - 1, span + row.number, max(longest, step)
    return SegmentGroups(system, np.concatenate(stations), np.concatenate(spans), longest)


def _starts(row: Row, most: int) -> IntArray:
    """(groups,) the first segment of each."""
    step = 1 if row.number <= most else -(-(row.number - 1) // most)
    return np.append(np.arange(0, row.number - 1, step, dtype=np.int64), row.number - 1)


def _upto(number: int) -> IntArray:
    return np.arange(number, dtype=np.int64)


def condensed(system: System, most: int = MOST_GROUPS) -> System:
    """The system with groups in place of the segments of its long shafts; itself where it has none, or closed loops.

    Inertia and flexibility of a group are reported as sums. The whole system stays at hand in `groups.system`.
    """
    groups = segment_groups(system, most)
    if groups.is_whole or system.bars is not None or system.condensed.extra.size:
        return system
    rows, inside = [], system.own_stations
    for row in system.rows:
        edges = (*_starts(row, most).tolist(), row.number)
        rows.append(Row(row.bar, len(edges) - 1, inside, row.begin, edges))
        inside += len(edges) - 2
    return replace(
        system, groups=groups, rows=tuple(rows),
        stations=Runs(system.stations[: system.own_stations], [(row.number - 1, row.station) for row in rows]),
        spans=Runs(system.own_spans, [(row.number, row.span) for row in rows]),
        inertia=groups.over_stations(system.inertia), flexibility=groups.over_spans(system.flexibility),
        viscous=system.viscous[groups.spans], loss_factor=system.loss_factor[groups.spans],
    )  # fmt: skip
