"""Joints of a train in the order of power flow: which stands behind which, and how the shafts behind them move."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.bracketed_search import find_root
from torsion.kernels.joints.cross import Transfer, behind, greatest_curvature, transfer
from torsion.kernels.joints.line import (
    Line,
    Variable,
    classical_angle,
    index_over,
    optimise,
    resultant,
)
from torsion.kernels.joints.tripod import exact_motion
from torsion.model.parts import JointRecord
from torsion.results import derived, reported, result
from torsion.train import Train


@reported
class CoupleFound:
    """Secondary couple that a joint puts on one of its shafts, in axes that stand still."""

    shaft: Literal["driving", "driven"] = result(
        "driving or driven: the shaft that the joint puts the couple on"
    )
    normal: FloatArray = result("N*m", "angle", "about the normal of the joint's plane")
    inplane: FloatArray = result("N*m", "angle", "about the axis in the plane, square to the shaft")
    yoke: FloatArray | None = result("N*m", "angle", "in axes that turn with the yoke, or null")
    mean: tuple[float, float] = result("N*m", "[about the normal, in the plane]")
    amplitude: tuple[complex, complex] = result(
        "N*m",
        "complex, of `order` over the shaft's own angle: [about the normal, in the plane]",
    )
    order: int = result(
        "of the amplitudes: 2 of a cross joint, 3 of a tripod, 0 of a steady couple"
    )
    largest: float = result("N*m", "largest resultant over the revolution")
    bearing: float | None = result(
        "N", "largest bearing reaction; null without a distance of bearings", default=None
    )

    @derived("the same as `order`; null of a steady couple")
    def varying_order(self) -> int | None:
        return self.order or None

    @derived("N*m", "magnitude of the mean couple")
    def mean_size(self) -> float:
        return math.hypot(*self.mean)


@reported
class JointFound:
    """One joint over the turns of its line's first shaft."""

    name: str = result("the joint")
    part: int  # position of its component
    kind: Literal["cross", "tripod", "cv"] = result("cross, tripod or cv")
    angle: float = result("rad", "between its shafts")
    plane: float = result(
        "rad", "from the plane of the joint before it to its own; 0 of a first joint"
    )
    phase: float = result("rad", "from the driven yoke of the joint before it to its driving yoke")
    yoke: float = result("rad", "from its plane to its driving yoke at angle zero")
    ratio: Fraction = result("speed of its driving shaft / reference speed, exact")
    order: int = result(
        "of its excitation per revolution of its driving shaft; 0 if it does not excite"
    )
    amplitude: complex = result("rad", "complex amplitude of that order of its transmission error")
    unevenness: float = result("1", "of this joint only: (largest - smallest driven speed) / mean")
    speed: float | None = result(
        "rad/s", "mean speed of its driving shaft at the rated point, or null"
    )
    torque: float | None = result("N*m", "mean torque in its driving shaft, or null")
    error: FloatArray = result(
        "rad", "angle", "of its driven shaft against the first shaft of the line"
    )
    speed_ratio: FloatArray = result(
        "1", "angle", "speed of its driven shaft / speed of the first shaft"
    )
    acceleration: FloatArray = result(
        "1/rad", "angle", "acceleration of its driven shaft / speed squared"
    )
    torque_ratio: FloatArray = result("1", "angle", "torque after it / torque before it")
    couples: tuple[CoupleFound, ...] = result("on its shafts; empty without a known torque")
    steepest: float = result(
        "1/rad", "maximum magnitude of acceleration / speed squared", default=0.0
    )
    force: float = result(
        "N",
        "maximum force across the driving shaft of a tripod with a single bearing; otherwise 0",
        default=0.0,
    )

    @derived("rad", "the same as `yoke_rad`, within half a revolution")
    def driving_yoke(self) -> float:
        return math.remainder(self.yoke, math.tau)

    @derived("order of its excitation per revolution of the reference, exact; or null")
    def reference_order(self) -> Fraction | None:
        return self.order * self.ratio if self.order else None

    @derived("rad/s", "maximum speed of its driven shaft; null without a speed")
    def fastest(self) -> float | None:
        return None if self.speed is None else float(self.speed * self.speed_ratio.max())

    @derived("rad/s", "minimum speed of its driven shaft; null without a speed")
    def slowest(self) -> float | None:
        return None if self.speed is None else float(self.speed * self.speed_ratio.min())

    @derived("rad/s**2", "maximum acceleration of its driven shaft; null without a speed")
    def greatest_acceleration(self) -> float | None:
        return None if self.speed is None else self.speed**2 * self.steepest

    @derived("rad**2/s", "mean speed times joint angle; null without a speed")
    def speed_angle(self) -> float | None:
        return None if self.speed is None else self.speed * self.angle


@reported
class Extreme:
    """A greatest or least speed of the last shaft of a line."""

    speed_ratio: float = result("1", "speed of the last shaft / speed of the first")
    at: float = result("rad", "first driving angle at which it stands")


@reported
class LineFound:
    """Joints on one shaft line, as one."""

    joints: tuple[int, ...] = result("positions in `joints` of the joints of one shaft line")
    resultant: float = result("rad", "angle of the one cross joint that does the same at order 2")
    phase: float = result("rad", "its phase")
    classical: float = result("rad", "small-angle sum of the handbooks")
    index: float = result("1", "(maximum - minimum) / mean speed of the last shaft")
    greatest: Extreme = result("greatest speed")
    least: Extreme = result("least speed")
    optimum: "OptimumFound | None" = result("the best choice; null if not requested", default=None)


@reported
class OptimumFound:
    """What the best choice gains."""

    variable: Literal["phase", "angle", "plane"] = result("phase, angle or plane")
    names: tuple[str, ...] = result("", "joint", "the joints that were free")
    before: tuple[float, ...] = result("rad", "joint", "of every free joint in the file")
    best: tuple[float, ...] = result("rad", "joint", "of every free joint")
    index_before: float = result("1", "index as the file says")
    index_best: float = result("1", "index of the best choice")
    sensitivity: tuple[float, ...] = result(
        "1",
        "joint",
        "index if that joint is 1 degree off, the worse sense",
        key="index_1_deg_off",
    )
    over: FloatArray = result("rad", "value", "of the first free joint over its range")
    index_over: FloatArray = result("1", "value", "index there, the other joints as they are")


@reported
class Joints:
    """All joints of the train."""

    angle: FloatArray = result("rad", "angle", "of the first shaft of each line")
    joints: tuple[JointFound, ...] = result("every joint")
    lines: tuple[LineFound, ...] = result("every line of joints, as one joint")
    remarks: tuple[str, ...] = result("what could not be said, and why")


_SAMPLES = 256  # of a third of a revolution; harmonics of a tripod that can turn fall below rounding long before the 128th


@dataclass(frozen=True)
class Placed:
    """A joint in its train."""

    name: str
    part: int
    record: JointRecord
    ratio: Fraction  # speed of its driving shaft / reference speed
    before: int | None  # position of the joint before it on its shaft line
    error: tuple[tuple[int, complex], ...]  # (order, rad) to first order, as the response takes it
    span: int  # position of its span in every assembly


@dataclass(frozen=True)
class Behind:
    """Motion of the shaft behind a joint as the first shaft of the line turns at speed 1; arrays (angles,)."""

    transfer: Transfer  # from the angle of the first shaft
    yoke: FloatArray  # rad from its plane to its driving yoke
    ratio: FloatArray  # of this joint alone: driven speed / driving speed


def placed(train: Train) -> tuple[Placed, ...]:
    """Return every joint, the ones before it first. Assemblies number springs first, then gears and joints."""
    placed_joints: dict[int, Placed] = {}
    for span, mesh in enumerate(train.constraints, len(train.springs)):
        part = train.parts[mesh.part]
        if part.joint is not None:
            before = None if mesh.after is None else list(placed_joints).index(mesh.after)
            placed_joints[mesh.part] = Placed(
                mesh.name, mesh.part, part.joint, part.ratio, before, mesh.error, span
            )
    return tuple(placed_joints.values())


def path_to(joints: Sequence[Placed], last: int | None) -> tuple[int, ...]:
    """Return the positions of the joints of a shaft line from its first to one of them."""
    path: list[int] = []
    while last is not None:
        path.insert(0, last)
        last = joints[last].before
    return tuple(path)


def motions(joints: Sequence[Placed], turned: FloatArray) -> tuple[Behind, ...]:
    """Return the exact motion behind every joint, its line's first shaft at the angles `turned` (angles,) rad."""
    none = np.zeros(turned.size)
    behind_joints = list[Behind]()
    for joint in joints:
        before = (
            Transfer(none, none + 1.0, none)
            if joint.before is None
            else behind_joints[joint.before].transfer
        )
        yoke = turned + (before.error + joint.record.yoke)
        of_joint = turning(joint.record, yoke)
        behind_joints.append(Behind(behind(before, of_joint), yoke, of_joint.ratio))
    return tuple(behind_joints)


def turning(joint: JointRecord, yoke: FloatArray) -> Transfer:
    """Return the error, ratio and second derivative of one joint, its driving yoke at angles from its plane, rad."""
    if joint.order == 2:
        return transfer(yoke, joint.angle)
    if joint.order == 0 or joint.angle == 0:
        return Transfer(np.zeros_like(yoke), np.ones_like(yoke), np.zeros_like(yoke))
    data = joint.angle, joint.radius or 0.0, joint.arm or 1.0
    arms = yoke + math.pi / 2  # from the normal of the plane
    motion = exact_motion(arms, *data)

    # The derivative of the ratio, 1/rad, by the Fourier series of it over a third of a revolution.
    third = 2.0 * np.pi / 3.0 * np.arange(_SAMPLES) / _SAMPLES
    series = 2.0 * np.fft.rfft(exact_motion(third, *data).ratio)[1:-1] / _SAMPLES
    steps = 1j * (3.0 * np.arange(1, series.size + 1)) * series
    heard = np.flatnonzero(np.abs(steps) > np.finfo(float).eps * np.abs(steps).max())
    turn = np.exp(3j * arms)
    slope = np.zeros(arms.shape, dtype=np.complex128)
    for step in steps[heard[-1] :: -1]:  # Horner
        slope = (slope + step) * turn
    return Transfer(motion.error, motion.ratio, slope.real)


def crosses(joints: Sequence[Placed], path: Sequence[int]) -> tuple[tuple[int, ...], Line]:
    """Return the positions of the cross joints of a path, and the line that they make, joints between them turning its yokes.

    Where there is none, the line is that of a straight joint.
    """
    rows: dict[int, tuple[float, float, float]] = {}
    carried = 0.0
    for position in path:
        joint = joints[position].record
        if joint.kind != "cross":
            carried += joint.phase - joint.plane
            continue
        plane = joint.plane if rows else 0.0
        rows[position] = joint.angle, plane, carried + joint.phase - (joint.plane - plane)
        carried = 0.0
    return tuple(rows), Line(*np.array(list(rows.values()) or [(0.0, 0.0, 0.0)]).T)


_TURN = (
    1440  # samples of a revolution, in which every extreme of speed or acceleration is first sought
)
_WIDEST = math.radians(45.0)  # of a joint's angle in the picture of the index


def line_found(
    joints: Sequence[Placed], path: tuple[int, ...], variable: Variable | None, free: str | None
) -> LineFound:
    """Return the joints of one path as one: the resultant of its cross joints, the speeds of all, the best `variable`."""
    _, line = crosses(joints, path)
    single = resultant(line)
    angle = float(single.greatest_at)
    greatest = Extreme(float(single.greatest), angle)
    slowest = Extreme(float(single.least), math.fmod(angle + math.pi / 2.0, math.pi))
    index = float(single.index)
    if has_third_order(joints, path):
        greatest = _extreme(joints, path, 1.0)
        slowest = _extreme(joints, path, -1.0)
        index = greatest.speed_ratio - slowest.speed_ratio
    optimum = variable and optimum_found(joints, path, variable, free)
    resulting = float(single.angle), float(single.phase), float(classical_angle(line))
    return LineFound(path, *resulting, index, greatest, slowest, optimum)


def has_third_order(joints: Sequence[Placed], path: Sequence[int]) -> bool:
    """Return whether a tripod on the path moves the end of its shaft: no single cross joint turns as the line does."""
    return any(joints[k].record.order == 3 and joints[k].record.angle > 0 for k in path)


def _extreme(joints: Sequence[Placed], path: tuple[int, ...], sense: float) -> Extreme:
    """The extreme of the sampled speed, refined to where the acceleration vanishes."""

    def acceleration(angle: float) -> float:
        return float(_end(joints, path, np.array([angle])).curvature[0])

    turned = np.linspace(0.0, 2.0 * math.pi, _TURN, endpoint=False)
    near = float(turned[int(np.argmax(sense * _end(joints, path, turned).ratio))])
    around = near - turned[1], near + turned[1]
    if acceleration(around[0]) * acceleration(around[1]) < 0.0:
        near = float(find_root(acceleration, *around, tolerance=1e-15))
    greatest = float(_end(joints, path, np.array([near])).ratio[0])
    return Extreme(greatest, math.fmod(near + 2.0 * math.pi, 2.0 * math.pi))


def steepest(joints: Sequence[Placed], path: tuple[int, ...]) -> float:
    """Return the greatest magnitude of the acceleration behind the last joint of a path at speed 1, 1/rad."""
    if not has_third_order(joints, path):
        return float(greatest_curvature(resultant(crosses(joints, path)[1]).angle))
    size = np.abs(
        _end(joints, path, np.linspace(0.0, 2.0 * math.pi, _TURN, endpoint=False)).curvature
    )
    row = int(np.argmax(size))
    before, top, behind = size[row - 1], size[row], size[(row + 1) % _TURN]
    bow = before - 2.0 * top + behind  # vertex of the parabola through the three
    return float(top if bow >= 0.0 else top - (behind - before) ** 2 / (8.0 * bow))


def _end(joints: Sequence[Placed], path: tuple[int, ...], turned: FloatArray) -> Transfer:
    """Motion behind the last joint of a path."""
    return motions(joints, turned)[path[-1]].transfer


def optimum_found(
    joints: Sequence[Placed], path: tuple[int, ...], variable: Variable, free: str | None
) -> OptimumFound | None:
    """Return the best choice for the cross joints of a path, tripods left out; None where there is nothing to choose.

    free: the joint that may be changed, all cross joints but the first if None.
    """
    chosen, line = crosses(joints, path)
    ranks = (
        range(1, len(chosen))
        if free is None
        else [k for k, joint in enumerate(chosen) if joints[joint].name == free]
    )
    ranks = [rank for rank in ranks if rank > 0 or variable == "angle"]
    if len(chosen) < 2 or not ranks:
        return None
    best = optimise(line, variable, ranks)
    before = [float(getattr(joints[chosen[rank]].record, variable)) for rank in ranks]
    changes = [
        float(getattr(best.line, variable)[rank] - getattr(line, variable)[rank]) for rank in ranks
    ]
    # Phases and planes are the same after half a revolution: the smaller change is stated.
    if variable != "angle":
        changes = [math.remainder(change, math.pi) for change in changes]
    best_values = [old + change for old, change in zip(before, changes, strict=True)]
    widest = max(_WIDEST, before[0], best_values[0]) if variable == "angle" else 2.0 * math.pi
    # The curve is over the value as the file counts it, which differs from that of the line by a constant.
    over = np.linspace(0.0, widest, 361)
    as_line_counts = float(getattr(line, variable)[ranks[0]]) - before[0]
    return OptimumFound(
        variable=variable,
        names=tuple(joints[chosen[rank]].name for rank in ranks),
        before=tuple(before),
        best=tuple(best_values),
        index_before=float(best.before.index),
        index_best=float(best.after.index),
        sensitivity=tuple(best.sensitivity.tolist()),
        over=over,
        index_over=index_over(line, variable, ranks[0], over + as_line_counts),
    )
