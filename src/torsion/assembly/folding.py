"""The train referred to one speed and laid out as a tree.

With theta = ratio * q an inertia becomes J ratio^2, a flexibility h/ratio^2 at the ratio of its driving station, and a
rigid gear a rigid span: products only, so nothing is lost. The softest spans that close a loop are left over.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.assembly.walking import MANY, Walk, connected, walk
from torsion.components.lowering import Part
from torsion.errors import Fault, InputError, SolveError
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
    """The tree of a system; raises InputError where rigid spans close a loop, SolveError where they join two
    held stations.
    """
    ratio = system.span_ratio
    flexibility = system.flexibility / ratio**2
    ends = _split_held(system)
    chosen = np.ones(len(flexibility), dtype=bool)
    way = _walked(system, ends, chosen)
    if len(flexibility) > np.count_nonzero(way.parent >= 0):
        chosen = _spanning(system, flexibility, ends, len(way.order))
        way = _walked(system, ends, chosen)
    return _layout(system, flexibility, ends, chosen, way)


def _walked(system: "System", ends: "_Ends", chosen: BoolArray) -> Walk:
    """The way over the `chosen` spans, from a held station (no ground) where a part of the train has one."""
    number = len(system.stations) + len(ends.copies)
    held = [station for station in np.flatnonzero(system.held).tolist() if not system.stations[station].is_ground]
    return walk(number, ends.driving, ends.driven, chosen, held)


@dataclass(frozen=True)
class _Ends:
    """Ends of every span after held stations were split into one copy a span."""

    driving: IntArray
    driven: IntArray
    copies: tuple[int, ...]  # the held station that each further node copies


def _split_held(system: "System") -> _Ends:
    """A held station stays the root of its train once; every other held station becomes one leaf a span.

    One with a single span is a root or a leaf as it is.
    """
    driving, driven = system.driving.copy(), system.driven.copy()
    if not system.held.any():
        return _Ends(driving, driven, ())
    copies: list[int] = []
    number = len(system.stations)
    group = _groups(number, driving, driven, system.held)
    rooted: set[int] = set()
    for station in np.flatnonzero(system.held).tolist():
        touching = [(side, s) for side in (driving, driven) for s in np.flatnonzero(side == station).tolist()]
        other = {id(driving): driven, id(driven): driving}
        for side, span in touching if len(touching) > 1 else []:
            beyond = int(group[other[id(side)][span]])
            if beyond in rooted or system.stations[station].is_ground:
                side[span] = number + len(copies)
                copies.append(station)
        if not system.stations[station].is_ground:
            rooted.update(int(group[other[id(side)][span]]) for side, span in touching)
    return _Ends(driving, driven, tuple(copies))


def _groups(number: int, driving: IntArray, driven: IntArray, held: BoolArray) -> IntArray:
    """Which stations hang together without passing through a held one."""
    if number >= MANY:
        free = ~held[driving] & ~held[driven]
        return np.asarray(connected(number, driving[free], driven[free]), dtype=np.int64)
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


def _spanning(system: "System", flexibility: FloatArray, ends: _Ends, number: int) -> BoolArray:
    """Which spans form the tree: the stiffest that close no loop; of two alike, the one that is not of `links`."""
    group = list(range(number))

    def root(a: int) -> int:
        while group[a] != a:
            group[a] = group[group[a]]
            a = group[a]
        return a

    chosen = np.zeros(len(flexibility), dtype=bool)
    closes = np.array([part.path[0] == "links" for part in system.train.parts])[system.span_part]
    for span in np.lexsort((closes, flexibility)).tolist():
        a, b = root(int(ends.driving[span])), root(int(ends.driven[span]))
        if a != b:
            group[a] = b
            chosen[span] = True
        elif flexibility[span] == 0:
            raise InputError([_rigid_loop(system.train.parts[system.span_part[span]])])
    return chosen


def _rigid_loop(part: Part) -> Fault:
    """The fault of a rigid component that closes a loop of rigid ones."""
    key = ("flexibility",) if getattr(part.component, "flexibility", None) == 0 else ()
    message = f"'{part.name}' is rigid and closes a loop of rigid links, whose torques nothing divides"
    return Fault((*part.path, *key), message, "give it a stiffness, or leave it out")


def _layout(system: "System", flexibility: FloatArray, ends: _Ends, chosen: BoolArray, way: Walk) -> Folded:
    """Number the tree from its roots outward."""
    stations = len(system.stations)
    order, number = way.order, len(way.order)
    place = np.empty(number, dtype=np.int64)
    place[order] = np.arange(number)
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
    _refuse_rigid_held(tree)
    sign = np.where(place[ends.driven] == span_node, 1.0, -1.0)
    return Folded(tree, place[:stations], span_node, sign, np.flatnonzero(~chosen), viscous, loss, copied)


def _refuse_rigid_held(tree: Tree) -> None:
    inner = tree.held & (tree.parent >= 0)
    if np.any(inner & (tree.flexibility == 0)):
        raise SolveError("two held stations are joined with a rigid span between; hold the train at one of them")
