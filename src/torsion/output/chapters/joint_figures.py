"""Figures of the universal joints over the revolution, and of the index of fluctuation against what can be chosen."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import FloatArray
from torsion.output.blocks import Figure
from torsion.output.chapters.joint_tables import STILL, names, of_line
from torsion.output.numbers import RPM, Scale, scale

if TYPE_CHECKING:
    from torsion.analyses.joints.joint_results import CoupleFound, JointFound, Joints, LineFound

IndexArray = NDArray[np.int64]
MOST_POINTS = 3000  # of a curve that is drawn
RAD = 180.0 / np.pi


def motion(joints: "Joints", number: int) -> Figure:
    """Angle error, speed, acceleration and torque ratio behind every joint of one line."""
    line, pick = joints.lines[number], _every(joints.angle)
    found = of_line(joints, line)
    speed = found[0].speed
    rate, square = (1.0, 1.0) if speed is None else (speed * RPM, speed**2)
    panels = [
        ("angle error, deg", RAD, _lines(found, [joint.error * RAD for joint in found], pick)),
        ("speed ratio" if speed is None else "speed, rpm", rate,
         _lines(found, [joint.speed_ratio * rate for joint in found], pick)),
        ("acceleration /\nspeed², 1/rad" if speed is None else "acceleration,\nrad/s²", square,
         _lines(found, [joint.acceleration * square for joint in found], pick)),
        ("torque behind /\nbefore the joint", 1.0, _lines(found, [joint.torque_ratio for joint in found], pick)),
    ]  # fmt: skip
    values = {"angle": joints.angle[pick] * RAD, "panels": panels, "quantity": _axis(found)}
    return Figure(f"joint-motion-{number + 1}", _motion_caption(joints, line), "joint turn", values)


def couples(joints: "Joints", number: int) -> Figure | None:
    """Secondary couples on both shafts of one joint; None where no torque is known, or where they stand still."""
    joint, pick = joints.joints[number], _every(joints.angle)
    if not any(couple.order for couple in joint.couples):
        return None
    unit = scale("N m", [couple.largest for couple in joint.couples])
    size = unit.factor * max(abs(joint.torque or 0.0), *(couple.largest for couple in joint.couples))
    panels = [
        (f"on the {couple.shaft}\nshaft, {unit.unit}", size, _couple_lines(couple, unit, pick))
        for couple in joint.couples
    ]
    line = next(line for line in joints.lines if number in line.joints)
    values = {"angle": joints.angle[pick] * RAD, "panels": panels, "quantity": _axis(of_line(joints, line))}
    return Figure(f"joint-couples-{number + 1}", f"Secondary couples of {joint.name}", "joint turn", values)


def index(joints: "Joints", number: int) -> Figure | None:
    """The index of fluctuation of a line against the first free joint's variable; None where none was sought."""
    line = joints.lines[number]
    found = line.optimum
    if found is None or not found.over.size:
        return None
    turn = 0.0 if found.variable == "angle" else 2.0 * np.pi
    first, last = float(found.over[0]), float(found.over[-1])
    before, best = (RAD * _within(float(at[0]), first, last, turn) for at in (found.before, found.best))
    values = {
        "values": found.over * RAD, "index": 100.0 * found.index_over,
        "quantity": f"{found.variable} of {found.names[0]}, deg",
        "present": (before, _percent(found.index_before)), "best": (best, _percent(found.index_best)),
    }  # fmt: skip
    rest = ", the other joints as they are" if len(joints.lines[number].joints) > 2 else ""
    moved = "; the best point moves all free joints" if len(found.names) > 1 else ""
    caption = (
        f"Index of fluctuation of {names(joints, line)} over the {found.variable} of {found.names[0]}{rest}{moved}"
    )
    return Figure(f"joint-index-{number + 1}", caption, "joint index", values)


def _percent(index: float) -> float:
    return 100.0 * index if index > STILL else 0.0


def _every(angle: FloatArray) -> IndexArray:
    """Positions of as many of the angles as can be seen, the first and the last among them."""
    return np.round(np.linspace(0, angle.size - 1, min(angle.size, MOST_POINTS))).astype(np.int64)


def _lines(found: "tuple[JointFound, ...]", values: list[FloatArray], pick: IndexArray) -> list[tuple[str, FloatArray]]:
    return [(f"behind {joint.name}", one[pick]) for joint, one in zip(found, values, strict=True)]


def _couple_lines(couple: "CoupleFound", unit: Scale, pick: IndexArray) -> list[tuple[str, FloatArray]]:
    """About the normal, in the plane, their resultant and, where it is known, the couple in the turning yoke."""
    found = [
        ("about the normal", couple.normal),
        ("in the plane", couple.inplane),
        ("resultant", np.hypot(couple.normal, couple.inplane)),
        *([("in the turning yoke", couple.yoke)] if couple.yoke is not None else []),
    ]
    return [(label, unit.factor * values[pick]) for label, values in found]


def _axis(found: "tuple[JointFound, ...]") -> str:
    return f"angle of the shaft before {found[0].name}, deg"


def _motion_caption(joints: "Joints", line: "LineFound") -> str:
    speed = joints.joints[line.joints[0]].speed
    turning = "which turns evenly" if speed is None else f"which turns evenly at {speed * RPM:.6g} rpm"
    return f"Motion behind {names(joints, line)} over the angle of the first shaft, {turning}"


def _within(value: float, first: float, last: float, turn: float) -> float:
    """A phase or plane brought into the drawn range by whole revolutions; of an angle `turn` is 0."""
    return value if turn == 0.0 or first <= value <= last else first + (value - first) % turn
