"""The torques of the cylinders of a throw, of gas and masses, as they follow its angle and speed."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import Steady, steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.motion.cylinder_torques import (
    OrdersByAngle,
    quadratics,
    without_equal_parts,
)
from torsion.primitives import Torque
from torsion.study import Study

PARTS = 64  # of a load by tables, between whose rows the harmonics are no polynomials of the speed
LOWEST = 0.02  # of the highest speed: down to it a load that is no polynomial of the speed is followed by parts


def cylinder_law(
    study: Study, system: System, interface: int, torques: Sequence[Torque], staying: Steady | None
) -> OrdersByAngle:
    """Of the torques of one station; beyond the speeds of tables their first and last parts go on.

    staying: mean torques that do not change with the speed, in place of those of the laws of load.
    """
    ratio = abs(float(system.speed_ratio[torques[0].station]))
    edges = _edges(study, torques, ratio)
    speed = np.stack([edges[:-1], (edges[:-1] + edges[1:]) / 2.0, edges[1:]], axis=1).ravel()
    known = (
        steady_if_known(study, system, speed / ratio)
        if staying is None
        else _repeated(staying, len(speed))
    )
    values = np.stack([amplitude(system, one, speed / ratio, known) for one in torques], axis=-1)
    edges, polynomial = without_equal_parts(
        edges, quadratics(edges, values.reshape(-1, 3, len(torques)))
    )
    order = np.array([float(one.order or 0) for one in torques])
    return OrdersByAngle(interface, order, edges[1:-1], polynomial, float(edges[-1]))


def _repeated(mean: Steady, speeds: int) -> Steady:
    """The mean torques of one speed at so many."""
    return replace(mean, applied=np.repeat(mean.applied, speeds, axis=1))


def _edges(study: Study, torques: Sequence[Torque], ratio: float) -> FloatArray:
    """(parts + 1,) rad/s of the own shaft, between which every amplitude is a polynomial of the speed."""
    operation = study.operation
    highest = (operation.speed or math.pi) * ratio
    ends = {0.5 * highest, highest}
    several = False
    for law in {
        id(one.cylinder.gas): one.cylinder.gas for one in torques if one.cylinder is not None
    }.values():
        if law is not None and law.over == "speed":
            ends = set(law.at.tolist())
        several |= law is not None and law.over == "load" and len(law.at) > 2
    ends = with_corners_of_loads(study, ends, ratio)
    if several:
        ends |= set(np.linspace(min(ends), max(ends), PARTS + 1).tolist())
    return np.array(sorted(ends))


def with_corners_of_loads(study: Study, ends: set[float], ratio: float) -> set[float]:
    """Return ends of parts (rad/s of the own shaft) between which mean torques are polynomials of the speed.

    Where a table ends the parts end too; a law of another power is followed by many parts.
    """
    if not study.has_mean_torque:
        return ends
    balance = power_balance(study.train, study.operation)
    if tables := [load.law.table for load in balance.loads if load.law.table]:
        first, last = (
            max(table[0][0] for table in tables) * ratio,
            min(table[-1][0] for table in tables) * ratio,
        )
        ends = {
            end
            for end in ends | {corner * ratio for corner in balance.corners}
            if first <= end <= last
        }
    if not balance.is_polynomial:
        lowest = min(ends) if tables else LOWEST * max(ends)
        ends |= set(np.geomspace(lowest, max(ends), PARTS + 1).tolist()[:-1])
    return ends
