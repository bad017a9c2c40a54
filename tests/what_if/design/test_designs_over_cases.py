"""Designs by processes: as by one, over all cases of the file, and the true optimum by enumeration."""

from dataclasses import replace
from itertools import product
from math import log, pi
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion import processes, rules
from torsion.findings import Findings, Work
from torsion.output.chapters.what_if.design import design_line
from torsion.rules.verdict_line import Checks
from torsion.what_if.design.design_results import Design
from torsion.what_if.variants.chunks import solved

SIZES = """name,stiffness [kN*m/rad],psi,rated_torque [kN*m],vibratory_torque [N*m],mass [kg]
small,9.6,0.9,1.25,190,34
middle,13,0.85,1.6,220,43
large,17,0.85,2.0,250,53
other,9600,0.5,1.1,500,20
huge,29,0.8,3.15,310,82
"""
TRAIN = """name: drive
operation: {{speeds: {{from: 300 rpm, to: 1800 rpm, steps: 41}}, rated: {{speed: 1500 rpm, power: 100 kW}}}}
train:
  - motor: {{name: motor, inertia: 1.2, ripple: [{{order: 2, torque: 8 %, phase: 20 deg}}]}}
  - coupling: {{name: rubber, stiffness: 13 kN*m/rad, psi: 0.85, rated_torque: 3 kN*m, vibratory_torque: 220 N*m}}
  - disc: {{name: hub, inertia: 0.15}}
  - shaft: {{name: tail, length: 1.4 m, diameter: 60 mm, material: light}}
  - coupling: {{name: plates, stiffness: 2 MN*m/rad, psi: 0.05, vibratory_torque: 150 N*m}}
  - propeller: {{name: pump, inertia: 0.95, blades: 2, excitation: [{{blade_order: 1, torque: 10 %}}]}}
materials: {{light: {{shear_modulus: 79.3 GPa, density: 0}}}}
analyses:
  modes: {{count: 2}}
  response:
{design}
rules: [coupling-maker]
{more}
"""
CATALOGUE, DIAMETER = "rubber: {catalogue: k.csv}", "tail.diameter: {from: 40 mm, to: 75 mm}"
PHASE = "motor.ripple.1.phase: {from: 0 deg, to: 180 deg}"
CASES = (
    "cases: {worn: {scale: {rubber.stiffness: 70 %}}, half: {set: {operation.rated.power: 60 kW}}}"
)


def text(*chosen: str, more: str = "", design: str = "") -> str:
    choose = "\n".join(
        [
            "  design:",
            *([design] if design else []),
            "    choose:",
            *(f"      {one}" for one in chosen),
        ]
    )
    return TRAIN.format(design=choose, more=more)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("design")
    (found / "k.csv").write_text(SIZES)
    return found


def designed(scene: str, folder: Path) -> Design:
    return torsion.run(torsion.parse(scene, str(folder / "train.yaml"))).need(Design)


ROWS = 8
BY_PHASE = """  - motor: {name: motor, inertia: 1.2, ripple: [{order: 2, torque: 30 %, phase: 20 deg}]}
  - coupling: {name: rubber, stiffness: 13 kN*m/rad, psi: 0.85, vibratory_torque: 220 N*m}
  - disc: {name: hub, inertia: 0.3}
  - shaft: {name: tail, length: 1.4 m, diameter: 60 mm, material: light}
  - coupling: {name: plates, stiffness: 2 MN*m/rad, psi: 0.05, vibratory_torque: 200 N*m}
  - propeller: {name: pump, inertia: 0.95, blades: 2, excitation: [{blade_order: 1, torque: 10 %}]}
"""


@pytest.fixture(scope="module")
def mixed(folder: Path) -> str:
    """A coupling of a catalogue, a diameter and a phase; stiffer rows may carry more torque, up to one of them."""
    rows = [
        f"{k},{6 * 1.06**k:.6g},{0.9 - 0.01 * k:.4g},{150 + 30 * k - 1.2 * k**2:.6g}"
        for k in range(ROWS)
    ]
    (folder / "rows.csv").write_text(
        "name,stiffness [kN*m/rad],psi,vibratory_torque [N*m]\n" + "\n".join(rows) + "\n"
    )
    scene = text(
        "rubber: {catalogue: rows.csv}",
        DIAMETER,
        PHASE.replace("0 deg, to: 180", "-90 deg, to: 90"),
        design="    evaluations: 150\n    seed: SEED",
    )
    head, tail = scene.split("  - motor")[0], scene[scene.index("materials:") :]
    head = head.replace("steps: 41", "steps: 9")  # peaks between speeds are sought
    return head + BY_PHASE + tail


def test_the_true_optimum_of_a_mixed_choice_is_found(mixed: str, folder: Path) -> None:
    """It is no end of any range, and two limits meet there."""
    study = torsion.parse(mixed.replace("SEED", "1"), str(folder / "train.yaml"))
    own = replace(
        study, analyses={key: one for key, one in study.analyses.items() if key != "design"}
    )
    work = Work(own, {}, ruled=rules.needed(own), solve=torsion.run)
    axes = np.arange(float(ROWS)), np.linspace(40, 75, 6), np.linspace(-90, 90, 3)
    grid = np.array(list(product(*axes)))
    answers = solved(work, study.variations["design"], grid, 2, judged=True)
    margins = -np.log([used for used, _ in answers.checks.values()])
    smallest = margins.min(axis=0)
    at = smallest.argmax()
    assert all(min(axis) < value < max(axis) for axis, value in zip(axes, grid[at], strict=True))
    design = designed(mixed.replace("SEED", "1"), folder)
    # What a judged run misses of a peak between two speeds, some 1e-4, may hide the last step.
    assert design.best[0].margin >= smallest.max() - 1e-3


def test_processes_find_the_choices_of_one(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Over a catalogue and cases."""
    scene = text(CATALOGUE, "tail.diameter: {from: 50 mm, to: 70 mm, steps: 6}", more=CASES)
    monkeypatch.setattr(processes, "processors", lambda: 2)
    shared = designed(scene, folder)
    monkeypatch.setattr(processes, "processors", lambda: 1)
    alone = designed(scene, folder)
    assert shared.best == alone.best
    assert np.array_equal(shared.aims, alone.aims)


def margin(found: Findings) -> float:
    """Smallest of the file and of all its cases, as a class would read it."""
    lines = [check for one in found.each.values() for check in one.need(Checks).lines]
    return min(log(check.limit / check.value) for check in lines)


def test_the_worst_of_all_cases_counts_and_each_is_proven(folder: Path) -> None:
    found = torsion.run(
        torsion.parse(
            text(
                "hub.inertia: {values: [0.05, 0.15, 0.3, 0.6, 0.9]}",
                "tail.diameter: {values: [40 mm, 50 mm, 60 mm]}",
                more=CASES,
            )
        )
    )
    design = found.need(Design)
    true = {}
    for inertia, diameter in product((0.05, 0.15, 0.3, 0.6, 0.9), (40, 50, 60)):
        own = text("tail.diameter: {values: [1 mm, 2 mm]}", more=CASES).replace(
            "hub, inertia: 0.15", f"hub, inertia: {inertia}"
        )
        own = own.replace("diameter: 60 mm", f"diameter: {diameter} mm")
        own = own[: own.index("  design:")] + own[own.index("rules:") :]
        true[str(inertia), f"{diameter} mm"] = margin(torsion.run(torsion.parse(own)))
    for one in design.best:
        assert one.margin == pytest.approx(true[one.values], rel=1e-12)
    assert design.best[0].margin == pytest.approx(max(true.values()), rel=1e-12)
    assert {one.worst_at for one in design.best} & {"case worn", "case half"}
    assert [case.results.get("design") for case in found.cases.values()] == [None, None]
    assert design.cases == ("worn", "half")
    assert dict(design_line(found))["Design"].endswith(
        "searched and solved over the nominal case and its cases worn, half"
    )


def test_a_choice_is_never_kept_where_a_case_fails() -> None:
    """Neither of a margin nor of a frequency that is aimed at; a case that is not judged does not count."""
    for aim in ("", "    aim: {mode-1.frequency: 15 Hz}"):
        for judged, proven in (("", "not kept"), (", judged: false", "kept")):
            more = f"cases: {{weak: {{set: {{rubber.vibratory_torque: 20 N*m}}{judged}}}}}"
            chosen = "rubber.stiffness: {values: [11 kN*m/rad, 13 kN*m/rad]}"
            found = torsion.run(
                torsion.parse(
                    text(
                        chosen, "hub.inertia: {values: [0.1, 0.15]}", design=aim, more=more
                    ).replace("150 N*m", "900 N*m")
                )
            )
            one = found.need(Design)
            assert one.best[one.chosen - 1].proven == proven
            words = dict(design_line(found))["Design"]
            assert f"full method: {proven}" in words
            assert ("not judged: weak" in words) == bool(judged)


def test_a_case_that_moves_a_component_reads_every_choice_of_it_anew(folder: Path) -> None:
    """A row states what the file does not, at a place that is no component in a case without the first two."""
    (folder / "r.csv").write_text("name,vibratory_torque [N*m]\na,150\nb,300\n")
    made = text(
        "plates: {catalogue: r.csv}", more="cases: {bare: {remove: [motor, rubber]}, soft: MORE}"
    )
    made = made.replace("vibratory_torque: 150 N*m", "rated_torque: 9 kN*m")
    made = made.replace("operation: {", "operation: {at: pump, ")
    made = made.replace("MORE", "{scale: {rubber.stiffness: 70 %}}")
    study = torsion.parse(made, str(folder / "scene.yaml"))
    variation = study.variations["design"]
    is_put_in_columns = [
        variation.in_case(study.cases[name]).declare is not None for name in ("bare", "soft")
    ]
    assert is_put_in_columns == [False, True]


def test_a_case_without_rules_has_no_limit_that_counts() -> None:
    chosen = "hub.inertia: {values: [0.1, 0.15]}"
    more = "cases: {free: {rules: [], scale: {rubber.stiffness: 20 %}}}"
    found, alone = (
        torsion.run(torsion.parse(text(chosen, more=one))).need(Design) for one in (more, "")
    )
    assert [one.margin for one in found.best] == [one.margin for one in alone.best]
    assert found.best[0].worst_at == ""


def test_the_margin_before_is_that_of_the_worst_case_as_the_margin_of_a_choice_is() -> None:
    """50 kW, and 80 and 20 kW in cases, at 1200 rpm, on a coupling of 1 kN m and on choices of it."""
    powers = (
        f"{name}: {{set: {{operation.rated.power: {size} kW}}}}"
        for name, size in (("more", 80), ("less", 20))
    )
    found = torsion.run(
        torsion.parse(
            f"""name: two discs
operation: {{rated: {{speed: 1200 rpm, power: 50 kW}}}}
train:
  - disc: {{inertia: 1}}
  - coupling: {{name: rubber, stiffness: 1000, rated_torque: 1 kN*m}}
  - disc: {{inertia: 1}}
rules: [coupling-maker]
analyses: {{modes: {{count: 1}}, design: {{choose: {{rubber.rated_torque: {{values: [0.7 kN*m, 2 kN*m]}}}}, aim: margin}}}}
cases: {{{", ".join(powers)}}}
"""
        )
    ).need(Design)
    of_case = log(40.0 * pi / 80.0)  # ln of 1 kN m over the mean torque
    assert found.before == pytest.approx(of_case, rel=1e-12)
    expected = of_case + np.log([0.7, 2.0])
    assert found.aims == pytest.approx(expected, rel=1e-12)
    assert [candidate.worst_at for candidate in found.best] == 2 * ["case more"]


def test_of_couplings_with_equal_margins_the_cheapest_alone_is_on_the_front(tmp_path: Path) -> None:
    rows = "name,rated_torque [kN*m],cost\ndear,1,12\ncheap,1,10\nstrong,2,15\nweak,0.8,11\n"
    (tmp_path / "k.csv").write_text(rows)
    scene = """name: two discs
operation: {rated: {speed: 1200 rpm, power: 50 kW}}
train:
  - disc: {inertia: 1}
  - coupling: {name: rubber, stiffness: 1000, rated_torque: 1 kN*m}
  - disc: {inertia: 1}
rules: [coupling-maker]
analyses: {modes: {count: 1}, design: {choose: {rubber: {catalogue: k.csv}}, aim: margin, against: cost}}
"""
    found = designed(scene, tmp_path)
    assert found.front_amount.tolist() == [10.0, 15.0]
    assert found.front_margin == pytest.approx(np.log([0.8 * pi, 1.6 * pi]), rel=1e-12)
