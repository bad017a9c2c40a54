"""All roots of the determinant of a damped tree at once: how many there are, rough ones to start from, and the roots.

They start from the undamped frequencies and follow by simultaneous iteration (Ehrlich 1967, Aberth 1973).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.elimination import EPS, Layout, layout
from torsion.kernels.natural_modes import start_frequencies
from torsion.kernels.reduction import cut, rigidity
from torsion.kernels.tree import Tree
from torsion.sources import source

if TYPE_CHECKING:
    from torsion.kernels.spring_law import SpringLaw

CONVERGED = 1e-13  # step relative to the root
DOUBLE = 1e-6  # a double root is no better than the root of the precision: steps and gaps of such pairs, relative
SWEEPS = 300
PAIR = np.array([-0.01 + 1j, -0.011 - 1j])  # starts over an undamped frequency, not quite conjugate
TURN = 0.3  # rad, from the negative real axis, of all other starts: two of them may oscillate
FAR = (1e-60, 1e60)  # rad/s: all roots but 0 lie between


@dataclass(frozen=True)
class DampedTree:
    """A tree and its damping, one value a station or span."""

    tree: Tree
    ground: FloatArray  # (stations,) N m s/rad, viscous to ground
    viscous: FloatArray  # (stations,) N m s/rad, viscous in span i
    loss_factor: FloatArray  # (stations,) of span i
    laws: "Mapping[int, SpringLaw]" = field(
        default_factory=dict
    )  # of spans that have one in place of these three

    @cached_property
    def plan(self) -> Layout:
        """What sweeps need to know of the tree."""
        return layout(self.tree, self.tree.flexibility)


def number_of_roots(train: DampedTree) -> tuple[int, int]:
    """How often 0 is a root of det T, and how many other roots there are.

    Far from all roots l p'/p is the number of those of lesser modulus; at a real l > 0 no two of its terms cancel.
    """
    far = np.array(FAR, dtype=np.complex128)
    with np.errstate(divide="ignore", invalid="ignore", under="ignore"):
        number = (far * log_derivative(train, far, lossy=0.0)).real
    if not np.isfinite(number).all():
        raise ValueError(
            "a part of the train has neither inertia nor a support; expected one of them"
        )
    zeros, degree = np.rint(number).astype(int).tolist()
    return zeros, degree - zeros


def rough_roots(train: DampedTree, number: int) -> ComplexArray:
    """Return as many starts (number,): a pair for each undamped frequency, others spread over the rates of its parts."""
    tree = train.tree
    springs, w = tree.cut(np.isinf(tree.flexibility)), np.empty(0)
    bodies = rigidity(springs)
    if bodies.elastic:
        w = start_frequencies(springs, cut(springs, bodies), bodies, bodies.elastic)[0]
    c, inertia = np.abs(np.concatenate([train.ground, train.viscous])), tree.inertia
    flexibility = tree.flexibility[np.isfinite(tree.flexibility)]
    c, inertia, flexibility = (values[values > 0] for values in (c, inertia, flexibility))
    slow = [1.0 / tau for law in train.laws.values() for _, tau in law.terms]
    swings = np.sqrt(1.0 / np.outer(flexibility, inertia))
    rates = np.outer(c, 1.0 / inertia), 1.0 / np.outer(c, flexibility), swings, slow
    rate = np.concatenate([np.ravel(values) for values in rates])
    others = np.arange(number - 2 * len(w))
    spread = np.quantile(rate, (others + 1.0) / (len(others) + 1.0)) if len(others) else np.empty(0)
    aside = spread * np.exp(1j * (np.pi + TURN * (-1.0) ** others))
    return np.concatenate([np.outer(PAIR, w).ravel(), aside])


def log_derivative(train: DampedTree, root: ComplexArray, lossy: float = 1.0) -> ComplexArray:
    """p'/p at each root, (roots,) s, of p = det(l^2 J + l C + K(1 + i eta)); `lossy` scales the loss factors.

    Leaf-to-root elimination and its derivative side by side; rigid spans merge, fixed stations take no part.
    """
    tree, plan, size = train.tree, train.plan, train.plan.size
    total = np.zeros(len(root), dtype=np.complex128)
    stiffness = [train.ground[i] * root + tree.inertia[i] * root * root for i in range(size)]
    slope = [train.ground[i] + 2 * tree.inertia[i] * root for i in range(size)]
    for station in range(size - 1, -1, -1):
        parent = plan.parent[station]
        if plan.prescribed[station] and not (plan.held[station] and parent >= 0):
            continue
        a, da = stiffness[station], slope[station]
        if parent < 0:
            total += da / a
        elif plan.rigid[station]:
            stiffness[parent] += a
            slope[parent] += da
        else:
            c: ComplexArray | float = train.viscous[station]
            if (law := train.laws.get(station)) is not None:
                k, c = law.at_root(root)
                total += law.poles(root)
            else:
                k = (1 + 1j * lossy * train.loss_factor[station]) / tree.flexibility[
                    station
                ] + c * root
            if plan.held[station]:
                stiffness[parent] += k
                slope[parent] += c
                continue
            pivot = a + k
            total += (da + c) / pivot
            share, turned = k / pivot, a / pivot
            stiffness[parent] += a * share
            slope[parent] += da * share * share + c * turned * turned
    return total


@source("Ehrlich1967")
@source("Aberth1973")
def polish_together(
    train: DampedTree,
    start: ComplexArray,
    zeros: int,
    *,
    lossy: float = 1.0,
    mirrored: bool = False,
) -> ComplexArray:
    """Roots (roots,) to about eps, each start led to a root of its own; `zeros` is how often 0 is a root.

    mirrored: the conjugates are roots as well and are kept away from. Raises SolveError if some do not settle.
    """
    # No two starts are equal, none is zero: equal ones are moved by some 1e-7 of themselves.
    root = np.array(start, dtype=np.complex128)
    root[root == 0] = 1e-3 * np.abs(root[root != 0]).min() if root.any() else 1.0
    copies = np.tril(np.abs(root[:, None] - root) <= 1e-9 * np.abs(root), -1).sum(axis=1)
    root *= 1 + 1e-7 * copies * np.exp(0.7j * copies)
    active = np.ones(len(root), dtype=bool)
    step = np.full(len(root), np.inf, dtype=np.complex128)
    for _ in range(SWEEPS):
        moving = np.flatnonzero(active)
        kept_away = np.append(root, root.conj()) if mirrored else root
        step[moving] = _steps(train, root[moving], kept_away, zeros, lossy)
        root[moving] += step[moving]
        active[moving] = ~(np.abs(step[moving]) <= CONVERGED * np.abs(root[moving]))
        if not active.any():
            return root

    # What has not settled must be a double root (a coupling damped just critically).
    for number in np.flatnonzero(active):
        gap = np.abs(np.delete(root, number) - root[number]).min(initial=np.inf)
        near = DOUBLE * abs(root[number])
        if not (abs(step[number]) <= near and gap <= near):
            raise SolveError(
                f"damped modes: no convergence in {SWEEPS} sweeps near {root[number]:.6g} rad/s; "
                "try undamped frequencies as start, or check the damping for misplaced powers of ten"
            )
    return root


def _steps(
    train: DampedTree, roots: ComplexArray, kept_away: ComplexArray, zeros: int, lossy: float
) -> ComplexArray:
    """Step of each root (moving,) to where p is 0 but none of `others` (roots,) is."""
    with np.errstate(all="ignore"):
        slope = log_derivative(train, roots, lossy)
        lost = ~np.isfinite(slope)
        if lost.any():  # exactly on a pole of the elimination: a few eps aside there is none
            slope[lost] = log_derivative(train, roots[lost] * (1 + 8 * EPS), lossy)
        gap = roots[:, None] - kept_away
        gap[gap == 0] = np.inf
        step: ComplexArray = -1 / (slope - ((1 / gap).sum(axis=1) + zeros / roots))
    step[np.isinf(slope)] = 0
    step[~np.isfinite(step)] = 0.01 * np.abs(roots[~np.isfinite(step)])
    return step
