"""Secondary couples on a shaft at its joints, by order of its speed, all shafts of the line turning as rigid bodies."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from torsion.analyses.joints.couples import couples_found
from torsion.analyses.joints.line import Behind, Placed, motions
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.lateral.line import BendingShaft

SAMPLES = 512  # of a turn; the orders of a joint of 70 degrees fall below rounding before the half of it
Carrier = Literal["driving", "driven"]


def orders(every: Sequence[Placed], shaft: BendingShaft) -> tuple[int, ...]:
    """0, and the orders of all joints up to this shaft and at its end."""
    found = {0}
    for at in shaft.joints:
        position: int | None = next(k for k, place in enumerate(every) if place.part == at.part)
        while position is not None:
            found.add(every[position].joint.order)
            position = every[position].before
    return tuple(sorted(found))


def couples_at(
    every: Sequence[Placed], shaft: BendingShaft, torque: FloatArray, carrier: Carrier = "driving"
) -> dict[int, ComplexArray]:
    """By order: (speeds, points, 2) N m, amplitudes about y and z of Re[C exp(i order x)], x the first shaft's angle.

    torque: (joints of `every`, speeds) N m, mean, constant on the first shaft of the line (carrier driving) or on the
    last. y is the normal of the plane of the joint before the shaft, else of the one behind it.
    """
    turned = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    moved = motions(every, turned)
    result = {
        order: np.zeros((torque.shape[1], len(shaft.beam.points), 2), dtype=np.complex128)
        for order in orders(every, shaft)
    }
    for at in shaft.joints:
        position = next(k for k, place in enumerate(every) if place.part == at.part)
        place = every[position]
        pair, _ = couples_found(place, moved[position].yoke, 1.0, "driving", None)
        couple = pair[0] if at.shaft == "driving" else pair[1]
        curve = (couple.normal + 1j * couple.inplane) * _carried(every, position, moved, carrier)
        if at is not shaft.joints[0] and at.shaft == "driving":
            curve = curve * np.exp(1j * place.joint.plane)
        for order, amplitude in result.items():
            turn = (1.0 if order == 0 else 2.0) / SAMPLES * np.exp(-1j * order * turned)
            pair_of_planes = np.array([curve.real @ turn, curve.imag @ turn])
            amplitude[:, at.point] += torque[position][:, None] * pair_of_planes
    return result


def _carried(every: Sequence[Placed], position: int, moved: Sequence[Behind], carrier: Carrier) -> FloatArray:
    """(angles,) torque in the driving shaft of a joint over the constant one."""
    before = every[position].before
    speed = np.ones(SAMPLES) if before is None else moved[before].speed
    if carrier == "driving":
        return np.asarray(1.0 / speed)
    last = position
    while following := [k for k, place in enumerate(every) if place.before == last]:
        last = following[0]
    return np.asarray(moved[last].speed / speed)
