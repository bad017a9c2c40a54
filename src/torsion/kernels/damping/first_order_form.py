"""First-order form of a damped tree: rough eigenvalues to start from, and how many roots there are in truth."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.sweeps import Layout, layout
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class DampedTree:
    """A tree and its damping, one value a station or span."""

    tree: Tree
    ground: FloatArray  # (stations,) N m s/rad, viscous to ground
    viscous: FloatArray  # (stations,) N m s/rad, viscous in span i
    loss_factor: FloatArray  # (stations,) of span i

    @cached_property
    def plan(self) -> Layout:
        """What sweeps need to know of the tree."""
        return layout(self.tree, self.tree.flexibility)


def zero_roots(train: DampedTree) -> tuple[int, int]:
    """How often 0 is a root of det T, and of the first-order form: parts free to turn count, once or twice.

    A part that no spring ties to ground can stand at any angle, one that no damper ties either can turn at any speed.
    A part fixed at several places can keep torques against itself, which only the first-order form sees.
    """
    tree = train.tree
    springs = _parts(tree, np.array(train.plan.rigid) | np.isfinite(tree.flexibility))
    everything = _parts(tree, np.ones(tree.size, dtype=bool))
    standing = set(springs.tolist()) - set(springs[tree.held].tolist())
    turning = set(everything.tolist()) - set(everything[tree.held | (train.ground > 0)].tolist())
    for part in turning:
        if not (tree.inertia[everything == part] > 0).any():
            raise ValueError("a part of the train has neither inertia nor a support; expected one of them")
    group = _parts(tree, np.array(train.plan.rigid))
    movable = set(group.tolist()) - set(group[tree.held].tolist())
    elastic = np.count_nonzero((tree.parent >= 0) & ~np.array(train.plan.rigid) & np.isfinite(tree.flexibility))
    locked = int(elastic) - (len(movable) - len(standing))
    return len(standing) + len(turning), len(turning) + locked


def _parts(tree: Tree, joined: np.ndarray) -> IntArray:
    """Number of the part of each station when only the spans `joined` hold."""
    part = np.arange(tree.size)
    for station, parent in enumerate(tree.parent.tolist()):
        if parent >= 0 and joined[station]:
            part[station] = part[parent]
    return part


def first_order_eigenvalues(train: DampedTree) -> np.ndarray:
    """Eigenvalues of the first-order form in sqrt(J) speed and torque/sqrt(k), skew-symmetric where undamped.

    Rigid spans are merged, massless stations are eliminated: where dampers act on them by their speeds, else by
    the balance of torques. All eigenvalues are returned, the structural zeros among them.
    """
    tree, (inertia, ground, ends, spans) = train.tree, _merge(train)
    count = len(inertia)
    elastic = [i for i in spans if np.isfinite(tree.flexibility[i])]
    G = np.zeros((len(elastic), count))
    for row, i in enumerate(elastic):
        G[row] = _relative(ends[i], count) / np.sqrt(tree.flexibility[i])
    C = np.diag(ground)
    for i in spans:
        direction = _relative(ends[i], count)
        C += train.viscous[i] * np.outer(direction, direction)
    slow = _slow_groups(inertia, ground, [ends[i] for i in spans if train.viscous[i] > 0])
    return np.linalg.eigvals(_condense(inertia, C, G, *slow))


def _merge(train: DampedTree) -> tuple[FloatArray, FloatArray, dict[int, tuple[int, int]], list[int]]:
    """Inertia and ground damping of the rigid groups that can move; the groups that each elastic span joins."""
    tree = train.tree
    group = _parts(tree, np.array(train.plan.rigid))
    fixed = set(group[tree.held].tolist())
    number = {part: place for place, part in enumerate(sorted(set(group.tolist()) - fixed))}
    inertia, ground = np.zeros(len(number)), np.zeros(len(number))
    for station, part in enumerate(group.tolist()):
        if part not in fixed:
            inertia[number[part]] += tree.inertia[station]
            ground[number[part]] += train.ground[station]
    spans = [i for i in range(tree.size) if tree.parent[i] >= 0 and not train.plan.rigid[i]]
    place = [number.get(part, -1) for part in group.tolist()]
    return inertia, ground, {i: (place[i], place[int(tree.parent[i])]) for i in spans}, spans


def _relative(ends: tuple[int, int], count: int) -> FloatArray:
    row = np.zeros(count)
    for end, sign in zip(ends, (1.0, -1.0), strict=True):
        if end >= 0:
            row[end] += sign
    return row


def _condense(inertia: FloatArray, C: FloatArray, G: FloatArray, balanced: FloatArray, slowed: IntArray) -> FloatArray:
    """The matrix of the first-order form; stations without inertia condensed (`_slow_groups`)."""
    heavy = np.flatnonzero(inertia > 0)
    torques = np.eye(len(G))
    if len(balanced):
        whole, _ = np.linalg.qr(G @ balanced.T, mode="complete")
        torques = whole[:, len(balanced) :]
    root = 1 / np.sqrt(inertia[heavy])
    speed_speed = C[np.ix_(heavy, heavy)] * np.outer(root, root)
    torque_speed = torques.T @ G[:, heavy] * root
    matrix = np.block([[-speed_speed, -torque_speed.T], [torque_speed, np.zeros((torques.shape[1],) * 2)]])
    if len(slowed):
        coupled = C[np.ix_(slowed, heavy)] * root
        turned = G[:, slowed].T @ torques
        right = np.hstack([-coupled, -turned])
        left = np.vstack([-coupled.T, turned.T])
        matrix += left @ np.linalg.solve(C[np.ix_(slowed, slowed)], right)
    return matrix


def _slow_groups(
    inertia: FloatArray, ground: FloatArray, dampers: list[tuple[int, int]]
) -> tuple[FloatArray, IntArray]:
    """Stations without inertia by what sets their speed, from the graph alone.

    First (groups, stations) 1 where in a group that no damper ties to anything: its torques balance. Then the numbers
    of the others, and of all but one of each balanced group: dampers set their speed.
    """
    light = inertia == 0
    group = np.arange(len(inertia))
    for first, second in dampers:
        if min(first, second) >= 0 and light[first] and light[second]:
            group[group == group[first]] = group[second]
    tied = set(group[ground > 0].tolist())
    for first, second in dampers:
        for one, other in ((first, second), (second, first)):
            if one >= 0 and light[one] and (other < 0 or not light[other]):
                tied.add(int(group[one]))
    free = [part for part in sorted(set(group[light].tolist())) if part not in tied]
    first_of = {int(np.flatnonzero(light & (group == part))[0]) for part in free}
    slowed = [station for station in np.flatnonzero(light).tolist() if station not in first_of]
    balanced = np.array([(light & (group == part)).astype(float) for part in free]).reshape(len(free), len(inertia))
    return balanced, np.array(slowed, dtype=np.int64)
