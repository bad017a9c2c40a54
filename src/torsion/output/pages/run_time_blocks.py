"""The study of run times in sentences, tables and figures: what to take, each quantity, how the times were taken."""

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from torsion.analyses.compare.timing import FULL, TimedQuantity, TimedRow, Timings, as_fast, fastest, unbeaten
from torsion.output.blocks import (
    Block,
    Column,
    Figure,
    Heading,
    KeyValues,
    Paragraph,
    Points,
    Table,
    on_terminal,
    texts,
)
from torsion.output.numbers import given, number

DIGITS = 3
MOST_AS_FAST = 3
LEAST_SHARE = 1e-4  # from which an error is given in per cent
NAMED = (texts("Method", "method"), texts("Discretisation", "discretisation"), Column("Error", short="error"))
FAMILIES = (  # start of a method's name, and how it is drawn
    ("modal superposition, static", "corrected"), ("modal superposition", "modal"), ("lumped, dense", "dense"),
    ("dense", "dense"), ("lumped", "lumped"), ("fem", "fem"), ("exact", "exact"), ("two-sided", "exact"), ("", "peer"),
)  # fmt: skip
MODAL = (
    "The superpositions take modes of the exact model, so that they have no discretisation error. Each mode is damped "
    "by itself: where damping couples the modes, that error stays, however many modes there are."
)
PARETO = "Methods that no other beats: none is both faster and more accurate"


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
        kind: Literal["pass", "fail"] = "pass" if fastest(quantity.rows, timings.tolerance) is not None else "fail"
        made.append(Paragraph(f"{quantity.title}. {recommendation(quantity, timings.tolerance)}", kind))
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
    columns = (
        *NAMED,
        Column("Median", "ms", short="ms"),
        Column("Assembly", "ms", short="assembly"),
        Column("Solve", "ms", short="solve"),
        Column("", align="left"),
    )
    marks = tuple("pass" if row is recommended else "" for row in rows)
    lines = tuple((*cells(row), "recommended" if mark else "") for row, mark in zip(rows, marks, strict=True))
    return Table(columns, lines, PARETO, marks, f"{quantity.title}: no other method is both faster and more accurate")


def _figure(quantity: TimedQuantity, tolerance: float) -> Figure:
    best = fastest(quantity.rows, tolerance)
    point = None if best is None else (1e3 * best.total.median, best.error)
    values = {"curves": curves(quantity.rows), "tolerance": tolerance, "bound": quantity.bound, "best": point}
    caption = f"{quantity.title}: largest relative error against run time, one curve a method, finer ones below"
    return Figure(f"study-{quantity.key}", caption, "study", values)


def curves(rows: Sequence[TimedRow]) -> list[tuple[Any, ...]]:
    """What the figure draws of every method: label, family, degree, medians and quartiles in ms, errors."""
    made = list[tuple[Any, ...]]()
    for name in dict.fromkeys(row.curve for row in rows):
        own = [row for row in rows if row.curve == name and math.isfinite(row.error)]
        if own:
            totals = [(one.median, one.quarter, one.three_quarters) for one in (row.total for row in own)]
            times = 1e3 * np.array(totals).T
            made.append((_label(name), _family(name), _degree(name), *times, np.array([row.error for row in own])))
    return made


def _label(name: str) -> str:
    return name.replace(", elimination", "").replace("modal superposition, static correction", "modal, static corr.")


def _family(name: str) -> str:
    return next(family for start, family in FAMILIES if name.startswith(start))


def _degree(name: str) -> int:
    """Of finite elements; 0 for all else."""
    return int(name.split()[2].rstrip(",")) if name.startswith("fem") else 0


def _all(quantity: TimedQuantity) -> Table:
    heads = ("Least", "Quarter", "Median", "Three quarters", "Assembly", "Solve")
    columns = (*NAMED, *(Column(head, "ms") for head in heads), Column("Runs"))
    return Table(columns, tuple(_row(row) for row in quantity.rows), f"{quantity.title}: every method, every run")


def _row(row: TimedRow) -> tuple[str, ...]:
    total = row.total
    times = (total.least, total.quarter, total.median, total.three_quarters, *_parts(row))
    return (row.curve, row.division, share(row.error), *(milliseconds(time) for time in times), str(total.runs))


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
    return rounds, steps, spread, "All times are of this program in Python; another program has others."


def recommendation(quantity: TimedQuantity, tolerance: float) -> str:
    """Which method to take, in one sentence: 'For 0.1 % up to 120 Hz: lumped, 8 segments, 0.4 ms (error 0.03 %).'"""
    best = fastest(quantity.rows, tolerance)
    goal = f"{share(tolerance)} up to {given(quantity.highest, DIGITS)} Hz"
    if best is None:
        nearest = min(quantity.rows, key=lambda row: row.error)
        return f"For {goal}: no method that was run is as accurate; the nearest is {_words(nearest)}."
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
    if error == float("inf"):
        return "no value"
    return f"{given(100.0 * error, DIGITS)} %" if error >= LEAST_SHARE else number(error, 2)


def milliseconds(seconds: float) -> str:
    """A time in ms."""
    return number(1e3 * seconds, DIGITS)


def _words(row: TimedRow) -> str:
    return f"{row.curve}, {row.division}, {milliseconds(row.total.median)} ms (error {share(row.error)})"


def cells(row: TimedRow) -> tuple[str, ...]:
    """Method, discretisation, error, medians of the whole, of assembly and of solve."""
    parts = (row.total.median, *_parts(row))
    return (row.curve, row.division, share(row.error), *(milliseconds(part) for part in parts))


def _parts(row: TimedRow) -> tuple[float, float]:
    return row.assembly_spread.median, row.solve_spread.median
