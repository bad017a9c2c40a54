"""Limits of a coupling's maker over frequency, and of its heat while a cylinder does not fire."""

import math
from fractions import Fraction

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.response.harmonic_components import Line
from torsion.model.elastic_element import OF_POWER, OF_TORQUE, OverFrequency
from torsion.rules import not_judged
from torsion.rules.coupling_maker import CouplingMaker, CouplingSettings
from torsion.rules.verdict_line import Checks

RPM = math.pi / 30.0
PSI, STIFFNESS, ELASTIC, LOSS = (
    1.15,
    36000.0,
    500.0,
    79.8611,
)  # of 500 N m at 20 Hz: the published power loss, W


def line(**limits):
    body = {"name": "rubber", "stiffness": STIFFNESS, "psi": PSI, **limits}
    return [
        ("motor", {"inertia": 1.0, "ripple": [{"order": 4, "torque": 10.0}]}),
        ("coupling", body),
        ("disc", {"inertia": 2.0}),
    ]


def judged(study, evidence, rpm, torque, **limits):
    scene = study(line(**limits))
    return CouplingMaker(CouplingSettings()).check(evidence(scene, rpm, half={"rubber": torque}))


def test_a_torque_falls_with_the_root_of_the_frequency_above_that_of_the_maker() -> None:
    law = OverFrequency(((10.0, 15e3),), OF_TORQUE)
    assert law.at(np.array([1.0, 10.0, 22.5, 40.0])) == pytest.approx(
        [15e3, 15e3, 10e3, 7.5e3], rel=1e-15
    )


@pytest.mark.parametrize("power", [OF_TORQUE, OF_POWER])
def test_a_table_is_kept_at_its_rows_and_never_above_a_straight_line(power) -> None:
    rows = ((2.0, 9.0), (5.0, 6.0), (8.0, 7.0), (20.0, 3.0))
    law, at = OverFrequency(rows, power), np.linspace(2.0, 20.0, 301)
    assert law.at(np.array([row[0] for row in rows])) == pytest.approx(
        [row[1] for row in rows], rel=1e-14
    )
    assert (law.at(at) <= np.interp(at, *zip(*rows, strict=True)) * (1 + 1e-14)).all()
    assert law.at(np.array([0.5, 80.0])) == pytest.approx(
        [3.0, 3.0 / (2.0 if power == OF_TORQUE else 1.0)]
    )


def test_rows_of_one_heat_are_a_root_between_them() -> None:
    rows = tuple((f, 15e3 * math.sqrt(10.0 / f)) for f in (10.0, 17.0, 40.0))
    at = np.linspace(10.0, 90.0, 81)
    assert OverFrequency(rows, OF_TORQUE).at(at) == pytest.approx(
        15e3 * np.sqrt(10.0 / at), rel=1e-14
    )


def test_one_order_is_judged_at_its_own_frequency(study, evidence) -> None:
    """Order 4 of 300, 600 and 1200 rpm is 20, 40 and 80 Hz; 10 Hz of the maker: 1/sqrt(2), 1/2, 1/sqrt(8)."""
    limit = {"torque": 1000.0, "at": 10.0, "above": "sqrt"}
    found = judged(
        study, evidence, [300.0, 600.0, 1200.0], [700.0, 499.0, 300.0], vibratory_torque=limit
    )
    alone, together = found
    assert [one.clause for one in found] == ["T_KW(f)", "T_KW(f)"]
    assert (alone.value, alone.limit) == pytest.approx((499.0, 500.0), rel=1e-14)
    assert (together.value, together.limit) == pytest.approx((998.0, 1000.0), rel=1e-12)
    assert {one.verdict for one in found} == {"pass"}
    worse = judged(study, evidence, [300.0, 600.0], [700.0, 501.0], vibratory_torque=limit)
    assert {one.verdict for one in worse} == {"fail"}


def test_a_constant_limit_over_frequency_judges_as_the_limit_alone() -> None:
    text = """
name: k
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 61}, rated: {speed: 800 rpm, power: 50 kW}, load: constant}
train:
  - motor: {name: m, inertia: 2, ripple: [{order: 3, torque: 10 %}, {order: 1, torque: 9 %, phase: 1 rad}]}
  - coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, KEYS}
  - propeller: {name: wheel, inertia: 4}
rules: [coupling-maker]
"""

    def lines(keys):
        return torsion.run(torsion.parse(text.replace("KEYS", keys))).need(Checks).lines

    (plain,), (alone, together) = (
        lines("vibratory_torque: 900"),
        lines("vibratory_torque: [[0 Hz, 900], [99 Hz, 900]]"),
    )
    assert (together.value, together.limit) == pytest.approx((plain.value, 900.0), rel=1e-12)
    assert alone.value < together.value
    assert together.what == "Vibratory torque of all components, weighted by frequency"
    assert "each component times T_KW(0 Hz) / T_KW(f)" in together.note
    (heat,), (shares,) = lines("heat_limit: 90"), lines("heat_limit: [[0 Hz, 90], [99 Hz, 90]]")
    assert (shares.value, shares.limit, shares.clause) == pytest.approx(
        (heat.value, 90.0, "P_KW(f)")
    )


def test_a_heat_over_frequency_counts_every_order_by_its_own_share(study, evidence) -> None:
    """79.8611 W at 20 Hz, where the maker permits 100 W, against the least of the speeds: 50 W at 40 Hz."""
    torque, table = ELASTIC * (1 + 1j * PSI / (2 * math.pi)), [[20.0, 100.0], [40.0, 50.0]]
    (one,) = judged(study, evidence, [300.0, 600.0], [torque, 0.0], heat_limit=table)
    assert (one.value, one.limit) == pytest.approx((LOSS / 2.0, 50.0), rel=1e-6)


@for_all(
    ("limit", "words"),
    [
        ({"torque": 3.0, "at": 10.0}, "`at` needs `above`"),
        ([[1.0, 3.0]], "two rows or more"),
        ([[2.0, 3.0], [1.0, 3.0]], "two rows or more, rising"),
        ({"table": [[1.0, 3.0], [2.0, 3.0]], "at": 1.0}, "exclude"),
        ({}, "`torque` or `table` is missing"),
        ({"torque": 0.0, "at": 9.0, "above": "sqrt"}, "must be more than 0"),
        ([[1.0, 0.0], [2.0, 3.0]], "more than 0"),
    ],
)
def test_a_limit_that_says_too_little_is_refused(study, limit, words) -> None:
    with pytest.raises(ValueError, match=words):
        study(line(vibratory_torque=limit))


ENGINE = """
name: e
operation: {speeds: {from: 400 rpm, to: 900 rpm, steps: 41}, rated: {speed: 900 rpm, power: 100 kW}}
train:
  - engine:
      {name: six, cylinders: 6, strokes: 4, firing_order: [1, 5, 3, 6, 2, 4], inertia: 0.05, stiffness: 1.5e6,
       geometry: {bore: 105 mm, stroke: 137 mm, rod_length: 207 mm}, masses: {reciprocating: 2.5 kg},
       gas: {cycle: wiebe, compression_ratio: 15, charge: 2.4 bar, exhaust: 2 bar, imep: 16 bar, p_max: 150 bar,
             duration: 60 deg}MISFIRE}
  - coupling:
      {name: rubber, stiffness: 20 kN*m/rad, psi: 1, heat_limit: 30 W, heat_limit_misfire: {power: 120 kW, for: 30 min}}
  - disc: {name: end, inertia: 3}
rules: [coupling-maker]
"""


def test_the_heat_in_misfire_has_the_limit_of_the_misfire_and_its_time() -> None:
    fires, fails = (
        torsion.run(torsion.parse(ENGINE.replace("MISFIRE", text))) for text in ("", ", misfire: 3")
    )
    (plain, unjudged), (misfire, firing) = (one.need(Checks).lines for one in (fires, fails))
    assert (plain.clause, plain.limit) == ("P_KW", 30.0)
    assert (firing.clause, firing.verdict) == ("normal firing", "not judged")
    assert (unjudged.clause, unjudged.verdict) == ("P_KW misfire", "not judged")
    assert (misfire.clause, misfire.limit) == ("P_KW misfire", 120e3)
    assert misfire.what == "Heat in misfire"
    assert "for 30 min at most" in misfire.note
    assert (misfire.value > 30.0, misfire.verdict) == (True, "pass")
    left = [what for what, _ in not_judged(fails.study)]
    assert "coupling-maker: heat of rubber in misfire, cold and warm" in left
    text = ENGINE.replace("MISFIRE", ", misfire: 3").replace(
        ", heat_limit_misfire: {power: 120 kW, for: 30 min}", ""
    )
    line, _ = torsion.run(torsion.parse(text)).need(Checks).lines
    assert (line.clause, line.verdict) == ("P_KW", "fail")
    assert "a cylinder does not fire: judged by the limit of continuous operation" in line.note


def test_cases_of_a_misfire_state_which_of_them_is_judged() -> None:
    cases = "cases: {warm: {set: {rubber.stiffness: 14 kN*m/rad, six.misfire: 2}}}\n"
    found = torsion.run(torsion.parse(ENGINE.replace("MISFIRE", "") + cases))
    assert not [what for what, _ in found.plan.left_out if "misfire" in what]
    (line,) = found.cases["warm"].need(Checks).lines
    assert line.clause == "P_KW misfire"
    assert "case warm" in line.note


def test_a_misfire_with_cases_is_not_told_to_compute_the_cold_and_the_warm_coupling() -> None:
    cases = "cases: {warm: {set: {rubber.stiffness: 14 kN*m/rad}}}\n"
    study = torsion.parse(ENGINE.replace("MISFIRE", ", misfire: 3") + cases)
    alone = torsion.parse(ENGINE.replace("MISFIRE", ", misfire: 3"))
    states = {"alone": alone, "with cases": study, "a case": study.cases["warm"]}
    told = {
        name: [what for what, _ in not_judged(state) if "cold and warm" in what]
        for name, state in states.items()
    }
    note = "coupling-maker: heat of rubber in misfire, cold and warm"
    assert told == {"alone": [note], "with cases": [], "a case": []}


def test_a_damper_has_a_limit_of_its_heat_in_misfire_too(study, evidence) -> None:
    parts = [
        line()[0],
        (
            "damper",
            {
                "name": "oil",
                "housing": 0.1,
                "ring": 0.2,
                "damping": 20.0,
                "heat_limit": [[20.0, 100.0], [40.0, 50.0]],
            },
        ),
        *line()[1:],
    ]
    seen = evidence(study(parts), [300.0], half={"oil": 40.0}, line=Line(Fraction(4), None, ("m",)))
    (one,) = CouplingMaker(CouplingSettings()).check(seen)
    assert (one.clause, one.value, one.limit) == (
        "P_KW(f)",
        pytest.approx(40.0**2 / 40.0, rel=1e-12),
        100.0,
    )


def test_a_limit_in_misfire_is_no_less_than_that_of_continuous_operation(study) -> None:
    with pytest.raises(ValueError, match="200 W in misfire is below the 300 W"):
        study(line(heat_limit=300.0, heat_limit_misfire="200 W"))
