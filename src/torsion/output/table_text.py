"""A table of a report as CSV text, its figures as programs write them."""

import csv
import io
import re

from torsion.output.blocks import Column, Table
from torsion.output.numbers import NONE, cell

PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")
_NUMBER = r"[+-]?(?:\d[\d.]*(?:e[+-]?\d+)?|inf)\s*(?:[,;\t]|$)"
_FORMULA = re.compile(
    rf"(^|[,;\t])(\s*)(?=[=+\-@])(?!{_NUMBER})"
)  # also behind what parts cells elsewhere
FIGURE = re.compile(r"−?\d[\d.]*(·10⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)?")


def table_text(number: str, table: Table) -> str:
    """The rows of a table under their titles, behind its number and caption as a comment."""
    target = io.StringIO()
    target.write(f"# {number}: {inert(one_line(table.caption))}\n")
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow([inert(_title(column)) for column in table.columns])
    rows.writerows([inert(cell) for cell in row] for row in figures(table))
    return target.getvalue()


def figures(table: Table) -> list[list[str]]:
    """Return the cells of every row as programs read them: numbers in the unit of their column, with all digits.

    >>> from torsion.output.blocks import table
    >>> figures(table("Speed [rpm] | < Remark", [(0.5, None)]))
    [['4.7746482927568605', '']]
    """
    return [
        [
            repr(value * column.factor)
            if isinstance(value, float)
            else plain_figure(NONE if value is None else cell(value))
            for column, value in zip(table.columns, row, strict=True)
        ]
        for row in table.values
    ]


def file_name(number: str) -> str:
    """Of the table of that number: table-4.1.csv."""
    return number.lower().replace(" ", "-") + ".csv"


def _title(column: Column) -> str:
    title = column.title.replace("_{", "_").replace("}", "")
    return f"{title} [{column.unit}]" if column.unit else title


def plain_figure(text: str) -> str:
    """A cell with its number as programs write it, 1.2346e-07; words as they stand, and nothing for '–'.

    >>> plain_figure("−1.2346·10⁻⁷"), plain_figure("–"), plain_figure("5 × screw")
    ('-1.2346e-7', '', '5 × screw')
    """
    if text.isascii():
        return one_line(text)
    if text == NONE:
        return ""
    return text.translate(PLAIN).replace("·10", "e") if FIGURE.fullmatch(text) else one_line(text)


def inert(text: str) -> str:
    """Return a text as a cell that a spreadsheet does not run: an apostrophe stands in front of =, +, - and @.

    Numbers stay numbers. A cell may end at a comma, semicolon or tab, as the spreadsheet of each country has it.

    >>> inert("=1+1"), inert("-1.5e-7"), inert("rubber;@SUM(A1)"), inert("5 - 3")
    ("'=1+1", '-1.5e-7', "rubber;'@SUM(A1)", '5 - 3')
    """
    return _FORMULA.sub(r"\1\2'", text)


def one_line(text: str) -> str:
    """A text of the scene without breaks of lines."""
    return " ".join(text.split())
