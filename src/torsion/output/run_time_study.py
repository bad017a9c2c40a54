"""The study of error against run time: its report in sentences, tables and figures, its JSON and its CSV."""

import csv
import io
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from datetime import date
from pathlib import Path
from typing import Any, Literal

import numpy as np

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
    head,
    on_terminal,
)
from torsion.output.document import Document, document
from torsion.output.figures import error_curves
from torsion.output.figures.figure import Figure
from torsion.output.numbers import given, number
from torsion.output.plain import finite
from torsion.output.reports import REPORTS
from torsion.output.scene import checksum
from torsion.output.write import inputs, write_texts

FORMAT = 1
TITLES = (
    "quantity",
    "method",
    "division",
    "size",
    "error [1]",
    "least [s]",
    "quarter [s]",
    "median [s]",
    "three quarters [s]",
    "median assembly [s]",
    "median solve [s]",
    "runs",
)
DIGITS = 3
MOST_AS_FAST = 3
LEAST_SHARE = 1e-4  # from which an error is given in per cent
SHORTER = "modal superposition, static correction", "modal, static corr."  # in the figure
FAMILIES = (  # start of a method's name, and how it is drawn
    ("modal superposition, static", "corrected"),
    ("modal superposition", "modal"),
    ("lumped, dense", "dense"),
    ("dense", "dense"),
    ("lumped", "lumped"),
    ("fem", "fem"),
    ("exact", "exact"),
    ("two-sided", "exact"),
    ("", "peer"),
)
MODAL = (
    "The superpositions take modes of the exact model, so that they have no discretisation error. Each mode is damped "
    "by itself: where damping couples the modes, that error stays, however many modes there are."
)
PARETO = "Methods that no other beats: none is both faster and more accurate"


def write_study(
    findings: Findings, timings: Timings, folder: str | Path, *, today: date | None = None
) -> Document:
    """Write study.html, study.json and study.csv, all or none; raises OSError where the folder cannot be written."""
    from torsion.output.html import html

    report = REPORTS["study"]
    made = document(findings, today or date.today(), report=report, before=blocks(timings))
    texts = {"html": html(made), "json": json_text(findings, timings), "csv": csv_text(timings)}
    contents = {f"{report.stem}.{suffix}": content for suffix, content in texts.items()}
    write_texts(contents, folder, inputs(findings.study))
    return made


def blocks(timings: Timings) -> list[Block]:
    """The whole report but for cover and source."""
    made: list[Block] = [Heading("What to take", at_end=True), *on_terminal(_summary(timings))]
    for quantity in timings.quantities:
        made += _chapter(quantity, timings.tolerance)
    made += [Heading("How the times were taken"), Points(_how(timings)), KeyValues(timings.machine)]
    if timings.quantities:
        made.append(Heading("All runs"))
        made += [_all(quantity) for quantity in timings.quantities]
    return made


def _summary(timings: Timings) -> list[Block]:
    made: list[Block] = []
    for quantity in timings.quantities:
        kind: Literal["pass", "fail"] = (
            "pass" if fastest(quantity.rows, timings.tolerance) is not None else "fail"
        )
        made.append(
            Paragraph(f"{quantity.title}. {recommendation(quantity, timings.tolerance)}", kind)
        )
    if timings.remarks:
        made.append(Points(timings.remarks))
    return made


def _chapter(quantity: TimedQuantity, tolerance: float) -> list[Block]:
    made: list[Block] = [
        Heading(quantity.title),
        Paragraph(quantity.meaning),
        Paragraph(f"{quantity.reference} Here it is {share(quantity.bound)}."),
        _figure(quantity, tolerance),
        best(quantity, tolerance),
    ]
    sentences = (alternatives(quantity, tolerance), doubt(quantity, tolerance))
    made += [Paragraph(text, "note") for text in sentences if text]
    if any(row.curve.startswith("modal") for row in quantity.rows):
        made.append(Paragraph(MODAL))
    if quantity.remarks:
        made.append(Points(quantity.remarks))
    return made


def best(quantity: TimedQuantity, tolerance: float) -> Table:
    """The methods that no other beats, and which of them is recommended."""
    rows, recommended = unbeaten(quantity.rows, quantity.bound), fastest(quantity.rows, tolerance)
    columns = "< Method -> | < Discretisation -> | Error -> | Median [ms] -> ms | Assembly [ms] -> | Solve [ms] -> | <"
    lines = tuple((*cells(row), "recommended" if row is recommended else "") for row in rows)
    marks = tuple("pass" if line[-1] else "" for line in lines)
    return Table(
        head(columns),
        lines,
        PARETO,
        marks,
        f"{quantity.title}: no other method is both faster and more accurate",
    )


def _figure(quantity: TimedQuantity, tolerance: float) -> Figure:
    best = fastest(quantity.rows, tolerance)
    point = None if best is None else (1e3 * best.total.median, best.error)
    caption = f"{quantity.title}: largest relative error against run time, one curve a method, finer ones below"
    return error_curves.run_times(
        f"study-{quantity.key}",
        caption,
        curves=curves(quantity.rows),
        tolerance=tolerance,
        bound=quantity.bound,
        best=point,
    )


def curves(rows: Sequence[TimedRow]) -> list[tuple[Any, ...]]:
    """What the figure draws of every method: label, family, degree, medians and quartiles in ms, errors."""
    made = list[tuple[Any, ...]]()
    for name in dict.fromkeys(row.curve for row in rows):
        own = [row for row in rows if row.curve == name and math.isfinite(row.error)]
        if own:
            totals = [
                (one.median, one.quarter, one.three_quarters) for one in (row.total for row in own)
            ]
            times = 1e3 * np.array(totals).T
            label = name.replace(", elimination", "").replace(*SHORTER)
            family = next(family for start, family in FAMILIES if name.startswith(start))
            degree = int(name.split()[2].rstrip(",")) if family == "fem" else 0
            made.append((label, family, degree, *times, np.array([row.error for row in own])))
    return made


def _all(quantity: TimedQuantity) -> Table:
    times = "Least [ms] | Quarter [ms] | Median [ms] | Three quarters [ms] | Assembly [ms] | Solve [ms] | Runs"
    columns = head(f"< Method -> | < Discretisation -> | Error -> | {times}")
    of = ("least", "quarter", "median", "three_quarters")
    rows = tuple((*cells(row, of), str(row.total.runs)) for row in quantity.rows)
    return Table(columns, rows, f"{quantity.title}: every method, every run")


def _how(timings: Timings) -> tuple[str, ...]:
    rounds = (
        "Every method is run once before, which warms up, gives its error and is no sample. Then all methods run "
        f"one after another in {timings.rounds} rounds, a fast one several times a round, one slower than "
        f"{FULL.slow:g} s in {FULL.slow_rounds} of them, so that a slow minute of the machine falls on all alike."
    )
    steps = (
        "Every run assembles the train anew and solves it; the two are timed apart. Assembly: from the train as it "
        "was read to the system with its tree and the laws of its shafts, in the response also sources and matrices. "
        "Not counted: reading the file, finding out how fine the exact model must be, writing a report."
    )
    spread = "Times are given by median and middle half of the runs; garbage is not collected during a run."
    return (
        rounds,
        steps,
        spread,
        "All times are of this program in Python; another program has others.",
    )


def recommendation(quantity: TimedQuantity, tolerance: float) -> str:
    """Which method to take, in one sentence: 'For 0.1 % up to 120 Hz: lumped, 8 segments, 0.4 ms (error 0.03 %).'"""
    best = fastest(quantity.rows, tolerance)
    goal = f"{share(tolerance)} up to {given(quantity.highest, DIGITS)} Hz"
    if best is None:
        nearest = min(quantity.rows, key=lambda row: row.error)
        return (
            f"For {goal}: no method that was run is as accurate; the nearest is {_words(nearest)}."
        )
    return f"For {goal}: {_words(best)}."


def alternatives(quantity: TimedQuantity, tolerance: float) -> str:
    """Which methods the runs do not distinguish from the recommended one; '' where none."""
    others = sorted(as_fast(quantity.rows, tolerance), key=lambda row: row.total.median)
    if not others:
        return ""
    more = f" and {len(others) - MOST_AS_FAST} more" if len(others) > MOST_AS_FAST else ""
    return f"As fast within the spread of the runs: {'; '.join(_words(row) for row in others[:MOST_AS_FAST])}{more}."


def doubt(quantity: TimedQuantity, tolerance: float) -> str:
    """A warning where the reference is not much better than the tolerance; '' where it is."""
    if quantity.bound <= tolerance / 10.0:
        return ""
    return f"The bound of the reference, {share(quantity.bound)}, is not a tenth of the tolerance: take more than that."


def share(error: float) -> str:
    """A relative error: '0.1 %', '2.3·10⁻⁹', 'none'."""
    if math.isinf(error):
        return "no value"
    return f"{given(100.0 * error, DIGITS)} %" if error >= LEAST_SHARE else number(error, 2)


def milliseconds(seconds: float) -> str:
    """A time in ms."""
    return number(1e3 * seconds, DIGITS)


def _words(row: TimedRow) -> str:
    return f"{row.curve}, {row.division}, {milliseconds(row.total.median)} ms (error {share(row.error)})"


def cells(row: TimedRow, of: Sequence[str] = ("median",)) -> tuple[str, ...]:
    """Method, discretisation, error, times `of` the whole, medians of assembly and of solve."""
    times = (
        *(getattr(row.total, name) for name in of),
        row.assembly_spread.median,
        row.solve_spread.median,
    )
    return (row.curve, row.division, share(row.error), *map(milliseconds, times))


def csv_text(timings: Timings) -> str:
    """One row a method and discretisation; numbers come back to the last digit, an infinite error is 'inf'."""
    target = io.StringIO()
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow(TITLES)
    for quantity in timings.quantities:
        for row in quantity.rows:
            total = row.total
            rows.writerow(
                [
                    quantity.key,
                    row.curve,
                    row.division,
                    row.size,
                    row.error,
                    total.least,
                    total.quarter,
                    total.median,
                    total.three_quarters,
                    row.assembly_spread.median,
                    row.solve_spread.median,
                    total.runs,
                ]
            )
    return target.getvalue()


def json_text(findings: Findings, timings: Timings) -> str:
    """The study as JSON text; times in seconds, every run; an error that is infinite is null."""
    study = findings.study
    values = {
        "format": FORMAT,
        "program": {"name": "torsion", "version": torsion.__version__},
        "scene": {"name": study.name, "file": study.shown_file, "sha256": checksum(study)},
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
        "unbeaten_rows": [
            quantity.rows.index(row) for row in unbeaten(quantity.rows, quantity.bound)
        ],
        "remarks": list(quantity.remarks),
        "rows": [_row_as_data(row) for row in quantity.rows],
    }


def _row_as_data(row: TimedRow) -> dict[str, Any]:
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
