"""The whole report as a cover and numbered blocks, for any renderer."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

from torsion.findings import Findings
from torsion.output.chapters import chapters
from torsion.output.cover import Cover, cover
from torsion.output.numbering import Numbered, numbered


@dataclass(frozen=True)
class Document:
    """A report before it is rendered."""

    cover: Cover
    body: tuple[Numbered, ...]


def document(findings: Findings, today: date | None = None, also: Sequence[str] = ()) -> Document:
    """The report of the findings, `also` with chapters that only an option asks for."""
    return Document(cover(findings, today), tuple(numbered(chapters(findings, also))))
