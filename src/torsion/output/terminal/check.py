"""The tables of the models side by side on the terminal, narrow enough for 80 columns."""

from pathlib import Path

from rich.console import Console, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from torsion.analyses.check.models import Compared
from torsion.findings import Findings
from torsion.output.chapters import model_comparison as chapter
from torsion.output.numbers import number
from torsion.output.pages.check import PAGE
from torsion.output.terminal.grids import COLOURS, filled, grid, printed


def show_check(findings: Findings, folder: Path | None = None, console: Console | None = None) -> None:
    """Print the tables and the verdict, and where the report is."""
    screen = console or Console()
    screen.print(Text(findings.study.name, style="bold"))
    for item in check_grids(findings):
        screen.print(item)
    if folder is not None:
        screen.print(Text(f"Report: {folder / PAGE}"))


def check_grids(findings: Findings) -> list[RenderableType]:
    """Frequencies with their errors, the largest errors of every model, and the verdict last."""
    found = findings.get(Compared)
    if found is None:
        return []
    if found.exact is None:
        return [printed(chapter.conclusion(found))]
    places = [Text(f"- torques of {text}") for model in found.models if (text := chapter.worst(model, found))]
    lacking = [Text(f"- no torques are compared: {found.no_torques}")] if found.no_torques else []
    return [_modes(found), largest_errors(found), *places, *lacking, printed(chapter.counts(found)),
            printed(chapter.conclusion(found))]  # fmt: skip


def _modes(found: "Compared") -> Grid:
    heads = [(f"{model.model}, error %", ">") for model in found.models]
    made = grid("Natural frequencies", ("mode", ">"), ("exact, Hz", ">"), *heads)
    exact = [] if found.exact is None else found.exact.frequency.tolist()
    errors = [100.0 * model.frequency_error for model in found.models]
    rows = [
        [str(mode + 1), number(frequency, 9), *(number(float(error[mode]), 3) for error in errors)]
        for mode, frequency in enumerate(exact)
    ]
    return filled(made, rows)


def largest_errors(found: "Compared") -> Grid:
    """The largest errors of every model, and its verdict; without a row where all models are the same."""
    heads = (("model", "<"), ("frequency, %", ">"), ("1 - MAC, %", ">"), ("torques, %", ">"), ("modes", ">"))
    made = grid("Largest errors against the exact model", *heads, ("ms", ">"), ("verdict", "<"))
    if found.exact is None:
        return made
    table = chapter.summary(found)
    for row, mark, model in zip(table.rows, table.marks, (found.exact, *found.models), strict=True):
        cells = (*row[:5], number(1e3 * (model.modes_seconds + model.torques_seconds), 3))
        verdict = Text(row[-1] if mark else "", style=COLOURS.get(mark, ""))
        made.add_row(*(Text(cell) for cell in cells), verdict)
    return made
