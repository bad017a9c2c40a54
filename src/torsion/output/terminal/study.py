"""The study of run times in sentences, and its tables on the terminal."""

from pathlib import Path

from rich.console import Console
from rich.text import Text

from torsion.analyses.study.rows import TimedQuantity, TimedRow, Timings, as_fast, fastest, unbeaten
from torsion.findings import Findings
from torsion.output.numbers import given, number
from torsion.output.terminal.grids import filled, grid

PAGE = "study.html"
DIGITS = 3
MOST_AS_FAST = 3
LEAST_SHARE = 1e-4  # from which an error is told in per cent


def recommendation(quantity: TimedQuantity, tolerance: float) -> str:
    """Which method to take, in one sentence: 'For 0.1 % up to 120 Hz: lumped, 8 segments, 0.4 ms (error 0.03 %).'"""
    best = fastest(quantity.rows, tolerance)
    goal = f"{share(tolerance)} up to {given(quantity.highest, DIGITS)} Hz"
    if best is None:
        nearest = min(quantity.rows, key=lambda row: row.error)
        return f"For {goal}: no method that was run is as accurate; the nearest is {_told(nearest)}."
    return f"For {goal}: {_told(best)}."


def alternatives(quantity: TimedQuantity, tolerance: float) -> str:
    """Which methods the runs cannot tell from the recommended one; '' where none."""
    others = sorted(as_fast(quantity.rows, tolerance), key=lambda row: row.total.median)
    if not others:
        return ""
    more = f" and {len(others) - MOST_AS_FAST} more" if len(others) > MOST_AS_FAST else ""
    return f"As fast within the spread of the runs: {'; '.join(_told(row) for row in others[:MOST_AS_FAST])}{more}."


def doubt(quantity: TimedQuantity, tolerance: float) -> str:
    """A warning where the reference is not much better than what is asked; '' where it is."""
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


def _told(row: TimedRow) -> str:
    return f"{row.curve}, {row.division}, {milliseconds(row.total.median)} ms (error {share(row.error)})"


def show_study(
    findings: Findings, timings: Timings, folder: Path | None = None, console: Console | None = None
) -> None:
    """Print the methods that no other beats, the recommendations, and where the report is."""
    screen = console or Console()
    screen.print(Text(findings.study.name, style="bold"))
    heads = (("method", "<"), ("division", "<"), ("error", ">"), ("ms", ">"), ("assembly", ">"), ("solve", ">"))
    for quantity in timings.quantities:
        made = grid(f"{quantity.title}: no other method is both faster and more accurate", *heads)
        screen.print(filled(made, [list(cells(row)) for row in unbeaten(quantity.rows, quantity.bound)]))
    for remark in timings.remarks:
        screen.print(Text(f"- {remark}"))
    for quantity in timings.quantities:
        screen.print(Text(f"{quantity.title}. {recommendation(quantity, timings.tolerance)}", style="green"))
    if folder is not None:
        screen.print(Text(f"Report: {folder / PAGE}"))


def cells(row: TimedRow) -> tuple[str, ...]:
    """Method, division, error, medians of the whole, of assembly and of solve."""
    parts = (row.total.median, row.assembly_spread.median, row.solve_spread.median)
    return (row.curve, row.division, share(row.error), *(milliseconds(part) for part in parts))
