"""Chapter: universal joints: angles, planes, phases and how they excite."""

import cmath
import math

import numpy as np

from torsion.components.lowering import Part
from torsion.findings import Findings
from torsion.primitives import Constraint
from torsion.report.blocks import Block, Column, Heading, Paragraph, Table
from torsion.report.numbers import NONE, RPM, degrees, number, order, rpm, scale
from torsion.report.reading import joint_model, largest, over_speed, rated

RATED = Column("Driven acceleration at rated speed", "rad/s²"), Column("Speed × angle", "deg/min")
MODEL = (
    "Cross joints are taken to first order: of the transmission error the order 2 of the driving shaft, as an imposed "
    "twist, together with the alternating part of the mean torque it transmits; q = tan²(β/2) is the amplitude of the "
    "error. Order 4 and above are not printed from this model, which is wrong for them at leading order."
)


def chapter(findings: Findings) -> list[Block]:
    """Nothing without joints."""
    meshes = {mesh.part: mesh for mesh in findings.study.train.constraints}
    found = [(k, p) for k, p in enumerate(findings.study.train.parts) if p.component.keyword == "joint" and k in meshes]
    if not found:
        return []
    joints = [(part, meshes[index]) for index, part in found]
    blocks: list[Block] = [Heading("Universal joints"), _geometry(joints), _unevenness(findings, joints)]
    blocks.extend(_resulting(findings, joints))
    if findings.response is not None and findings.response.lines and any(mesh.error for _, mesh in joints):
        blocks.append(_response(findings, found))
        blocks.append(Paragraph(f"{MODEL} {joint_model(findings)}"))
    return blocks


def _geometry(joints: list[tuple[Part, Constraint]]) -> Table:
    columns = (
        Column("Joint", align="left"), Column("Kind", align="left"), Column("Angle β", "deg"),
        Column("Plane to the previous joint's", "deg"), Column("Phase of the yokes", "deg"),
        Column("q = tan²(β/2)", "rad"),
        Column("Speed ratio, smallest"), Column("Largest"),
    )  # fmt: skip
    rows = []
    for part, _ in joints:
        joint = part.component
        bend, plane = float(getattr(joint, "angle", 0.0)), getattr(joint, "plane", None)
        rows.append((
            part.name, str(getattr(joint, "kind", "cross")), degrees(bend), NONE if plane is None else degrees(plane),
            degrees(float(getattr(joint, "phase", 0.0))), number(math.tan(bend / 2) ** 2),
            number(math.cos(bend), 6), number(1 / math.cos(bend), 6),
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Angles of the joints")


def _unevenness(findings: Findings, joints: list[tuple[Part, Constraint]]) -> Table:
    speed = rated(findings)
    columns = [
        Column("Joint", align="left"), Column("Order, own shaft"), Column("Order, reference"),
        Column("Error amplitude", "rad"),
        Column("Phase", "deg"), Column("tan β sin β"),
        *(RATED if speed else ()),
    ]  # fmt: skip
    rows = []
    for part, mesh in joints:
        bend = float(getattr(part.component, "angle", 0.0))
        for harmonic, amplitude in mesh.error or ((2, 0j),):
            own = [] if speed is None else _motion(speed * float(part.ratio), bend, harmonic, abs(amplitude))
            rows.append((
                part.name, str(harmonic), order(harmonic * part.ratio), number(abs(amplitude)),
                degrees(cmath.phase(amplitude)) if amplitude else NONE, number(math.tan(bend) * math.sin(bend)), *own,
            ))  # fmt: skip
    return Table(tuple(columns), tuple(rows), "Transmission error of each joint by itself")


def _motion(speed: float, bend: float, harmonic: int, amplitude: float) -> list[str]:
    """Amplitude of the driven shaft's acceleration, and speed times angle as joint makers count it."""
    return [number((harmonic * speed) ** 2 * amplitude), number(speed * RPM * math.degrees(bend))]


def _resulting(findings: Findings, joints: list[tuple[Part, Constraint]]) -> list[Block]:
    """The order-2 phasors of joints of one speed on one line added up, when everything between them is rigid."""
    groups: dict[tuple[str, ...], list[Constraint]] = {}
    for part, mesh in joints:
        if mesh.error:
            groups.setdefault((str(part.ratio), str(part.path[:-2])), []).append(mesh)
    rows = []
    for meshes in groups.values():
        if len(meshes) > 1:
            total = abs(sum(mesh.error[0][1] for mesh in meshes))
            rest = 0.0 if total < 1e-12 * max(abs(mesh.error[0][1]) for mesh in meshes) else total
            names = ", ".join(mesh.name for mesh in meshes)
            rows.append((names, number(rest), degrees(2 * math.atan(math.sqrt(rest)))))
    if not rows:
        return []
    columns = (Column("Joints", align="left"), Column("Resulting amplitude", "rad"), Column("Resulting angle", "deg"))
    caption = "Joints of one shaft line together, as if everything between them were rigid"
    return [Table(columns, tuple(rows), caption)]


def _response(findings: Findings, joints: list[tuple[int, Part]]) -> Table:
    response, system = over_speed(findings), findings.system
    columns = (
        Column("Joint", align="left"), Column("Line"), Column("Largest torque through the joint", "N m"),
        Column("At speed", "rpm"),
        Column("Estimated model error there", "%"),
    )  # fmt: skip
    rows = []
    for index, part in joints:
        spans = [k for k, span in enumerate(system.spans) if span.part == index]
        wanted = 2 * part.ratio
        for number_of_line, line in enumerate(response.lines):
            if line.order != wanted:
                continue
            size = np.abs(response.torque[:, number_of_line, spans]).max(axis=1)
            at = largest(np.where(response.status[:, number_of_line] == 0, size, np.nan))
            if at is not None:
                unit = scale("N m", [])
                error = number(100 * float(response.joint_error[at, number_of_line]), 2)
                rows.append(
                    (
                        part.name,
                        f"order {order(wanted)}",
                        unit.text(float(size[at])),
                        rpm(float(response.speed[at])),
                        error,
                    )
                )
    return Table(columns, tuple(rows), "Order 2 of each joint's shaft: response of the train")
