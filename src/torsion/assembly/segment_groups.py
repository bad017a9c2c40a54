"""Segment groups: what stands for the segments of shafts that have too many to report each.

A condensed system has groups in place of segments. Between its ends a group is exactly the chain of its segments, so
that angles and torques at its ends are those of the whole system.
"""

from dataclasses import replace

import numpy as np

from torsion.arrays import IntArray
from torsion.assembly.spans import Row, Runs, SegmentGroups
from torsion.assembly.system import System

MOST_GROUPS = 2000  # of a shaft: more segments than that are condensed to about so many groups


def segment_groups(system: System, most: int) -> SegmentGroups:
    """At most about `most` groups of every shaft; its last segment is one of its own."""
    station, span, longest = system.own_stations, len(system.own_spans), 1
    stations, spans = [np.arange(station)], [np.arange(span)]
    for row in system.rows:
        starts = _starts(row, most)
        stations.append(station - 1 + starts[1:])
        spans.append(span + starts)
        longest = max(longest, int(starts[1]) if row.number > 1 else 1)
        station, span = station + row.number - 1, span + row.number
    station_kept, span_kept = np.concatenate(stations), np.concatenate(spans)
    last = np.append(span_kept, len(system.spans))[1:] - 1
    ends = np.searchsorted(station_kept, np.column_stack([system.driving[span_kept], system.driven[last]]))
    return SegmentGroups(system.spans, station_kept, span_kept, ends, longest)


def _starts(row: Row, most: int) -> IntArray:
    """(groups,) the first segment of each."""
    step = 1 if row.number <= most else -(-(row.number - 1) // most)
    return np.append(np.arange(0, row.number - 1, step, dtype=np.int64), row.number - 1)


def condensed(system: System, most: int = MOST_GROUPS) -> System:
    """The system with groups in place of the segments of its long shafts; itself where it has none, or closed loops.

    Inertia and flexibility of a group are reported as sums. The whole system stays at hand as `uncondensed`.
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
        system, groups=groups, uncondensed=system, rows=tuple(rows),
        stations=Runs(system.stations[: system.own_stations], [(row.number - 1, row.station) for row in rows]),
        spans=Runs(system.own_spans, [(row.number, row.span) for row in rows]),
        inertia=groups.over_stations(system.inertia), flexibility=groups.over_spans(system.flexibility),
        viscous=system.viscous[groups.spans], loss_factor=system.loss_factor[groups.spans],
    )  # fmt: skip
