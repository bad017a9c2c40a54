"""Chapter: universal joints: angles, planes and phases, what they do together, their couples and how they excite."""

from dataclasses import replace
from typing import TYPE_CHECKING

from torsion.analyses.joints.joint_results import Joints
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Points, Table, head
from torsion.output.chapters import joint_figures, joint_tables, verdict
from torsion.output.numbers import NONE, Scale, number, order
from torsion.output.reported_values import amplitude, joint_model
from torsion.output.selection import largest, worst
from torsion.rules.verdict_line import Checks

if TYPE_CHECKING:
    from torsion.analyses.joints.joint_results import JointFound, Joints

NEWTON_METRE = Scale("N m", 1.0)
AXES = (
    "Angles count from the plane of a joint's two shafts. A couple is what the joint puts on that shaft: about the "
    "normal n of the joint's plane, and about the axis in that plane that is square to the shaft."
)
MODEL = (
    "In the response joints are taken to first order: of the transmission error the order 2 of the driving shaft "
    "(order 3 of a tripod with a single bearing), as an imposed twist, together with the alternating part of the mean "
    "torque it transmits. Higher orders are not printed from this model, which is wrong for them at leading order."
)


def chapter(findings: Findings) -> list[Block]:
    """Nothing without joints; on the terminal the lines alone."""
    return [
        replace(block, short="") if isinstance(block, Table) and block.short != joint_tables.LINES
        else replace(block, brief=False) if isinstance(block, Paragraph | Points) else block
        for block in alone(findings)
    ]  # fmt: skip


def alone(findings: Findings) -> list[Block]:
    """The same, on the terminal with every table."""
    found = findings.get(Joints)
    if found is None or not found.joints:
        return []
    blocks: list[Block] = [Heading("Universal joints"), joint_tables.geometry(found), joint_tables.alone(found)]
    blocks += [*_together(found), *_couples(found), *_best(found), *_response(findings, found)]
    if found.remarks:
        blocks += [Heading("What could not be said of the joints", 2), Points(found.remarks, brief=True)]
    return blocks


def summary(findings: Findings) -> list[Block]:
    """The joints in short, for a report of them alone: each line as one, what is gained, and the verdict."""
    found = findings.get(Joints)
    if found is None:
        return []
    items = [sentence for line in found.lines for sentence in joint_tables.in_short(found, line)]
    judged = verdict.conclusion(findings) if findings.need(Checks).lines else []
    return [Heading("Summary"), Points(tuple(items)), *judged]


def _together(found: "Joints") -> list[Block]:
    """The lines as one, their speeds and accelerations, and the motion over the revolution."""
    blocks: list[Block] = [Heading("Joints together", 2), joint_tables.lines(found)]
    moving = joint_tables.at_speed(found)
    if moving is not None:
        blocks.append(moving)
    return [*blocks, *(joint_figures.motion(found, k) for k in range(len(found.lines)))]


def _couples(found: "Joints") -> list[Block]:
    """Nothing where no torque is known."""
    table = joint_tables.couples(found)
    if table is None:
        return []
    drawn: list[Figure | None] = [joint_figures.couples(found, k) for k in range(len(found.joints))]
    return [Heading("Secondary couples", 2), Paragraph(AXES), table, *(figure for figure in drawn if figure)]


def _best(found: "Joints") -> list[Block]:
    """Nothing where no best choice was requested."""
    blocks: list[Block] = []
    for k, line in enumerate(found.lines):
        figure = joint_figures.index(found, k)
        blocks += [*joint_tables.optimum(found, line), *([figure] if figure else [])]
    return [Heading("The best choice", 2), *blocks] if blocks else []


def _response(findings: Findings, found: "Joints") -> list[Block]:
    """How the train answers to each joint's order; nothing without a response or without a joint that excites."""
    exciting = [joint for joint in found.joints if joint.order and joint.amplitude]
    if findings.get(Response) is None or not findings.need(Response).lines or not exciting:
        return []
    columns = head(
        "< Joint | Line | Largest torque through the joint [N m] | At speed [rpm] | Estimated model error there [%]"
    )
    rows = [row for joint in exciting for row in _answers(findings, joint)]
    table = Table(columns, tuple(rows), "The order of each joint's shaft: response of the train")
    return [Heading("Excitation of the train", 2), table, Paragraph(f"{MODEL} {joint_model(findings)}".strip())]


def _answers(findings: Findings, joint: "JointFound") -> list[tuple[str, ...]]:
    """The largest torque in the joint's spans at every line of its order."""
    response, wanted = findings.need(Response), joint.order * joint.ratio
    size = amplitude(findings, [k for k, span in enumerate(findings.system.spans) if span.part == joint.part])
    rows: list[tuple[str, ...]] = []
    for place in (k for k, line in enumerate(response.lines) if line.order == wanted):
        at = largest(size[:, place])
        error = NONE if at is None else number(100 * float(response.joint_error[at, place]), 2)
        rows.append((joint.name, f"order {order(wanted)}", *worst(size[:, place], response.speed, NEWTON_METRE), error))
    return rows
