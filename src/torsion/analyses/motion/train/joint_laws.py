"""Universal joints in motion over time: torques between two parts of a train that turn by the map of a joint."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.stability.mechanism import JointMap, error, joint_map
from torsion.arrays import FloatArray
from torsion.assembly.spans import Span
from torsion.assembly.system import System
from torsion.kernels.joints import tripod
from torsion.kernels.motion.collocation import Conditions, Law, Points

SAMPLES = 64  # of a third of a revolution of a tripod: its error is a series that has fallen to rounding there
RETURN = 20.0  # 1/s, rate at which rounding of a rigid joint's angle is taken back


def exact_map(system: System, span: Span) -> JointMap:
    """The map of a joint; of a tripod a series of its exact motion."""
    joint_of_span, joint = joint_map(system, span), system.train.parts[span.part].joint
    if joint is None or joint.kind != "tripod" or not joint_of_span.series:
        return joint_of_span
    angle = np.arange(SAMPLES) * (2.0 * math.pi / 3.0 / SAMPLES)
    spider = joint.yoke + math.pi / 2.0
    motion = tripod.exact_motion(angle + spider, joint.angle, joint.radius or 0.0, joint.arm or 1.0)
    amplitudes = 2.0 * np.fft.rfft(motion.error)[: SAMPLES // 2] / SAMPLES
    amplitudes[0] /= 2.0
    series = tuple((3 * k, complex(amplitude)) for k, amplitude in enumerate(amplitudes))
    return replace(joint_of_span, series=series)


def turned(
    joint: JointMap, angle: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Driven angle and its derivatives by the driving angle, both of the own shafts."""
    e0, e1, e2, e3 = error(joint, angle)
    return angle + e0, 1.0 + e1, e2, e3


class JointLaw(Law):
    """A law between the station in front of a joint and that behind it."""

    @property
    def count(self) -> int:
        return 2


@dataclass(frozen=True)
class ElasticJoint(JointLaw):
    """A joint with a spring behind it and nothing between: k (f(a) - b) + c (f' a' - b') on b, f' times it against a.

    Before its time begins it carries a mean torque that is no part of the answer.
    """

    interface: int  # the station in front of the joint; that behind its spring is the next
    joint: JointMap
    stiffness: float  # N m/rad
    viscous: float  # N m s/rad
    mean: float = 0.0  # N m

    def conditions(self, regime: int, points: Points) -> Conditions:
        f0, f1, f2, _ = turned(self.joint, points.angle[0])
        k, c, (front, behind) = self.stiffness, self.viscous, points.speed
        carried = points.torque[1] + self.mean
        torque = k * (f0 - points.angle[1]) + c * (f1 * front - behind)
        zero, unit = np.zeros_like(f1), np.ones_like(f1)
        return Conditions(
            np.stack([-f1 * carried + self.mean, torque]) - points.torque,
            by_torque=np.array([[-unit, -f1], [zero, -unit]]),
            by_angle=np.array([[-f2 * carried, zero], [k * f1 + c * f2 * front, -k * unit]]),
            by_speed=np.array([[zero, zero], [c * f1, -c * unit]]),
        )


@dataclass(frozen=True)
class RigidJoint(JointLaw):
    """A joint between two inertias: b'' = f' a'' + f'' a'^2, by the torque on b that this needs."""

    interface: int  # the station in front of the joint; that behind it is the next
    joint: JointMap
    inertia: float  # kg m2, that makes a torque of what the angles lack
    mean: float = 0.0  # N m

    def conditions(self, regime: int, points: Points) -> Conditions:
        f0, f1, f2, f3 = turned(self.joint, points.angle[0])
        (front, behind), (gain, gained) = points.speed, points.acceleration
        zero, unit = np.zeros_like(f1), np.ones_like(f1)
        carried = points.torque[1] + self.mean
        off = f1 * gain + f2 * front**2 - gained + 2.0 * RETURN * (f1 * front - behind)
        off = off + RETURN**2 * (f0 - points.angle[1])
        m = self.inertia
        by_angle = f2 * gain + f3 * front**2 + 2.0 * RETURN * f2 * front + RETURN**2 * f1
        by_speed = 2.0 * m * (f2 * front + RETURN * f1)
        return Conditions(
            np.stack([self.mean - f1 * carried - points.torque[0], m * off]),
            by_torque=np.array([[-unit, -f1], [zero, zero]]),
            by_angle=np.array([[-f2 * carried, zero], [m * by_angle, -m * RETURN**2 * unit]]),
            by_speed=np.array([[zero, zero], [by_speed, -2.0 * m * RETURN * unit]]),
            by_acceleration=np.array([[zero, zero], [m * f1, -m * unit]]),
        )
