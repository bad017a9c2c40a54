"""The tree that every sweep runs over: stations numbered from the root outward, one span to each parent."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Family:
    """Stations of one level, sorted by parent; those of `parents[g]` begin at `first[g]`."""

    stations: IntArray
    parents: IntArray
    first: IntArray


@dataclass(frozen=True)
class Tree:
    """A forest of stations; span i joins station i to `parent[i]`, and `parent[i] < i`.

    Everything is referred to one speed, so gear ratios are no longer seen. A spring to ground is a span to a
    held leaf. A held station does not move; it is a root or a leaf.
    """

    parent: IntArray  # (stations,), -1 at a root
    flexibility: FloatArray  # (stations,) rad/(N m) of span i; 0 is rigid; 0 and unused at a root
    inertia: FloatArray  # (stations,) kg m2; 0 is massless; unused where held
    held: BoolArray  # (stations,)

    @property
    def size(self) -> int:
        """Number of stations, which is also the number of spans and roots."""
        return len(self.parent)

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The stations whose parent each station is."""
        lists: list[list[int]] = [[] for _ in range(self.size)]
        for station, parent in enumerate(self.parent.tolist()):
            if parent >= 0:
                lists[parent].append(station)
        return tuple(tuple(row) for row in lists)

    @cached_property
    def levels(self) -> tuple[IntArray, ...]:
        """Stations of equal distance from their root, nearest first."""
        depth = np.zeros(self.size, dtype=np.int64)
        for station, parent in enumerate(self.parent.tolist()):
            if parent >= 0:
                depth[station] = depth[parent] + 1
        order = np.argsort(depth, kind="stable")
        edges = np.flatnonzero(np.diff(depth[order])) + 1
        return tuple(np.split(order, edges))

    @cached_property
    def families(self) -> tuple[Family, ...]:
        """The levels with brothers side by side, for sums over children; nearest the root first."""
        return tuple(_family(level, self.parent) for level in self.levels)

    @cached_property
    def most_children(self) -> int:
        """The largest number of spans outward of one station."""
        return max((len(row) for row in self.children), default=0)

    @cached_property
    def moving_inertia(self) -> FloatArray:
        """Inertia (stations,) kg m2, 0 where held."""
        return np.where(self.held, 0.0, self.inertia)

    @cached_property
    def rest_stiffness(self) -> FloatArray:
        """Own stiffness (stations,) N m/rad against the ground: infinite where held, else 0."""
        return np.where(self.held, np.inf, 0.0)

    @cached_property
    def is_chain(self) -> bool:
        """Every span joins a station to the one numbered before it, from a single root."""
        return bool(np.array_equal(self.parent, np.arange(-1, self.size - 1)))


def _family(level: IntArray, parent: IntArray) -> Family:
    stations = level[np.argsort(parent[level], kind="stable")]
    parents, first = np.unique(parent[stations], return_index=True)
    return Family(stations, parents, first.astype(np.int64))
