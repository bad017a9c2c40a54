"""Tables and sentences on the terminal: words may be cut, numbers never."""

from itertools import zip_longest

import numpy as np
from rich.box import SIMPLE
from rich.console import OverflowMethod, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from torsion.findings import Findings
from torsion.report.blocks import Block, Paragraph, Points, Table
from torsion.report.numbers import given, number, rpm
from torsion.rules.verdict_line import Checks

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


def tabled(table: Table, title: str, *columns: int) -> Grid:
    """A table of the report, of it these columns (default: all); marks colour the last cell of their row.

    A unit stands at the first of the neighbours that have it.
    """
    kept, heads, unit = columns or tuple(range(len(table.columns))), list[tuple[str, str]](), ""
    for head in (table.columns[k] for k in kept):
        is_new, unit = head.unit not in ("", unit), head.unit
        heads.append((f"{head.title}, {unit}" if is_new else head.title, "<" if head.align == "left" else ">"))
    made = grid(title, *heads)
    for row, mark in zip_longest(table.rows[:MOST_ROWS], table.marks[:MOST_ROWS], fillvalue=""):
        *cells, last = (row[k] for k in kept)
        made.add_row(*(Text(cell) for cell in cells), Text(last, style=COLOURS.get(mark, "")))
    if len(table.rows) > MOST_ROWS:
        made.caption = f"and {len(table.rows) - MOST_ROWS} more rows in the report"
    return made


def verdicts(findings: Findings) -> Grid:
    """The checks in a line each."""
    heads = (("verdict", "<"), ("component", "<"), ("check", "<"), ("value", ">"), ("limit", ">"), ("unit", "<"))
    made = grid("Checks, each at its worst point", *heads, ("at rpm", ">"), ("limit from", "<"))
    for check in findings.need(Checks).lines:
        limit = "none" if np.isnan(check.limit) else ("≥ " if check.at_least else "") + given(check.limit, 4)
        unit = check.unit.replace("mm2", "mm²").replace("s2", "s²")
        word = Text(check.verdict.upper(), style=COLOURS[check.verdict])
        value = "no answer" if np.isinf(check.value) else number(check.value, 4)
        cells = (check.where, check.clause, value, limit, unit, rpm(check.speed, 4), check.standing)
        made.add_row(word, *(Text(cell) for cell in cells))
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
