"""The report of a study of run times: study.html, study.json and study.csv."""

import csv
import io
import json
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any

import torsion
from torsion.analyses.study.rows import Spread, TimedQuantity, TimedRow, Timings, fastest, unbeaten
from torsion.findings import Findings
from torsion.output.chapters import input_file as source_chapter
from torsion.output.cover import checksum, cover
from torsion.output.document import Document
from torsion.output.numbering import numbered
from torsion.output.pages.study_blocks import blocks
from torsion.output.plain import finite
from torsion.output.terminal.study import PAGE, recommendation

FORMAT = 1
TITLES = (
    "quantity", "method", "division", "size", "error [1]", "least [s]", "quarter [s]", "median [s]",
    "three quarters [s]", "median assembly [s]", "median solve [s]", "runs",
)  # fmt: skip


def write_study(findings: Findings, timings: Timings, folder: str | Path, *, today: date | None = None) -> list[Path]:
    """Write the three files into the folder, all or none; raises OSError where it cannot be written."""
    from torsion.output.html import html
    from torsion.output.write import write_texts

    page = html(study_document(findings, timings, today or date.today()))
    texts = {PAGE: page, "study.json": json_text(findings, timings), "study.csv": csv_text(timings)}
    return write_texts(texts, folder)


def study_document(findings: Findings, timings: Timings, today: date | None = None) -> Document:
    """The report: what to take, every quantity, how the times were taken, all rows, the file."""
    front = replace(cover(findings, today), title="Error against run time")
    body = blocks(timings)
    if findings.study.text:
        body += source_chapter.chapter(findings)
    return Document(front, tuple(numbered(body)))


def csv_text(timings: Timings) -> str:
    """One row a method and division; numbers come back to the last digit, an infinite error is 'inf'."""
    target = io.StringIO()
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow(TITLES)
    for quantity in timings.quantities:
        for row in quantity.rows:
            total = row.total
            rows.writerow([
                quantity.key, row.curve, row.division, row.size, row.error, total.least, total.quarter, total.median,
                total.three_quarters, row.assembly_spread.median, row.solve_spread.median, total.runs,
            ])  # fmt: skip
    return target.getvalue()


def json_text(findings: Findings, timings: Timings) -> str:
    """The study as JSON text; times in seconds, every run; an error that is infinite is null."""
    study = findings.study
    told = {
        "format": FORMAT,
        "program": {"name": "torsion", "version": torsion.__version__},
        "scene": {"name": study.name, "file": study.file, "sha256": checksum(study.text) if study.text else None},
        "tolerance": timings.tolerance,
        "rounds": timings.rounds,
        "machine": dict(timings.machine),
        "remarks": list(timings.remarks),
        "quantities": [_quantity(one, timings.tolerance) for one in timings.quantities],
    }
    return json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _quantity(quantity: TimedQuantity, tolerance: float) -> dict[str, Any]:
    best = fastest(quantity.rows, tolerance)
    return {
        "key": quantity.key,
        "title": quantity.title,
        "meaning": quantity.meaning,
        "reference": {"what": quantity.reference, "bound": finite(quantity.bound)},
        "highest_Hz": quantity.highest,
        "errors_are_of": list(quantity.columns),
        "recommendation": recommendation(quantity, tolerance),
        "recommended_row": None if best is None else quantity.rows.index(best),
        "unbeaten_rows": [quantity.rows.index(row) for row in unbeaten(quantity.rows, quantity.bound)],
        "remarks": list(quantity.remarks),
        "rows": [_row(row) for row in quantity.rows],
    }


def _row(row: TimedRow) -> dict[str, Any]:
    return {
        "method": row.curve,
        "division": row.division,
        "size": row.size,
        "error": finite(row.error),
        "errors": [finite(error) for error in row.errors],
        "total": _spread(row.total),
        "assembly": _spread(row.assembly_spread),
        "solve": _spread(row.solve_spread),
        "assembly_s": list(row.assembly),
        "solve_s": list(row.solve),
    }


def _spread(spread: Spread) -> dict[str, Any]:
    return {
        "least_s": spread.least,
        "quarter_s": spread.quarter,
        "median_s": spread.median,
        "three_quarters_s": spread.three_quarters,
        "runs": spread.runs,
    }
