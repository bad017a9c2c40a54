"""Conditions of a limit that the file does not answer are named, and contradictions of it are refused."""

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.output.headline import headline
from torsion.rules import rule
from torsion.rules.class_rules.m68_shafts import tau_c
from torsion.rules.verdict_line import Checks

SHIP = """
name: n
operation: {speeds: {from: 20 rpm, to: 105 rpm, steps: 41}, rated: {speed: 100 rpm, power: 50 kW}, load: constant}
materials: {steel: {density: 7850, shear_modulus: 79.3 GPa, tensile_strength: 500 MPa}}
train:
- motor: {name: drive, inertia: 1000, ripple: [{order: 1, torque: TORQUE N*m}]}
- shaft: {name: line, length: 0.5, diameter: 200 mm, role: intermediate, material: steel, features: [FEATURE]}
- propeller: {inertia: 1000, pitch: fixed}
rules: [RULE]
"""
W_P = math.pi / 16 * 0.2**3  # m3


def solved(text=SHIP, feature="flange", rule="iacs-m68", torque=4.0):
    for word, value in (("FEATURE", feature), ("RULE", rule), ("TORQUE", torque)):
        text = text.replace(word, str(value))
    return torsion.run(torsion.parse(text))


def stress(found):
    (line,) = [
        one
        for one in found.need(Checks).lines
        if one.clause in ("tau_C", "tau_1") and one.has_limit
    ]
    return line


@pytest.mark.parametrize(
    ("feature", "rule", "share", "restricted"),
    [
        ("shrink fit", "iacs-m68", 0.95, True),
        ("shrink fit", "iacs-m68", 0.85, False),
        ("flange", "iacs-m68", 0.95, False),
        ("shrink fit", "lr", 0.95, True),
        ("shrink fit", "iacs-m68: {conditions: drawing 1}", 0.95, False),
    ],
)
def test_a_shrink_fit_near_tau_c_has_the_condition_of_note_1(
    feature, rule, share, restricted
) -> None:
    """Half of the ripple twists the shaft between two equal inertias; tau_C is least from 0.9 of the rated speed."""
    torque = 2 * share * float(tau_c(500.0, 200.0, 1.0, 1.0)) * 1e6 * W_P
    line = stress(solved(feature=feature, rule=rule, torque=torque))
    assert line.utilisation == pytest.approx(share, rel=5e-3)
    assert line.verdict == ("restricted" if restricted else "pass")
    assert [
        words.startswith("shrink fit of 'line': seat 1 to 2 % thicker")
        for words in line.restrictions
    ] == ([True] if restricted else [])


def test_least_diameters_are_not_judged_without_the_rated_power() -> None:
    found = solved(SHIP.replace(", power: 50 kW", ""))
    (line,) = [one for one in found.need(Checks).lines if one.clause == "minimum diameter"]
    assert (line.where, line.verdict, found.exit_status) == ("line", "not judged", 1)
    assert "write `power` of `operation.rated`" in line.note
    assert headline(found)[0][1].startswith(f"NOT JUDGED: {line.what}, line")


GEARED = """
name: n
operation: {speeds: {from: 1000 rpm, to: 1200 rpm}}
train:
- motor: {name: drive, inertia: 1}
- coupling: {name: rubber, stiffness: 1e8}
- gear: {name: box, RATIO, inertia: [0.1, 0.1]}
- MACHINE
rules: [RULE: {line_frequency: none}]
"""


@for_all("rule", ["api-610", "api-617", "api-618", "api-684"])
@for_all(
    ("ratio", "machine", "words"),
    [
        (
            "ratio: 2",
            "disc: {inertia: 1}",
            "gear mesh frequency of 'box' not judged: its `teeth` are not given",
        ),
        ("teeth: [20, 40]", "disc: {inertia: 1}", ""),
        (
            "teeth: [20, 40]",
            "pump: {name: wheel, inertia: 1}",
            "blade passing frequency of 'wheel' not judged: its `blades` are not given",
        ),
        ("teeth: [20, 40]", "pump: {name: wheel, inertia: 1, blades: 7}", ""),
    ],
)
def test_an_excitation_whose_number_is_not_known_is_a_restriction(
    rule, ratio, machine, words
) -> None:
    text = GEARED.replace("RATIO", ratio).replace("MACHINE", machine).replace("RULE", rule)
    found = torsion.run(torsion.parse(text))
    restrictions = {words for line in found.need(Checks).lines for words in line.restrictions}
    assert restrictions == ({words} if words else set())
    assert headline(found)[0][1].startswith(
        f"PASS with restrictions: {words}" if words else "PASS: "
    )


def test_the_vanes_of_a_pump_are_an_excitation() -> None:
    """Seven vanes at half the speed: order 3.5 of the motor."""
    text = GEARED.replace("RATIO", "teeth: [20, 40]").replace(
        "MACHINE", "pump: {name: wheel, inertia: 1, blades: 7}"
    )
    lines = torsion.run(torsion.parse(text.replace("RULE", "api-610"))).need(Checks).lines
    (vanes,) = [line for line in lines if line.what == "Separation from blade passing of wheel"]
    assert vanes.order == Fraction(7, 2)


@pytest.mark.parametrize("drive", ["electric", "turbine", "slip coupling"])
def test_kr_has_limits_for_drives_without_an_engine_by_agreement_alone(drive) -> None:
    found = solved(rule=f"kr: {{drive: {drive}}}")
    line = stress(found)
    assert line.verdict == "restricted"
    assert line.restrictions == (
        f"limits by agreement with KR, values of 202.1: 202.2 has none for `drive: {drive}`",
    )
    by_motor = stress(
        solved(rule="kr")
    ).restrictions  # of a file that does not state `drive` and has a motor alone
    assert by_motor == (line.restrictions[0].replace(drive, "electric"),)
    assert stress(solved(rule=f"lr: {{drive: {drive}}}")).verdict == "pass"


def test_a_motor_beside_a_crankshaft_is_no_drive_of_kr(study) -> None:
    """Limits for drives without an engine are by agreement; a train with a crankshaft has an engine."""
    line = ("shaft", {"name": "line", "length": 1, "diameter": 0.1, "role": "intermediate"})
    crank = ("shaft", {"name": "crank", "length": 1, "diameter": 0.1, "role": "crank"})
    motor, screw = ("motor", {"inertia": 1}), ("propeller", {"inertia": 1})
    for parts, by_agreement in (([motor, line, screw], True), ([motor, crank, line, screw], False)):
        shafts = {shaft.name: shaft for shaft in rule("kr").shafts(study(parts))}
        words = shafts["line"].restrictions
        assert any(word.startswith("limits by agreement") for word in words) == by_agreement


CUT_OUT = """
name: engine of four cylinders
operation: {speeds: {from: 300 rpm, to: 1200 rpm}, rated: {speed: 1000 rpm, power: 400 kW}}
train:
- engine: {cylinders: 4, strokes: 4, firing_order: [1, 3, 4, 2], inertia: 1, stiffness: 5 MN*m/rad, loss_factor: 2 %,
    gas: {table: [[0.5, 100 N*m, 0 deg], [2, 900 N*m, 0 deg]]}CUT}
- shaft: {name: line, length: 1 m, diameter: 150 mm, role: intermediate, features: flange}
- propeller: {inertia: 20, pitch: fixed}
materials: {steel: {shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa}}
rules: [iacs-m68]
"""


@pytest.mark.parametrize(
    "rating", [", power: 400 kW}", "}\n  load: [[1 rpm, 1 N*m], [2000 rpm, 8 kN*m]]"]
)
def test_least_diameter_is_that_of_all_cylinders_where_one_does_not_fire(rating: str) -> None:
    """The rated torque is that of all four, whether the file states the power or a table of the load."""
    text = CUT_OUT.replace("operation: {", "operation:\n  ").replace(", rated:", "\n  rated:")
    text = text.replace(", power: 400 kW}}", rating)
    least, reduced = (
        next(
            check.limit
            for check in torsion.run(torsion.parse(text.replace("CUT", cut))).need(Checks).lines
            if check.clause == "minimum diameter"
        )
        for cut in ("", ", cut_out: 2")
    )
    assert reduced == pytest.approx(least, rel=1e-12)


def test_the_rated_torque_of_a_mesh_is_that_of_all_cylinders_where_one_does_not_fire() -> None:
    gear = "- gear: {name: g, ratio: 2, inertia: [1, 2], application_factor: 1.4}\n- shaft"
    text = CUT_OUT.replace("- shaft", gear).replace("iacs-m68", "gear-hammer")
    limit, reduced = (
        next(
            check.limit
            for check in torsion.run(torsion.parse(text.replace("CUT", cut))).need(Checks).lines
            if check.clause == "(K_A - 1) T_rated"
        )
        for cut in ("", ", cut_out: 2")
    )
    assert limit == pytest.approx(0.4 * 400e3 / (1000 * np.pi / 30), rel=1e-9)
    assert reduced == pytest.approx(limit, rel=1e-12)


SCENE = Path(__file__).parents[2] / "shafting_specs" / "diesel_misfire.yaml"


@pytest.mark.parametrize("rule", ["kr", "nk"])
@pytest.mark.parametrize(("key", "value", "right"), [("strokes", 2, 4), ("cylinders", 6, 8)])
def test_settings_that_contradict_the_engine_of_the_file_are_refused(
    rule, key, value, right
) -> None:
    """The engine of the scene has eight cylinders and four strokes."""
    text = SCENE.read_text(encoding="utf-8")
    named = text.replace(
        "rules: [coupling-maker, gear-hammer]", f"rules: [{rule}: {{{key}: {value}}}]"
    )
    with pytest.raises(torsion.InputError) as refusal:
        torsion.parse(named, str(SCENE))
    (fault,) = [one for one in refusal.value.faults if key in one.message]
    assert (
        fault.message
        == f"`{key}` {value} of {rule} contradicts the engine of the file, which has {right}"
    )
    assert fault.hint == f"{key}: {right}, or leave it out"
    assert fault.line == text.count("\n", 0, text.index("rules: [")) + 1
    agreed = named.replace(f"{key}: {value}", f"{key}: {right}")
    assert torsion.parse(agreed, str(SCENE)).rules


@pytest.mark.parametrize(
    ("strength", "settings", "words"),
    [
        (760, "", ""),
        (761, "", "special approval of 'line': carbon steel of 761 N/mm2, above 760"),
        (800, ": {alloy: line}", ""),
        (900, ": {alloy: line}", "special approval of 'line': alloy steel of 900 N/mm2, above 800"),
        (900, ": {alloy: line, conditions: letter 7}", ""),
    ],
)
def test_a_stronger_steel_than_the_rule_has_is_by_approval(strength, settings, words) -> None:
    line = stress(solved(SHIP.replace("500 MPa", f"{strength} MPa"), rule=f"iacs-m68{settings}"))
    assert line.restrictions == ((words,) if words else ())


@pytest.mark.parametrize(("strength", "is_agreed"), [(590, True), (591, False)])
def test_a_crankshaft_of_kr_is_stronger_than_its_table_by_agreement_alone(
    strength, is_agreed
) -> None:
    text = SHIP.replace("500 MPa", f"{strength} MPa").replace(", features: [FEATURE]", "")
    line = stress(solved(text.replace("intermediate", "crank"), rule="kr"))
    words = () if is_agreed else ("strength above 590 N/mm2 by agreement with KR",)
    assert line.restrictions == words


def test_major_critical_speeds_of_unknown_cylinders_are_not_judged() -> None:
    text = SHIP.replace(", features: [FEATURE]", "").replace("intermediate", "crank")
    for settings, verdicts in (
        ("", ["not judged"]),
        (": {cylinders: 6, strokes: 2}", ["pass"]),
        (": {arrangement: V60, strokes: 4}", []),
    ):
        lines = solved(text, rule=f"kr{settings}").need(Checks).lines
        assert [line.verdict for line in lines if line.clause == "major critical speed"] == verdicts


@pytest.mark.parametrize(
    ("duty", "role", "right"),
    [("propulsion", "generator", "generator set"), ("generator set", "propeller", "propulsion")],
)
def test_a_duty_that_contradicts_what_is_driven_is_refused(duty, role, right) -> None:
    """The table of a generator set permits 90 N/mm2 below 0.9, that of a main engine 34 at 1.05, in place of 21."""
    text = SHIP.replace(", features: [FEATURE]", "").replace("role: intermediate", "role: crank")
    text = text.replace(
        "- propeller",
        f"- shaft: {{name: end, length: 0.5, diameter: 200 mm, role: {role}, "
        "material: steel}\n- propeller",
    )
    with pytest.raises(
        torsion.InputError, match=f"`duty` {duty} of kr contradicts the shaft of role {role}"
    ):
        solved(text, rule=f"kr: {{duty: {duty}}}")
    solved(text, rule=f"kr: {{duty: {right}}}")


def test_a_train_that_runs_above_the_last_limit_is_not_judged_there_wherever_its_speeds_end() -> (
    None
):
    found = solved(SHIP.replace("operation: {", "operation: {highest: 110 rpm, "))
    (above,) = [
        line
        for line in found.need(Checks).lines
        if line.what.endswith("above the last speed with a limit")
    ]
    assert (above.verdict, found.exit_status) == ("not judged", 1)
    assert above.speed <= 110 * math.pi / 30 * (1 + 1e-9)


def test_a_generator_set_without_propulsion_has_no_least_diameters_of_propulsion_shafts() -> None:
    text = SHIP.replace(", power: 50 kW", "").replace(
        "- propeller: {inertia: 1000, pitch: fixed}",
        (
            "- shaft: {name: end, length: 0.5, diameter: 200 mm, role: generator, material: steel}\n- disc: {inertia: 1000}"
        ),
    )
    assert "minimum diameter" not in {line.clause for line in solved(text).need(Checks).lines}
