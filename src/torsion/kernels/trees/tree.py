"""The tree that every sweep runs over: stations numbered from the root to the leaves, one span to each parent."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray
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
    shafts: Shafts | None = None  # the spans with distributed inertia

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


Values = NDArray[Any]  # real or complex
Rows = list[Values]
EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Layout:
    """What the sweeps need to know of a tree: plain lists, and which stations are moved rather than free to move."""

    size: int  # number of stations
    parent: list[int]
    children: tuple[tuple[int, ...], ...]
    held: list[bool]
    rigid: list[bool]  # span i has no flexibility
    prescribed: list[bool]  # fixed, or rigidly joined to such a root


def layout(tree: Tree, compliance: Values) -> Layout:
    """Return the lists for the sweeps; `compliance` is (stations,) or (stations, columns), rad/(N m).

    Raises ValueError for a rigid span to a fixed station that is no root.
    """
    zero = (compliance == 0).reshape(tree.size, -1)
    rigid = zero.all(axis=1)
    if bool((zero.any(axis=1) & ~rigid).any()):
        raise ValueError(
            "a span is rigid at some frequencies only; expected rigid at all or at none"
        )
    leaf = tree.held & (tree.parent >= 0)
    if bool((leaf & rigid).any()):
        raise ValueError(
            "a rigid span leads to a fixed leaf; expected that fixed station as the root"
        )
    prescribed = tree.held.copy()
    for station in np.flatnonzero(rigid & (tree.parent >= 0)).tolist():
        prescribed[station] = prescribed[tree.parents[station]]
    lists = (values.tolist() for values in (tree.held, rigid, prescribed))
    return Layout(tree.size, tree.parents, tree.children, *lists)


@dataclass(frozen=True)
class SpanSides:
    """What both sides of every span show: lists with a row (columns,) a station, which stay in a processor's cache.

    Angle and torque of a station follow from z, f of its branch and zd, e of the rest: (f d + e)/D and
    (e z - f zd)/D with D = z d + zd. Where the parent is prescribed zd = 1, d = hc and e is the angle of the parent
    with the twist: all three over the infinite stiffness. A fixed leaf has z = 1, f = 0, D = d for the same reason.
    """

    plan: Layout
    compliance: Rows  # hc, rad/(N m)
    branch: Rows  # z, N m/rad: the station and all beyond it
    through: Rows  # z/(1 + hc z): the same felt by the parent through the span
    transfer: Rows  # 1/(1 + hc z): angle of the station over that of its parent, without sources
    rest: Rows  # zd, N m/rad: all but the branch, at the parent; 0 at a root
    divisor: Rows  # d = 1 + hc zd; 1 at a root

    @cached_property
    def meeting(self) -> Rows:
        """1/D of every station."""
        meeting: Rows = []
        with np.errstate(all="ignore"):
            for station, divisor in enumerate(self.divisor):
                if self.plan.held[station] and self.plan.parent[station] >= 0:
                    meeting.append(1.0 / divisor)
                else:
                    meeting.append(1.0 / (self.branch[station] * divisor + self.rest[station]))
        return meeting

    @cached_property
    def whole(self) -> Values:
        """Dynamic stiffness (stations, columns) N m/rad of the whole train at each station; infinite where prescribed."""
        whole = np.full((self.plan.size, len(self.divisor[0])), np.inf, self.divisor[0].dtype)
        with np.errstate(all="ignore"):
            for station in np.flatnonzero(~np.array(self.plan.prescribed)).tolist():
                through = self.rest[station] / self.divisor[station]
                np.add(self.branch[station], through, out=whole[station])
        return whole


def share(children: Sequence[int], through: Rows, remainders: Rows, remainder: Values) -> None:
    """Give every child the sum of all the others: by sums from both ends, never as the total minus its own."""
    remainders[children[0]] = remainder
    for previous, child in pairwise(children):
        remainder = remainder + through[previous]
        remainders[child] = remainder
    after = through[children[-1]]
    for child in reversed(children[:-1]):
        remainders[child] = remainders[child] + after
        after = after + through[child]


@np.errstate(all="ignore")
def eliminate(
    plan: Layout, station_stiffness: Values, compliance: Values, *, guard: bool = False
) -> SpanSides:
    """Return both sides of every span from `station_stiffness` (stations, columns) N m/rad, of each by itself.

    compliance: (stations, 1) or (stations, columns) rad/(N m). `guard` replaces a denominator that is exactly zero (a
    branch in resonance with its root end fixed, such as a vibration absorber in tune) by eps, which is a relative change
    of that one flexibility by eps.
    """

    def one_plus(product: Values) -> Values:
        product += 1.0
        if guard:
            product[product == 0] = EPS
        return product

    size, kind = plan.size, np.result_type(station_stiffness, compliance)
    hc, z = list(compliance), [row.astype(kind) for row in station_stiffness]
    ones_row = np.ones(station_stiffness.shape[1], dtype=kind)
    through, transfer, divisor = ([ones_row] * size for _ in range(3))
    rest = [np.zeros_like(ones_row)] * size
    for station in range(size - 1, -1, -1):
        if (parent := plan.parent[station]) >= 0:
            if plan.held[station]:
                through[station] = ones_row / hc[station]
            else:
                transfer[station] = np.reciprocal(one_plus(hc[station] * z[station]))
                through[station] = z[station] * transfer[station]
            z[parent] += through[station]

    for station, children in enumerate(plan.children):
        if plan.prescribed[station]:
            for child in children:
                rest[child], divisor[child] = ones_row, hc[child] * ones_row
        elif children:
            share(
                children,
                through,
                rest,
                station_stiffness[station] + rest[station] / divisor[station],
            )
            for child in children:
                divisor[child] = one_plus(hc[child] * rest[child])
        if plan.held[station] and plan.parent[station] >= 0:
            z[station] = ones_row
    return SpanSides(plan, hc, z, through, transfer, rest, divisor)


def eliminate_undamped(tree: Tree, w: FloatArray) -> SpanSides:
    """Return both sides of every span of an undamped tree at `w` (m,) rad/s, shafts included."""
    square, inertia = w * w, tree.inertia_columns
    flexibility = tree.flexibility.reshape(tree.size, -1)
    if tree.shafts is not None:
        flexibility, inertia = tree.at(square)
        inertia[tree.held] = 0.0
    return eliminate(layout(tree, flexibility), inertia * -square, flexibility)


@np.errstate(all="ignore")
def spread(sides: SpanSides, start: IntArray) -> tuple[Values, Values]:
    """Return angles and torques, both (stations, columns), of the free motion in which station `start` (columns,) turns by 1.

    On the way from the start to the root the torque is that of the rest of the train, elsewhere that of the branch.
    """
    plan, columns = sides.plan, len(start)
    angle, torque = np.zeros((2, plan.size, columns), dtype=sides.divisor[0].dtype)
    angle[start, np.arange(columns)] = 1.0

    # Toward the root the rest of the train turns each parent, toward the leaves each parent its branch.
    for station in range(plan.size - 1, -1, -1):
        if (parent := plan.parent[station]) >= 0 and not plan.prescribed[station]:
            turned = angle[station] / sides.divisor[station]
            np.multiply(-sides.rest[station], turned, out=torque[station])
            if not plan.prescribed[parent]:
                angle[parent] += turned
    is_aside = angle == 0.0
    for station, parent in enumerate(plan.parent):
        if parent < 0 or plan.prescribed[parent]:
            continue
        if plan.held[station]:
            np.multiply(angle[parent], sides.through[station], out=torque[station])
            continue
        turned = angle[parent] * sides.transfer[station]
        np.copyto(angle[station], turned, where=is_aside[station])
        np.copyto(torque[station], sides.branch[station] * turned, where=is_aside[station])

    # A rigid span to a fixed station carries what the spans beyond it carry.
    for station in range(plan.size - 1, -1, -1):
        if plan.prescribed[station] and plan.parent[station] >= 0 and not plan.held[station]:
            torque[station] = sum(torque[child] for child in plan.children[station])
    return angle, torque


@np.errstate(all="ignore")
def forced(sides: SpanSides, force: Values, twist: Values | None = None) -> tuple[Values, Values]:
    """Return angles (rad) and torques of the spans on their stations (N m), both (stations, columns).

    Of a distributed shaft the torque is that in its flexibility. force: N m on every station, (stations, 1) or
    (stations, columns), 0 on fixed ones. twist: rad, the same of the
    spans; none: 0.
    """
    plan = sides.plan
    shape = plan.size, len(sides.meeting[0])
    z, zd, divisor = sides.branch, sides.rest, sides.divisor
    acting = [force] if twist is None else [force, twist]
    kind = np.result_type(z[0], *acting)
    f = [np.broadcast_to(row, shape[1:]).astype(kind) for row in force]

    # Toward the root: what each span passes on of its branch is added to the station nearer the root.
    passed: Rows = [np.zeros(shape[1])] * plan.size
    for station in range(plan.size - 1, -1, -1):
        parent = plan.parent[station]
        if parent < 0:
            continue
        if not plan.held[station]:
            source = f[station] if twist is None else f[station] - z[station] * twist[station]
            passed[station] = source * sides.transfer[station]
        elif twist is not None:
            passed[station] = -twist[station] / sides.compliance[station]
        f[parent] += passed[station]

    # Toward the leaves: e, of all but the branch; a twist of a span is felt beyond it.
    jumps: Rows = [] if twist is None else [*map(np.multiply, zd, twist)]
    still = np.zeros(shape[1])
    e: Rows = [still] * plan.size
    angle, torque = np.zeros((2, *shape), dtype=kind)
    for station, children in enumerate(plan.children):
        if plan.prescribed[station]:
            for child in children:
                e[child] = still if plan.held[station] else e[station]
        elif children:
            share(children, passed, e, force[station] + e[station] / divisor[station])
        for child in children if jumps else ():
            e[child] = e[child] + jumps[child]
        if plan.held[station]:
            f[station] = np.zeros_like(e[station])
        else:
            np.multiply(f[station], divisor[station], out=angle[station])
            angle[station] += e[station]
            angle[station] *= sides.meeting[station]
        if plan.parent[station] >= 0:
            np.multiply(e[station], z[station], out=torque[station])
            torque[station] -= f[station] * zd[station]
            torque[station] *= sides.meeting[station]
    return angle, torque
