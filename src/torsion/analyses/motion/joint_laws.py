"""Universal joints in motion over time: torques between two parts of a train that turn by the map of a joint."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.stability.mechanism import JointMap, error, joint_map
from torsion.arrays import FloatArray
from torsion.assembly.spans import Span
from torsion.assembly.system import System
from torsion.kernels.joints import tripod
from torsion.kernels.motion.collocation import Conditions, Points

SAMPLES = 64  # of a third of a revolution of a tripod: its error is a series that has fallen to rounding there
RETURN = 20.0  # 1/s, rate at which rounding of a rigid joint's angle is taken back


def exact_map(system: System, span: Span) -> JointMap:
    """The map of a joint; of a tripod a series of its exact motion."""
    found, joint = joint_map(system, span), system.train.parts[span.part].joint
    if joint is None or joint.kind != "tripod" or not found.series:
        return found
    angle = np.arange(SAMPLES) * (2.0 * math.pi / 3.0 / SAMPLES)
    spider = joint.yoke + math.pi / 2.0
    exact = tripod.exact_motion(
        angle + spider, joint.angle, joint.radius or 0.0, joint.arm or 1.0
    ).error
    amplitude = 2.0 * np.fft.rfft(exact)[: SAMPLES // 2] / SAMPLES
    amplitude[0] /= 2.0
    return replace(found, series=tuple((3 * k, complex(one)) for k, one in enumerate(amplitude)))


def turned(
    joint: JointMap, angle: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Driven angle and its derivatives by the driving angle, both of the own shafts."""
    e0, e1, e2, e3 = error(joint, angle)
    return angle + e0, 1.0 + e1, e2, e3


@dataclass(frozen=True)
class ElasticJoint:
    """A joint with a spring behind it and nothing between: k (f(a) - b) + c (f' a' - b') on b, f' times it against a.

    Before its time begins it carries a mean torque that is no part of the answer.
    """

    at: tuple[int, int]  # the station in front of the joint, that behind its spring
    joint: JointMap
    stiffness: float  # N m/rad
    viscous: float  # N m s/rad
    mean: float = 0.0  # N m
    cuts: tuple[float, ...] = ()

    def first(self, points: Points) -> int:
        return 0

    def limits(self, regime: int, points: Points) -> list[tuple[FloatArray, int]]:
        return []

    def still(self, regime: int) -> tuple[int, ...]:
        return ()

    def conditions(self, regime: int, points: Points) -> Conditions:
        f0, f1, f2, _ = turned(self.joint, points.angle[0])
        k, c, (before, behind) = self.stiffness, self.viscous, points.speed
        torque = k * (f0 - points.angle[1]) + c * (f1 * before - behind)
        none, ones = np.zeros_like(f1), np.ones_like(f1)
        lack = np.stack([-f1 * (points.torque[1] + self.mean) + self.mean, torque]) - points.torque
        return Conditions(
            lack,
            by_torque=np.array([[-ones, -f1], [none, -ones]]),
            by_angle=np.array(
                [
                    [-f2 * (points.torque[1] + self.mean), none],
                    [k * f1 + c * f2 * before, -k * ones],
                ]
            ),
            by_speed=np.array([[none, none], [c * f1, -c * ones]]),
        )


@dataclass(frozen=True)
class RigidJoint:
    """A joint between two inertias: b'' = f' a'' + f'' a'^2, by the torque on b that this needs."""

    at: tuple[int, int]  # the stations in front of the joint and behind it
    joint: JointMap
    inertia: float  # kg m2, that makes a torque of what the angles lack
    mean: float = 0.0  # N m
    cuts: tuple[float, ...] = ()
    first = ElasticJoint.first
    limits = ElasticJoint.limits
    still = ElasticJoint.still

    def conditions(self, regime: int, points: Points) -> Conditions:
        f0, f1, f2, f3 = turned(self.joint, points.angle[0])
        (before, behind), (gain, gained) = points.speed, points.acceleration
        none, ones = np.zeros_like(f1), np.ones_like(f1)
        carried = points.torque[1] + self.mean
        off = f1 * gain + f2 * before**2 - gained + 2.0 * RETURN * (f1 * before - behind)
        off = off + RETURN**2 * (f0 - points.angle[1])
        m = self.inertia
        by_angle = f2 * gain + f3 * before**2 + 2.0 * RETURN * f2 * before + RETURN**2 * f1
        return Conditions(
            np.stack([self.mean - f1 * carried - points.torque[0], m * off]),
            by_torque=np.array([[-ones, -f1], [none, none]]),
            by_angle=np.array([[-f2 * carried, none], [m * by_angle, -m * RETURN**2 * ones]]),
            by_speed=np.array(
                [[none, none], [2.0 * m * (f2 * before + RETURN * f1), -2.0 * m * RETURN * ones]]
            ),
            by_acceleration=np.array([[none, none], [m * f1, -m * ones]]),
        )
