"""How far one figure moves a damped mode: derivatives of its root, by products of its shape and torques."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.damping.damped_roots import DampedTree
from torsion.kernels.damping.damped_tree_modes import (
    DampedTreeModes,
    both_sides,
    per_station,
    slope_at,
)
from torsion.kernels.tree import Tree

if TYPE_CHECKING:
    from torsion.kernels.spring_law import SpringLaw


@dataclass(frozen=True)
class RootSensitivity:
    """Derivatives of the root of each mode, 1/s; of a repeated root they do not exist."""

    compliance: ComplexArray  # (stations, modes) by the complex compliance of span i, rad/(N m), at the root; 0 at a root
    inertia: ComplexArray  # (stations, modes) by the inertia, kg m2
    ground_damping: ComplexArray  # (stations, modes) by the damper to ground, N m s/rad


def root_sensitivity(
    tree: Tree,
    modes: DampedTreeModes,
    *,
    ground_damping: FloatArray | None = None,
    viscous: FloatArray | None = None,
    loss_factor: FloatArray | None = None,
    laws: "Mapping[int, SpringLaw] | None" = None,
) -> RootSensitivity:
    """Of the modes that `damped_modes` found with the same damping; `compliance_slopes` leads on to k, eta and c.

    With unconjugated squares dl = -x'(dT)x/(x' (dT/dl) x): no left shape is needed, as the train is reciprocal
    (Lancaster 1964).

    >>> from torsion.kernels.damping.damped_tree_modes import damped_modes
    >>> one = Tree(np.array([-1, 0]), np.array([0.0, 1e-4]), np.ones(2), np.array([True, False]))
    >>> damper = np.array([0.0, 2.0])  # l = -1 + i sqrt(1e4 - 1)
    >>> found = root_sensitivity(one, damped_modes(one, ground_damping=damper), ground_damping=damper)
    >>> found.ground_damping[1].round(9)  # -1/2 - i c/(4 sqrt(k - c^2/4))
    array([-0.5-0.00500025j])
    """
    flexibility = np.where(tree.parent < 0, 0.0, tree.flexibility)
    tree = Tree(tree.parent, flexibility, tree.moving_inertia, tree.held)
    ground = per_station(tree, ground_damping, may_drive=True)
    across, loss = (per_station(tree, values) for values in (viscous, loss_factor))
    train, root = DampedTree(tree, ground, across, loss, laws or {}), modes.eigenvalue
    with np.errstate(all="ignore"):
        seen = both_sides(train, root)
    over = 1.0 / slope_at(train, seen, root, modes.angle, modes.torque)
    motion = modes.angle**2 * over
    return RootSensitivity(modes.torque**2 * over, -(root**2) * motion, -root * motion)
