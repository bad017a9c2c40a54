"""The study of error against run time: a sentence and a table for each quantity, and every run as JSON."""

import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from datetime import date
from pathlib import Path
from typing import Any

import torsion
from torsion.analyses.compare.timing import (
    FULL,
    Spread,
    TimedQuantity,
    TimedRow,
    Timings,
    as_fast,
    fastest,
    unbeaten,
)
from torsion.findings import Findings
from torsion.output.blocks import (
    Block,
    Heading,
    KeyValues,
    Paragraph,
    Points,
    Table,
    on_terminal,
    table,
)
from torsion.output.document import Document, document
from torsion.output.html import html
from torsion.output.numbers import given, number
from torsion.output.plain import finite
from torsion.output.reports import REPORTS
from torsion.output.scene import checksum
from torsion.output.write import inputs, write_texts

FORMAT = 1
DIGITS = 3
LEAST_SHARE = 1e-4  # from which an error is given in per cent
MODAL = (
    "The superpositions take modes of the exact model, so that they have no discretisation error. Each mode is damped "
    "by itself: where damping couples the modes, that error stays, however many modes there are."
)
HOW = (
    (
        "Every method is run once before, which warms up, gives its error and is no sample. Then all methods run one after "
        "another in {rounds} rounds, a fast one several times a round, one slower than {slow:g} s in {slow_rounds} of "
        "them, so that a slow minute of the machine falls on all alike."
    ),
    (
        "Every run assembles the train anew and solves it; the two are timed apart. Assembly: from the train as it was "
        "read to the system with its tree and the laws of its shafts, in the response also sources and matrices. Not "
        "counted: reading the file, finding out how fine the exact model must be, writing a report."
    ),
    "Times are given by median and middle half of the runs; garbage is not collected during a run.",
    "All times are of this program in Python; another program has others.",
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
    summary: list[Block] = []
    for quantity in timings.quantities:
        best = fastest(quantity.rows, timings.tolerance)
        sentence = f"{quantity.title}. {recommendation(quantity, timings.tolerance)}"
        summary.append(Paragraph(sentence, "fail" if best is None else "pass"))
    if timings.remarks:
        summary.append(Points(timings.remarks))
    yield Heading("What to take", at_end=True)
    yield from on_terminal(summary)

    for quantity in timings.quantities:
        yield Heading(quantity.title)
        yield Paragraph(quantity.meaning)
        yield Paragraph(f"{quantity.reference} Here it is {share(quantity.bound)}.")
        yield methods(quantity, timings.tolerance)
        if quantity.bound > timings.tolerance / 10.0:
            yield Paragraph(
                f"The bound of the reference, {share(quantity.bound)}, is not a tenth of the tolerance: take more "
                "than that.",
                "note",
            )
        if any(row.curve.startswith("modal") for row in quantity.rows):
            yield Paragraph(MODAL)
        if quantity.remarks:
            yield Points(quantity.remarks)

    yield Heading("How the times were taken")
    numbers = {"rounds": timings.rounds, "slow": FULL.slow, "slow_rounds": FULL.slow_rounds}
    yield Points(tuple(sentence.format(**numbers) for sentence in HOW))
    yield KeyValues(timings.machine)


def methods(quantity: TimedQuantity, tolerance: float) -> Table:
    """Return every method and discretisation with its error and run times, and what makes it worth taking."""
    best, rivals = fastest(quantity.rows, tolerance), as_fast(quantity.rows, tolerance)
    rows = []
    for row in quantity.rows:
        remark = "as fast" if row in rivals else ""
        if row in unbeaten(quantity.rows, quantity.bound):
            remark = "recommended" if row is best else remark or "not beaten"
        quartiles = [milliseconds(getattr(row.total, key)) for key in ("quarter", "three_quarters")]
        rows.append((*cells(row), *quartiles, row.total.runs, remark))
    return table(
        "< Method -> | < Discretisation -> | Error -> | Median [ms] -> ms | Assembly [ms] | Solve [ms] | "
        "Quarter [ms] | Three quarters [ms] | Runs | < Remark ->",
        rows,
        f"{quantity.title}: error and run time of every method. Not beaten: no other is faster and more accurate. As "
        "fast: within the spread of the runs",
        marks=["pass" if row[-1] == "recommended" else "" for row in rows],
        short=f"{quantity.title}: error and run time",
    )


def recommendation(quantity: TimedQuantity, tolerance: float) -> str:
    """Return which method to take: 'For 0.1 % up to 120 Hz: lumped, 8 segments, 0.4 ms (error 0.03 %).'"""
    best = fastest(quantity.rows, tolerance)
    goal = f"{share(tolerance)} up to {given(quantity.highest, DIGITS)} Hz"
    row = best or min(quantity.rows, key=lambda row: row.error)
    words = f"{row.curve}, {row.division}, {milliseconds(row.total.median)} ms (error {share(row.error)})."
    if best is None:
        words = f"no method that was run is as accurate; the nearest is {words}"
    return f"For {goal}: {words}"


def share(error: float) -> str:
    """Return a relative error: '0.1 %', '2.3·10⁻⁹', 'no value'."""
    if math.isinf(error):
        return "no value"
    return f"{given(100.0 * error, DIGITS)} %" if error >= LEAST_SHARE else number(error, 2)


def milliseconds(seconds: float) -> str:
    """Return a time in ms, with three digits."""
    return number(1e3 * seconds, DIGITS)


def cells(row: TimedRow) -> tuple[str, ...]:
    """Return method, discretisation, error, and the medians of the whole, of assembly and of solve in ms."""
    times = row.total, row.assembly_spread, row.solve_spread
    return (row.curve, row.division, share(row.error), *(milliseconds(t.median) for t in times))


def json_text(findings: Findings, timings: Timings) -> str:
    """Return the study as JSON text; times in seconds, every run; an error that is infinite is null."""
    study = findings.study
    values = {
        "format": FORMAT,
        "program": {"name": "torsion", "version": torsion.__version__},
        "scene": {"name": study.name, "file": study.shown_file, "sha256": checksum(study)},
        "tolerance": timings.tolerance,
        "rounds": timings.rounds,
        "machine": dict(timings.machine),
        "remarks": timings.remarks,
        "quantities": [_quantity(quantity, timings.tolerance) for quantity in timings.quantities],
    }
    return json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _quantity(quantity: TimedQuantity, tolerance: float) -> dict[str, Any]:
    rows, best = quantity.rows, fastest(quantity.rows, tolerance)
    return {
        "key": quantity.key,
        "title": quantity.title,
        "meaning": quantity.meaning,
        "reference": {"what": quantity.reference, "bound": finite(quantity.bound)},
        "highest_Hz": quantity.highest,
        "errors_are_of": quantity.columns,
        "recommendation": recommendation(quantity, tolerance),
        "recommended_row": None if best is None else rows.index(best),
        "unbeaten_rows": [rows.index(row) for row in unbeaten(rows, quantity.bound)],
        "remarks": quantity.remarks,
        "rows": [_row_as_data(row) for row in rows],
    }


def _row_as_data(row: TimedRow) -> dict[str, Any]:
    def in_seconds(spread: Spread) -> dict[str, Any]:
        return {
            key if key == "runs" else f"{key}_s": value for key, value in asdict(spread).items()
        }

    return {
        "method": row.curve,
        "division": row.division,
        "size": row.size,
        "error": finite(row.error),
        "errors": [finite(error) for error in row.errors],
        "total": in_seconds(row.total),
        "assembly": in_seconds(row.assembly_spread),
        "solve": in_seconds(row.solve_spread),
        "assembly_s": row.assembly,
        "solve_s": row.solve,
    }
