"""A tree whose stations lie in one row, as that row: the order of its stations and the spans between them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.kernels.tree import FloatArray, IntArray, Tree


@dataclass(frozen=True)
class Path:
    """Stations along a row; span s lies between stations s and s + 1. Only the first and the last may be held."""

    station: IntArray  # (stations,) their numbers in the tree
    span: IntArray  # (stations - 1,) tree station whose span each one is
    sign: FloatArray  # (stations - 1,) 1 where the tree's parent comes first, else -1
    inertia: FloatArray  # (stations,) kg m2, 0 where held
    flexibility: FloatArray  # (stations - 1,) rad/(N m)
    first_held: bool
    last_held: bool

    @cached_property
    def is_in_order(self) -> bool:
        """The tree is numbered along the row."""
        return bool(np.all(self.station[1:] > self.station[:-1]))


def path_of(tree: Tree) -> Path | None:
    """The row of a tree, or None where it branches, falls into parts, or is held at an inner station."""
    station = _order(tree.parent)
    if station is None:
        return None
    held = np.flatnonzero(tree.held[station]).tolist()
    if not set(held) <= {0, tree.size - 1}:
        return None
    before, after = station[:-1], station[1:]
    outward = tree.parent[after] == before
    span = np.where(outward, after, before)
    inertia, flexibility = tree.moving_inertia[station], tree.flexibility[span]
    return Path(
        station,
        span,
        np.where(outward, 1.0, -1.0),
        inertia,
        flexibility,
        0 in held,
        tree.size > 1 and held[-1:] == [tree.size - 1],
    )


def _order(parent: IntArray) -> IntArray | None:
    """Stations (stations,) from one end of the row to the other; None where they are not a row."""
    size = len(parent)
    if size == 0 or np.count_nonzero(parent < 0) != 1:
        return None
    if parent[0] < 0 and np.array_equal(parent[1:], np.arange(size - 1)):
        return np.arange(size)
    root = int(np.flatnonzero(parent < 0)[0])
    children = np.bincount(parent[parent >= 0], minlength=size)
    if children[root] > 2 or np.any(np.delete(children, root) > 1):
        return None
    first, next_one = np.flatnonzero(parent == root).tolist(), np.full(size, -1, dtype=np.int64)
    inner = parent >= 0
    next_one[parent[inner]] = np.flatnonzero(inner)
    arms, outward = [], next_one.tolist()
    for station in first:
        arm, here = [], station
        while here >= 0:
            arm.append(here)
            here = outward[here]
        arms.append(arm)
    near = arms[0][::-1] if arms else []
    return np.array([*near, root, *(arms[1] if len(arms) > 1 else [])], dtype=np.int64)
