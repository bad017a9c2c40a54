"""Sweep of a tree from its leaves: dynamic stiffness and sources of every branch as its root end feels them.

The mixed angle/torque form (flexibility, never stiffness) with sums of terms only: rigid spans and massless
stations need no special case, and every value is accurate relative to the data of the springs, however unequal.
Rows run over columns: frequencies or roots. Floating point exceptions are left to the caller's `np.errstate`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray
from torsion.kernels.tree import Tree

Row = NDArray[Any]  # (columns,) real or complex: one value a frequency or a root
Rows = list[Any]  # a Row a station; None where the value is infinite, has no meaning or is no longer needed
EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Layout:
    """What the sweeps need to know of a tree: plain lists, and which stations are moved rather than free to move."""

    parent: list[int]
    children: tuple[tuple[int, ...], ...]
    held: list[bool]
    rigid: list[bool]  # span i has no flexibility
    prescribed: list[bool]  # held, or rigidly joined to a held root

    @property
    def size(self) -> int:
        """Number of stations."""
        return len(self.parent)


@dataclass(frozen=True)
class Branches:
    """Every branch, sources included, from its leaves: z angle = f + torque of span i on station i."""

    stiffness: Rows  # z, N m/rad: station i with all that hangs on it
    stiffness_through: Rows  # z/(1 + hc z): the same felt by the parent through span i
    source: Rows  # f, N m; None where nothing acts
    source_through: Rows  # (f - z twist)/(1 + hc z); None where nothing acts
    transfer: Rows  # 1/(1 + hc z); kept where nothing acts in the branch, or its parent is prescribed


def layout(tree: Tree, compliance: NDArray[Any]) -> Layout:
    """Lists for the sweeps; `compliance` is (stations,) or (stations, columns), rad/(N m).

    Raises ValueError for a held station that is neither root nor leaf, and for a rigid span to a held leaf.
    """
    zero = compliance == 0
    rigid = zero if zero.ndim == 1 else zero.all(axis=1)
    if zero.ndim > 1 and bool((zero.any(axis=1) & ~rigid).any()):
        raise ValueError("a span is rigid at some frequencies only; expected rigid at all or at none")
    _check_held(tree, rigid)
    parent = tree.parent.tolist()
    held = tree.held.tolist()
    prescribed = list(held)
    for station, inner in enumerate(parent):
        if inner >= 0 and not held[station]:
            prescribed[station] = bool(rigid[station]) and prescribed[inner]
    return Layout(parent, tree.children, held, rigid.tolist(), prescribed)


def _check_held(tree: Tree, rigid: BoolArray) -> None:
    leaf = tree.held & (tree.parent >= 0)
    if any(tree.children[station] for station in np.flatnonzero(leaf)):
        raise ValueError("a held station has spans on both sides; expected a root or a leaf (split the tree there)")
    if bool((leaf & rigid).any()):
        raise ValueError("a rigid span leads to a held leaf; expected that held station as the root")


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

    `guard` replaces a denominator that is exactly zero (a branch in resonance with its root end held, such as a
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
        z_row, f_row = (None, None) if room is None or not inner else (room[0][station], room[1][station])
        for child in plan.children[station]:
            z = np.add(z, found.stiffness_through[child], out=z_row)
            f = total(f, found.source_through[child], f_row)
        _drop_if_alone(plan.children[station], found)
        found.stiffness[station], found.source[station] = z, f
        if inner:
            factor = inverse_sum(hc * z, guard)
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


def _drop_if_alone(children: tuple[int, ...], found: Branches) -> None:
    """An only child has no siblings that need to know what it passes on: free the memory."""
    if len(children) == 1:
        found.stiffness_through[children[0]] = found.source_through[children[0]] = None


def inverse_sum(product: Row, guard: bool) -> Row:
    """1/(1 + product), in the memory of `product`; see `branches` for `guard`."""
    return np.reciprocal(guarded_sum(product, guard), out=product)


def guarded_sum(product: Row, guard: bool) -> Row:
    """1 + product, in the memory of `product`; see `branches` for `guard`."""
    product += 1
    if guard:
        product[product == 0] = EPS
    return product


def share(children: Sequence[int], through: Rows, outward: Rows, remainder: Any, add: Any = np.add) -> None:
    """Give every child the sum of all the others: by sums from both ends, never as the total minus its own."""
    if len(children) == 1:
        outward[children[0]] = remainder
        return
    before = remainder
    for child in children:
        outward[child] = before
        before = add(before, through[child])
    after: Any = None
    for child in reversed(children):
        if after is not None:
            outward[child] = add(outward[child], after)
        after = through[child] if after is None else add(after, through[child])
