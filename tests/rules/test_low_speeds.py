"""A judgement that lacks low speeds says so: limits hold from standstill, and a train passes all speeds to start."""

import math
from functools import cache

import pytest
from tests.for_all import for_all

import torsion
from torsion.output.headline import headline
from torsion.rules.verdict_line import Checks

RPM = math.pi / 30.0
SHIP = """
name: n
operation: {speeds: {from: FIRST rpm, to: 126 rpm, steps: 41}, rated: {speed: 120 rpm, power: 50 kW}, load: constant}
materials: {steel: {density: 7850, shear_modulus: 79.3 GPa, tensile_strength: 500 MPa}}
train:
- motor: {name: drive, inertia: 2, ripple: [{order: 1, torque: 4 N*m}]}
- coupling: {name: rubber, stiffness: 2e6, loss_factor: 5 %, vibratory_torque: 9 kN*m}
- shaft: {name: line, length: 0.5, diameter: 200 mm, role: ROLE, material: steel, features: [flange], segments: 1}
- propeller: {inertia: 6, pitch: fixed}
rules: [RULE]
"""
THROW = (
    "iacs-m53: {pin: 200 mm, journal: 200 mm, pin_fillet: 12 mm, journal_fillet: 12 mm, web_thickness: 70 mm, "
    "web_width: 260 mm, radius: 140 mm, bending: 4 MPa, shear: 1 MPa, strokes: 4CONTINUOUS}"
)
FROM_START = ("iacs-m68", "lr", "kr", "mil-std-167", THROW.replace("CONTINUOUS", ""))
GRID = "{line_frequency: none, continuous: {from: FROM rpm, to: TO rpm}}"


@cache
def solved(rule, first):
    role = "crank" if "m53" in rule else "intermediate"
    return torsion.run(
        torsion.parse(SHIP.replace("FIRST", str(first)).replace("ROLE", role).replace("RULE", rule))
    )


def rows(rule, first, clauses=()):
    """The rows of stresses, by their kind."""
    lines = solved(rule, first).need(Checks).lines
    return [
        one
        for one in lines
        if one.unit == "N/mm2" or one.clause in ("speeds", "separation", *clauses)
    ]


@pytest.mark.parametrize("rule", FROM_START)
def test_speeds_that_begin_above_every_barred_range_are_not_judged(rule) -> None:
    """UR M68 limits stresses from lambda 0, and bars ranges below 0.8; UR M53 takes all speeds."""
    (low,) = [one for one in rows(rule, 114) if one.clause == "speeds"]
    assert (low.verdict, low.where) == ("not judged", "line")
    assert low.what.endswith("below the computed speeds")
    assert low.note == "judged from 114 rpm only, 0.95 of the rated speed"
    assert solved(rule, 114).exit_status == 1


@pytest.mark.parametrize("rule", FROM_START)
def test_speeds_that_begin_below_are_a_restriction_that_names_the_first(rule) -> None:
    lines = [one for one in rows(rule, 60) if one.clause not in ("orders", "misfire")]
    assert {one.verdict for one in lines} == {"restricted"}
    assert all(
        "judged from 60 rpm only, 0.5 of the rated speed" in one.restrictions for one in lines
    )


@pytest.mark.parametrize("rule", FROM_START)
def test_speeds_from_a_fifth_of_the_rated_one_have_the_start(rule) -> None:
    assert not [
        one for one in rows(rule, 24) if any("judged from" in words for words in one.restrictions)
    ]
    assert headline(solved("mil-std-167", 24))[0][1] == "PASS: 1 limit met"


def test_speeds_that_are_computed_above_for_the_rule_have_the_same_restriction() -> None:
    text = (
        SHIP.replace("FIRST", "60")
        .replace("126", "120")
        .replace("ROLE", "intermediate")
        .replace("RULE", "iacs-m68")
    )
    (stress,) = [
        one for one in torsion.run(torsion.parse(text)).need(Checks).lines if one.clause == "tau_C"
    ]
    assert stress.restrictions == ("judged from 60 rpm only, 0.5 of the rated speed",)


@pytest.mark.parametrize(("first", "verdict"), [(60, "pass"), (114, "restricted")])
def test_a_limit_of_continuous_use_lacks_speeds_only_if_none_is_below_the_usual_ones(
    first, verdict
) -> None:
    lines = [
        one for one in solved("coupling-maker", first).need(Checks).lines if one.clause == "T_KW"
    ]
    assert [one.verdict for one in lines] == [verdict]


@for_all(
    "rule",
    [f"{name}: {GRID}" for name in ("api-610", "api-617", "api-618", "api-684")]
    + [THROW.replace("CONTINUOUS", ", continuous: {from: FROM rpm, to: TO rpm}")],
)
@for_all(("first", "last"), [(120, 126), (12, 110), (121, 126), (60, 125)])
def test_continuous_use_that_leaves_out_speeds_of_the_operation_is_a_restriction(
    rule, first, last
) -> None:
    lines = rows(rule.replace("FROM", str(first)).replace("TO", str(last)), 12)
    lines = [one for one in lines if one.verdict != "not judged"]
    assert lines
    assert {one.verdict for one in lines} == {"restricted"}
    words = f"judged in continuous use only, {first} rpm to {last} rpm"
    assert all(words in one.restrictions for one in lines)


def test_margins_over_a_range_that_lacks_the_rated_speed_are_a_restriction_without_speeds_of_the_operation() -> (
    None
):
    text = SHIP.replace("speeds: {from: FIRST rpm, to: 126 rpm, steps: 41}, ", "").replace(
        "ROLE", "intermediate"
    )
    text = text.replace(", ripple: [{order: 1, torque: 4 N*m}]", "")
    rule = "api-617: " + GRID.replace("FROM", "100").replace("TO", "110")
    lines = torsion.run(torsion.parse(text.replace("RULE", rule))).need(Checks).lines
    assert {one.verdict for one in lines} == {"restricted"}


@pytest.mark.parametrize(("first", "verdict"), [(100, "pass"), (120, "pass"), (121, "restricted")])
def test_an_operating_range_of_type_iii_holds_the_rated_speed(first, verdict) -> None:
    """Below the range 1.75 times the limit holds, which the rated speed does not have."""
    rule = f"mil-std-167: {{continuous: {{from: {first} rpm, to: 126 rpm}}}}"
    assert {line.verdict for line in rows(rule, 24)} == {verdict}
