"""Secondary couples of one joint of a train, over the angles of its yoke and as mean and harmonic."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from torsion.analyses.joints.found import CoupleFound
from torsion.analyses.joints.line import Placed
from torsion.arrays import FloatArray
from torsion.components.part_records import JointRecord
from torsion.kinematics.couples import Couple, Harmonic, couple_harmonics, couples
from torsion.kinematics.cross import transfer
from torsion.kinematics.tripod import constant_velocity_couple, exact_motion, exact_statics

Carrier = Literal["driving", "driven"]
_SAMPLES = 720  # over a turn of a tripod; symmetry puts the extremes of its couples at multiples of 30 degrees


@dataclass(frozen=True)
class _Tripod:
    """Couples (normal, inplane) of a single-bearing tripod on its shafts and its force, arrays like `arms`."""

    driving: tuple[FloatArray, FloatArray]
    driven: tuple[FloatArray, FloatArray]
    force: FloatArray


def couples_found(
    place: Placed, yoke: FloatArray, torque: float, carrier: Carrier, distance: float | None
) -> tuple[tuple[CoupleFound, CoupleFound], float]:
    """Couples on the driving and the driven shaft, and the greatest force across the driving shaft, N.

    yoke (angles,) rad from the joint's plane; `torque` is constant on the shaft called `carrier`.
    """
    if place.joint.kind == "cross":
        return _of_cross(place, yoke, torque, carrier, distance), 0.0
    if place.joint.order == 0 or place.joint.angle == 0:
        return _of_constant_velocity(place.joint.angle, yoke, torque, distance), 0.0
    return _of_tripod(place, yoke, torque, carrier, distance)


def _of_cross(
    place: Placed, yoke: FloatArray, torque: float, carrier: Carrier, distance: float | None
) -> tuple[CoupleFound, CoupleFound]:
    """Mean and second harmonic in closed form, counted over the carrier's own angle."""
    angle, yoke_at_zero = place.joint.angle, place.joint.yoke
    found, parts = couples(yoke, angle, torque, carrier), couple_harmonics(angle, torque, carrier)
    start = yoke_at_zero if carrier == "driving" else yoke_at_zero + float(transfer(yoke_at_zero, angle).error)
    turn = np.exp(2j * start)
    largest = {carrier: abs(torque) * math.tan(angle), _other(carrier): abs(torque) * _lesser(angle)}
    driving = (found.driving, found.driving_yoke, parts.driving_normal, parts.driving_inplane)
    driven = (found.driven, found.driven_yoke, parts.driven_normal, parts.driven_inplane)

    def of(shaft: Carrier, couple: Couple, turning: FloatArray, normal: Harmonic, inplane: Harmonic) -> CoupleFound:
        return CoupleFound(
            shaft, couple.normal, couple.inplane, turning,
            mean=(float(normal.mean), float(inplane.mean)),
            amplitude=(complex(normal.second * turn), complex(inplane.second * turn)),
            order=2, largest=largest[shaft], bearing=_reaction(largest[shaft], distance),
        )  # fmt: skip

    return of("driving", *driving), of("driven", *driven)


def _lesser(angle: float) -> float:
    """Largest couple on the shaft without the constant torque, over it: peak of tan u sqrt(1 - s^2 u^2)."""
    sine = math.sin(angle)
    return sine if 2.0 * sine * sine <= 1.0 else 0.5 / math.cos(angle)


def _of_constant_velocity(
    angle: float, yoke: FloatArray, torque: float, distance: float | None
) -> tuple[CoupleFound, CoupleFound]:
    """Standing couple torque tan(angle/2) in the plane, the same on either shaft."""
    size = float(constant_velocity_couple(angle, torque))
    none = (0j, 0j)
    one, other = (
        CoupleFound(shaft, np.zeros_like(yoke), np.full_like(yoke, size), None, (0.0, size), none, 0, abs(size),
                    _reaction(abs(size), distance))
        for shaft in ("driving", "driven")
    )  # fmt: skip
    return one, other


def _of_tripod(
    place: Placed, yoke: FloatArray, torque: float, carrier: Carrier, distance: float | None
) -> tuple[tuple[CoupleFound, CoupleFound], float]:
    """Exact couples; mean and third harmonic over the carrier's own angle from a turn of samples."""
    arms = 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    curve, turn = (
        _statics(place.joint, yoke + math.pi / 2, torque, carrier),
        _statics(place.joint, arms, torque, carrier),
    )
    start = place.joint.yoke + math.pi / 2
    x, share = _own_angle(place.joint, arms, start, carrier)
    rows = []
    for shaft, shown, whole in (("driving", curve.driving, turn.driving), ("driven", curve.driven, turn.driven)):
        mean = tuple(float(np.mean(part * share)) for part in whole)
        third = tuple(complex(2.0 * np.mean(part * share * np.exp(-3j * x))) for part in whole)
        largest = float(np.hypot(*whole).max())
        rows.append(
            CoupleFound(
                "driving" if shaft == "driving" else "driven", shown[0], shown[1], None,
                (mean[0], mean[1]), (third[0], third[1]), 3, largest, _reaction(largest, distance),
            )
        )  # fmt: skip
    return (rows[0], rows[1]), float(turn.force.max())


def _own_angle(joint: JointRecord, arms: FloatArray, start: float, carrier: Carrier) -> tuple[FloatArray, FloatArray]:
    """The carrier's angle from where it stands at angle zero, and its speed over the driving one; like `arms`."""
    if carrier == "driving":
        return arms - start, np.ones_like(arms)
    both = exact_motion(np.append(arms, start), joint.angle, joint.radius or 0.0, joint.arm or 1.0)
    return arms - start + both.error[:-1] - both.error[-1], both.ratio[:-1]


def _statics(joint: JointRecord, arms: FloatArray, torque: float, carrier: Carrier) -> _Tripod:
    """Couples with the first arm at angles from the plane's normal; a couple about the normal acts on both shafts."""
    data = joint.angle, joint.radius or 0.0, joint.arm or 1.0
    carried = np.full_like(arms, torque) if carrier == "driving" else torque * exact_motion(arms, *data).ratio
    found = exact_statics(arms, *data, carried)
    return _Tripod(
        (found.driving_normal, found.driving_inplane), (-found.driving_normal, found.driven_inplane),
        np.hypot(*found.force),
    )  # fmt: skip


def _other(carrier: Carrier) -> Carrier:
    return "driven" if carrier == "driving" else "driving"


def _reaction(couple: float, distance: float | None) -> float | None:
    """N at each of two bearings at a distance, m."""
    return None if distance is None else couple / distance
