"""A table of a report as CSV text, its figures as programs write them."""

import csv
import io
import re

from torsion.output.blocks import Column, Table

PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")
FIGURE = re.compile(r"−?\d[\d.]*(·10⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)?")


def table_text(number: str, table: Table) -> str:
    """The rows of a table under their titles, behind its number and caption as a comment."""
    target = io.StringIO()
    target.write(f"# {number}: {one_line(table.caption)}\n")
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow([_title(column) for column in table.columns])
    rows.writerows([plain_figure(cell) for cell in row] for row in table.rows)
    return target.getvalue()


def file_name(number: str) -> str:
    """Of the table of that number: table-4.1.csv."""
    return number.lower().replace(" ", "-") + ".csv"


def _title(column: Column) -> str:
    title = column.title.replace("_{", "_").replace("}", "")
    return f"{title} [{column.unit}]" if column.unit else title


def plain_figure(cell: str) -> str:
    """A cell with its number as programs write it, 1.2346e-07; words as they stand, and nothing for '–'.

    >>> plain_figure("−1.2346·10⁻⁷"), plain_figure("–"), plain_figure("5 × screw")
    ('-1.2346e-7', '', '5 × screw')
    """
    if cell.isascii():
        return one_line(cell)
    if cell == "–":
        return ""
    return cell.translate(PLAIN).replace("·10", "e") if FIGURE.fullmatch(cell) else one_line(cell)


def one_line(text: str) -> str:
    """A text of the scene without breaks of lines."""
    return " ".join(text.split())
