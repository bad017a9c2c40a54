"""The pages of the comparisons: check.html of the models, study.html of error against run time, their JSON and CSV."""

import csv
import io
import json
from dataclasses import asdict, replace
from datetime import date
from pathlib import Path
from typing import Any

import torsion
from torsion.analyses.compare.timing import Spread, TimedQuantity, TimedRow, Timings, fastest, unbeaten
from torsion.findings import Findings
from torsion.output.plain import finite
from torsion.report.blocks import Block
from torsion.report.chapters import model_comparison
from torsion.report.chapters import plan as plan_chapter
from torsion.report.chapters import source as source_chapter
from torsion.report.cover import checksum, cover
from torsion.report.document import Document
from torsion.report.numbering import numbered
from torsion.report.pages.run_time_blocks import blocks, recommendation

CHECK, STUDY = "check.html", "study.html"
FORMAT = 1
TITLES = (
    "quantity", "method", "division", "size", "error [1]", "least [s]", "quarter [s]", "median [s]",
    "three quarters [s]", "median assembly [s]", "median solve [s]", "runs",
)  # fmt: skip


def write_check(findings: Findings, folder: str | Path, *, today: date | None = None) -> list[Path]:
    """Write check.html and check.json, both or none; raises OSError where the folder cannot be written."""
    from torsion.output.results_json import MODELS, text
    from torsion.report.html import html
    from torsion.report.write import write_texts

    page = html(check_document(findings, today or date.today()))
    return write_texts({CHECK: page, "check.json": text(findings, MODELS)}, folder)


def write_study(findings: Findings, timings: Timings, folder: str | Path, *, today: date | None = None) -> list[Path]:
    """Write study.html, study.json and study.csv, all or none; raises OSError where the folder cannot be written."""
    from torsion.report.html import html
    from torsion.report.write import write_texts

    page = html(study_document(findings, timings, today or date.today()))
    texts = {STUDY: page, "study.json": json_text(findings, timings), "study.csv": csv_text(timings)}
    return write_texts(texts, folder)


def check_document(findings: Findings, today: date | None = None) -> Document:
    """The report of the models side by side alone."""
    chapters = (model_comparison, plan_chapter, source_chapter)
    body = [block for chapter in chapters for block in chapter.chapter(findings)]
    return _document(findings, "Models of a shaft train compared", body, today)


def study_document(findings: Findings, timings: Timings, today: date | None = None) -> Document:
    """The report: what to take, every quantity, how the times were taken, all rows, the file."""
    source = source_chapter.chapter(findings) if findings.study.text else []
    return _document(findings, "Error against run time", [*blocks(timings), *source], today)


def _document(findings: Findings, title: str, body: list[Block], today: date | None) -> Document:
    return Document(replace(cover(findings, today), title=title), tuple(numbered(body)))


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
