"""How far a model is from the reference: relative errors of frequencies, of mode shapes and of response torques."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.sources import source

TOGETHER = 1e-6  # relative; modes nearer to each other than that are one, and any mixture of their shapes is right
NEGLIGIBLE = 1e-9  # of the largest torque of a harmonic: torques that stay below are rounding and are not compared


def relative_errors(
    values: Sequence[float] | FloatArray, reference: Sequence[Any] | FloatArray
) -> FloatArray:
    """Return (values,) signed errors over the reference; infinite for values that are missing at the end.

    The difference is taken in the numbers of the reference, which may have more digits than double precision.
    """
    exact = np.asarray(reference)
    error = np.full(len(reference), np.inf)
    count = min(len(exact), len(values))
    error[:count] = (np.asarray(values, dtype=float)[:count] - exact[:count]) / exact[:count]
    return error


def shape_weights(system: System) -> FloatArray:
    """Return (own stations,) kg m2 at own speed: inertias, and at either end of a shaft the half next to it.

    The same for every model of a train: the stations between the pieces of shafts are left out.
    """
    own_stations = len(system.train.stations)
    weight = np.zeros(own_stations)
    for lump in system.train.inertias:
        weight[lump.station] += lump.inertia
    for bar in system.train.bars:
        weight[[bar.driving, bar.driven]] += bar_segments(bar, 1)[1]
    weight[system.held[:own_stations]] = 0.0
    return weight


@source("AllemangBrown1982")
def shape_errors(
    shape: FloatArray, exact: FloatArray, frequency: FloatArray, weight: FloatArray
) -> FloatArray:
    """Return (modes,) 1 - MAC of every shape (stations, modes) against the exact one of the same number.

    exact: (stations, at least as many modes) with their `frequency`; weight: (stations,) inertias. MAC is the modal
    assurance criterion (Allemang & Brown 1982) weighted by inertia: the squared cosine of the angle between two shapes
    or, where exact frequencies are the same, between a shape and the space of theirs. It is found as the rest outside
    of that space, so that nothing cancels. NaN where no station of any inertia moves.
    """
    root = np.sqrt(weight)[:, None]
    ours = shape * root
    theirs = exact * root
    errors = np.full(shape.shape[1], np.nan)
    for mode in range(shape.shape[1]):
        close = np.abs(frequency - frequency[mode]) <= TOGETHER * frequency[mode]
        size = float(np.linalg.norm(ours[:, mode]))
        space = _space(theirs[:, close])
        if size == 0 or space.shape[1] == 0:
            continue
        vector = ours[:, mode] / size
        remainder = vector - space @ (space.T @ vector)
        errors[mode] = min(float(remainder @ remainder), 1.0)
    return errors


def _space(columns: FloatArray) -> FloatArray:
    """Return (rows, rank) orthonormal columns that span the same space."""
    size = np.linalg.norm(columns, axis=0)
    moving: FloatArray = columns[:, size > 0] / size[size > 0]
    if moving.shape[1] == 0:
        return moving
    u, singular, _ = np.linalg.svd(moving, full_matrices=False)
    return u[:, singular > max(moving.shape) * np.finfo(float).eps * singular[0]]


def over_largest(torque: ComplexArray, exact: ComplexArray) -> FloatArray:
    """Return (speeds,) largest error of any torque (speeds, ends) over the largest exact torque at that speed.

    NaN where there is no torque.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        size = np.abs(exact).max(axis=1, initial=0.0)
        return np.where(size > 0, np.abs(torque - exact).max(axis=1, initial=0.0) / size, np.nan)


def over_peaks(exact: Sequence[ComplexArray], torques: Sequence[ComplexArray]) -> tuple[float, ...]:
    """Return for every harmonic the largest error of a torque (speeds, ends) over its peak of all speeds.

    NaN in what was found makes it infinite.
    """
    errors = []
    for exact_torque, torque in zip(exact, torques, strict=True):
        peak = np.abs(exact_torque).max(axis=0)
        compared = peak > NEGLIGIBLE * peak.max()
        share = np.abs(torque - exact_torque)[:, compared] / peak[compared]
        share[~np.isfinite(torque[:, compared])] = np.inf
        errors.append(float(share.max(initial=0.0)))
    return tuple(errors)
