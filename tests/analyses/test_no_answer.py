"""An analysis without an answer is said with cause, line and remedy, and takes no other with it."""

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import torsion
from torsion.analyses import ANALYSES, Analysis
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.analyses.undamped_modes import Modes
from torsion.cli import app
from torsion.errors import Fault, InputError, SolveError
from torsion.output.stored.results_json import results
from torsion.study import Study

GEAR = """name: joints on both sides of a gear
operation: {speeds: {from: 30 rad/s, to: 90 rad/s, steps: 4}, rated: {speed: 60 rad/s, power: 20 kW}}
train:
  - motor: {inertia: 1, damping: 1}
  - joint: {angle: 5 deg}
  - coupling: {stiffness: 1e4, viscous: 5}
  - gear: {teeth: [37, 211]}
  - joint: {angle: 8 deg}
  - coupling: {stiffness: 1e4, viscous: 5}
  - disc: {inertia: 1, damping: 2}
"""
SHAFT = """name: a shaft that joints hold
operation: {speeds: {from: 10 rad/s, to: 20 rad/s, steps: 3}}
train:
  - disc: {inertia: 1}
  - coupling: {stiffness: 1e5, viscous: 1}
  - joint: {angle: 2 deg}
  - shaft: {name: tail, length: 1 m, diameter: 50 mm}
  - joint: {angle: 2 deg}
  - disc: {name: screw, inertia: 1}
excitations: [{at: screw, order: 1, torque: 1}]
"""
FAST = "lateral: {modes: 20, speeds: {from: 1 rpm, to: 1e9 rpm}}"
FLAT = "response: {frequencies: {from: 1, to: 5}}"
NO_ANSWER = [  # scene, what has no answer, its words, what the line begins with, the exit status
    (GEAR, "stability: ", "stability", "teeth 37/211", "- gear", 3),
    (
        GEAR,
        "response: {method: harmonic-balance}",
        "exact periodic response",
        "joint-2 (order 2)",
        "- gear",
        3,
    ),
    (SHAFT, FAST, "bending of the shafts", "at most 400 are possible", "analyses", 3),
    (SHAFT, FLAT, "response over frequency", "no torque acts at every frequency", "analyses", 2),
]
STATED = ("natural_frequencies", "modes", "damped_modes", "joints", "critical_speeds")


def scene(text: str, *requested: str) -> Study:
    return torsion.parse(f"{text}analyses: {{{', '.join(requested)}}}\n")


def stated(findings) -> dict:
    found = results(findings)
    return {key: found[key] for key in STATED if key in found}


@pytest.mark.parametrize(("text", "requested", "what", "words", "line", "status"), NO_ANSWER)
def test_analysis_without_an_answer_is_left_out_and_all_others_stay(
    text, requested, what, words, line, status
):
    study = scene(text, "modes: ", requested)
    found = torsion.run(study)
    (one,) = found.plan.unanswered
    assert (one.what, one.is_named, one.is_input) == (what, True, status == 2)
    assert words in one.why
    assert study.text.splitlines()[one.line - 1].strip().startswith(line)
    assert (what, one.words) in found.plan.left_out
    assert stated(found) == stated(torsion.run(scene(text, "modes: ")))


@pytest.mark.parametrize(("text", "requested", "what", "words", "line", "status"), NO_ANSWER)
def test_command_writes_the_report_says_it_last_and_tells_by_its_status(
    text, requested, what, words, line, status, tmp_path: Path
):
    file = tmp_path / "scene.yaml"
    file.write_text(scene(text, "modes: ", requested).text, encoding="utf-8")
    done = CliRunner().invoke(
        app, ["solve", str(file), "-o", str(tmp_path / "out")], env={"COLUMNS": "200"}
    )
    assert done.exit_code == status
    last = done.stderr.strip().splitlines()
    assert last[0] == f"no answer: {what}"
    assert words in last[1]
    assert last[2].strip().startswith(line)
    stated = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))
    assert [one["what"] for one in stated["plan"]["unanswered"]] == [what]
    assert stated["modes"]["frequency_Hz"]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "NOT JUDGED" in page
    assert f"<dt>Not computed</dt><dd>{what}" in page


def test_remedy_that_is_offered_gives_the_answer():
    few = GEAR.replace(
        "from: 30 rad/s, to: 90 rad/s, steps: 4", "from: 60 rad/s, to: 60.1 rad/s, steps: 2"
    )
    (one,) = torsion.run(scene(few, "stability: ")).plan.unanswered
    assert "gear-1" in one.remedy + one.words
    found = torsion.run(scene(few.replace("teeth: [37, 211]", "teeth: [37, 74]"), "stability: "))
    assert found.plan.unanswered == ()
    assert (found.need(Stability).growth < 0).all()


def test_stability_without_an_answer_leaves_the_map_out_too_and_nothing_else():
    requested = "stability: {map: {over: angle, from: 1 deg, to: 9 deg, steps: 3}}"
    found = torsion.run(scene(GEAR, "modes: ", requested))
    assert [one.analysis for one in found.plan.unanswered] == ["stability", "stability map"]
    assert found.need(Modes).frequency.size


@dataclass(frozen=True)
class Refusing(Analysis):
    """An analysis that every study wants and that ends by an error."""

    error: Exception = field(default_factory=Exception)

    def imported(self, word):
        def refuse(work) -> None:
            raise self.error

        return refuse


def run_with(monkeypatch, study: Study, **errors: Exception):
    """The findings where the analyses of those names end by those errors."""
    for name, error in errors.items():
        refusing = Refusing(name, __name__, wanted=lambda study: True, error=error)
        monkeypatch.setitem(ANALYSES, name, refusing)
    return torsion.run(study)


def test_what_the_file_does_not_name_leaves_the_exit_status_alone(monkeypatch):
    study = torsion.parse(
        SHAFT.replace("length: 1 m", "length: 1 m, support: {at: 0.5 m, stiffness: 1e6}")
    )
    errors = {"lateral": SolveError("too many elements", "fewer"), "modes": SolveError("too low")}
    plan = run_with(monkeypatch, study, **errors).plan
    assert {one.analysis: one.is_named for one in plan.unanswered} == {
        "lateral": False,
        "modes": True,
    }
    assert ("lateral", "too many elements; remedy: fewer") in plan.left_out


def test_a_bug_in_an_analysis_is_not_caught(monkeypatch):
    study = scene(SHAFT, "modes: ")
    assert torsion.run(study).plan.unanswered == ()
    with pytest.raises(ZeroDivisionError):
        run_with(monkeypatch, study, joints=ZeroDivisionError())


@pytest.mark.parametrize(
    "error", [SolveError("no way", "another"), InputError([Fault(("train", 1), "bad", "good")])]
)
def test_analysis_that_a_rule_of_the_file_reads_is_not_left_out(error, monkeypatch):
    study = torsion.parse(f"{SHAFT}rules: [universal-joints]\n")
    with pytest.raises(
        type(error), match=error.args[0] if isinstance(error, SolveError) else "bad"
    ):
        run_with(monkeypatch, study, joints=error)
    monkeypatch.undo()
    assert [
        one.analysis for one in run_with(monkeypatch, study, critical=error).plan.unanswered
    ] == ["critical"]


def test_nothing_is_reported_where_nothing_has_an_answer():
    supports = "support: [{at: 0.2 m, stiffness: 1e7}, {at: 0.8 m, stiffness: 1e7}]"
    text = f"name: a\ntrain: [disc: {{inertia: 1}}, shaft: {{length: 1 m, diameter: 50 mm, {supports}}}]\n"
    assert torsion.run(scene(text, "modes: ", FAST)).plan.unanswered
    with pytest.raises(SolveError, match="at most 400 are possible"):
        torsion.run(scene(text, FAST))


LOOP = """name: damped loop
train: [disc: {name: a, inertia: 1}, coupling: {stiffness: 1e4, viscous: 1}, disc: {name: b, inertia: 2}]
links: [{between: [a, b], coupling: {stiffness: 2e4}}]
analyses: {modes: {%s}}
"""


def test_damped_modes_that_a_file_names_are_never_left_out_in_silence() -> None:
    (one,) = torsion.run(torsion.parse(LOOP % "damped: true")).plan.unanswered
    assert (one.analysis, one.line, one.is_named) == ("damped", 4, True)
    assert "closed loops" in one.why
    plan = torsion.run(torsion.parse(LOOP % "count: 1")).plan
    assert plan.unanswered == ()
    assert any(what == "damped modes" for what, _ in plan.left_out)


def test_an_analysis_that_does_not_exist_is_refused_by_its_name() -> None:
    with pytest.raises(InputError, match="no analysis is called 'foo'"):
        torsion.run(torsion.parse(LOOP % "count: 1"), only=("foo",))


@pytest.mark.parametrize("speeds", [[], [0.0, 5.0], [-5.0], [20.0, float("nan")]])
def test_a_response_refuses_what_are_no_speeds(speeds: list[float]) -> None:
    study = torsion.parse(SHAFT)
    with pytest.raises(InputError, match="not speeds of a response"):
        torsion.response(study, torsion.assemble(study.train), speeds=np.array(speeds))


def test_a_link_from_a_point_to_itself_is_said_to_be_that() -> None:
    with pytest.raises(InputError, match="'a' and 'a' are one point"):
        torsion.parse((LOOP % "count: 1").replace("[a, b]", "[a, a]"))


def test_a_tolerance_that_is_read_but_not_varied_is_said_in_the_plan():
    text = "name: x\ntrain: [disc: {inertia: 1}, coupling: {name: k, stiffness: 5, tolerance: 15 %}, disc: {inertia: 2}]\n"
    left = dict(torsion.run(torsion.parse(text)).plan.left_out)
    assert left["the tolerance of 'k'"] == (
        "its 15 % change only the frequencies; other results use the nominal stiffness (`cases: {from: tolerances}` "
        "varies them)"
    )


def test_of_some_analyses_the_rules_that_read_others_are_left_out():
    text = "name: x\noperation: {speeds: {from: 300 rpm, to: 900 rpm}, rated: {speed: 800 rpm, power: 50 kW}}\n"
    text += "train: [motor: {inertia: 1, ripple: [{order: 2, torque: 5 %}]}, "
    text += "coupling: {stiffness: 5e4, psi: 0.5, vibratory_torque: 9}, propeller: {inertia: 2}]\nrules: [coupling-maker]\n"
    found = torsion.run(torsion.parse(text), only=("modes",))
    assert found.study.rules
    assert found.results["checks"].lines == ()
    assert dict(found.plan.left_out)["the rule coupling-maker"] == "what it reads is not requested"
    assert torsion.run(torsion.parse(text), only=("response",)).results["checks"].lines
