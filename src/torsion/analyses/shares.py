"""Where the energy of a mode sits, and where its shape changes its sign."""

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System

STANDS_STILL = 1e-12  # of the largest amplitude (referred to one speed); a smaller one is rounding and has no sign
LARGEST_BLOCK = 2**20  # stations times modes at once; 8 MB an array


def lumped_kinetic(system: System, shape: FloatArray) -> FloatArray:
    """(stations, modes) twice the kinetic energy / w^2 of what is lumped at each station; shape at own speed."""
    energy = np.square(shape)
    energy *= np.where(system.held, 0.0, system.lumped_inertia)[:, None]
    return energy


def lumped_elastic(system: System, torque: FloatArray) -> FloatArray:
    """(spans, modes) twice the elastic energy of the spans that store any."""
    energy = np.square(torque)
    energy *= np.where(is_elastic(system), system.flexibility, 0.0)[:, None]
    return energy


def shares(energy: FloatArray) -> FloatArray:
    """What each one has of the sum over all, (all, modes), in the place of `energy`."""
    energy /= energy.sum(axis=0)
    return energy


def is_elastic(system: System) -> BoolArray:
    """(spans,) spans that store energy: neither rigid nor without stiffness."""
    return np.asarray((system.flexibility > 0) & np.isfinite(system.flexibility))


def nodes(system: System, shape: FloatArray) -> IntArray:
    """(modes,) spans over which the shape (stations, modes), rad at own speed, changes its sign.

    A station that stands still takes the sign of the station inward of it, so that a node at a station counts once.
    A held station has no sign: the shape starts there and does not cross it.
    """
    block, number = max(1, LARGEST_BLOCK // max(system.folded.tree.size, 1)), shape.shape[1]
    counted = [_nodes(system, shape[:, first : first + block]) for first in range(0, number, block)]
    return np.concatenate([np.empty(0, dtype=np.int64), *counted])


def _nodes(system: System, shape: FloatArray) -> IntArray:
    tree, stations = system.folded.tree, np.arange(system.folded.tree.size)[:, None]
    angle = np.zeros((tree.size, shape.shape[1]))
    angle[system.folded.node] = shape / system.speed_ratio[:, None]
    size = np.abs(angle)
    sign = np.sign(angle).astype(np.int8)
    sign[size <= STANDS_STILL * size.max(axis=0, initial=0.0)] = 0
    sign[tree.held] = 0
    still = (sign == 0) & ~tree.held[:, None]
    if still.any():
        begins = still & (tree.parent < 0)[:, None]
        sign[begins] = 1
        moving = np.where(still & ~begins, tree.parent[:, None], stations)
        while not np.array_equal(beyond := np.take_along_axis(moving, moving, axis=0), moving):
            moving = beyond
        sign = np.take_along_axis(sign, moving, axis=0)
    joined = (tree.parent >= 0) & np.isfinite(tree.flexibility)
    crosses: IntArray = np.count_nonzero((sign * sign[tree.parent] < 0) & joined[:, None], axis=0)
    return crosses
