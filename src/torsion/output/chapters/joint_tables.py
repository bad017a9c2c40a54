"""Tables of the universal joints: geometry, each by itself, the lines, motion at speed, couples, the best choice."""

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.joints.joint_results import Joints
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Paragraph, Table, head
from torsion.output.numbers import NONE, RPM, below_right, degrees, given, given_rpm, number, order, scale

if TYPE_CHECKING:
    from torsion.analyses.joints.joint_results import JointFound, LineFound, OptimumFound

Series = tuple[str, FloatArray]  # title with unit; (angles,)
LINES = "Joints of a shaft line as one: angle, speed ratios, index"  # on the terminal
STILL = 1e-12  # rad: an amplitude or an index below it is rounding of angles of order one
COUPLES = (
    "Secondary couples on the shafts, for the mean torque in the joint's driving shaft: amplitudes are half ranges of "
    "that order of the shaft whose torque is constant; bearings and force are largest values over the revolution"
)
ASSEMBLY = "1 deg"  # of error, for which the sensitivity is stated


def geometry(joints: "Joints") -> Table:
    """Kind, angle, plane and phase of every joint."""
    columns = head(
        "< Joint -> | < Kind -> | Angle β [deg] -> angle | Plane to the previous joint's [deg] -> plane | "
        "Phase of the yokes [deg] -> phase | Driving yoke from its plane at angle zero [deg] | q = tan²(β/2)"
    )
    leading = {line.joints[0] for line in joints.lines}
    rows = tuple(
        (
            joint.name, joint.kind, degrees(joint.angle, below_right(joint.angle)),
            NONE if k in leading else degrees(joint.plane), degrees(joint.phase),
            degrees(math.remainder(joint.yoke, math.tau)),
            number(math.tan(joint.angle / 2) ** 2) if joint.kind == "cross" else NONE,
        )
        for k, joint in enumerate(joints.joints)
    )  # fmt: skip
    return Table(columns, rows, "Angles of the joints", short="Universal joints, angles in deg")


def alone(joints: "Joints") -> Table:
    """Transmission error and unevenness of every joint by itself."""
    columns = head(
        "< Joint -> | Order, own shaft -> order | Order, reference | Error amplitude [rad] | "
        "Error amplitude [deg] -> error, deg | Its phase [deg] | Unevenness [%]"
    )
    rows = []
    for joint in joints.joints:
        size = abs(joint.amplitude)
        orders = (str(joint.order), order(joint.order * joint.ratio)) if joint.order and size else (NONE, NONE)
        phase = degrees(cmath.phase(joint.amplitude)) if size else NONE
        rows.append((joint.name, *orders, number(size), number(math.degrees(size)), phase, _percent(joint.unevenness)))
    caption = (
        "Each joint by itself: transmission error, and unevenness (largest less smallest driven speed, over the mean)"
    )
    return Table(columns, tuple(rows), caption, short="Each joint by itself: transmission error")


def lines(joints: "Joints") -> Table:
    """The joints of each shaft line as one."""
    columns = head(
        "< Joints -> | Resultant angle [deg] -> as one, deg | Small-angle sum [deg] -> small-angle | Phase [deg] | "
        "Greatest speed ratio -> greatest | at [deg] | Least -> | at [deg] | Index of fluctuation [%] -> index, %"
    )
    rows = []
    for line in joints.lines:
        varies = line.index > STILL
        where = [degrees(at) if varies else NONE for at in (line.greatest.at, line.least.at)]
        rows.append((
            names(joints, line), _angle(line.resultant), _angle(line.classical),
            degrees(line.phase) if varies else NONE, number(line.greatest.speed_ratio, 7), where[0],
            number(line.least.speed_ratio, 7), where[1], _percent(line.index),
        ))  # fmt: skip
    caption = (
        "Joints of one shaft line as one cross joint, everything between them taken as rigid; angles of its first shaft"
    )
    return Table(columns, tuple(rows), caption, short=LINES)


def at_speed(joints: "Joints") -> Table | None:
    """Speed, acceleration and torque behind every joint; without a known speed as ratios."""
    known = [joint for joint in joints.joints if joint.speed is not None]
    if not known:
        return None
    columns = head(
        "< Joint -> | Mean speed [rpm] -> rpm | Greatest behind it [rpm] | Least [rpm] | "
        "Largest acceleration behind it [rad/s²] -> rad/s² behind | Speed × angle [deg/min]"
    )
    rows = []
    for joint in known:
        speed = float(joint.speed or 0.0)
        rows.append((
            joint.name, given_rpm(speed), number(speed * RPM * float(joint.speed_ratio.max()), 6),
            number(speed * RPM * float(joint.speed_ratio.min()), 6),
            number(speed**2 * joint.steepest) if joint.steepest > STILL else "0",
            number(speed * RPM * math.degrees(joint.angle)),
        ))  # fmt: skip
    caption = "Speed and acceleration of the shaft behind each joint, the first shaft of the line turning evenly"
    return Table(columns, tuple(rows), caption, short="Speed and acceleration behind each joint")


def couples(joints: "Joints") -> Table | None:
    """Secondary couples; None where no torque is known."""
    known = [(joint, couple) for joint in joints.joints for couple in joint.couples]
    if not known:
        return None
    held, pushed = (any(one) for one in ([c.bearing is not None for _, c in known], [j.force for j, _ in known]))
    unit = scale("N m", [couple.largest for _, couple in known])
    torque = scale("N m", [abs(joint.torque or 0.0) for joint, _ in known])
    columns = [
        *head(
            f"< Joint -> | < Shaft -> on the shaft | Torque [{torque.unit}] | Mean [{unit.unit}] -> mean | Order -> | "
            f"Amplitude, normal [{unit.unit}] -> normal | Amplitude, in plane [{unit.unit}] -> in plane | "
            f"Largest [{unit.unit}] -> largest"
        ),
        *([Column("Bearings", "N", short="bearing, N")] if held else []),
        *([Column("Force across", "N")] if pushed else []),
    ]  # fmt: skip
    rows = []
    for joint, couple in known:
        values = (math.hypot(*couple.mean), *(abs(one) for one in couple.amplitude))
        mean, normal, plane = (unit.text(value) for value in values)
        rows.append((
            joint.name, couple.shaft, torque.text(joint.torque), mean, str(couple.order) if couple.order else NONE,
            normal, plane, unit.text(couple.largest), *([number(couple.bearing)] if held else []),
            *([number(joint.force) if joint.force else NONE] if pushed else []),
        ))  # fmt: skip
    return Table(tuple(columns), tuple(rows), COUPLES, short=f"Secondary couples, {unit.unit}")


def optimum(joints: "Joints", line: "LineFound") -> list[Block]:
    """What the best choice is and what it gains; nothing where none was sought."""
    found = line.optimum
    if found is None:
        return []
    columns = head(
        f"< Joint -> | {found.variable.capitalize()} now [deg] -> now | Best [deg] -> best | "
        f"Index if {ASSEMBLY} off the best [%] -> index if {ASSEMBLY} off, %"
    )
    rows = best_rows(found)
    title = f"Best {found.variable} of {names(joints, line)}"
    return [Table(columns, rows, title, short=f"{title}, deg"), Paragraph(gained(found), brief=True)]


def best_rows(found: "OptimumFound") -> tuple[tuple[str, ...], ...]:
    """Joint, value now, best value (deg), index (%) if that joint is off the best."""
    return tuple(
        (name, degrees(before), degrees(best) if abs(best) > STILL else "0", _percent(off))
        for name, before, best, off in zip(found.names, found.before, found.best, found.sensitivity, strict=True)
    )


def gained(found: "OptimumFound") -> str:
    """The gain in a sentence."""
    before, best = _percent(found.index_before), _percent(found.index_best)
    if found.index_before <= STILL:
        return "The line already turns evenly: there is nothing to gain."
    share = given(100.0 * (1.0 - found.index_best / found.index_before), 4)
    return f"The index of fluctuation falls from {before} % to {best} %: {share} % of it is saved."


def in_short(joints: "Joints", line: "LineFound") -> list[str]:
    """A line of joints in one or two sentences."""
    made = "turns its last shaft evenly"
    if line.index > STILL:
        made = f"turns its last shaft with an index of fluctuation of {_percent(line.index)} %"
        if line.resultant**2 > STILL:
            made += f"; its cross joints act as one of {_angle(line.resultant)} deg"
    said = [f"The line of {names(joints, line)} {made}."]
    if line.optimum is not None:
        best = ", ".join(f"{row[0]} {row[2]} deg" for row in best_rows(line.optimum))
        said.append(f"Best {line.optimum.variable}: {best}. {gained(line.optimum)}")
    return said


def names(joints: "Joints", line: "LineFound") -> str:
    """The joints of a line in words."""
    return ", ".join(joints.joints[k].name for k in line.joints)


def of_line(joints: "Joints", line: "LineFound") -> "tuple[JointFound, ...]":
    """The joints of a line."""
    return tuple(joints.joints[k] for k in line.joints)


def _percent(value: float) -> str:
    return number(100.0 * value) if abs(value) > STILL else "0"


def _angle(value: float) -> str:
    """A resultant angle; its square is the amplitude that rounding is judged by."""
    return number(math.degrees(value), below_right(value)) if value * value > STILL else "0"


def columns(findings: Findings) -> list[Series]:
    """Motion and couples of every joint over the angle of the first shaft, title with unit and values."""
    found = findings.need(Joints)
    curves = [curve for joint in found.joints for curve in _curves(joint)]
    return [("angle of first shaft [deg]", np.degrees(found.angle)), *curves]


def _curves(joint: "JointFound") -> list[Series]:
    """Motion, torque ratio and couples; speeds and accelerations where the speed is known, else as ratios."""
    name = joint.name
    made: list[Series] = [
        (f"{name} error [deg]", np.degrees(joint.error)),
        (f"{name} speed ratio [1]", joint.speed_ratio),
    ]
    if joint.speed is None:
        made.append((f"{name} acceleration / speed² [1/rad]", joint.acceleration))
    else:
        made.append((f"{name} speed [rpm]", joint.speed_ratio * joint.speed * RPM))
        made.append((f"{name} acceleration [rad/s²]", joint.acceleration * joint.speed**2))
    made.append((f"{name} torque ratio [1]", joint.torque_ratio))
    for couple in joint.couples:
        made.append((f"{name} couple on {couple.shaft} shaft about normal [N m]", couple.normal))
        made.append((f"{name} couple on {couple.shaft} shaft in plane [N m]", couple.inplane))
        if couple.yoke is not None:
            made.append((f"{name} couple on {couple.shaft} shaft in turning yoke [N m]", couple.yoke))
    return made
