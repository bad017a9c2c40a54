"""Elimination of a tree: the stiffness that both sides of a span show, free shapes that follow, and what sources add.

Values may be complex: z/(1 + hc z) in place of 1/(h + 1/z), because quotients of complex zeros and infinities are not
numbers. Only sums of terms, products and quotients: rigid spans and massless stations need no special case, and every
value is accurate relative to the data of the springs, however unequal (Demmel and Gragg 1993). What a fixed station
shows is infinite; the values of its spans are divided by it. Columns are frequencies or roots; floating point exceptions
are ignored: a massless branch and a node are meant.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.trees.tree import Tree

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
    # From the leaves to the root: the stiffness of each branch, through its span as its parent feels it.
    for station in range(size - 1, -1, -1):
        if (parent := plan.parent[station]) >= 0:
            if plan.held[station]:
                through[station] = ones_row / hc[station]
            else:
                transfer[station] = np.reciprocal(one_plus(hc[station] * z[station]))
                through[station] = z[station] * transfer[station]
            z[parent] += through[station]

    # Back to the leaves: to every child the train without its branch.
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
