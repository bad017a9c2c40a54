"""The train of its moving inertias only: rigid spans merged, massless stations eliminated, without a subtraction.

Adding inertias merges a rigid span; the star-mesh rule k_ij += k_i k_j / sum(k) eliminates a massless station. Both
only add, multiply and divide positive numbers, so that every frequency keeps its relative accuracy.
"""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree


@dataclass(frozen=True)
class Rigidity:
    """What the graph alone says: which stations move as one, and which parts are free to turn."""

    body: IntArray  # (stations,) the first station of the rigid body that each one belongs to
    fixed: BoolArray  # (stations,) joined rigidly to a held station, or held
    component: IntArray  # (stations,) root of the part each one belongs to
    free_roots: IntArray  # (rigid motions,) root of every part with inertia and no held station
    elastic: int  # number of natural frequencies other than 0


@dataclass(frozen=True)
class ReducedTrain:
    """Inertias (bodies,) kg m2 joined by springs (springs,) N m/rad and each tied to ground by `ground` (bodies,)."""

    inertia: FloatArray
    inner: IntArray  # (springs,)
    outer: IntArray  # (springs,)
    stiffness: FloatArray
    ground: FloatArray
    acyclic: bool  # False where the elimination of a massless station has closed a loop


def rigidity(tree: Tree) -> Rigidity:
    """Rigid bodies, fixed stations and free parts of a tree."""
    size, parents, rigid = tree.size, tree.parent.tolist(), (tree.flexibility == 0.0).tolist()
    body, component = list(range(size)), list(range(size))
    for station, parent in enumerate(parents):
        if parent >= 0:
            component[station] = component[parent]
            if rigid[station]:
                body[station] = body[parent]
    bodies, components = np.array(body, dtype=np.int64), np.array(component, dtype=np.int64)
    fixed = np.bincount(bodies, tree.held, minlength=size)[bodies] > 0
    inertia = np.bincount(bodies, np.where(fixed, 0.0, tree.moving_inertia), minlength=size)
    heavy = np.bincount(components, inertia, minlength=size) > 0
    grounded = np.bincount(components, tree.held, minlength=size) > 0
    free_roots = np.flatnonzero(heavy & ~grounded)
    return Rigidity(bodies, fixed, components, free_roots, int(np.count_nonzero(inertia)) - len(free_roots))


def reduce_tree(
    tree: Tree, known: Rigidity, closing: tuple[IntArray, IntArray, FloatArray] | None = None
) -> ReducedTrain:
    """The moving inertias of a tree and the springs between them, with the spans that close loops, if any.

    `closing` gives the stations at both ends and the flexibility (loops,) rad/(N m), positive.
    """
    total = np.bincount(known.body, tree.moving_inertia, minlength=tree.size).astype(np.float64)
    heads = np.flatnonzero((known.body == np.arange(tree.size)) & ~known.fixed)
    number = np.full(tree.size, -1, dtype=np.int64)
    number[heads] = np.arange(len(heads))
    spans = np.flatnonzero((tree.parent >= 0) & (tree.flexibility > 0.0))
    outer, inner, stiffness = spans, tree.parent[spans], 1.0 / tree.flexibility[spans]
    if closing is not None:
        inner, outer = np.append(inner, closing[0]), np.append(outer, closing[1])
        stiffness = np.append(stiffness, 1.0 / closing[2])
    outer, inner = number[known.body[outer]], number[known.body[inner]]
    moving = (outer >= 0) & (inner >= 0) & (outer != inner)
    ground = np.zeros(len(heads))
    for tied, other in ((outer, inner), (inner, outer)):
        to_ground = (tied >= 0) & (other < 0)
        np.add.at(ground, tied[to_ground], stiffness[to_ground])
    acyclic = closing is None
    whole = ReducedTrain(total[heads], inner[moving], outer[moving], stiffness[moving], ground, acyclic)
    return whole if np.all(whole.inertia > 0.0) else _without_massless(whole)


def _without_massless(train: ReducedTrain) -> ReducedTrain:
    """The same train with every massless body eliminated by the star-mesh rule, outermost first."""
    neighbours: list[dict[int, float]] = [{} for _ in train.inertia]
    for a, b, k in zip(train.inner.tolist(), train.outer.tolist(), train.stiffness.tolist(), strict=True):
        neighbours[a][b] = neighbours[b][a] = neighbours[a].get(b, 0.0) + k
    ground, acyclic = train.ground.tolist(), train.acyclic
    for body in np.flatnonzero(train.inertia == 0.0)[::-1].tolist():
        star = list(neighbours[body].items())
        acyclic = acyclic and len(star) + (ground[body] > 0.0) <= 2
        total = sum(neighbours[body].values()) + ground[body]
        for position, (a, k) in enumerate(star):
            del neighbours[a][body]
            ground[a] += k * (ground[body] / total)
            for b, other in star[:position]:
                neighbours[a][b] = neighbours[b][a] = neighbours[a].get(b, 0.0) + k * (other / total)
    kept = np.flatnonzero(train.inertia > 0.0)
    number = {body: position for position, body in enumerate(kept.tolist())}
    springs = sorted((number[a], number[b], k) for a in number for b, k in neighbours[a].items() if a < b)
    return ReducedTrain(
        inertia=train.inertia[kept],
        inner=np.array([a for a, _, _ in springs], dtype=np.int64),
        outer=np.array([b for _, b, _ in springs], dtype=np.int64),
        stiffness=np.array([k for _, _, k in springs], dtype=np.float64),
        ground=np.array(ground)[kept],
        acyclic=acyclic,
    )
