"""Stations in layers of equal distance from their root, so that one numpy call sweeps a whole layer."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from torsion.arrays import FloatArray, IntArray

_MOST_AT_ONCE = 4  # children in a family up to which they are added one rank after another


class Layer(NamedTuple):
    """Stations one span farther from the root than those of the layer `above`; siblings stand side by side.

    Arrays that are swept have one row of zeros after the last station, for children and siblings that do not exist.
    """

    stations: slice
    above: slice
    is_in_line: (
        bool  # each of those above has one child, in the same order; then the rest is not needed
    )
    parent: IntArray  # (stations,) position among those above
    children: IntArray  # (ranks, above) station of each child; no ranks in large families
    siblings: IntArray  # (distances, stations) station at each distance round the family; none in large ones
    families: tuple[slice, ...]  # stations with one parent, in large families


_NOBODY = np.empty((0, 0), dtype=np.int64)
_NOWHERE = np.empty(0, dtype=np.int64)


def layers_of(parent: IntArray) -> tuple[Layer, ...] | None:
    """The layers from the roots to the leaves, nearest first; None where stations are not numbered layer by layer.

    `parent` (stations,) never falls in a tree numbered so, and is -1 at a root.
    """
    size = len(parent)
    if not size or (parent[1:] < parent[:-1]).any():
        return None
    roots = int(parent.searchsorted(0))
    number = np.bincount(parent[roots:], minlength=size)
    end = number.cumsum() + roots  # of each one's children
    sums, edges = end.tolist(), [0, roots]
    while edges[-1] < size:
        edges.append(sums[edges[-1] - 1])
    if len(edges) == 2:
        return ()
    widest = np.maximum.reduceat(number, edges[:-1]).tolist()
    ranks = np.arange(min(max(widest), _MOST_AT_ONCE))[:, None]
    children = np.where(number > ranks, (end - number) + ranks, size)
    siblings = _round_families(parent, number, end, ranks[1:])
    layers = []
    for begin, middle, stop, largest in zip(edges, edges[1:], edges[2:], widest, strict=False):
        above, stations = slice(begin, middle), slice(middle, stop)
        if largest == 1 and middle - begin == stop - middle:
            layers.append(Layer(stations, above, True, _NOWHERE, _NOBODY, _NOBODY, ()))
        else:
            few = largest if largest <= _MOST_AT_ONCE else 0
            near = siblings[: max(few - 1, 0), stations]
            families = (
                ()
                if few
                else tuple(slice(e - n, e) for e, n in zip(sums[above], number[above], strict=True))
            )
            parents = parent[stations] - begin
            layers.append(
                Layer(stations, above, False, parents, children[:few, above], near, families)
            )
    return tuple(layers)


def _round_families(
    parent: IntArray, number: IntArray, end: IntArray, distance: IntArray
) -> IntArray:
    """The siblings (distances, stations) that stand `distance` (distances, 1) on, beginning anew after the last."""
    sibling, size = np.arange(len(parent)) + distance, number[parent]
    sibling -= np.where(sibling >= end[parent], size, 0)
    return np.asarray(np.where(size > distance, sibling, len(parent)))


def sweep_to_roots(
    layers: tuple[Layer, ...],
    total: FloatArray,
    passed: FloatArray,
    inverse: FloatArray,
    after: Callable[[FloatArray, FloatArray], None] | None = None,
) -> None:
    """Dynamic stiffness of all branches, layer by layer from the leaves: zz = 1/(h + 1/z), added at the parent.

    `total` (stations, m): of each station by itself, then with all beyond it. `passed` (stations + 1, m): the
    flexibility of each span, then what it passes on. `inverse` (stations, m) becomes 1/z; `after` may change what
    is passed on and use it as room.
    """
    reciprocal, add = np.reciprocal, np.add
    for layer in reversed(layers):
        through, turned = passed[layer.stations], inverse[layer.stations]
        reciprocal(total[layer.stations], turned)
        add(through, turned, through)
        reciprocal(through, through)
        if after is not None:
            after(through, turned)
        add_children(layer, passed, total[layer.above])


def add_children(layer: Layer, passed: FloatArray, total: FloatArray) -> None:
    """Add what the stations of a layer pass on, of `passed` (stations + 1, m), to `total` (above, m)."""
    if layer.is_in_line:
        np.add(total, passed[layer.stations], total)
        return
    if len(layer.children):
        for child in passed.take(layer.children, 0):
            np.add(total, child, total)
    for family in layer.families:
        if family.stop > family.start:
            row = total[layer.parent[family.start - layer.stations.start]]
            np.add(row, np.add.reduce(passed[family], axis=0), row)


def of_the_rest(layer: Layer, above: FloatArray, passed: FloatArray, out: FloatArray) -> None:
    """Put `above` (above, m) plus what all siblings pass on into `out` (stations, m), not as a total minus its own."""
    above.take(layer.parent, 0, out, "clip")
    if len(layer.siblings):
        for sibling in passed.take(layer.siblings, 0):
            np.add(out, sibling, out)
    for family in layer.families:
        passed_by_family, rows = (
            passed[family],
            out[family.start - layer.stations.start : family.stop - layer.stations.start],
        )
        rows[1:] += np.add.accumulate(passed_by_family[:-1], axis=0)
        rows[:-1] += np.add.accumulate(passed_by_family[:0:-1], axis=0)[::-1]


def share(
    children: Sequence[int],
    through: list[Any],
    remainders: list[Any],
    remainder: Any,
    add: Any = np.add,
) -> None:
    """Give every child the sum of all the others: by sums from both ends, never as the total minus its own."""
    if len(children) == 1:
        remainders[children[0]] = remainder
        return
    before = remainder
    for child in children:
        remainders[child] = before
        before = add(before, through[child])
    after: Any = None
    for child in reversed(children):
        if after is not None:
            remainders[child] = add(remainders[child], after)
        after = through[child] if after is None else add(after, through[child])
