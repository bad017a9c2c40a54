"""Files that leave open, or break, what a rule demands never pass plainly."""

import pytest

import torsion
from torsion.errors import InputError
from torsion.rules.verdict_line import Check, Checks

LINE = """
name: n
operation: {speeds: {from: 20 rpm, to: 105 rpm, steps: 41}, rated: {speed: 100 rpm, power: 50 kW}}
materials: {steel: {density: 7850, shear_modulus: 79.3 GPa, tensile_strength: 500 MPa}}
train:
- DRIVE: {name: drive, inertia: 1000}
- shaft: {name: line, length: 0.5, diameter: 200 mm, role: intermediate, material: steel, SHAFT}
- shaft: {name: second, length: 0.5, diameter: 200 mm, role: intermediate, material: steel, features: flange}
- propeller: {inertia: 1000, pitch: fixed, blades: 4, excitation: [{blade_order: 1, torque: 1 %}]}
rules: [RULE]
"""


def rows(text: str) -> list[Check]:
    return list(torsion.run(torsion.parse(text)).need(Checks).lines)


def line(shaft: str = "features: flange", rule: str = "iacs-m68", drive: str = "motor") -> list[Check]:
    """Rows on the stress in continuous use of the shaft `line`."""
    text = LINE.replace("SHAFT", shaft).replace("RULE", rule).replace("DRIVE", drive)
    return [one for one in rows(text) if one.where == "line" and one.clause in ("tau_C", "tau_1") and one.has_limit]


def test_splines_have_no_factor_in_the_table() -> None:
    splines = "features: flange, notches: {splines: {teeth: 10, root: 170 mm, width: 25 mm, fillet: 3 mm}}"
    (row,) = line(splines)
    assert (row.verdict, "splines" in row.note) == ("not judged", True)


@pytest.mark.parametrize(
    ("fillet", "verdict"), [(", fillet: 16 mm", "pass"), (", fillet: 15 mm", "not judged"), ("", "not judged")]
)
def test_the_fillet_of_an_integral_flange_is_at_least_eight_per_cent_of_the_diameter(fillet: str, verdict: str) -> None:
    (row,) = line(f"features: flange, step: {{flange: {{diameter: 400 mm, thickness: 50 mm{fillet}}}}}")
    assert row.verdict == verdict


@pytest.mark.parametrize(
    "setting", ["conditions: ' '", "verified: {edition: ' ', by: A}", "verified: {edition: '1', by: ' '}"]
)
def test_a_blank_document_answers_nothing(setting: str) -> None:
    with pytest.raises(InputError, match="blank"):
        line(rule=f"iacs-m68: {{{setting}}}")


@pytest.mark.parametrize(("drive", "is_agreed"), [("motor", True), ("turbine", True), ("disc", False)])
def test_kr_has_no_limits_of_its_own_behind_a_motor_or_turbine(drive: str, is_agreed: bool) -> None:
    (row,) = line(rule="kr", drive=drive)
    assert any("by agreement with KR" in words for words in row.restrictions) == is_agreed
