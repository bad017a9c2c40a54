"""The command `torsion joint`."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from torsion.cli import app

JOINTS = """name: two joints
train:
  - joint: {angle: 15 deg}
  - shaft: {length: 1 m, diameter: 60 mm}
  - joint: {angle: 20 deg, plane: 10 deg, phase: 55 deg}
"""
FILES = ["joints.csv", "joints.html", "joints.json"]


def call(*words: str):
    return CliRunner().invoke(
        app, ["joint", *words], env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "line.yaml"
    path.write_text(JOINTS, encoding="utf-8")
    return path


def test_joints_alone_are_printed_and_written(scene: Path, tmp_path: Path) -> None:
    done = call(str(scene), "-o", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert "14.256" in done.output  # Ma, Yu and Han 2011, phase 55 degrees
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == FILES


def test_the_report_goes_beside_those_of_solve(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert call(str(scene)).exit_code == 0
    assert sorted(path.name for path in (tmp_path / "reports" / "line").iterdir()) == FILES


def test_json_is_printed_alone_and_nothing_is_written(scene: Path, tmp_path: Path) -> None:
    done = call(str(scene), "--json")
    stated = json.loads(done.stdout)
    assert [joint["name"] for joint in stated["joints"]["joints"]] == ["joint-1", "joint-2"]
    assert stated["plan"]["left_out"][0]["what"] == "everything but the joints"
    assert [path.name for path in tmp_path.iterdir()] == ["line.yaml"]


def test_turns_of_the_command_take_the_place_of_those_of_the_file(scene: Path) -> None:
    once, thrice = (
        json.loads(call(str(scene), "--json", "--turns", n).stdout)["joints"]["angle_rad"]
        for n in "13"
    )
    assert thrice[-1] == pytest.approx(3 * once[-1], rel=1e-12)


@pytest.mark.parametrize("turns", ["0", "-1", "101", "x"])
def test_turns_that_make_no_sense_are_refused(scene: Path, turns: str) -> None:
    done = call(str(scene), "--turns", turns)
    assert done.exit_code == 2
    assert "Traceback" not in done.output


def test_a_train_without_joints_is_a_located_fault(tmp_path: Path) -> None:
    path = tmp_path / "discs.yaml"
    path.write_text(
        "name: x\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
    )
    done = call(str(path))
    assert done.exit_code == 2
    assert "discs.yaml:2:" in done.output
    assert "no joint" in done.output


@pytest.mark.parametrize("angle", ["90 deg", "5"])
def test_bad_geometry_is_a_located_fault(scene: Path, angle: str) -> None:
    scene.write_text(JOINTS.replace("15 deg", angle), encoding="utf-8")
    done = call(str(scene))
    assert done.exit_code == 2
    assert "line.yaml:3:" in done.output


def test_a_folder_that_cannot_be_written_is_told_and_leaves_no_traceback(
    scene: Path, tmp_path: Path
) -> None:
    (tmp_path / "taken").write_text("a file")
    done = call(str(scene), "-o", str(tmp_path / "taken"))
    assert done.exit_code == 2
    assert "cannot be written" in done.output


def test_a_failed_run_leaves_the_earlier_files_whole(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert call(str(scene), "-o", str(out)).exit_code == 0
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    scene.write_text(JOINTS.replace("20 deg", "120 deg"), encoding="utf-8")
    assert call(str(scene), "-o", str(out)).exit_code == 2
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_settings_and_other_rules_of_the_file_do_not_stop_the_joints(scene: Path) -> None:
    text = JOINTS + "analyses: {modes: , joints: {optimise: phase}}\n"
    scene.write_text(text, encoding="utf-8")
    done = call(str(scene), "--json")
    assert done.exit_code == 0, done.output
    stated = json.loads(done.stdout)
    assert stated["joints"]["lines"][0]["optimum"]["best_rad"] == [
        pytest.approx(0.17453292519943295, rel=1e-12)
    ]
