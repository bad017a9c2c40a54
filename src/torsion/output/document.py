"""The whole report for any renderer: a cover, and blocks with their numbers."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from functools import partial
from typing import Annotated

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, PageEnd, Paragraph, Table, Verbatim
from torsion.output.chapters import chapters
from torsion.output.figures.figure import Figure
from torsion.output.numbers import given_rpm
from torsion.output.reported_values import speed_range
from torsion.output.reports import REPORTS, Report
from torsion.output.stored.scene import checksum
from torsion.output.stored.stored_data import BY_NAME, NOT_KEPT
from torsion.output.table_text import file_name, table_text

MOST_ROWS = 200  # of a table that is printed whole
FIRST, LAST = 20, 5  # rows printed of a longer one, and those that do not pass
FAILED = ("fail", "not kept", "not judged")
MOST_LINES, MOST_SIGNS = 2_000, 200_000  # of a text that is printed
GAP = "⋮"  # in a row, in place of omitted rows
Texts = Mapping[str, Callable[[], str]]  # what makes the text of a file, by its name


def shortened(block: Block, number: str, stem: str) -> tuple[Block, Texts]:
    """Return a block as the page has it, and the files beside the page that it names; a short block unchanged."""
    if isinstance(block, Table) and len(block.values) > MOST_ROWS and number:
        # A gap stands in place of omitted rows, and the caption says so.
        name, count = f"{stem}-{file_name(number)}", len(block.values)
        failed = [row for row, mark in enumerate(block.marks) if mark in FAILED]
        kept = {*range(FIRST), *failed[:MOST_ROWS], *range(count - LAST, count)}
        shown = [row for row in range(count) if row in kept or row - 1 in kept]
        gap = (GAP,) * len(block.columns)
        which = f"the first {MOST_ROWS}" if len(failed) > MOST_ROWS else f"all {len(failed)}"
        caption = f"{block.caption}; the first {FIRST} rows, the last {LAST}"
        caption += f" and {which} that do not pass" if failed else ""
        caption += f", {count - len(kept):,} more rows in {name}"
        if failures := len(set(failed) - kept):
            caption += f", {failures:,} of them not passed"
        short = replace(
            block,
            values=tuple(block.values[row] if row in kept else gap for row in shown),
            marks=tuple(block.marks[k] if k in kept else "" for k in shown if block.marks),
            caption=caption,
        )
        return short, {name: partial(table_text, number, block)}
    if isinstance(block, Verbatim):
        lines, signs = block.text.count("\n"), len(block.text)
        if lines > MOST_LINES or signs > MOST_SIGNS:
            name, size = f"{stem}-input.yaml", f"{lines:,} lines, {signs:,} characters"
            sentence = f"The input is long ({size}): see {name}."
            return Paragraph(sentence), {name: lambda: block.text}
    return block, {}


DISCLAIMER = "The results are as accurate as the input data. The report does not replace class approval or measurements."


LABEL = {"document_number": "", "revision": "revision "}  # of the document, with words before them
FRONT_MATTER = {
    "vessel": "Vessel",
    "yard": "Yard",
    "imo_number": "IMO number",
    "society": "Society",
}
SIGNED = {"prepared": "Prepared", "checked": "Checked", "approved": "Approved"}
LONG = 60  # characters of a fact that needs a row of its own
SHORT = 12  # digits of the SHA-256 that stand on every page
LOGO = re.compile(r"data:image/(png|jpeg|svg\+xml);base64,[A-Za-z0-9+/]*=*")


@dataclass(frozen=True)
class Cover:
    """Title, facts, disclaimer, lines for signatures, and what stands at the head of every page."""

    title: str
    subtitle: str
    facts: tuple[tuple[str, str], ...]
    disclaimer: str = DISCLAIMER
    identity: str = ""  # number and revision of the document, else the name of the scene; at the head of every page
    origin: str = ""  # the first digits of the SHA-256 of the input; beside it
    signatures: tuple[tuple[str, str], ...] = ()  # what was done, and by whom
    logo: str = ""  # a data URI

    def __post_init__(self) -> None:
        if self.logo and not LOGO.fullmatch(self.logo):
            raise ValueError("a logo is a picture in base64")

    @property
    def facts_by_length(self) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
        """The facts that stand two in a row, and those that need a row of their own."""
        short, long = (
            [fact for fact in self.facts if (len(fact[1]) > LONG) is is_long]
            for is_long in (False, True)
        )
        return short, long


@dataclass(frozen=True)
class Numbered:
    """A block with its number ('' where it has none): '4', '4.2', 'Table 4.1', 'Figure 4.3'."""

    block: Annotated[Block, BY_NAME]
    number: str = ""


@dataclass(frozen=True)
class Ending:
    """How the command ends that prints the report."""

    status: int = 0  # its exit status
    work: str = ""  # what was done, and in what time
    unanswered: tuple[str, ...] = ()  # what has no answer, and why


@dataclass(frozen=True)
class Document:
    """A report before it is rendered: all that its page, its PDF, its tables and the terminal are made of."""

    cover: Cover
    body: tuple[Numbered, ...]
    name: str = "solve"  # of its report in REPORTS
    ending: Ending = Ending()
    beside: Texts = field(
        default_factory=dict, metadata=NOT_KEPT
    )  # files beside the page: what is too long for it

    @property
    def report(self) -> Report:
        """What it is a report of, and the names of its files."""
        return REPORTS[self.name]

    @property
    def has_first_page(self) -> bool:
        """The facts of the cover stand behind a first page."""
        return any(isinstance(item.block, PageEnd) for item in self.body)


def document(
    findings: Findings,
    today: date | None = None,
    report: Report = REPORTS["solve"],
    before: Sequence[Block] = (),
    *,
    is_full: bool = False,
) -> Document:
    """Return the report of the findings, with the blocks `before` at its begin and, if full, all its appendices."""
    body, files_beside = list[Numbered](), dict[str, Callable[[], str]]()
    for item in numbered([*before, *chapters(findings, report, is_full=is_full)]):
        block, files = shortened(item.block, item.number, report.stem)
        body.append(Numbered(block, item.number))
        files_beside.update(files)
    name = next(name for name, known_report in REPORTS.items() if known_report is report)
    done = [line for case in findings.each.values() for line in case.plan.done]
    work = f"{len(done)} steps in {sum(line.seconds for line in done):.2f} s" if done else ""
    ending = Ending(findings.exit_status, work, findings.without_answer)
    cover = _cover(findings, today, report.title)
    return Document(cover, tuple(body), name, ending, files_beside)


def _cover(findings: Findings, today: date | None, title: str) -> Cover:
    """Return the cover of a report; without a date it bears none."""
    study, front, sha = findings.study, findings.study.document, checksum(findings.study) or ""
    stated = {} if front is None else front.model_dump(exclude_none=True)
    label = [words + stated[key] for key, words in LABEL.items() if key in stated]
    case = [f"case {study.case.name}"] if label and study.case is not None else []
    point, operation = study.operation.rated, [speed_range(findings)]
    if point is not None:
        rating = f" with {point.power / 1e3:.5g} kW" if point.power is not None else ""
        operation.append(f"rated {given_rpm(point.speed)} rpm{rating}")
    stated_speeds = ", ".join(filter(None, operation))
    facts = [
        ("Document", ", ".join(label)),
        *((words, stated.get(key, "")) for key, words in FRONT_MATTER.items()),
        ("Input file", study.shown_file),
        ("Input SHA-256", sha),
        ("Operation", stated_speeds and f"{stated_speeds} (speed of {study.reference})"),
        ("Rules", ", ".join(name for name, _ in study.rules) or "none requested"),
        ("Computed by", f"torsion {torsion.__version__}"),
        ("Date", today.isoformat() if today else ""),
    ]
    return Cover(
        title,
        study.name,
        tuple(fact for fact in facts if fact[1]),
        identity=" · ".join([*label, *case]) or study.name,
        origin=f"input SHA-256 {sha[:SHORT]}" if sha else "",
        logo=study.logo,
        signatures=tuple((words, stated.get(key, "")) for key, words in SIGNED.items() if front),
    )


def numbered(blocks: Sequence[Block]) -> Iterator[Numbered]:
    """Yield the blocks in their order, with their numbers; tables and figures without a caption have none."""
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
