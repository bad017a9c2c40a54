"""What is found of universal joints: each joint, each line of them, its optimum."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from torsion.kernels.tree import FloatArray


@dataclass(frozen=True)
class CoupleFound:
    """Secondary couple that a joint puts on one of its shafts, in axes that stand still."""

    shaft: Literal["driving", "driven"]
    normal: FloatArray  # (angles,) N m about the normal of the joint's plane
    inplane: FloatArray  # (angles,) N m about the axis in the plane, square to the shaft
    yoke: FloatArray | None  # (angles,) N m in axes that turn with the yoke
    mean: tuple[float, float]  # N m: normal, inplane
    amplitude: tuple[complex, complex]  # N m, of `order` over the carrier shaft's own angle: normal, inplane
    order: int  # 2 of a cross joint, 3 of a tripod, 0 where the couple stands still
    largest: float  # N m, resultant over the turn
    bearing: float | None  # N: largest bearing reaction, where the distance of the bearings is given


@dataclass(frozen=True)
class JointFound:
    """One joint over the turns of its line's first shaft."""

    name: str
    part: int
    kind: Literal["cross", "tripod", "cv"]
    angle: float  # rad
    plane: float  # rad
    phase: float  # rad
    yoke: float  # rad from its plane to its driving yoke at angle zero
    ratio: Fraction  # speed of its driving shaft / reference speed
    order: int  # of its excitation: 2 cross, 3 tripod, 0 none
    amplitude: complex  # rad, of that order of the transmission error over its driving shaft's angle
    unevenness: float  # largest less smallest driven speed / mean, of this joint alone
    speed: float | None  # rad/s, mean, of its driving shaft at the rated point; None where the file says none
    torque: float | None  # N m, mean, in its driving shaft; None where it is not known
    error: FloatArray  # (angles,) rad of its driven shaft against the first shaft of the line
    speed_ratio: FloatArray  # (angles,) speed of its driven shaft / speed of the first shaft
    acceleration: FloatArray  # (angles,) 1/rad: times speed squared is the acceleration of its driven shaft
    torque_ratio: FloatArray  # (angles,) torque behind this joint / torque before it
    couples: tuple[CoupleFound, ...]  # driving and driven; empty where no torque is known
    steepest: float = 0.0  # 1/rad, greatest magnitude of `acceleration`
    force: float = 0.0  # N, greatest force across the driving shaft, of a tripod with a single bearing


@dataclass(frozen=True)
class LineFound:
    """Joints on one shaft line, as one."""

    joints: tuple[int, ...]  # positions in the list of joints
    resultant: float  # rad: angle of the one cross joint that does the same at order 2
    phase: float  # rad
    classical: float  # rad: the small-angle sum
    index: float  # (greatest - least)/mean speed of the last shaft
    greatest: tuple[float, float]  # speed ratio, and the first driving angle (rad) at which it stands
    least: tuple[float, float]
    optimum: "OptimumFound | None" = None


@dataclass(frozen=True)
class OptimumFound:
    """What the best choice gains."""

    variable: Literal["phase", "angle", "plane"]
    names: tuple[str, ...]  # the joints that were free
    before: tuple[float, ...]  # rad
    best: tuple[float, ...]  # rad
    index_before: float
    index_best: float
    sensitivity: tuple[float, ...]  # index if that joint is 1 degree off, the worse sense
    over: FloatArray  # (values,) rad of the first free joint's variable over its range
    index_over: FloatArray  # (values,) the index there, the other joints as they are


@dataclass(frozen=True)
class Joints:
    """All joints of the train."""

    angle: FloatArray  # (angles,) rad of the first shaft of each line
    joints: tuple[JointFound, ...]
    lines: tuple[LineFound, ...]
    remarks: tuple[str, ...]  # what could not be said and why: no speed, no torque
