"""Universal joints in motion over time: a train cut at them into linear parts, and the torques that join these again.

A joint between two inertias is rigid. Where one side has no inertia, the elastic span there and the joint are one.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.stability.mechanism import JointMap, error, joint_map
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import Span, System
from torsion.errors import SolveError
from torsion.kernels.joints import tripod
from torsion.kernels.motion.collocation import Conditions, Law, Points
from torsion.kernels.trees.tree import connected

SAMPLES = 64  # of a third of a revolution of a tripod: its error is a series that has fallen to rounding there
RETURN = 20.0  # 1/s, rate at which rounding of a rigid joint's angle is taken back
NEWTON = 60  # steps that invert a joint's map, which is monotone
GIVE_YOKES = "`inertia: [driving, driven]`"


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


@dataclass
class ElasticJoint(Law):
    """A joint with a spring behind it and nothing between: k (f(a) - b) + c (f' a' - b') on b, f' times it against a.

    Before its time begins it carries a mean torque that is no part of the answer.
    """

    count = 2
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


@dataclass
class RigidJoint(Law):
    """A joint between two inertias: b'' = f' a'' + f'' a'^2, by the torque on b that this needs."""

    count = 2
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


@dataclass(frozen=True)
class JointCut:
    """A joint at which the train is cut, with the elastic span beside it where that is taken along."""

    span: int
    joint: JointMap  # from `front` on
    front: int  # station with inertia beside the joint
    behind: int  # station with inertia on the other side
    elastic: int | None = None  # span
    massless: tuple[int, ...] = ()  # stations between the joint and that span
    mean: float = 0.0  # N m on `behind`
    viscous: float = 0.0  # N m s/rad of the elastic span, of its loss factor too
    orders: tuple[int, ...] = ()  # of its error, per revolution of its shaft

    def law(self, system: System, inertia: float) -> ElasticJoint | RigidJoint:
        """Return its law; inertia: kg m2 of both sides together."""
        if self.elastic is None:
            return RigidJoint(0, self.joint, inertia, self.mean)
        stiffness = 1.0 / float(system.flexibility[self.elastic])
        return ElasticJoint(0, self.joint, stiffness, self.viscous, self.mean)

    def carried(self, system: System) -> Iterator[tuple[int, int, float]]:
        """Span, which interface of the law (0, 1), and the factor with which its torque is the span's."""
        forward = int(system.driving[self.span]) == self.front
        yield self.span, int(forward or self.elastic is None), 1.0
        if self.elastic is not None:
            yield self.elastic, 1, 1.0 if int(system.driven[self.elastic]) == self.behind else -1.0

    def fill_speeds(self, system: System, angle: FloatArray, speed: FloatArray) -> None:
        """Fill in the speeds (stations, times) of the stations without inertia, from the others' angles and speeds."""
        inside, ends = list(self.massless), (system.driving, system.driven)
        forward = int(system.driving[self.span]) == self.front
        scale = system.speed_ratio[inside] / system.speed_ratio[ends[forward][self.span]]
        gain = turned(self.joint, angle[self.front])[1] * speed[self.front]
        speed[inside] = scale[:, None] * gain


def parts_of(system: System, cuts: Sequence[JointCut]) -> System:
    """The train without its uneven joints; an elastic span that is taken along stays, and carries nothing."""
    names = ("flexibility", "viscous", "loss_factor")
    changed = {name: getattr(system, name).copy() for name in names}
    changed["flexibility"][[cut.span for cut in cuts]] = np.inf
    for name in names[1:]:
        changed[name][[cut.elastic for cut in cuts if cut.elastic is not None]] = 0.0
    return replace(system, **changed)


def joint_cuts(system: System, mean: Steady | None) -> tuple[JointCut, ...]:
    """Every uneven joint; raises SolveError where it can be taken neither as rigid nor with an elastic span."""
    spans = system.uneven_joints
    number = len(system.stations)
    rigid, joined = system.flexibility == 0, np.ones(len(system.spans), dtype=bool)
    rigid[spans], joined[spans] = False, False
    body = connected(number, system.driving[rigid], system.driven[rigid])
    part = connected(number, system.driving[joined], system.driven[joined])
    if len(np.unique(part)) < len(spans) + 1:
        message = "joints close a loop, and their transient response is not supported yet"
        raise _refusal(system, int(spans[-1]), message, "leave one out")
    weight = np.zeros(len(body))
    np.add.at(weight, body, system.inertia)
    return tuple(_cut(system, span, body, weight[body] > 0.0, mean) for span in spans.tolist())


def _cut(
    system: System, span: int, body: IntArray, heavy: np.ndarray, mean: Steady | None
) -> JointCut:
    """Cut the train at a joint; body: (stations,) rigid body of each; heavy: whether that has an inertia."""
    joint, carried = exact_map(system, system.spans[span]), 0.0
    driving, driven = int(system.driving[span]), int(system.driven[span])
    if mean is not None:  # the map of an angle that begins later
        carried, angle = float(mean.torque[span, 0]), float(mean.twist[driving, 0])
        pairs = joint.series
        series = tuple(
            (order, amplitude * np.exp(1j * order * angle)) for order, amplitude in pairs
        )
        joint = replace(joint, yoke=joint.yoke + angle, series=series)
    orders = tuple(order for order, _ in system.spans[span].error)
    if heavy[driving] and heavy[driven]:
        return JointCut(span, joint, driving, driven, mean=carried, orders=orders)
    if not heavy[driving] and not heavy[driven]:
        message = "{} has an inertia on neither side"
        raise _refusal(system, span, message, f"give one of its yokes an inertia: {GIVE_YOKES}")

    forward = bool(heavy[driving])
    front, light = (driving, driven) if forward else (driven, driving)
    inside = np.flatnonzero(body == body[light])
    beside = np.isin(system.driving, inside) | np.isin(system.driven, inside)
    spans = np.flatnonzero(beside & (system.flexibility > 0))
    spans = spans[spans != span]
    acting = [damper.station for damper in system.dampers]
    acting += [torque.station for torque in system.train.torques]
    is_acted_on = bool(np.isin(acting, inside).any())
    if len(spans) != 1 or is_acted_on or not np.isfinite(system.flexibility[spans]).all():
        message = "{} needs an inertia or exactly one elastic span next to it"
        raise _refusal(system, span, message, f"give the yoke there an inertia: {GIVE_YOKES}")
    elastic = int(spans[0])
    ends = int(system.driving[elastic]), int(system.driven[elastic])
    behind = ends[1] if ends[0] in inside else ends[0]
    if not heavy[behind] or elastic in system.uneven_joints or system.spans[elastic].ratio != 1:
        message = "the elastic span next to {} leads to no inertia of the same speed"
        hint = f"give the yokes of the joint an inertia: {GIVE_YOKES}"
        raise _refusal(system, span, message, hint)
    if not forward and joint.series:
        message = f"the driving yoke of the tripod '{system.spans[span].name}' has no inertia"
        raise _refusal(system, span, message, f"give it one: {GIVE_YOKES}")
    viscous, loss = float(system.viscous[elastic]), float(system.loss_factor[elastic])
    if loss:  # what loses as much in the mode with most of its energy there
        modes = modes_as_discretised(system, None)
        w = 2.0 * np.pi * float(modes.frequency[int(np.argmax(modes.elastic[elastic]))])
        viscous += loss / float(system.flexibility[elastic]) / w
    return JointCut(
        span,
        joint if forward else replace(joint, unevenness=-joint.unevenness),
        front,
        behind,
        elastic,
        tuple(inside.tolist()),
        carried if forward else -carried,
        viscous,
        orders,
    )


def _refusal(system: System, span: int, message: str, hint: str) -> SolveError:
    """What is wrong with a joint, at its place in the file."""
    path = system.train.parts[system.spans[span].part].path
    joint = f"the joint '{system.spans[span].name}'"
    return SolveError(message.replace("{}", joint), hint, path)


def standing_angles(
    system: System, cuts: Sequence[JointCut], speed: float
) -> tuple[FloatArray, FloatArray]:
    """Angles (rad) and speeds (stations,) of the own shafts at time 0: no span twisted, the first station as it is.

    speed: rad/s of the reference station.
    """
    ratio = system.speed_ratio
    offset, rate = np.zeros(len(ratio)), np.ones(len(ratio))
    joined = np.ones(len(system.spans), dtype=bool)
    joined[[cut.span for cut in cuts]] = False
    part = connected(len(ratio), system.driving[joined], system.driven[joined])
    settled, left = {int(part[0])}, list(cuts)
    while left:
        cut = next(cut for cut in left if {int(part[cut.front]), int(part[cut.behind])} & settled)
        left.remove(cut)
        forward = int(part[cut.front]) in settled
        source, target = (cut.front, cut.behind) if forward else (cut.behind, cut.front)
        angle = float(ratio[source] * offset[source])
        angle, factor = _beyond(cut.joint, angle, forward=forward)
        members = part == part[target]
        offset[members] = angle / ratio[target]
        rate[members] = rate[source] * ratio[source] * factor / ratio[target]
        settled.add(int(part[target]))
    return offset * ratio, speed * rate * ratio


def _beyond(joint: JointMap, angle: float, *, forward: bool) -> tuple[float, float]:
    """Angle and speed factor of the driven side at a driving angle; forward: else the other way round."""
    sought = angle
    for _ in range(0 if forward else NEWTON):
        reached, slope = (float(column[0]) for column in turned(joint, np.array([angle]))[:2])
        angle -= (reached - sought) / slope
        if abs(reached - sought) < 1e-15 * max(1.0, abs(sought)):
            break
    driven, slope = (float(column[0]) for column in turned(joint, np.array([angle]))[:2])
    return (driven, slope) if forward else (angle, 1.0 / slope)
