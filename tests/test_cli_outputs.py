"""What a command writes: never over a file that it reads, nothing stale beside it, and output that nobody takes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from torsion.cli import app
from torsion.errors import BAD_INPUT, FAILED_CHECK, SOLVED
from torsion.output.stored.stored_report import naming

TWO = """name: two discs
operation: {speeds: {from: 300 rpm, to: 1800 rpm, steps: 21}, rated: {speed: 1500 rpm, power: 100 kW}}
train:
- motor: {inertia: 1.2, ripple: [{order: 2, torque: 5 %}]}
- coupling: {stiffness: 20 kN*m/rad, psi: 0.8, rated_torque: 1.0 kN*m, vibratory_torque: 0.3 kN*m}
- propeller: {inertia: 0.8}
rules: [coupling-maker]
"""
TABLE = "kind,name,inertia [kg*m**2],stiffness [N*m/rad]\ndisc,a,1,\ncoupling,c,,1000\ndisc,b,2,\n"
TABLED = "name: x\ntrain: {table: rows.svg}\n"
FORCED = """name: x
train: [disc: {name: a, inertia: 1}, coupling: {stiffness: 1e5, viscous: 10}, disc: {inertia: 3}]
analyses:
  transient: {duration: 0.1 s, initial: rest, events: [{at: a, table: {file: motion.csv}}], export: csv}
"""
TORQUE = "time [s], torque [N*m]\n0, 0\n0.01, 5\n0.1, 5\n"
LOGO = '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><rect width="9" height="9"/></svg>'


def call(*words: object, status: int = SOLVED) -> str:
    """What stands on the screen, on one line."""
    done = CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "200"})
    assert done.exit_code == status, done.output
    return " ".join(done.output.split())


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with scenes in which the command stands."""
    monkeypatch.chdir(tmp_path)
    files = {
        "two.yaml": TWO,
        "rows.svg": TABLE,
        "tabled.yaml": TABLED,
        "report.html": TWO,
        "logo.svg": LOGO,
    }
    files |= {
        "signed.yaml": f"{TWO}document: {{logo: logo.svg}}\n",
        "forced.yaml": FORCED,
        "motion.csv": TORQUE,
    }
    files |= {
        "check.json": "name: one\ntrain: [disc: {inertia: 1}, shaft: {length: 2 m, diameter: 9 cm}]\n"
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "link.yaml").symlink_to("two.yaml")
    os.link(tmp_path / "two.yaml", tmp_path / "same.svg")
    return tmp_path


@pytest.mark.parametrize(
    "words",
    [
        "sketch two.yaml -o two.yaml",
        "sketch two.yaml -o ./link.yaml",
        "sketch link.yaml -o two.yaml",
        "sketch two.yaml -o same.svg",
        "sketch tabled.yaml -o rows.svg",
        "solve two.yaml -o out --matrices two.yaml",
        "solve report.html -o .",
        "check check.json -o .",
        "solve forced.yaml -o .",
    ],
)
def test_no_file_that_is_read_is_overwritten(words: str, here: Path) -> None:
    known = {path.name: path.read_bytes() for path in here.iterdir()}
    assert "is a file that was read, and would be overwritten" in call(
        *words.split(), status=BAD_INPUT
    )
    assert {path.name: path.read_bytes() for path in here.iterdir() if path.is_file()} == known


def test_a_mesh_is_not_overwritten(here: Path) -> None:
    import meshio

    points = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]])
    corners = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    meshio.Mesh(points, [("triangle", corners)]).write(here / "square.vtk")
    shaft = "shaft: {length: 1 m, section: {mesh: square.vtk, unit: cm}}"
    (here / "meshed.yaml").write_text(
        f"name: x\ntrain: [disc: {{inertia: 1}}, {shaft}, disc: {{inertia: 1}}]\n"
    )
    known = (here / "square.vtk").read_bytes()
    assert "would be overwritten" in call(
        "sketch", "meshed.yaml", "-o", "square.vtk", status=BAD_INPUT
    )
    assert (here / "square.vtk").read_bytes() == known


def test_the_results_are_not_overwritten_by_their_report(here: Path) -> None:
    call("solve", "two.yaml", "-o", "out")
    (here / "kept").mkdir()
    (here / "out" / "results.json").rename(here / "kept" / "report.html")
    assert "would be overwritten" in call("report", "kept/report.html", status=BAD_INPUT)


def test_what_an_earlier_report_wrote_does_not_stay_beside_a_later_one(here: Path) -> None:
    out = here / "out"
    call("solve", "two.yaml", "-o", "out")
    plain = {path.name for path in out.iterdir()}
    call("solve", "two.yaml", "-o", "out", "--csv", "--pdf")
    listed = json.loads((out / "results.json").read_text(encoding="utf-8"))["files"]
    assert listed == sorted(path.name for path in out.iterdir())
    assert {"tables.zip", "report.pdf"} | plain < set(listed)
    mine = {"report-table-1.csv", "report-table-1.1-mine.csv", "figure-mine.csv", "series.npz"}
    for name in mine:
        (out / name).write_text("a user's", encoding="utf-8")
    call("solve", "two.yaml", "-o", "out")
    assert {path.name for path in out.iterdir()} == plain | mine


def test_motions_of_an_earlier_report_are_removed_and_other_reports_are_left(here: Path) -> None:
    out = here / "out"
    call("solve", "forced.yaml", "-o", "out")
    assert (out / "motion.csv").is_file()
    call("check", "two.yaml", "-o", "out")
    call("solve", "two.yaml", "-o", "out")
    assert sorted(path.name for path in out.iterdir()) == [
        "check.html",
        "check.json",
        "report.html",
        "results.json",
    ]


def test_files_that_the_report_adds_later_are_removed_too(here: Path) -> None:
    out = here / "out"
    call("solve", "two.yaml", "-o", "out")
    plain = {path.name for path in out.iterdir()}
    call("report", "out", "--csv")
    assert (out / "tables.zip").is_file()
    call("report", "out")
    assert (out / "tables.zip").is_file()  # of the same results
    call("solve", "two.yaml", "-o", "out")
    assert {path.name for path in out.iterdir()} == plain


def test_a_report_is_not_drawn_beside_the_results_of_another(here: Path) -> None:
    call("solve", "two.yaml", "-o", "out")
    call("solve", "two.yaml", "-o", "other")
    assert "holds the results of another report" in call(
        "report", "out", "-o", "other", status=BAD_INPUT
    )


@pytest.mark.parametrize(("name", "out"), [("../rows.svg", "out"), ("two.yaml", "."), ("sub", ".")])
def test_no_other_file_is_removed_whatever_the_earlier_results_name(
    name: str, out: str, here: Path
) -> None:
    (here / "report.html").unlink()
    call("solve", "two.yaml", "-o", out)
    (here / "sub").mkdir()
    file, known = (
        here / out / "results.json",
        {path for path in here.rglob("*") if path.name[0] != "."},
    )
    text = file.read_text(encoding="utf-8")
    file.write_text(naming(text, ["report.html", "results.json", name]), encoding="utf-8")
    call("solve", "two.yaml", "-o", out)
    assert set(here.rglob("*")) == known


@pytest.mark.parametrize(
    ("given", "instead"),
    [
        ('"program": {', '"program": { '),
        ('"reference":"', '"reference":"x'),
        (',\n"report": {', ',\n"more": 1,\n"report": {'),
    ],
)
def test_results_that_were_changed_anywhere_are_refused(
    given: str, instead: str, here: Path
) -> None:
    call("solve", "two.yaml", "-o", "out")
    file = here / "out" / "results.json"
    text = file.read_text(encoding="utf-8")
    assert given in text
    file.write_text(text.replace(given, instead, 1), encoding="utf-8")
    assert "was changed after it was written" in call("report", "out", status=BAD_INPUT)


def run(words: str, folder: Path, command: str = "%s") -> "subprocess.CompletedProcess[str]":
    """The command in a shell, with `pipefail`: its status is that of the program."""
    program = f"{sys.executable} -m torsion {words}"
    shell = ["bash", "-o", "pipefail", "-c", command % program]
    return subprocess.run(
        shell, cwd=folder, capture_output=True, text=True, check=False, timeout=120
    )


@pytest.mark.skipif(os.name != "posix", reason="pipes of a shell")
@pytest.mark.parametrize(
    ("words", "reader"),
    [
        ("solve two.yaml -o out", "true"),
        ("solve two.yaml --json", "head -c 1"),
        ("plan two.yaml", "true"),
        ("schema", "head -c 1"),
    ],
)
def test_a_reader_that_leaves_changes_nothing(words: str, reader: str, here: Path) -> None:
    done = run(words, here, f"%s | {{ {reader}; exec 0<&-; }}")
    assert (done.returncode, done.stderr) == (SOLVED, "")
    assert (here / "out" / "results.json").is_file() == ("-o" in words)


@pytest.mark.skipif(os.name != "posix", reason="pipes of a shell")
def test_a_check_that_fails_says_so_also_to_a_closed_pipe(here: Path) -> None:
    (here / "two.yaml").write_text(TWO.replace("0.3 kN*m", "0.001 kN*m"), encoding="utf-8")
    done = run("solve two.yaml -o out", here, "%s | true")
    assert (done.returncode, done.stderr) == (FAILED_CHECK, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full disk to write to")
@pytest.mark.parametrize("words", ["solve two.yaml -o out", "solve two.yaml --json", "schema"])
def test_output_that_cannot_be_written_is_said_on_one_line(words: str, here: Path) -> None:
    done = run(words, here, "%s > /dev/full")
    assert done.returncode == BAD_INPUT
    assert done.stderr == "the output cannot be written: No space left on device\n"
