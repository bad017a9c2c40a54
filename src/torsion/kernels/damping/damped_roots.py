"""All roots of the determinant of a damped tree at once: how many there are, rough ones to start from, and the roots.

The start is the first-order form, the roots follow by simultaneous iteration (Ehrlich 1967, Aberth 1973).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.elimination import EPS, Layout, layout
from torsion.kernels.reduction import rigidity
from torsion.kernels.spanning_forest import connected
from torsion.kernels.tree import Tree
from torsion.sources import source

if TYPE_CHECKING:
    from torsion.kernels.spring_law import SpringLaw

CONVERGED = 1e-13  # step relative to the root
DOUBLE = 1e-6  # a double root is no better than the root of the precision: steps and gaps of such pairs, relative
SWEEPS = 300
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


def first_order_eigenvalues(train: DampedTree) -> np.ndarray:
    """Eigenvalues of the first-order form in sqrt(J) speed and torque/sqrt(k), skew-symmetric where undamped.

    Rigid spans are merged, massless stations are eliminated: where dampers act on them by their speeds, else by
    the balance of torques. All eigenvalues are returned, the structural zeros among them.
    """
    tree, bodies = train.tree, rigidity(train.tree)
    moving = np.unique(bodies.body[~bodies.fixed])
    count = len(moving)
    body = np.where(
        bodies.fixed, count, np.searchsorted(moving, bodies.body)
    )  # the last one is the ground
    inertia, ground = np.zeros((2, count + 1))
    np.add.at(inertia, body, tree.inertia)
    np.add.at(ground, body, train.ground)
    span = np.flatnonzero((tree.parent >= 0) & (tree.flexibility > 0))
    ends, flexibility, viscous = (
        body[np.stack([span, tree.parent[span]])],
        tree.flexibility[span],
        train.viscous[span],
    )
    if train.laws:
        ends, flexibility, viscous = _with_states(train, span, (ends, flexibility, viscous), count)
        extra_states = sum(len(law.terms) for law in train.laws.values())
        inertia, ground = (
            np.concatenate([values[:-1], np.zeros(extra_states), values[-1:]])
            for values in (inertia, ground)
        )
        count += extra_states

    # Twists of all spans, then springs by their torques and dampers by their speeds.
    twist = np.subtract(*np.eye(count + 1)[ends])[:, :count]
    elastic = np.isfinite(flexibility)
    G = twist[elastic] / np.sqrt(flexibility[elastic])[:, None]
    C = np.diag(ground[:-1]) + twist.T @ (viscous[:, None] * twist)
    return np.linalg.eigvals(
        _condense(inertia[:-1], C, G, *_slow_groups(inertia, ground, ends[:, viscous > 0]))
    )


def _with_states(
    train: DampedTree, span: IntArray, spans: tuple[IntArray, FloatArray, FloatArray], count: int
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Ends, flexibility and viscous damping of the spans, and of a spring and a damper in a row for every term.

    Between the two of a term is a station without inertia of its own, numbered from `count` on; the ground is last.
    """
    ends, flexibility, viscous = spans
    extra_states = sum(len(law.terms) for law in train.laws.values())
    ends = np.where(ends == count, count + extra_states, ends)
    flexibility, viscous, state, extra = flexibility.copy(), viscous.copy(), count, []
    for station, law in train.laws.items():
        (row,) = np.flatnonzero(span == station)
        flexibility[row], viscous[row] = 1.0 / law.static, 0.0
        for k, tau in law.terms:
            extra += [(ends[0, row], state, 1.0 / k, 0.0), (state, ends[1, row], np.inf, k * tau)]
            state += 1
    first, second, soft, damping = np.array(extra).T
    ends = np.hstack([ends, np.array([first, second], dtype=np.int64)])
    return ends, np.append(flexibility, soft), np.append(viscous, damping)


def _condense(
    inertia: FloatArray, C: FloatArray, G: FloatArray, balanced: FloatArray, slowed: IntArray
) -> FloatArray:
    """The matrix of the first-order form; stations without inertia condensed (`_slow_groups`)."""
    heavy = np.flatnonzero(inertia > 0)
    torques = np.eye(len(G))
    if len(balanced):
        basis, _ = np.linalg.qr(G @ balanced.T, mode="complete")
        torques = basis[:, len(balanced) :]
    root = 1 / np.sqrt(inertia[heavy])
    speed_speed = C[np.ix_(heavy, heavy)] * np.outer(root, root)
    torque_speed = torques.T @ G[:, heavy] * root
    matrix = np.block(
        [[-speed_speed, -torque_speed.T], [torque_speed, np.zeros((torques.shape[1],) * 2)]]
    )
    if len(slowed):
        coupled = C[np.ix_(slowed, heavy)] * root
        turned = G[:, slowed].T @ torques
        right = np.hstack([-coupled, -turned])
        left = np.vstack([-coupled.T, turned.T])
        matrix += left @ np.linalg.solve(C[np.ix_(slowed, slowed)], right)
    return matrix


def _slow_groups(
    inertia: FloatArray, ground: FloatArray, dampers: IntArray
) -> tuple[FloatArray, IntArray]:
    """Stations without inertia by what sets their speed, from the graph alone, in which the last one is the ground.

    `dampers` (2, dampers) are the stations that each damper joins.

    First (groups, stations) 1 where in a group that no damper ties to anything: its torques balance. Then the numbers
    of the others, and of all but one of each balanced group: dampers set their speed.
    """
    light = np.append(inertia[:-1] == 0, False)
    within = light[dampers].all(axis=0)
    group = connected(len(light), *dampers[:, within])
    free = np.setdiff1d(group[light], np.append(group[ground > 0], group[dampers[:, ~within]]))
    return (group[:-1] == free[:, None]).astype(float), np.setdiff1d(np.flatnonzero(light), free)


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
    root = _separate(start)
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
    _check_doubles(root, step, active)
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


def _separate(start: ComplexArray) -> ComplexArray:
    """Starts of which no two are equal, none is zero: equal ones are moved by some 1e-7 of themselves."""
    root = np.array(start, dtype=np.complex128)
    root[root == 0] = 1e-3 * np.abs(root[root != 0]).min() if root.any() else 1.0
    is_equal = np.abs(root[:, None] - root) <= 1e-9 * np.abs(root)
    copies = np.tril(is_equal, -1).sum(axis=1)
    root *= 1 + 1e-7 * copies * np.exp(0.7j * copies)
    return root


def _check_doubles(root: ComplexArray, step: ComplexArray, active: np.ndarray) -> None:
    """What has not settled must be a double root (a coupling damped just critically)."""
    for number in np.flatnonzero(active):
        gap = np.abs(np.delete(root, number) - root[number]).min(initial=np.inf)
        if not (
            abs(step[number]) <= DOUBLE * abs(root[number]) and gap <= DOUBLE * abs(root[number])
        ):
            raise SolveError(
                f"damped modes: no convergence in {SWEEPS} sweeps near {root[number]:.6g} rad/s; "
                "try undamped frequencies as start, or check the damping for misplaced powers of ten"
            )
