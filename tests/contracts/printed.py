"""What a printed number may stand for: the interval of the values that are rounded to it."""

import math
from dataclasses import dataclass, replace
from fractions import Fraction

from torsion.output.blocks import Table

SLACK = 1e-12  # relative: of the arithmetic of this file
PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")
Row = dict[str, str]


@dataclass(frozen=True)
class Interval:
    """All values from one to another."""

    low: float
    high: float

    def __add__(self, other: "Interval") -> "Interval":
        return Interval(self.low + other.low, self.high + other.high)

    def __sub__(self, other: "Interval") -> "Interval":
        return Interval(self.low - other.high, self.high - other.low)

    def __mul__(self, other: "Interval") -> "Interval":
        ends = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return Interval(min(ends), max(ends))

    def meets(self, other: "Interval") -> bool:
        """Some value is in both."""
        slack = SLACK * max(map(abs, (self.low, self.high, other.low, other.high)))
        return self.low <= other.high + slack and other.low <= self.high + slack


NOTHING = Interval(0.0, 0.0)


def value(text: str) -> float:
    """A cell as a number: '−1.2346·10⁷', '2/3', '∞'."""
    plain = text.translate(PLAIN).replace("·10", "e").replace("∞", "inf")
    return float(Fraction(plain)) if "/" in plain else float(plain)


def printed(text: str, digits: int) -> Interval:
    """The values that are rounded to a cell of so many significant digits; of a fraction, or 0, that value alone."""
    middle = value(text)
    if middle == 0 or "/" in text or math.isinf(middle):
        return Interval(middle, middle)
    half = 0.5 * 10.0 ** (math.floor(math.log10(abs(middle))) - digits + 1)
    return Interval(middle - half, middle + half)


def rows(table: Table) -> list[Row]:
    """The rows by title; a title that comes again is the first one of them."""
    titles = [column.title for column in table.columns]
    return [dict(reversed(list(zip(titles, row, strict=True)))) for row in table.rows]


def with_cell(table: Table, row: int, column: int, text: str) -> Table:
    """The table with another text in one cell."""
    cells = [list(one) for one in table.rows]
    cells[row][column] = text
    return replace(table, values=tuple(map(tuple, cells)))
