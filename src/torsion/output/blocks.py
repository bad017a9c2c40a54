"""The blocks that a report is made of; every renderer prints the same list, the terminal those with a short form.

Texts may hold `_{x}` for a subscript; names and values of the scene stand in cells, where nothing is interpreted.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

from torsion.output.figures.figure import Figure
from torsion.output.numbers import NONE, cell


@dataclass(frozen=True)
class Heading:
    """A chapter (level 1) or a section of one (level 2); numbers are given by the renderer."""

    text: str
    level: Literal[1, 2] = 1
    at_end: bool = False  # on the terminal this chapter stands last, where the eye is


@dataclass(frozen=True)
class Paragraph:
    """Plain sentences; the kind sets how much they stand out."""

    text: str
    kind: Literal["plain", "note", "pass", "fail"] = "plain"
    brief: bool = False  # stands on the terminal too


@dataclass(frozen=True)
class Points:
    """A list of short statements."""

    items: tuple[str, ...]
    brief: bool = False


@dataclass(frozen=True)
class Column:
    """A column of a table: what stands in it and its unit."""

    title: str
    unit: str = ""
    align: Literal["left", "right", "center"] = "right"
    short: str = ""  # its title on the terminal; '' where it is left out there
    is_files: bool = False  # its cells name files beside the report, to which they lead on a page


@dataclass(frozen=True)
class Table:
    """A table of texts; `marks` says of every row how it stands out ('' is plain)."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    marks: tuple[str, ...] = ()  # "", "note" or a verdict
    short: str = ""  # its title on the terminal; '' where it does not stand there
    rows_in_summary: int = 0  # on the terminal without `-v`
    summary: str = ""  # sentence on the terminal without `-v`, in place of rows

    def __post_init__(self) -> None:
        if any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(
                f"a row of the table '{self.caption}' does not have {len(self.columns)} cells"
            )


@dataclass(frozen=True)
class KeyValues:
    """Pairs of a label and its value."""

    pairs: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Verbatim:
    """Text as it stands, with its line numbers."""

    text: str


@dataclass(frozen=True)
class Box:
    """What matters most, in a box: a sign and words in large letters, then texts under short titles."""

    sign: str
    text: str
    kind: Literal["pass", "fail", "note"]
    lines: tuple[tuple[str, str], ...]  # title, text


@dataclass(frozen=True)
class PageEnd:
    """The first page ends here; what is stated of the report itself follows."""


Block = Box | PageEnd | Heading | Paragraph | Points | Table | KeyValues | Figure | Verbatim


@lru_cache
def head(titles: str) -> tuple[Column, ...]:
    """Columns of a table: '< Shaft -> | Critical speed [rpm] -> rpm'; '<' marks words, which stand to the left.

    Behind '->' is the title on the terminal, by itself the same in small letters.

    >>> head("< Shaft | Critical speed [rpm] -> rpm")[1]
    Column(title='Critical speed', unit='rpm', align='right', short='rpm', is_files=False)
    """
    found = []
    for words in titles.split("|"):
        full, arrow, short = words.strip().partition(" ->")
        title, _, unit = full.removesuffix("]").partition(" [")
        name = title.removeprefix("<").strip()
        align: Literal["left", "right"] = "left" if title.startswith("<") else "right"
        found.append(Column(name, unit, align, short.strip() or (name.lower() if arrow else "")))
    return tuple(found)


def table(
    titles: str | tuple[Column, ...],
    rows: Iterable[Sequence[Any]],
    caption: str = "",
    *,
    marks: Iterable[str] = (),
    short: str = "",
    rows_in_summary: int = 0,
    summary: str = "",
) -> Table:
    """A table of values, which stand in it as `cell` shows them, under the titles of `head` or columns.

    >>> table("< Mode | Frequency [Hz] | Nodes", [("first", 12.5, 1), ("second", None, 2)]).rows
    (('first', '12.500', '1'), ('second', '–', '2'))
    """
    columns = head(titles) if isinstance(titles, str) else titles
    cells = tuple(tuple(map(cell, row)) for row in rows)
    return Table(columns, cells, caption, tuple(marks), short, rows_in_summary, summary)


def filled(made: Table) -> Table:
    """The same table without the columns that have no value in any row.

    >>> filled(table("< Mode | Frequency [Hz] | Cost", [("first", 12.5, None), ("second", 13.0, None)])).rows
    (('first', '12.500'), ('second', '13.000'))
    """
    kept = [
        k
        for k in range(len(made.columns))
        if not made.rows or any(row[k] != NONE for row in made.rows)
    ]
    rows = tuple(tuple(row[k] for k in kept) for row in made.rows)
    return replace(made, columns=tuple(made.columns[k] for k in kept), rows=rows)


def texts(title: str, short: str = "") -> Column:
    """A column of words."""
    return Column(title, align="left", short=short)


def on_terminal(blocks: Iterable[Block]) -> list[Block]:
    """The same blocks, sentences among them on the terminal too."""
    return [
        replace(one, brief=True) if isinstance(one, Paragraph | Points) else one for one in blocks
    ]
