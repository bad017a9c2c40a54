"""Rigid spans to a fixed station: what they join does not move, and their torque is a sum of reactions."""

from dataclasses import replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.kernels.reduction import Rigidity
from torsion.kernels.tree import Tree


def needs_cutting(tree: Tree, known: Rigidity) -> bool:
    """Whether a station that is not itself `held` is fixed by rigid spans."""
    if not tree.holds:
        return False
    return bool(np.any(known.fixed & ~tree.held)) or bool(np.any(_inside(tree, known)))


def cut(tree: Tree, known: Rigidity) -> Tree:
    """The tree with every fixed station `held` and the rigid spans between them taken out."""
    return replace(tree, parent=np.where(_inside(tree, known), -1, tree.parent), held=known.fixed)


def with_reactions(tree: Tree, known: Rigidity, torque: FloatArray, outside: FloatArray | float = 0.0) -> FloatArray:
    """Torque (stations, m) of the cut tree, completed in the rigid spans between fixed stations by equilibrium.

    `outside` (stations, m) N m is what acts on each station besides its spans.

    Where a body is fixed more than once, the shares are not determined: the fixed station numbered first takes all.
    """
    inside, parents = _inside(tree, known), tree.parent.tolist()
    load = np.where(tree.parent[:, None] >= 0, torque, 0.0) + outside
    for station, parent in enumerate(parents):
        if parent >= 0 and not inside[station]:
            load[parent] -= torque[station]
    full = torque.copy()
    for body in np.unique(known.body[inside]).tolist():
        members = np.flatnonzero(known.body == body).tolist()
        order, before = _order_from(next(i for i in members if tree.held[i]), members, parents)
        for station in order[:0:-1]:
            nearer = before[station]
            is_parent = parents[station] == nearer
            full[station if is_parent else nearer] = -load[station] if is_parent else load[station]
            load[nearer] += load[station]
    return full


def _order_from(first: int, members: list[int], parents: list[int]) -> tuple[list[int], dict[int, int]]:
    """Members of a rigid body in order of distance from `first`, and the one before each."""
    joined: dict[int, list[int]] = {i: [] for i in members}
    for i in members:
        if parents[i] in joined:
            joined[i].append(parents[i])
            joined[parents[i]].append(i)
    order, before = [first], {first: -1}
    for i in order:
        for other in joined[i]:
            if other not in before:
                before[other] = i
                order.append(other)
    return order, before


def _inside(tree: Tree, known: Rigidity) -> BoolArray:
    """Stations (stations,) whose span is rigid and joins fixed stations."""
    return np.asarray(known.fixed & (tree.static.flexibility == 0.0) & (tree.parent >= 0))
