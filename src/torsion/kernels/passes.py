"""Two-sided passes: the dynamic stiffness of both sides of every span, and what follows without a difference of angles.

One sweep from the leaves to the roots and one back give, at every span, the stiffness of the train outward and inward
of it, both as sums of terms only: the share of brothers is summed from the left and from the right, never taken from a
total. Angles are then products outward from one station, torques products of a stiffness and an angle, so that each
component keeps its own relative accuracy (the re-rooted, or twisted, factorisation of Parlett and Dhillon 1997).
"""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.tree import FloatArray, IntArray, Tree


@dataclass(frozen=True)
class Passes:
    """Dynamic stiffness at w (m,) rad/s; all (stations, m), N m/rad. At a root the inward ones are 0."""

    own: FloatArray  # of the station alone
    outward: FloatArray  # z: of the station and all outward of it, seen at the station
    passed: FloatArray  # zz: the same, seen through the span from the parent
    inward: FloatArray  # zd: of all the rest, seen at the parent
    returned: FloatArray  # y: the same, seen through the span from the station

    @property
    def total(self) -> FloatArray:
        """Dynamic stiffness of the whole train (stations, m), seen at each station; 0 at a natural frequency."""
        return self.outward + self.returned


def stiffness_passes(tree: Tree, w: FloatArray) -> Passes:
    """The two passes at angular frequencies `w` (m,). Infinite values are meant: a held station, a node."""
    own = tree.rest_stiffness[:, None] - np.multiply.outer(tree.moving_inertia, w * w)
    outward, (passed, inward, returned) = own.copy(), np.zeros((3, *own.shape))
    h, parents = tree.flexibility.tolist(), tree.parent.tolist()
    base, z, zz, zd, y = list(own), list(outward), list(passed), list(inward), list(returned)
    add, reciprocal = np.add, np.reciprocal
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        for i in range(tree.size - 1, -1, -1):
            parent = parents[i]
            if parent >= 0:
                through = zz[i]
                reciprocal(z[i], through)
                add(through, h[i], through)
                reciprocal(through, through)
                add(z[parent], through, z[parent])
        for i, children in enumerate(tree.children):
            if children:
                _share(base[i], y[i], children, zz, zd)
            for child in children:
                through = y[child]
                reciprocal(zd[child], through)
                add(through, h[child], through)
                reciprocal(through, through)
    return Passes(own, outward, passed, inward, returned)


def forced(tree: Tree, passes: Passes, torque: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m) rad and span torques (stations, m) N m under `torque` (stations, m) N m at each station.

    The torque in a span is the one it exerts on its outer station. Each side is a stiffness and a torque (Norton), and
    at either end of the span both sides meet: with ff, zz and fd, zd at the parent, t = (fd zz - ff zd) / (zz + zd).
    """
    f, fd, g = torque.copy(), np.zeros_like(torque), np.zeros_like(torque)
    z, zz, zd, y = passes.outward, passes.passed, passes.inward, passes.returned
    parents, ff, own = tree.parent.tolist(), np.zeros_like(torque), list(torque)
    f_rows, fd_rows, ff_rows, g_rows = list(f), list(fd), list(ff), list(g)
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        outer, inner = _transmission(passes.passed, z), _transmission(passes.returned, zd)
        for i in range(tree.size - 1, -1, -1):
            if parents[i] >= 0:
                np.multiply(f_rows[i], outer[i], out=ff_rows[i])
                np.add(f_rows[parents[i]], ff_rows[i], out=f_rows[parents[i]])
        for i, children in enumerate(tree.children):
            if children:
                _share(own[i], g_rows[i], children, ff_rows, fd_rows)
                for child in children:
                    np.multiply(fd_rows[child], inner[child], out=g_rows[child])
        angle = (f + g) / passes.total
        span = np.where(np.abs(zd) <= np.abs(z), (fd * zz - ff * zd) / (zz + zd), (g * z - f * y) / (z + y))
    span[np.isinf(z) & np.isinf(zd)] = 0.0  # between two held stations
    span[tree.parent < 0] = 0.0
    return np.where(tree.held[:, None], 0.0, angle), span


def free_shapes(tree: Tree, passes: Passes) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angles and span torques (stations, m), mass-normalised, and the correction (m,) of w^2 by Rayleigh's quotient.

    Each column starts at the station where the residual |Z| / J is least. A column comes out not finite where `w` is a
    repeated frequency to the last digit: its shape is not determined by one station.
    """
    total = passes.total
    start = _least_residual(tree, total)
    column = np.arange(total.shape[1])
    angle = np.zeros_like(total)
    angle[start, column] = 1.0
    parents = tree.parent.tolist()
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        inner = _transmission(passes.returned, passes.inward)
        outer = _transmission(passes.passed, passes.outward)
        rows, factor, product = list(angle), list(inner), np.empty(total.shape[1])
        multiply, add = np.multiply, np.add
        for i in range(tree.size - 1, -1, -1):
            if parents[i] >= 0:
                multiply(rows[i], factor[i], product)
                add(rows[parents[i]], product, rows[parents[i]])
        start_is_outward = angle != 0.0
        factor = list(np.where(start_is_outward, 0.0, outer))
        for i, parent in enumerate(parents):
            if parent >= 0:
                multiply(rows[parent], factor[i], product)
                add(rows[i], product, rows[i])
        torque = np.where(start_is_outward, -passes.returned * angle, passes.passed * angle[tree.parent])
        torque[tree.parent < 0] = 0.0
        mass = np.einsum("i,ij,ij->j", tree.moving_inertia, angle, angle)
        correction = total[start, column] / mass
        scale = 1.0 / np.sqrt(mass)
        return angle * scale, torque * scale, correction


def _least_residual(tree: Tree, total: FloatArray) -> IntArray:
    """Station (m,) with inertia at which |Z| / J is least."""
    carriers = np.flatnonzero(tree.moving_inertia > 0.0)
    residual = np.abs(total[carriers]) / tree.moving_inertia[carriers, None]
    residual[np.isnan(residual)] = np.inf
    best: IntArray = carriers[np.argmin(residual, axis=0)]
    return best


def _transmission(seen_through: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Angle of the far end of a span over that of the near one, 1/(1 + h z) = zz/z.

    Taken from the rounded zz, which is what the next station has seen: at a node both are large by the same rounding.
    """
    return np.where(stiffness == 0.0, 1.0, seen_through / stiffness)


def _share(
    own: FloatArray,
    inner: FloatArray,
    children: tuple[int, ...],
    term: list[FloatArray],
    out: list[FloatArray],
) -> None:
    """Write, for each child, `own` plus `inner` plus the terms of its brothers, by sums from the left and the right."""
    first, *later = children
    np.add(own, inner, out[first])
    before = first
    for child in later:
        np.add(out[before], term[before], out[child])
        before = child
    after = term[children[-1]]
    for child in reversed(children[:-1]):
        np.add(out[child], after, out[child])
        after = after + term[child]
