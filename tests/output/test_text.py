"""The tables of the terminal."""

import io
from pathlib import Path

from rich.console import Console

import torsion
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.numbers import number, rpm
from torsion.output.pages.terminal import progress, show
from torsion.rules.verdict_line import WORDS, Checks


def printed(findings: Findings) -> str:
    """What the terminal shows."""
    stream = io.StringIO()
    show(document(findings), Path("reports/x"), Console(file=stream, width=200, color_system=None))
    return stream.getvalue()


def test_the_terminal_shows_verdicts_frequencies_and_the_place_of_the_report(
    train: Findings, nasty: str
) -> None:
    text = printed(train)
    for check in train.need(Checks).lines:
        assert WORDS[check.verdict] in text
    for frequency in train.need(Modes).frequency.tolist():
        assert number(frequency, 7) in text
    assert str(Path("reports/x/report.html")) in text


def test_a_name_is_no_markup_of_the_terminal(train: Findings, nasty: str) -> None:
    assert "[a](b)" in "".join(printed(train).split())  # rich would take [a] for a style


def test_no_amplitude_is_told_at_a_speed_without_a_reliable_one(undamped: Findings) -> None:
    """The torque grows without limit towards the resonance: the largest of the range is not that of any speed."""
    assert undamped.need(Response).unreliable.any()
    assert not undamped.need(Response).unreliable.all()
    assert "coupling-1 no reliable value –" in " ".join(printed(undamped).split())
    assert (
        "The report states no amplitude at these speeds and no maximum over the range."
        in " ".join(printed(undamped).split())
    )


def test_the_largest_torque_is_that_of_the_synthesis_at_its_speed(train: Findings) -> None:
    stated = printed(train).split("Maximum vibratory torque")[1].split("rubber")[1].split()[:2]
    (span,) = [k for k, span in enumerate(train.system.spans) if span.name == "rubber"]
    half = train.need(Synthesis).half_range[:, span]
    assert stated == [
        number(float(half.max())),
        rpm(float(train.need(Response).speed[half.argmax()])),
    ]


def test_progress_fills_its_bar_on_the_error_stream(capsys, monkeypatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    for share, is_full in ((1.0, True), (0.5, False)):
        with progress() as report:
            report("modes [of all]", share)
        printed = capsys.readouterr()
        assert printed.out == ""
        assert "modes [of all]" in printed.err
        last = printed.err.rpartition("modes [of all]")[2]
        assert ("━" * 40 in last) is is_full  # without a change of colour between its parts


def test_progress_is_silent_where_there_is_no_terminal(capsys: object) -> None:
    with progress() as tell:
        tell("response [bold]", 0.5)


def test_words_of_a_verdict_are_whole_on_80_columns() -> None:
    scene = Path(__file__).parents[2] / "shafting_specs" / "haixun_06402.yaml"
    narrow = Console(width=80, record=True, file=io.StringIO())
    show(document(torsion.run(torsion.read(scene))), console=narrow)
    printed = narrow.export_text()
    assert "…" not in printed
    assert max(map(len, printed.splitlines())) <= 80
    tight = Console(width=64, record=True, file=io.StringIO())
    show(document(torsion.run(torsion.read(scene))), console=tight)
    assert "≥   98.682" in tight.export_text()  # words may be cut, numbers never
