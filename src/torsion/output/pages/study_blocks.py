"""Chapters of the study of run times: what to take, each quantity, how the times were taken, all rows."""

import math
from typing import Literal

import numpy as np

from torsion.analyses.study.rows import Spread, TimedQuantity, TimedRow, Timings, fastest, unbeaten
from torsion.analyses.study.timing import SLOW, SLOW_ROUNDS
from torsion.output.blocks import Block, Column, Figure, Heading, KeyValues, Paragraph, Points, Table
from torsion.output.terminal.study import alternatives, cells, doubt, milliseconds, recommendation, share

FAMILIES = (  # start of a method's name, and how it is drawn
    ("modal superposition, static", "corrected"), ("modal superposition", "modal"), ("lumped, dense", "dense"),
    ("dense", "dense"), ("lumped", "lumped"), ("fem", "fem"), ("exact", "exact"), ("two-sided", "exact"),
)  # fmt: skip
MODAL = (
    "The superpositions take modes of the exact model, so that they have no error of division. Each mode is damped by "
    "itself: where damping couples the modes, that error stays, however many modes there are."
)
PARETO = "Methods that no other beats: none is both faster and more accurate"


def blocks(timings: Timings) -> list[Block]:
    """The whole report but for cover and source."""
    made: list[Block] = [Heading("What to take"), *_summary(timings)]
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
        kind: Literal["pass", "fail"] = "pass" if fastest(quantity.rows, timings.tolerance) is not None else "fail"
        made.append(Paragraph(f"{quantity.title}. {recommendation(quantity, timings.tolerance)}", kind))
    if timings.remarks:
        made.append(Points(timings.remarks))
    return made


def _chapter(quantity: TimedQuantity, tolerance: float) -> list[Block]:
    rows = unbeaten(quantity.rows, quantity.bound)
    best = fastest(quantity.rows, tolerance)
    columns = (
        Column("Method", align="left"), Column("Division", align="left"), Column("Error"), Column("Median", "ms"),
        Column("Assembly", "ms"), Column("Solve", "ms"), Column("", align="left"),
    )  # fmt: skip
    marks = tuple("pass" if row is best else "" for row in rows)
    made: list[Block] = [
        Heading(quantity.title),
        Paragraph(quantity.meaning),
        Paragraph(f"{quantity.reference} Here it is {share(quantity.bound)}."),
        _figure(quantity, tolerance),
        Table(columns, tuple((*cells(row), "recommended" if row is best else "") for row in rows), PARETO, marks),
    ]
    sentences = (alternatives(quantity, tolerance), doubt(quantity, tolerance))
    made += [Paragraph(text, "note") for text in sentences if text]
    if any(row.curve.startswith("modal") for row in quantity.rows):
        made.append(Paragraph(MODAL))
    if quantity.remarks:
        made.append(Points(quantity.remarks))
    return made


def _figure(quantity: TimedQuantity, tolerance: float) -> Figure:
    curves = []
    for name in dict.fromkeys(row.curve for row in quantity.rows):
        rows = [row for row in quantity.rows if row.curve == name and math.isfinite(row.error)]
        if rows:
            totals = [row.total for row in rows]
            times = [1e3 * np.array([getattr(one, part) for one in totals]) for part in ("median", "quarter")]
            high = 1e3 * np.array([one.three_quarters for one in totals])
            errors = np.array([row.error for row in rows])
            curves.append((_label(name), _family(name), _degree(name), *times, high, errors))
    best = fastest(quantity.rows, tolerance)
    point = None if best is None else (1e3 * best.total.median, best.error)
    values = {"curves": curves, "tolerance": tolerance, "bound": quantity.bound, "best": point}
    caption = f"{quantity.title}: largest relative error against run time, one curve a method, finer divisions below"
    return Figure(f"study-{quantity.key}", caption, "study", values)


def _label(name: str) -> str:
    return name.replace(", elimination", "").replace("modal superposition, static correction", "modal, static corr.")


def _family(name: str) -> str:
    return next(family for start, family in FAMILIES if name.startswith(start))


def _degree(name: str) -> int:
    """Of finite elements; 0 for all else."""
    return int(name.split()[2].rstrip(",")) if name.startswith("fem") else 0


def _all(quantity: TimedQuantity) -> Table:
    columns = (
        Column("Method", align="left"), Column("Division", align="left"), Column("Error"), Column("Least", "ms"),
        Column("Quarter", "ms"), Column("Median", "ms"), Column("Three quarters", "ms"), Column("Assembly", "ms"),
        Column("Solve", "ms"), Column("Runs"),
    )  # fmt: skip
    return Table(columns, tuple(_row(row) for row in quantity.rows), f"{quantity.title}: every method and division")


def _row(row: TimedRow) -> tuple[str, ...]:
    total = row.total
    spreads: tuple[Spread, Spread] = (row.assembly_spread, row.solve_spread)
    times = (total.least, total.quarter, total.median, total.three_quarters, *(one.median for one in spreads))
    return (row.curve, row.division, share(row.error), *(milliseconds(time) for time in times), str(total.runs))


def _how(timings: Timings) -> tuple[str, ...]:
    turns = (
        "Every method is run once before, which warms up, gives its error and is no sample. Then all methods have "
        f"their turn in {timings.rounds} rounds, a fast one several times in a turn, one slower than "
        f"{SLOW:g} s in {SLOW_ROUNDS} of them, so that a slow minute of the machine falls on all alike."
    )
    steps = (
        "Every run assembles the train anew and solves it; the two are timed apart. Assembly: from the train as it "
        "was read to the system with its tree and the laws of its shafts, in the response also sources and matrices. "
        "Not counted: reading the file, finding out how fine the exact model must be, writing a report."
    )
    told = "Times are told by median and middle half of the runs; garbage is not collected during a run."
    return turns, steps, told, "All times are of this program in Python; another program has others."
