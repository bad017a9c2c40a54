"""The stand-alone report of the models side by side: check.html and check.json."""

from dataclasses import replace
from datetime import date
from pathlib import Path

from torsion.findings import Findings
from torsion.output.blocks import Block
from torsion.output.chapters import input_file as source_chapter
from torsion.output.chapters import model_comparison as check_chapter
from torsion.output.chapters import steps_done as plan_chapter
from torsion.output.cover import cover
from torsion.output.document import Document
from torsion.output.numbering import numbered

PAGE = "check.html"


def write_check(findings: Findings, folder: str | Path, *, today: date | None = None) -> list[Path]:
    """Write both files into the folder, all or none; raises OSError where it cannot be written."""
    from torsion.output.html import html
    from torsion.output.results_json import MODELS, text
    from torsion.output.write import write_texts

    page = html(check_document(findings, today or date.today()))
    return write_texts({PAGE: page, "check.json": text(findings, MODELS)}, folder)


def check_document(findings: Findings, today: date | None = None) -> Document:
    """The report of the comparison alone."""
    blocks: list[Block] = []
    for chapter in (check_chapter, plan_chapter, source_chapter):
        blocks += chapter.chapter(findings)
    front = cover(findings, today)
    return Document(replace(front, title="Models of a shaft train compared"), tuple(numbered(blocks)))
