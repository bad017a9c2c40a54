"""A train in its modes: rigid motions, and what modes alone do not say of spans and stations."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.reduction import rigidity
from torsion.kernels.sturm import SHARE_OF_LIMIT, brackets, count_below
from torsion.kernels.tree import Tree, connected


def rigid_shapes(system: System) -> FloatArray:
    """Return the rigid motions (stations, motions) rad at own speed, generalised inertia 1.

    That of the whole train comes first, where nothing holds it; then those of parts that turn against each other.
    Raises SolveError for such a part without inertia.
    """
    ratio = system.speed_ratio
    finite = np.isfinite(system.flexibility)
    part = connected(len(ratio), system.driving[finite], system.driven[finite])
    loose = np.setdiff1d(part, part[system.held])
    shapes = np.where(part[:, None] == loose, ratio[:, None], 0.0)
    if not system.held.any():
        shapes[:, 0] = ratio
    if not loose.size:
        return shapes
    upper = np.linalg.qr(np.sqrt(np.where(system.held, 0.0, system.inertia))[:, None] * shapes).R
    if not np.diag(upper).all():
        raise SolveError("a part of the train turns freely and has no inertia", "give it one")
    return np.linalg.solve((upper * np.sign(np.diag(upper))[:, None]).T, shapes.T).T


def massless(system: System) -> BoolArray:
    """Return (stations,) where nothing that is rigidly joined to the station has an inertia."""
    rigid = system.flexibility == 0.0
    group = connected(len(system.stations), system.driving[rigid], system.driven[rigid])
    total = np.zeros(len(group))
    np.add.at(total, group, system.inertia)
    return np.asarray(total[group] == 0.0)


def beside_modes(system: System) -> tuple[BoolArray, BoolArray]:
    """Return stations and spans whose angle, and torque, under torques on the train is not a sum over the modes alone."""
    without = massless(system)
    return without, (system.flexibility == 0.0) | without[system.driving] | without[system.driven]


JUST_ABOVE = 1e-3  # relative
# Unknowns of finite elements that are solved at once where counts cannot reach.
LARGEST_DENSE = 2000
ABOVE = 1.0 + 1e-9  # a mode at the highest frequency itself is one of those up to it


@dataclass(frozen=True)
class Reach:
    """The elastic modes up to a frequency."""

    count: int
    frequency: float  # rad/s


def reach(tree: Tree, highest: float = math.inf) -> Reach:
    """Return the elastic modes of the undamped `tree` up to `highest` (rad/s), as far as its distributed shafts resolve them.

    Linear elements have no unknowns inside, and resolve all the modes that they have.
    """
    motions = rigidity(tree.static)
    # The angular frequency from which counts would need a correction.
    limit = math.inf if tree.shafts is None else tree.shafts.limit
    top = min(highest * ABOVE, SHARE_OF_LIMIT * limit)
    if not math.isfinite(top):
        return Reach(motions.elastic, math.inf)
    return Reach(int(count_below(tree, np.array([top]))[0]) - len(motions.free_roots), top)


def above_mode(tree: Tree, count: int) -> float:
    """Return a frequency (rad/s) just above the elastic mode `count` (counted from 1), which lies in reach."""
    rigid = len(rigidity(tree.static).free_roots)
    return float(brackets(tree, np.array([rigid + count - 1]), tolerance=JUST_ABOVE)[1][0])


def referred_modes(tree: Tree, count: int | None) -> TreeModes:
    """Return the lowest `count` elastic modes on the undamped tree; None: all that the distributed shafts resolve.

    Where finite elements are too few for the counts the modes are those of the dense problem, without certificate.
    Raises SolveError where the pieces of a continuum are too long.
    """
    resolved = reach(tree)
    if count is not None and count > resolved.count and math.isfinite(resolved.frequency):
        from torsion.kernels.distributed.finite_elements import CondensedElements, dense_modes

        # Angles and unknowns inside of finite elements; infinite for a continuum.
        laws = () if tree.shafts is None else tree.shafts.laws
        inner = (law.modes.size if isinstance(law, CondensedElements) else math.inf for law in laws)
        if tree.size + sum(inner) <= LARGEST_DENSE:
            return dense_modes(tree, count)
    return tree_modes(tree, resolved.count if count is None else count)
