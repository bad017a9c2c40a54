"""Joints of a train in the order of power flow: which stands behind which, and how the shafts behind them move."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.arrays import FloatArray
from torsion.components.part_records import JointRecord
from torsion.kinematics.cross import Transfer, transfer
from torsion.kinematics.line import Line
from torsion.kinematics.tripod import exact_motion
from torsion.train import Train

_SAMPLES = 256  # of a third of a turn; harmonics of a tripod that can turn fall below rounding long before the 128th


@dataclass(frozen=True)
class Placed:
    """A joint in its train."""

    name: str
    part: int
    joint: JointRecord
    ratio: Fraction  # speed of its driving shaft / reference speed
    before: int | None  # position of the joint before it on its shaft line
    error: tuple[tuple[int, complex], ...]  # (order, rad) to first order, as the response takes it
    span: int  # position of its span in every assembly


@dataclass(frozen=True)
class Behind:
    """Motion of the shaft behind a joint as the first shaft of the line turns at speed 1; arrays (angles,)."""

    error: FloatArray  # rad, against the first shaft
    speed: FloatArray
    acceleration: FloatArray  # 1/rad
    yoke: FloatArray  # rad from its plane to its driving yoke
    ratio: FloatArray  # of this joint alone: driven speed / driving speed


def placed(train: Train) -> tuple[Placed, ...]:
    """Every joint, the ones before it first. Assemblies number springs first, then gears and joints."""
    found: list[Placed] = []
    at: dict[int, int] = {}  # part -> position in the list
    for number, mesh in enumerate(train.constraints):
        part = train.parts[mesh.part]
        if part.joint is None:
            continue
        before = None if mesh.after is None else at[mesh.after]
        at[mesh.part] = len(found)
        span = len(train.springs) + number
        found.append(Placed(mesh.name, mesh.part, part.joint, part.ratio, before, mesh.error, span))
    return tuple(found)


def paths(joints: Sequence[Placed]) -> tuple[tuple[int, ...], ...]:
    """Positions of the joints of every shaft line, from its first joint to one that no other stands behind."""
    followed = {joint.before for joint in joints}
    return tuple(_path(joints, last) for last in range(len(joints)) if last not in followed)


def _path(joints: Sequence[Placed], last: int | None) -> tuple[int, ...]:
    path: list[int] = []
    while last is not None:
        path.insert(0, last)
        last = joints[last].before
    return tuple(path)


def motions(joints: Sequence[Placed], turned: FloatArray) -> tuple[Behind, ...]:
    """Exact motion behind every joint, its line's first shaft at the angles `turned` (angles,) rad."""
    found: list[Behind] = []
    for joint in joints:
        start = Behind(*np.zeros((5, turned.size))) if joint.before is None else found[joint.before]
        rate = np.ones(turned.size) if joint.before is None else start.speed
        yoke = turned + (start.error + joint.joint.yoke)
        own = turning(joint.joint, yoke)
        gain = own.curvature * rate * rate + own.ratio * start.acceleration
        found.append(Behind(start.error + own.error, own.ratio * rate, gain, yoke, own.ratio))
    return tuple(found)


def turning(joint: JointRecord, yoke: FloatArray) -> Transfer:
    """Error, ratio and second derivative of one joint, its driving yoke at angles from its plane, rad."""
    if joint.order == 2:
        return transfer(yoke, joint.angle)
    if joint.order == 0 or joint.angle == 0:
        return Transfer(np.zeros_like(yoke), np.ones_like(yoke), np.zeros_like(yoke))
    radius, arm = joint.radius or 0.0, joint.arm or 1.0
    arms = yoke + math.pi / 2  # from the normal of the plane
    motion = exact_motion(arms, joint.angle, radius, arm)
    return Transfer(motion.error, motion.ratio, _slope(joint.angle, radius, arm, arms))


def _slope(angle: float, radius: float, arm: float, arms: FloatArray) -> FloatArray:
    """Derivative of a tripod's speed ratio, 1/rad, from the Fourier series of the ratio over a third of a turn."""
    third = 2.0 * np.pi / 3.0 * np.arange(_SAMPLES) / _SAMPLES
    series = 2.0 * np.fft.rfft(exact_motion(third, angle, radius, arm).ratio)[1:-1] / _SAMPLES
    order = 3.0 * np.arange(1, series.size + 1)
    steps = 1j * order * series
    heard = np.flatnonzero(np.abs(steps) > np.finfo(float).eps * np.abs(steps).max())
    turn, total = np.exp(3j * arms), np.zeros(arms.shape, dtype=np.complex128)
    for step in steps[heard[-1] :: -1]:  # Horner
        total = (total + step) * turn
    return np.asarray(total.real)


def crosses(joints: Sequence[Placed], path: Sequence[int]) -> tuple[tuple[int, ...], Line]:
    """Positions of the cross joints of a path, and the line that they make, joints between them turning its yokes."""
    chosen: list[int] = []
    angle: list[float] = []
    plane: list[float] = []
    phase: list[float] = []
    carried = 0.0
    for position in path:
        joint = joints[position].joint
        own, leaning = joint.phase, joint.plane
        if joint.kind != "cross":
            carried += own - leaning
            continue
        first = not chosen
        chosen.append(position)
        angle.append(joint.angle)
        plane.append(0.0 if first else leaning)
        phase.append(carried + own - leaning if first else carried + own)
        carried = 0.0
    return tuple(chosen), Line(np.array(angle), np.array(plane), np.array(phase))
