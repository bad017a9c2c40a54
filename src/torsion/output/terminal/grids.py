"""Tables and sentences on the terminal: words may be cut, numbers never."""

from itertools import zip_longest

from rich.box import SIMPLE
from rich.console import OverflowMethod, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from torsion.output.blocks import Block, Paragraph, Points, Table

COLOURS = {
    "pass": "green",
    "fail": "bold red",
    "not kept": "bold red",
    "outside": "yellow",
    "note": "yellow",
    "plain": "",
}
MOST_ROWS = 12


def grid(title: str, *columns: tuple[str, str]) -> Grid:
    """An empty table; words may be cut, numbers never."""
    made = Grid(
        title=title, title_justify="left", title_style="italic", header_style="bold", box=SIMPLE, pad_edge=False
    )
    for name, side in columns:
        right = side == ">"
        fold: OverflowMethod = "fold" if right else "ellipsis"
        made.add_column(name, justify="right" if right else "left", no_wrap=right, overflow=fold)
    return made


def filled(made: Grid, rows: list[list[str]]) -> Grid:
    """The table with its rows, as many of them as can be read at a glance."""
    for row in rows[:MOST_ROWS]:
        made.add_row(*(Text(cell) for cell in row))
    if len(rows) > MOST_ROWS:
        made.caption = f"and {len(rows) - MOST_ROWS} more rows in the report"
    return made


def in_short(table: Table) -> Grid:
    """A table of the report in its short form; marks colour the last cell of their row."""
    kept = [k for k, column in enumerate(table.columns) if column.short]
    heads = [(table.columns[k].short, "<" if table.columns[k].align == "left" else ">") for k in kept]
    made = grid(plain(table.short), *heads)
    for row, mark in zip_longest(table.rows[:MOST_ROWS], table.marks[:MOST_ROWS], fillvalue=""):
        *cells, last = (row[k] for k in kept)
        made.add_row(*(Text(cell) for cell in cells), Text(last, style=COLOURS.get(mark, "")))
    if len(table.rows) > MOST_ROWS:
        made.caption = f"and {len(table.rows) - MOST_ROWS} more rows in the report"
    return made


def printed(block: Block) -> RenderableType:
    """A sentence or a list of the conclusion."""
    match block:
        case Paragraph(text=text, kind=kind):
            return Text(plain(text), style=COLOURS[kind])
        case Points(items=items):
            return Text("\n".join(f"- {plain(item)}" for item in items))
        case _:
            return Text("")


def plain(text: str) -> str:
    """Subscripts as they are written on one line: tau_C."""
    return text.replace("_{", "_").replace("}", "")
