"""Two-sided passes: the dynamic stiffness of both sides of every span, and what follows without a difference of angles.

One sweep from the leaves to the roots and one back give, at every span, the stiffness of the train outward and inward
of it, both as sums of terms only: the share of brothers is summed from the left and from the right, never taken from a
total. Angles are then products outward from one station, torques products of a stiffness and an angle, so that each
component keeps its own relative accuracy (the re-rooted, or twisted, factorisation of Parlett and Dhillon 1997).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.kernels.tree import FloatArray, Tree


@dataclass(frozen=True)
class Passes:
    """Dynamic stiffness at w (m,) rad/s; all (stations, m), N m/rad. At a root the inward ones are 0."""

    own: FloatArray  # of the station alone
    outward: FloatArray  # z: of the station and all outward of it, seen at the station
    passed: FloatArray  # zz: the same, seen through the span from the parent
    inward: FloatArray  # zd: of all the rest, seen at the parent
    returned: FloatArray  # y: the same, seen through the span from the station

    @cached_property
    def total(self) -> FloatArray:
        """Dynamic stiffness of the whole train (stations, m), seen at each station; 0 at a natural frequency."""
        return self.outward + self.returned

    @cached_property
    def transmitted_outward(self) -> FloatArray:
        """Angle of each station over that of its parent (stations, m), without sources outward."""
        return _transmission(self.passed, self.outward)

    @cached_property
    def transmitted_inward(self) -> FloatArray:
        """Angle of each parent over that of the station (stations, m), without sources inward."""
        return _transmission(self.returned, self.inward)


def stiffness_passes(tree: Tree, w: FloatArray) -> Passes:
    """The two passes at angular frequencies `w` (m,). Infinite values are meant: a held station, a node."""
    own = tree.own_stiffness(w * w)
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        return _passes(tree, own)


def _passes(tree: Tree, own: FloatArray) -> Passes:
    outward, (passed, inward, returned) = own.copy(), np.zeros((3, *own.shape))
    h, parents = tree.flexibilities, tree.parents
    base, z, zz, zd, y = list(own), list(outward), list(passed), list(inward), list(returned)
    add, reciprocal = np.add, np.reciprocal
    for i in range(tree.size - 1, -1, -1):
        parent = parents[i]
        if parent >= 0:
            through, there = zz[i], z[parent]
            reciprocal(z[i], through)
            add(through, h[i], through)
            reciprocal(through, through)
            add(there, through, there)
    for i, children in enumerate(tree.children):
        if len(children) == 1:
            add(base[i], y[i], zd[children[0]])
        elif children:
            _share(base[i], y[i], children, zz, zd)
        for child in children:
            through = y[child]
            reciprocal(zd[child], through)
            add(through, h[child], through)
            reciprocal(through, through)
    return Passes(own, outward, passed, inward, returned)


@dataclass(frozen=True)
class Norton:
    """The sources on both sides of every span; all (stations, m), N m."""

    outward: FloatArray  # f: of the station and all outward of it
    passed: FloatArray  # ff: the same, seen through the span from the parent
    inward: FloatArray  # fd: of all the rest, seen at the parent
    returned: FloatArray  # g: the same, seen through the span from the station


def sources(tree: Tree, passes: Passes, torque: FloatArray) -> Norton:
    """What `torque` (stations, m) N m at each station comes to on both sides of every span."""
    outward, (passed, inward, returned) = torque.copy(), np.zeros((3, *torque.shape))
    parents, own = tree.parents, list(torque)
    f, ff, fd, g = list(outward), list(passed), list(inward), list(returned)
    add, multiply = np.add, np.multiply
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        outer, inner = list(passes.transmitted_outward), list(passes.transmitted_inward)
        for i in range(tree.size - 1, -1, -1):
            parent = parents[i]
            if parent >= 0:
                multiply(f[i], outer[i], ff[i])
                add(f[parent], ff[i], f[parent])
        for i, children in enumerate(tree.children):
            if len(children) == 1:
                add(own[i], g[i], fd[children[0]])
            elif children:
                _share(own[i], g[i], children, ff, fd)
            for child in children:
                multiply(fd[child], inner[child], g[child])
    return Norton(outward, passed, inward, returned)


def forced_angles(tree: Tree, passes: Passes, norton: Norton) -> FloatArray:
    """Angles (stations, m) rad under the sources `norton`."""
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        angle: FloatArray = (norton.outward + norton.returned) / passes.total
    if tree.holds:
        angle[tree.held] = 0.0
    return angle


def forced(tree: Tree, passes: Passes, torque: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m) rad and span torques (stations, m) N m under `torque` (stations, m) N m at each station.

    The torque in a span is the one it exerts on its outer station. Each side is a stiffness and a torque (Norton), and
    at either end of the span both sides meet: with ff, zz and fd, zd at the parent, t = (fd zz - ff zd) / (zz + zd).
    """
    norton = sources(tree, passes, torque)
    f, ff, fd, g = norton.outward, norton.passed, norton.inward, norton.returned
    z, zz, zd, y = passes.outward, passes.passed, passes.inward, passes.returned
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        at_parent, at_station = (fd * zz - ff * zd) / (zz + zd), (g * z - f * y) / passes.total
        span = np.where(np.abs(zd) <= np.abs(z), at_parent, at_station)
    if tree.holds:
        span[np.isinf(z) & np.isinf(zd)] = 0.0  # between two held stations
    span[tree.roots] = 0.0
    return forced_angles(tree, passes, norton), span


def _transmission(seen_through: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Angle of the far end of a span over that of the near one, 1/(1 + h z) = zz/z.

    Taken from the rounded zz, which is what the next station has seen: at a node both are large by the same rounding.
    Floating point exceptions are left to the caller's `np.errstate`.
    """
    ratio: FloatArray = seen_through / stiffness
    soft = stiffness == 0.0
    if soft.any():
        ratio[soft] = 1.0
    return ratio


def _share(
    own: FloatArray,
    inner: FloatArray,
    children: tuple[int, ...],
    term: list[FloatArray],
    out: list[FloatArray],
) -> None:
    """Write, for each child, `own` plus `inner` plus the terms of its brothers, by sums from the left and the right."""
    before = children[0]
    np.add(own, inner, out[before])
    for child in children[1:]:
        np.add(out[before], term[before], out[child])
        before = child
    after = term[before]
    for child in children[-2::-1]:
        np.add(out[child], after, out[child])
        after = after + term[child]
