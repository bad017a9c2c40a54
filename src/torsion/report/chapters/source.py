"""Appendix: the input as read."""

from torsion.findings import Findings
from torsion.report.blocks import Block, Heading, Paragraph, Verbatim
from torsion.report.cover import checksum


def chapter(findings: Findings) -> list[Block]:
    """Left out where the scene did not come from a file."""
    text = findings.study.text
    if not text:
        return []
    words = f"{findings.study.file or 'Input'}, SHA-256 {checksum(text)}. The whole report was computed from this text."
    return [Heading("Appendix: the input as read"), Paragraph(words), Verbatim(text)]
