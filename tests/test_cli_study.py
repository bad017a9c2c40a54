"""The command `torsion study`."""

import json
from itertools import pairwise
from pathlib import Path

import pytest
from tests.for_all import for_all
from typer.testing import CliRunner

from torsion.analyses.compare import run_times as study_times
from torsion.analyses.compare.timing import Effort
from torsion.cli import app

SHORT = Effort(rounds=2, longest=5.0, segments=8, unknowns=4, degrees=(1, 2), speeds=5)
SCENE = """name: a shaft
operation: {speeds: {from: 600 rpm, to: 3000 rpm}}
train:
  - disc: {name: left, inertia: 0.02}
  - shaft: {length: 1.5 m, diameter: 60 mm, loss_factor: 0.01}
  - disc: {name: right, inertia: 0.03}
excitations: [{at: right, order: 6, torque: 100 N*m}]
"""
DISCS = SCENE.replace(
    "shaft: {length: 1.5 m, diameter: 60 mm, loss_factor: 0.01}", "coupling: {stiffness: 20000}"
)
FILES = ["study.html", "study.json"]


def call(*words: str):
    return CliRunner().invoke(
        app, ["study", *words], env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(study_times, "QUICK", SHORT)
    path = tmp_path / "shaft.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def test_the_study_is_printed_and_written(scene: Path, tmp_path: Path) -> None:
    done = call(str(scene), "--quick", "-o", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert "For 0.1 % up to 300 Hz:" in done.output
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == FILES
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    stated = json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))
    rows = [row for quantity in stated["quantities"] for row in quantity["rows"]]
    assert page.count("<tr") >= len(rows) > 4
    assert page.count("error and run time of every method") >= len(stated["quantities"]) == 2


def test_json_is_printed_alone_and_nothing_is_written(scene: Path, tmp_path: Path) -> None:
    done = call(str(scene), "--quick", "--json", "--tolerance", "5 %")
    stated = json.loads(done.stdout)
    assert stated["tolerance"] == pytest.approx(0.05)
    for one in stated["quantities"]:
        best = one["rows"][one["recommended_row"]]
        kept = [
            (one["rows"][k]["total"]["median_s"], one["rows"][k]["error"])
            for k in one["unbeaten_rows"]
        ]
        assert all(a[0] <= b[0] and a[1] > b[1] for a, b in pairwise(kept))
        assert best["error"] <= 0.05
        assert best["total"]["median_s"] == min(
            row["total"]["median_s"]
            for row in one["rows"]
            if row["error"] is not None and row["error"] <= 0.05
        )
    assert [path.name for path in tmp_path.iterdir()] == ["shaft.yaml"]


@for_all("tolerance", ["0", "-1 %", "2", "1 mm", "good"])
def test_a_tolerance_that_makes_no_sense_is_refused(scene: Path, tolerance: str) -> None:
    done = call(str(scene), "--quick", f"--tolerance={tolerance}")
    assert done.exit_code == 2
    assert "tolerance" in done.output


def test_a_train_without_shafts_to_divide_is_a_located_fault(scene: Path) -> None:
    scene.write_text(DISCS, encoding="utf-8")
    done = call(str(scene), "--quick")
    assert done.exit_code == 2
    assert "shaft.yaml:" in done.output
    assert "nothing to divide" in " ".join(done.output.split())


def test_closed_loops_are_refused_because_the_reference_takes_none(scene: Path) -> None:
    text = SCENE + "links: [{between: [left, right], coupling: {stiffness: 1000}}]\n"
    scene.write_text(text, encoding="utf-8")
    done = call(str(scene), "--quick")
    assert done.exit_code == 2
    assert "closed loops" in done.output


def test_a_folder_that_cannot_be_written_is_told(scene: Path, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    done = call(str(scene), "--quick", "-o", str(tmp_path / "taken"))
    assert done.exit_code == 2
    assert "cannot be written" in done.output
