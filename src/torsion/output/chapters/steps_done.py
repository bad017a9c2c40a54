"""Chapter: what was done, how, of what size and in what time; what was left out and why."""

from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Heading, KeyValues, Table, texts
from torsion.output.numbers import number


def chapter(findings: Findings) -> list[Block]:
    """Always printed."""
    plan = findings.plan
    columns = (
        texts("Step"), texts("Method"), texts("Size"),
        Column("Time", "ms"), texts("Why"),
    )  # fmt: skip
    rows = tuple((line.what, line.method, line.size, number(1e3 * line.seconds, 3), line.why) for line in plan.done)
    blocks: list[Block] = [Heading("What was computed"), Table(columns, rows, "Steps that were done")]
    if plan.left_out:
        left = texts("Left out"), texts("Why")
        blocks.append(Table(left, tuple(plan.left_out), "Left out"))
    if plan.versions:
        blocks.append(KeyValues(tuple(plan.versions.items())))
    return blocks
