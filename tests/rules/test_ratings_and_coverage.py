"""What a rule must not let pass: a rating that grows with the load, majors without a crankshaft, limits unnamed."""

import math

import pytest

import torsion
from torsion.rules import not_judged
from torsion.rules.verdict_line import Check, Checks

GEARED = """
name: geared
operation:
  speeds: {from: 400 rpm, to: 1500 rpm, steps: 60}
  rated: {speed: 1200 rpm, power: 50 kW}
  load: LOAD
train:
- motor: {inertia: 2, ripple: [{order: 1, torque: 40 N*m}]}
- coupling: {stiffness: 2e4, loss_factor: 5 %, heat_limit: 1 W}
- gear: {teeth: [20, 40], inertia: [0.1, 0.6], application_factor: 1.35}
- propeller: {inertia: 6}
rules: [gear-hammer]
"""
LINE = """
name: line
operation: {speeds: {from: 400 rpm, to: 1400 rpm, steps: 101}, rated: {speed: 1200 rpm, power: 50 kW}}
train:
- motor: {inertia: 40}
- shaft: {length: 2 m, diameter: 104 mm, role: intermediate}
- propeller: {inertia: 100, blades: 4, excitation: [{blade_order: 1, torque: 1 %}]}
rules: [kr: {cylinders: 1, strokes: 2}]
"""


def limit(load: str) -> float:
    found = torsion.run(torsion.parse(GEARED.replace("LOAD", load)))
    return next(one.limit for one in found.need(Checks).lines if one.clause.startswith("(K_A"))


def test_a_load_above_the_rated_torque_does_not_raise_the_limit_of_a_gear() -> None:
    rated = 50e3 / (1200 * math.pi / 30)
    assert limit("propeller") == pytest.approx(0.35 * rated, rel=1e-12)
    assert limit("[[400 rpm, 8000 N*m], [1500 rpm, 8000 N*m]]") == pytest.approx(
        0.35 * rated, rel=1e-12
    )
    assert limit("[[400 rpm, 100 N*m], [1500 rpm, 100 N*m]]") == pytest.approx(
        0.35 * 100, rel=1e-12
    )


def test_majors_are_judged_at_the_reference_where_the_train_has_no_crankshaft() -> None:
    found = torsion.run(torsion.parse(LINE))
    (major,) = (one for one in found.need(Checks).lines if one.clause == "major critical speed")
    assert 0.8 < major.value < 1.1
    assert major.fails


def test_limits_of_a_maker_that_no_rule_judges_are_said() -> None:
    study = torsion.parse(GEARED.replace("LOAD", "propeller"))
    assert [what for what, _ in not_judged(study) if what.startswith("limits of")] == [
        "limits of coupling-1"
    ]


def test_a_margin_of_nothing_uses_its_limit_infinitely() -> None:
    one = Check(
        "api-610",
        "margin",
        "mode 1",
        "margin",
        0.0,
        0.1,
        "1",
        "not kept",
        "to be verified",
        at_least=True,
    )
    assert one.utilisation == math.inf
