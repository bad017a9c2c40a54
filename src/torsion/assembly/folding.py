"""The train referred to one speed and laid out as a tree.

With theta = ratio * q an inertia becomes J ratio^2, a flexibility h/ratio^2 at the ratio of its driving station, and a
rigid gear a rigid span: products only, so nothing is lost. The softest spans that close a loop are left over.
"""

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree

if TYPE_CHECKING:
    from torsion.assembly.system import System


@dataclass(frozen=True)
class Folded:
    """A tree of the train's stations and spans in one speed."""

    tree: Tree
    node: IntArray  # (stations,) tree station of each station
    span: IntArray  # (spans,) tree station below each span; -1 where the span closes a loop or doubles another
    sign: FloatArray  # (spans,) 1 where the driving station is the parent, -1 where the driven one is
    extra: IntArray  # (extra,) spans that close loops
    viscous: FloatArray  # (tree stations,) N m s/rad of each tree span, folded
    loss_factor: FloatArray  # (tree stations,)
    is_held_copy: BoolArray  # (tree stations,) a second copy of a held station, at the end of one of its spans


def fold(system: "System") -> Folded:
    """The tree of a system; raises SolveError where rigid spans close a loop or join two held stations."""
    ratio = system.span_ratio
    flexibility = system.flexibility / ratio**2
    ends = _split_held(system)
    spanning = _spanning(flexibility, ends, len(system.stations) + len(ends.copies))
    return _layout(system, flexibility, ends, spanning)


@dataclass(frozen=True)
class _Ends:
    """Ends of every span after held stations were split into one copy a span."""

    driving: IntArray
    driven: IntArray
    copies: tuple[int, ...]  # the held station that each further node copies


def _split_held(system: "System") -> _Ends:
    """A held station stays the root of its train once; every other held station becomes one leaf a span."""
    driving, driven = system.driving.copy(), system.driven.copy()
    copies: list[int] = []
    number = len(system.stations)
    group = _groups(number, driving, driven, system.held)
    rooted: set[int] = set()
    for station in np.flatnonzero(system.held).tolist():
        touching = [(side, s) for side in (driving, driven) for s in np.flatnonzero(side == station).tolist()]
        other = {id(driving): driven, id(driven): driving}
        for side, span in touching:
            beyond = int(group[other[id(side)][span]])
            if beyond in rooted or system.stations[station].is_ground:
                side[span] = number + len(copies)
                copies.append(station)
        if not system.stations[station].is_ground:
            rooted.update(int(group[other[id(side)][span]]) for side, span in touching)
    return _Ends(driving, driven, tuple(copies))


def _groups(number: int, driving: IntArray, driven: IntArray, held: BoolArray) -> IntArray:
    """Which stations hang together without passing through a held one."""
    group = np.arange(number)

    def root(a: int) -> int:
        while group[a] != a:
            group[a] = group[group[a]]
            a = int(group[a])
        return a

    for a, b in zip(driving.tolist(), driven.tolist(), strict=True):
        if not held[a] and not held[b]:
            group[root(a)] = root(b)
    return np.array([root(a) for a in range(number)])


def _spanning(flexibility: FloatArray, ends: _Ends, number: int) -> BoolArray:
    """Which spans form the tree: the stiffest that close no loop."""
    group = list(range(number))

    def root(a: int) -> int:
        while group[a] != a:
            group[a] = group[group[a]]
            a = group[a]
        return a

    chosen = np.zeros(len(flexibility), dtype=bool)
    for span in np.argsort(flexibility, kind="stable").tolist():
        a, b = root(int(ends.driving[span])), root(int(ends.driven[span]))
        if a != b:
            group[a] = b
            chosen[span] = True
        elif flexibility[span] == 0:
            raise SolveError("rigid links close a loop; give one of them a stiffness")
    return chosen


def _layout(system: "System", flexibility: FloatArray, ends: _Ends, chosen: BoolArray) -> Folded:
    """Number the tree from its roots outward."""
    stations, copies = len(system.stations), np.array(ends.copies, dtype=np.int64)
    number = stations + len(copies)
    source = np.concatenate([np.arange(stations), copies]) if len(copies) else np.arange(stations)
    held = system.held[source]
    near: list[list[tuple[int, int]]] = [[] for _ in range(number)]
    for span in np.flatnonzero(chosen).tolist():
        a, b = int(ends.driving[span]), int(ends.driven[span])
        near[a].append((b, span))
        near[b].append((a, span))
    order, parent, above = _walk(near, held, stations)
    place = np.empty(number, dtype=np.int64)
    place[order] = np.arange(number)
    rank = np.array([place[p] if p >= 0 else -1 for p in parent], dtype=np.int64)[order]
    by_span = np.array(above, dtype=np.int64)[order]
    has = by_span >= 0
    tree_flexibility, viscous, loss = np.zeros(number), np.zeros(number), np.zeros(number)
    ratio2 = system.span_ratio**2
    tree_flexibility[has] = flexibility[by_span[has]]
    viscous[has] = (system.viscous * ratio2)[by_span[has]]
    loss[has] = system.loss_factor[by_span[has]]
    span_node = np.full(len(flexibility), -1, dtype=np.int64)
    span_node[by_span[has]] = np.flatnonzero(has)
    tree = Tree(rank, tree_flexibility, (system.inertia * system.speed_ratio**2)[source][order], held[order])
    _refuse_rigid_held(tree)
    sign = np.where(place[ends.driven] == span_node, 1.0, -1.0)
    extra = np.flatnonzero(~chosen)
    copy = np.arange(number)[order] >= stations
    return Folded(tree, place[:stations], span_node, sign, extra, viscous, loss, copy)


def _walk(near: list[list[tuple[int, int]]], held: BoolArray, stations: int) -> tuple[IntArray, list[int], list[int]]:
    """Breadth first from a held station, else from the first station, of every separate train."""
    number = len(near)
    parent, above, seen, order = [-1] * number, [-1] * number, [False] * number, []
    starts = [s for s in range(stations) if held[s] and near[s]] + list(range(number))
    for start in starts:
        if seen[start]:
            continue
        seen[start] = True
        queue = deque([start])
        while queue:
            here = queue.popleft()
            order.append(here)
            for there, span in near[here]:
                if not seen[there]:
                    seen[there], parent[there], above[there] = True, here, span
                    queue.append(there)
    return np.array(order, dtype=np.int64), parent, above


def _refuse_rigid_held(tree: Tree) -> None:
    inner = tree.held & (tree.parent >= 0)
    if np.any(inner & (tree.flexibility == 0)):
        raise SolveError("two held stations are joined with a rigid span between; hold the train at one of them")
