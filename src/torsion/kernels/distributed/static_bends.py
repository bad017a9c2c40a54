"""Coordinates of a tree of finite elements in which twice the elastic energy is their sum of squares.

Every span that bends has one, its torque times the root of its flexibility; the modes inside the elements are the
others. Angles follow as sums along the tree, about a mean that the inertia holds still or about a fixed station: rigid
motions are left out beforehand, and no angle is a small difference of large ones.
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.distributed.distributed_shafts import Shafts
from torsion.kernels.distributed.element import CondensedElements
from torsion.kernels.reduction import Rigidity, rigidity
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class Bends:
    """What coordinates mean. A spring is a span that is not rigid; that of a shaft has its static flexibility."""

    spring: IntArray  # (springs,) outer station of each
    root: FloatArray  # (springs,) root of its flexibility, (rad/(N m))^1/2
    bend: FloatArray  # (springs, coordinates) angle of the outer end less that of the inner one, over `root`
    angle: FloatArray  # (stations, coordinates) rad
    inside: IntArray  # (shafts, modes) coordinate of each mode inside an element


def static_bends(train: Tree, shafts: Shafts, element: CondensedElements) -> Bends:
    """The coordinates of the tree `train`, whose shafts `shafts` are `element`."""
    tree = train.static
    known = rigidity(tree)
    spring = np.flatnonzero((tree.parent >= 0) & (tree.flexibility > 0.0))
    root = np.sqrt(tree.flexibility[spring])
    bodies = np.unique(known.body[known.fixed])
    first = np.unique(known.component[bodies], return_index=True)[1]
    angle = _angles(tree, known.component, spring, bodies[first]) * root
    bend, ties = np.eye(len(spring)), angle[np.delete(bodies, first)]
    if len(ties):
        ties = ties / np.linalg.norm(ties, axis=1, keepdims=True)
        bend = np.linalg.qr(ties.T, mode="complete")[0][:, len(ties) :]
        angle = angle @ bend
    angle = np.concatenate((angle, _balance(tree, known, shafts, element)), axis=1)
    angle[known.fixed] = 0.0
    inside = bend.shape[1] + np.arange(element.modes.size).reshape(element.modes.shape)
    bend = np.concatenate((bend, np.zeros((len(spring), element.modes.size))), axis=1)
    return Bends(spring, root, bend, angle, inside)


def _angles(tree: Tree, component: IntArray, spring: IntArray, fixed: IntArray) -> FloatArray:
    """Angles (stations, springs) for a twist of 1 in each, such that the weighted mean of a part's angles is zero.

    The weight is the inertia; in a part that is held it is only at the first of its `fixed` stations.
    """
    weight = np.where(np.isin(component, component[fixed]), 0.0, tree.moving_inertia)
    weight[fixed] = 1.0
    outward = _outward(tree)[:, spring]
    inward = (component[:, None] == component[spring]) & ~outward
    beyond, before = weight @ outward, weight @ inward
    whole = beyond + before
    whole[whole == 0.0] = 1.0
    return np.where(outward, before / whole, 0.0) - np.where(inward, beyond / whole, 0.0)


def _outward(tree: Tree) -> BoolArray:
    """(stations, stations) whether a station is at the outer end of a span, or beyond."""
    beyond = np.eye(tree.size, dtype=np.bool_)
    columns = list(beyond)
    for i in range(tree.size - 1, -1, -1):
        if tree.parents[i] >= 0:
            np.logical_or(columns[tree.parents[i]], columns[i], columns[tree.parents[i]])
    return beyond.T


def _balance(tree: Tree, known: Rigidity, shafts: Shafts, element: CondensedElements) -> FloatArray:
    """Angle (stations, modes) by which a free part turns back as a whole, lest a mode inside carry it along."""
    inertia = tree.moving_inertia
    part = known.component[:, None] == known.component[known.free_roots]
    share = part / (inertia @ part)
    turned = share @ part[shafts.node].T
    balance: FloatArray = -np.repeat(turned, element.modes.shape[1], axis=1) * element.coupling_turn.reshape(-1)
    return balance
