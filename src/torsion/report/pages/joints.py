"""The stand-alone report of the universal joints: joints.html, joints.json and joints.csv."""

import csv
import io
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import torsion
from torsion.analyses.joints.joint_results import Joints
from torsion.findings import Findings
from torsion.kernels.tree import FloatArray
from torsion.report.blocks import Block
from torsion.report.chapters import joints as joints_chapter
from torsion.report.chapters import plan as plan_chapter
from torsion.report.chapters import source as source_chapter
from torsion.report.chapters import verdict as verdict_chapter
from torsion.report.cover import checksum, cover
from torsion.report.document import Document
from torsion.report.numbering import numbered
from torsion.report.numbers import RPM
from torsion.rules.check import Checks

if TYPE_CHECKING:
    from torsion.analyses.joints.joint_results import JointFound

PAGE = "joints.html"
Series = tuple[str, FloatArray]  # title with unit; (angles,)


def write_joints(findings: Findings, folder: str | Path, *, today: date | None = None) -> list[Path]:
    """Write the three files into the folder, all or none; raises OSError where it cannot be written."""
    from torsion.output.results_json import JOINTS, text
    from torsion.report.html import html
    from torsion.report.write import write_texts

    page = html(joint_document(findings, today or date.today()))
    texts = {PAGE: page, "joints.json": text(findings, JOINTS), "joints.csv": csv_text(findings)}
    return write_texts(texts, folder)


def joint_document(findings: Findings, today: date | None = None) -> Document:
    """The report of the joints alone; the verdict where a rule was judged."""
    blocks: list[Block] = joints_chapter.summary(findings)
    if findings.need(Checks).lines:
        blocks += verdict_chapter.chapter(findings)
    for chapter in (joints_chapter, plan_chapter, source_chapter):
        blocks += chapter.chapter(findings)
    front = cover(findings, today)
    return Document(replace(front, title="Universal joints"), tuple(numbered(blocks)))


def csv_text(findings: Findings) -> str:
    """One row an angle; comments before the titles say what it is of. Numbers come back to the last digit."""
    found, study = findings.get(Joints), findings.study
    if found is None:
        raise ValueError("a table of joints needs joints")
    series: list[Series] = [("angle of first shaft [deg]", np.degrees(found.angle))]
    for joint in found.joints:
        series += _columns(joint)
    target = io.StringIO()
    target.write(f"# scene: {_one_line(study.name)}\n")
    if study.text:
        target.write(f"# file: {_one_line(study.file)}, SHA-256 {checksum(study.text)}\n")
    target.write(f"# torsion {torsion.__version__}; motion is that of the shaft behind the joint\n")
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow([title for title, _ in series])
    rows.writerows(np.column_stack([values for _, values in series]).tolist())
    return target.getvalue()


def _columns(joint: "JointFound") -> list[Series]:
    """Motion, torque ratio and couples; speeds and accelerations where the speed is known, else as ratios."""
    name = _one_line(joint.name)
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


def _one_line(text: str) -> str:
    return " ".join(text.split())
