"""The study of error against run time: a sentence and a table for each quantity, and every run as JSON."""

import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from datetime import date
from pathlib import Path
from statistics import median

import torsion
from torsion.analyses.compare.timing import (
    FULL,
    TimedQuantity,
    TimedRow,
    Timings,
    fastest,
    unbeaten,
)
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Points, Table, table
from torsion.output.document import Document, document
from torsion.output.numbers import given, number
from torsion.output.pages.html import html
from torsion.output.reports import REPORTS
from torsion.output.stored.results_json import finite
from torsion.output.stored.scene import checksum
from torsion.output.write import inputs, write_texts

FORMAT = 1
LEAST_SHARE = 1e-4  # from which an error is given in per cent
HOW = (
    "Every method is run once before, which warms up, gives its error and is no sample. Then all methods run one after "
    "another in {rounds} rounds, a fast one several times a round, one slower than {slow:g} s in {slow_rounds} of "
    "them, so that a slow minute of the machine falls on all alike. Every run assembles the train anew and solves it; "
    "times are medians. Not counted: reading the file, finding out how fine the exact model must be, writing a report. "
    "Another program has other times."
)


def write_study(
    findings: Findings, timings: Timings, folder: str | Path, *, today: date | None = None
) -> Document:
    """Write study.html and study.json, both or none; raises OSError where the folder cannot be written."""
    report = REPORTS["study"]
    study = document(findings, today or date.today(), report=report, before=[*blocks(timings)])
    contents = {
        f"{report.stem}.html": html(study),
        f"{report.stem}.json": json_text(findings, timings),
    }
    write_texts(contents, folder, inputs(findings.study))
    return study


def blocks(timings: Timings) -> Iterator[Block]:
    """Yield the whole report but for cover and source."""
    yield Heading("What to take", at_end=True)
    for quantity in timings.quantities:
        best = fastest(quantity.rows, timings.tolerance)
        sentence = f"{quantity.title}. {recommendation(quantity, timings.tolerance)}"
        yield Paragraph(sentence, "fail" if best is None else "pass", brief=True)
    if timings.remarks:
        yield Points(timings.remarks, brief=True)

    for quantity in timings.quantities:
        yield Heading(quantity.title)
        yield Paragraph(
            f"{quantity.meaning} {quantity.reference} Here it is {share(quantity.bound)}."
        )
        yield methods(quantity, timings.tolerance)
        if quantity.bound > timings.tolerance / 10.0:
            text = f"The bound of the reference, {share(quantity.bound)}, is not a tenth of the tolerance: take more"
            yield Paragraph(f"{text} than that.", "note")
        if quantity.remarks:
            yield Points(quantity.remarks)

    yield Heading("How the times were taken")
    slow = {"slow": FULL.slow, "slow_rounds": FULL.slow_rounds}
    yield Paragraph(HOW.format(rounds=timings.rounds, **slow))
    yield KeyValues(timings.machine)


def methods(quantity: TimedQuantity, tolerance: float) -> Table:
    """Return every method and discretisation with its error and run times, and what makes it worth taking."""
    best, undefeated = fastest(quantity.rows, tolerance), unbeaten(quantity.rows, quantity.bound)
    remarks = [
        "recommended" if row is best else "not beaten" if row in undefeated else ""
        for row in quantity.rows
    ]
    return table(
        "< Method -> | < Discretisation -> | Error -> | Median [ms]:3 -> ms | Assembly [ms]:3 | Solve [ms]:3 | "
        "< Remark ->",
        [(*cells(row), remark) for row, remark in zip(quantity.rows, remarks, strict=True)],
        f"{quantity.title}: error and run time of every method. Not beaten: no other is faster and more accurate",
        marks=["pass" if remark == "recommended" else "" for remark in remarks],
        short=f"{quantity.title}: error and run time",
    )


def recommendation(quantity: TimedQuantity, tolerance: float) -> str:
    """Return which method to take: 'For 0.1 % up to 120 Hz: lumped, 8 segments, 0.4 ms (error 0.03 %).'"""
    best = fastest(quantity.rows, tolerance)
    row = best or min(quantity.rows, key=lambda row: row.error)
    milliseconds = number(1e3 * row.total.median, 3)
    words = f"{row.curve}, {row.division}, {milliseconds} ms (error {share(row.error)})."
    if best is None:
        words = f"no method that was run is as accurate; the nearest is {words}"
    return f"For {share(tolerance)} up to {given(quantity.highest, 3)} Hz: {words}"


def share(error: float) -> str:
    """Return a relative error: '0.1 %', '2.3·10⁻⁹', 'no value'."""
    if math.isinf(error):
        return "no value"
    return f"{given(100.0 * error, 3)} %" if error >= LEAST_SHARE else number(error, 2)


def cells(row: TimedRow) -> tuple[str | float, ...]:
    """Return method, discretisation, error, and the medians of the whole, of assembly and of solve in s."""
    times = row.total.median, median(row.assembly), median(row.solve)
    return (row.curve, row.division, share(row.error), *times)


def json_text(findings: Findings, timings: Timings) -> str:
    """Return the study as JSON text; times in seconds, every run; an error that is infinite is null."""
    study = findings.study
    quantities = []
    for quantity in timings.quantities:
        rows, best = quantity.rows, fastest(quantity.rows, timings.tolerance)
        runs = []
        for row in rows:
            total = asdict(row.total)
            of_total = {"runs": total.pop("runs"), **{f"{key}_s": t for key, t in total.items()}}
            runs.append(
                {
                    "method": row.curve,
                    "division": row.division,
                    "size": row.size,
                    "error": finite(row.error),
                    "errors": [finite(error) for error in row.errors],
                    "total": of_total,
                    "assembly_s": row.assembly,
                    "solve_s": row.solve,
                }
            )
        quantities.append(
            {
                "key": quantity.key,
                "title": quantity.title,
                "meaning": quantity.meaning,
                "reference": {"what": quantity.reference, "bound": finite(quantity.bound)},
                "highest_Hz": quantity.highest,
                "errors_are_of": quantity.columns,
                "recommendation": recommendation(quantity, timings.tolerance),
                "recommended_row": None if best is None else rows.index(best),
                "unbeaten_rows": [rows.index(row) for row in unbeaten(rows, quantity.bound)],
                "remarks": quantity.remarks,
                "rows": runs,
            }
        )
    values = {
        "format": FORMAT,
        "program": {"name": "torsion", "version": torsion.__version__},
        "scene": {"name": study.name, "file": study.shown_file, "sha256": checksum(study)},
        "tolerance": timings.tolerance,
        "rounds": timings.rounds,
        "machine": dict(timings.machine),
        "remarks": timings.remarks,
        "quantities": quantities,
    }
    return json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
