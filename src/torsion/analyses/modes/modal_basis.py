"""A train in its modes: rigid motions, and what modes alone do not say of spans and stations."""

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.spanning_forest import connected


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
