"""A report on the terminal: its blocks that have a short form, narrow enough for 80 columns.

Names may be wrapped, numbers never.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.table import Table as Grid
from rich.text import Text

from torsion.findings import Progress
from torsion.output.blocks import Box, Heading, Paragraph, Points, Table
from torsion.output.document import Document
from torsion.user_files import without_controls

COLOURS = {
    "pass": "green",
    "fail": "bold red",
    "not kept": "bold red",
    "not judged": "yellow",
    "restricted": "yellow",
    "note": "yellow",
}
MOST_ROWS = 12  # of a table
MOST_TABLES, MOST_SENTENCES, MOST_LINES = 2, 5, 25  # in the summary
LAST_LINES = 2  # of the work, and of where the report is
HEADS = (  # of the box, in the summary
    "Sweep",
    "Design",
    "Barred ranges",
    "Restrictions",
    "Not computed",
    "Not confirmed",
    "For information",
)
SHORTEST_NAME, LONGEST_VERDICT = 4, 12  # letters; the longest word of "! PASS with restrictions"
REDRAWN = 0.1  # s between two drawings of the progress
WIDTH, GAP = 80, 2  # columns of a narrow terminal; between two columns of a table


def show(
    document: Document,
    folder: Path | None = None,
    console: Console | None = None,
    *,
    is_verbose: bool = True,
) -> None:
    """Print the report, or its summary of at most 25 lines if not verbose, and where its page is."""
    printed = console or Console()
    for item in (screen if is_verbose else summary)(document, printed.width):
        printed.print(item)
    if document.ending.work:
        hint = "" if is_verbose else "; all tables: -v, or the report"
        printed.print(Text(document.ending.work + hint))
    if folder is not None:
        printed.print(Text(without_controls(f"Report: {folder / document.report.stem}.html")))


def summary(document: Document, width: int = WIDTH) -> list[RenderableType]:
    """Return the verdict, its worst rows, and frequencies, each in few lines; the verdict first."""
    items, sentences, tables = _title(document), list[str](), list[tuple[Table, int]]()
    lines = len(items) + LAST_LINES
    for block in (item.block for item in document.body):
        match block:
            case Box(sign=sign, text=text, kind=kind, lines=remarks):
                headline = _in_two_lines(f"{sign} {text}", width)
                items.append(Text(headline, style=f"bold {COLOURS[kind]}"))
                lines += len(headline.splitlines())
                sentences += [f"{head}: {_plain(line)}" for head, line in remarks if head in HEADS]
            case Table(summary=words) if words:
                sentences.append(words)
            case Table(rows_in_summary=rows) if rows and block.rows:
                tables.append((block, rows))
    last = [_in_two_lines(text, width) for text in sentences[:MOST_SENTENCES]]

    # The rows of the tables have what the sentences and the heads of the tables leave.
    tables = tables[:MOST_TABLES]
    room = MOST_LINES - lines - len(tables) - sum(len(text.splitlines()) for text in last)
    for table, rows in tables:
        grid, height = _grid(table, rows, width, most_lines=room)
        items.append(grid)
        room -= height
    return [*items, *map(Text, last)]


def screen(document: Document, width: int = WIDTH) -> list[RenderableType]:
    """Return everything that is printed; the verdict last, where the eye is: of several chapters at the end the first."""
    first = _title(document)
    # Of each chapter at the end its tables, then its sentences.
    ends = list[tuple[list[RenderableType], list[RenderableType]]]()
    tables = sentences = first
    for block in (item.block for item in document.body):
        match block:
            case Heading(level=1, at_end=at_end):
                if at_end:
                    ends.append(([], []))
                tables, sentences = ends[-1] if at_end else (first, first)
            case Table(short=title) if title and block.rows:
                tables += [Text(_plain(title), style="italic"), _grid(block, MOST_ROWS, width)[0]]
                if (omitted := len(block.rows) - MOST_ROWS) > 0:
                    tables.append(Text(f"and {omitted} more rows in the report", style="italic"))
                tables.append(Text())
            case Box(sign=sign, text=text, kind=kind, lines=lines):
                sentences.append(Text(f"{sign} {text}", style=f"bold {COLOURS[kind]}"))
                sentences += [Text(f"{head}: {_plain(line)}") for head, line in lines]
            case Paragraph(text=text, kind=kind, brief=True):
                sentences.append(Text(_plain(text), style=COLOURS.get(kind, "")))
            case Points(items=items, brief=True):
                sentences += [Text(f"- {_plain(item)}") for item in items]
    return first + [item for chapter in reversed(ends) for part in chapter for item in part]


def _title(document: Document) -> list[RenderableType]:
    """Return the name of the model, and number and revision of the document."""
    cover = document.cover
    title: list[RenderableType] = [Text(cover.subtitle, style="bold")]
    if cover.identity not in ("", cover.subtitle):
        title.append(Text(f"{cover.identity}, {cover.origin}"))
    return title


def _in_two_lines(text: str, width: int) -> str:
    """Return what fits into two lines; '…' stands for the rest."""
    lines = wrap(text, width)
    if len(lines) > 2:
        rest = " ".join(lines[1:])
        lines = [lines[0], f"{rest[: width - 1].rstrip()}…"]
    return "\n".join(lines)


def _grid(
    table: Table, row_count: int, width: int, *, most_lines: int | None = None
) -> tuple[Grid, int]:
    """Return the first rows of a table, and how many lines they have; marks colour the last cell of their row.

    Numbers stay whole. Names are wrapped to the width, short ones last; if `most_lines` are given, names are cut after
    two lines, and rows that do not fit are left out.
    """
    kept = [k for k, column in enumerate(table.columns) if column.short]
    rows, marks = table.rows[:row_count], table.marks[:row_count]
    widths = {k: max(len(table.columns[k].short), *(len(row[k]) for row in rows)) for k in kept}
    is_name = {k: table.columns[k].align == "left" for k in kept}
    if marks and is_name[kept[-1]]:
        widths[kept[-1]], is_name[kept[-1]] = min(widths[kept[-1]], LONGEST_VERDICT), False
    names = sorted((k for k in kept if is_name[k]), key=lambda k: widths[k])
    room = width - sum(widths[k] for k in kept if not is_name[k]) - GAP * (len(kept) - 1)
    for count, k in zip(range(len(names), 0, -1), names, strict=True):
        widths[k] = min(widths[k], max(room // count, SHORTEST_NAME))
        room -= widths[k]

    grid = Grid(box=None, padding=(0, GAP, 0, 0), pad_edge=False, header_style="italic")
    for k in kept:
        column = table.columns[k]
        grid.add_column(
            column.short,
            justify="left" if column.align == "left" else "right",
            width=widths[k],
            no_wrap=column.align != "left",
            overflow="fold",
        )
    lines = 0
    for row, mark in zip_longest(rows, marks, fillvalue=""):
        texts = {k: row[k] for k in kept}
        if most_lines is not None:
            texts |= {k: _in_two_lines(row[k], widths[k]) for k in kept if is_name[k]}
        height = max(len(wrap(text, widths[k])) for k, text in texts.items())
        if most_lines is not None and lines + height > most_lines:
            break
        lines += height
        *cells, last = texts.values()
        grid.add_row(*map(Text, cells), Text(last, style=COLOURS.get(mark, "")))
    return grid, lines


def _plain(text: str) -> str:
    """Return subscripts as they are written on one line: tau_C."""
    return text.replace("_{", "_").replace("}", "")


@contextmanager
def progress() -> Iterator[Progress]:
    """Show on the error stream what is being done; nothing where that is no terminal.

    No thread draws it: beside one, a process begins no copies of itself to share work out.
    """
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    console, drawn = Console(stderr=True), 0.0
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    is_off = not console.is_terminal
    with Bar(*columns, console=console, transient=True, disable=is_off, auto_refresh=False) as bar:
        task = bar.add_task("", total=1.0)

        def show(what: str, share: float) -> None:
            nonlocal drawn
            now = time.monotonic()
            is_due = now - drawn > REDRAWN
            bar.update(task, description=escape(what), completed=share, refresh=is_due)
            drawn = now if is_due else drawn

        yield show
