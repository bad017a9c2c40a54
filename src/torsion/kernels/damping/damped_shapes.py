"""Shapes and torques of damped modes from the dynamic stiffness of both sides, by products along the train."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import qr, solve_triangular

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.damping.damped_roots import DampedTree
from torsion.kernels.sweeps import EPS, Layout, Rows, branches, guarded_sum, share
from torsion.kernels.tree import Tree

UNRESOLVED = 1e-8  # of the largest column: below it, the shapes of a repeated root are not independent


@dataclass(frozen=True)
class BothSides:
    """Dynamic stiffness at each root; rows over roots, None where infinite."""

    compliance: ComplexArray  # (stations, roots) hc, rad/(N m)
    branch: Rows  # z, N m/rad: of a station and all beyond it
    rest: Rows  # zd: of all but that branch, at the parent
    whole: ComplexArray  # (stations, roots) Z, N m/rad, of the whole train at a station; infinite where prescribed


def both_sides(train: DampedTree, root: ComplexArray) -> BothSides:
    """Dynamic stiffness l^2 J + l C + K(1 + i eta) of the train as every station sees it."""
    plan, size, soft = train.plan, train.plan.size, train.tree.flexibility > 0
    own = train.ground[:, None] * root + train.tree.inertia[:, None] * root * root
    hc = np.zeros((size, len(root)), dtype=np.complex128)
    stiffness = (1 + 1j * train.loss_factor[soft]) / train.tree.flexibility[soft]
    hc[soft] = 1 / (stiffness[:, None] + train.viscous[soft, None] * root)
    found = branches(plan, list(own), list(hc), [0.0] * size, guard=True)
    rest: Rows = [None] * size
    whole = np.full((size, len(root)), np.inf, dtype=np.complex128)
    for station in range(size):
        parent, z = plan.parent[station], found.stiffness[station]
        if plan.prescribed[station]:
            continue
        through: Any = 0.0
        if parent >= 0 and plan.prescribed[parent]:
            through = 1 / hc[station]
        elif parent >= 0:
            through = rest[station] / guarded_sum(hc[station] * rest[station], guard=True)
        whole[station] = z + through
        share(plan.children[station], found.stiffness_through, rest, own[station] + through)
    return BothSides(hc, found.stiffness, rest, whole)


def shapes_from(plan: Layout, at: BothSides, pushed: IntArray) -> tuple[ComplexArray, ComplexArray]:
    """Angles and torques, both (stations, roots), when station `pushed` (roots,) turns by 1."""
    size, count = plan.size, len(pushed)
    angle, torque = (np.zeros((size, count), dtype=np.complex128) for _ in range(2))
    reached = np.zeros((size, count), dtype=bool)
    angle[pushed, np.arange(count)] = 1
    reached[pushed, np.arange(count)] = True
    for i in range(size - 1, -1, -1):
        parent, on = plan.parent[i], reached[i]
        if parent < 0 or plan.prescribed[i] or not on.any():
            continue
        hc = at.compliance[i][on]
        if plan.prescribed[parent]:
            torque[i, on] = -angle[i, on] / hc
            continue
        zd = at.rest[i][on]
        turned = angle[i, on] / guarded_sum(hc * zd, guard=True)
        angle[parent, on] = turned
        reached[parent] |= on
        torque[i, on] = -zd * turned
    for i in range(size):
        parent = plan.parent[i]
        if parent < 0 or plan.prescribed[parent]:
            continue
        hc, x = at.compliance[i], angle[parent]
        if plan.held[i]:
            torque[i] = x / hc
            continue
        turned = x / guarded_sum(hc * at.branch[i], guard=True)
        angle[i] = np.where(reached[i], angle[i], turned)
        torque[i] = np.where(reached[i], torque[i], at.branch[i] * turned)
    for i in range(size - 1, -1, -1):  # a rigid span to a fixed station carries what the spans beyond it carry
        if plan.prescribed[i] and plan.parent[i] >= 0 and not plan.held[i]:
            torque[i] = sum((torque[child] for child in plan.children[i]), np.zeros(count))
    return angle, torque


def most_active(tree: Tree, whole: ComplexArray) -> IntArray:
    """The station of least |Z|/J at each root, (roots,): where the mode is best seen."""
    inertia = np.where(tree.held, 0.0, tree.inertia)[:, None]
    with np.errstate(all="ignore"):
        ease = inertia / np.abs(whole)
    ease[np.isnan(ease) & (inertia > 0)] = 0
    best: IntArray = np.argmax(np.nan_to_num(ease, nan=0.0, posinf=np.inf), axis=0)
    return best


def newton_step(
    train: DampedTree, at: BothSides, root: ComplexArray, pushed: IntArray, shape: ComplexArray, torque: ComplexArray
) -> ComplexArray:
    """Correction of each root, -Z/Z', from the shape in which station `pushed` turns by 1."""
    wound = at.compliance * torque
    slope = ((train.ground[:, None] + 2 * root * train.tree.inertia[:, None]) * shape * shape).sum(axis=0)
    slope += (train.viscous[:, None] * wound * wound).sum(axis=0)
    step: ComplexArray = -at.whole[pushed, np.arange(len(root))] / slope
    return step


def independent_shapes(train: DampedTree, root: complex, count: int) -> tuple[ComplexArray, ComplexArray] | None:
    """Angles and torques (stations, count) of a root that comes `count` times, orthogonal as J weighs them.

    The train is pushed at every station in turn; the best independent answers are kept. None if there are too few.
    """
    tree, size = train.tree, train.plan.size
    at = both_sides(train, np.full(size, root))
    angle, torque = shapes_from(train.plan, at, np.arange(size))
    weight = np.sqrt(np.where(tree.held, 0.0, tree.inertia))
    receptance = np.diag(at.whole)
    floor = EPS * np.abs(root * root) * tree.inertia
    push = weight / np.where(np.abs(receptance) <= floor, np.maximum(floor, np.finfo(float).tiny), receptance)
    sound = np.isfinite(push) & np.isfinite(angle).all(axis=0) & np.isfinite(torque).all(axis=0)
    angle, torque = (np.where(sound, part * push, 0) for part in (angle, torque))
    _, triangle, order = qr(weight[:, None] * angle, mode="economic", pivoting=True)
    triangle = triangle[:count, :count]
    if abs(triangle[-1, -1]) <= UNRESOLVED * abs(triangle[0, 0]):
        return None
    chosen = order[:count]
    return tuple(solve_triangular(triangle, part[:, chosen].T, trans="T").T for part in (angle, torque))  # type: ignore[return-value]


def decay(
    train: DampedTree, at: BothSides, root: ComplexArray, shape: ComplexArray, torque: ComplexArray
) -> FloatArray:
    """Real part of each root, (roots,) 1/s, to full relative accuracy however small: x* T(l) x = 0 is a quadratic.

    l^2 m + l c + k(1 + i eta) = 0 with m, c, k sums of positive terms gives Re l = -(c + sum k eta |.|^2/Im l)/(2m).
    """
    wound = np.abs(at.compliance * torque) ** 2
    inertia = (train.tree.inertia[:, None] * np.abs(shape) ** 2).sum(axis=0)
    lost = (train.ground[:, None] * np.abs(shape) ** 2).sum(axis=0) + (train.viscous[:, None] * wound).sum(axis=0)
    loss = np.where(train.loss_factor > 0, train.loss_factor, 0.0)
    stiffness = np.divide(loss, train.tree.flexibility, out=np.zeros_like(loss), where=train.tree.flexibility > 0)
    lost = lost + (stiffness[:, None] * wound).sum(axis=0) / root.imag
    real: FloatArray = -lost / (2 * inertia)
    return real
