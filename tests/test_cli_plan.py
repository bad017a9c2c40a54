"""The commands `torsion plan` and `torsion sketch`: what would be computed, and the train alone, without solving."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.contracts.frozen import SCENES, solved
from typer.testing import CliRunner

from torsion import commands
from torsion.analyses import ANALYSES
from torsion.cli import app
from torsion.schema.json_schema import json_schema


def call(*words: str):
    return CliRunner().invoke(
        app, list(words), env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )


@pytest.mark.parametrize(
    "scene", ["haixun_06402", "usv", "six_cylinder", "cardan_bearings", "keyed_shaft", "pump_trip"]
)
def test_what_is_planned_is_what_is_computed(scene: str) -> None:
    """Every step of the plan is one that `solve` takes, of the same size; what it leaves out has no result."""
    planned, found = commands.plan(SCENES[scene]), solved(scene)
    done = {line.what: line for line in found.plan.done}
    titles = {analysis.title: analysis for analysis in ANALYSES.values()}
    for what, size, _ in planned.steps:
        assert what in done or any(
            found.results.get(name) is not None for name in titles[what].results
        ), what
        if what == "assembly":
            assert done[what].size == size.partition(";")[0]
    for what, _ in planned.left_out:
        if what in titles:
            held = [found.results.get(name) for name in titles[what].results]
            assert all(one is None or not getattr(one, "crossings", True) for one in held), what


def test_plan_says_sizes_and_reasons() -> None:
    done = call("plan", str(SCENES["haixun_06402"]))
    assert done.exit_code == 0, done.output
    assert "natural frequencies: 6 elastic modes (the file names it)" in done.output
    assert "response over speed: 2 harmonic components at 281 speeds" in done.output
    assert "rules: iacs-m68, coupling-maker, gear-hammer (the file names them)" in done.output
    assert (
        "left out: coupling-maker for motor shaft, because its maker's limits are not given"
        in done.output
    )


def test_a_faulty_file_has_no_plan(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    file.write_text("name: x\ntrain: [disk: {inertia: 1}]\n", encoding="utf-8")
    for command in ("plan", "sketch"):
        done = call(command, str(file))
        assert (done.exit_code, "did you mean `disc`?" in done.output) == (2, True)


def test_the_sketch_is_a_picture_of_the_train(tmp_path: Path) -> None:
    place = tmp_path / "usv.svg"
    done = call("sketch", str(SCENES["usv"]), "-o", str(place))
    assert (done.exit_code, done.output.split()) == (0, ["Sketch:", str(place)])
    assert ElementTree.parse(place).getroot().tag == "{http://www.w3.org/2000/svg}svg"
    refused = call("sketch", str(SCENES["usv"]), "-o", str(tmp_path / "none" / "usv.svg"))
    assert (refused.exit_code, "the sketch cannot be written" in refused.output) == (2, True)


def test_a_new_scene_names_its_schema_to_editors_and_can_be_planned(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    assert call("new", str(file)).exit_code == 0
    first = file.read_text(encoding="utf-8").splitlines()[0]
    assert first == "# yaml-language-server: $schema=torsion.schema.json"
    stated = json.loads((tmp_path / "torsion.schema.json").read_text(encoding="utf-8"))
    assert stated == json_schema()
    assert call("plan", str(file)).exit_code == 0
    assert call("new", str(file)).exit_code == 2
