"""The commands on a file with cases: exit status, one case alone, plan, JSON, what is said on the terminal."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import torsion
from torsion import commands
from torsion.cli import app

BASE = """name: base
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 31}, rated: {speed: 800 rpm, power: 50 kW}}
train:
  - motor: {name: engine, inertia: 2, ripple: [{order: 3, torque: 10 %}]}
  - coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, vibratory_torque: 900 N*m}
  - propeller: {name: wheel, inertia: 4, damping: {model: archer, factor: 30}}
rules: [coupling-maker]
"""
FAILS = "{set: {rubber.vibratory_torque: 1 N*m}}"
INFORMS = "{set: {rubber.vibratory_torque: 1 N*m}, judged: false}"
PASSES = "{scale: {rubber.stiffness: 90 %}}"
LINKED = BASE + "links: [{between: [engine, wheel], coupling: {name: chord, stiffness: 1e4}}]\n"
GONE = "remove: [rubber.stiffness, rubber.psi, chord.stiffness]"
NO_ANSWER = f"{{{GONE}, set: {{rubber.flexibility: 0, chord.flexibility: 0}}}}"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)

    def written(base: str = BASE, **cases: str) -> str:
        path = tmp_path / "base.yaml"
        path.write_text(
            base + "cases:\n" + "".join(f"  {name}: {body}\n" for name, body in cases.items())
        )
        return str(path)

    return written


def call(*words: str):
    return CliRunner().invoke(
        app, list(words), env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )


@pytest.mark.parametrize(
    ("cases", "status"),
    [
        ({"a": PASSES}, 0),
        ({"a": PASSES, "b": FAILS}, 1),
        ({"b": FAILS, "a": PASSES}, 1),
        ({"a": INFORMS}, 0),
        ({"a": PASSES, "b": "{set: {rubber.stiffness: 1}}"}, 2),
    ],
)
def test_the_exit_status_is_that_of_the_worst_case_that_is_judged(
    file, cases: dict[str, str], status: int
) -> None:
    if status == 2:
        cases = {**cases, "b": "{set: {rubber.stiffness: 1 N}}"}
    assert call("solve", file(**cases)).exit_code == status


def test_a_case_without_an_answer_takes_no_other_with_it(file, tmp_path: Path) -> None:
    done = call("solve", file(LINKED, a=PASSES, x=NO_ANSWER), "-o", "out")
    assert done.exit_code == 2
    assert "no answer: case 'x'" in done.output
    assert "case 'x': " in done.stderr
    made = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*.html")}
    assert made == {"report.html", "a/report.html"}
    assert "NOT JUDGED: case x (1 of 3)" in (tmp_path / "out" / "report.html").read_text(
        encoding="utf-8"
    )
    informed = NO_ANSWER.replace("{remove", "{judged: false, remove")
    assert call("solve", file(LINKED, a=PASSES, x=informed), "-o", "out").exit_code == 0


def test_one_case_is_solved_alone(file, tmp_path: Path) -> None:
    name = file(good=PASSES, bad=FAILS)
    assert call("solve", name, "--case", "good").exit_code == 0
    assert [path.name for path in (tmp_path / "reports" / "base").iterdir()] == ["good"]
    assert call("solve", name, "--case", "bad").exit_code == 1
    assert call("solve", name, "--case", "normal").exit_code == 0
    assert (tmp_path / "reports" / "base" / "report.html").exists()
    found = json.loads(call("solve", name, "--case", "good", "--json").output)
    assert found["scene"]["case"] == "good"
    assert found["cases"] == {}
    done = call("solve", name, "--case", "god")
    assert (done.exit_code, "did you mean 'good'?" in done.output) == (2, True)


def test_json_has_the_results_of_every_case(file) -> None:
    name = file(good=PASSES, bad=FAILS)
    found = json.loads(call("solve", name, "--json").output)
    assert list(found["cases"]) == ["good", "bad"]
    assert found["scene"]["case"] is None
    for case in found["cases"]:
        alone = json.loads(call("solve", name, "--case", case, "--json").output)
        assert found["cases"][case]["checks"] == alone["checks"]
        assert found["cases"][case]["response"] == alone["response"]


def test_the_terminal_begins_with_the_verdict_over_all_cases(file) -> None:
    done = call("solve", file(good=PASSES, bad=FAILS))
    lines = done.output.splitlines()
    assert lines[1].startswith("✗ FAIL: case bad (1 of 3)")
    assert lines[2].split()[0] == "case"
    assert [line.split()[0] for line in lines[3:6]] == ["normal", "good", "bad"]


def test_the_plan_has_every_case_and_nothing_is_solved(file) -> None:
    name = file(good=PASSES, few="{speeds: {from: 300 rpm, to: 900 rpm, steps: 11}}")
    done = call("plan", name)
    assert done.exit_code == 0
    head, good, few = done.output.split("\ncase ")
    assert "1 harmonic component at 31 speeds" in head.replace("components", "component")
    assert good.startswith("good\n")
    assert "at 11 speeds" in few
    assert call("plan", name, "--case", "few").output == few.removeprefix("few\n")
    assert set(commands.plan(name).cases) == {"good", "few"}


def test_other_commands_take_the_file_as_it_stands_or_one_case(file, tmp_path: Path) -> None:
    shaft = BASE.replace(
        "  - propeller", "  - shaft: {name: s, length: 1 m, diameter: 60 mm}\n  - propeller"
    )
    name = file(shaft, long="{set: {s.length: 2 m}}")
    alone, long = (commands.check(name, case=case) for case in (None, "long"))
    assert long.study.name == "base, case long"
    lowest = [one.results["check"].models[0].frequency[0] for one in (alone, long)]
    assert lowest[0] > lowest[1]
    assert any(what == "the cases long" for what, _ in alone.plan.left_out)
    assert call("check", name, "--case", "long").exit_code in (0, 1)
    assert call("sketch", name, "--case", "long", "-o", str(tmp_path / "x.svg")).exit_code == 0
    assert call("solve", name, "--matrices", str(tmp_path / "m.npz")).exit_code == 0


def test_python_reads_runs_and_solves_the_cases(file, tmp_path: Path) -> None:
    name = file(good=PASSES, bad=FAILS)
    study = torsion.read(name)
    assert list(study.cases) == ["good", "bad"]
    assert study.cases["bad"].case.changes[0].after == "1 N*m"
    shares = list[tuple[str, float]]()
    found = torsion.run(study, progress=lambda what, share: shares.append((what, share)))
    assert list(found.each) == ["normal", "good", "bad"]
    assert [one.failed for one in found.each.values()] == [False, False, True]
    assert [share for _, share in shares] == sorted(share for _, share in shares)
    assert {what.partition(":")[0] for what, _ in shares} == {
        "case normal",
        "case good",
        "case bad",
    }
    assert torsion.solve(name, tmp_path / "x", case="good").study.case.name == "good"
    assert torsion.run(study.cases["good"]).cases == {}
