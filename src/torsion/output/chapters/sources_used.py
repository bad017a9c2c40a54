"""The literature of the formulas and methods that the run used: a paragraph after the editions of the rules."""

from collections.abc import Iterator

from torsion.findings import Findings, UsedSource
from torsion.output.blocks import Block, Paragraph


def chapter(findings: Findings) -> Iterator[Block]:
    """The rules are in the table before it, with the basis of their limits."""
    literature = [_entry(used) for used in findings.plan.sources if not used.is_rule]
    if literature:
        yield Paragraph(
            f"Sources of the formulas used in this calculation: {'; '.join(literature)}."
        )


def _entry(used: UsedSource) -> str:
    where = "".join(f", {location}" for location in used.where)
    return f"{used.words}{where}" + ("" if used.compared else ", edition not confirmed")
