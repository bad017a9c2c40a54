"""Chapter: universal joints: angles, planes and phases, what they do together, their couples and how they excite."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.joints.joint_results import Joints, LineFound
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.chapters import closing, joint_tables
from torsion.output.chapters.joint_tables import names
from torsion.output.figures.figure import Axis, Figure
from torsion.output.figures.joint_curves import joint_turn
from torsion.output.numbers import scale
from torsion.output.reported_values import joint_model
from torsion.rules.verdict_line import Checks

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
    loads = findings.get(ComponentLoads)
    if loads is None or not any(joint.order and joint.amplitude for joint in joints.joints):
        return
    yield Heading("Excitation of the train", 2)
    yield table(
        "joint: < Joint | order: Order:o | torque: Maximum torque in the joint [N m]:u | speed: Speed [rpm] | "
        "model_error: Estimated model error [%]:2",
        loads.joints,
        "Response of the train to the order of each joint",
    )
    yield Paragraph(f"{MODEL} {joint_model(findings)}".strip())


def _motion(joints: Joints, number: int, line: LineFound) -> Figure:
    """Angle error, speed, acceleration and torque ratio behind every joint of one line."""
    in_line = [joints.joints[k] for k in line.joints]
    curves = (
        ("error", "angle error", "deg", RAD),
        ("speed_ratio", "speed ratio", "", 1.0),
        ("acceleration", "acceleration / speed²", "1/rad", 1.0),
        ("torque_ratio", "torque downstream / upstream", "", 1.0),
    )
    panels = [
        (
            Axis(title, unit),
            size,
            [(f"downstream of {joint.name}", getattr(joint, name) * size) for joint in in_line],
        )
        for name, title, unit, size in curves
    ]
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
