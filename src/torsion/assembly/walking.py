"""A way over all stations of a train, from its roots outward, breadth first."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, IntArray

MANY = 4000  # stations from which scipy's search over sparse graphs is the faster (measured)


@dataclass(frozen=True)
class Walk:
    """Stations as they are met; `parent` and `above` are -1 at a root."""

    order: IntArray  # (stations,)
    parent: IntArray  # (stations,) of each station
    above: IntArray  # (stations,) the span each station was reached by


def walk(number: int, driving: IntArray, driven: IntArray, chosen: BoolArray, held: list[int]) -> Walk:
    """Breadth first from a held station, else from the first station, of every separate part, over `chosen` spans."""
    if number >= MANY:
        return _walk_of_many(number, driving, driven, chosen, held)
    near: list[list[tuple[int, int]]] = [[] for _ in range(number)]
    for span, (a, b) in enumerate(zip(driving.tolist(), driven.tolist(), strict=True)):
        if chosen[span]:
            near[a].append((b, span))
            near[b].append((a, span))
    parent, above, order = [-1] * number, [-1] * number, list[int]()
    seen = [False] * number
    for start in [station for station in held if near[station]] + list(range(number)):
        if seen[start]:
            continue
        seen[start] = True
        met = len(order)
        order.append(start)
        while met < len(order):
            here = order[met]
            met += 1
            for there, span in near[here]:
                if not seen[there]:
                    seen[there], parent[there], above[there] = True, here, span
                    order.append(there)
    return Walk(*(np.array(values, dtype=np.int64) for values in (order, parent, above)))


def connected(number: int, driving: IntArray, driven: IntArray) -> IntArray:
    """(stations,) the same number for all stations that hang together."""
    from scipy.sparse.csgraph import connected_components

    return np.asarray(connected_components(_graph(number, driving, driven), directed=False)[1])


def _walk_of_many(number: int, driving: IntArray, driven: IntArray, chosen: BoolArray, held: list[int]) -> Walk:
    """One search from a point beside the train, which is joined to the root of every part."""
    from scipy.sparse.csgraph import breadth_first_order

    span = np.flatnonzero(chosen)
    a, b = driving[span], driven[span]
    part = connected(number, a, b)
    root = np.unique(part, return_index=True)[1]
    for station in reversed(held):
        root[part[station]] = station
    beside = np.full(len(root), number)
    graph = _graph(number + 1, np.concatenate([a, beside]), np.concatenate([b, root]))
    met, before = breadth_first_order(graph, number, directed=False)
    order, parent = met[1:].astype(np.int64), before[:-1].astype(np.int64)
    parent[root] = -1
    above = np.full(number, -1, dtype=np.int64)
    outward, inward = parent[b] == a, parent[a] == b
    above[b[outward]], above[a[inward]] = span[outward], span[inward]
    return Walk(order, parent, above)


def _graph(number: int, driving: IntArray, driven: IntArray) -> Any:
    from scipy.sparse import coo_array

    return coo_array((np.ones(len(driving), dtype=np.int32), (driving, driven)), shape=(number, number)).tocsr()
