"""The one reader of tables that users hand in: cells with line and column, a head with units, and decimal signs.

Columns are parted by tabs, semicolons or commas, which the first line shows or says (`sep=;`). Empty lines, and lines
that begin with `#`, say nothing. Cells in double quotes may hold separators, breaks of lines, and quotes written twice.

A table whose cells are parted by semicolons or tabs may have decimal points or decimal commas. `40.000` is 40 in one
language and 40 000 in another: what the other numbers of the table do not decide is refused.
"""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

from torsion import units
from torsion.errors import Fault, Refusal
from torsion.user_files import LARGEST_SIGNAL, LARGEST_TABLE, REORDERING, printable, read_file

MOST_ROWS = 100_000
_NO_VALUE = r"#(?:[A-Z]+[!?]|DIV/0!|N/A|NV)"  # what a spreadsheet writes for a formula without one
FORMULA_ERROR = re.compile(rf"{_NO_VALUE}|Err:\d+|##+")
_COMMENT = re.compile(rf' *"?#(?!(?:{_NO_VALUE[1:]})"?[ \t]*(?:[\t;,\r\n]|$))')
_STATED = re.compile(r'"?sep=(.)"?[ \t]*(?:\r\n?|\n)', re.IGNORECASE)
_BREAK = re.compile(r"\r\n?|\n")
_NUL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f]")
_HEAD = re.compile(r"(.*?)\s*[\[(](.+)[\])]")  # inertia [kg*m**2]

_COMMA = re.compile(r"([-+]?[0-9]*),([0-9]+(?:[eE][-+]?[0-9]+)?)(?![0-9,.])")  # a number begins
_POINT = re.compile(r"[-+]?[0-9]*\.[0-9]+(?:[eE][-+]?[0-9]+)?(?![0-9,.])")
_THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2}[.,][0-9]{3}")
_FIGURE = re.compile(r"(?<![\w.,])[-+]?[0-9.,]*[0-9](?:[eE][-+]?[0-9]+)?")
_JOINED = re.compile(r"(?<=[0-9]),(?=[0-9])")  # no blank shows whether it parts two numbers or one


class Cell(NamedTuple):
    """The text between two separators without blanks around it, and where it begins (from 1)."""

    text: str
    line: int
    column: int


Mark = tuple[Cell, str]  # a number with a decimal or thousands mark, and its cell


def table_text(file: Path, largest: int = LARGEST_TABLE) -> tuple[str, Fault | None]:
    """The text of a file without a byte order mark, and what is wrong with its encoding; raises OSError."""
    content, hint, before = read_file(file, largest), "save it as `CSV UTF-8`", ""
    try:
        text = content.decode().removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        text, before = content.decode(errors="replace"), content[: error.start].decode()
        message = "the file is not UTF-8 text"
        if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
            text, message = "", "the file is UTF-16 text"
    else:
        if not (sign := _NUL.search(text) or REORDERING.search(text)):
            return text, None
        message, before = f"the character U+{ord(sign[0]):04X} is not allowed", text[: sign.start()]
        hint = "save the sheet as CSV, not as a workbook"
    lines = _BREAK.split(before)
    return text, Fault((), message, hint, line=len(lines), column=len(lines[-1]) + 1)


def first_comment(text: str) -> str:
    """What the first line says that begins with `#`; empty where none does."""
    comment = next((line for line in _BREAK.split(text) if _COMMENT.match(line)), "")
    return comment.strip(' "#\t,;').strip()


def head_of(text: str) -> tuple[str, str]:
    """The name and the unit of a column from the text of its first cell; empty where it has none.

    >>> head_of("stiffness [kN*m/rad]"), head_of("torque (N*m)"), head_of("name")
    (('stiffness', 'kN*m/rad'), ('torque', 'N*m'), ('name', ''))
    """
    head = _HEAD.fullmatch(text)
    return (head[1].strip(), head[2].strip()) if head else (text.strip(), "")


def unit_fault(written: str, unit: str) -> Refusal | None:
    """What is wrong with a unit of a column where one of `unit` is expected."""
    try:
        units.to_si(f"1 {written}", unit)
    except Refusal as fault:
        return fault
    return None


class Table:
    """The rows of a table that say something, with every fault of its text located; quotes are resolved.

    >>> table = Table("time [s];torque [kN*m]\\n0,5;1,25\\n")
    >>> table.read_signs(table.rows[1])
    >>> table.separator, [table.plain(cell.text) for cell in table.rows[1]]
    (';', ['0.5', '1.25'])
    """

    def __init__(self, text: str, most_rows: int = MOST_ROWS) -> None:
        self.faults: list[Fault] = []
        self.has_commas = False  # no comma parts the cells, so that it may be a decimal sign
        self._has_points = False  # some number has a decimal point
        stated = _STATED.match(text)
        self.separator = stated[1] if stated else ","
        for line in () if stated else _BREAK.split(text):
            # The first line that says something has a tab, else a semicolon, else a comma.
            plain = re.sub(r'"[^"]*"', "", line)
            if plain.strip(" \t,;") and not _COMMENT.match(line):
                self.separator = next((sign for sign in "\t;" if sign in plain), ",")
                break
        plain = rf"[^{re.escape(self.separator)}\r\n]*"
        self._cell = re.compile(rf' *"((?:[^"]|"")*)" *({plain})|({plain})')
        self.rows: list[list[Cell]] = []
        for row in self._rows(text, stated.end() if stated else 0):
            if any(map(itemgetter(0), row)):
                self.rows.append(row)
            if len(self.rows) > most_rows:
                self.fault(Cell("", 1, 1), f"the table has more than {most_rows} rows")
                break

    def fault(self, cell: Cell, message: str, hint: str = "") -> None:
        """Note what is wrong with a cell, and what would be right."""
        fault = Fault((), printable(message, 200), hint, line=cell.line, column=cell.column)
        self.faults.append(fault)

    def _rows(self, text: str, start: int) -> Iterator[list[Cell]]:
        """Every row with its cells, from a position in the text on; a comment has none."""
        line = 1 + len(_BREAK.findall(text, 0, start))
        while start <= len(text):
            row, position = list[Cell](), start
            is_comment = _COMMENT.match(text, start)
            while written := None if is_comment else self._cell.match(text, position):
                quoted, following, words = written.groups()
                column = position - start + 1
                if quoted is None:
                    if words.lstrip().startswith('"'):
                        self.fault(Cell("", line, column), "this quote is not closed")
                    blanks = len(words) - len(words.lstrip())
                    row.append(Cell(words.strip(), line, column + blanks))
                else:
                    if following:
                        hint = "quotes within a cell are doubled"
                        self.fault(Cell("", line, column), "text follows the closing quote", hint)
                    inner = _BREAK.sub(" ", quoted.replace('""', '"'))
                    row.append(Cell(inner.strip(), line, column))
                    for ending in _BREAK.finditer(text, position, written.end(1)):
                        line, start = line + 1, ending.end()
                position = written.end() + 1
                if text[written.end() : position] != self.separator:
                    break
            yield row
            behind = _BREAK.search(text, start if is_comment else position - 1)
            start = behind.end() if behind else len(text) + 1
            line += 1

    def plain(self, text: str) -> str:
        """A number with a decimal point for its decimal comma; of a list in brackets every number."""
        if not self.has_commas:
            return text
        if text[:1] in ("[", "{"):
            return _JOINED.sub(".", text).replace(";", ",") if ";" in text else text
        return _COMMA.sub(r"\1.\2", text, count=1) if _COMMA.match(text) else text

    def read_signs(self, cells: Iterable[Cell]) -> None:
        """Find the decimal sign of the table from the cells that may hold numbers; note what leaves it open."""
        self.has_commas = self.separator != ","
        if not self.has_commas:
            return
        cells = list(cells)
        has_both = all(any(sign in cell.text for cell in cells) for sign in ".,")
        points, commas, marked = list[Mark](), list[Mark](), list[Mark]()
        for cell in cells:
            # The number that a cell begins with, or those in its brackets, where semicolons part them.
            is_list = cell.text[:1] in ("[", "{")
            numbers = _FIGURE.finditer(cell.text) if ";" in cell.text else ()
            for match in numbers if is_list else filter(None, [_FIGURE.match(cell.text)]):
                figure = match[0]
                if _POINT.fullmatch(figure):
                    points.append((cell, figure))
                elif _COMMA.fullmatch(figure):
                    commas.append((cell, figure))
                if figure.count(".") + figure.count(",") == 1:
                    marked.append((cell, figure))
            # Of one sign alone the first number that is no thousands decides: signals have millions.
            if not has_both and marked and not _THOUSANDS.fullmatch(marked[-1][1]):
                break
        self._has_points = bool(points)
        if commas and points:
            rarer, usual = sorted((points, commas), key=len)
            (cell, figure), (opposite, sign) = rarer[0], usual[0]
            message = f"`{figure}` here, and `{sign}` in line {opposite.line}: two decimal signs in one table"
            hint = "write all numbers with one of them, and no marks between thousands"
            self.fault(cell, message, hint)
        elif marked and all(_THOUSANDS.fullmatch(figure) for _, figure in marked):
            cell, figure = marked[0]
            message = "may be thousands or decimals: every such number of this table has three digits after its mark"

            # A number like 40.000 without its mark, and in a way that it can only be a decimal.
            short = figure.rstrip("0")
            decimal = f"{short}0" if short[-1] in ".," or short == figure else short
            hint = f"write {re.sub('[.,]', '', figure)} or {decimal}"
            self.fault(cell, f"`{figure}` {message}", hint)

    def refuse_joined(self, cell: Cell) -> bool:
        """Note a list of which a comma may part two numbers, or be the decimal sign of one."""
        is_plain = (
            not self.has_commas or self._has_points or any(sign in cell.text for sign in ".;")
        )
        if is_plain or cell.text[:1] != "[" or not _JOINED.search(cell.text):
            return False
        inner = cell.text.strip("[] ")
        parts = re.split(r",\s+", inner) if re.search(r",\s", inner) else inner.split(",")
        is_pair = len(parts) == 2 and ", " not in inner
        number = f"{inner} for a number, " if is_pair else ""
        ways = "one number or a list" if is_pair else "read in two ways"
        hint = f'write {number}"[{"; ".join(parts)}]" for a list'
        self.fault(cell, f"`{cell.text}` may be {ways}", hint)
        return True


@dataclass(frozen=True)
class Columns:
    """What the columns are, and an example of the first line and of a row."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    head: str
    row: str
    meant: str  # what a row must be: "a finite torque at a finite time"
    least: float = -math.inf  # value of the first column
    is_loop: bool = False  # the first column rises and falls
    most: int = MOST_ROWS


def pairs(file: Path, columns: Columns) -> tuple[tuple[float, ...], ...]:
    """The values of every row in SI, those of the first column ascending but for a loop.

    Raises ValueError with two arguments, what is wrong and what would be right, where it is no such file.
    """
    return _pairs(file, _text(file, columns), columns)


def named(file: Path, choices: Sequence[Columns]) -> Columns:
    """The choice whose units the head of a file names; where none is, the first: its faults then say so."""
    try:
        table = Table(_text(file, choices[0]), choices[0].most)
    except ValueError:
        return choices[0]
    for columns in choices:
        try:
            _factors(file, table.rows[0], columns)
        except (ValueError, LookupError):
            continue
        return columns
    return choices[0]


def _text(file: Path, columns: Columns) -> str:
    largest = LARGEST_TABLE if columns.most <= MOST_ROWS else LARGEST_SIGNAL
    try:
        text, fault = table_text(file, largest)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", error)
        raise ValueError(f"'{file}' cannot be read: {why}", "give a text file") from None
    if fault is not None:
        raise ValueError(f"'{file}' cannot be read: {fault.message}", fault.hint)
    return text


@lru_cache(maxsize=8)  # of variants of a train, which all read the same files
def _pairs(file: Path, text: str, columns: Columns) -> tuple[tuple[float, ...], ...]:
    table = Table(text, columns.most + 1)
    count = len(table.rows) - 1
    if not 2 <= count <= columns.most:
        hint = f"2 to {columns.most} rows below the units"
        raise ValueError(f"'{file}' has {max(count, 0)} rows", hint)
    factors = _factors(file, table.rows[0], columns)
    table.read_signs(cell for row in table.rows[1:] for cell in row)
    for fault in table.faults:
        raise ValueError(f"'{file}', line {fault.line}: {fault.message}", fault.hint)
    rows = list[tuple[float, ...]]()
    for row in table.rows[1:]:
        where = f"'{file}', line {row[0].line}"
        if len(row) != len(factors):
            decimals = "a point in decimals, or decimal commas and semicolons"
            hint = decimals if len(row) > len(factors) else " and ".join(columns.names)
            raise ValueError(f"{where}: {len(row)} columns, not {len(factors)}", hint)
        numbers = zip((table.plain(cell.text) for cell in row), factors, strict=True)
        try:
            rows.append(tuple(float(number) * factor for number, factor in numbers))
        except ValueError:
            what = "pair of numbers" if len(factors) > 1 else "number"
            written = f"{table.separator.strip()} ".join(cell.text for cell in row)
            raise ValueError(f"{where}: '{written}' is no {what}", columns.row) from None
        if not (all(map(math.isfinite, rows[-1])) and rows[-1][0] >= columns.least):
            raise ValueError(f"{where}: {columns.meant} is meant", columns.row)
    for number in range(1, 0 if columns.is_loop else len(rows)):
        if rows[number][0] <= rows[number - 1][0]:
            first, line = columns.names[0], table.rows[number + 1][0].line
            message = f"'{file}', line {line}: the {first} does not rise"
            raise ValueError(message, f"{first}s ascend")
    return tuple(rows)


def _factors(file: Path, head: Sequence[Cell], columns: Columns) -> tuple[float, ...]:
    """SI per unit of every column, which stands in brackets behind a name, or alone."""
    if len(head) != len(columns.names):
        message = f"'{file}' has {len(head)} columns in line 1, not {len(columns.names)}"
        raise ValueError(message, columns.head)
    factors = []
    for cell, unit in zip(head, columns.units, strict=True):
        name, bracketed = head_of(cell.text)
        word = bracketed or name
        try:
            factors.append(units.to_si(f"1 {word}" if word else "", unit))
        except Refusal as fault:
            message = f"'{file}', line 1: '{cell.text}' has no unit of {unit}: {fault.message}"
            raise ValueError(message, f"the first line names the units: {columns.head}") from None
    return tuple(factors)
