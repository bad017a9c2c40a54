"""Rigid bodies, fixed stations and free parts of a train, and what follows from the graph alone.

What rigid spans join to a fixed station does not move, and their torques are sums of reactions.
"""

from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.trees.tree import Tree, walk


@dataclass(frozen=True)
class Rigidity:
    """What the graph alone says: which stations move as one, and which parts are free to turn."""

    body: IntArray  # (stations,) the first station of the rigid body that each one belongs to
    fixed: BoolArray  # (stations,) `held`, or joined rigidly to such a station
    component: IntArray  # (stations,) root of the part each one belongs to
    free_roots: IntArray  # (rigid motions,) root of every part with inertia and no fixed station
    inside: BoolArray  # (stations,) whose span is rigid and joins fixed stations
    elastic: int  # number of natural frequencies other than 0


def rigidity(tree: Tree) -> Rigidity:
    """Rigid bodies, fixed stations and free parts of a tree."""
    size, parents = tree.size, tree.parents
    rigid = (tree.flexibility == 0.0).tolist()
    body, component = list(range(size)), list(range(size))
    for station, parent in enumerate(parents):
        if parent >= 0:
            component[station] = component[parent]
            if rigid[station]:
                body[station] = body[parent]
    fixed_bodies = {body[station] for station in np.flatnonzero(tree.held).tolist()}
    grounded = {component[station] for station in fixed_bodies}
    heavy = {
        b for b, inertia in zip(body, tree.moving_inertia.tolist(), strict=True) if inertia > 0.0
    } - fixed_bodies
    free_roots = sorted({component[b] for b in heavy} - grounded)
    fixed = np.array([b in fixed_bodies for b in body], dtype=bool)
    return Rigidity(
        body=np.array(body, dtype=np.int64),
        fixed=fixed,
        component=np.array(component, dtype=np.int64),
        free_roots=np.array(free_roots, dtype=np.int64),
        inside=fixed & rigid & (tree.parent >= 0),
        elastic=len(heavy) - len(free_roots),
    )


def rigid_shapes(tree: Tree, bodies: Rigidity) -> FloatArray:
    """Angles (stations, rigid motions) rad, constant over each free part and mass-normalised."""
    part = bodies.component[:, None] == bodies.free_roots
    scaled: FloatArray = part / np.sqrt(tree.moving_inertia @ part)
    return scaled


def cut(tree: Tree, bodies: Rigidity) -> Tree:
    """The tree with every fixed station `held` and the rigid spans between them taken out; itself if there are none."""
    if not bodies.inside.any():
        return tree
    return replace(tree, parent=np.where(bodies.inside, -1, tree.parent), held=bodies.fixed)


def with_reactions(
    tree: Tree, bodies: Rigidity, torque: FloatArray, outside: FloatArray | float = 0.0
) -> FloatArray:
    """Torque (stations, m) of the cut tree, completed in the rigid spans between fixed stations by equilibrium.

    `outside` (stations, m) N m is what acts on each station besides its spans.

    Where a body is fixed more than once, the shares are not determined: the fixed station numbered first takes all.
    """
    inside = bodies.inside
    if not inside.any():
        return torque
    load = np.where(tree.parent[:, None] >= 0, torque, 0.0) + outside
    for station, parent in enumerate(tree.parents):
        if parent >= 0 and not inside[station]:
            load[parent] -= torque[station]
    full = torque.copy()
    way = walk(
        tree.size, tree.parent, np.arange(tree.size), inside, np.flatnonzero(tree.held).tolist()
    )
    for station in way.order[::-1].tolist():
        nearer, span = way.parent[station], way.above[station]
        if nearer >= 0:
            full[span] = -load[station] if span == station else load[station]
            load[nearer] += load[station]
    return full


def bends(tree: Tree, bodies: Rigidity) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Coordinates whose sum of squares is the elastic energy: torque times the root of the flexibility of each span.

    Spans that are not rigid (springs,), those roots, the bend of each over its root (springs, coordinates), and angles
    (stations, coordinates) rad. Angles are sums along the tree, about a mean that the inertia holds still or about a
    fixed station: rigid motions are left out, and no angle is a small difference of large ones.
    """
    spring = np.flatnonzero((tree.parent >= 0) & (tree.flexibility > 0.0))
    root = np.sqrt(tree.flexibility[spring])
    fixed = np.unique(bodies.body[bodies.fixed])
    first = np.unique(bodies.component[fixed], return_index=True)[1]

    # Whether a station is at the outer end of a spring, or beyond; else in the same part, or in another.
    beyond = np.eye(tree.size, dtype=bool)
    for station, parent, _ in tree.steps:
        beyond[parent] |= beyond[station]
    beyond = beyond.T[:, spring]
    before = (bodies.component[:, None] == bodies.component[spring]) & ~beyond

    # The weighted mean of the angles of a part is zero; of one that is fixed the weight is at its first fixed station.
    is_fixed = np.isin(bodies.component, bodies.component[fixed])
    weight = np.where(is_fixed, 0.0, tree.moving_inertia)
    weight[fixed[first]] = 1.0
    outer, inner = weight @ beyond, weight @ before
    total = outer + inner
    total[total == 0.0] = 1.0
    angle = (np.where(beyond, inner / total, 0.0) - np.where(before, outer / total, 0.0)) * root

    bend, ties = np.eye(len(spring)), angle[np.delete(fixed, first)]
    if len(ties):
        ties = ties / np.linalg.norm(ties, axis=1, keepdims=True)
        bend = np.linalg.qr(ties.T, mode="complete")[0][:, len(ties) :]
        angle = angle @ bend
    angle[bodies.fixed] = 0.0
    return spring, root, bend, angle
