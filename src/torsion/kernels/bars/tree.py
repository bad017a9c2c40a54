"""A tree some of whose spans have distributed inertia, and what its stations and spans are at each frequency."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from torsion.kernels.bars.spans import Bars
from torsion.kernels.reduction import Rigidity, rigidity
from torsion.kernels.tree import FloatArray, IntArray, Tree


@dataclass(frozen=True)
class BarTree:
    """A tree and its bars; the flexibility that `tree` itself gives for the span of a bar is not used."""

    tree: Tree
    bars: Bars

    @cached_property
    def bar_of(self) -> list[int]:
        """Bar of each station's span; -1 for a plain span or a root."""
        bar = np.full(self.tree.size, -1)
        bar[self.bars.node] = np.arange(self.bars.size)
        return list(bar.tolist())

    @cached_property
    def parent(self) -> IntArray:
        """Station (bars,) at the inner end of each bar."""
        return self.tree.parent[self.bars.node]

    @cached_property
    def rounds(self) -> tuple[IntArray, ...]:
        """The bars in groups within which no two begin at one station."""
        if len(set(self.parent.tolist())) == self.bars.size:
            return (np.arange(self.bars.size),)
        order = np.argsort(self.parent, kind="stable")
        begins = self.parent[order]
        _, first, length = np.unique(begins, return_index=True, return_counts=True)
        turn = np.arange(len(order)) - np.repeat(first, length)
        return tuple(order[turn == k] for k in range(int(length.max(initial=0))))

    @cached_property
    def plain(self) -> IntArray:
        """Stations whose span is no bar, roots among them."""
        return np.flatnonzero(np.array(self.bar_of) < 0)

    @cached_property
    def static(self) -> Tree:
        """The tree at frequency 0, each bar a flexibility between its end inertias: its rigid motions are right."""
        flexibility, inner, outer = (values[:, 0] for values in self.bars.at(np.zeros(1)))
        whole, inertia = self.tree.flexibility.copy(), self.tree.inertia.copy()
        whole[self.bars.node] = flexibility
        np.add.at(inertia, self.parent, inner)
        inertia[self.bars.node] += outer
        return replace(self.tree, flexibility=whole, inertia=inertia)

    @cached_property
    def known(self) -> Rigidity:
        """Rigid bodies, fixed stations and free parts."""
        return rigidity(self.static)

    def solved(self, tree: Tree) -> "BarTree":
        """The same bars on another tree of the same stations."""
        return BarTree(tree, self.bars)

    def add_ends(self, total: FloatArray, inner: FloatArray, outer: FloatArray) -> None:
        """Add what the ends of every bar bring, (bars, m) each, to that of the stations (stations, m), in place."""
        total[self.bars.node] += outer
        for part in self.rounds:
            total[self.parent[part]] += inner[part]

    def flexibilities(self, flexibility: FloatArray) -> list[FloatArray]:
        """A row a span: of `flexibility` (bars, m) for a bar, one value without axes for any other."""
        rows = list(self.tree.flexibilities)
        for node, row in zip(self.bars.node.tolist(), flexibility, strict=True):
            rows[node] = row
        return rows
