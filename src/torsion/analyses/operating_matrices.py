"""The matrices of a train at its operating point, for export."""

from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.matrices import Matrices, matrices
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.study import Study


@dataclass(frozen=True)
class OperatingMatrices:
    """Matrices with all damping, that of propellers at the speed and the mean torque told."""

    view: Matrices
    speed: float  # rad/s of the reference station: rated, else the highest; NaN where the file gives none
    mean_torque: FloatArray  # (stations,) N m applied at own speed; NaN where the file does not say it


def operating_matrices(study: Study, system: System) -> OperatingMatrices:
    """J, K, C and H at the speed at which damped modes are told.

    Raises InputError where a damping follows from a speed or a mean torque that the file does not give, and for the
    exact model, which has no matrices.
    """
    speed = study.operation.speed
    following = [d for d in system.dampers if d.torque_factor or d.speed_factor]
    if following and not speed:
        name = system.stations[following[0].station].name
        message = f"the damping of '{name}' follows from the speed, and so do the matrices; none is given"
        raise InputError([Fault(("operation",), message, "`operation: {rated: {speed: 1500 rpm, power: 100 kW}}`")])
    grid = np.array([speed or 0.0])
    steady = steady_if_known(study, system, grid) if speed else None
    ground = ground_damping(system, grid, steady)[:, 0]
    mean = np.full(len(system.stations), np.nan) if steady is None else steady.applied[:, 0]
    return OperatingMatrices(matrices(system, ground_damping=ground), speed or np.nan, mean)
