"""Damped modes of a tree: complex roots of det(l^2 J + l C + K(1 + i eta)), their shapes and torques.

Shapes and torques follow from the dynamic stiffness of both sides of every span, by products along the train.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.damping.damped_roots import (
    DampedTree,
    number_of_roots,
    polish_together,
    rough_roots,
)
from torsion.kernels.elimination import EPS, SpanSides, eliminate, spread
from torsion.kernels.spanning_forest import connected
from torsion.kernels.tree import Tree

if TYPE_CHECKING:
    from torsion.kernels.spring_law import SpringLaw

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
        rising = 1j * np.asarray(start, dtype=np.complex128)
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
    result = np.zeros(tree.size) if values is None else np.asarray(values, dtype=np.float64)
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
    inertia = np.where(train.tree.held, 0.0, train.tree.inertia)[:, None]
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
    hc = np.zeros((train.tree.size, len(root)), dtype=np.complex128)
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
    weight = np.sqrt(np.where(tree.held, 0.0, tree.inertia))
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
