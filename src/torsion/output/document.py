"""The whole report for any renderer: a cover, and blocks with their numbers."""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from datetime import date

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Table
from torsion.output.chapters import chapters
from torsion.output.figures.figure import Figure
from torsion.output.reported_values import operation_words
from torsion.output.reports import REPORTS, Report
from torsion.output.scene import checksum

DISCLAIMER = (
    "This report was computed from the figures in the input file, which it repeats in full; it is as good as they are. "
    "Limits marked “to be verified” are to be compared with the edition in force before the report is submitted. "
    "It does not replace the approval of a classification society or measurements on the plant."
)


@dataclass(frozen=True)
class Cover:
    """Title, facts and disclaimer."""

    title: str
    subtitle: str
    facts: tuple[tuple[str, str], ...]
    disclaimer: str = DISCLAIMER


@dataclass(frozen=True)
class Numbered:
    """A block with its number ('' where it has none): '4', '4.2', 'Table 4.1', 'Figure 4.3'."""

    block: Block
    number: str = ""


@dataclass(frozen=True)
class Document:
    """A report before it is rendered."""

    cover: Cover
    body: tuple[Numbered, ...]
    findings: Findings
    report: Report


def document(
    findings: Findings, today: date | None = None, also: Collection[str] = (), report: Report = REPORTS["solve"],
    before: Sequence[Block] = (),
) -> Document:  # fmt: skip
    """The report of the findings, `also` with the chapters of those outputs, and behind the blocks `before` them."""
    body = tuple(numbered([*before, *chapters(findings, report, also)]))
    return Document(_cover(findings, today, report.title), body, findings, report)


def _cover(findings: Findings, today: date | None, title: str) -> Cover:
    """The cover of a report; without a date it bears none."""
    study = findings.study
    facts = [
        ("Scene", study.name),
        ("Description", study.description.strip()),
        ("Input file", study.file),
        ("SHA-256 of the input", checksum(study) or ""),
        ("Operation", operation_words(findings)),
        ("Rules", ", ".join(name for name, _ in study.rules) or "none requested"),
        ("Computed by", f"torsion {torsion.__version__}"),
        ("Date", today.isoformat() if today else ""),
    ]
    return Cover(title, study.name, tuple(fact for fact in facts if fact[1]))


def numbered(blocks: Sequence[Block]) -> Iterator[Numbered]:
    """The blocks in their order, with their numbers; tables and figures without a caption have none."""
    chapter, count = 0, Counter[str]()
    for block in blocks:
        kind = type(block).__name__
        match block:
            case Heading(level=1):
                chapter += 1
                count.clear()
                yield Numbered(block, str(chapter))
            case Heading():
                count[kind] += 1
                yield Numbered(block, f"{chapter}.{count[kind]}")
            case Table(caption=words) | Figure(caption=words) if words:
                count[kind] += 1
                yield Numbered(block, f"{kind} {chapter}.{count[kind]}")
            case _:
                yield Numbered(block)
