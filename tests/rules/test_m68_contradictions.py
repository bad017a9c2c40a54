"""A feature that the file states nearby takes no factor away from a shaft: roles, notches, cases, forging."""

import pytest

import torsion
from torsion.errors import InputError
from torsion.rules.class_rules.m53 import M53Settings
from torsion.rules.verdict_line import Checks

TRAIN = """
name: line
materials: {{steel: {{shear_modulus: 80 GPa, density: 7850, tensile_strength: 600 MPa, loss_factor: 0.005}}}}
operation: {{speeds: {{from: 30 rpm, to: 105 rpm}}, rated: {{speed: 100 rpm, power: 1 MW}}}}
train:
- disc: {{name: a, inertia: 20000}}
- shaft: {{name: line, length: 10 m, diameter: 400 mm, material: steel, {shaft}}}
- disc: {{name: b, inertia: 40000}}
excitations: [{{at: a, order: 4, torque: 2800}}]
rules: [iacs-m68]
"""


def limit(shaft: str) -> float:
    """The limit tau_C (N/mm2) in continuous use, of the first row of its clause."""
    checks = torsion.run(torsion.parse(TRAIN.format(shaft=shaft))).need(Checks)
    return next(check.limit for check in checks.lines if check.clause == "tau_C")


@pytest.mark.parametrize(
    ("shaft", "c_k"),
    [
        ("role: intermediate, features: flange", 1.0),
        ("role: propeller, features: flange", 0.55),
        ("role: propeller, features: shrink fit", 0.55),
        ("role: propeller, features: tube shaft", 0.80),
        ("role: thrust, features: flange", 0.85),
        (
            "role: intermediate, features: flange, notches: {keyway: {width: 90 mm, depth: 30 mm, fillet: 2 mm}}",
            0.45,
        ),
        ("role: intermediate, features: flange, notches: {hole: 60 mm}", 0.50),
    ],
)
def test_the_least_factor_of_role_features_and_notches_counts(shaft: str, c_k: float) -> None:
    assert limit(shaft) / limit("role: intermediate, features: flange") == pytest.approx(
        c_k, rel=0.03
    )


def test_a_factor_of_manufacture_that_the_text_does_not_have_is_refused() -> None:
    with pytest.raises((InputError, ValueError), match=r"no factor K of 1\.2"):
        M53Settings.model_validate({"manufacture": 1.2})
