"""The pages of the comparisons: check.html of the models, study.html of error against run time, their JSON and CSV."""

import csv
import io
import json
from dataclasses import asdict
from datetime import date
from pathlib import Path
from typing import Any

import torsion
from torsion.analyses.compare.timing import Spread, TimedQuantity, TimedRow, Timings, fastest, unbeaten
from torsion.findings import Findings
from torsion.output.chapters import chapters
from torsion.output.cover import checksum, cover
from torsion.output.document import Document
from torsion.output.numbering import numbered
from torsion.output.pages.run_time_blocks import blocks, recommendation
from torsion.output.plain import finite
from torsion.output.reports import REPORTS

FORMAT = 1
TITLES = (
    "quantity", "method", "division", "size", "error [1]", "least [s]", "quarter [s]", "median [s]",
    "three quarters [s]", "median assembly [s]", "median solve [s]", "runs",
)  # fmt: skip


def write_study(findings: Findings, timings: Timings, folder: str | Path, *, today: date | None = None) -> Document:
    """Write study.html, study.json and study.csv, all or none; raises OSError where the folder cannot be written."""
    from torsion.output.html import html
    from torsion.output.write import write_texts

    made = study_document(findings, timings, today or date.today())
    stem = made.report.stem
    texts = {"html": html(made), "json": json_text(findings, timings), "csv": csv_text(timings)}
    write_texts({f"{stem}.{suffix}": content for suffix, content in texts.items()}, folder)
    return made


def study_document(findings: Findings, timings: Timings, today: date | None = None) -> Document:
    """The report: what to take, every quantity, how the times were taken, all rows, the file."""
    report = REPORTS["study"]
    body = [*blocks(timings), *chapters(findings, report)]
    return Document(cover(findings, today, report.title), tuple(numbered(body)), findings, report)


def csv_text(timings: Timings) -> str:
    """One row a method and discretisation; numbers come back to the last digit, an infinite error is 'inf'."""
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
    values = {
        "format": FORMAT,
        "program": {"name": "torsion", "version": torsion.__version__},
        "scene": {"name": study.name, "file": study.file, "sha256": checksum(study.text) if study.text else None},
        "tolerance": timings.tolerance,
        "rounds": timings.rounds,
        "machine": dict(timings.machine),
        "remarks": list(timings.remarks),
        "quantities": [_quantity(one, timings.tolerance) for one in timings.quantities],
    }
    return json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


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
    return {key if key == "runs" else f"{key}_s": value for key, value in asdict(spread).items()}
