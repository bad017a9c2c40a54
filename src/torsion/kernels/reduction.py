"""The train of its moving inertias only: rigid spans merged, massless stations eliminated, without a subtraction.

Adding inertias merges a rigid span; the star-mesh rule k_ij += k_i k_j / sum(k) eliminates a massless station. Both
only add, multiply and divide positive numbers, so that every frequency keeps its relative accuracy.
"""

import math
from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.tree import Tree


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

    inertia: FloatArray
    inner: IntArray  # (springs,)
    outer: IntArray  # (springs,)
    stiffness: FloatArray
    ground: FloatArray
    acyclic: bool  # False where the elimination of a massless station has closed a loop


def rigidity(tree: Tree) -> Rigidity:
    """Rigid bodies, fixed stations and free parts of a tree."""
    size, parents = tree.size, tree.parents
    if tree.is_plain:
        none = np.zeros(size, dtype=np.int64)
        return Rigidity(np.arange(size), none.astype(np.bool_), none, none[:1], size - 1)
    rigid = (tree.flexibility == 0.0).tolist()
    body, component = list(range(size)), list(range(size))
    for station, parent in enumerate(parents):
        if parent >= 0:
            component[station] = component[parent]
            if rigid[station]:
                body[station] = body[parent]
    fixed_bodies = {body[station] for station in np.flatnonzero(tree.held).tolist()} if tree.holds else set()
    grounded = {component[station] for station in fixed_bodies}
    heavy = {b for b, inertia in zip(body, tree.moving_inertia.tolist(), strict=True) if inertia > 0.0} - fixed_bodies
    free_roots = sorted({component[b] for b in heavy} - grounded)
    return Rigidity(
        body=np.array(body, dtype=np.int64),
        fixed=np.array([b in fixed_bodies for b in body], dtype=bool),
        component=np.array(component, dtype=np.int64),
        free_roots=np.array(free_roots, dtype=np.int64),
        elastic=len(heavy) - len(free_roots),
    )


def rigid_shapes(tree: Tree, known: Rigidity) -> FloatArray:
    """Angles (stations, rigid motions) rad, constant over each free part and mass-normalised."""
    if tree.is_plain:
        return np.full((tree.size, 1), 1.0 / math.sqrt(tree.inertia.sum()))
    part = known.component[:, None] == known.free_roots
    scaled: FloatArray = part / np.sqrt(tree.moving_inertia @ part)
    return scaled


def reduce_tree(
    tree: Tree, known: Rigidity, chords: tuple[IntArray, IntArray, FloatArray] | None = None
) -> ReducedTrain:
    """The moving inertias of a tree and the springs between them, with the spans that close loops, if any.

    `chords` gives the stations at both ends and the flexibility (loops,) rad/(N m), positive.
    """
    if tree.is_plain and chords is None:
        inner, outer = tree.parent[1:], known.body[1:]
        return ReducedTrain(tree.inertia, inner, outer, 1.0 / tree.flexibility[1:], np.zeros(tree.size), True)
    number, total = _bodies(tree, known)
    joined = [(p, i, h) for i, (p, h) in enumerate(zip(tree.parents, tree.flexibility.tolist(), strict=True)) if p >= 0]
    if chords is not None:
        joined += zip(*(part.tolist() for part in chords), strict=True)
    springs, ground = [], [0.0] * len(total)
    for near, far, flexibility in joined:
        one, other = number[near], number[far]
        if flexibility > 0.0 and one != other:
            if one >= 0 and other >= 0:
                springs.append((one, other, 1.0 / flexibility))
            else:
                ground[max(one, other)] += 1.0 / flexibility
    whole = _train(total, springs, ground, chords is None)
    return whole if min(total, default=1.0) > 0.0 else _without_massless(whole)


def _bodies(tree: Tree, known: Rigidity) -> tuple[list[int], list[float]]:
    """Number of the moving body of each station, -1 where it is fixed, and the inertia of each body, kg m2."""
    number, total = list[int](), list[float]()
    inertias, fixed = tree.moving_inertia.tolist(), known.fixed.tolist()
    for station, (body, inertia) in enumerate(zip(known.body.tolist(), inertias, strict=True)):
        if fixed[station]:
            number.append(-1)
        elif body == station:
            number.append(len(total))
            total.append(inertia)
        else:
            number.append(number[body])
            total[number[body]] += inertia
    return number, total


def _train(
    inertia: list[float], springs: list[tuple[int, int, float]], ground: list[float], acyclic: bool
) -> ReducedTrain:
    inner, outer, stiffness = zip(*springs, strict=True) if springs else ((), (), ())
    return ReducedTrain(
        inertia=np.array(inertia, dtype=np.float64),
        inner=np.array(inner, dtype=np.int64),
        outer=np.array(outer, dtype=np.int64),
        stiffness=np.array(stiffness, dtype=np.float64),
        ground=np.array(ground, dtype=np.float64),
        acyclic=acyclic,
    )


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
    return _train(train.inertia[kept].tolist(), springs, [ground[body] for body in number], acyclic)
