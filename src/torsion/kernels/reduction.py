"""The train of its moving inertias only: rigid spans merged, massless stations eliminated, without a subtraction.

Adding inertias merges a rigid span; the star-mesh rule k_ij += k_i k_j / sum(k) eliminates a massless station. Both
only add, multiply and divide positive numbers, so that every frequency keeps its relative accuracy. What rigid spans
join to a fixed station does not move, and their torques are sums of reactions.
"""

from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.tree import Tree, walk


@dataclass(frozen=True)
class Rigidity:
    """What the graph alone says: which stations move as one, and which parts are free to turn."""

    body: IntArray  # (stations,) the first station of the rigid body that each one belongs to
    fixed: BoolArray  # (stations,) `held`, or joined rigidly to such a station
    component: IntArray  # (stations,) root of the part each one belongs to
    free_roots: IntArray  # (rigid motions,) root of every part with inertia and no fixed station
    elastic: int  # number of natural frequencies other than 0


@dataclass(frozen=True)
class ReducedTrain:
    """Inertias (bodies,) kg m2 joined by springs (springs,) N m/rad and each tied to ground by `ground` (bodies,)."""

    head: IntArray  # (bodies,) the first station of each body
    inertia: FloatArray
    inner: IntArray  # (springs,)
    outer: IntArray  # (springs,)
    stiffness: FloatArray
    ground: FloatArray


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
    fixed_bodies = (
        {body[station] for station in np.flatnonzero(tree.held).tolist()} if tree.holds else set()
    )
    grounded = {component[station] for station in fixed_bodies}
    heavy = {
        b for b, inertia in zip(body, tree.moving_inertia.tolist(), strict=True) if inertia > 0.0
    } - fixed_bodies
    free_roots = sorted({component[b] for b in heavy} - grounded)
    return Rigidity(
        body=np.array(body, dtype=np.int64),
        fixed=np.array([b in fixed_bodies for b in body], dtype=bool),
        component=np.array(component, dtype=np.int64),
        free_roots=np.array(free_roots, dtype=np.int64),
        elastic=len(heavy) - len(free_roots),
    )


def rigid_shapes(tree: Tree, bodies: Rigidity) -> FloatArray:
    """Angles (stations, rigid motions) rad, constant over each free part and mass-normalised."""
    part = bodies.component[:, None] == bodies.free_roots
    scaled: FloatArray = part / np.sqrt(tree.moving_inertia @ part)
    return scaled


def reduce_tree(
    tree: Tree, bodies: Rigidity, chords: tuple[IntArray, IntArray, FloatArray] | None = None
) -> ReducedTrain:
    """The moving inertias of a tree and the springs between them, with the spans that close loops, if any.

    `chords` gives the stations at both ends and the flexibility (loops,) rad/(N m), positive.
    """
    stations = np.arange(tree.size)
    head = np.flatnonzero((bodies.body == stations) & ~bodies.fixed)
    number = np.full(tree.size, -1)
    number[head] = np.arange(len(head))
    number = number[bodies.body]  # of the moving body of each station; -1 where it is fixed
    spans = tree.parent, stations, tree.flexibility
    near, far, flexibility = (
        spans if chords is None else (np.append(*pair) for pair in zip(spans, chords, strict=True))
    )
    near_body, far_body = number[near], number[far]
    is_soft = (near >= 0) & (flexibility > 0.0) & (near_body != far_body)
    is_between = np.minimum(near_body, far_body) >= 0
    spring, tie = is_soft & is_between, is_soft & ~is_between
    inertia, ground = (
        np.asarray(np.bincount(bodies.body, tree.moving_inertia), dtype=np.float64),
        np.zeros(len(head)),
    )
    np.add.at(ground, np.maximum(near_body, far_body)[tie], 1.0 / flexibility[tie])
    train = ReducedTrain(
        head=head,
        inertia=inertia[head],
        inner=near_body[spring],
        outer=far_body[spring],
        stiffness=1.0 / flexibility[spring],
        ground=ground,
    )
    return train if train.inertia.min(initial=1.0) > 0.0 else _without_massless(train)


def _without_massless(train: ReducedTrain) -> ReducedTrain:
    """The same train with every massless body eliminated by the star-mesh rule, outermost first."""
    neighbours: list[dict[int, float]] = [{} for _ in train.inertia]
    for a, b, k in zip(
        train.inner.tolist(), train.outer.tolist(), train.stiffness.tolist(), strict=True
    ):
        neighbours[a][b] = neighbours[b][a] = neighbours[a].get(b, 0.0) + k
    ground = train.ground.tolist()
    for body in np.flatnonzero(train.inertia == 0.0)[::-1].tolist():
        star = list(neighbours[body].items())
        total = sum(neighbours[body].values()) + ground[body]
        for position, (a, k) in enumerate(star):
            del neighbours[a][body]
            ground[a] += k * (ground[body] / total)
            for b, k_other in star[:position]:
                neighbours[a][b] = neighbours[b][a] = neighbours[a].get(b, 0.0) + k * (
                    k_other / total
                )
    kept = np.flatnonzero(train.inertia > 0.0)
    number = {body: position for position, body in enumerate(kept.tolist())}
    springs = sorted(
        (number[a], number[b], k) for a in number for b, k in neighbours[a].items() if a < b
    )
    inner, outer, stiffness = np.array(springs, dtype=np.float64).reshape(-1, 3).T
    ends = inner.astype(np.int64), outer.astype(np.int64)
    return ReducedTrain(
        train.head[kept], train.inertia[kept], *ends, stiffness, np.array(ground)[kept]
    )


def cut(tree: Tree, bodies: Rigidity) -> Tree:
    """The tree with every fixed station `held` and the rigid spans between them taken out; itself if there are none."""
    if not (tree.holds and _inside(tree, bodies).any()):
        return tree
    return replace(tree, parent=np.where(_inside(tree, bodies), -1, tree.parent), held=bodies.fixed)


def with_reactions(
    tree: Tree, bodies: Rigidity, torque: FloatArray, outside: FloatArray | float = 0.0
) -> FloatArray:
    """Torque (stations, m) of the cut tree, completed in the rigid spans between fixed stations by equilibrium.

    `outside` (stations, m) N m is what acts on each station besides its spans.

    Where a body is fixed more than once, the shares are not determined: the fixed station numbered first takes all.
    """
    inside, stations = _inside(tree, bodies), np.arange(tree.size)
    load = np.where(tree.parent[:, None] >= 0, torque, 0.0) + outside
    for station, parent in enumerate(tree.parents):
        if parent >= 0 and not inside[station]:
            load[parent] -= torque[station]
    full = torque.copy()
    way = walk(tree.size, tree.parent, stations, inside, np.flatnonzero(tree.held).tolist())
    for station in way.order[::-1].tolist():
        nearer, span = way.parent[station], way.above[station]
        if nearer >= 0:
            full[span] = -load[station] if span == station else load[station]
            load[nearer] += load[station]
    return full


def _inside(tree: Tree, bodies: Rigidity) -> BoolArray:
    """Stations (stations,) whose span is rigid and joins fixed stations."""
    return np.asarray(bodies.fixed & (tree.static.flexibility == 0.0) & (tree.parent >= 0))


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
    angle = _angles(tree, bodies.component, spring, fixed[first]) * root
    bend, ties = np.eye(len(spring)), angle[np.delete(fixed, first)]
    if len(ties):
        ties = ties / np.linalg.norm(ties, axis=1, keepdims=True)
        bend = np.linalg.qr(ties.T, mode="complete")[0][:, len(ties) :]
        angle = angle @ bend
    angle[bodies.fixed] = 0.0
    return spring, root, bend, angle


def _angles(tree: Tree, component: IntArray, spring: IntArray, fixed: IntArray) -> FloatArray:
    """Angles (stations, springs) for a twist of 1 in each, such that the weighted mean of a part's angles is zero.

    The weight is the inertia; in a part that is fixed it is only at the first of its `fixed` stations.
    """
    weight = np.where(np.isin(component, component[fixed]), 0.0, tree.moving_inertia)
    weight[fixed] = 1.0
    beyond = _beyond(tree)[:, spring]
    before = (component[:, None] == component[spring]) & ~beyond
    outer, inner = weight @ beyond, weight @ before
    total = outer + inner
    total[total == 0.0] = 1.0
    return np.where(beyond, inner / total, 0.0) - np.where(before, outer / total, 0.0)


def _beyond(tree: Tree) -> BoolArray:
    """(stations, stations) whether a station is at the outer end of a span, or beyond."""
    beyond = np.eye(tree.size, dtype=np.bool_)
    for i in range(tree.size - 1, -1, -1):
        if tree.parents[i] >= 0:
            beyond[tree.parents[i]] |= beyond[i]
    return beyond.T
