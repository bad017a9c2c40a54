"""One or two columns of numbers from a table whose head names their units, as text files of measurements have them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from torsion import units
from torsion.tables import MOST_ROWS, Cell, Table, head_of, table_text
from torsion.user_files import LARGEST_SIGNAL, LARGEST_TABLE


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
        why, hint = getattr(error, "strerror", error), "give a text file"
    else:
        if fault is None:
            return text
        why, hint = fault.message, fault.hint
    raise ValueError(f"'{file}' cannot be read: {why}", hint)


@lru_cache(maxsize=8)  # of variants of a train, which all read the same files
def _pairs(file: Path, text: str, columns: Columns) -> tuple[tuple[float, ...], ...]:
    table = Table(text, columns.most + 1)
    if not 3 <= len(table.rows) <= columns.most + 1:
        raise ValueError(
            f"'{file}' has {max(len(table.rows) - 1, 0)} rows",
            f"2 to {columns.most} rows below the units",
        )
    factors = _factors(file, table.rows[0], columns)
    table.read_signs(cell for row in table.rows[1:] for cell in row)
    for fault in table.faults:
        raise ValueError(f"'{file}', line {fault.line}: {fault.message}", fault.hint)
    rows = [_row(file, row, factors, columns, table) for row in table.rows[1:]]
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
        except units.UnitFault as fault:
            message = f"'{file}', line 1: '{cell.text}' has no unit of {unit}: {fault.message}"
            raise ValueError(message, f"the first line names the units: {columns.head}") from None
    return tuple(factors)


def _row(
    file: Path, row: Sequence[Cell], factors: tuple[float, ...], columns: Columns, table: Table
) -> tuple[float, ...]:
    where, count = f"'{file}', line {row[0].line}", len(row)
    if count != len(factors):
        decimals = "a point in decimals, or decimal commas and semicolons"
        hint = decimals if count > len(factors) else " and ".join(columns.names)
        raise ValueError(f"{where}: {count} columns, not {len(factors)}", hint)
    try:
        values = tuple(
            float(table.plain(cell.text)) * factor
            for cell, factor in zip(row, factors, strict=True)
        )
    except ValueError:
        what = "pair of numbers" if len(factors) > 1 else "number"
        written = f"{table.separator.strip()} ".join(cell.text for cell in row)
        raise ValueError(f"{where}: '{written}' is no {what}", columns.row) from None
    if not (all(map(math.isfinite, values)) and values[0] >= columns.least):
        raise ValueError(f"{where}: {columns.meant} is meant", columns.row)
    return values
