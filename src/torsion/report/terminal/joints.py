"""The tables of the joints on the terminal, narrow enough for 80 columns."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from torsion.analyses.joints.joint_results import Joints
from torsion.findings import Findings
from torsion.report import joint_tables
from torsion.report.chapters import verdict
from torsion.report.numbers import NONE, number, rpm, scale
from torsion.report.pages.joints import PAGE
from torsion.report.terminal.grids import filled, grid, printed, verdicts
from torsion.rules.check import Checks

if TYPE_CHECKING:
    from torsion.analyses.joints.joint_results import Joints, OptimumFound

DIGITS = 4


def show_joints(findings: Findings, folder: Path | None = None, console: Console | None = None) -> None:
    """Print the tables of the joints, and where the report is."""
    screen = console or Console()
    screen.print(Text(findings.study.name, style="bold"))
    for item in joint_grids(findings):
        screen.print(item)
    if folder is not None:
        screen.print(Text(f"Report: {folder / PAGE}"))


def joint_grids(findings: Findings) -> list[RenderableType]:
    """Geometry, lines, couples, the best choice, what could not be said, and the verdict if a rule was judged."""
    found = findings.get(Joints)
    if found is None:
        return []
    shown: list[RenderableType] = [
        made for made in (_geometry(found), lines_as_one(found), _couples(found)) if made.row_count
    ]
    for line in found.lines:
        if line.optimum is not None:
            shown += [_best(line.optimum), Text(joint_tables.gained(line.optimum))]
    shown += [Text(f"- {remark}") for remark in found.remarks]
    if findings.need(Checks).lines:
        shown += [verdicts(findings), *(printed(block) for block in verdict.conclusion(findings))]
    return shown


def lines_as_one(found: "Joints") -> Grid:
    """The joints of each shaft line as one."""
    heads = (("joints", "<"), ("as one, deg", ">"), ("small-angle", ">"), ("greatest", ">"), ("least", ">"))
    made = grid("Joints of a shaft line as one: angle, speed ratios, index", *heads, ("index, %", ">"))
    full = joint_tables.lines(found).rows
    return filled(made, [[row[0], row[1], row[2], row[4], row[6], row[8]] for row in full])


def _geometry(found: "Joints") -> Grid:
    heads = (("joint", "<"), ("kind", "<"), ("angle", ">"), ("plane", ">"), ("phase", ">"), ("error, deg", ">"))
    made = grid("Universal joints, angles in deg", *heads, ("rpm", ">"), ("rad/s² behind", ">"))
    rows = []
    for joint, row in zip(found.joints, joint_tables.geometry(found).rows, strict=True):
        gain = NONE
        if joint.speed is not None:
            gain = number(joint.speed**2 * joint.steepest, DIGITS) if joint.steepest > joint_tables.STILL else "0"
        error = number(math.degrees(abs(joint.amplitude)), DIGITS)
        rows.append([row[0], row[1], *row[2:5], error, rpm(joint.speed, DIGITS), gain])
    return filled(made, rows)


def _couples(found: "Joints") -> Grid:
    known = [(joint, couple) for joint in found.joints for couple in joint.couples]
    unit = scale("N m", [couple.largest for _, couple in known])
    heads = (("joint", "<"), ("on the shaft", "<"), ("mean", ">"), ("order", ">"), ("amplitude", ">"), ("largest", ">"))
    made = grid(f"Secondary couples, {unit.unit}", *heads, ("bearing, N", ">"))
    rows = [
        [joint.name, couple.shaft, unit.text(math.hypot(*couple.mean), DIGITS), str(couple.order),
         unit.text(max(abs(one) for one in couple.amplitude), DIGITS), unit.text(couple.largest, DIGITS),
         number(couple.bearing, DIGITS)]
        for joint, couple in known
    ]  # fmt: skip
    return filled(made, rows)


def _best(found: "OptimumFound") -> Grid:
    heads = (("joint", "<"), ("now", ">"), ("best", ">"), ("index if 1 deg off the best, %", ">"))
    made = grid(f"Best {found.variable}, deg", *heads)
    return filled(made, list(map(list, joint_tables.best_rows(found))))
