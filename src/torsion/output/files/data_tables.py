"""Tables in files: results as plain values for CSV and spreadsheets, and the tables of the report, all digits.

Columns of results are keys of results.json. Lists of records become a table by their key (`checks`,
`critical_speeds`), arrays over one axis a table by their result (`modes`). Arrays over two axes stay in results.json.
"""

import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Any

import numpy as np

import torsion
from torsion.errors import refusal
from torsion.findings import Findings
from torsion.output.blocks import Table
from torsion.output.document import Document
from torsion.output.stored.results_json import plain, reliable
from torsion.output.stored.scene import Selection, checksum, span_rows, station_rows
from torsion.output.table_text import (
    csv_rows,
    file_name,
    inert,
    inert_cells,
    one_line,
    packed,
    table_text,
)
from torsion.results import RPM, is_declared, quantities

LONGEST_SHEET = 31  # characters of a sheet name in a workbook
SPEED = "speed_rad_per_s"  # a column in rpm follows it


@dataclass(frozen=True)
class DataTable:
    """A table with a stable name; cells are numbers, texts, booleans or None."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]


def data_tables(findings: Findings) -> Iterator[DataTable]:
    """Yield all tables of the results, in the order of results.json; a table without rows is omitted."""
    selection = Selection(findings.system)
    yield from _of_records("stations", plain(station_rows(selection.system), selection))
    yield from _of_records("spans", plain(span_rows(selection.system), selection))
    for name, result in findings.results.items():
        if is_declared(result):
            yield from result_tables(name, result, selection)


def result_tables(name: str, result: Any, selection: Selection) -> Iterator[DataTable]:
    """Yield the arrays over one axis and the lists of records of one result."""
    values = plain(result, selection)
    if isinstance(values, list):
        yield from _of_records(name, values)
        return
    # Arrays of one dimension stand in one table for each axis; that of the first axis has the name of the result.
    by_axis: dict[tuple[str, int], dict[str, list[Any]]] = {}
    for quantity in quantities(type(result)):
        if len(quantity.printed) != 1 or quantity.record is not None:
            continue
        array = selection.reduced(reliable(result, quantity), quantity, quantity.axes)
        if isinstance(array, np.ndarray) and array.ndim == 1:
            columns = by_axis.setdefault((quantity.printed[0], len(array)), {})
            is_complex = array.dtype.kind == "c"
            parts = {"_real": array.real, "_imag": array.imag} if is_complex else {"": array}
            columns |= {f"{quantity.key}{part}": half.tolist() for part, half in parts.items()}

    for position, ((axis, count), columns) in enumerate(by_axis.items()):
        table_name = name if position == 0 else f"{name}_by_{axis.replace(' ', '_')}"
        yield from _table(table_name, {axis: list(range(1, count + 1)), **columns})
    for key, records in values.items():
        if isinstance(records, list) and all(isinstance(row, dict) for row in records):
            yield from _of_records(name if len(values) == 1 else f"{name}_{key}", records)


def _of_records(name: str, records: list[Any]) -> Iterator[DataTable]:
    """Yield the records as rows; a record in a record gives columns such as `basis.kind`, a list of words one text."""
    rows = [dict(_flat(record)) for record in records if isinstance(record, Mapping)]
    keys = dict.fromkeys(key for row in rows for key in row)
    yield from _table(name, {key: [row.get(key) for row in rows] for key in keys})


def _flat(record: Mapping[str, Any], head: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in record.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{head}{key}.")
        elif isinstance(value, list) and all(isinstance(item, str) for item in value):
            yield head + key, "; ".join(value)
        elif not isinstance(value, list | np.ndarray):
            yield head + key, value


def _table(name: str, columns: Mapping[str, list[Any]]) -> Iterator[DataTable]:
    """Yield the table of these columns, with `speed_rpm` after a speed in rad/s; nothing if it has no row."""
    cells: dict[str, list[Any]] = {}
    for key, values in columns.items():
        cells[key] = [_cell(value) for value in values]
        if key == SPEED:
            cells["speed_rpm"] = [None if value is None else value * RPM for value in cells[key]]
    if rows := tuple(zip(*cells.values(), strict=True)):
        yield DataTable(name, tuple(cells), rows)


def _cell(value: Any) -> Any:
    """Return a number, text or boolean; None for no value."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, bool | int | float | str | None) else str(value)


def archive(document: Document, findings: Findings) -> bytes:
    """Return a .zip of `checks.csv`, `modes.csv`, ...; of a file with cases, those of each case in its folder."""
    texts = {}
    for name, case in findings.each.items():
        folder = "" if case is findings else case.study.case.folder if case.study.case else name
        for table in data_tables(case) if case.is_answered else ():
            file = f"{folder}/{table.name}.csv" if folder else f"{table.name}.csv"
            texts[file] = csv_rows([table.columns, *table.rows])
    return packed(texts)


def workbook(document: Document, findings: Findings) -> bytes:
    """Return an .xlsx workbook, one sheet a table, numbers as numbers. Raises InputError without openpyxl."""
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
        for title in sheet[1]:
            title.font = Font(bold=True)
        sheet.freeze_panes = "A2"
        for row in table.rows:
            sheet.append(inert_cells(row))
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()


def report_tables(document: Document) -> bytes:
    """Return a .zip of `table-4.1.csv` and so on; a table is complete also if the page omits rows."""
    texts = {}
    for item in document.body:
        if isinstance(item.block, Table) and item.number:
            name = file_name(item.number)
            complete = document.beside.get(f"{document.report.stem}-{name}")
            texts[name] = complete() if complete else table_text(item.number, item.block)
    return packed(texts)


def report_columns(document: Document, findings: Findings) -> str | None:
    """Return the columns of a report over one axis, after comments on their origin; None if it declares none."""
    if not document.report.columns:
        return None
    columns = resolve_name(f"torsion.output.chapters.{document.report.columns}")(findings)
    study = findings.study
    comments = [f"scene: {inert(one_line(study.name))}"]
    if study.text:
        file = inert(one_line(study.shown_file))
        comments.append(f"file: {file}, SHA-256 {checksum(study)}")
    comments.append(f"torsion {torsion.__version__}; motion of the shaft downstream of the joint")
    titles, values = zip(*columns, strict=True)
    head = "".join(f"# {comment}\n" for comment in comments)
    return head + csv_rows([titles, *np.column_stack(values).tolist()])
