"""Tables of the universal joints: geometry, each by itself, the lines, motion at speed, couples, the best choice."""

import cmath
import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.joints.joint_results import JointFound, Joints, LineFound, OptimumFound
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Paragraph, Table, table
from torsion.output.numbers import (
    NONE,
    RPM,
    below_right,
    degrees,
    given,
    given_rpm,
    number,
    order,
    scale,
    settled,
)

Series = tuple[str, FloatArray]  # title with unit; (angles,)
LINES = "Joints of a shaft line together"  # on the terminal
STILL = 1e-12  # rad: an amplitude or an index below it is rounding of angles of order one
ASSEMBLY = "1 deg"  # of error, for which the sensitivity is stated


def geometry(joints: Joints) -> Table:
    """Kind, angle, plane and phase of every joint."""
    leading = {line.joints[0] for line in joints.lines}
    rows = [
        (
            joint.name,
            joint.kind,
            degrees(joint.angle, below_right(joint.angle)),
            NONE if k in leading else degrees(joint.plane),
            degrees(joint.phase),
            degrees(settled(math.remainder(joint.yoke, math.tau), math.tau)),
            math.tan(joint.angle / 2) ** 2 if joint.kind == "cross" else NONE,
        )
        for k, joint in enumerate(joints.joints)
    ]
    return table(
        "< Joint -> | < Kind -> | Angle β [deg] -> angle | Plane against the previous joint [deg] -> plane | "
        "Phase of the yokes [deg] -> phase | Driving yoke from the plane at angle zero [deg] | q = tan²(β/2)",
        rows,
        "Angles of the joints",
        short="Universal joints, angles in deg",
    )


def alone(joints: Joints) -> Table:
    """Transmission error and unevenness of every joint by itself."""
    rows = []
    for joint in joints.joints:
        size = abs(joint.amplitude)
        orders = (
            (str(joint.order), order(joint.order * joint.ratio))
            if joint.order and size
            else (NONE, NONE)
        )
        phase = degrees(settled(cmath.phase(joint.amplitude), math.tau)) if size else NONE
        rows.append(
            (joint.name, *orders, size, math.degrees(size), phase, _percent(joint.unevenness))
        )
    return table(
        "< Joint -> | Order, own shaft -> order | Order, reference | Error amplitude [rad] | "
        "Error amplitude [deg] -> error, deg | Phase [deg] | Speed fluctuation [%]",
        rows,
        "Single joints: transmission error and speed fluctuation (maximum − minimum driven speed) / mean",
        short="Single joints: transmission error",
    )


def lines(joints: Joints) -> Table:
    """The joints of each shaft line as one."""
    rows = []
    for line in joints.lines:
        varies = line.index > STILL
        ends = [
            (number(end.speed_ratio, 7), degrees(settled(end.at, math.tau)) if varies else NONE)
            for end in (line.greatest, line.least)
        ]
        rows.append(
            (
                names(joints, line),
                _angle(line.resultant),
                _angle(line.classical),
                degrees(settled(line.phase, math.tau)) if varies else NONE,
                *ends[0],
                *ends[1],
                _percent(line.index),
            )
        )
    return table(
        "< Joints -> | Resultant angle [deg] -> resultant, deg | Small-angle sum [deg] -> small-angle | Phase [deg] | "
        "Maximum speed ratio -> maximum | at [deg] | Minimum -> | at [deg] | Degree of non-uniformity [%] -> "
        "non-uniformity, %",
        rows,
        "Joints of one shaft line as one cross joint, rigid between them; angles of the first shaft",
        short=LINES,
    )


def at_speed(joints: Joints) -> Iterator[Table]:
    """Speed, acceleration and torque behind every joint whose speed is known; nothing where none is."""
    rows = [
        (
            joint.name,
            given_rpm(joint.speed),
            number(joint.speed * RPM * float(joint.speed_ratio.max()), 6),
            number(joint.speed * RPM * float(joint.speed_ratio.min()), 6),
            number(joint.speed**2 * joint.steepest) if joint.steepest > STILL else "0",
            number(joint.speed * RPM * math.degrees(joint.angle)),
        )
        for joint in joints.joints
        if joint.speed is not None
    ]
    if rows:
        yield table(
            "< Joint -> | Mean speed [rpm] -> rpm | Maximum downstream [rpm] | Minimum [rpm] | "
            "Maximum acceleration downstream [rad/s²] -> rad/s² | Speed × angle [deg/min]",
            rows,
            "Speed and acceleration of the shaft downstream of each joint; the first shaft rotates uniformly",
            short="Speed and acceleration downstream of each joint",
        )


def couples(joints: Joints) -> Table:
    """Secondary couples of the joints whose torque is known."""
    known = [(joint, couple) for joint in joints.joints for couple in joint.couples]
    held, pushed = (
        any(one) for one in ([c.bearing is not None for _, c in known], [j.force for j, _ in known])
    )
    unit = scale("N m", [couple.largest for _, couple in known])
    torque = scale("N m", [joint.torque for joint, _ in known if joint.torque is not None])
    rows = []
    for joint, couple in known:
        mean, normal, plane = (
            unit.text(abs(one)) for one in (math.hypot(*couple.mean), *couple.amplitude)
        )
        rows.append(
            (
                joint.name,
                couple.shaft,
                torque.text(joint.torque),
                mean,
                couple.order or NONE,
                normal,
                plane,
                unit.text(couple.largest),
                *([number(couple.bearing)] if held else []),
                *([number(joint.force) if joint.force else NONE] if pushed else []),
            )
        )
    bearings, force = (
        " | Bearings [N] -> bearing, N" if held else "",
        " | Force across [N]" if pushed else "",
    )
    return table(
        f"< Joint -> | < Shaft -> on the shaft | Torque [{torque.unit}] | Mean [{unit.unit}] -> mean | Order -> | "
        f"Amplitude, normal [{unit.unit}] -> normal | Amplitude, in plane [{unit.unit}] -> in plane | "
        f"Maximum [{unit.unit}] -> maximum{bearings}{force}",
        rows,
        "Secondary couples on the shafts for the mean torque in the driving shaft: amplitudes of one order, zero to "
        "peak; bearing and transverse forces are maxima over the revolution",
        short=f"Secondary couples, {unit.unit}",
    )


def optimum(joints: Joints, line: LineFound) -> Iterator[Block]:
    """What the best choice is and what it gains; nothing where none was sought."""
    found = line.optimum
    if found is not None:
        title = f"Optimum {found.variable} of {names(joints, line)}"
        yield table(
            f"< Joint -> | {found.variable.capitalize()} now [deg] -> now | Optimum [deg] -> optimum | "
            f"Non-uniformity with an error of {ASSEMBLY} [%] -> with {ASSEMBLY} error, %",
            [
                (name, degrees(before), _best(best), _percent(off))
                for name, before, best, off in zip(
                    found.names, found.before, found.best, found.sensitivity, strict=True
                )
            ],
            title,
            short=f"{title}, deg",
        )
        yield Paragraph(_gained(found), brief=True)


def _best(value: float) -> str:
    return degrees(value) if abs(value) > STILL else "0"


def _gained(found: OptimumFound) -> str:
    """The gain in a sentence."""
    before, best = _percent(found.index_before), _percent(found.index_best)
    if found.index_before <= STILL:
        return "The line already rotates uniformly."
    share = given(100.0 * (1.0 - found.index_best / found.index_before), 4)
    return f"The degree of non-uniformity decreases from {before} % to {best} %, by {share} %."


def in_short(joints: Joints, line: LineFound) -> Iterator[str]:
    """A line of joints in one or two sentences."""
    found, made = line.optimum, "rotates its last shaft uniformly"
    if line.index > STILL:
        made = f"rotates its last shaft with a degree of non-uniformity of {_percent(line.index)} %"
        if line.resultant**2 > STILL:
            made += f"; its cross joints act as one joint of {_angle(line.resultant)} deg"
    yield f"The line of {names(joints, line)} {made}."
    if found is not None:
        best = ", ".join(
            f"{name} {_best(value)} deg"
            for name, value in zip(found.names, found.best, strict=True)
        )
        yield f"Optimum {found.variable}: {best}. {_gained(found)}"


def names(joints: Joints, line: LineFound) -> str:
    """The joints of a line in words."""
    return ", ".join(joints.joints[k].name for k in line.joints)


def _percent(value: float) -> str:
    return number(100.0 * value) if abs(value) > STILL else "0"


def _angle(value: float) -> str:
    """A resultant angle; its square is the amplitude that rounding is judged by."""
    return number(math.degrees(value), below_right(value)) if value * value > STILL else "0"


def columns(findings: Findings) -> list[Series]:
    """Motion and couples of every joint over the angle of the first shaft, title with unit and values."""
    found = findings.need(Joints)
    curves = [
        (f"{joint.name} {title}", values)
        for joint in found.joints
        for title, values in _curves(joint)
    ]
    return [("angle of first shaft [deg]", np.degrees(found.angle)), *curves]


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
