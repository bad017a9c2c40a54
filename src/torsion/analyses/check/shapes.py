"""How far a mode shape is from those of the exact model: what is left of it outside of them."""

import numpy as np

from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.kernels.tree import FloatArray

TOGETHER = 1e-6  # relative; modes nearer to each other than that are one, and any mixture of their shapes is right


def shape_weights(system: System) -> FloatArray:
    """(own stations,) kg m2 at own speed: the train's inertias and, at either end of a shaft, the half next to it.

    The same for every model of a train: the stations between the pieces of shafts are left out.
    """
    own = len(system.train.stations)
    weight = np.zeros(own)
    for lump in system.train.inertias:
        weight[lump.station] += lump.inertia
    for bar in system.train.bars:
        weight[[bar.driving, bar.driven]] += bar_segments(bar, 1)[1]
    weight[system.held[:own]] = 0.0
    return weight


def shape_errors(shape: FloatArray, exact: FloatArray, frequency: FloatArray, weight: FloatArray) -> FloatArray:
    """(modes,) 1 - MAC of every shape (stations, modes) against the exact one of the same number.

    exact: (stations, at least as many modes) with their `frequency`; weight: (stations,) inertias. MAC is the modal
    assurance criterion (Allemang & Brown 1982) weighted by inertia: the squared cosine of the angle between two shapes
    or, where exact frequencies are the same, between a shape and the space of theirs. It is found as the rest outside
    of that space, so that nothing cancels. NaN where no station of any inertia moves.
    """
    root = np.sqrt(weight)[:, None]
    ours, theirs = shape * root, exact * root
    errors = np.full(shape.shape[1], np.nan)
    for mode in range(shape.shape[1]):
        beside = np.abs(frequency - frequency[mode]) <= TOGETHER * frequency[mode]
        size, space = float(np.linalg.norm(ours[:, mode])), _space(theirs[:, beside])
        if size == 0 or space.shape[1] == 0:
            continue
        vector = ours[:, mode] / size
        rest = vector - space @ (space.T @ vector)
        errors[mode] = min(float(rest @ rest), 1.0)
    return errors


def _space(columns: FloatArray) -> FloatArray:
    """(rows, rank) orthonormal columns that span the same space."""
    size = np.linalg.norm(columns, axis=0)
    moving: FloatArray = columns[:, size > 0] / size[size > 0]
    if moving.shape[1] == 0:
        return moving
    u, singular, _ = np.linalg.svd(moving, full_matrices=False)
    return np.asarray(u[:, singular > max(moving.shape) * np.finfo(float).eps * singular[0]])
