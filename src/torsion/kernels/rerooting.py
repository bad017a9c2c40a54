"""A tree with another root, numbered layer by layer: from the middle a sweep passes half as many layers."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class Rerooted:
    """A tree with another root and numbering."""

    tree: Tree  # its stations are numbered layer by layer
    station: IntArray  # (stations,) where each station of the given tree is now
    span: IntArray  # (stations,) where each span of the given tree is now
    sign: FloatArray  # (stations, 1) -1 where a span of the given tree now runs the other way

    def angles(self, angle: FloatArray) -> FloatArray:
        """Angles (stations, m) in the numbering of the given tree."""
        return angle.take(self.station, 0)

    def torques(self, torque: FloatArray) -> FloatArray:
        """Span torques (stations, m) in the numbering and with the signs of the given tree."""
        given = torque.take(self.span, 0)
        given *= self.sign
        return given


def rerooted_at_middle(tree: Tree) -> Rerooted:
    """The same train with the middle of its longest path as the root.

    The root stays where there are several, and where a fixed one has more than one span: a fixed station is a leaf.
    A chain stays as it is, for it is swept from both ends at once; so do small trees, not worth while, and distributed
    shafts, whose shapes are swept station by station.
    """
    if tree.is_swept_by_stations or tree.shafts is not None:
        return _as_it_is(tree)
    parents = tree.parents
    path = [] if not parents or parents.count(-1) > 1 else _to_the_middle(parents)
    if len(path) < 2 or (tree.held[0] and parents.count(0) > 1):
        return by_layers(tree)
    return _rerooted(tree, path)


def rerooted_at_end(tree: Tree) -> Rerooted | None:
    """The same train with an end of the row in which its stations lie as the root; None where they are no row."""
    if tree.is_chain:
        return _as_it_is(tree)
    path = tree.roots[:1]
    if len(tree.roots) != 1 or len(tree.children[path[0]]) > 2 or tree.most_children > 2:
        return None
    while tree.children[path[-1]]:
        path.append(tree.children[path[-1]][0])
    row = _rerooted(tree, path if len(tree.children[path[0]]) == 2 else path[:1])
    return row if row.tree.is_chain else None


def by_layers(tree: Tree) -> Rerooted:
    """The same train numbered layer by layer, its roots where they are."""
    return _renumbered(tree, tree.parents, np.arange(tree.size), np.ones((tree.size, 1)))


def _as_it_is(tree: Tree) -> Rerooted:
    return Rerooted(tree, np.arange(tree.size), np.arange(tree.size), np.ones((tree.size, 1)))


def _rerooted(tree: Tree, path: list[int]) -> Rerooted:
    """The train with the last station of a `path` from its root as the root."""
    toward, span, sign = tree.parents.copy(), list(range(tree.size)), np.ones((tree.size, 1))
    for outer, inner in zip(path[1:], path, strict=False):
        toward[inner], span[inner] = outer, outer
    toward[path[-1]], span[path[-1]] = -1, path[0]
    sign[path[1:]] = -1.0
    return _renumbered(tree, toward, np.array(span), sign)


def _renumbered(tree: Tree, toward: list[int], span: IntArray, sign: FloatArray) -> Rerooted:
    """The train with parents `toward`; each station has the span that was numbered `span` (stations,)."""
    order = _by_layers(toward)
    station, span = _inverse(order), span[order]
    number = np.append(station, -1)  # the last one is what -1 finds
    parent = number[np.array(toward, dtype=np.int64)[order]]
    whole = Tree(parent, tree.flexibility[span], tree.inertia[order], tree.held[order])
    return Rerooted(whole, station, _inverse(span), sign)


def _to_the_middle(parents: list[int]) -> list[int]:
    """Stations from the only root to the middle of the longest path."""
    size = len(parents)
    height, second, tallest = [0] * size, [0] * size, [-1] * size
    for station in range(size - 1, 0, -1):
        parent, reach = parents[station], height[station] + 1
        if reach > height[parent]:
            height[parent], second[parent], tallest[parent] = reach, height[parent], station
        elif reach > second[parent]:
            second[parent] = reach
    path, behind = [0], 0
    while height[path[-1]] > max(behind, second[path[-1]]) + 1:
        behind = max(behind, second[path[-1]]) + 1
        path.append(tallest[path[-1]])
    return path


def _by_layers(parents: list[int]) -> IntArray:
    """Stations in the order of their distance from a root, siblings side by side."""
    children: list[list[int]] = [[] for _ in parents]
    order: list[int] = []
    for station, parent in enumerate(parents):
        (children[parent] if parent >= 0 else order).append(station)
    for station in order:
        order += children[station]
    return np.array(order, dtype=np.int64)


def _inverse(order: IntArray) -> IntArray:
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    return place
