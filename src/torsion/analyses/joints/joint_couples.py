"""Secondary couples of one joint of a train, over the angles of its yoke and as mean and harmonic."""

import math
from dataclasses import replace

import numpy as np

from torsion.analyses.joints.joint_lines import Placed
from torsion.analyses.joints.joint_results import CoupleFound
from torsion.arrays import FloatArray
from torsion.kernels.joints.couples import Carrier, couple_harmonics, couples
from torsion.kernels.joints.cross import transfer
from torsion.kernels.joints.tripod import constant_velocity_couple, exact_motion, exact_statics

Pair = tuple[CoupleFound, ...]  # on the driving and on the driven shaft
SHAFTS: tuple[Carrier, Carrier] = ("driving", "driven")
_SAMPLES = 720  # over a revolution of a tripod; symmetry puts the extremes of its couples at multiples of 30 degrees


def joint_couples(
    joint: Placed, yoke: FloatArray, torque: float, carrier: Carrier, distance: float | None
) -> tuple[Pair, float]:
    """Return the couples on the driving and the driven shaft, and the greatest force across the driving shaft, N.

    yoke (angles,) rad from the joint's plane; `torque` is constant on the shaft called `carrier`; distance of two
    bearings, m.
    """
    force = 0.0
    if joint.record.kind == "cross":
        pair = _of_cross(joint, yoke, torque, carrier)
    elif joint.record.order == 0 or joint.record.angle == 0:
        # A standing couple torque tan(angle/2) in the plane, the same on either shaft.
        size = float(constant_velocity_couple(joint.record.angle, torque))
        none = np.zeros_like(yoke)
        mean = (0.0, size)
        driving = CoupleFound("driving", none, none + size, None, mean, (0j, 0j), 0, abs(size))
        pair = driving, replace(driving, shaft="driven")
    else:
        pair, force = _of_tripod(joint, yoke, torque, carrier)
    if distance is not None:
        pair = tuple(replace(couple, bearing=couple.largest / distance) for couple in pair)
    return pair, force


def _of_cross(joint: Placed, yoke: FloatArray, torque: float, carrier: Carrier) -> Pair:
    """Mean and second harmonic in closed form, counted over the carrier's own angle."""
    angle = joint.record.angle
    start = joint.record.yoke
    curves = couples(yoke, angle, torque, carrier)
    if carrier == "driven":
        start += float(transfer(start, angle).error)
    turn = np.exp(2j * start)
    sine = math.sin(angle)
    # on the shaft without the constant torque: the peak of tan u sqrt(1 - sin^2 u^2)
    lesser = sine if 2.0 * sine * sine <= 1.0 else 0.5 / math.cos(angle)
    shafts = zip(
        SHAFTS,
        (curves.driving, curves.driven),
        couple_harmonics(angle, torque, carrier),
        strict=True,
    )
    return tuple(
        CoupleFound(
            shaft,
            couple.normal,
            couple.inplane,
            couple.yoke,
            mean=(0.0, float(part.mean)),
            amplitude=(complex(part.normal * turn), complex(part.inplane * turn)),
            order=2,
            largest=abs(torque) * (math.tan(angle) if shaft == carrier else lesser),
        )
        for shaft, couple, part in shafts
    )


def _of_tripod(
    joint: Placed, yoke: FloatArray, torque: float, carrier: Carrier
) -> tuple[Pair, float]:
    """Exact couples of a single bearing; mean and third harmonic over the carrier's own angle from one revolution."""
    record = joint.record
    start = joint.record.yoke + math.pi / 2
    arms = 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    data = record.angle, record.radius or 0.0, record.arm or 1.0
    x, share = (
        arms - start,
        np.ones_like(arms),
    )  # the carrier's angle from where it starts, its speed / driving speed
    if carrier == "driven":
        both = exact_motion(np.append(arms, start), *data)
        x = x + both.error[:-1] - both.error[-1]
        share = both.ratio[:-1]

    def statics(angles: FloatArray) -> tuple[list[tuple[FloatArray, FloatArray]], FloatArray]:
        """Return (normal, inplane) on both shafts, the first arm at angles from the plane's normal, and the force."""
        carried = (
            np.full_like(angles, torque)
            if carrier == "driving"
            else torque * exact_motion(angles, *data).ratio
        )
        contact = exact_statics(angles, *data, carried)
        on_driven = -contact.driving_normal, contact.driven_inplane
        return [(contact.driving_normal, contact.driving_inplane), on_driven], np.hypot(
            *contact.force
        )

    (curves, _), (turns, force) = statics(yoke + math.pi / 2), statics(arms)
    pair = []
    for shaft, curve, revolution in zip(SHAFTS, curves, turns, strict=True):
        mean = [float(np.mean(part * share)) for part in revolution]
        third = [complex(2.0 * np.mean(part * share * np.exp(-3j * x))) for part in revolution]
        largest = float(np.hypot(*revolution).max())
        pair.append(
            CoupleFound(shaft, *curve, None, (mean[0], mean[1]), (third[0], third[1]), 3, largest)
        )
    return tuple(pair), float(force.max())
