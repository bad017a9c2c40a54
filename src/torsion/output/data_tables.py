"""The results as tables of plain values, for CSV and spreadsheets: columns are keys of results.json, all digits.

Lists of records become a table by their key (`checks`, `critical_speeds`), arrays over one axis a table by their result
(`modes`). Arrays over two axes stay in results.json.
"""

import csv
import io
import math
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.plain import plain, shown
from torsion.output.scene import span_rows, station_rows
from torsion.output.selection import Selection
from torsion.output.table_text import inert, one_line
from torsion.results import is_declared, quantities

WRITTEN = (
    1980,
    1,
    1,
    0,
    0,
    0,
)  # date of every file in the archive: the same results give the same bytes
LONGEST_SHEET = 31  # characters of a sheet name in a workbook
RPM = 30.0 / math.pi
SPEED = "speed_rad_per_s"  # a column of it has another in rpm next to it


@dataclass(frozen=True)
class DataTable:
    """A table with a stable name; cells are numbers, texts, booleans or None."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]


def data_tables(findings: Findings) -> Iterator[DataTable]:
    """Yield all tables of the results, in the order of results.json; a table without rows is left out."""
    selection = Selection(findings.system)
    rows = {
        "stations": plain(station_rows(selection), selection),
        "spans": plain(span_rows(selection), selection),
    }
    for name, records in rows.items():
        yield from _of_records(name, records)
    for name, value in findings.results.items():
        if not is_declared(value):
            continue
        data = plain(value, selection)
        if isinstance(data, list):
            yield from _of_records(name, data)
            continue
        yield from _of_arrays(name, value, selection)
        for key, inner in data.items():
            if (
                isinstance(inner, list)
                and inner
                and all(isinstance(record, dict) for record in inner)
            ):
                yield from _of_records(name if len(data) == 1 else f"{name}_{key}", inner)


def _of_arrays(name: str, value: Any, selection: Selection) -> Iterator[DataTable]:
    """Yield the one-dimensional arrays of a result, one table for each axis; that of the first axis has its name."""
    by_axis: dict[tuple[str, int], dict[str, Any]] = {}
    for quantity in quantities(type(value)):
        if len(quantity.printed) != 1 or quantity.record is not None:
            continue
        array = shown(value, quantity, selection)
        if not isinstance(array, np.ndarray) or array.ndim != 1:
            continue
        columns = by_axis.setdefault((quantity.printed[0], len(array)), {})
        if array.dtype.kind == "c":
            columns |= {f"{quantity.key}_real": array.real, f"{quantity.key}_imag": array.imag}
        else:
            columns[quantity.key] = array
    for place, ((axis, count), columns) in enumerate(by_axis.items()):
        if not count:
            continue
        cells = [[_cell(item) for item in column.tolist()] for column in columns.values()]
        rows = tuple(zip(range(1, count + 1), *cells, strict=True))
        yield _with_rpm(
            DataTable(
                name if place == 0 else f"{name}_by_{axis.replace(' ', '_')}",
                (axis, *columns),
                rows,
            )
        )


def _of_records(name: str, records: list[Any]) -> Iterator[DataTable]:
    """Yield the records as rows; a record in a record gives columns such as `basis.kind`, a list of words one text."""
    flat = [dict(_flat(record)) for record in records if isinstance(record, Mapping)]
    columns = tuple(dict.fromkeys(key for row in flat for key in row))
    if flat and columns:
        yield _with_rpm(
            DataTable(name, columns, tuple(tuple(row.get(key) for key in columns) for row in flat))
        )


def _flat(record: Mapping[str, Any], head: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in record.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{head}{key}.")
        elif isinstance(value, list) and all(isinstance(item, str) for item in value):
            yield head + key, "; ".join(value)
        elif not isinstance(value, list | np.ndarray):
            yield head + key, _cell(value)


def _cell(value: Any) -> Any:
    """Return a number, text or boolean; None for no value."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return (
        str(value)
        if value is not None and not isinstance(value, bool | int | float | str)
        else value
    )


def _with_rpm(table: DataTable) -> DataTable:
    """Return the table with `speed_rpm` after a speed in rad/s."""
    if SPEED not in table.columns:
        return table
    place = table.columns.index(SPEED)
    speeds = [None if row[place] is None else row[place] * RPM for row in table.rows]
    rows = [
        (*row[: place + 1], rpm, *row[place + 1 :])
        for row, rpm in zip(table.rows, speeds, strict=True)
    ]
    columns = (*table.columns[: place + 1], "speed_rpm", *table.columns[place + 1 :])
    return DataTable(table.name, columns, tuple(rows))


def csv_of(table: DataTable) -> str:
    """Return a table as CSV; a text that a spreadsheet would run as a formula is made inert."""
    target = io.StringIO()
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow(table.columns)
    rows.writerows(
        [inert(one_line(cell)) if isinstance(cell, str) else cell for cell in row]
        for row in table.rows
    )
    return target.getvalue()


def archive(document: Document, findings: Findings) -> bytes:
    """Return a .zip of `checks.csv`, `modes.csv`, ...; of a file with cases, those of each case in its folder."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as made:
        for name, case in findings.each.items():
            folder = "" if case is findings or not findings.cases else f"{_folder(case, name)}/"
            for table in data_tables(case) if case.is_answered else ():
                info = zipfile.ZipInfo(f"{folder}{table.name}.csv", WRITTEN)
                made.writestr(info, csv_of(table), zipfile.ZIP_DEFLATED)
    return target.getvalue()


def _folder(case: Findings, name: str) -> str:
    return case.study.case.folder if case.study.case is not None else name


def workbook(document: Document, findings: Findings) -> bytes:
    """Return an .xlsx workbook, one sheet a table, numbers as numbers. Raises InputError without openpyxl."""
    from torsion.errors import refusal

    try:
        from openpyxl import Workbook
        from openpyxl.styles import Font
    except ImportError:
        raise refusal("a workbook needs openpyxl", "pip install openpyxl") from None
    book = Workbook(write_only=False)
    book.remove(book.active)
    for table in data_tables(findings):
        sheet = book.create_sheet(table.name[:LONGEST_SHEET])
        sheet.append(table.columns)
        for cell in sheet[1]:
            cell.font = Font(bold=True)
        sheet.freeze_panes = "A2"
        for row in table.rows:
            sheet.append([inert(one_line(cell)) if isinstance(cell, str) else cell for cell in row])
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()
