"""A torque over time from a file of two columns, time and torque, whose first line names their units."""

import math
import re
from functools import lru_cache
from pathlib import Path

from torsion import units

MOST_ROWS = 100_000
_UNIT = re.compile(r".*[\[(](.+)[\])]\s*|(.*)")  # time [ms], torque (kN*m), or the unit alone
_BETWEEN = re.compile(r"[;,\t]")


@lru_cache(maxsize=4)
def torque_rows(file: Path) -> tuple[tuple[float, float], ...]:
    """(s, N m) of every row, times ascending.

    Raises ValueError with two arguments, what is wrong and what would be right, where it is no such file.
    """
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, ValueError) as error:
        raise ValueError(f"'{file}' cannot be read: {getattr(error, 'strerror', error)}", "give a text file") from None
    numbered = [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]
    if not 3 <= len(numbered) <= MOST_ROWS + 1:
        raise ValueError(f"'{file}' has {max(len(numbered) - 1, 0)} rows", f"2 to {MOST_ROWS} rows below the units")
    factors = _factors(file, numbered[0][1])
    rows = [_row(file, number, line, factors) for number, line in numbered[1:]]
    for place in range(1, len(rows)):
        if rows[place][0] <= rows[place - 1][0]:
            raise ValueError(f"'{file}', line {numbered[place + 1][0]}: the time does not rise", "times ascend")
    return tuple(rows)


def _factors(file: Path, header: str) -> tuple[float, float]:
    """SI per unit of both columns."""
    cells = _BETWEEN.split(header)
    if len(cells) != 2:
        raise ValueError(f"'{file}' has {len(cells)} columns in line 1, not 2", "time [s], torque [N*m]")
    found = []
    for cell, unit in zip(cells, ("s", "N*m"), strict=True):
        match = _UNIT.fullmatch(cell.strip())
        word = "" if match is None else (match[1] or match[2] or "").strip()
        try:
            found.append(units.to_si(f"1 {word}" if word else "", unit))
        except units.UnitFault as fault:
            message = f"'{file}', line 1: '{cell.strip()}' has no unit of {unit}: {fault.message}"
            raise ValueError(message, "the first line names the units: time [s], torque [N*m]") from None
    return found[0], found[1]


def _row(file: Path, number: int, line: str, factors: tuple[float, float]) -> tuple[float, float]:
    cells = _BETWEEN.split(line)
    if len(cells) != 2:
        hint = "a point in decimals, one separator" if len(cells) > 2 else "time and torque"
        raise ValueError(f"'{file}', line {number}: {len(cells)} columns, not 2", hint)
    try:
        time, torque = (float(cell) * factor for cell, factor in zip(cells, factors, strict=True))
    except ValueError:
        raise ValueError(f"'{file}', line {number}: '{line.strip()}' is no pair of numbers", "0.5, 120") from None
    if not (math.isfinite(time) and math.isfinite(torque) and time >= 0.0):
        raise ValueError(f"'{file}', line {number}: a finite torque at a finite time from 0 on is meant", "0.5, 120")
    return time, torque
