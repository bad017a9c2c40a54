"""Tables of the universal joints: geometry, each by itself, the lines, motion at speed, couples, the best choice."""

import cmath
import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.joints.joint_results import JointFound, Joints, LineFound, OptimumFound
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Paragraph, Table, filled, table
from torsion.output.numbers import (
    RPM,
    degrees,
    given,
    number,
    settled,
)

Series = tuple[str, FloatArray]  # title with unit; (angles,)
LINES = "Joints of a shaft line together"  # on the terminal
STILL = 1e-12  # rad: an amplitude or an index below it is rounding of angles of order one
ASSEMBLY = "1 deg"  # of error, for which the sensitivity is stated


def geometry(joints: Joints) -> Table:
    """Return the kind, angle, plane and phase of every joint."""
    leading = {line.joints[0] for line in joints.lines}
    return table(
        "< Joint -> | < Kind -> | Angle β [deg]:g -> angle | Plane against the previous joint [deg]:g -> plane | "
        "Phase of the yokes [deg]:g -> phase | Driving yoke from the plane at angle zero [deg]:g | q = tan²(β/2)",
        [
            (
                joint.name,
                joint.kind,
                degrees(joint.angle),
                None if k in leading else joint.plane,
                joint.phase,
                settled(math.remainder(joint.yoke, math.tau), math.tau),
                math.tan(joint.angle / 2) ** 2 if joint.kind == "cross" else None,
            )
            for k, joint in enumerate(joints.joints)
        ],
        "Angles of the joints",
        short="Universal joints, angles in deg",
    )


def alone(joints: Joints) -> Table:
    """Return the transmission error and unevenness of every joint by itself."""
    rows = []
    for joint in joints.joints:
        size = abs(joint.amplitude)
        orders = (joint.order, joint.order * joint.ratio) if joint.order and size else (None, None)
        phase = settled(cmath.phase(joint.amplitude), math.tau) if size else None
        rows.append((joint.name, *orders, size, size, phase, still(joint.unevenness)))
    return table(
        "< Joint -> | Order, own shaft -> order | Order, reference:o | Error amplitude [rad] | "
        "Error amplitude [deg] -> error, deg | Phase [deg]:g | Speed fluctuation [%]",
        rows,
        "Single joints: transmission error and speed fluctuation (maximum − minimum driven speed) / mean",
        short="Single joints: transmission error",
    )


def lines(joints: Joints) -> Table:
    """Return the joints of each shaft line as one."""
    rows = []
    for line in joints.lines:
        varies = line.index > STILL
        ends = [
            (end.speed_ratio, settled(end.at, math.tau) if varies else None)
            for end in (line.greatest, line.least)
        ]
        rows.append(
            (
                names(joints, line),
                _angle(line.resultant),
                _angle(line.classical),
                settled(line.phase, math.tau) if varies else None,
                *ends[0],
                *ends[1],
                still(line.index),
            )
        )
    return table(
        "< Joints -> | Resultant angle [deg] -> resultant, deg | Small-angle sum [deg] -> small-angle | Phase [deg]:g | "
        "Maximum speed ratio:7 -> maximum | at [deg]:g | Minimum:7 -> | at [deg]:g | Degree of non-uniformity [%] -> "
        "non-uniformity, %",
        rows,
        "Joints of one shaft line as one cross joint, rigid between them; angles of the first shaft",
        short=LINES,
    )


def at_speed(joints: Joints) -> Iterator[Table]:
    """Return the speed, acceleration and torque behind every joint whose speed is known; nothing where none is."""
    rows = [
        (
            joint.name,
            joint.speed,
            joint.speed * joint.speed_ratio.max(),
            joint.speed * joint.speed_ratio.min(),
            joint.speed**2 * still(joint.steepest),
            joint.speed * RPM * math.degrees(joint.angle),
        )
        for joint in joints.joints
        if joint.speed is not None
    ]
    if rows:
        yield table(
            "< Joint -> | Mean speed [rpm]:6g -> rpm | Maximum downstream [rpm]:6 | Minimum [rpm]:6 | "
            "Maximum acceleration downstream [rad/s²] -> rad/s² | Speed × angle [deg/min]",
            rows,
            "Speed and acceleration of the shaft downstream of each joint; the first shaft rotates uniformly",
            short="Speed and acceleration downstream of each joint",
        )


def couples(joints: Joints) -> Table:
    """Return the secondary couples of the joints whose torque is known."""
    rows = [
        (
            joint.name,
            couple.shaft,
            joint.torque,
            math.hypot(*couple.mean),
            couple.order or None,
            *map(abs, couple.amplitude),
            couple.largest,
            couple.bearing,
            joint.force or None,
        )
        for joint in joints.joints
        for couple in joint.couples
    ]
    return filled(
        table(
            "< Joint -> | < Shaft -> on the shaft | Torque [~N m] | Mean [~N m] -> mean | Order -> | "
            "Amplitude, normal [~N m] -> normal | Amplitude, in plane [~N m] -> in plane | "
            "Maximum [~N m] -> maximum | Bearings [N] -> bearing, N | Force across [N]",
            rows,
            "Secondary couples on the shafts for the mean torque in the driving shaft: amplitudes of one order, zero to "
            "peak; bearing and transverse forces are maxima over the revolution",
            short="Secondary couples, ~",
        )
    )


def optimum(joints: Joints, line: LineFound) -> Iterator[Block]:
    """Return what the best choice is and what it gains; nothing where none was sought."""
    best_choice = line.optimum
    if best_choice is not None:
        title = f"Optimum {best_choice.variable} of {names(joints, line)}"
        yield table(
            f"< Joint -> | {best_choice.variable.capitalize()} now [deg]:g -> now | Optimum [deg]:g -> optimum | "
            f"Non-uniformity with an error of {ASSEMBLY} [%] -> with {ASSEMBLY} error, %",
            zip(
                best_choice.names,
                best_choice.before,
                map(still, best_choice.best),
                map(still, best_choice.sensitivity),
                strict=True,
            ),
            title,
            short=f"{title}, deg",
        )
        yield Paragraph(_gained(best_choice), brief=True)


def still(value: float) -> float:
    """Return a value, or 0 where it is rounding of angles of order one."""
    return value if abs(value) > STILL else 0.0


def _gained(best_choice: OptimumFound) -> str:
    before, best = _percent(best_choice.index_before), _percent(best_choice.index_best)
    if best_choice.index_before <= STILL:
        return "The line already rotates uniformly."
    share = given(100.0 * (1.0 - best_choice.index_best / best_choice.index_before), 4)
    return f"The degree of non-uniformity decreases from {before} % to {best} %, by {share} %."


def in_short(joints: Joints, line: LineFound) -> Iterator[str]:
    """Return a line of joints in one or two sentences."""
    best_choice, made = line.optimum, "rotates its last shaft uniformly"
    if line.index > STILL:
        made = f"rotates its last shaft with a degree of non-uniformity of {_percent(line.index)} %"
        if line.resultant**2 > STILL:
            made += f"; its cross joints act as one joint of {_angle(line.resultant)} deg"
    yield f"The line of {names(joints, line)} {made}."
    if best_choice is not None:
        best = ", ".join(
            f"{name} {degrees(still(value))} deg"
            for name, value in zip(best_choice.names, best_choice.best, strict=True)
        )
        yield f"Optimum {best_choice.variable}: {best}. {_gained(best_choice)}"


def names(joints: Joints, line: LineFound) -> str:
    """Return the joints of a line in words."""
    return ", ".join(joints.joints[k].name for k in line.joints)


def _percent(value: float) -> str:
    return number(100.0 * still(value))


def _angle(value: float) -> str:
    """A resultant angle; its square is the amplitude that rounding is judged by."""
    return number(math.degrees(value)) if value * value > STILL else "0"


def columns(findings: Findings) -> list[Series]:
    """Return the motion and couples of every joint over the angle of the first shaft, title with unit and values."""
    joints = findings.need(Joints)
    curves = [
        (f"{joint.name} {title}", values)
        for joint in joints.joints
        for title, values in _curves(joint)
    ]
    return [("angle of first shaft [deg]", np.degrees(joints.angle)), *curves]


def _curves(joint: JointFound) -> Iterator[Series]:
    """Motion, torque ratio and couples; speeds and accelerations where the speed is known, else as ratios."""
    yield "error [deg]", np.degrees(joint.error)
    yield "speed ratio [1]", joint.speed_ratio
    if joint.speed is None:
        yield "acceleration / speed² [1/rad]", joint.acceleration
    else:
        yield "speed [rpm]", joint.speed_ratio * joint.speed * RPM
        yield "acceleration [rad/s²]", joint.acceleration * joint.speed**2
    yield "torque ratio [1]", joint.torque_ratio
    for couple in joint.couples:
        yield f"couple on {couple.shaft} shaft about normal [N m]", couple.normal
        yield f"couple on {couple.shaft} shaft in plane [N m]", couple.inplane
        if couple.yoke is not None:
            yield f"couple on {couple.shaft} shaft in turning yoke [N m]", couple.yoke
