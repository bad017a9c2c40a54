"""No rule passes over what it was not judged at: speeds that end below the rated one, or begin above it."""

import math
from functools import cache

import pytest

import torsion
from torsion.output import check_words
from torsion.output.chapters import verdict
from torsion.output.headline import headline
from torsion.output.stored.results_json import results
from torsion.rules.demands import with_reach
from torsion.rules.verdict_line import Check, Checks

RPM = math.pi / 30.0
SCENE = """
name: n
operation: {speeds: {from: FIRST rpm, to: LAST rpm, steps: 21}, rated: {speed: 1200 rpm, power: 50 kW}, load: LOAD}
train:
- motor: {inertia: 2, ripple: [{order: 1, torque: 4 N*m}]}
- coupling: {name: rubber, stiffness: 2e4, loss_factor: 5 %, heat_limit: 1 kW, rated_torque: 410 N*m}
- shaft: {name: line, length: 0.5, diameter: 80 mm, role: intermediate}
- shaft: {name: throw, length: 0.1, diameter: 90 mm, role: crank}
- gear: {name: mesh, teeth: [20, 40], inertia: [0.1, 0.6], application_factor: 1.35}
- propeller: {inertia: 6, pitch: fixed}
rules: [RULE]
"""
OVER_SPEED = {  # rule: share of the rated speed to which it is to be judged
    "iacs-m68": 1.05,
    "lr": 1.05,
    "ccs": 1.05,
    "kr": 1.2,
    "gear-hammer": 1.0,
    "coupling-maker": 1.0,
    "mil-std-167": 1.0,
    "engine-maker: {crank_stress: 90 MPa}": 1.0,
    "nvh: {at: line, acceleration: 9e9}": 1.0,
}
OF_NO_RANGE = ("minimum diameter", "T_KN", "major critical speed")


SOFT = "cases: {soft: {scale: {rubber.stiffness: 90 %}}}\n"  # societies demand another stiffness


@cache
def solved(rule, first=240, last=1500, load="constant", more=""):
    scene = (
        SCENE if "engine-maker" in rule else SCENE.replace(", role: crank", "")
    )  # which demands a misfire
    if rule in ("lr", "ccs", "kr"):
        more = SOFT
    text = (
        scene.replace("FIRST", str(first))
        .replace("LAST", str(last))
        .replace("LOAD", load)
        .replace("RULE", rule)
    )
    return torsion.run(torsion.parse(text + more))


@pytest.mark.parametrize(("rule", "scope"), OVER_SPEED.items())
def test_a_rule_over_speeds_that_end_below_the_rated_one_does_not_pass(rule, scope) -> None:
    found = solved(rule, last=800)
    lines = [one for one in found.need(Checks).lines if one.clause == "speeds"]
    assert {one.verdict for one in lines} == {"not judged"}
    assert len(lines) == len({one.where for one in lines})
    for one in lines:
        assert one.what.endswith(" above the computed speeds")
        assert one.note.count("judged up to 800 rpm only") == 1
        reach = one.reach.first / RPM, one.reach.last / RPM, one.reach.demanded / RPM
        assert reach == pytest.approx((240, 800, 1200 * scope), rel=1e-12)
    (sign, words), kind = headline(found)
    assert (sign, words.startswith(f"NOT JUDGED: {lines[0].what}, "), kind) == ("?", True, "note")
    assert found.exit_status == 1
    by_agreement = {"restricted"} if rule == "kr" else set()  # driven by a motor
    assert {one["verdict"] for one in results(found)["checks"]} - by_agreement <= {
        "not judged",
        "pass",
    }
    words = dict(verdict.box(found).lines)
    until = f"{1200 * scope:.6g}"
    assert f"Not checked: 800 to {until} rpm, required by " in words["Restrictions"]


@pytest.mark.parametrize(("rule", "scope"), OVER_SPEED.items())
def test_a_rule_judged_at_the_rated_speed_passes_and_is_judged_up_to_what_it_demands_above(
    rule, scope
) -> None:
    found = solved(rule, last=1200)
    above = {"restricted"} if scope > 1.05 else set()
    assert {one.verdict for one in found.need(Checks).lines} == {"pass"} | above
    assert found.exit_status == 0
    whole = solved(rule, last=round(1200 * scope))
    assert all(one.reach is None for one in whole.need(Checks).lines)
    assert check_words.unreached(whole) == ""


def test_speeds_that_begin_above_the_rated_one_do_not_pass() -> None:
    found = solved("iacs-m68", first=1300, last=1500)
    word = "NOT JUDGED: Torsional stress amplitude below the computed speeds, line (iacs-m68)"
    assert headline(found) == (("?", word), "note")
    assert found.exit_status == 1


def test_a_rule_that_fails_below_the_rated_speed_fails() -> None:
    found = solved("gear-hammer: {limit: 1e-6}", last=800)
    assert [one.verdict for one in found.need(Checks).lines] == ["fail", "not judged", "pass"]
    assert headline(found)[0][1].startswith("FAIL: ")


def test_speeds_of_continuous_use_below_the_rated_one_are_stated_beside_the_pass() -> None:
    found = solved("engine-maker: {crank_stress: 90 MPa, continuous: {from: 500 rpm, to: 800 rpm}}")
    (line,) = found.need(Checks).lines
    assert (line.verdict, line.reach.last / RPM) == ("restricted", pytest.approx(800))
    assert headline(found)[0][1].startswith("PASS with restrictions: judged up to 800 rpm only")


def test_a_case_of_fewer_speeds_passes_up_to_these_alone() -> None:
    cases = "cases: {slow: {speeds: {from: 400 rpm, to: 700 rpm}}}\n"
    found = solved("coupling-maker", more=cases)
    assert headline(found.cases["slow"])[0][1].startswith(
        "PASS with restrictions: judged up to 700 rpm"
    )
    assert found.exit_status == 0
    short = solved("coupling-maker", last=800, more=cases)
    assert short.exit_status == 1


def test_margins_of_frequencies_over_part_of_the_speeds_are_no_pass() -> None:
    def verdicts(last):
        return [
            one.verdict
            for one in solved("api-617: {line_frequency: none}", last=last).need(Checks).lines
        ]

    assert "not judged" in verdicts(1100)
    assert "not judged" not in verdicts(1200)


def test_what_fails_stays_so() -> None:
    study = solved("iacs-m68", last=800).study
    one = Check("r", "c", "w", "x", 2.0, 1.0, "N m", "fail", "maker")
    assert [check.verdict for check in with_reach(one, study)] == ["fail", "not judged"]


@pytest.mark.parametrize(
    "load", ["[[0 rpm, 1 N*m], [1500 rpm, 1 N*m]]", "[[0 rpm, 0 N*m], [1500 rpm, 0 N*m]]"]
)
def test_a_smaller_load_takes_no_smaller_shaft(load) -> None:
    def least(law):
        lines = solved("iacs-m68", load=law).need(Checks).lines
        return next(one.limit for one in lines if one.clause == "minimum diameter")

    assert least(load) == pytest.approx(least("constant"), rel=1e-12)
    assert least("[[0 rpm, 3000 N*m], [1500 rpm, 3000 N*m]]") == pytest.approx(
        least("constant") * (3000 / (50e3 / (1200 * RPM))) ** (1 / 3), rel=1e-12
    )


@pytest.mark.parametrize("rule", ["iacs-m68", "gear-hammer", "coupling-maker"])
def test_excitations_of_nothing_are_no_pass(rule) -> None:
    text = (
        SCENE.replace("FIRST", "400")
        .replace("LAST", "1500")
        .replace("LOAD", "constant")
        .replace("RULE", rule)
    )
    with pytest.raises(torsion.InputError, match="every excitation of the train is 0"):
        torsion.parse(text.replace("torque: 4 N*m", "torque: 0 N*m"))
