"""A train cut at its universal joints: parts that are linear, and what joins them in motion over time.

A joint between two inertias is rigid. Where one side has no inertia, the elastic span there and the joint are one.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.motion.joint_laws import ElasticJoint, RigidJoint, exact_map, turned
from torsion.analyses.stability.mechanism import JointMap
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.kernels.spanning_forest import connected

NEWTON = 60  # steps that invert a joint's map, which is monotone


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

    def law(self, first: int, system: System, inertia: float) -> ElasticJoint | RigidJoint:
        """Of the interfaces `first` and the next; inertia: kg m2 of both sides together."""
        at = (first, first + 1)
        if self.elastic is None:
            return RigidJoint(at, self.joint, inertia, self.mean)
        return ElasticJoint(
            at, self.joint, 1.0 / float(system.flexibility[self.elastic]), self.viscous, self.mean
        )

    def carried(self, system: System) -> Iterator[tuple[int, int, float]]:
        """Span, which interface of the law (0, 1), and the factor with which its torque is the span's."""
        forward = int(system.driving[self.span]) == self.front
        yield self.span, int(forward or self.elastic is None), 1.0
        if self.elastic is not None:
            yield self.elastic, 1, 1.0 if int(system.driven[self.elastic]) == self.behind else -1.0

    def patched(self, system: System, angle: FloatArray, speed: FloatArray) -> None:
        """Fill in the speeds (stations, times) of the stations without inertia, from the others' angles and speeds."""
        inside = list(self.massless)
        there = (
            system.driven[self.span]
            if int(system.driving[self.span]) == self.front
            else system.driving[self.span]
        )
        scale = system.speed_ratio[inside] / system.speed_ratio[there]
        speed[inside] = scale[:, None] * (
            turned(self.joint, angle[self.front])[1] * speed[self.front]
        )


def joint_spans(system: System) -> IntArray:
    """(joints,) spans that turn unevenly."""
    return np.array(
        [number for number, span in enumerate(system.own_spans) if span.error], dtype=np.int64
    )


def parts_of(system: System, cuts: Sequence[JointCut]) -> System:
    """The train without its uneven joints; an elastic span that is taken along stays, and carries nothing."""
    flexibility, viscous, loss = (
        system.flexibility.copy(),
        system.viscous.copy(),
        system.loss_factor.copy(),
    )
    flexibility[[cut.span for cut in cuts]] = np.inf
    for one in (viscous, loss):
        one[[cut.elastic for cut in cuts if cut.elastic is not None]] = 0.0
    return replace(system, flexibility=flexibility, viscous=viscous, loss_factor=loss)


def joint_cuts(system: System, mean: Steady | None) -> tuple[JointCut, ...]:
    """Every uneven joint; raises SolveError where it can be taken neither as rigid nor with an elastic span."""
    spans = joint_spans(system)
    if not spans.size:
        return ()
    rigid = system.flexibility == 0
    rigid[spans] = False
    body = connected(len(system.stations), system.driving[rigid], system.driven[rigid])
    if system.groups is not None:
        message = "the transient analysis does not support joints together with shafts of so many segments"
        raise SolveError(message, "give them fewer `segments`", _place(system, int(spans[0])))
    joined = np.ones(len(rigid), dtype=bool)
    joined[spans] = False
    part = connected(len(system.stations), system.driving[joined], system.driven[joined])
    if len(np.unique(part)) < len(spans) + 1:
        message = "joints close a loop, and their transient response is not supported yet"
        raise SolveError(message, "leave one out", _place(system, int(spans[-1])))
    weight = np.zeros(len(body))
    np.add.at(weight, body, system.inertia)
    return tuple(_cut(system, span, body, weight[body] > 0.0, mean) for span in spans.tolist())


def _place(system: System, span: int) -> Path:
    """Of the joint, in the file."""
    return system.train.parts[system.spans[span].part].path


def _cut(
    system: System, span: int, body: IntArray, heavy: np.ndarray, mean: Steady | None
) -> JointCut:
    joint, name, place = (
        exact_map(system, system.spans[span]),
        system.spans[span].name,
        _place(system, span),
    )
    driving, driven = int(system.driving[span]), int(system.driven[span])
    carried = 0.0 if mean is None else float(mean.torque[span, 0])
    if mean is not None:
        joint = _shifted(joint, float(mean.twist[driving, 0]))
    orders = tuple(order for order, _ in system.spans[span].error)
    if heavy[driving] and heavy[driven]:
        return JointCut(span, joint, driving, driven, mean=carried, orders=orders)
    if not heavy[driving] and not heavy[driven]:
        message = f"the joint '{name}' has an inertia on neither side"
        raise SolveError(
            message, "give one of its yokes an inertia: `inertia: [driving, driven]`", place
        )
    front, light, sign = (driving, driven, 1.0) if heavy[driving] else (driven, driving, -1.0)
    inside = np.flatnonzero(body == body[light])
    beside = np.flatnonzero(
        (np.isin(system.driving, inside) | np.isin(system.driven, inside))
        & (system.flexibility > 0)
    )
    beside = beside[beside != span]
    stations = [one.station for one in system.dampers] + [
        one.station for one in system.train.torques
    ]
    acted = bool(np.isin(stations, inside).any())
    if len(beside) != 1 or acted or not np.isfinite(system.flexibility[beside]).all():
        message = f"the joint '{name}' needs an inertia or exactly one elastic span next to it"
        raise SolveError(
            message, "give the yoke there an inertia: `inertia: [driving, driven]`", place
        )
    elastic = int(beside[0])
    ends = int(system.driving[elastic]), int(system.driven[elastic])
    behind = ends[1] if ends[0] in inside else ends[0]
    if not heavy[behind] or elastic in joint_spans(system) or system.spans[elastic].ratio != 1:
        message = (
            f"the elastic span next to the joint '{name}' leads to no inertia of the same speed"
        )
        raise SolveError(
            message, "give the yokes of the joint an inertia: `inertia: [driving, driven]`", place
        )
    if sign < 0.0 and joint.series:
        message = f"the driving yoke of the tripod '{name}' has no inertia"
        raise SolveError(message, "give it one: `inertia: [driving, driven]`", place)
    joint = joint if sign > 0.0 else joint.undone()
    viscous = float(system.viscous[elastic]) + _of_losses(system, elastic)
    return JointCut(
        span, joint, front, behind, elastic, tuple(inside.tolist()), sign * carried, viscous, orders
    )


def _of_losses(system: System, span: int) -> float:
    """N m s/rad: the viscous damping that loses what a loss factor does in the mode with most of its energy there."""
    if not system.loss_factor[span]:
        return 0.0
    found = modes_as_discretised(system, None)
    w = 2.0 * np.pi * float(found.frequency[int(np.argmax(found.elastic[span]))])
    return float(system.loss_factor[span] / system.flexibility[span]) / w


def _shifted(joint: JointMap, angle: float) -> JointMap:
    """The map of an angle that begins later."""
    series = tuple(
        (order, amplitude * np.exp(1j * order * angle)) for order, amplitude in joint.series
    )
    return replace(joint, yoke=joint.yoke + angle, series=series)


def standing(
    system: System, cuts: Sequence[JointCut], speed: float
) -> tuple[FloatArray, FloatArray]:
    """Angles (rad) and speeds (stations,) of the own shafts at time 0: no span twisted, the first station as it is.

    speed: rad/s of the reference station.
    """
    ratio = system.speed_ratio
    offset, rate = np.zeros(len(ratio)), np.ones(len(ratio))
    if cuts:
        whole = np.ones(len(system.spans), dtype=bool)
        whole[[cut.span for cut in cuts]] = False
        part = connected(len(ratio), system.driving[whole], system.driven[whole])
        known, left = {int(part[0])}, list(cuts)
        while left:
            cut = next(one for one in left if {int(part[one.front]), int(part[one.behind])} & known)
            left.remove(cut)
            a, b = (cut.front, cut.behind)
            forward = int(part[a]) in known
            here, there = (a, b) if forward else (b, a)
            angle = ratio[here] * offset[here]
            angle, factor = _through(cut.joint, angle) if forward else _back(cut.joint, angle)
            members = part == part[there]
            offset[members] = angle / ratio[there]
            rate[members] = rate[here] * ratio[here] * factor / ratio[there]
            known.add(int(part[there]))
    return offset * ratio, speed * rate * ratio


def _through(joint: JointMap, angle: float) -> tuple[float, float]:
    """Driven angle, and driven speed / driving speed."""
    f0, f1, _, _ = turned(joint, np.array([angle]))
    return float(f0[0]), float(f1[0])


def _back(joint: JointMap, driven: float) -> tuple[float, float]:
    """Driving angle, and driving speed / driven speed."""
    angle = driven
    for _ in range(NEWTON):
        reached, slope = _through(joint, angle)
        angle -= (reached - driven) / slope
        if abs(reached - driven) < 1e-15 * max(1.0, abs(driven)):
            break
    return angle, 1.0 / _through(joint, angle)[1]
