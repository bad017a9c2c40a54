"""What the rules need of the response over speed: every order, the bounds of their limits, and no peak between."""

import math
from fractions import Fraction

import numpy as np
import pytest

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.over_speed import ResponseSettings, response
from torsion.analyses.undamped_modes import Modes
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.output.chapters import chapters
from torsion.rules.verdict_line import Checks

RPM = math.pi / 30.0
FERRY = """
name: a ferry
materials: {S: {shear_modulus: 79.3 GPa, density: DENSITY, tensile_strength: 600 MPa}}
operation: {speeds: {from: 300 rpm, to: TOP rpm, steps: STEPS}, rated: {speed: 1000 rpm, power: 100 kW}}
train:
  - motor: {inertia: 2, ripple: [{order: 1, torque: 1 %}]}
  - shaft: {name: s, length: 1, diameter: 55 mm, role: intermediate, material: S}
  - propeller: {name: screw, inertia: 3, blades: BLADES, damping: 20, excitation: [{blade_order: 1, torque: SHARE}]}
"""
GEARED = """
name: a geared train
operation: {speeds: {from: 300 rpm, to: 1500 rpm, steps: 61}, rated: {speed: 1500 rpm, power: 30 kW}}
train:
  - motor: {name: m, inertia: 2, ripple: [{order: 1, torque: 5 %}, {order: 2, torque: 50}]}
  - coupling: {name: c, stiffness: 3e4, psi: 1, vibratory_torque: 60}
  - gear: {teeth: [20, 41]}
  - propeller: {name: load, inertia: 3, blades: 3, excitation: [{blade_order: 1, torque: 8 %}]}
"""


def scene(more: str = "", *, density=7850, top=1000, steps=71, blades=4, share="40 %") -> str:
    text = (
        FERRY.replace("DENSITY", str(density)).replace("TOP", str(top)).replace("STEPS", str(steps))
    )
    return text.replace("BLADES", str(blades)).replace("SHARE", share) + more


def solved(text: str) -> Findings:
    return torsion.run(torsion.parse(text, "scene.yaml"))


def verdicts(found: Findings) -> list[tuple[str, str, str, float]]:
    return [
        (check.where, check.clause, check.verdict, check.value)
        for check in found.need(Checks).lines
    ]


def check_of(found: Findings, clause: str):
    return next(
        check for check in found.need(Checks).lines if check.clause == clause and check.has_limit
    )


@pytest.mark.parametrize(
    ("whole", "orders"),
    [
        (scene("rules: [iacs-m68]\n"), "[1]"),
        (GEARED + "rules: [coupling-maker, gear-hammer]\n", "[60/41]"),
    ],
)
def test_rules_judge_all_orders_whatever_orders_are_named(whole, orders) -> None:
    part = solved(whole + f"analyses: {{modes: , response: {{orders: {orders}}}}}\n")
    assert verdicts(part) == verdicts(solved(whole))
    assert part.failed
    assert any("all orders" in line.size for line in part.plan.done)
    assert "judge them together" in str(chapters(part))


def test_orders_that_are_not_named_are_left_out_and_said_so() -> None:
    found = solved(scene("analyses: {response: {orders: [1]}}\n"))
    assert [line.order for line in found.need(Response).lines] == [1]
    assert [line.order for line in found.need(Response).left_out] == [4]
    assert ("order 4 of the response (screw)", "`orders` does not name it") in found.plan.left_out
    text = str(chapters(found))
    assert "orders requested" in text
    assert "all orders" not in text


def test_fixed_frequencies_are_told_beside_the_orders_named() -> None:
    steady_hum = "excitations: [{at: screw, frequency: 40 Hz, torque: 3}]\n"
    found = solved(scene(steady_hum + "analyses: {response: {orders: [4]}}\n"))
    assert [(line.order, line.frequency) for line in found.need(Response).lines] == [
        (4, None),
        (None, 40.0),
    ]


def test_order_that_nothing_excites_is_refused_where_it_stands() -> None:
    for rules in ("", "rules: [iacs-m68]\n"):
        with pytest.raises(InputError) as caught:
            torsion.parse(scene(rules + "analyses: {response: {orders: [1, 7]}}\n"), "scene.yaml")
        (fault,) = caught.value.faults
        assert fault.message == "no excitation has order 7"
        assert fault.hint == "there are 1, 4, per turn of the reference"
        assert "orders: [1, 7]" in str(caught.value)


def test_order_that_nothing_excites_is_refused_for_a_study_made_by_hand() -> None:
    study = torsion.parse(scene("analyses: {response: {orders: [4]}}\n"), "scene.yaml")
    study.analyses["response"] = ResponseSettings(orders=[Fraction(5, 2)])
    with pytest.raises(InputError, match="no excitation has order 5/2"):
        response(study, torsion.assemble(study.train))


RISING = {"density": 0, "top": 1100, "blades": 2, "share": "66 %"}


def test_bounds_of_the_limits_are_computed_however_few_speeds_are_asked() -> None:
    few = solved(scene("rules: [iacs-m68]\n", steps=5, **RISING))
    speeds = few.need(Response).speed / RPM
    for bound in (800, 900, 1000, 1050):
        assert np.min(np.abs(speeds / bound - 1)) < 1e-12
    assert few.need(Response).requested.sum() == 5
    many = solved(scene("rules: [iacs-m68]\n", steps=801, **RISING))
    one, other = check_of(few, "tau_C"), check_of(many, "tau_C")
    assert (one.speed / RPM, one.verdict) == (pytest.approx(1050), other.verdict)
    assert one.value == pytest.approx(other.value, rel=1e-12)


@pytest.mark.parametrize("blades", [3, 4])
def test_verdicts_do_not_depend_on_the_number_of_speeds(blades) -> None:
    few, many = (
        solved(scene("rules: [iacs-m68]\n", steps=steps, blades=blades, top=1060, share="20 %"))
        for steps in (2, 4001)
    )
    for one, other in zip(
        *(
            [check for check in found.need(Checks).lines if check.limit > 0]
            for found in (few, many)
        ),
        strict=True,
    ):
        assert (one.clause, one.verdict, one.value) == (
            other.clause,
            other.verdict,
            pytest.approx(other.value, 1e-3),
        )
    barred = [
        [
            edge
            for check in found.need(Checks).lines
            for one in check.barred
            for edge in (one.lower, one.upper)
        ]
        for found in (few, many)
    ]
    assert barred[0] == pytest.approx(barred[1], rel=1e-3)


def test_a_peak_of_a_table_between_two_speeds_is_judged() -> None:
    spike = "excitations: [{at: screw, order: 3, torque: [[0 rpm, 0], [901 rpm, 0], [901.1 rpm, 9e5], [901.2 rpm, 0], [2000 rpm, 0]]}]\n"  # noqa: E501
    found = check_of(solved(scene(spike + "rules: [iacs-m68]\n", steps=5)), "tau_C")
    assert (found.verdict, found.speed / RPM) == ("fail", pytest.approx(901.1))


def test_ends_of_continuous_use_are_computed() -> None:
    rule = "rules: [gear-hammer: {continuous: {from: 777 rpm, to: 1234.5 rpm}}]\n"
    speeds = solved(GEARED.replace("steps: 61", "steps: 3") + rule).need(Response).speed / RPM
    for bound in (777, 1234.5, 1500):
        assert np.min(np.abs(speeds / bound - 1)) < 1e-12


def test_speeds_of_a_study_without_rules_are_as_before() -> None:
    found = solved(scene(steps=5))
    alone = response(
        found.study, found.system, modes=found.need(Modes), damped=found.need(DampedModes)
    )
    assert np.array_equal(found.need(Response).speed, alone.speed)


def test_rated_torque_is_judged_though_the_speeds_end_below_it() -> None:
    found = solved(scene("rules: [iacs-m68]\n", top=700))
    assert check_of(found, "minimum diameter").speed == pytest.approx(1000 * RPM)
    assert not [what for what, _ in found.plan.left_out if "diameter" in what]
    (row,) = [one for one in found.need(Checks).lines if one.clause == "speeds"]
    assert (row.verdict, row.reach.demanded / RPM) == ("not judged", pytest.approx(1050.0))
    low = GEARED.replace("to: 1500 rpm", "to: 700 rpm") + "rules: [gear-hammer]\n"
    line = check_of(solved(low), "(K_A - 1) T_rated")
    assert line.limit == pytest.approx(0.35 * 30e3 / (1500 * RPM))
    assert "judged up to 700 rpm only" in line.note
