"""Appendix: the literature of the formulas and methods that the run used."""

from collections.abc import Iterator

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, table


def chapter(findings: Findings) -> Iterator[Block]:
    """The rules stand in the appendix of the limits, with the basis of each."""
    rows = [
        (used.key, used.words, ", ".join(used.where) or "–", "yes" if used.compared else "edition not confirmed")
        for used in findings.plan.sources
        if not used.is_rule
    ]
    if rows:
        yield Heading("Appendix: sources of the formulas")
        yield table("< Key | < Source | < Place | < Compared", rows, "Sources used in this calculation")
