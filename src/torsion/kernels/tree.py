"""The tree that every sweep runs over: stations numbered from the root outward, one span to each parent."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsion.kernels.layers import Layer, layers_of

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


_STATIONS_WITHOUT_LAYERS = 16  # (measured)


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
    def parents(self) -> list[int]:
        """`parent` as a list, which plain loops read faster."""
        return list(self.parent.tolist())

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The stations whose parent each station is."""
        lists: list[list[int]] = [[] for _ in range(self.size)]
        for station, parent in enumerate(self.parents):
            if parent >= 0:
                lists[parent].append(station)
        return tuple(map(tuple, lists))

    @cached_property
    def roots(self) -> list[int]:
        """The stations without a parent."""
        return [station for station, parent in enumerate(self.parents) if parent < 0]

    @cached_property
    def flexibilities(self) -> list[FloatArray]:
        """`flexibility` as arrays of one value without axes, which numpy adds to a row faster than a float."""
        return [self.flexibility[station, ...] for station in range(self.size)]

    @cached_property
    def layers(self) -> tuple[Layer, ...] | None:
        """Stations of equal distance from their root; None where they are not numbered layer by layer."""
        return layers_of(self.parent)

    @cached_property
    def is_swept_by_stations(self) -> bool:
        """A chain, or so small that a sweep by layers is not worth finding them."""
        return self.size <= _STATIONS_WITHOUT_LAYERS or self.is_chain

    @property
    def is_ready(self) -> bool:
        """Sweeps can take the stations as they are numbered."""
        return self.is_swept_by_stations or self.layers is not None

    @cached_property
    def most_children(self) -> int:
        """The largest number of spans outward of one station."""
        return int(np.bincount(self.parent + 1)[1:].max(initial=0))

    @cached_property
    def moving_inertia(self) -> FloatArray:
        """Inertia (stations,) kg m2, 0 where held."""
        return np.where(self.held, 0.0, self.inertia) if self.holds else self.inertia

    @cached_property
    def holds(self) -> bool:
        """Any station is held."""
        return bool(self.held.any())

    def own_stiffness(self, square: FloatArray) -> FloatArray:
        """Dynamic stiffness (stations, m) N m/rad of each station alone at `square` (m,) of the angular frequency.

        Infinite where held; written as a difference, so that a zero is positive.
        """
        own: FloatArray = np.multiply.outer(self.moving_inertia, square)
        np.subtract(0.0, own, out=own)
        if self.holds:
            own[self.held] = np.inf
        return own

    @cached_property
    def is_chain(self) -> bool:
        """Every span joins a station to the one numbered before it, from a single root."""
        return self.parents == list(range(-1, self.size - 1))

    @cached_property
    def is_plain(self) -> bool:
        """One root, no rigid span, and every station moves and has inertia."""
        rigid, roots = self.size - int(np.count_nonzero(self.flexibility[1:])), self.parents.count(-1)
        return rigid == roots == 1 and not self.holds and bool(self.inertia.min() > 0.0)
