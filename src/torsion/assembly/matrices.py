"""Inertia, stiffness and damping of a train in full, as a view for export; no analysis computes with them."""

from dataclasses import dataclass

import numpy as np

from torsion.assembly.system import System
from torsion.kernels.tree import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class Matrices:
    """J q'' + C q' + (K + i H) q = basis' T over the free angles q, each referred to the reference speed.

    Rigid spans and gears are condensed: stations that turn together share one free angle. Held stations have none.
    """

    inertia: FloatArray  # (free, free) kg m2
    stiffness: FloatArray  # (free, free) N m/rad
    damping: FloatArray  # (free, free) N m s/rad
    loss: FloatArray  # (free, free) N m/rad: stiffness times loss factor of every span
    basis: FloatArray  # (stations, free): angle of each station at own speed = basis @ q
    names: tuple[str, ...]  # (free,) the first station of each free angle
    stations: tuple[str, ...]  # (stations,)


def matrices(system: System, *, ground_damping: FloatArray | None = None) -> Matrices:
    """The matrices of a system; `ground_damping` (stations,) N m s/rad, default the part that does not depend on speed.

    Their stiffness is a sum of stiffnesses, and so loses the soft springs beside a stiff one; that is why this is a
    view and not what the analyses use.
    """
    group = _joined(system)
    fixed = np.isin(group, group[system.held])
    free = np.unique(group[~fixed])
    basis = np.where((group[:, None] == free) & ~fixed[:, None], system.speed_ratio[:, None], 0.0)
    inertia = np.where(system.held, 0.0, system.inertia)
    ground = _constant_damping(system) if ground_damping is None else ground_damping
    across = _twist(system, basis)
    springs = (system.flexibility > 0) & np.isfinite(system.flexibility)
    stiffness = np.divide(1.0, system.flexibility, out=np.zeros(len(system.spans)), where=springs)
    return Matrices(
        inertia=(basis.T * inertia) @ basis,
        stiffness=(across.T * stiffness) @ across,
        damping=(across.T * system.viscous) @ across + (basis.T * ground) @ basis,
        loss=(across.T * (stiffness * system.loss_factor)) @ across,
        basis=basis,
        names=tuple(system.stations[int(np.flatnonzero(group == one)[0])].name for one in free),
        stations=tuple(station.name for station in system.stations),
    )


def _constant_damping(system: System) -> FloatArray:
    """(stations,) N m s/rad to ground at own speed, without what follows from speed or mean torque."""
    damping = np.zeros(len(system.stations))
    for damper in system.dampers:
        damping[damper.station] += damper.constant
    return damping


def _twist(system: System, basis: FloatArray) -> FloatArray:
    """(spans, free) twist of each span at its driving station's speed: driving - driven angle / ratio."""
    referred = basis / system.speed_ratio[:, None]
    return np.asarray((referred[system.driving] - referred[system.driven]) * system.span_ratio[:, None])


def _joined(system: System) -> IntArray:
    """(stations,) number of the stations that turn together, in the order of the first of each."""
    rigid: BoolArray = system.flexibility == 0
    group = np.arange(len(system.stations))
    for a, b in zip(system.driving[rigid].tolist(), system.driven[rigid].tolist(), strict=True):
        low, high = sorted((int(group[a]), int(group[b])))
        group[group == high] = low
    return group
