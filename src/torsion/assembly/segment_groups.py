"""Segment groups: what stands for the segments of shafts that have too many to report each.

A condensed system has groups in place of segments. Between its ends a group is exactly the chain of its segments, so
that angles and torques at its ends are those of the whole system.
"""

from dataclasses import replace

import numpy as np

from torsion.assembly.spans import Row, Runs, SegmentGroups
from torsion.assembly.system import System

MOST_GROUPS = 2000  # of a shaft: more segments than that are condensed to about so many groups


def segment_groups(system: System, most: int) -> SegmentGroups:
    """At most about `most` groups of every shaft; its last segment is one of its own."""
    station, span, inside, longest = system.own_stations, len(system.own_spans), system.own_stations, 1
    stations, spans, rows = [np.arange(station)], [np.arange(span)], list[Row]()
    for row in system.rows:
        step = 1 if row.number <= most else -(-(row.number - 1) // most)
        starts = np.append(np.arange(0, row.number - 1, step), row.number - 1)
        stations.append(station - 1 + starts[1:])
        spans.append(span + starts)
        edges = (*starts.tolist(), row.number)
        whole = tuple(row.edges[edge] for edge in edges) if row.edges else edges
        rows.append(Row(row.bar, len(starts), inside, row.begin, whole))
        station, span, inside = station + row.number - 1, span + row.number, inside + len(starts) - 1
        longest = max(longest, step)
    kept = Runs(system.own_spans, [(row.number, row.span) for row in rows])
    return SegmentGroups(np.concatenate(stations), np.concatenate(spans), kept, tuple(rows), len(system.spans), longest)


def condensed(system: System, most: int = MOST_GROUPS) -> System:
    """The system with groups in place of the segments of its long shafts; itself where it has none, or closed loops.

    Inertia and flexibility of a group are reported as sums. The whole system stays at hand as `uncondensed`.
    """
    groups = segment_groups(system, most)
    if groups.is_whole or system.bars is not None or system.condensed.extra.size:
        return system
    stations = Runs(system.stations[: system.own_stations], [(row.number - 1, row.station) for row in groups.rows])
    return replace(
        system, groups=groups, uncondensed=system, rows=groups.rows, stations=stations, spans=groups.kept,
        inertia=groups.over_stations(system.inertia), flexibility=groups.over_spans(system.flexibility),
        viscous=system.viscous[groups.spans], loss_factor=system.loss_factor[groups.spans],
    )  # fmt: skip
