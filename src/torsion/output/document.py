"""The whole report as a cover and numbered blocks, for any renderer."""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import date

from torsion.findings import Findings
from torsion.output.chapters import chapters
from torsion.output.cover import Cover, cover
from torsion.output.numbering import Numbered, numbered
from torsion.output.reports import REPORTS, Report


@dataclass(frozen=True)
class Document:
    """A report before it is rendered."""

    cover: Cover
    body: tuple[Numbered, ...]
    findings: Findings | None = None
    report: Report = REPORTS["solve"]

    @property
    def source(self) -> Findings:
        """The findings that it is of; raises ValueError where it is of none."""
        if self.findings is None:
            raise ValueError("the document is not one of findings")
        return self.findings


def document(
    findings: Findings, today: date | None = None, also: Collection[str] = (), report: Report = REPORTS["solve"]
) -> Document:
    """The report of the findings; `also` with the chapters that belong to those outputs."""
    body = tuple(numbered(chapters(findings, report, also)))
    return Document(cover(findings, today, report.title), body, findings, report)
