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
from torsion.kernels.modes.natural_modes import start_frequencies
from torsion.kernels.trees.elimination import EPS, Layout, SpanSides, eliminate, layout, spread
from torsion.kernels.trees.tree import Tree, connected, cut, rigidity
from torsion.sources import source

if TYPE_CHECKING:
    from torsion.kernels.stiffness_laws import SpringLaw

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
    far = np.array(FAR, dtype=complex)
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


def log_derivative(
    train: DampedTree, root: ComplexArray | FloatArray, lossy: float
) -> ComplexArray:
    """p'/p at each root, (roots,) s, of p = det(l^2 J + l C + K(1 + i eta)); `lossy` scales the loss factors.

    Leaf-to-root elimination and its derivative side by side; rigid spans merge, fixed stations take no part.
    """
    tree, plan, ground = train.tree, train.plan, train.ground[:, None]
    total = np.zeros(len(root), dtype=complex)
    inertial = tree.inertia[:, None] * root
    stiffness, slope = [*(ground * root + inertial * root)], [*(ground + 2 * inertial)]
    for station in range(plan.size - 1, -1, -1):
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
                if law.exponent is None:  # what p'/p lacks for the poles of k
                    total += sum(tau / (1.0 + root * tau) for _, tau in law.terms)
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
    root = np.array(start, dtype=complex)
    root[root == 0] = 1e-3 * np.abs(root[root != 0]).min() if root.any() else 1.0
    copies = np.tril(np.abs(root[:, None] - root) <= 1e-9 * np.abs(root), -1).sum(axis=1)
    root *= 1 + 1e-7 * copies * np.exp(0.7j * copies)
    active = np.ones(len(root), dtype=bool)
    step = np.full(len(root), np.inf, dtype=complex)
    for _ in range(SWEEPS):
        moving = np.flatnonzero(active)
        kept_away = np.append(root, root.conj()) if mirrored else root

        # To where p is 0 but at none of those kept away from.
        with np.errstate(all="ignore"):
            start_root = root[moving]
            slope = log_derivative(train, start_root, lossy)
            lost = ~np.isfinite(slope)
            if lost.any():  # exactly on a pole of the elimination: a few eps aside there is none
                slope[lost] = log_derivative(train, start_root[lost] * (1 + 8 * EPS), lossy)
            gap = start_root[:, None] - kept_away
            gap[gap == 0] = np.inf
            change = -1 / (slope - ((1 / gap).sum(axis=1) + zeros / start_root))
        change[np.isinf(slope)] = 0
        is_lost = ~np.isfinite(change)
        change[is_lost] = 0.01 * np.abs(start_root[is_lost])
        step[moving] = change
        root[moving] += change
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


OVERDAMPED = 1e-7  # |Im|/|root| of a critically damped pair in double precision: below it, roots count as real
REPEATED = 1e-11  # relative distance below which roots share a space of shapes
LOSS_STAGE = 0.1  # largest loss factor added at once in the continuation from none
NEWTON_REACH = 1e-9  # relative: Newton may polish a root, not leave it
NEWTON_STEPS = 3
LIGHT = 0.1  # |real part|/|root| up to which the real part from the energies is the better one
# Of the largest column: below it, the shapes of a repeated root are not independent.
UNRESOLVED = 1e-8
NEWTON_TOLERANCE = 1e-11  # relative step that a simple root must not exceed at the end


@dataclass(frozen=True)
class DampedTreeModes:
    """Oscillating modes by |eigenvalue| ascending; the largest angle of a shape is 1. Roots at 0 are not listed."""

    eigenvalue: ComplexArray  # (modes,) 1/s, upper half-plane
    real_root: FloatArray  # (roots,) 1/s, by modulus: overdamped motions, without the loss factors
    angle: ComplexArray  # (stations, modes) rad
    torque: ComplexArray  # (stations, modes) N m, of span i on station i, damper's share included


def damped_modes(
    tree: Tree,
    *,
    ground_damping: FloatArray | None = None,
    viscous: FloatArray | None = None,
    loss_factor: FloatArray | None = None,
    start: FloatArray | None = None,
    laws: "Mapping[int, SpringLaw] | None" = None,
) -> DampedTreeModes:
    """All oscillating modes and all real roots; with `start`, only the modes grown from those.

    ground_damping, viscous (N m s/rad), loss_factor: (stations,), default none. start: (modes,) rad/s, undamped
    circular frequencies above 0, enough for light damping (of the real roots only those met on the way are then
    listed). Loss factors act on oscillating modes alone. laws: of spans of some stations in place of stiffness and
    damping; a law of a power of s needs `start`.
    Raises SolveError if roots do not settle, ValueError for arrays that do not fit.
    """
    flexibility = np.where(tree.parent < 0, 0.0, tree.flexibility)
    tree = Tree(tree.parent, flexibility, tree.moving_inertia, tree.held)
    ground = per_station(tree, ground_damping, may_drive=True)
    across, loss = (per_station(tree, values) for values in (viscous, loss_factor))
    train = DampedTree(tree, ground, across, loss, laws or {})
    zeros, number = number_of_roots(train)
    if start is None:
        root = polish_together(train, rough_roots(train, number), zeros, lossy=0.0)
    else:
        rising = 1j * np.asarray(start, dtype=complex)
        if rising.ndim != 1 or not (rising.imag > 0).all():
            raise ValueError("start must be a list of circular frequencies above 0")
        root = polish_together(train, rising, zeros, lossy=0.0, mirrored=True)
    real = np.abs(root.imag) <= OVERDAMPED * np.abs(root)
    upper = (root.imag > 0) & ~real
    oscillating = int(np.count_nonzero(upper))
    if start is not None:
        lossy = np.where(root.imag > 0, root, root.conj())[~real]
        oscillating = len(lossy)
    elif 2 * oscillating + np.count_nonzero(real) == len(root):
        lossy = root[np.argsort(~upper, kind="stable")]
    else:
        raise SolveError(
            "damped modes: roots without a conjugate; try undamped frequencies as start"
        )

    # To the full loss factors by continuation from none.
    stages = int(np.ceil(train.loss_factor.max(initial=0.0) / LOSS_STAGE))
    for stage in range(1, stages + 1):
        lossy = polish_together(train, lossy, zeros, lossy=stage / stages)
    return _with_shapes(train, lossy[:oscillating], np.sort(root[real].real)[::-1])


def per_station(tree: Tree, values: FloatArray | None, *, may_drive: bool = False) -> FloatArray:
    """Damping (stations,), 0 where none is given; raises ValueError for values that do not fit.

    may_drive: negative values are taken, as of a load whose torque falls with speed.
    """
    result = np.zeros(tree.size) if values is None else np.asarray(values, dtype=float)
    if (
        result.shape != (tree.size,)
        or not (np.isfinite(result) & ((result >= 0) | may_drive)).all()
    ):
        raise ValueError(
            f"damping of shape {result.shape}; expected ({tree.size},) finite values, none negative"
        )
    return result


def _with_shapes(train: DampedTree, root: ComplexArray, real: FloatArray) -> DampedTreeModes:
    root = root[np.argsort(np.abs(root), kind="stable")]
    with np.errstate(all="ignore"):
        seen, root, angle, torque = _polished(train, root)
        first = connected(
            len(root), *np.nonzero(np.abs(root[:, None] - root) <= REPEATED * np.abs(root))
        )
        for group in (
            np.flatnonzero(first == representative) for representative in np.unique(first)
        ):
            if len(group) > 1:
                several = independent_shapes(train, complex(root[group].mean()), len(group))
                if several is not None:
                    angle[:, group], torque[:, group] = several

        # Of a light damping the real part is the small difference of large numbers, but not from the energies.
        light = np.abs(root.real) <= LIGHT * np.abs(root)
        root = np.where(light, decay(train, seen, root, angle, torque) + 0.0 + 1j * root.imag, root)
    largest = angle[np.argmax(np.abs(angle), axis=0), np.arange(len(root))]
    return DampedTreeModes(root, real, angle / largest, torque / largest)


def _polished(
    train: DampedTree, root: ComplexArray
) -> tuple[SpanSides, ComplexArray, ComplexArray, ComplexArray]:
    """Dynamic stiffness, roots, angles and torques after a few Newton steps, each of which must stay where it is."""
    distance = np.abs(root[:, None] - root)
    np.fill_diagonal(distance, np.inf)
    gap = distance.min(axis=1, initial=np.inf)
    repeated = gap <= REPEATED * np.abs(root)
    inertia = train.tree.moving_inertia[:, None]
    for _ in range(NEWTON_STEPS):
        # The station of least |Z|/J, where the mode is best seen, is turned by 1.
        seen = both_sides(train, root)
        ease = inertia / np.abs(seen.whole)
        ease[np.isnan(ease) & (inertia > 0)] = 0
        pushed = np.argmax(np.nan_to_num(ease, nan=0.0, posinf=np.inf), axis=0)
        angle, torque = spread(seen, pushed)

        # The slope is x' (dT/dl) x, in N m s/rad.
        wound = np.array(seen.compliance) * torque
        at_stations = train.ground[:, None] + 2 * root * train.tree.inertia[:, None]
        slope = (at_stations * angle * angle).sum(axis=0)
        slope += (train.viscous[:, None] * wound * wound).sum(axis=0)
        for station, law in train.laws.items():
            slope += law.at_root(root)[1] * wound[station] ** 2
        step = -seen.whole[pushed, np.arange(len(root))] / slope
        size = np.abs(step)
        root = np.where(
            (size <= NEWTON_REACH * np.abs(root)) & (repeated | (size <= 0.1 * gap)),
            root + step,
            root,
        )
        if (size <= 4 * EPS * np.abs(root)).all():
            break

    # A double root is no better than its distance to the other one.
    unsettled = ~(size <= np.maximum(NEWTON_TOLERANCE * np.abs(root), gap))
    if unsettled.any():
        raise SolveError(
            f"damped modes: the root near {root[unsettled][0]:.6g} rad/s is not settled; try other start values"
        )
    return seen, root, angle, torque


def both_sides(train: DampedTree, root: ComplexArray) -> SpanSides:
    """Dynamic stiffness l^2 J + l C + K(1 + i eta) of the train as every station sees it."""
    soft = train.tree.flexibility > 0
    station_stiffness = train.ground[:, None] * root + train.tree.inertia[:, None] * root * root
    hc = np.zeros((train.tree.size, len(root)), dtype=complex)
    stiffness = (1 + 1j * train.loss_factor[soft]) / train.tree.flexibility[soft]
    hc[soft] = 1 / (stiffness[:, None] + train.viscous[soft, None] * root)
    for station, law in train.laws.items():
        hc[station] = 1 / law.at_root(root)[0]
    return eliminate(train.plan, station_stiffness, hc, guard=True)


def independent_shapes(
    train: DampedTree, root: complex, count: int
) -> tuple[ComplexArray, ComplexArray] | None:
    """Angles and torques (stations, count) of a root that comes `count` times, orthogonal as J weighs them.

    The train is pushed at every station in turn; the best independent answers are kept. None if there are too few.
    """
    from scipy.linalg import qr, solve_triangular

    tree, size = train.tree, train.plan.size
    seen = both_sides(train, np.full(size, root))
    angle, torque = spread(seen, np.arange(size))
    weight = np.sqrt(tree.moving_inertia)
    receptance = np.diag(seen.whole)
    floor = EPS * np.abs(root * root) * tree.inertia
    push = weight / np.where(
        np.abs(receptance) <= floor, np.maximum(floor, np.finfo(float).tiny), receptance
    )
    sound = np.isfinite(push) & np.isfinite(angle).all(axis=0) & np.isfinite(torque).all(axis=0)
    angle, torque = (np.where(sound, part * push, 0) for part in (angle, torque))
    _, triangle, order = qr(weight[:, None] * angle, mode="economic", pivoting=True)
    triangle = triangle[:count, :count]
    if abs(triangle[-1, -1]) <= UNRESOLVED * abs(triangle[0, 0]):
        return None
    chosen = order[:count]
    return tuple(
        solve_triangular(triangle, part[:, chosen].T, trans="T").T for part in (angle, torque)
    )  # type: ignore[return-value]


def decay(
    train: DampedTree,
    seen: SpanSides,
    root: ComplexArray,
    shape: ComplexArray,
    torque: ComplexArray,
) -> FloatArray:
    """Real part of each root, (roots,) 1/s, to full relative accuracy however small: x* T(l) x = 0 is a quadratic.

    l^2 m + l c + k(1 + i eta) = 0 with m, c, k sums of positive terms gives Re l = -(c + sum k eta |.|^2/Im l)/(2m).
    """
    wound = np.abs(np.array(seen.compliance) * torque) ** 2
    inertia = (train.tree.inertia[:, None] * np.abs(shape) ** 2).sum(axis=0)
    lost = (train.ground[:, None] * np.abs(shape) ** 2).sum(axis=0) + (
        train.viscous[:, None] * wound
    ).sum(axis=0)
    loss = np.where(train.loss_factor > 0, train.loss_factor, 0.0)
    stiffness = np.divide(
        loss, train.tree.flexibility, out=np.zeros_like(loss), where=train.tree.flexibility > 0
    )
    lost = lost + (stiffness[:, None] * wound).sum(axis=0) / root.imag
    for station, law in train.laws.items():
        lost = lost + law.at_root(root)[0].imag * wound[station] / root.imag
    real: FloatArray = -lost / (2 * inertia)
    return real
