"""The blocks that a report is made of; every renderer prints the same list, the terminal those with a short form.

Texts may hold `_{x}` for a subscript; names and values of the scene stand in cells, where nothing is interpreted.
"""

import cmath
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, Literal

import numpy as np

from torsion.output.figures.figure import Figure
from torsion.output.numbers import (
    DIGITS,
    ROUNDING,
    Scale,
    cell,
    given,
    number,
    order,
    scale,
)
from torsion.output.records import values_of_records
from torsion.output.stored.scene import NO_VALUE

HEAD = re.compile(
    r"(?:(?P<name>[\w.@]+):(?: |$))?(?P<left>< ?)?(?P<title>.*?)(?: ?\[(?P<unit>[^\]]*)\])?"
    r"(?::(?P<digits>\d*)(?P<form>[gl+opsu?]*))?"
)
EMPTY, INFINITE = {None, ""}, "no finite value"
SHOWN = {  # unit of a column: the unit of its values, and the factor between them
    "rpm": ("rad/s", 30.0 / math.pi),
    "deg": ("rad", 180.0 / math.pi),
    "deg/min": ("rad**2/s", (180.0 / math.pi) * (30.0 / math.pi)),
    "%": ("", 100.0),
    "N/mm²": ("Pa", 1e-6),
    "bar": ("Pa", 1e-5),
    "µm": ("m", 1e6),
    "µrad": ("rad", 1e6),
    "mm": ("m", 1e3),
    "cm²": ("m**2", 1e4),
    "ms": ("s", 1e3),
    "°C": ("degC", 1.0),
    "kW": ("W", 1e-3),
    "GPa": ("Pa", 1e-9),
    "mm³": ("m**3", 1e9),
    "1/min": ("Hz", 60.0),
}
Value = str | bool | int | float | None  # of a cell


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
    """A column of a table: what stands in it, its unit, and how its values are written."""

    title: str
    unit: str = ""
    align: Literal["left", "right", "center"] = "right"
    short: str = ""  # its title on the terminal; '' where it is left out there
    digits: int = DIGITS  # significant ones of a number
    form: str = ""  # letters that `head` explains
    factor: float = 1.0  # from a value in SI units to the unit
    name: str = ""  # of the declared quantity that stands in it

    def text(self, value: Value) -> str:
        """Return a number in the unit to its digits; anything else in words."""
        if not isinstance(value, float):
            return cell(value)
        size = value * self.factor
        sign = "+" if "+" in self.form and size > 0 else ""
        return sign + (given if "g" in self.form else number)(size, self.digits)


@dataclass(frozen=True)
class Table:
    """A table of values; `marks` says of every row how it stands out ('' is plain)."""

    columns: tuple[Column, ...]
    values: tuple[
        tuple[Value, ...], ...
    ]  # (rows, columns); numbers in SI units, words as they stand
    caption: str = ""
    marks: tuple[str, ...] = ()  # "", "note" or a verdict
    short: str = ""  # its title on the terminal; '' where it does not stand there
    rows_in_summary: int = 0  # on the terminal without `-v`
    summary: str = ""  # sentence on the terminal without `-v`, in place of rows

    @cached_property
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """The texts that a page shows, (rows, columns)."""
        return tuple(
            tuple(column.text(value) for column, value in zip(self.columns, row, strict=True))
            for row in self.values
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
    """Return the columns of a table: 'mode: Mode | < Shaft -> | Critical speed [rpm]:6 -> rpm'.

    'mode:' names the quantity of a record, '<' marks words, which stand to the left, and ':6' are digits, behind them
    letters: g for an input value (no zeros that nobody wrote), + for a sign, l for files that a page leads to, o for an
    order, p for the phase of a complex number (without it the amplitude), s for 0 if rounding may be the value beside the
    largest of the column, u for words if no value is reliable, ? for no column if no row has a value. A value in SI units
    is shown in [rpm], one that is in rpm already in [=rpm]; in [~N m] with the largest prefix that leaves no such column
    of the table below 1. After '->' is the title on the terminal, by itself the same in small letters, with '~' for that
    unit, as in `short`.

    >>> head("< Shaft | Critical speed [rpm]:6 -> rpm")[1].text(math.pi)
    '30.0000'
    """
    columns = []
    for words in titles.split("|"):
        full, arrow, short = words.strip().partition(" ->")
        pieces = HEAD.fullmatch(full)
        assert pieces is not None  # every part of it may be missing
        name, unit = pieces["name"] or "", pieces["unit"] or ""
        title = pieces["title"] or name.replace("_", " ").capitalize()
        columns.append(
            Column(
                title,
                unit.lstrip("="),
                "left" if pieces["left"] else "right",
                short.strip() or (title.lower() if arrow else ""),
                digits=int(pieces["digits"] or DIGITS),
                form=pieces["form"] or "",
                factor=SHOWN[unit][1] if unit in SHOWN else 1.0,
                name=name,
            )
        )
    return tuple(columns)


def table(
    titles: str | tuple[Column, ...],
    rows: Iterable[Any],
    caption: str = "",
    *,
    marks: Iterable[str] = (),
    most: int | None = None,
    short: str = "",
    rows_in_summary: int = 0,
    summary: str = "",
) -> Table:
    """Return a table of values in SI units under the titles of `head`, at `most` so many of its rows.

    Where the titles name quantities, a row is a result that declares them or a place of its arrays (`along`), or a
    tuple of results, and then of the values of the columns that name none.

    >>> table("< Mode | Frequency [Hz] | Damping [%]:2", [("first", 12.5, 0.01), ("second", None, 1)]).rows
    (('first', '12.500', '1.0'), ('second', '–', '1'))
    """
    columns, records = head(titles) if isinstance(titles, str) else titles, list(rows)
    if most is not None and len(records) > most:
        caption, records = f"{caption}; the first {most} of {len(records)}", records[:most]
    if records and any(column.name for column in columns):
        # A phase has a unit of its own.
        named = [(column.name, "" if "p" in column.form else column.unit) for column in columns]
        units, records = values_of_records(named, records, SHOWN)
        columns = tuple(
            column if "p" in column.form else replace(column, unit=unit)
            for column, unit in zip(columns, units, strict=True)
        )
    if any(len(row) != len(columns) for row in records):
        raise ValueError(f"a row of the table '{caption}' does not have {len(columns)} cells")
    cells = [
        _plain(held, column)
        for held, column in zip(zip(*records, strict=True), columns, strict=False)
    ]
    cells = cells or [[] for _ in columns]
    kept = [
        (column, held)
        for column, held in zip(columns, cells, strict=True)
        if "?" not in column.form or not set(held) <= EMPTY
    ]

    # A prefix leaves the top of every column in its unit at 1 or more.
    prefixes = dict[str, Scale]()
    for unit in {column.unit for column, _ in kept if column.unit.startswith("~")}:
        tops = (
            max((abs(value) for value in held if isinstance(value, float)), default=0.0)
            for column, held in kept
            if column.unit == unit
        )
        prefixes[unit] = chosen = scale(unit[1:], [min(filter(None, tops), default=0.0)])
        short = short.replace("~", chosen.unit)
    shown = []
    for column, _ in kept:
        if (in_unit := prefixes.get(column.unit)) is None:
            shown.append(column)
        else:
            words, factor = column.short.replace("~", in_unit.unit), in_unit.factor
            shown.append(replace(column, unit=in_unit.unit, factor=factor, short=words))
    values = tuple(zip(*(held for _, held in kept), strict=True))
    summarised = short, rows_in_summary, summary
    return Table(tuple(shown), values, caption, tuple(marks)[:most], *summarised)


def _plain(values: Sequence[Any], column: Column) -> list[Value]:
    """Return the values of a column as a table keeps them: finite numbers, words, or None."""
    held = [value.item() if isinstance(value, np.generic) else value for value in values]
    if "s" in column.form or "p" in column.form:
        sizes = (abs(value) for value in held if isinstance(value, float | complex))
        largest = max(sizes, default=0.0)
        held = [
            0.0 if isinstance(value, float | complex) and abs(value) < ROUNDING * largest else value
            for value in held
        ]
    return [_cell(value, column.form) for value in held]


def _cell(value: Any, form: str) -> Value:
    if "p" in form:
        value = cmath.phase(value) if value else None
    elif isinstance(value, complex):
        value = abs(value)
    if "u" in form and (value is None or value == math.inf):
        return NO_VALUE if value is None else INFINITE
    if isinstance(value, float):
        return value if math.isfinite(value) else None if math.isnan(value) else number(value)
    if isinstance(value, Fraction) and "o" in form:
        return order(value)
    is_kept = isinstance(value, str | int | None) and not isinstance(value, Enum)
    return value if is_kept else cell(value)
