"""The train referred to one speed and laid out as a tree.

With theta = ratio * q an inertia becomes J ratio^2, a flexibility h/ratio^2 at the ratio of its driving station, and a
rigid gear a rigid span: products only, so nothing is lost. The softest spans that close a loop are left over.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.fixed_points import fixed_point_faults
from torsion.components.lowering import Part
from torsion.errors import Fault, InputError
from torsion.kernels.spanning_forest import Walk, closing_no_loop, connected, walk
from torsion.kernels.tree import Tree

if TYPE_CHECKING:
    from torsion.assembly.system import System


@dataclass(frozen=True)
class CondensedTrain:
    """A tree of the train's stations and spans in one speed."""

    tree: Tree
    node: IntArray  # (stations,) tree station of each station
    span: IntArray  # (spans,) tree station below each span; -1 where the span closes a loop or doubles another
    sign: FloatArray  # (spans,) 1 where the driving station is the parent, -1 where the driven one is
    extra: IntArray  # (extra,) spans that close loops
    viscous: FloatArray  # (tree stations,) N m s/rad of each tree span, referred
    loss_factor: FloatArray  # (tree stations,)
    is_held_copy: BoolArray  # (tree stations,) a second copy of a fixed station, at the end of one of its spans


def fold(system: "System") -> CondensedTrain:
    """The tree of a system; raises InputError where rigid spans close a loop or join two fixed stations.

    Where rigid spans lead to several fixed stations of one part of the train, each of these is a root of its own, and
    the softest spans between them are left over as those that close a loop (through ground).
    """
    ratio = system.span_ratio
    flexibility = system.flexibility / ratio**2
    ends = _split_held(system)
    chosen = np.ones(len(flexibility), dtype=bool)
    way = walk(ends.number, ends.driving, ends.driven, chosen, ends.roots)
    if ends.anchors or len(flexibility) > np.count_nonzero(way.parent >= 0):
        chosen = _spanning(system, flexibility, ends)
        way = walk(ends.number, ends.driving, ends.driven, chosen, ends.roots)
    return _layout(system, flexibility, ends, chosen, way)


@dataclass(frozen=True)
class _Ends:
    """Ends of every span after fixed stations were split into one copy a span."""

    number: int  # of stations and copies
    driving: IntArray
    driven: IntArray
    copies: tuple[int, ...]  # the fixed station that each further node copies
    roots: list[int]  # fixed stations (no ground) to walk from, in this order
    anchors: tuple[int, ...]  # fixed stations that rigid spans join to one part, where there are several


def _split_held(system: "System") -> _Ends:
    """A fixed station stays the root of its train once; every other fixed station becomes one leaf a span.

    One with a single span is a root or a leaf as it is. A rigid span can only lead away from a root.
    """
    driving, driven = system.driving.copy(), system.driven.copy()
    number = len(system.stations)
    if not system.held.any():
        return _Ends(number, driving, driven, (), [], ())
    free = ~system.held[driving] & ~system.held[driven]
    group = connected(number, driving[free], driven[free])  # stations joined without passing through a fixed one
    held = np.flatnonzero(system.held).tolist()
    touching = {station: _touching(system, station) for station in held}
    root, anchors = _rigidly_rooted(system, touching, group)
    copies: list[int] = []
    for station in held:
        is_ground = system.stations[station].is_ground
        for side, span, other in touching[station] if len(touching[station]) > 1 else []:
            here, there = (driving, driven) if side == 0 else (driven, driving)
            is_between = bool(system.held[other]) and there[span] < number
            is_elsewhere = root.get(int(group[other]), station) != station
            if system.flexibility[span] > 0 and (is_ground or is_between or is_elsewhere):
                here[span] = number + len(copies)
                copies.append(station)
        if not is_ground:
            for _, _, other in touching[station]:
                root.setdefault(int(group[other]), station)
    first = dict.fromkeys(root.values())
    rest = [station for station in held if station not in first and not system.stations[station].is_ground]
    return _Ends(number + len(copies), driving, driven, tuple(copies), [*first, *rest], anchors)


def _touching(system: "System", station: int) -> list[tuple[int, int, int]]:
    """(0 as its driving end or 1, span, station at the other end) of every span of a station."""
    found = []
    for side, here, there in ((0, system.driving, system.driven), (1, system.driven, system.driving)):
        found += [(side, span, int(there[span])) for span in np.flatnonzero(here == station).tolist()]
    return found


def _rigidly_rooted(
    system: "System", touching: dict[int, list[tuple[int, int, int]]], group: IntArray
) -> tuple[dict[int, int], tuple[int, ...]]:
    """The first fixed station that a rigid span joins to each group, and the anchors."""
    root, anchors = dict[int, int](), set[int]()
    for station, spans in touching.items():
        for _, span, other in spans:
            if system.flexibility[span] == 0:
                first = other if system.held[other] else root.setdefault(int(group[other]), station)
                anchors |= {first, station} if first != station else set()
    return root, tuple(sorted(anchors))


def _spanning(system: "System", flexibility: FloatArray, ends: _Ends) -> BoolArray:
    """Which spans form the tree: the stiffest that close no loop and join no two anchors; those of `links` last."""
    closes = np.array([part.path[0] == "links" for part in system.train.parts])[system.span_part]
    ranked = np.lexsort((closes, flexibility))
    chosen = closing_no_loop(ends.number, ends.driving, ends.driven, ranked, ends.anchors)
    rigid = ranked[~chosen[ranked] & (flexibility[ranked] == 0)]
    if rigid.size:
        part = system.train.parts[system.span_part[rigid[0]]]
        raise InputError(fixed_point_faults(system.train) or [_rigid_loop(part)])
    return chosen


def _rigid_loop(part: Part) -> Fault:
    """The fault of a rigid component that closes a loop of rigid ones."""
    key = () if part.ratings is None else ("flexibility",)  # a rigid coupling says so itself
    message = f"'{part.name}' is rigid and closes a loop of rigid links, whose torques nothing divides"
    return Fault((*part.path, *key), message, "give it a stiffness, or leave it out")


def _layout(system: "System", flexibility: FloatArray, ends: _Ends, chosen: BoolArray, way: Walk) -> CondensedTrain:
    """Number the tree from its roots to its leaves."""
    stations = len(system.stations)
    order, number = way.order, len(way.order)
    place = np.argsort(order)
    parent, above = way.parent[order], way.above[order]
    node = np.flatnonzero(above >= 0)
    span, ratio2 = above[node], system.span_ratio**2
    tree_flexibility, viscous, loss = np.zeros((3, number))
    tree_flexibility[node] = flexibility[span]
    viscous[node] = (system.viscous * ratio2)[span]
    loss[node] = system.loss_factor[span]
    span_node = np.full(len(flexibility), -1, dtype=np.int64)
    span_node[span] = node
    copied = order >= stations
    source = order if not ends.copies else np.append(np.arange(stations), ends.copies)[order]
    inertia = (system.lumped_inertia * system.speed_ratio**2)[source]
    tree = Tree(np.where(parent >= 0, place[parent], -1), tree_flexibility, inertia, system.held[source])
    sign = np.where(place[ends.driven] == span_node, 1.0, -1.0)
    return CondensedTrain(tree, place[:stations], span_node, sign, np.flatnonzero(~chosen), viscous, loss, copied)
