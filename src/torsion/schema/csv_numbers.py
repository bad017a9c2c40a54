"""The decimal sign of a table, and numbers and lists whose signs may be read in two ways.

A table whose cells are parted by semicolons or tabs may have decimal points or decimal commas. `40.000` is 40 in one
language and 40 000 in another: what the other numbers of the table do not decide is refused.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from torsion import units
from torsion.schema.csv_text import Cell
from torsion.schema.yaml_source import resolved

Slip = tuple[Cell, str, str]  # where, what is wrong, what would be right
_COMMA = re.compile(
    r"([-+]?[0-9]*),([0-9]+(?:[eE][-+]?[0-9]+)?)(?![0-9,.])"
)  # a number with a decimal comma begins
_POINT = re.compile(r"[-+]?[0-9]*\.[0-9]+(?:[eE][-+]?[0-9]+)?(?![0-9,.])")
_THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2}[.,][0-9]{3}")
_FIGURE = re.compile(r"(?<![\w.,])[-+]?[0-9.,]*[0-9](?:[eE][-+]?[0-9]+)?")
_JOINED = re.compile(r"(?<=[0-9]),(?=[0-9])")  # no blank shows whether it parts two numbers or one


@dataclass(frozen=True)
class Numbers:
    """How the numbers of a table are to be read."""

    commas: bool = False  # no comma parts the cells, so that it may be a decimal sign
    points: bool = False  # some number has a decimal point

    def plain(self, text: str) -> str:
        """With a decimal point for a decimal comma, which numbers may have where no comma parts the cells."""
        if not self.commas:
            return text
        if text[:1] in "[{":
            return _JOINED.sub(".", text).replace(";", ",") if ";" in text else text
        return _COMMA.sub(r"\1.\2", text, count=1) if _COMMA.match(text) else text

    def slip(self, cell: Cell) -> Slip | None:
        """What is wrong with a list of which a comma may part two numbers, or one."""
        is_plain = not self.commas or self.points or any(sign in cell.text for sign in ".;")
        if is_plain or cell.text[:1] != "[" or not _JOINED.search(cell.text):
            return None
        inner = cell.text.strip("[] ")
        parts = re.split(r",\s+", inner) if re.search(r",\s", inner) else inner.split(",")
        one = (
            f"{inner} for a number, "
            if len(parts) == 2 and "," in inner and ", " not in inner
            else ""
        )
        right = f'write {one}"[{"; ".join(parts)}]" for a list'
        ways = "one number or a list" if one else "read in two ways"
        return cell, f"`{cell.text}` may be {ways}", right


def numbers_of(separator: str, cells: Iterable[Cell]) -> tuple[Numbers, Slip | None]:
    """How to read the numbers of a table, and what is wrong with its decimal signs.

    cells: those that may hold numbers.
    """
    figures = [(cell, figure) for cell in cells for figure in _figures(cell.text)]
    points = [(cell, figure) for cell, figure in figures if _POINT.fullmatch(figure)]
    if separator == ",":
        return Numbers(), None
    commas = [(cell, figure) for cell, figure in figures if _COMMA.fullmatch(figure)]
    made = Numbers(True, bool(points))
    if commas and points:
        (cell, text), (other, found) = (
            (points[0], commas[0]) if len(points) <= len(commas) else (commas[0], points[0])
        )
        message = (
            f"`{text}` here, and `{found}` in line {other.line}: two decimal signs in one table"
        )
        return made, (
            cell,
            message,
            "write all numbers with one of them, and no marks between thousands",
        )
    marked = [(cell, figure) for cell, figure in figures if len(re.findall("[.,]", figure)) == 1]
    if marked and all(_THOUSANDS.fullmatch(figure) for _, figure in marked):
        cell, text = marked[0]
        message = "may be thousands or decimals: every such number of this table has three digits after its mark"
        return made, (cell, f"`{text}` {message}", f"write {_both_ways(text)}")
    return made, None


def _both_ways(text: str) -> str:
    """A number like 40.000 without a mark between thousands, and in a way that it can only be a decimal."""
    short = text.rstrip("0")
    decimal = f"{short}0" if short[-1] in ".," or short == text else short
    return f"{re.sub('[.,]', '', text)} or {decimal}"


def _figures(text: str) -> Iterator[str]:
    """The numbers of a cell: the one that it begins with, or those in its brackets, where semicolons part them."""
    if text[:1] not in ("[", "{"):
        yield from (found[0] for found in [_FIGURE.match(text)] if found)
    elif ";" in text:
        yield from (found[0] for found in _FIGURE.finditer(text))


def in_unit(value: Any, text: str, unit: str) -> Any:
    """A number with its unit; all else as it stands."""
    return f"{text} {unit}" if unit and is_number(text) else value


def is_number(text: str) -> bool:
    """Whether a cell says a number."""
    value = resolved(text)
    return isinstance(value, int | float) and not isinstance(value, bool)


def unit_fault(written: str, unit: str) -> units.UnitFault | None:
    """What is wrong with a unit of a column where one of `unit` is expected."""
    try:
        units.to_si(f"1 {written}", unit)
    except units.UnitFault as fault:
        return fault
    return None
