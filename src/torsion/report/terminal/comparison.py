"""The models side by side and the study of run times on the terminal: tables and sentences of their reports."""

from pathlib import Path

from rich.console import Console, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from torsion.analyses.compare.side_by_side import Compared
from torsion.analyses.compare.timing import Timings
from torsion.findings import Findings
from torsion.report.blocks import Paragraph, Points
from torsion.report.chapters import model_comparison as chapter
from torsion.report.pages.comparison_pages import CHECK, STUDY
from torsion.report.pages.run_time_blocks import best, recommendation
from torsion.report.terminal.grids import printed, tabled

LARGEST = "Largest errors against the exact model"


def show_check(findings: Findings, folder: Path | None = None, console: Console | None = None) -> None:
    """Print the tables and the verdict of the models side by side, and where the report is."""
    _show(findings, check_grids(findings), folder and folder / CHECK, console)


def show_study(
    findings: Findings, timings: Timings, folder: Path | None = None, console: Console | None = None
) -> None:
    """Print the methods that no other beats, the recommendations, and where the report is."""
    shown: list[RenderableType] = [
        tabled(
            best(one, timings.tolerance), f"{one.title}: no other method is both faster and more accurate", *range(6)
        )
        for one in timings.quantities
    ]
    shown += [printed(Points(timings.remarks))] if timings.remarks else []
    for one in timings.quantities:
        shown.append(printed(Paragraph(f"{one.title}. {recommendation(one, timings.tolerance)}", "pass")))
    _show(findings, shown, folder and folder / STUDY, console)


def _show(findings: Findings, items: list[RenderableType], page: Path | None, console: Console | None) -> None:
    screen = console or Console()
    for item in (Text(findings.study.name, style="bold"), *items):
        screen.print(item)
    if page is not None:
        screen.print(Text(f"Report: {page}"))


def check_grids(findings: Findings) -> list[RenderableType]:
    """Frequencies with their errors, the largest errors of every model, and the verdict last."""
    found = findings.get(Compared)
    if found is None:
        return []
    if found.exact is None:
        return [printed(chapter.conclusion(found))]
    errors = range(3, 3 * len(found.models) + 1, 3)
    shown: list[RenderableType] = [tabled(chapter.modes(found), "Natural frequencies", 0, 1, *errors)]
    shown.append(tabled(chapter.summary(found), LARGEST))
    shown += [Text(f"- torques of {text}") for model in found.models if (text := chapter.worst(model, found))]
    if found.no_torques:
        shown.append(Text(f"- no torques are compared: {found.no_torques}"))
    return [*shown, printed(chapter.counts(found)), printed(chapter.conclusion(found))]


def largest_errors(findings: Findings) -> Grid | None:
    """The largest errors of every model, and its verdict; None where no models were compared."""
    found = findings.get(Compared)
    return None if found is None or found.exact is None else tabled(chapter.summary(found), LARGEST)
