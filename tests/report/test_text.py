"""The tables of the terminal."""

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.report.numbers import number, rpm
from torsion.report.reading import unreliable
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


def test_no_amplitude_is_told_at_a_speed_without_a_reliable_one(undamped: Findings) -> None:
    """Beside the resonance the answer is finite to rounding alone; what is told stands at another speed."""
    steps = int(undamped.response.speed.size)
    assert np.any(unreliable(undamped))
    assert not np.all(unreliable(undamped))
    told = printed(undamped).split("Largest vibratory torque")[1].split("coupling-1")[1].split()[:2]
    known = np.where(unreliable(undamped), -np.inf, undamped.synthesis.half_range[:, 0])
    assert told == [number(float(known.max())), rpm(float(undamped.response.speed[known.argmax()]))]
    nowhere = replace(undamped, response=replace(undamped.response, status=np.full((steps, 1), Status.NEAR_SINGULAR)))
    assert "coupling-1 no reliable value –" in " ".join(printed(nowhere).split())


def test_progress_is_silent_where_there_is_no_terminal(capsys: object) -> None:
    with progress() as tell:
        tell("response [bold]", 0.5)
