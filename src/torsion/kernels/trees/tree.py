"""The tree that every sweep runs over: stations numbered from the root to the leaves, one span to each parent.

Rigid bodies, fixed stations and free parts follow from the graph alone. What rigid spans join to a fixed station does
not move, and their torques are sums of reactions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from torsion.kernels.distributed.span_laws import Shafts

Step = tuple[int, int, int]  # a station, the next one toward the root, the span between


@dataclass(frozen=True)
class Tree:
    """A forest of stations; span i joins station i to `parent[i]`, and `parent[i] < i`.

    Everything is referred to one speed, so gear ratios are no longer seen. A spring to ground is a span to a
    fixed leaf. A fixed station does not move; it is a root or a leaf. The law of a span is a constant flexibility, or
    that of a distributed shaft. Trains of one layout stand side by side where flexibility and inertia have a column
    for each (stations, m): sweeps then take one frequency a column.
    """

    parent: IntArray  # (stations,), -1 at a root
    flexibility: FloatArray  # (stations,) rad/(N m) of span i; 0 is rigid; unused at a root and of distributed shafts
    inertia: FloatArray  # (stations,) kg m2; 0 is massless; unused where fixed
    held: BoolArray  # (stations,) fixed
    shafts: "Shafts | None" = None  # the spans with distributed inertia

    @property
    def size(self) -> int:
        """Number of stations, which is also the number of spans and roots."""
        return len(self.parent)

    @cached_property
    def parents(self) -> list[int]:
        """`parent` as a list, which plain loops read faster."""
        return list(self.parent.tolist())

    @cached_property
    def steps(self) -> list[Step]:
        """Every span toward its root, the leaves first."""
        return [(i, parent, i) for i, parent in enumerate(self.parents) if parent >= 0][::-1]

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The stations whose parent each station is."""
        lists: list[list[int]] = [[] for _ in range(self.size)]
        for station, parent in enumerate(self.parents):
            if parent >= 0:
                lists[parent].append(station)
        return tuple(map(tuple, lists))

    @cached_property
    def most_children(self) -> int:
        """The largest number of spans from one station toward the leaves."""
        return int(np.bincount(self.parent + 1)[1:].max(initial=0))

    @cached_property
    def moving_inertia(self) -> FloatArray:
        """Inertia (stations,) kg m2, 0 where fixed."""
        return np.where(self.held, 0.0, self.inertia.T).T if self.held.any() else self.inertia

    @cached_property
    def inertia_columns(self) -> FloatArray:
        """`moving_inertia` as (stations, 1) or (stations, m) kg m2."""
        return self.moving_inertia.reshape(self.size, -1)

    @cached_property
    def shaft_parent(self) -> IntArray:
        """Station (shafts,) at the root end of each distributed shaft."""
        return np.empty(0, dtype=np.int64) if self.shafts is None else self.parent[self.shafts.node]

    @cached_property
    def static(self) -> "Tree":
        """The tree at frequency 0, each shaft a flexibility between two inertias: its rigid motions are right."""
        if self.shafts is None:
            return self
        flexibility, inertia = (values[:, 0] for values in self.at(np.zeros(1)))
        return replace(self, flexibility=flexibility, inertia=inertia, shafts=None)

    def at(self, square: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flexibility and inertia (stations, m) at `square` (m,), each shaft a flexibility between two inertias."""
        flexibility, inertia = (
            np.repeat(values[:, None], len(square), axis=1)
            for values in (self.flexibility, self.inertia)
        )
        if self.shafts is not None:
            flexibility[self.shafts.node], inner, outer = self.shafts.at(square)
            self.add_ends(inertia, inner, outer)
        return flexibility, inertia

    def columns(self, trains: IntArray | BoolArray | slice | int) -> "Tree":
        """Some of the trains side by side, by position or mask; or one by itself."""
        return replace(
            self, flexibility=self.flexibility[:, trains], inertia=self.inertia[:, trains]
        )

    def cut(self, spans: BoolArray) -> "Tree":
        """The tree without the spans (stations,) named; itself where none is."""
        if not spans.any():
            return self
        return replace(
            self,
            parent=np.where(spans, -1, self.parent),
            flexibility=np.where(spans, 0.0, self.flexibility),
        )

    def add_ends(self, total: NDArray[Any], inner: NDArray[Any], outer: NDArray[Any]) -> None:
        """Add what the ends of every shaft bring, (shafts, ...) each, to that of the stations (stations, ...)."""
        if self.shafts is not None:
            total[self.shafts.node] += outer
            for parent, row in zip(self.shaft_parent.tolist(), inner, strict=True):
                total[parent] += row  # several shafts may begin at one station


@dataclass(frozen=True)
class Walk:
    """Stations as they are met; `parent` and `above` are -1 at a root."""

    order: IntArray  # (stations,)
    parent: IntArray  # (stations,) of each station
    above: IntArray  # (stations,) the span each station was reached by


def walk(
    number: int, driving: IntArray, driven: IntArray, chosen: BoolArray, roots: list[int]
) -> Walk:
    """Breadth first from one of `roots`, else from the first station, of every separate part, over `chosen` spans."""
    near: list[list[tuple[int, int]]] = [[] for _ in range(number)]
    for span in np.flatnonzero(chosen).tolist():
        a, b = int(driving[span]), int(driven[span])
        near[a].append((b, span))
        near[b].append((a, span))
    parent, above, order = [-1] * number, [-1] * number, list[int]()
    seen = [False] * number
    for root in [station for station in roots if near[station]] + list(range(number)):
        part = [] if seen[root] else [root]
        seen[root] = True
        for parent_station in part:
            for neighbour, span in near[parent_station]:
                if not seen[neighbour]:
                    seen[neighbour], parent[neighbour], above[neighbour] = (
                        True,
                        parent_station,
                        span,
                    )
                    part.append(neighbour)
        order += part
    return Walk(*(np.array(values, dtype=np.int64) for values in (order, parent, above)))


def connected(number: int, driving: IntArray, driven: IntArray) -> IntArray:
    """(stations,) the first of all stations that spans join to each."""
    first = np.arange(number)
    while len(driving):
        a, b = first[driving], first[driven]
        is_separate = a != b
        driving, driven, a, b = (ends[is_separate] for ends in (driving, driven, a, b))
        np.minimum.at(first, np.maximum(a, b), np.minimum(a, b))
        while np.any(first[first] != first):
            first = first[first]
    return first


def closing_no_loop(
    number: int, driving: IntArray, driven: IntArray, ranked: IntArray, joined: Sequence[int] = ()
) -> BoolArray:
    """(spans,) the spans that make a forest, taken in the order `ranked` (Kruskal 1956); stations of `one` are joined.

    Taken from the stiffest on, what is left closes each loop at its softest span.
    """
    group, chosen = list(range(number)), np.zeros(len(driving), dtype=bool)
    for station in joined:
        group[station] = joined[0]

    def root(a: int) -> int:
        while group[a] != a:
            group[a] = group[group[a]]
            a = group[a]
        return a

    for span in ranked.tolist():
        a, b = root(int(driving[span])), root(int(driven[span]))
        group[a], chosen[span] = b, a != b
    return chosen


@dataclass(frozen=True)
class Rigidity:
    """What the graph alone says: which stations move as one, and which parts are free to turn."""

    body: IntArray  # (stations,) the first station of the rigid body that each one belongs to
    fixed: BoolArray  # (stations,) `held`, or joined rigidly to such a station
    component: IntArray  # (stations,) root of the part each one belongs to
    free_roots: IntArray  # (rigid motions,) root of every part with inertia and no fixed station
    inside: BoolArray  # (stations,) whose span is rigid and joins fixed stations
    elastic: int  # number of natural frequencies other than 0


def rigidity(tree: Tree) -> Rigidity:
    """Rigid bodies, fixed stations and free parts of a tree."""
    size, parents = tree.size, tree.parents
    rigid = (tree.flexibility == 0.0).tolist()
    body, component = list(range(size)), list(range(size))
    for station, parent in enumerate(parents):
        if parent >= 0:
            component[station] = component[parent]
            if rigid[station]:
                body[station] = body[parent]
    fixed_bodies = {body[station] for station in np.flatnonzero(tree.held).tolist()}
    grounded = {component[station] for station in fixed_bodies}
    heavy = {
        b for b, inertia in zip(body, tree.moving_inertia.tolist(), strict=True) if inertia > 0.0
    } - fixed_bodies
    free_roots = sorted({component[b] for b in heavy} - grounded)
    fixed = np.array([b in fixed_bodies for b in body], dtype=bool)
    return Rigidity(
        body=np.array(body, dtype=np.int64),
        fixed=fixed,
        component=np.array(component, dtype=np.int64),
        free_roots=np.array(free_roots, dtype=np.int64),
        inside=fixed & rigid & (tree.parent >= 0),
        elastic=len(heavy) - len(free_roots),
    )


def rigid_shapes(tree: Tree, bodies: Rigidity) -> FloatArray:
    """Angles (stations, rigid motions) rad, constant over each free part and mass-normalised."""
    part = bodies.component[:, None] == bodies.free_roots
    scaled: FloatArray = part / np.sqrt(tree.moving_inertia @ part)
    return scaled


def cut(tree: Tree, bodies: Rigidity) -> Tree:
    """The tree with every fixed station `held` and the rigid spans between them taken out; itself if there are none."""
    if not bodies.inside.any():
        return tree
    return replace(tree, parent=np.where(bodies.inside, -1, tree.parent), held=bodies.fixed)


def with_reactions(
    tree: Tree, bodies: Rigidity, torque: FloatArray, outside: FloatArray | float = 0.0
) -> FloatArray:
    """Torque (stations, m) of the cut tree, completed in the rigid spans between fixed stations by equilibrium.

    `outside` (stations, m) N m is what acts on each station besides its spans.

    Where a body is fixed more than once, the shares are not determined: the fixed station numbered first takes all.
    """
    inside = bodies.inside
    if not inside.any():
        return torque
    load = np.where(tree.parent[:, None] >= 0, torque, 0.0) + outside
    for station, parent in enumerate(tree.parents):
        if parent >= 0 and not inside[station]:
            load[parent] -= torque[station]
    full = torque.copy()
    way = walk(
        tree.size, tree.parent, np.arange(tree.size), inside, np.flatnonzero(tree.held).tolist()
    )
    for station in way.order[::-1].tolist():
        nearer, span = way.parent[station], way.above[station]
        if nearer >= 0:
            full[span] = -load[station] if span == station else load[station]
            load[nearer] += load[station]
    return full


def bends(tree: Tree, bodies: Rigidity) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Coordinates whose sum of squares is the elastic energy: torque times the root of the flexibility of each span.

    Spans that are not rigid (springs,), those roots, the bend of each over its root (springs, coordinates), and angles
    (stations, coordinates) rad. Angles are sums along the tree, about a mean that the inertia holds still or about a
    fixed station: rigid motions are left out, and no angle is a small difference of large ones.
    """
    spring = np.flatnonzero((tree.parent >= 0) & (tree.flexibility > 0.0))
    root = np.sqrt(tree.flexibility[spring])
    fixed = np.unique(bodies.body[bodies.fixed])
    first = np.unique(bodies.component[fixed], return_index=True)[1]

    # Whether a station is at the outer end of a spring, or beyond; else in the same part, or in another.
    beyond = np.eye(tree.size, dtype=bool)
    for station, parent, _ in tree.steps:
        beyond[parent] |= beyond[station]
    beyond = beyond.T[:, spring]
    before = (bodies.component[:, None] == bodies.component[spring]) & ~beyond

    # The weighted mean of the angles of a part is zero; of one that is fixed the weight is at its first fixed station.
    is_fixed = np.isin(bodies.component, bodies.component[fixed])
    weight = np.where(is_fixed, 0.0, tree.moving_inertia)
    weight[fixed[first]] = 1.0
    outer, inner = weight @ beyond, weight @ before
    total = outer + inner
    total[total == 0.0] = 1.0
    angle = (np.where(beyond, inner / total, 0.0) - np.where(before, outer / total, 0.0)) * root

    bend, ties = np.eye(len(spring)), angle[np.delete(fixed, first)]
    if len(ties):
        ties = ties / np.linalg.norm(ties, axis=1, keepdims=True)
        bend = np.linalg.qr(ties.T, mode="complete")[0][:, len(ties) :]
        angle = angle @ bend
    angle[bodies.fixed] = 0.0
    return spring, root, bend, angle
