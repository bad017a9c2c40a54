"""Every table of a report as CSV, in one archive: the figures that the page shows, as a spreadsheet reads them."""

import csv
import io
import re
import zipfile

from torsion.output.blocks import Column, Table
from torsion.output.csv_table import one_line
from torsion.output.document import Document, Numbered

WRITTEN = (1980, 1, 1, 0, 0, 0)  # date of every file in the archive: the same report gives the same bytes
PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")
FIGURE = re.compile(r"−?\d[\d.]*(·10⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)?")


def archive(document: Document) -> bytes:
    """A .zip of `table-4.1.csv` and so on, each named by its number and beginning with its caption as a comment."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as made:
        for item in document.body:
            if isinstance(item.block, Table) and item.number:
                name = item.number.lower().replace(" ", "-") + ".csv"
                made.writestr(zipfile.ZipInfo(name, WRITTEN), table_text(item, item.block), zipfile.ZIP_DEFLATED)
    return target.getvalue()


def table_text(item: Numbered, table: Table) -> str:
    """One table as CSV."""
    target = io.StringIO()
    target.write(f"# {item.number}: {one_line(table.caption)}\n")
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow([_title(column) for column in table.columns])
    rows.writerows([plain_figure(cell) for cell in row] for row in table.rows)
    return target.getvalue()


def _title(column: Column) -> str:
    title = column.title.replace("_{", "_").replace("}", "")
    return f"{title} [{column.unit}]" if column.unit else title


def plain_figure(cell: str) -> str:
    """A cell with its number as programs write it, 1.2346e-07; words as they stand, and nothing for '–'.

    >>> plain_figure("−1.2346·10⁻⁷"), plain_figure("–"), plain_figure("5 × screw")
    ('-1.2346e-7', '', '5 × screw')
    """
    if cell == "–":
        return ""
    return cell.translate(PLAIN).replace("·10", "e") if FIGURE.fullmatch(cell) else one_line(cell)
