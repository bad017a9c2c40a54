"""Two-sided passes of a tree with bars: as of a plain tree (`passes`), with the end inertias on the way.

What lies outward of a bar is seen through its outer end inertia, its flexibility and its inner one. So the torques at
both ends are products of a stiffness and an angle: no difference of angles, no torque at a free end, exactly.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.kernels.bars.tree import BarTree
from torsion.kernels.sweeps import share
from torsion.kernels.tree import FloatArray, IntArray


@dataclass(frozen=True)
class BarPasses:
    """Dynamic stiffness at w (m,) rad/s; all (stations, m), N m/rad. At a root the inward ones are 0."""

    outward: FloatArray  # z: of the station and all outward of it
    outer: FloatArray  # z': the same with the outer end of the span inward of it
    through: FloatArray  # zz': the same, seen through the flexibility
    passed: FloatArray  # zz: with the inner end: all that the span shows at the parent
    inward: FloatArray  # zd: of all the rest, seen at the parent
    inner: FloatArray  # zd': the same with the inner end of the span
    back: FloatArray  # y': the same, seen through the flexibility
    returned: FloatArray  # y: with the outer end: all that the span shows at the station

    @cached_property
    def total(self) -> FloatArray:
        """Dynamic stiffness of the whole train (stations, m), seen at each station; 0 at a natural frequency."""
        return self.outward + self.returned

    @cached_property
    def transmitted_outward(self) -> FloatArray:
        """Angle of each station over that of its parent (stations, m), without sources outward."""
        return _transmission(self.through, self.outer)

    @cached_property
    def transmitted_inward(self) -> FloatArray:
        """Angle of each parent over that of the station (stations, m), without sources inward."""
        return _transmission(self.back, self.inner)


def bar_passes(train: BarTree, w: FloatArray) -> BarPasses:
    """The two passes at angular frequencies `w` (m,) below the limit. Infinite values are meant."""
    square = w * w
    flexibility, inner, outer = train.bars.at(square)
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        own = train.tree.own_stiffness(square)
        near, far = list(inner * square), list(outer * square)
        passes = BarPasses(own.copy(), *np.zeros((7, *own.shape)))
        h = train.flexibilities(flexibility)
        _inward(train, passes, h, near, far)
        _outward(train, passes, own, h, near, far)
        plain = train.plain
        passes.outer[plain], passes.inner[plain] = passes.outward[plain], passes.inward[plain]
        passes.passed[plain], passes.returned[plain] = passes.through[plain], passes.back[plain]
    return passes


def _inward(
    train: BarTree, passes: BarPasses, h: list[FloatArray], near: list[FloatArray], far: list[FloatArray]
) -> None:
    """From the leaves to the roots; `near`, `far`: w^2 times the end inertia of each bar."""
    z, ends, seen, shown = (list(a) for a in (passes.outward, passes.outer, passes.through, passes.passed))
    parents, bars = train.tree.parents, train.bar_of
    for i in range(train.tree.size - 1, -1, -1):
        parent, bar = parents[i], bars[i]
        if parent < 0:
            continue
        stiffness, through = z[i], seen[i]
        if bar >= 0:
            stiffness = np.subtract(stiffness, far[bar], ends[i])
        np.reciprocal(stiffness, through)
        np.add(through, h[i], through)
        np.reciprocal(through, through)
        if bar >= 0:
            through = np.subtract(through, near[bar], shown[i])
        np.add(z[parent], through, z[parent])


def _outward(
    train: BarTree,
    passes: BarPasses,
    own: FloatArray,
    h: list[FloatArray],
    near: list[FloatArray],
    far: list[FloatArray],
) -> None:
    """From the roots to the leaves."""
    zd, ends, seen, shown = (list(a) for a in (passes.inward, passes.inner, passes.back, passes.returned))
    base, plain, through_bar, bars = list(own), list(passes.through), list(passes.passed), train.bar_of
    for i, children in enumerate(train.tree.children):
        if not children:
            continue
        rest = np.add(base[i], seen[i] if bars[i] < 0 else shown[i])
        if len(children) > 1:
            terms = {child: plain[child] if bars[child] < 0 else through_bar[child] for child in children}
            rows = _shared(children, terms, rest)
        else:
            rows = {children[0]: rest}
        for child in children:
            bar, back = bars[child], seen[child]
            zd[child][:] = stiffness = rows[child]
            if bar >= 0:
                stiffness = np.subtract(stiffness, near[bar], ends[child])
            np.reciprocal(stiffness, back)
            np.add(back, h[child], back)
            np.reciprocal(back, back)
            if bar >= 0:
                np.subtract(back, far[bar], shown[child])


def _shared(children: tuple[int, ...], terms: dict[int, FloatArray], rest: FloatArray) -> dict[int, FloatArray]:
    """For each child `rest` and the terms of its brothers, by sums from both ends."""
    order = range(len(children))
    rows: list[FloatArray] = [rest] * len(children)
    share(order, [terms[child] for child in children], rows, rest)
    return dict(zip(children, rows, strict=True))


def _transmission(seen_through: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Angle of the far end of a flexibility over that of the near one, 1/(1 + h z), from the rounded stiffnesses."""
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        ratio: FloatArray = seen_through / stiffness
    soft = stiffness == 0.0
    if soft.any():
        ratio[soft] = 1.0
    return ratio


def forced(
    train: BarTree, passes: BarPasses, torque: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Angles rad, torques N m at the inner and the outer end of each span and in its flexibility: (stations, m) each.

    Under `torque` (stations, m) N m at each station. A torque is the one exerted on the outer side.
    """
    f, own = torque.copy(), list(torque)
    fd = np.zeros_like(f)
    inner, outer, parents = list(passes.transmitted_inward), list(passes.transmitted_outward), train.tree.parents
    through = np.zeros_like(f)
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        for i in range(train.tree.size - 1, -1, -1):
            if parents[i] >= 0:
                np.multiply(f[i], outer[i], through[i])
                f[parents[i]] += through[i]
        back = np.zeros_like(f)
        for i, children in enumerate(train.tree.children):
            if children:
                rest = own[i] + back[i]
                for child, row in _shared(children, {c: through[c] for c in children}, rest).items():
                    fd[child] = row
                    np.multiply(row, inner[child], back[child])
        z, y, zz, zd = passes.outward, passes.returned, passes.passed, passes.inward
        angle = (f + back) / passes.total
        at_parent = (fd * zz - through * zd) / (zz + zd)
        at_station = (back * z - f * y) / passes.total
        between_parent = (fd * passes.through - through * passes.inner) / (passes.through + passes.inner)
        between_station = (back * passes.outer - f * passes.back) / (passes.outer + passes.back)
        between = np.where(np.abs(passes.inner) <= np.abs(passes.outer), between_parent, between_station)
    angle[train.tree.held] = 0.0
    return angle, *_ends(train, passes, at_parent, at_station, between)


def _ends(
    train: BarTree, passes: BarPasses, at_parent: FloatArray, at_station: FloatArray, between: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Torques at both ends and between; at a held end, and all along a plain span, that between the ends."""
    between[np.isinf(passes.outward) & np.isinf(passes.inward)] = 0.0  # between two held stations
    at_parent, at_station = (
        np.where(np.isinf(stiffness), between, values)
        for stiffness, values in ((passes.inward, at_parent), (passes.outward, at_station))
    )
    at_parent[train.plain] = at_station[train.plain] = between[train.plain]
    for row in (at_parent, at_station, between):
        row[train.tree.roots] = 0.0
    return at_parent, at_station, between


def spread(train: BarTree, inner: FloatArray, outer: FloatArray, start: IntArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m) that are 1 at `start` (m,), and those of them at the start and inward of it, else 0."""
    angle, product = np.zeros(outer.shape), np.empty(len(start))
    angle[start, np.arange(len(start))] = 1.0
    rows, parents = list(angle), train.tree.parents
    for i in range(train.tree.size - 1, -1, -1):
        if parents[i] >= 0:
            np.multiply(rows[i], inner[i], product)
            np.add(rows[parents[i]], product, rows[parents[i]])
    inward = angle.copy()
    factor = list(np.where(inward != 0.0, 0.0, outer))
    for i, parent in enumerate(parents):
        if parent >= 0:
            np.multiply(rows[parent], factor[i], product)
            np.add(rows[i], product, rows[i])
    return angle, inward
