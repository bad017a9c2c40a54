"""One or two columns of numbers from a text file whose first line names their units."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from torsion import units
from torsion.user_files import LARGEST_SIGNAL, LARGEST_TABLE, read_file

MOST_ROWS = 100_000
_UNIT = re.compile(r".*[\[(](.+)[\])]\s*|(.*)")  # time [ms], torque (kN*m), or the unit alone
_BETWEEN = re.compile(r"[;,\t]")
_DECIMAL = re.compile(r"(?<=\d),(?=\d)")  # comma, where semicolons part the cells


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

    @property
    def largest(self) -> int:
        """Bytes of a file."""
        return LARGEST_TABLE if self.most <= MOST_ROWS else LARGEST_SIGNAL

    @property
    def both(self) -> str:
        """Their names."""
        return " and ".join(self.names)


def pairs(file: Path, columns: Columns) -> tuple[tuple[float, ...], ...]:
    """The values of every row in SI, those of the first column ascending but for a loop.

    Raises ValueError with two arguments, what is wrong and what would be right, where it is no such file.
    """
    try:
        text = read_file(file, columns.largest).decode("utf-8-sig")
    except (OSError, ValueError) as error:
        raise ValueError(
            f"'{file}' cannot be read: {getattr(error, 'strerror', error)}", "give a text file"
        ) from None
    return _pairs(file, text, columns)


@lru_cache(maxsize=8)
def _pairs(file: Path, text: str, columns: Columns) -> tuple[tuple[float, ...], ...]:
    """Those of a text; a file that has changed is read anew."""
    lines = text.splitlines()
    numbered = [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]
    if not 3 <= len(numbered) <= columns.most + 1:
        raise ValueError(
            f"'{file}' has {max(len(numbered) - 1, 0)} rows",
            f"2 to {columns.most} rows below the units",
        )
    factors = _factors(file, numbered[0][1], columns)
    rows = [_row(file, number, line, factors, columns) for number, line in numbered[1:]]
    first = columns.names[0]
    for place in range(1, 0 if columns.is_loop else len(rows)):
        if rows[place][0] <= rows[place - 1][0]:
            message = f"'{file}', line {numbered[place + 1][0]}: the {first} does not rise"
            raise ValueError(message, f"{first}s ascend")
    return tuple(rows)


def named(file: Path, choices: Sequence[Columns]) -> Columns:
    """The one whose units the first line of a file names; where none is, the first: its faults then say so."""
    try:
        text = read_file(file, choices[0].largest).decode("utf-8-sig")
    except (OSError, ValueError):
        return choices[0]
    header = next((line for line in text.splitlines() if line.strip()), "")
    for columns in choices:
        try:
            _factors(file, header, columns)
        except ValueError:
            continue
        return columns
    return choices[0]


def _factors(file: Path, header: str, columns: Columns) -> tuple[float, ...]:
    """SI per unit of every column."""
    cells = _BETWEEN.split(header)
    if len(cells) != len(columns.names):
        raise ValueError(
            f"'{file}' has {len(cells)} columns in line 1, not {len(columns.names)}", columns.head
        )
    found = []
    for cell, unit in zip(cells, columns.units, strict=True):
        match = _UNIT.fullmatch(cell.strip())
        word = "" if match is None else (match[1] or match[2] or "").strip()
        try:
            found.append(units.to_si(f"1 {word}" if word else "", unit))
        except units.UnitFault as fault:
            message = f"'{file}', line 1: '{cell.strip()}' has no unit of {unit}: {fault.message}"
            raise ValueError(message, f"the first line names the units: {columns.head}") from None
    return tuple(found)


def _row(
    file: Path, number: int, line: str, factors: tuple[float, ...], columns: Columns
) -> tuple[float, ...]:
    cells = (
        _DECIMAL.sub(".", line).split(";")
        if _DECIMAL.search(line) and ";" in line
        else _BETWEEN.split(line)
    )
    if len(cells) != len(factors):
        more = "a point in decimals, or decimal commas and semicolons"
        hint = more if len(cells) > len(factors) else columns.both
        raise ValueError(f"'{file}', line {number}: {len(cells)} columns, not {len(factors)}", hint)
    try:
        values = tuple(float(cell) * factor for cell, factor in zip(cells, factors, strict=True))
    except ValueError:
        what = "pair of numbers" if len(factors) > 1 else "number"
        raise ValueError(
            f"'{file}', line {number}: '{line.strip()}' is no {what}", columns.row
        ) from None
    if not (all(map(math.isfinite, values)) and values[0] >= columns.least):
        raise ValueError(f"'{file}', line {number}: {columns.meant} is meant", columns.row)
    return values
