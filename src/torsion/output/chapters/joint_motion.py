"""Chapter: universal joints: angles, planes and phases, what they do together, their couples and how they excite."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.joints.joint_results import (
    CoupleFound,
    JointFound,
    Joints,
    LineFound,
)
from torsion.analyses.response.amplitudes import Response
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.chapters import closing, joint_tables
from torsion.output.chapters.joint_tables import names
from torsion.output.figures import joint_curves
from torsion.output.figures.figure import Figure
from torsion.output.numbers import RPM, order, scale
from torsion.output.reported_values import amplitude, joint_model
from torsion.output.selection import largest, worst
from torsion.rules.verdict_line import Checks

RAD = 180.0 / np.pi
Curves = list[tuple[str, FloatArray]]  # label; (angles,)
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
        if isinstance(block, Table) and block.short != joint_tables.LINES:
            yield replace(block, short="")
        else:
            yield replace(block, brief=False) if isinstance(block, Paragraph | Points) else block


def alone(findings: Findings) -> Iterator[Block]:
    """Return the same, on the terminal with every table."""
    joints = findings.get(Joints)
    if joints is None or not joints.joints:
        return
    yield Heading("Universal joints")
    yield joint_tables.geometry(joints)
    yield joint_tables.alone(joints)
    yield Heading("Joints together", 2)
    yield joint_tables.lines(joints)
    yield from joint_tables.at_speed(joints)
    yield from (_motion(joints, k, line) for k, line in enumerate(joints.lines))
    if any(joint.couples for joint in joints.joints):
        yield Heading("Secondary couples", 2)
        yield Paragraph(AXES)
        yield joint_tables.couples(joints)
        yield from (
            _couples(joints, k)
            for k, joint in enumerate(joints.joints)
            if any(c.order for c in joint.couples)
        )
    if any(line.optimum is not None for line in joints.lines):
        yield Heading("Optimum angles", 2)
        for line in joints.lines:
            yield from joint_tables.optimum(joints, line)
    yield from _response(findings, joints)
    if joints.remarks:
        yield Heading("Not computed for the joints", 2)
        yield Points(joints.remarks, brief=True)


def summary(findings: Findings) -> Iterator[Block]:
    """Return the joints in short, for a report of them alone: each line as one, what is gained, and the verdict."""
    joints = findings.get(Joints)
    if joints is not None:
        yield Heading("Summary")
        yield Points(
            tuple(
                sentence
                for line in joints.lines
                for sentence in joint_tables.in_short(joints, line)
            )
        )
        if findings.need(Checks).lines:
            yield from closing.conclusion(findings)


def _response(findings: Findings, joints: Joints) -> Iterator[Block]:
    """How the train answers to each joint's order; nothing without a response or without a joint that excites."""
    response = findings.get(Response)
    exciting = [joint for joint in joints.joints if joint.order and joint.amplitude]
    if response is None or not response.lines or not exciting:
        return
    rows = []
    for joint in exciting:
        wanted = joint.order * joint.ratio
        size = amplitude(
            findings, [k for k, span in enumerate(findings.system.spans) if span.part == joint.part]
        )
        for column in (k for k, line in enumerate(response.lines) if line.order == wanted):
            row = largest(size[:, column])
            error = None if row is None else response.joint_error[row, column]
            torque = worst(size[:, column], response.speed)
            rows.append((joint.name, f"order {order(wanted)}", *torque, error))
    yield Heading("Excitation of the train", 2)
    yield table(
        "< Joint | < Order | Maximum torque in the joint [N m] | Speed [rpm] | Estimated model error [%]:2",
        rows,
        "Response of the train to the order of each joint",
    )
    yield Paragraph(f"{MODEL} {joint_model(findings)}".strip())


def _motion(joints: Joints, number: int, line: LineFound) -> Figure:
    """Angle error, speed, acceleration and torque ratio behind every joint of one line."""
    in_line = [joints.joints[k] for k in line.joints]
    speed = in_line[0].speed
    rate, square = (1.0, 1.0) if speed is None else (speed * RPM, speed**2)
    curves = [
        ("angle error", "deg", RAD, "error"),
        (
            "speed ratio" if speed is None else "speed",
            "" if speed is None else "rpm",
            rate,
            "speed_ratio",
        ),
        ("acceleration / speed²", "1/rad", square, "acceleration")
        if speed is None
        else ("acceleration", "rad/s²", square, "acceleration"),
        ("torque downstream / upstream", "", 1.0, "torque_ratio"),
    ]
    panels = [
        (
            title,
            unit,
            size,
            [(f"downstream of {joint.name}", getattr(joint, values) * size) for joint in in_line],
        )
        for title, unit, size, values in curves
    ]
    turning = (
        "which rotates uniformly"
        if speed is None
        else f"which rotates uniformly at {speed * RPM:.6g} rpm"
    )
    caption = (
        f"Motion downstream of {names(joints, line)} over the angle of the first shaft, {turning}"
    )
    return _turn(f"joint-motion-{number + 1}", caption, joints, in_line[0], panels)


def _couples(joints: Joints, number: int) -> Figure:
    """Secondary couples on both shafts of one joint."""
    joint = joints.joints[number]
    sizes = [couple.largest for couple in joint.couples]
    unit = scale("N m", sizes)
    size = unit.factor * max(sizes if joint.torque is None else [abs(joint.torque), *sizes])
    panels = [
        (
            f"on the {couple.shaft} shaft",
            unit.unit,
            size,
            [(label, unit.factor * values) for label, values in _couple_curves(couple)],
        )
        for couple in joint.couples
    ]
    first = next(joints.joints[line.joints[0]] for line in joints.lines if number in line.joints)
    return _turn(
        f"joint-couples-{number + 1}", f"Secondary couples of {joint.name}", joints, first, panels
    )


def _couple_curves(couple: CoupleFound) -> Iterator[tuple[str, FloatArray]]:
    """About the normal, in the plane, their resultant and, where it is known, the couple in the turning yoke."""
    yield "about the normal", couple.normal
    yield "in the plane", couple.inplane
    yield "resultant", np.hypot(couple.normal, couple.inplane)
    if couple.yoke is not None:
        yield "in the turning yoke", couple.yoke


def _turn(
    name: str,
    caption: str,
    joints: Joints,
    first: JointFound,
    panels: list[tuple[str, str, float, Curves]],
) -> Figure:
    """Curves over the angle of the shaft before the first joint of a line."""
    quantity, angle = f"angle of the shaft upstream of {first.name}", joints.angle * RAD
    return joint_curves.joint_turn(name, caption, angle=angle, panels=panels, quantity=quantity)
