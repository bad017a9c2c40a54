"""Every table of a report as CSV, in one archive: the figures that the page shows, as a spreadsheet reads them."""

import io
import zipfile

from torsion.output.blocks import Table
from torsion.output.document import Document
from torsion.output.table_text import file_name, table_text

WRITTEN = (
    1980,
    1,
    1,
    0,
    0,
    0,
)  # date of every file in the archive: the same report gives the same bytes


def archive(document: Document) -> bytes:
    """A .zip of `table-4.1.csv` and so on, whole also where the page leaves rows out.

    Each is named by its number and begins with its caption as a comment.
    """
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as made:
        for item in document.body:
            if isinstance(item.block, Table) and item.number:
                name = file_name(item.number)
                whole = document.beside.get(f"{document.report.stem}-{name}")
                text = whole() if whole else table_text(item.number, item.block)
                made.writestr(zipfile.ZipInfo(name, WRITTEN), text, zipfile.ZIP_DEFLATED)
    return target.getvalue()
