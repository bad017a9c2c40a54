"""The stand-alone report of the models side by side: check.html and check.json."""

from dataclasses import replace
from datetime import date
from pathlib import Path

from torsion.findings import Findings
from torsion.report.blocks import Block
from torsion.report.chapters import check as check_chapter
from torsion.report.chapters import plan as plan_chapter
from torsion.report.chapters import source as source_chapter
from torsion.report.cover import cover
from torsion.report.document import Document
from torsion.report.numbering import numbered

PAGE = "check.html"


def write_check(findings: Findings, folder: str | Path, *, today: date | None = None) -> list[Path]:
    """Write both files into the folder, all or none; raises OSError where it cannot be written."""
    from torsion.output.results_json import MODELS, text
    from torsion.report.html import html
    from torsion.report.write import write_texts

    page = html(check_document(findings, today or date.today()))
    return write_texts({PAGE: page, "check.json": text(findings, MODELS)}, folder)


def check_document(findings: Findings, today: date | None = None) -> Document:
    """The report of the comparison alone."""
    blocks: list[Block] = []
    for chapter in (check_chapter, plan_chapter, source_chapter):
        blocks += chapter.chapter(findings)
    front = cover(findings, today)
    return Document(replace(front, title="Models of a shaft train compared"), tuple(numbered(blocks)))
