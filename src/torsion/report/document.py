"""The whole report as a cover and numbered blocks, for any renderer."""

from dataclasses import dataclass
from datetime import date

from torsion.findings import Findings
from torsion.report.chapters import chapters
from torsion.report.cover import Cover, cover
from torsion.report.numbering import Numbered, numbered


@dataclass(frozen=True)
class Document:
    """A report before it is rendered."""

    cover: Cover
    body: tuple[Numbered, ...]


def document(findings: Findings, today: date | None = None) -> Document:
    """The report of the findings; chapters that have nothing to say are not there."""
    return Document(cover(findings, today), tuple(numbered(chapters(findings))))
