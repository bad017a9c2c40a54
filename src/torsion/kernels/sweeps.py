"""Sweeps of a tree with sources and damping: every branch from its leaves, then both sides of every span from the root.

The mixed angle/torque form (flexibility, never stiffness) with sums of terms only: rigid spans and massless
stations need no special case, and every value is accurate relative to the data of the springs, however unequal.
Beside `two_sides`, for values that may be complex: z/(1 + h z) in place of 1/(h + 1/z), because quotients of complex
zeros and infinities are not numbers, and for one right-hand side, whose branches without sources cost a product each.
Rows run over columns: frequencies or roots. Floating point exceptions are left to the caller's `np.errstate`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.layers import share
from torsion.kernels.tree import Tree

Row = NDArray[Any]  # (columns,) real or complex: one value a frequency or a root
Rows = list[
    Any
]  # a Row a station; None where the value is infinite, has no meaning or is no longer needed
EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Layout:
    """What the sweeps need to know of a tree: plain lists, and which stations are moved rather than free to move."""

    parent: list[int]
    children: tuple[tuple[int, ...], ...]
    held: list[bool]
    rigid: list[bool]  # span i has no flexibility
    prescribed: list[bool]  # `held`, or rigidly joined to such a root

    @property
    def size(self) -> int:
        """Number of stations."""
        return len(self.parent)


@dataclass(frozen=True)
class Branches:
    """Every branch, sources included, from its leaves: z angle = f + torque of span i on station i."""

    stiffness: Rows  # z, N m/rad: station i with all beyond it
    stiffness_through: Rows  # z/(1 + hc z): the same felt by the parent through span i
    source: Rows  # f, N m; None where nothing acts
    source_through: Rows  # (f - z twist)/(1 + hc z); None where nothing acts
    transfer: (
        Rows  # 1/(1 + hc z); kept where nothing acts in the branch, or its parent is prescribed
    )


def layout(tree: Tree, compliance: NDArray[Any]) -> Layout:
    """Lists for the sweeps; `compliance` is (stations,) or (stations, columns), rad/(N m).

    Raises ValueError for a fixed station that is neither root nor leaf, and for a rigid span to a fixed leaf.
    """
    zero = compliance == 0
    rigid = zero if zero.ndim == 1 else zero.all(axis=1)
    if zero.ndim > 1 and bool((zero.any(axis=1) & ~rigid).any()):
        raise ValueError(
            "a span is rigid at some frequencies only; expected rigid at all or at none"
        )
    leaf = tree.held & (tree.parent >= 0)
    if any(tree.children[station] for station in np.flatnonzero(leaf)):
        raise ValueError(
            "a fixed station has spans on both sides; expected a root or a leaf (split the tree there)"
        )
    if bool((leaf & rigid).any()):
        raise ValueError(
            "a rigid span leads to a fixed leaf; expected that fixed station as the root"
        )
    held, is_rigid = tree.held.tolist(), rigid.tolist()
    prescribed = list(held)
    for station, inner in enumerate(tree.parents):
        if inner >= 0 and is_rigid[station]:
            prescribed[station] = prescribed[inner]
    return Layout(tree.parents, tree.children, held, is_rigid, prescribed)


def branches(
    plan: Layout,
    own: Sequence[Row],
    compliance: Sequence[Row],
    force: Sequence[Any],
    twist: Sequence[Any] | None = None,
    guard: bool = False,
    room: tuple[Rows, Rows] | None = None,
) -> Branches:
    """Dynamic stiffness and sources of all branches, leaves first; a force or twist that is None does not act.

    `guard` replaces a denominator that is exactly zero (a branch in resonance with its root end fixed, such as a
    vibration absorber in tune) by eps, which is a relative change of that one flexibility by eps.
    `room`: rows of the right type that stiffness and source of every station but a root may be put in.
    """
    found = Branches(*([None] * plan.size for _ in range(5)))
    for station in range(plan.size - 1, -1, -1):
        q = None if twist is None else twist[station]
        hc = compliance[station]
        inner = plan.parent[station] >= 0
        if plan.held[station]:
            if inner:
                found.stiffness_through[station] = 1 / hc
                found.source_through[station] = None if q is None else -q / hc
            continue
        z, f = own[station], force[station]
        z_row, f_row = (
            (None, None) if room is None or not inner else (room[0][station], room[1][station])
        )
        for child in plan.children[station]:
            z = np.add(z, found.stiffness_through[child], out=z_row)
            f = total(f, found.source_through[child], f_row)
        if (
            len(plan.children[station]) == 1
        ):  # no sibling needs to know what it passes on: free the memory
            found.stiffness_through[plan.children[station][0]] = found.source_through[
                plan.children[station][0]
            ] = None
        found.stiffness[station], found.source[station] = z, f
        if inner:
            factor = guarded_sum(hc * z, guard)
            np.reciprocal(factor, out=factor)
            found.stiffness_through[station] = z * factor
            pushed = total(f, None if q is None else -q * z)
            found.source_through[station] = None if pushed is None else pushed * factor
            if pushed is None or plan.prescribed[plan.parent[station]]:
                found.transfer[station] = factor
    return found


def total(one: Any, other: Any, out: Row | None = None) -> Any:
    """Sum of two sources, each of which may be None: nothing acts. `out` may be used for it."""
    if one is None or other is None:
        return other if one is None else one
    return np.add(one, other, out=out)


def guarded_sum(product: Row, guard: bool) -> Row:
    """1 + product, in the memory of `product`; see `branches` for `guard`."""
    product += 1
    if guard:
        product[product == 0] = EPS
    return product


@dataclass(frozen=True)
class Equations:
    """One linear system for every column: own angle = force + torques, angle = angle of parent - hc torque + twist."""

    own: NDArray[
        Any
    ]  # (stations, columns) N m/rad, the dynamic stiffness of each station by itself
    compliance: NDArray[Any]  # hc, (stations,) or (stations, columns) rad/(N m)
    force: Sequence[Any]  # N m: a number or a row a station; None where none acts
    twist: Sequence[Any]  # rad: the same of the span


@dataclass(frozen=True)
class Sweep:
    """All that the way from the root needs."""

    plan: Layout
    given: Equations
    found: Branches
    compliance: Rows  # hc
    loud: list[bool]  # something acts in the branch of span i, or on that span
    angle: Rows
    torque: Rows
    stiffness: Rows  # zd, N m/rad: everything but the branch of span i, at its parent
    source: Rows  # fd, N m: the same; None where nothing acts
    receptance: (
        Rows  # rad/(N m): angle of station i under a unit torque on it; None where prescribed
    )
    guard: bool


def solve(
    plan: Layout,
    given: Equations,
    angle: ComplexArray,
    torque: ComplexArray,
    *,
    sensitivity: FloatArray | None = None,
    guard: bool = False,
) -> None:
    """Fill `angle` and `torque`, zero at first: angle = (f d + e)/D rad, torque = (e z - f zd)/D N m with D = z d + zd.

    On the way their rows hold f and z. `sensitivity` takes the sums of |own receptance|: (columns,), or (2 columns,)
    with |real| and |imaginary| side by side. z, f: stiffness and source of the branch of span i; zd, fd: of everything
    else, at the parent; d = 1 + hc zd and e = fd + zd twist. No angle is ever subtracted from another, so that the only
    cancellation is that of the physics. The receptance of station i is d/D. Where nothing acts in a branch, angle =
    transfer times angle of the parent, and torque = z angle. (1/D as a product along the train would spread the loss of
    one local resonance over all of it.)
    """
    own, compliance = list(given.own), values_or_rows(given.compliance)
    rows = list(angle), list(torque)
    room = (rows[1], rows[0]) if np.iscomplexobj(given.own) else None
    found = branches(plan, own, compliance, given.force, given.twist, guard, room)
    loud = [f is not None or q is not None for f, q in zip(found.source, given.twist, strict=True)]
    zd, fd, receptance = ([None] * plan.size for _ in range(3))
    at = Sweep(plan, given, found, compliance, loud, *rows, zd, fd, receptance, guard)
    for i, parent in enumerate(plan.parent):
        if parent < 0:
            _root(at, i)
        elif not loud[i]:
            _quiet(at, i, sensitivity is not None)
        elif plan.prescribed[parent]:
            _beside_prescribed(at, i)
        else:
            _join(at, i, sensitivity is not None)
        if sensitivity is not None and at.receptance[i] is not None:
            loss = (own[i] * at.receptance[i]).view(np.float64)
            sensitivity += np.abs(loss, out=loss)
        _forget(at, i)


def values_or_rows(values: NDArray[Any]) -> list[Any]:
    """Numbers or rows, one a station."""
    return list(values.tolist()) if values.ndim == 1 else list(values)


def _root(at: Sweep, i: int) -> None:
    if at.plan.held[i]:
        return
    f, receptance = at.found.source[i], np.reciprocal(at.found.stiffness[i])
    at.receptance[i] = receptance
    if f is not None:
        np.multiply(f, receptance, out=at.angle[i])
    _share_out(at, i, at.given.own[i], at.given.force[i])


def _quiet(at: Sweep, i: int, with_receptance: bool) -> None:
    """A span that only follows what comes from its root end."""
    hc, parent = at.compliance[i], at.plan.parent[i]
    if at.plan.held[i]:
        np.multiply(at.angle[parent], 1 / hc, out=at.torque[i])
        return
    transfer = at.found.transfer[i]
    np.multiply(at.angle[parent], transfer, out=at.angle[i])
    np.multiply(at.angle[i], at.found.stiffness[i], out=at.torque[i])
    if with_receptance and not at.plan.prescribed[i]:
        beyond = at.receptance[parent]
        at.receptance[i] = transfer * (hc if beyond is None else hc + transfer * beyond)


def _join(at: Sweep, i: int, with_receptance: bool) -> None:
    """A span with something that acts in its branch or on it, and a parent that is free to move."""
    hc, q, zd, fd = at.compliance[i], at.given.twist[i], at.stiffness[i], at.source[i]
    z, f = at.found.stiffness[i], at.found.source[i]
    e = total(fd, None if q is None else zd * q)
    d = guarded_sum(hc * zd, at.guard)
    if at.plan.held[i]:
        np.multiply(e, np.reciprocal(d), out=at.torque[i])
        return
    meeting = z * d
    meeting += zd
    np.reciprocal(meeting, out=meeting)
    if with_receptance:
        at.receptance[i] = d * meeting
    if f is None:
        np.multiply(e, meeting, out=at.angle[i])
        np.multiply(z, at.angle[i], out=at.torque[i])
    elif e is None:
        f = f * meeting
        np.multiply(f, d, out=at.angle[i])
        np.negative(f * zd, out=at.torque[i])
    else:
        f, turned = f * meeting, e * meeting
        np.multiply(z, turned, out=at.torque[i])
        at.torque[i] -= f * zd
        np.add(np.multiply(f, d, out=f), turned, out=at.angle[i])
    if any(at.loud[child] for child in at.plan.children[i]):
        np.reciprocal(d, out=d)
        source = total(at.given.force[i], None if e is None else e * d)
        _share_out(at, i, at.given.own[i] + zd * d, source)


def _beside_prescribed(at: Sweep, i: int) -> None:
    """A span whose root end turns by a given angle; with its twist, `moved`."""
    hc, q, torque = at.compliance[i], at.given.twist[i], at.torque[i]
    moved = at.angle[at.plan.parent[i]]
    if q is not None:
        moved = moved + q
    if at.plan.held[i]:
        np.divide(moved, hc, out=torque)
        return
    z, f = at.found.stiffness[i], at.found.source[i]
    f = 0.0 if f is None else f
    if at.plan.rigid[i]:
        np.subtract(moved * z, f, out=torque)
        at.angle[i][:] = moved
        return
    factor = at.found.transfer[i]
    at.receptance[i] = hc * factor
    np.multiply(moved * z - f, factor, out=torque)
    np.multiply(moved + hc * f, factor, out=at.angle[i])
    _share_out(at, i, at.given.own[i] + 1 / hc, total(at.given.force[i], moved / hc))


def _share_out(at: Sweep, i: int, stiffness: Row, source: Any) -> None:
    """Give every child in whose branch something acts what everything else does at station i.

    stiffness, source: of station i with what lies toward the root.
    """
    through, children = at.found.stiffness_through, at.plan.children[i]
    loud = [child for child in children if at.loud[child]]
    if loud and len(loud) < len(children):
        for child in children:
            if not at.loud[child]:
                stiffness = stiffness + through[child]
    if loud:
        share(loud, through, at.stiffness, stiffness)
        share(loud, at.found.source_through, at.source, source, total)


def _forget(at: Sweep, i: int) -> None:
    """Free the memory of what nobody needs any more."""
    at.stiffness[i] = at.source[i] = None
    at.found.stiffness[i] = at.found.source[i] = at.found.transfer[i] = None
    parent = at.plan.parent[i]
    if parent >= 0 and at.plan.children[parent][-1] == i:
        at.receptance[parent] = None
    if not at.plan.children[i]:
        at.receptance[i] = None
