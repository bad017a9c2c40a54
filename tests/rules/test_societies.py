"""Verdicts of the societies' rule sets on stresses made by hand."""

import math

import numpy as np
import pytest
from tests.for_all import for_all

from torsion.model.component import Material
from torsion.rules import lacking, not_judged, rule, settings, verdicts
from torsion.rules.class_rules.m68_shafts import tau_c
from torsion.rules.demands import demanded_study

RPM = math.pi / 30.0
W_P = math.pi / 16 * 0.1**3  # m3, of a solid shaft of 100 mm
NAMES = ["kr", "lr", "dnv", "abs", "bv", "ccs", "nk", "rina"]
EXCITES = ("motor", {"name": "engine", "inertia": 3.0, "ripple": [{"order": 3, "torque": 10.0}]})


def shaft(name="line", role="intermediate", **more):
    return (
        "shaft",
        {"name": name, "length": 1.0, "diameter": 0.1, "role": role, "segments": 1, **more},
    )


def train(*links):
    parts = [EXCITES]
    for number, link in enumerate(links):
        parts += [link, ("disc", {"name": f"disc {number}", "inertia": 2.0})]
    return parts


def stress(values):
    return np.asarray(values, dtype=float) * 1e6 * W_P


def judged(study, evidence, name, parts, rpm, half, mean=None, **given):
    scene = study(parts, [(name, settings(name).model_validate(given))])
    assert lacking(scene) == []
    found = verdicts(evidence(scene, np.asarray(rpm, dtype=float), half=half, mean=mean))
    return {(check.where, check.clause): check for check in found}


@pytest.mark.parametrize("name", NAMES)
def test_a_line_shaft_has_the_limit_of_m68_and_the_standing_of_the_society(
    study, evidence, name
) -> None:
    limit = float(tau_c(600, 100, 1.0, 0.95))
    kept = (
        "restricted" if name == "kr" else "pass"
    )  # a motor drives, for which KR has no limits of its own
    for share, verdict in ((1 - 1e-9, kept), (1 + 1e-9, "fail" if name == "kr" else "not kept")):
        found = judged(
            study, evidence, name, train(shaft()), [950.0], {"line": stress([share * limit])}
        )
        check = found["line", "tau_1" if name in ("kr", "nk", "bv", "rina") else "tau_C"]
        assert check.verdict == verdict
        assert check.limit == pytest.approx(limit, rel=1e-13)
        assert check.rule == name
        assert check.basis.kind == ("text" if name == "kr" else "unconfirmed")
        assert rule(name).title in check.basis.edition


@for_all(
    ("name", "given", "ratio", "limit", "clause"),
    [
        ("kr", {"strokes": 4, "arrangement": "in-line"}, 1.0, 21.0, "tau_1"),
        ("kr", {"strokes": 4, "arrangement": "V60"}, 0.9, 25.56, "tau_1"),
        ("kr", {"strokes": 2, "arrangement": "in-line"}, 0.9, 21.51, "tau_1"),
        ("kr", {"strokes": 4, "arrangement": "other V"}, 1.0, 16.0, "tau_1"),
        ("kr", {}, 1.0, 16.0, "tau_1"),
        ("kr", {"strokes": 4}, 1.0, 16.0, "tau_1"),
        ("kr", {"strokes": 4, "arrangement": "V45"}, 1.05, 21 + 59.25 * math.sqrt(0.05), "tau_3"),
        ("kr", {"strokes": 4, "arrangement": "V45"}, 1.15, 53.1263968569, "tau_3"),
        (
            "kr",
            {"strokes": 4, "arrangement": "in-line", "duty": "generator set"},
            0.9,
            21.0,
            "tau_1",
        ),
        (
            "kr",
            {"strokes": 4, "arrangement": "in-line", "duty": "generator set"},
            1.1,
            21.0,
            "tau_1",
        ),
        ("kr", {"duty": "generator set"}, 0.95, 16.0, "tau_1"),
        ("kr", {"duty": "generator set"}, 0.89, 90.0, "tau_2"),
        ("nk", {"strokes": 4, "arrangement": "in-line"}, 1.0, 21.0, "tau_1"),
        ("ccs", {}, 1.0, 52 - 3.1 - 33.8 + 2.0, "tau_C"),
    ],
)
def test_a_crankshaft_fails_above_its_limit(
    study, evidence, name, given, ratio, limit, clause
) -> None:
    soft = {"m": Material(shear_modulus=79e9, density=7850.0, tensile_strength=440e6)}
    for share, kept in ((1 - 1e-9, True), (1 + 1e-9, False)):
        parts = train(shaft("crank", "crank", material="m"))
        scene = study(parts, [(name, settings(name).model_validate(given))], materials=soft)
        found = verdicts(evidence(scene, [1000.0 * ratio], half={"crank": stress([share * limit])}))
        (check,) = [check for check in found if check.where == "crank" and check.unit == "N/mm2"]
        assert (check.clause, check.limit) == (clause, pytest.approx(limit, rel=1e-11))
        assert check.verdict == ("pass" if kept else "fail" if name == "kr" else "not kept")


def test_a_generator_shaft_has_its_own_limits_by_the_smaller_factor(study, evidence) -> None:
    parts, half = train(shaft("tail", "generator")), {"tail": stress([10.0, 10.0])}
    found = judged(study, evidence, "kr", parts, [500.0, 1000.0], half)
    assert found["tail", "tau_1"].limit == 31.0  # no yield strength is stated: f_m 1
    assert found["tail", "tau_2"].limit == 118.0
    hard = {
        "m": Material(
            shear_modulus=79e9, density=7850.0, tensile_strength=590e6, yield_strength=260e6
        )
    }
    scene = study(
        train(shaft("tail", "generator", material="m")), [("kr", settings("kr")())], materials=hard
    )
    checks = verdicts(evidence(scene, [1000.0], half=half | {"tail": stress([10.0])}))
    assert [check.limit for check in checks] == [pytest.approx(31.0 * 260 / 225, rel=1e-13)]


def test_nothing_is_barred_for_a_generator_set(study, evidence) -> None:
    rpm = np.linspace(300, 1100, 81)
    tau = 5.0 + 90.0 * np.exp(-(((rpm - 600) / 20) ** 2))
    found = judged(
        study,
        evidence,
        "kr",
        train(shaft("crank", "crank")),
        rpm,
        {"crank": stress(tau)},
        duty="generator set",
    )
    assert {key for key, line in found.items() if line.unit} == {
        ("crank", "tau_1"),
        ("crank", "tau_2"),
    }
    assert found["crank", "tau_2"].verdict == "fail"
    assert found["crank", "tau_2"].limit == 90.0


def test_a_crankshaft_of_a_main_engine_may_be_barred_below_0_8(study, evidence) -> None:
    rpm = np.linspace(300, 1100, 161)
    tau = 5.0 + 45.0 * np.exp(-(((rpm - 500) / 20) ** 2))
    found = judged(
        study, evidence, "kr", train(shaft("crank", "crank")), rpm, {"crank": stress(tau)}
    )
    passing = found["crank", "tau_2"]
    (barred,) = passing.barred
    assert [barred.formula_lower / RPM, barred.formula_upper / RPM] == pytest.approx(
        [16 * 500 / 17.5, 17.5 * 500 / 16], rel=1e-12
    )
    assert (passing.verdict, passing.limit) == (
        "restricted",
        pytest.approx(2 * (45 - 29 * 0.25), rel=1e-13),
    )
    assert (
        found["crank", "tau_1"].verdict == "restricted"
    )  # from 300 rpm, and 600 N/mm2 above the 590 of the table


def test_a_resonance_at_the_rated_speed_is_not_barred_but_fails(study, evidence) -> None:
    rpm = np.linspace(300, 1100, 161)
    tau = 5.0 + 45.0 * np.exp(-(((rpm - 950) / 20) ** 2))
    found = judged(
        study, evidence, "kr", train(shaft("crank", "crank")), rpm, {"crank": stress(tau)}
    )
    assert found["crank", "tau_1"].verdict == "fail"
    assert "no barred range is permitted" in found["crank", "tau_1"].note


@pytest.mark.parametrize("name", ["lr", "dnv", "abs", "bv", "rina"])
def test_a_crankshaft_that_a_society_has_no_table_for_is_named(study, name) -> None:
    scene = study(train(shaft(), shaft("crank", "crank")), [(name, settings(name)())])
    reasons = dict(not_judged(scene))
    assert "crank" in reasons[f"{name}: shafts of another role"]
    assert lacking(scene) == []
    assert (
        "nothing to judge"
        in lacking(study(train(shaft("crank", "crank")), [(name, settings(name)())]))[0].message
    )


def test_the_tachometer_of_lr_is_2_percent_unless_the_file_gives_another(study) -> None:
    assert settings("lr")().tachometer == 0.02
    assert settings("lr").model_validate({"tachometer": "0 %"}).tachometer == 0.0
    assert settings("abs")().tachometer == 0.0


def test_gears_of_lr_carry_a_third_of_the_rated_torque(study, evidence) -> None:
    parts = [
        EXCITES,
        shaft(),
        ("gear", {"name": "box", "ratio": 2}),
        ("disc", {"name": "load", "inertia": 2.0}),
    ]
    for share, verdict in ((1 - 1e-9, "pass"), (1 + 1e-9, "not kept")):
        found = judged(
            study,
            evidence,
            "lr",
            parts,
            [500.0, 1000.0],
            {"box": [0.0, share * 300.0]},
            {"box": [225.0, 900.0]},
        )
        check = found["box", "gears"]
        assert (check.verdict, check.limit) == (verdict, pytest.approx(300.0, rel=1e-12))
    scene = study(parts, [("lr", settings("lr")())], rated={"speed": "1000 rpm"})
    (row,) = [
        row for row in rule("lr", settings("lr")()).demanded_rows(scene) if row.clause == "gears"
    ]
    assert (row.where, row.verdict) == ("box", "not judged")


def test_states_and_other_rules_are_named_where_they_are_not_judged(study) -> None:
    rubber = (
        "coupling",
        {"name": "rubber", "stiffness": 2e4, "psi": 1.0, "vibratory_torque": 50.0},
    )
    parts = [
        *train(shaft(), rubber, shaft("crank", "crank"))[:-1],
        ("gear", {"name": "box", "ratio": 2}),
        ("propeller", {"name": "screw", "inertia": 2.0, "blades": 4, "pitch": "controllable"}),
    ]
    for name in NAMES:
        scene = study(parts, [(name, settings(name)())])
        rows = {
            row.clause: row.verdict for row in rule(name, scene.rules[0][1]).demanded_rows(scene)
        }
        states = (
            "misfire",
            "zero pitch",
            "other stiffness",
            *(["major critical speed"] if name == "kr" else []),
        )
        assert rows == dict.fromkeys(states, "not judged")
    kr = dict(not_judged(study(parts, [("kr", settings("kr")())])))
    wanted = {"gears", "couplings"}
    assert {f"kr: {word}" for word in wanted} <= set(kr)
    others = [(name, settings(name)()) for name in ("kr", "gear-hammer", "coupling-maker")]
    kr = dict(not_judged(study(parts, others)))
    assert not {"kr: gears", "kr: couplings"} & set(kr)


def test_kr_wants_stresses_up_to_1_2_of_the_rated_speed(study) -> None:
    for last, end in (
        ("1199 rpm", 1200.0),
        ("1000 rpm", 1200.0),
        ("1200 rpm", None),
        ("999 rpm", None),
    ):
        scene = study(
            train(shaft()), [("kr", settings("kr")())], speeds={"from": "100 rpm", "to": last}
        )
        above = demanded_study(scene)
        found = None if above is None else above.operation.speeds.last / RPM
        assert found == (None if end is None else pytest.approx(end, rel=1e-12))


def test_speeds_that_all_lie_above_the_rated_one_are_all_that_the_rule_is_held_against(
    study,
) -> None:
    speeds = {"from": "1100 rpm", "to": "1150 rpm"}
    assert demanded_study(study(train(shaft()), [("kr", settings("kr")())], speeds=speeds)) is None


def test_speeds_above_the_rated_one_lie_as_close_as_those_of_the_operation(study) -> None:
    for steps, known in (
        (10, 3),
        (19, 5),
        (91, 21),
    ):  # of 100, 50 and 10 rpm, from 1000 to 1200 rpm
        speeds = {"from": "100 rpm", "to": "1000 rpm", "steps": steps}
        above = demanded_study(study(train(shaft()), [("kr", settings("kr")())], speeds=speeds))
        assert above.operation.speeds.steps == known


@pytest.mark.parametrize("duty", ["propulsion", "generator set"])
def test_major_critical_speeds_lie_outside_their_range(study, evidence, duty) -> None:
    """Two equal discs of 3 kg m2 on a massless crank: f = sqrt(2 k/J)/(2 pi); the order 3 of six cylinders."""
    light = {"m": Material(shear_modulus=79e9, density=0.0, tensile_strength=440e6)}
    parts = [EXCITES, shaft("crank", "crank", material="m"), ("disc", {"inertia": 3.0})]
    stiffness = 79e9 * math.pi / 32 * 0.1**4
    critical = math.sqrt(2 * stiffness / 3.0) / 3.0  # rad/s of the third order
    low = 0.8 if duty == "propulsion" else 0.9
    for ratio, verdict in (
        (low * 0.999, "pass"),
        (low * 1.001, "fail"),
        (1.099, "fail"),
        (1.101, "pass"),
    ):
        given = settings("kr").model_validate({"strokes": 4, "cylinders": 6, "duty": duty})
        rated = {"speed": critical / ratio, "power": 1e5}
        speeds = {"from": 1.0, "to": critical / ratio}
        operation = {
            "rated": {**rated, "speed": f"{rated['speed']} rad/s"},
            "speeds": {key: f"{value} rad/s" for key, value in speeds.items()},
        }
        scene = study(parts, [("kr", given)], materials=light, **operation)
        found = verdicts(evidence(scene, np.array([critical / ratio]) / RPM, half={"crank": [0.0]}))
        third = [
            check for check in found if check.clause == "major critical speed" and check.order == 3
        ]
        assert [check.verdict for check in third] == [verdict]
        assert third[0].value == pytest.approx(ratio, rel=1e-9)
        assert third[0].limit == (1.1 if ratio > 1 else low)
