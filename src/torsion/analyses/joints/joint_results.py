"""What is found of universal joints: each joint, each line of them, its optimum."""

import math
from fractions import Fraction
from typing import Literal

from torsion.arrays import FloatArray
from torsion.results import derived, reported, result


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
