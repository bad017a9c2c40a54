"""Which spans make a forest of a train, and the way over its stations from the roots to the leaves, breadth first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, IntArray


@dataclass(frozen=True)
class Walk:
    """Stations as they are met; `parent` and `above` are -1 at a root."""

    order: IntArray  # (stations,)
    parent: IntArray  # (stations,) of each station
    above: IntArray  # (stations,) the span each station was reached by


def walk(
    number: int, driving: IntArray, driven: IntArray, chosen: BoolArray, roots: list[int]
) -> Walk:
    """Breadth first from one of `roots`, else from the first station, of every separate part, over `chosen` spans."""
    near: list[list[tuple[int, int]]] = [[] for _ in range(number)]
    for span in np.flatnonzero(chosen).tolist():
        a, b = int(driving[span]), int(driven[span])
        near[a].append((b, span))
        near[b].append((a, span))
    parent, above, order = [-1] * number, [-1] * number, list[int]()
    seen = [False] * number
    for root in [station for station in roots if near[station]] + list(range(number)):
        part = [] if seen[root] else [root]
        seen[root] = True
        for parent_station in part:
            for neighbour, span in near[parent_station]:
                if not seen[neighbour]:
                    seen[neighbour], parent[neighbour], above[neighbour] = (
                        True,
                        parent_station,
                        span,
                    )
                    part.append(neighbour)
        order += part
    return Walk(*(np.array(values, dtype=np.int64) for values in (order, parent, above)))


def connected(number: int, driving: IntArray, driven: IntArray) -> IntArray:
    """(stations,) the first of all stations that spans join to each."""
    first = np.arange(number)
    while len(driving):
        a, b = first[driving], first[driven]
        is_separate = a != b
        driving = driving[is_separate]
        driven = driven[is_separate]
        a = a[is_separate]
        b = b[is_separate]
        np.minimum.at(first, np.maximum(a, b), np.minimum(a, b))
        while np.any(first[first] != first):
            first = first[first]
    return first


def closing_no_loop(
    number: int, driving: IntArray, driven: IntArray, ranked: IntArray, joined: Sequence[int] = ()
) -> BoolArray:
    """(spans,) the spans that make a forest, taken in the order `ranked` (Kruskal 1956); stations of `one` are joined.

    Taken from the stiffest on, what is left closes each loop at its softest span.
    """
    group, chosen = list(range(number)), np.zeros(len(driving), dtype=bool)
    for station in joined:
        group[station] = joined[0]

    def root(a: int) -> int:
        while group[a] != a:
            group[a] = group[group[a]]
            a = group[a]
        return a

    for span in ranked.tolist():
        a, b = root(int(driving[span])), root(int(driven[span]))
        group[a], chosen[span] = b, a != b
    return chosen
