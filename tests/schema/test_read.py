"""What a file says arrives in the study: exact ratios, SI figures, names, places, settings."""

import math
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest
from tests.for_all import for_all

from torsion.errors import Fault, InputError
from torsion.fields import Amount
from torsion.rules.verdict_line import Checks
from torsion.runner import run
from torsion.schema import template
from torsion.schema.scene_reader import located, parse, read

SCENES = sorted((Path(__file__).parents[2] / "shafting_specs").glob("**/*.yaml"))
TWO = "name: two discs\ntrain:\n  - disc: {inertia: 1}\n  - coupling: {stiffness: 2e4}\n  - disc: {inertia: 2.5}\n"


def train_of(entries: str):
    return parse("name: scene\ntrain:\n" + entries).train


@for_all("path", SCENES)
def test_every_scene_of_the_repository_reads(path):
    study = read(path)
    assert study.file == str(path)
    assert study.text == path.read_text(encoding="utf-8")


def test_smallest_scene_has_the_defaults_of_the_format():
    study = parse(TWO, "two.yaml")
    assert (study.name, study.description, study.file, study.text) == (
        "two discs",
        "",
        "two.yaml",
        TWO,
    )
    assert (study.model, dict(study.analyses), study.rules) == ("lumped", {}, ())
    assert study.operation.speeds is None
    assert study.train.materials["steel"].shear_modulus == 79.3e9
    assert [part.name for part in study.train.parts] == ["disc-1", "coupling-1", "disc-2"]
    assert study.train.springs[0].flexibility == 1 / 2e4


def test_figures_arrive_in_si_units():
    text = (
        "name: scene\n"
        "operation: {speeds: {from: 300 rpm, to: 100 rad/s, steps: 7}, rated: {speed: 1500 1/min, power: 100 kW}}\n"
        "train:\n"
        "  - disc: {inertia: 11.9 lbf*in*s**2, damping: 0.5 Nms/rad}\n"
        "  - shaft: {length: 800 mm, diameter: [6 cm, 0.07], bore: 1 in}\n"
        "  - disc: {inertia: 2_000}\n"
        "  - coupling: {stiffness: 350 N*m/deg, psi: 80 %}\n"
        "  - disc: {inertia: 1.0E+3}\n"
    )
    study = parse(text)
    operation, train = study.operation, study.train
    assert operation.speeds.first == pytest.approx(10 * math.pi, rel=1e-15)
    assert (operation.speeds.last, operation.speeds.steps) == (100.0, 7)
    assert operation.rated.speed == pytest.approx(50 * math.pi, rel=1e-15)
    assert operation.rated.power == 1e5
    assert [item.inertia for item in train.inertias] == pytest.approx(
        [11.9 * 0.45359237 * 9.80665 * 0.0254, 2000.0, 1000.0], rel=1e-15
    )
    assert train.dampers[0].constant == 0.5
    (bar,) = train.bars
    assert (bar.length, bar.outer, bar.bore) == (0.8, (0.06, 0.07), (0.0254, 0.0254))
    assert 1 / train.springs[0].flexibility == pytest.approx(350 * 180 / math.pi, rel=1e-15)
    assert train.springs[0].loss_factor == pytest.approx(0.8 / (2 * math.pi), rel=1e-15)


@pytest.mark.parametrize(
    ("gear", "speed"),
    [
        ("teeth: [42, 125]", Fraction(42, 125)),
        ("ratio: 2.976", Fraction(1000, 2976)),
        ("ratio: 125/42", Fraction(42, 125)),
        ("ratio: 3", Fraction(1, 3)),
    ],
)
def test_speed_ratios_are_exact_fractions_of_what_is_written(gear, speed):
    train = train_of(
        f"  - disc: {{inertia: 1}}\n  - gear: {{{gear}}}\n  - disc: {{name: last, inertia: 1}}\n"
    )
    assert train["last"].ratio == speed


def test_orders_are_exact_fractions_of_what_is_written():
    text = TWO + (
        "operation: {speeds: {from: 1 rpm, to: 2 rpm}, rated: {speed: 1 rpm, power: 1}}\n"
        "excitations:\n"
        "  - {at: disc-1, order: 0.1, torque: 3}\n"
        "  - {at: disc-1, order: 21/8, torque: {of_mean: 10 %}, phase: 180 deg}\n"
        "  - {at: disc-2, frequency: 35, torque: 5 %}\n"
        "  - {at: disc-2, order: 2, torque: [[0 rpm, 1], [60 rpm, 5]]}\n"
    )
    first, second, third, fourth = parse(text).train.torques
    assert (first.order, first.torque) == (Fraction(1, 10), 3.0)
    assert (second.order, Amount(second.torque, second.of_mean)) == (
        Fraction(21, 8),
        Amount(0.0, 0.1),
    )
    assert second.phase == math.pi
    assert (third.frequency, third.of_mean) == (35.0, 0.05)
    assert fourth.table == ((0.0, 1.0), (pytest.approx(2 * math.pi, rel=1e-15), 5.0))


def test_branches_of_branches_are_read_where_they_stand():
    train = train_of(
        "  - disc: {inertia: 1}\n"
        "  - branch: {train: [coupling: {flexibility: 0}, disc: {inertia: 2}, branch: {train: [disc: {inertia: 3}]}]}\n"
        "  - gear:\n"
        "      teeth: [20, 40]\n"
        "      branches: [{teeth: 10, train: [disc: {name: fast, inertia: 4}]}, {ratio: 4}]\n"
        "  - disc: {name: slow, inertia: 5}\n"
    )
    assert train["disc-3"].path == (
        "train",
        1,
        "branch",
        "train",
        2,
        "branch",
        "train",
        0,
        "disc",
    )
    assert (train["fast"].ratio, train["slow"].ratio) == (2, Fraction(1, 2))


def test_link_closes_a_loop_between_points():
    text = (
        TWO
        + "links: [{between: [disc-1, disc-2], shaft: {length: 1, diameter: 0.1, material: soft}}]\n"
    )
    train = parse(text + "materials: {soft: {shear_modulus: 1 GPa, density: 0}}\n").train
    (bar,) = train.bars
    assert (bar.driving, bar.driven) == (train.springs[0].driving, train.springs[0].driven)
    assert bar.shear_modulus == 1e9


def test_speeds_count_from_the_component_of_operation():
    text = "name: a\noperation: {at: disc-2}\ntrain: [disc: {inertia: 1}, gear: {ratio: 3}, disc: {inertia: 2}]\n"
    train = parse(text).train
    assert (train["disc-1"].ratio, train["disc-2"].ratio) == (3, 1)


def test_analysis_without_settings_runs_with_its_defaults_and_rules_keep_their_order():
    text = (
        "name: a\n"
        "operation: {speeds: {from: 10 rpm, to: 20 rpm}, rated: {speed: 15 rpm, power: 1 kW}}\n"
        "train: [motor: {inertia: 1, ripple: [{order: 1, torque: 5}]}, coupling: {stiffness: 5, max_torque: 7},"
        " gear: {ratio: 2}, propeller: {inertia: 3}]\n"
        "analyses: {modes: , response: }\n"
        "rules: [gear-hammer: {limit: 0.4}, coupling-maker]\n"
    )
    study = parse(text)
    assert list(study.analyses) == ["modes", "response"]
    assert study.analyses["modes"].count == 6
    assert [name for name, _ in study.rules] == ["gear-hammer", "coupling-maker"]
    assert study.rules[0][1].limit == 0.4


def test_fault_that_is_found_after_reading_is_shown_in_the_file():
    study = parse(TWO, "two.yaml")
    error = located(
        InputError([Fault(("train", 2, "disc", "inertia"), "too heavy", "lighter")]), study
    )
    assert [(fault.line, fault.column) for fault in error.faults] == [(5, 21)]
    assert (
        str(error)
        == "two.yaml:5:21: too heavy (lighter)\n      - disc: {inertia: 2.5}\n" + " " * 24 + "^"
    )


def test_example_of_the_new_command_reads_and_every_line_is_explained():
    text = template("example.yaml")
    study = parse(text)
    assert {part.kind for part in study.train.parts} == {
        "motor",
        "coupling",
        "gear",
        "shaft",
        "propeller",
    }
    assert [name for name, _ in study.rules] == ["iacs-m68", "coupling-maker", "gear-hammer"]
    assert [line for line in text.splitlines() if line.strip() and "#" not in line] == []


def test_example_of_the_new_command_solves_and_meets_its_rules():
    checks = run(parse(template("example.yaml"))).need(Checks).lines
    assert {check.rule for check in checks} == {"iacs-m68", "coupling-maker", "gear-hammer"}
    assert [check for check in checks if check.verdict == "fail"] == []


def test_example_reads_with_every_optional_key_that_it_shows():
    lines, found = template("example.yaml").splitlines(), 0
    for number, line in enumerate(lines):
        key = line.strip().removeprefix("# ")
        indented = line.startswith(("  ", "# analyses:", "# excitations:", "# cases:", "#   "))
        if line.strip().startswith("#") and indented and "youngs" not in key:
            lines[number] = line.replace("# ", "", 1)
            found += 1
    study = parse("\n".join(lines))
    assert found >= 15
    kinds = {part.kind for part in study.train.parts}
    assert kinds >= {"joint", "disc", "damper", "branch"}
    assert list(study.analyses) == ["modes", "response"]
    assert list(study.cases) == ["warm"]


def test_reading_imports_only_the_kinds_that_the_file_names():
    code = (
        "import sys, torsion.schema.scene_reader as reader\n"
        f"reader.parse({TWO!r})\n"
        "named = ('pint', 'matplotlib', 'jinja2', 'torsion.model.joint', 'torsion.model.gears.gear',"
        " 'torsion.model.shafts.shaft', 'torsion.kernels.joints.cross', 'torsion.rules.class_rules.m68',"
        " 'torsion.analyses.response.over_speed')\n"
        "print([name for name in named if name in sys.modules])\n"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
