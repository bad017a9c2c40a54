"""Damped modes of a tree: complex roots of det(l^2 J + l C + K(1 + i eta)), their shapes and torques."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.damping.damped_roots import DampedTree, first_order_eigenvalues, number_of_roots, polish_together
from torsion.kernels.damping.damped_shapes import (
    BothSides,
    both_sides,
    decay,
    independent_shapes,
    most_active,
    newton_step,
    shapes_from,
)
from torsion.kernels.spanning_forest import connected
from torsion.kernels.sweeps import EPS
from torsion.kernels.tree import Tree

LARGEST_FIRST_ORDER = 300  # stations: the dense start costs their cube
OVERDAMPED = 1e-7  # |Im|/|root| of a critically damped pair in double precision: below it, roots count as real
REPEATED = 1e-11  # relative distance below which roots share a space of shapes
LOSS_STAGE = 0.1  # largest loss factor added at once in the continuation from none
NEWTON_REACH = 1e-9  # relative: Newton may polish a root, not leave it
NEWTON_STEPS = 3
LIGHT = 0.1  # |real part|/|root| up to which the real part from the energies is the better one
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
) -> DampedTreeModes:
    """All oscillating modes and all real roots; with `start`, only the modes grown from those.

    ground_damping, viscous (N m s/rad), loss_factor: (stations,), default none. start: (modes,) rad/s, undamped
    circular frequencies above 0; needed from 300 movable stations on, and enough for light damping at any size (of
    the real roots only those met on the way are then listed). Loss factors act on oscillating modes alone.
    Raises SolveError if roots do not settle, ValueError for arrays that do not fit.
    """
    flexibility = np.where(tree.parent < 0, 0.0, tree.flexibility)
    tree = Tree(tree.parent, flexibility, tree.moving_inertia, tree.held)
    damping = (_per_station(tree, values) for values in (ground_damping, viscous, loss_factor))
    train = DampedTree(tree, *damping)
    zeros, others = number_of_roots(train)
    if start is None:
        upper, real = _all_roots(train, zeros, others)
    else:
        upper, real = _roots_from(train, zeros, np.asarray(start, dtype=np.float64))
    return _with_shapes(train, upper, np.sort(real)[::-1])


def _per_station(tree: Tree, values: FloatArray | None) -> FloatArray:
    result = np.zeros(tree.size) if values is None else np.asarray(values, dtype=np.float64)
    if result.shape != (tree.size,) or not (np.isfinite(result) & (result >= 0)).all():
        raise ValueError(f"damping of shape {result.shape}; expected ({tree.size},) finite values, none negative")
    return result


def _all_roots(train: DampedTree, zeros: int, others: int) -> tuple[ComplexArray, FloatArray]:
    movable = int(np.count_nonzero(~np.array(train.plan.prescribed)))
    if movable > LARGEST_FIRST_ORDER:
        raise SolveError(
            f"damped modes: {movable} movable stations, expected at most {LARGEST_FIRST_ORDER}; "
            "give undamped frequencies as start"
        )
    rough: ComplexArray = first_order_eigenvalues(train).astype(np.complex128)
    rough = rough[np.argsort(np.abs(rough))[len(rough) - others :]]
    root = polish_together(train, rough, zeros, lossy=0.0)
    real = np.abs(root.imag) <= OVERDAMPED * np.abs(root)
    upper = (root.imag > 0) & ~real
    if 2 * np.count_nonzero(upper) + np.count_nonzero(real) != len(root):
        raise SolveError("damped modes: roots without a conjugate; try undamped frequencies as start")
    lossy = _with_loss(train, root[np.argsort(~upper, kind="stable")], zeros)
    return lossy[: np.count_nonzero(upper)], root[real].real


def _roots_from(train: DampedTree, zeros: int, start: FloatArray) -> tuple[ComplexArray, FloatArray]:
    if start.ndim != 1 or not (start > 0).all():
        raise ValueError("start must be a list of circular frequencies above 0")
    rising: ComplexArray = (1j * start).astype(np.complex128)
    root = polish_together(train, rising, zeros, lossy=0.0, mirrored=True)
    real = np.abs(root.imag) <= OVERDAMPED * np.abs(root)
    upper = np.where(root.imag > 0, root, root.conj())[~real]
    return _with_loss(train, upper, zeros), root[real].real


def _with_loss(train: DampedTree, root: ComplexArray, zeros: int) -> ComplexArray:
    """Roots at the full loss factors, by continuation from none."""
    stages = int(np.ceil(train.loss_factor.max(initial=0.0) / LOSS_STAGE))
    for stage in range(1, stages + 1):
        root = polish_together(train, root, zeros, lossy=stage / stages)
    return root


def _with_shapes(train: DampedTree, root: ComplexArray, real: FloatArray) -> DampedTreeModes:
    root = root[np.argsort(np.abs(root), kind="stable")]
    with np.errstate(all="ignore"):
        at, root, angle, torque = _polished(train, root)
        first = connected(len(root), *np.nonzero(np.abs(root[:, None] - root) <= REPEATED * np.abs(root)))
        for group in (np.flatnonzero(first == one) for one in np.unique(first)):
            if len(group) > 1:
                several = independent_shapes(train, complex(root[group].mean()), len(group))
                if several is not None:
                    angle[:, group], torque[:, group] = several
        light = np.abs(root.real) <= LIGHT * np.abs(root)
        root = np.where(light, decay(train, at, root, angle, torque) + 0.0 + 1j * root.imag, root)
    largest = angle[np.argmax(np.abs(angle), axis=0), np.arange(len(root))]
    return DampedTreeModes(root, real, angle / largest, torque / largest)


def _polished(train: DampedTree, root: ComplexArray) -> tuple[BothSides, ComplexArray, ComplexArray, ComplexArray]:
    """Dynamic stiffness, roots, angles and torques after a few Newton steps, each of which must stay where it is."""
    apart = np.abs(root[:, None] - root)
    np.fill_diagonal(apart, np.inf)
    gap = apart.min(axis=1, initial=np.inf)
    repeated = gap <= REPEATED * np.abs(root)
    for _ in range(NEWTON_STEPS):
        at = both_sides(train, root)
        pushed = most_active(train.tree, at.whole)
        angle, torque = shapes_from(train.plan, at, pushed)
        step = newton_step(train, at, root, pushed, angle, torque)
        size = np.abs(step)
        root = np.where((size <= NEWTON_REACH * np.abs(root)) & (repeated | (size <= 0.1 * gap)), root + step, root)
        if (size <= 4 * EPS * np.abs(root)).all():
            break
    unsettled = ~(size <= np.maximum(NEWTON_TOLERANCE * np.abs(root), gap))
    if unsettled.any():
        raise SolveError(
            f"damped modes: the root near {root[unsettled][0]:.6g} rad/s is not settled; try other start values"
        )
    return at, root, angle, torque
