"""The tables of the terminal."""

import io
from pathlib import Path

from rich.console import Console

from torsion.findings import Findings
from torsion.report.numbers import number
from torsion.report.terminal.tables import progress, show


def printed(findings: Findings) -> str:
    """What the terminal shows."""
    stream = io.StringIO()
    show(findings, Path("reports/x"), Console(file=stream, width=200, color_system=None))
    return stream.getvalue()


def test_the_terminal_shows_verdicts_frequencies_and_the_place_of_the_report(train: Findings, nasty: str) -> None:
    text = printed(train)
    for check in train.checks:
        assert check.verdict.upper().removeprefix("TO BE ").removesuffix("IED") in text
    for frequency in train.modes.frequency.tolist():
        assert number(frequency, 7) in text
    assert str(Path("reports/x/report.html")) in text


def test_a_name_is_no_markup_of_the_terminal(train: Findings, nasty: str) -> None:
    assert "[a](b)" in "".join(printed(train).split())  # rich would take [a] for a style


def test_progress_is_silent_where_there_is_no_terminal(capsys: object) -> None:
    with progress() as tell:
        tell("response [bold]", 0.5)
