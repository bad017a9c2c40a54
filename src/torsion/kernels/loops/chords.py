"""The spanning tree of the stiffest spans of a train with closed loops, and the chords: the spans that close them."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.spanning_forest import closing_no_loop, walk
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class LoopedTrain:
    """A train with loops, renumbered; the torque of every given span is `sign` times that of span or chord `source`."""

    tree: Tree
    first: IntArray  # (chords,) new stations at both ends of each chord
    second: IntArray
    flexibility: FloatArray  # (chords,) rad/(N m)
    station: IntArray  # (stations,) new number of each given station
    source: IntArray  # (given stations + given chords,) row among the new stations, then the chords
    sign: FloatArray  # (given stations + given chords,)


def stiffest_tree(tree: Tree, first: IntArray, second: IntArray, flexibility: FloatArray) -> LoopedTrain:
    """Tear every loop at its softest span (Kruskal 1956): what is torn is then a correction, not the main path.

    The root of a part is a fixed station wherever there is one, so that angles are sums of twists from the ground.
    Spans are those of `tree`, from parent to station, and (chords,) ones from `first` to `second`.
    """
    near, far = np.append(tree.parent, first), np.append(np.arange(tree.size), second)
    soft = np.append(tree.flexibility, flexibility)
    ranked = np.argsort(soft, kind="stable")
    chosen = closing_no_loop(tree.size, near, far, ranked[near[ranked] >= 0])
    way = walk(tree.size, near, far, chosen, np.flatnonzero(tree.held).tolist())
    order, station = way.order, np.argsort(way.order)
    span, above = way.above[order], way.parent[order]
    parent = np.where(above >= 0, station[above], -1)
    new = Tree(parent, np.where(span >= 0, soft[span], 0.0), tree.inertia[order], tree.held[order])
    torn = np.flatnonzero(~chosen & (near >= 0))
    source, sign = np.arange(len(near)), np.zeros(len(near))
    inside = np.flatnonzero(span >= 0)
    source[span[inside]] = inside
    sign[span[inside]] = np.where(station[far[span[inside]]] == inside, 1.0, -1.0)
    source[torn], sign[torn] = tree.size + np.arange(len(torn)), 1.0
    source[sign == 0.0] = 0
    return LoopedTrain(new, station[near[torn]], station[far[torn]], soft[torn], station, source, sign)


def around(tree: Tree, first: IntArray, second: IntArray) -> FloatArray:
    """+1 and -1 (chords, stations) for the spans whose twists add up to angle[first] - angle[second]; else 0.

    Raises ValueError for a chord between parts that nothing else joins.
    """
    sign = np.zeros((len(first), tree.size))
    for chord, ends in enumerate(zip(second.tolist(), first.tolist(), strict=True)):
        here = list(ends)
        for side, direction in ((0, 1.0), (1, -1.0)):
            while tree.parents[here[side]] >= 0:
                sign[chord, here[side]] += direction
                here[side] = tree.parents[here[side]]
        if here[0] != here[1] and not tree.held[here].all():
            raise ValueError(f"chord {chord} joins two parts that nothing else joins; expected it in the tree")
    return sign


def pairs(stations: int, first: IntArray, second: IntArray) -> FloatArray:
    """Torques (chords, stations) with which a unit torque in each chord acts on the tree."""
    pair, chord = np.zeros((len(first), stations)), np.arange(len(first))
    np.add.at(pair, (chord, second), 1.0)
    np.add.at(pair, (chord, first), -1.0)
    return pair
