"""Chapter: universal joints: angles, planes and phases, what they do together, their couples and how they excite."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.joints.joint_lines import Joints, LineFound, OptimumFound
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.chapters import closing
from torsion.output.figures.curves import joint_turn
from torsion.output.figures.figure import Axis, Figure
from torsion.output.numbers import RPM, degrees, given, number, scale
from torsion.output.records import along
from torsion.output.reported_values import joint_model
from torsion.rules.verdict_line import Checks

Series = tuple[str, FloatArray]  # title with unit; (angles,)
LINES = "Joints of a shaft line together"  # on the terminal
STILL = 1e-12  # rad: an amplitude or an index below it is rounding of angles of order one
ASSEMBLY = "1 deg"  # of error, for which the sensitivity is stated


def lines(joints: Joints) -> Table:
    """Return the joints of each shaft line as one."""
    rows = []
    for line in joints.lines:
        # A resultant angle is the root of what cancels.
        resultant, classical = (
            angle if angle**2 > STILL else 0.0 for angle in (line.resultant, line.classical)
        )
        shown = replace(line, resultant=resultant, classical=classical)
        ends = [line.greatest, line.least]
        if line.index <= STILL:
            shown = replace(shown, phase=math.nan, index=0.0)
            ends = [replace(end, at=math.nan) for end in ends]
        rows.append((shown, *ends, names(joints, line)))
    return table(
        "< Joints -> | resultant: Resultant angle [deg] -> resultant, deg | "
        "classical: Small-angle sum [deg]:s -> small-angle | phase: Phase [deg]:g | "
        "2.speed_ratio: Maximum speed ratio:7 -> maximum | 2.at: at [deg]:gs | 3.speed_ratio: Minimum:7 -> | "
        "3.at: at [deg]:gs | index: Degree of non-uniformity [%] -> non-uniformity, %",
        rows,
        "Joints of one shaft line as one cross joint, rigid between them; angles of the first shaft",
        short=LINES,
    )


def couples(joints: Joints) -> Table:
    """Return the secondary couples of the joints whose torque is known."""
    return table(
        "name: < Joint -> | shaft: < Shaft -> on the shaft | torque: Torque [~N m] | mean_size: Mean [~N m] -> mean | "
        "varying_order: Order -> | amplitude@1: Amplitude, normal [~N m] -> normal | "
        "amplitude@2: Amplitude, in plane [~N m] -> in plane | largest: Maximum [~N m] -> maximum | "
        "bearing: Bearings [N]:? -> bearing, N | force: Force across [N]:?",
        [
            (replace(joint, force=joint.force or math.nan), couple)
            for joint in joints.joints
            for couple in joint.couples
        ],
        "Secondary couples on the shafts for the mean torque in the driving shaft: amplitudes of one order, zero to "
        "peak; bearing and transverse forces are maxima over the revolution",
        short="Secondary couples, ~",
    )


def optimum(joints: Joints, line: LineFound) -> Iterator[Block]:
    """Return what the best choice is and what it gains; nothing where none was sought."""
    best_choice = line.optimum
    if best_choice is not None:
        title = f"Optimum {best_choice.variable} of {names(joints, line)}"
        shown = replace(
            best_choice,
            best=tuple(map(still, best_choice.best)),
            sensitivity=tuple(map(still, best_choice.sensitivity)),
        )
        yield table(
            f"names: < Joint -> | before: {best_choice.variable.capitalize()} now [deg]:g -> now | "
            "best: Optimum [deg]:g -> optimum | "
            f"sensitivity: Non-uniformity with an error of {ASSEMBLY} [%] -> with {ASSEMBLY} error, %",
            along(shown, "joint"),
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
        if line.resultant**2 > STILL:  # its square is the amplitude that rounding is judged by
            angle = number(math.degrees(line.resultant))
            made += f"; its cross joints act as one joint of {angle} deg"
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


def columns(findings: Findings) -> list[Series]:
    """Return the motion and couples of every joint over the angle of the first shaft, title with unit and values."""
    joints = findings.need(Joints)
    columns: list[Series] = [("angle of first shaft [deg]", np.degrees(joints.angle))]
    for joint in joints.joints:
        # Speeds and accelerations stand as ratios where the speed is not known.
        curves = {"error [deg]": np.degrees(joint.error), "speed ratio [1]": joint.speed_ratio}
        if joint.speed is None:
            curves["acceleration / speed² [1/rad]"] = joint.acceleration
        else:
            curves["speed [rpm]"] = joint.speed_ratio * joint.speed * RPM
            curves["acceleration [rad/s²]"] = joint.acceleration * joint.speed**2
        curves["torque ratio [1]"] = joint.torque_ratio
        for couple in joint.couples:
            head = f"couple on {couple.shaft} shaft"
            curves[f"{head} about normal [N m]"] = couple.normal
            curves[f"{head} in plane [N m]"] = couple.inplane
            if couple.yoke is not None:
                curves[f"{head} in turning yoke [N m]"] = couple.yoke
        columns += [(f"{joint.name} {title}", values) for title, values in curves.items()]
    return columns


RAD = 180.0 / np.pi
AXES = (
    "Angles count from the plane of the two shafts of a joint. A secondary couple acts on its shaft about the"
    " normal n of this plane, and about the axis in the plane that is perpendicular to the shaft."
)
MODEL = (
    "The response models joints to first order: order 2 of the driving shaft (order 3 for a tripod with a "
    "single bearing) as imposed twist, and the alternating part of the transmitted mean torque. The model is "
    "not valid for higher orders, and the report omits them."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without joints; on the terminal the lines alone."""
    for block in alone(findings):
        if isinstance(block, Table) and block.short != LINES:
            yield replace(block, short="")
        else:
            yield replace(block, brief=False) if isinstance(block, Paragraph | Points) else block


def alone(findings: Findings) -> Iterator[Block]:
    """Return the same, on the terminal with every table."""
    joints = findings.get(Joints)
    if joints is None or not joints.joints:
        return
    yield Heading("Universal joints")
    yield table(
        "name: < Joint -> | kind: < Kind -> | angle: Angle β [deg]:g -> angle | "
        "plane: Plane against the previous joint [deg]:g -> plane | phase: Phase of the yokes [deg]:g -> phase | "
        "driving_yoke: Driving yoke from the plane at angle zero [deg]:gs | "
        "reference_order: Order, reference:o? -> order | "
        "amplitude: Transmission error [deg]:s -> error, deg | amplitude: Phase of the error [deg]:gp | "
        "unevenness: Speed fluctuation [%]:s",
        joints.joints,
        "Single joints: angles, transmission error and speed fluctuation (maximum − minimum driven speed) / mean",
        short="Universal joints, angles in deg",
    )
    yield Heading("Joints together", 2)
    yield lines(joints)
    moving = [joint for joint in joints.joints if joint.speed is not None]
    if moving:
        yield table(
            "name: < Joint -> | speed: Mean speed [rpm]:6g -> rpm | fastest: Maximum downstream [rpm]:6 | "
            "slowest: Minimum [rpm]:6 | greatest_acceleration: Maximum acceleration downstream [rad/s²] -> rad/s² | "
            "speed_angle: Speed × angle [deg/min]",
            [replace(joint, steepest=still(joint.steepest)) for joint in moving],
            "Speed and acceleration of the shaft downstream of each joint; the first shaft rotates uniformly",
            short="Speed and acceleration downstream of each joint",
        )
    yield from (_motion(joints, k, line) for k, line in enumerate(joints.lines))
    if any(joint.couples for joint in joints.joints):
        yield Heading("Secondary couples", 2)
        yield Paragraph(AXES)
        yield couples(joints)
        yield from (
            _couples(joints, k)
            for k, joint in enumerate(joints.joints)
            if any(c.order for c in joint.couples)
        )
    if any(line.optimum is not None for line in joints.lines):
        yield Heading("Optimum angles", 2)
        for line in joints.lines:
            yield from optimum(joints, line)
    loads = findings.get(ComponentLoads)
    if loads is not None and any(joint.order and joint.amplitude for joint in joints.joints):
        yield Heading("Excitation of the train", 2)
        yield table(
            "joint: < Joint | order: Order:o | torque: Maximum torque in the joint [N m]:u | speed: Speed [rpm] | "
            "model_error: Estimated model error [%]:2",
            loads.joints,
            "Response of the train to the order of each joint",
        )
        yield Paragraph(f"{MODEL} {joint_model(findings)}".strip())
    if joints.remarks:
        yield Heading("Not computed for the joints", 2)
        yield Points(joints.remarks, brief=True)


def summary(findings: Findings) -> Iterator[Block]:
    """Return the joints in short, for a report of them alone: each line as one, what is gained, and the verdict."""
    joints = findings.get(Joints)
    if joints is None:
        return
    yield Heading("Summary")
    yield Points(tuple(sentence for line in joints.lines for sentence in in_short(joints, line)))
    if findings.need(Checks).lines:
        yield from closing.conclusion(findings)


def _motion(joints: Joints, number: int, line: LineFound) -> Figure:
    """Angle error, speed, acceleration and torque ratio behind every joint of one line."""
    in_line = [joints.joints[k] for k in line.joints]
    panels = []
    for name, title, unit, size in (
        ("error", "angle error", "deg", RAD),
        ("speed_ratio", "speed ratio", "", 1.0),
        ("acceleration", "acceleration / speed²", "1/rad", 1.0),
        ("torque_ratio", "torque downstream / upstream", "", 1.0),
    ):
        curves = [(f"downstream of {joint.name}", getattr(joint, name) * size) for joint in in_line]
        panels.append((Axis(title, unit), size, curves))
    caption = f"Motion downstream of {names(joints, line)} over the angle of the first shaft, which rotates uniformly"
    return joint_turn(f"joint-motion-{number + 1}", caption, joints.angle, panels, in_line[0].name)


def _couples(joints: Joints, number: int) -> Figure:
    """Secondary couples on both shafts of one joint."""
    joint = joints.joints[number]
    sizes = [couple.largest for couple in joint.couples]
    unit = scale("N m", sizes)
    size = unit.factor * max([abs(joint.torque or 0.0), *sizes])
    panels = []
    for couple in joint.couples:
        curves = {
            "about the normal": couple.normal,
            "in the plane": couple.inplane,
            "resultant": np.hypot(couple.normal, couple.inplane),
        }
        if couple.yoke is not None:
            curves["in the turning yoke"] = couple.yoke
        lines = [(label, unit.factor * values) for label, values in curves.items()]
        panels.append((Axis(f"on the {couple.shaft} shaft", unit.unit), size, lines))
    first = next(joints.joints[line.joints[0]] for line in joints.lines if number in line.joints)
    name, caption = f"joint-couples-{number + 1}", f"Secondary couples of {joint.name}"
    return joint_turn(name, caption, joints.angle, panels, first.name)
