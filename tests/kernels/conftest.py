"""References for the modal kernels in many digits, and the families of trains they are compared on."""

from collections.abc import Callable
from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.trees.tree import Tree

DIGITS = 120


@dataclass(frozen=True)
class ExactModes:
    """Elastic modes, ascending: lists of mpf [mode], [mode][station], [mode][span], [mode][loop]."""

    frequency: list
    angle: list
    torque: list
    loop_torque: list


@pytest.fixture
def random_tree() -> Callable[..., Tree]:
    """A tree with k 1..1e12 and J 1e-6..1e4 spread evenly over the decades, fixed at root and leaves as requested."""

    def draw(seed: int, *, size: int, shape: str = "branched", held: str = "none") -> Tree:
        rng = np.random.default_rng(seed)
        reach = {"chain": 1, "branched": 3, "bushy": size}[shape]
        parent = np.array([-1] + [int(rng.integers(max(0, i - reach), i)) for i in range(1, size)])
        leaves = ~np.isin(np.arange(size), parent)
        fixed = {
            "none": np.zeros(size, bool),
            "root": np.arange(size) == 0,
            "leaves": leaves & (np.arange(size) > 0),
        }
        return Tree(
            parent, 10 ** -rng.uniform(0, 12, size), 10 ** rng.uniform(-6, 4, size), fixed[held]
        )

    return draw


@pytest.fixture
def chain() -> Callable[..., Tree]:
    """A chain of given inertias and stiffnesses; `held` lists stations."""

    def build(inertia: list[float], stiffness: list[float], held: tuple[int, ...] = ()) -> Tree:
        size = len(inertia)
        flexibility = np.array([0.0, *(1.0 / np.asarray(stiffness, dtype=float))])
        return Tree(
            np.arange(-1, size - 1),
            flexibility,
            np.array(inertia, float),
            np.isin(np.arange(size), held),
        )

    return build


@pytest.fixture
def exact_count() -> Callable[[Tree, float], int]:
    """Number of frequencies below w, from the pivots of the elimination in many digits."""
    return _exact_count


@pytest.fixture
def exact_modes() -> Callable[..., ExactModes]:
    """Elastic modes of a train, from the assembled matrices in many digits."""
    return _exact_modes


@pytest.fixture
def shuffled_loops() -> Callable[..., tuple[Tree, np.ndarray, np.ndarray, np.ndarray]]:
    """`tree` and random spans that close it."""

    def draw(tree: Tree, seed: int, loops: int) -> tuple[Tree, np.ndarray, np.ndarray, np.ndarray]:
        rng = np.random.default_rng(seed)
        first = rng.integers(0, tree.size, loops)
        second = (first + rng.integers(1, tree.size, loops)) % tree.size
        return tree, first, second, 10 ** rng.uniform(-12, 0, loops)

    return draw


def _exact_count(tree: Tree, w: float) -> int:
    with mp.workdps(DIGITS):
        square, count = mp.mpf(float(w)) ** 2, 0
        seen = [
            mp.inf if held else -square * mp.mpf(float(j))
            for held, j in zip(tree.held, tree.inertia, strict=True)
        ]
        for i in range(tree.size - 1, -1, -1):
            count += seen[i] < 0
            if tree.parent[i] >= 0:
                inverse = (
                    mp.mpf(0) if mp.isinf(seen[i]) else (mp.inf if seen[i] == 0 else 1 / seen[i])
                )
                pivot = mp.mpf(float(tree.flexibility[i])) + inverse
                count -= pivot < 0
                passed = mp.mpf(0) if mp.isinf(pivot) else (mp.inf if pivot == 0 else 1 / pivot)
                seen[tree.parent[i]] += passed
        return int(count)


def _exact_modes(tree: Tree, first=(), second=(), flexibility=()) -> ExactModes:
    with mp.workdps(DIGITS):
        body = _bodies(tree)
        fixed = {body[i] for i in range(tree.size) if tree.held[i]}
        mass = {b: mp.mpf(0) for b in body if b not in fixed}
        for i, b in enumerate(body):
            if b in mass:
                mass[b] += mp.mpf(float(tree.inertia[i]))
        spans = [(int(p), i, tree.flexibility[i]) for i, p in enumerate(tree.parent) if p >= 0]
        loops = list(zip(map(int, first), map(int, second), flexibility, strict=True))
        matrix = _stiffness(
            [(body[a], body[b], h) for a, b, h in spans + loops if h > 0], list(mass)
        )
        frequency, shapes = _eigen(matrix, list(mass), mass)
        angle = [[shape.get(body[i], mp.mpf(0)) for i in range(tree.size)] for shape in shapes]
        torque = [_torques(tree, w, x) for w, x in zip(frequency, angle, strict=True)]
        closing = [[(x[a] - x[b]) / mp.mpf(float(h)) for a, b, h in loops] for x in angle]
        return ExactModes(frequency, angle, torque, closing)


def _bodies(tree: Tree) -> list[int]:
    body = list(range(tree.size))
    for i, p in enumerate(tree.parent.tolist()):
        if p >= 0 and tree.flexibility[i] == 0:
            body[i] = body[p]
    return body


def _stiffness(spans, moving):
    row = {b: n for n, b in enumerate(moving)}
    matrix = mp.zeros(len(moving))
    for a, b, h in spans:
        k = 1 / mp.mpf(float(h))
        for p, q in ((a, b), (b, a)):
            if p in row:
                matrix[row[p], row[p]] += k
                if q in row:
                    matrix[row[p], row[q]] -= k
    return matrix


def _eigen(matrix, moving, mass):
    """Frequencies and {body: angle} of the elastic modes; massless bodies by a Schur complement."""
    heavy = [n for n, b in enumerate(moving) if mass[b] > 0]
    light = [n for n, b in enumerate(moving) if mass[b] == 0]

    def part(rows, columns):
        return mp.matrix([[matrix[r, c] for c in columns] for r in rows])

    reduced, follow = part(heavy, heavy), None
    if light:
        follow = -(part(light, light) ** -1) * part(light, heavy)
        reduced += part(heavy, light) * follow
    root = [mp.sqrt(mass[moving[n]]) for n in heavy]
    scaled = mp.matrix(
        [[reduced[r, c] / root[r] / root[c] for c in range(len(heavy))] for r in range(len(heavy))]
    )
    values, vectors = mp.eigsy((scaled + scaled.T) / 2)
    frequency, shapes = [], []
    for n in sorted(range(len(heavy)), key=lambda n: values[n]):
        if values[n] > mp.mpf(10) ** (10 - DIGITS) * max(values):
            own = mp.matrix([vectors[r, n] / root[r] for r in range(len(heavy))])
            shape = {moving[b]: own[r] for r, b in enumerate(heavy)}
            if follow is not None:
                shape |= {moving[b]: (follow * own)[r] for r, b in enumerate(light)}
            frequency.append(mp.sqrt(values[n]))
            shapes.append(shape)
    return frequency, shapes


def _torques(tree: Tree, w, x):
    """Twist over flexibility; in a rigid span what the station at its outer end needs (not for a fixed one)."""
    torque = [-(w**2) * mp.mpf(float(j)) * a for j, a in zip(tree.inertia, x, strict=True)]
    for i in range(tree.size - 1, -1, -1):
        p, h = int(tree.parent[i]), mp.mpf(float(tree.flexibility[i]))
        if p < 0:
            torque[i] = mp.mpf(0)
            continue
        if h > 0:
            torque[i] = (x[p] - x[i]) / h
        torque[p] += torque[i]
    return torque
