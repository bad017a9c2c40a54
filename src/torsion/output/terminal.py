"""A report on the terminal: its blocks that have a short form, narrow enough for 80 columns.

Words of a table may be cut, numbers never.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap

from rich.box import SIMPLE
from rich.console import Console, JustifyMethod, OverflowMethod, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar
from rich.table import Table as Grid
from rich.text import Text

from torsion.errors import without_controls
from torsion.findings import Progress
from torsion.output.blocks import Box, Heading, Paragraph, Points, Table
from torsion.output.document import Document
from torsion.output.renderers import OUTPUTS

COLOURS = {
    "pass": "green",
    "fail": "bold red",
    "not kept": "bold red",
    "not judged": "yellow",
    "restricted": "yellow",
    "note": "yellow",
}
MOST_ROWS = 12
LONGEST_WORD, SHORTEST_WORD = 12, 4  # letters that a column of words keeps on a narrow terminal
MOST_TABLES, MOST_SENTENCES = 2, 5  # in the summary
HEADS = (
    "Sweep",
    "Design",
    "Barred ranges",
    "Restrictions",
    "Not computed",
    "For information",
)  # of the box, there
LONGEST_VERDICT = 12  # letters: the longest word of "! PASS with restrictions"
WIDTH, GAP = 80, 3  # columns of a narrow terminal; between two columns of a table


def show(
    document: Document,
    folder: Path | None = None,
    console: Console | None = None,
    *,
    is_verbose: bool = True,
) -> None:
    """Print the report, or its summary of at most 25 lines if not verbose, and where its page is."""
    printed = console or Console()
    for item in OUTPUTS["terminal"](document) if is_verbose else summary(document, printed.width):
        printed.print(item)
    if document.ending.work:
        printed.print(
            Text(document.ending.work + ("" if is_verbose else "; all tables: -v, or the report"))
        )
    if folder is not None:
        printed.print(Text(without_controls(f"Report: {folder / document.report.stem}.html")))


def summary(document: Document, width: int = WIDTH) -> list[RenderableType]:
    """The verdict, its worst rows, and frequencies, each in few lines; the verdict first."""
    found = _title(document)
    sentences, tables = list[str](), 0
    for block in (item.block for item in document.body):
        match block:
            case Box(sign=sign, text=text, kind=kind, lines=lines):
                style = f"bold {COLOURS[kind]}".replace("bold bold", "bold")
                found.append(Text(_in_lines(f"{sign} {text}", 2, width), style=style))
                sentences += [f"{head}: {_plain(line)}" for head, line in lines if head in HEADS]
            case Table(summary=words) if words:
                sentences.append(words)
            case Table(rows_in_summary=rows) if rows and block.rows and tables < MOST_TABLES:
                tables += 1
                found.append(_in_lines_of(block, rows, width))
    return [
        *found,
        *(Text(_in_lines(sentence, 2, width)) for sentence in sentences[:MOST_SENTENCES]),
    ]


def _title(document: Document) -> list[RenderableType]:
    """Name of the model, and number and revision of the document."""
    title: list[RenderableType] = [Text(document.cover.subtitle, style="bold")]
    if document.cover.numbered:
        title.append(Text(f"{document.cover.identity}, {document.cover.origin}"))
    return title


def _in_lines(text: str, most: int, width: int) -> str:
    """The words that fit into so many lines; '…' stands for the rest."""
    lines = wrap(text, width)
    if len(lines) <= most:
        return "\n".join(lines)
    return "\n".join([*lines[: most - 1], wrap(lines[most - 1], width - 2)[0] + " …"])


def screen(document: Document) -> list[RenderableType]:
    """Everything that is printed; the verdict last, where the eye is: of several chapters at the end the first."""
    first = _title(document)
    ends = list[
        tuple[list[RenderableType], list[RenderableType]]
    ]()  # of a verdict: its tables, then its sentences
    chapter = said = first
    for block in (item.block for item in document.body):
        match block:
            case Heading(level=1, at_end=at_end):
                if at_end:
                    ends.append(([], []))
                chapter, said = ends[-1] if at_end else (first, first)
            case Table(short=title) if title and block.rows:
                chapter.append(_in_short(block))
            case Box(sign=sign, text=text, kind=kind, lines=lines):
                said.append(
                    Text(
                        f"{sign} {text}", style=f"bold {COLOURS[kind]}".replace("bold bold", "bold")
                    )
                )
                said.append(Text("\n".join(f"{head}: {_plain(line)}" for head, line in lines)))
            case Paragraph(text=text, kind=kind, brief=True):
                said.append(Text(_plain(text), style=COLOURS.get(kind, "")))
            case Points(items=items, brief=True):
                said.append(Text("\n".join(f"- {_plain(item)}" for item in items)))
    return [*first, *(one for tables, words in reversed(ends) for one in (*tables, *words))]


def _in_lines_of(table: Table, most: int, width: int) -> Grid:
    """The first rows of a table without frame: numbers whole, names cut; only a long verdict has two lines."""
    kept = [k for k, column in enumerate(table.columns) if column.short]
    rows, marks = table.rows[:most], table.marks[:most]
    widths = {k: max(len(table.columns[k].short), *(len(row[k]) for row in rows)) for k in kept}
    if marks:
        widths[kept[-1]] = min(widths[kept[-1]], LONGEST_VERDICT)
    named = [k for k in kept if table.columns[k].align == "left" and not (marks and k == kept[-1])]
    room = width - sum(widths[k] + 2 for k in kept if k not in named) - 2 * len(named)
    for k in sorted(
        named, key=lambda k: widths[k]
    ):  # short names stay whole, the longest has what is left
        widths[k] = min(widths[k], max(room // (len(named)), SHORTEST_WORD))
        room, named = room - widths[k], named[1:]

    grid = Grid(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="italic")
    for k in kept:
        column = table.columns[k]
        is_verdict = bool(marks) and k == kept[-1]
        justify: JustifyMethod = "left" if column.align == "left" else "right"
        overflow: OverflowMethod = "fold" if is_verdict else "ellipsis"
        grid.add_column(
            column.short,
            justify=justify,
            width=widths[k],
            no_wrap=not is_verdict,
            overflow=overflow,
        )
    for row, mark in zip_longest(rows, marks, fillvalue=""):
        *cells, last = (row[k] for k in kept)
        grid.add_row(*(Text(cell) for cell in cells), Text(last, style=COLOURS.get(mark, "")))
    return grid


def _in_short(table: Table) -> Grid:
    """A table of the report in its short form; marks colour the last cell of their row."""
    made = Grid(
        title=_plain(table.short),
        title_justify="left",
        title_style="italic",
        box=SIMPLE,
        pad_edge=False,
    )
    kept = [k for k, column in enumerate(table.columns) if column.short]
    floors = _least_widths(table, kept)
    for k, column in ((k, table.columns[k]) for k in kept):
        if column.align == "left" and table.marks and k == kept[-1]:
            made.add_column(column.short, overflow="fold", width=floors[k])
        elif column.align == "left":
            made.add_column(
                column.short, overflow="fold" if table.marks else "ellipsis", min_width=floors[k]
            )
        else:
            made.add_column(column.short, justify="right", no_wrap=True, overflow="fold")
    for row, mark in zip_longest(table.rows[:MOST_ROWS], table.marks[:MOST_ROWS], fillvalue=""):
        *cells, last = (row[k] for k in kept)
        made.add_row(*(Text(cell) for cell in cells), Text(last, style=COLOURS.get(mark, "")))
    if len(table.rows) > MOST_ROWS:
        made.caption = f"and {len(table.rows) - MOST_ROWS} more rows in the report"
    return made


def _least_widths(table: Table, kept: list[int]) -> dict[int, int]:
    """Letters that each column keeps: numbers are never cut, and no word of a last column with verdicts.

    Other words keep fewer than LONGEST_WORD where the table does not fit into WIDTH otherwise.
    """
    widths = dict[int, int]()
    for k in kept:
        cells = [table.columns[k].short, *(row[k] for row in table.rows[:MOST_ROWS])]
        words = (
            cells
            if table.columns[k].align != "left"
            else [word for cell in cells for word in cell.split()]
        )
        widths[k] = max(map(len, words), default=0)
    is_cut = {
        k: table.columns[k].align == "left" and not (table.marks and k == kept[-1]) for k in kept
    }
    for longest in range(LONGEST_WORD, SHORTEST_WORD - 1, -1):
        floors = {k: min(width, longest) if is_cut[k] else width for k, width in widths.items()}
        if sum(floors.values()) + GAP * len(floors) - 1 <= WIDTH:
            break
    return floors


def _plain(text: str) -> str:
    """Subscripts as they are written on one line: tau_C."""
    return text.replace("_{", "_").replace("}", "")


@contextmanager
def progress() -> Iterator[Progress]:
    """A progress indicator on the error stream that shows what is being done; nothing where that is no terminal."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda what, share: bar.update(task, description=escape(what), completed=share)
