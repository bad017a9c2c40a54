"""Chapter: what was done, how, of what size and in what time; what was left out and why."""

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Table, head
from torsion.output.numbers import number


def chapter(findings: Findings) -> list[Block]:
    """Always printed."""
    plan = findings.plan
    columns = head("< Step | < Method | < Size | Time [ms] | < Why")
    rows = tuple((line.what, line.method, line.size, number(1e3 * line.seconds, 3), line.why) for line in plan.done)
    blocks: list[Block] = [Heading("What was computed"), Table(columns, rows, "Steps that were done")]
    if plan.left_out:
        left = head("< Left out | < Why")
        blocks.append(Table(left, tuple(plan.left_out), "Left out"))
    if plan.versions:
        blocks.append(KeyValues(tuple(plan.versions.items())))
    return blocks
