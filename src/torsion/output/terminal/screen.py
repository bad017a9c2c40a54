"""A report on the terminal: its blocks that have a short form, narrow enough for 80 columns."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar
from rich.text import Text

from torsion.findings import Progress
from torsion.output.blocks import Heading, Paragraph, Points, Table
from torsion.output.document import Document
from torsion.output.renderers import OUTPUTS
from torsion.output.terminal.grids import in_short, printed


def show(document: Document, folder: Path | None = None, console: Console | None = None) -> None:
    """Print the report, and where its page is."""
    screen = console or Console()
    for item in OUTPUTS["terminal"](document):
        screen.print(item)
    done = document.source.plan.done
    if done:
        screen.print(Text(f"{len(done)} steps in {sum(line.seconds for line in done):.2f} s"))
    if folder is not None:
        screen.print(Text(f"Report: {folder / document.report.stem}.html"))


def screen(document: Document) -> list[RenderableType]:
    """Everything that is printed; the verdict last, where the eye is."""
    first: list[RenderableType] = [Text(document.cover.subtitle, style="bold")]
    last: list[RenderableType] = []
    chapter = first
    for block in (item.block for item in document.body):
        match block:
            case Heading(level=1, at_end=at_end):
                chapter = last if at_end else first
            case Table(short=title) if title and block.rows:
                chapter.append(in_short(block))
            case Paragraph(brief=True) | Points(brief=True):
                chapter.append(printed(block))
    return [*first, *last]


@contextmanager
def progress() -> Iterator[Progress]:
    """A progress indicator on the error stream that shows what is being done; nothing where that is no terminal."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda what, share: bar.update(task, description=escape(what), completed=share)
