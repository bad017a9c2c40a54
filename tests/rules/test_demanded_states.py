"""Misfire, zero pitch and another stiffness: rows NOT JUDGED only where neither the file nor a case of it has them."""

import pytest

import torsion
from torsion.rules.verdict_line import Checks
from torsion.schema.variants.cases import states_of_cases

SCENE = """
name: n
operation: {speeds: {from: 300 rpm, to: 600 rpm, steps: 4}, rated: {speed: 600 rpm, power: 50 kW}}
materials: {s: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850, tensile_strength: 600 MPa}}
train:
  - engine: {name: diesel, ENGINE}
  - coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, vibratory_torque: 9 kN*m}
  - shaft: {name: line, length: 2 m, diameter: 150 mm, role: intermediate, material: s, segments: 1}
  - propeller: {name: wheel, inertia: 60, PITCH}
rules: [RULE]
"""
STATES = ("misfire", "zero pitch", "other stiffness")
MISFIRE, PITCH = (
    "{set: {diesel.misfire: 2}}",
    "{set: {operation.load: [[300 rpm, 90 N*m], [600 rpm, 250 N*m]]}}",
)
SOFT = "{scale: {rubber.stiffness: 80 %}}"
ENGINE = (
    "cylinders: 4, strokes: 4, firing_order: [1, 3, 4, 2], crank_inertia: 1.5, stiffness: 6 MN*m/rad, "
    "loss_factor: 1.5 %, geometry: {bore: 180 mm, stroke: 220 mm, rod_length: 440 mm}, "
    "masses: {piston: 8 kg, rod: {mass: 15 kg, centre: 150 mm, inertia: 0.5}}, "
    "gas: {cycle: wiebe, compression_ratio: 14, charge: 2 bar, exhaust: 1.5 bar, imep: 8 bar, p_max: 100 bar, "
    "duration: 60 deg}, mechanical_efficiency: 90 %"
)


def open_rows(
    rule: str,
    cases: str = "",
    pitch: str = "pitch: controllable",
    engine: str = "",
    role: str = "intermediate",
) -> dict[str, str]:
    text = (
        SCENE.replace("intermediate", role)
        .replace("ENGINE", ENGINE + engine)
        .replace("PITCH", pitch)
        .replace("RULE", rule)
    )
    found = torsion.run(torsion.parse(text + cases)).need(Checks).lines
    return {one.clause: one.verdict for one in found if one.clause in STATES}


@pytest.mark.parametrize("rule", ["dnv", "kr", "iacs-m68"])
def test_states_that_no_case_has_are_not_judged(rule: str) -> None:
    demanded = STATES[:2] if rule == "iacs-m68" else STATES
    assert open_rows(rule) == dict.fromkeys(demanded, "not judged")


@pytest.mark.parametrize(
    ("cases", "left"),
    [
        (f"cases: {{a: {MISFIRE}, b: {PITCH}, c: {SOFT}}}\n", ()),
        (f"cases: {{a: {MISFIRE}, b: {PITCH}}}\n", ("other stiffness",)),
        (f"cases: {{a: {MISFIRE[:-1]}, judged: false}}, b: {PITCH}, c: {SOFT}}}\n", ("misfire",)),
        (
            f"cases: {{a: {MISFIRE[:-1]}, rules: [coupling-maker]}}, b: {PITCH}, c: {SOFT}}}\n",
            ("misfire",),
        ),
    ],
)
def test_states_that_a_judged_case_has_are_no_row(cases: str, left: tuple[str, ...]) -> None:
    assert open_rows("dnv", cases) == dict.fromkeys(left, "not judged")


def test_a_misfire_of_the_file_itself_and_a_fixed_pitch_are_no_row() -> None:
    for engine in (", misfire: 2", ", misfire: worst"):
        assert open_rows("iacs-m68", pitch="pitch: fixed", engine=engine) == {}


def test_a_pitch_that_a_ship_does_not_state_is_a_restriction() -> None:
    assert open_rows("iacs-m68", pitch="blades: 4", engine=", misfire: 2") == {}
    assert open_rows("iacs-m68", pitch="blades: 4", engine=", misfire: 2", role="propeller") == {
        "zero pitch": "restricted"
    }


@pytest.mark.parametrize(
    ("cases", "states"),
    [
        (None, []),
        ({"from": "tolerances"}, [{"other stiffness"}]),
        ({"a": {"set": {"e.misfire": []}}}, [set()]),
        (
            {"a": {"set": {"e.misfire": 1}}, "b": {"based_on": "a", "speeds": {}}},
            [{"misfire"}, {"misfire"}],
        ),
        ({"a": {"set": {"e.misfire": 1}, "judged": False}, "b": {"based_on": "a"}}, [{"misfire"}]),
        ({"a": {"based_on": "b"}, "b": {"based_on": "a"}}, [set(), set()]),
        ({"a": None, "b": {"set": 3, "scale": []}, "c": "x"}, [set(), set(), set()]),
    ],
)
def test_states_of_the_cases_of_a_file(cases: object, states: list[set[str]]) -> None:
    assert [one.states for one in states_of_cases(cases)] == states
