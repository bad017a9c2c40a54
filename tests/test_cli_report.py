"""`torsion report` on the command line: the same files and words as `solve`, without solving."""

import json
import zipfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

import torsion.runner
from torsion.cli import app
from torsion.errors import BAD_INPUT, FAILED_CHECK, SOLVED

FRONT = 'document: {document_number: TVC-1, revision: "2", vessel: Example Star, prepared: A. Engineer}\n'
SCENE = f"""name: line
{FRONT}operation: {{speeds: {{from: 300 rpm, to: 1800 rpm, steps: 21}}, rated: {{speed: 1500 rpm, power: 100 kW}}}}
train:
- motor: {{inertia: 1.2, ripple: [{{order: 2, torque: 5 %}}]}}
- coupling: {{stiffness: 20 kN*m/rad, psi: 0.8, rated_torque: 1.0 kN*m, vibratory_torque: LIMIT}}
- propeller: {{inertia: 0.8}}
rules: [coupling-maker]
"""


def call(*words: object, status: int = SOLVED) -> list[str]:
    """The lines on the screen."""
    done = CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "120"})
    assert done.exit_code == status, done.output
    return done.output.splitlines()


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "scene.yaml"
    file.write_text(SCENE.replace("LIMIT", "0.3 kN*m"), encoding="utf-8")
    return file


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_every_file_that_the_report_makes_is_the_same(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A figure of the PDF apart: it bears the moment at which it was set."""
    first, again = tmp_path / "first", tmp_path / "again"
    solved = call("solve", scene, "-o", first, "--csv", "--pdf")
    monkeypatch.delattr(torsion.runner, "run")
    drawn = call("report", first, "-o", again, "--csv", "--pdf")
    assert drawn[:-1] == solved[:-1]
    assert drawn[-1] == f"Report: {again / 'report.html'}"
    known, made = content(first), content(again)
    assert made.keys() == known.keys() - {"results.json", "data.zip"}
    assert {"report.html", "tables.zip"} < made.keys()
    assert any(name.startswith("figure-") for name in made)
    for name in made.keys() - {"report.pdf"}:
        assert made[name] == known[name]
    assert zipfile.ZipFile(again / "tables.zip").namelist()
    assert made["report.pdf"].startswith(b"%PDF-")


def test_the_report_is_drawn_beside_its_results_and_leaves_them(
    scene: Path, tmp_path: Path
) -> None:
    call("solve", scene, "-o", tmp_path / "out")
    (tmp_path / "out" / "series.npz").write_bytes(b"of these results")
    known = content(tmp_path / "out")
    (tmp_path / "out" / "report.html").unlink()
    call("report", tmp_path / "out" / "results.json")
    assert content(tmp_path / "out") == known


def test_the_exit_status_is_that_of_solve(scene: Path, tmp_path: Path) -> None:
    scene.write_text(SCENE.replace("LIMIT", "0.001 kN*m"), encoding="utf-8")
    call("solve", scene, "-o", tmp_path / "out", status=FAILED_CHECK)
    call("report", tmp_path / "out", status=FAILED_CHECK)


def test_what_has_no_answer_is_said_again(scene: Path, tmp_path: Path) -> None:
    text = scene.read_text(encoding="utf-8").replace(
        "rules: [coupling-maker]", "analyses: {modes: , stability: }"
    )
    text = text.replace(
        "- propeller: {inertia: 0.8}", "- joint: {angle: 5 deg}\n- propeller: {inertia: 0.8}"
    )
    scene.write_text(text, encoding="utf-8")
    first = CliRunner().invoke(app, ["solve", str(scene), "-o", str(tmp_path / "out")])
    again = CliRunner().invoke(app, ["report", str(tmp_path / "out")])
    assert (again.exit_code, again.stderr) == (first.exit_code, first.stderr)


def test_results_without_a_report_are_refused(scene: Path, tmp_path: Path) -> None:
    printed = call("solve", scene, "--json")
    assert "report" not in json.loads("\n".join(printed))
    (tmp_path / "printed.json").write_text("\n".join(printed), encoding="utf-8")
    assert "holds no report" in " ".join(
        call("report", tmp_path / "printed.json", status=BAD_INPUT)
    )
    assert "holds no report" in " ".join(call("report", scene, status=BAD_INPUT))


def test_a_folder_that_cannot_be_written_is_said(scene: Path, tmp_path: Path) -> None:
    call("solve", scene, "-o", tmp_path / "out")
    assert "cannot be written" in " ".join(
        call("report", tmp_path / "out", "-o", scene, status=BAD_INPUT)
    )


def test_one_line_of_the_terminal_names_the_document(scene: Path, tmp_path: Path) -> None:
    lines = call("solve", scene, "-o", tmp_path / "out")
    sha = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["scene"][
        "sha256"
    ]
    assert lines[:2] == ["line", f"TVC-1 · revision 2, input SHA-256 {sha[:12]}"]
    scene.write_text(scene.read_text(encoding="utf-8").replace(FRONT, ""), encoding="utf-8")
    assert not any(
        ", input SHA-256" in line for line in call("solve", scene, "-o", tmp_path / "out")
    )
