"""The dynamic stiffness of both sides of every span, and the response that follows without a difference of angles.

One sweep from the leaves to the roots and one back give, at every span, the stiffness of the train toward the leaves
and of all the rest, both as sums of terms only: the share of siblings is summed from the left and from the right, never
taken from a total. Angles are then products along the train from one station, torques products of a stiffness and an
angle, so that each component keeps its own relative accuracy (the re-rooted, or twisted, factorisation of Parlett and
Dhillon 1997). A distributed shaft is seen through its outer end inertia, its flexibility and its inner one: there is no
torque at a free end, exactly.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class TwoSides:
    """Dynamic stiffness at w (m,) rad/s; all (stations, m), N m/rad. At a root those of the rest are 0.

    Of a spring, what lies at its ends is the same with and without the ends of the span.
    """

    branch: FloatArray  # z: of the station and all beyond it, seen at the station
    branch_end: FloatArray  # the same with the outer end of the span to the parent
    branch_through: FloatArray  # the same, seen through the flexibility
    branch_passed: FloatArray  # zz: with the inner end, all that the span shows at the parent
    rest: FloatArray  # zd: of all the rest, seen at the parent
    rest_end: FloatArray  # the same with the inner end of the span
    rest_through: FloatArray  # the same, seen through the flexibility
    rest_passed: FloatArray  # y: with the outer end, all that the span shows at the station

    @cached_property
    def total(self) -> FloatArray:
        """Dynamic stiffness of the whole train (stations, m), seen at each station; 0 at a natural frequency."""
        return self.branch + self.rest_passed

    @cached_property
    def to_leaves(self) -> FloatArray:
        """Angle of each station over that of its parent (stations, m), without sources beyond."""
        return _transmission(self.branch_through, self.branch_end)

    @cached_property
    def to_root(self) -> FloatArray:
        """Angle of each parent over that of the station (stations, m), without sources in the rest."""
        return _transmission(self.rest_through, self.rest_end)


def two_sides(tree: Tree, w: FloatArray) -> TwoSides:
    """The two sweeps at angular frequencies `w` (m,). Infinite values are meant: a fixed station, a node."""
    square = w * w
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        own = tree.own_stiffness(square)
        z, (zz, zd, y) = own.copy(), np.zeros((3, *own.shape))
        if tree.shafts is None:
            sides, h, near, far = TwoSides(z, z, zz, zz, zd, zd, y, y), tree.flexibilities, [], []
        else:
            flexibility, inner, outer = tree.shafts.at(square)
            ends = np.zeros((4, *own.shape))
            sides = TwoSides(z, ends[0], zz, ends[1], zd, ends[2], y, ends[3])
            h, near, far = tree.flexibilities.copy(), list(inner * square), list(outer * square)
            for node, row in zip(tree.shafts.node.tolist(), flexibility, strict=True):
                h[node] = row
        _to_roots(tree, sides, h, near, far)
        _to_leaves(tree, sides, own, h, near, far)
        if tree.shafts is not None:
            springs = tree.springs
            sides.branch_end[springs], sides.rest_end[springs] = z[springs], zd[springs]
            sides.branch_passed[springs], sides.rest_passed[springs] = zz[springs], y[springs]
    return sides


def _to_roots(tree: Tree, sides: TwoSides, h: list[FloatArray], near: list[FloatArray], far: list[FloatArray]) -> None:
    """From the leaves to the roots; `near`, `far`: w^2 times the end inertia of each shaft."""
    z, zz = list(sides.branch), list(sides.branch_through)
    ends, shown = (zz, zz) if tree.shafts is None else (list(sides.branch_end), list(sides.branch_passed))
    parents, shafts, add, reciprocal = tree.parents, tree.shaft_of, np.add, np.reciprocal
    for i in range(tree.size - 1, -1, -1):
        parent, shaft = parents[i], shafts[i]
        if parent < 0:
            continue
        through, there = zz[i], z[parent]
        reciprocal(z[i] if shaft < 0 else np.subtract(z[i], far[shaft], ends[i]), through)
        add(through, h[i], through)
        reciprocal(through, through)
        add(there, through if shaft < 0 else np.subtract(through, near[shaft], shown[i]), there)


def _to_leaves(
    tree: Tree,
    sides: TwoSides,
    own: FloatArray,
    h: list[FloatArray],
    near: list[FloatArray],
    far: list[FloatArray],
) -> None:
    """From the roots to the leaves."""
    zd, y, term = list(sides.rest), list(sides.rest_through), list(sides.branch_through)
    shafts, base, ends, back = tree.shaft_of, list(own), zd, y
    if tree.shafts is not None:
        ends, back = list(sides.rest_end), list(y)
        for node in tree.shafts.node.tolist():
            term[node], back[node] = sides.branch_passed[node], sides.rest_passed[node]
    add, reciprocal = np.add, np.reciprocal
    for i, children in enumerate(tree.children):
        if len(children) == 1:
            add(base[i], back[i], zd[children[0]])
        elif children:
            _add_siblings(base[i], back[i], children, term, zd)
        for child in children:
            through, shaft = y[child], shafts[child]
            reciprocal(zd[child] if shaft < 0 else np.subtract(zd[child], near[shaft], ends[child]), through)
            add(through, h[child], through)
            reciprocal(through, through)
            if shaft >= 0:
                np.subtract(through, far[shaft], back[child])


def _add_siblings(
    own: FloatArray, back: FloatArray, children: tuple[int, ...], term: list[FloatArray], out: list[FloatArray]
) -> None:
    """Write, for each child, `own` plus `back` plus the terms of its siblings, by sums from the left and the right."""
    add = np.add
    before = children[0]
    add(own, back, out[before])
    for child in children[1:]:
        add(out[before], term[before], out[child])
        before = child
    after = term[before]
    for child in children[-2::-1]:
        add(out[child], after, out[child])
        after = after + term[child]


def forced(tree: Tree, sides: TwoSides, torque: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m) rad and torques (stations, m) N m under `torque` (stations, m) N m at each station.

    The torque is that in the flexibility of a span, as it acts on the side of the leaves. Each side is a stiffness and
    a source (Norton), and both meet at either end: with ff, zz and fd, zd at the root end (fd zz - ff zd)/(zz + zd).
    """
    f, (ff, fd, g) = torque.copy(), np.zeros((3, *torque.shape))
    source, passed, rest, back, own = list(f), list(ff), list(fd), list(g), list(torque)
    add, multiply, parents = np.add, np.multiply, tree.parents
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        to_leaves, to_root = list(sides.to_leaves), list(sides.to_root)
        for i in range(tree.size - 1, -1, -1):
            parent = parents[i]
            if parent >= 0:
                multiply(source[i], to_leaves[i], passed[i])
                add(source[parent], passed[i], source[parent])
        for i, children in enumerate(tree.children):
            if children:
                _add_siblings(own[i], back[i], children, passed, rest)
            for child in children:
                multiply(rest[child], to_root[child], back[child])
        z, zz, zd, y = sides.branch_end, sides.branch_through, sides.rest_end, sides.rest_through
        at_parent, at_station = (fd * zz - ff * zd) / (zz + zd), (g * z - f * y) / (z + y)
        span, angle = np.where(np.abs(zd) <= np.abs(z), at_parent, at_station), (f + g) / sides.total
    if tree.holds:
        angle[tree.held] = 0.0
        span[np.isinf(sides.branch) & np.isinf(sides.rest)] = 0.0  # between two fixed stations
    span[tree.roots] = 0.0
    return angle, span


def _transmission(seen_through: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Angle of the far end of a flexibility over that of the near one, 1/(1 + h z) = zz/z.

    Taken from the rounded zz, which is what the next station has seen: at a node both are large by the same rounding.
    """
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        ratio: FloatArray = seen_through / stiffness
    soft = stiffness == 0.0
    if soft.any():
        ratio[soft] = 1.0
    return ratio
