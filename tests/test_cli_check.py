"""The command `torsion check`."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from torsion.cli import app

SHAFT = """name: one shaft
train:
  - disc: {name: small, inertia: 0.1}
  - shaft: {length: 2 m, diameter: 100 mm}
  - disc: {name: large, inertia: 0.4}
"""
COARSE = SHAFT.replace("length:", "segments: 2, length:") + "analyses: {modes: {count: 1}}\n"
DISCS = "name: x\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"


def call(command: str, *words: str):
    return CliRunner().invoke(
        app, [command, *words], env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "line.yaml"
    path.write_text(SHAFT, encoding="utf-8")
    return path


def test_models_are_compared_without_the_file_asking_it(scene: Path, tmp_path: Path) -> None:
    done = call("check", str(scene), "-o", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert "lumped and fem are within 0.1 %" in done.output
    assert "No torques are compared: nothing excites" in done.output
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "check.html",
        "check.json",
    ]


def test_json_is_printed_alone_and_nothing_is_written(scene: Path, tmp_path: Path) -> None:
    done = call("check", str(scene), "--json")
    stated = json.loads(done.stdout)
    assert [model["model"] for model in stated["check"]["models"]] == ["exact", "lumped", "fem"]
    assert stated["check"]["tolerance"] == 0.001
    assert stated["plan"]["left_out"][-1]["what"] == "everything else"
    assert [path.name for path in tmp_path.iterdir()] == ["line.yaml"]


@pytest.mark.parametrize(("tolerance", "status"), [("0.1 %", 1), ("20 %", 0)])
@pytest.mark.parametrize("command", ["check", "solve"])
def test_a_model_beyond_the_tolerance_makes_the_exit_status_one(
    scene: Path, tmp_path: Path, command: str, tolerance: str, status: int
) -> None:
    text = COARSE.replace(
        "count: 1}", f"count: 1}}, check: {{models: [lumped], tolerance: {tolerance}}}"
    )
    scene.write_text(text, encoding="utf-8")
    done = call(command, str(scene), "-o", str(tmp_path / "out"))
    assert done.exit_code == status, done.output
    assert command == "solve" or f"within {tolerance} of the exact model" in done.output
    assert ("FAIL" in done.output) == bool(status)


def test_a_train_without_shafts_is_the_same_in_all_models(scene: Path, tmp_path: Path) -> None:
    scene.write_text(DISCS, encoding="utf-8")
    done = call("check", str(scene), "-o", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert "all models are the same" in done.output
    stated = json.loads((tmp_path / "out" / "check.json").read_text(encoding="utf-8"))
    assert stated["check"]["models"] == []


def test_a_loop_has_no_exact_model_and_the_fault_is_located(scene: Path) -> None:
    scene.write_text(
        SHAFT + "links:\n  - {between: [small, large], coupling: {stiffness: 1e4}}\n",
        encoding="utf-8",
    )
    done = call("check", str(scene))
    assert done.exit_code == 2
    assert "line.yaml:7:" in done.output
    assert "closed loops" in done.output


def test_a_folder_that_cannot_be_written_is_told_and_leaves_no_traceback(
    scene: Path, tmp_path: Path
) -> None:
    (tmp_path / "taken").write_text("a file")
    done = call("check", str(scene), "-o", str(tmp_path / "taken"))
    assert done.exit_code == 2
    assert "cannot be written" in done.output


def test_the_rules_that_the_file_names_stand_in_its_head(tmp_path: Path) -> None:
    """They are named, and not judged."""
    file = tmp_path / "ruled.yaml"
    file.write_text(
        "name: x\noperation: {rated: {speed: 900 rpm, power: 10 kW}, speeds: {from: 100 rpm, to: 900 rpm}}\n"
        "train: [motor: {inertia: 1}, shaft: {length: 1 m, diameter: 50 mm}, coupling: {stiffness: 1e4, "
        "rated_torque: 1 kN*m}, disc: {inertia: 2}]\nrules: [coupling-maker]\n",
        encoding="utf-8",
    )
    printed = json.loads(call("check", str(file), "--json").stdout)
    assert printed["scene"]["rules"] == ["coupling-maker"]
    assert "checks" not in printed
