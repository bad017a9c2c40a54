"""Verdicts of `iacs-m68` on a shaft whose stress over speed is made by hand."""

import math
import re

import numpy as np
import pytest

from torsion.model.component import STEEL, Material
from torsion.rules.class_rules import m68
from torsion.rules.class_rules.m68_shafts import least_diameter, tau_c, tau_t
from torsion.rules.class_rules.shaft_limits import barred_range, limits_of

RPM = math.pi / 30.0
RATED = 1000.0
BLADES = [{"blade_order": 1, "torque": 10.0}]
SCREW = (
    "propeller",
    {"name": "screw", "inertia": 5.0, "pitch": "fixed", "blades": 4, "excitation": BLADES},
)
W_P = math.pi / 16 * 0.1**3  # m3, of a solid shaft of 100 mm


def line(role="intermediate", **shaft):
    body = {"name": "line", "length": 1.0, "diameter": 0.1, "role": role, "segments": 2, **shaft}
    return [("motor", {"inertia": 3.0}), ("shaft", body), SCREW]


def stress(values):
    """Torque amplitude that gives these stresses, N/mm2, in the solid shaft of 100 mm."""
    return np.asarray(values, dtype=float) * 1e6 * W_P


def limit(rpm, c_k=1.0):
    return tau_c(600, 100, c_k, np.asarray(rpm) / RATED)


def clauses(checks, clause):
    return [check for check in checks if check.clause == clause and not math.isnan(check.limit)]


@pytest.fixture
def judged(study, evidence):
    """Checks of an intermediate shaft whose stress is a share of tau_C at 96 speeds from 100 to 1050 rpm."""

    def run(share, requested=m68.M68Settings()):  # noqa: B008
        rpm = np.linspace(100, 1050, 96)
        return m68.M68(requested).check(
            evidence(study(line()), rpm, half={"line": stress(limit(rpm) * share)})
        )

    return run


def test_stress_below_the_limit_passes_at_the_greatest_share_of_it(study, evidence) -> None:
    rpm = np.array([100.0, 500.0, 900.0, 1050.0])
    scene = study(line())
    found = m68.M68(m68.M68Settings()).check(
        evidence(scene, rpm, half={"line": stress(limit(rpm) * [0.3, 0.2, 0.9, 0.1])})
    )
    (check,) = clauses(found, "tau_C")
    assert check.verdict == "pass"
    assert check.value == pytest.approx(0.9 * check.limit, rel=1e-12)
    assert check.limit == pytest.approx(float(limit(900.0)), rel=1e-12)
    assert check.speed == pytest.approx(900 * RPM, rel=1e-12)
    assert check.unit == "N/mm2"
    assert "4 × screw" in check.note
    assert check.order == 4
    assert not clauses(found, "tau_T")


def test_stress_above_the_limit_fails_from_0_8_of_the_rated_speed(study, evidence) -> None:
    rpm = np.array([100.0, 700.0, 800.0, 1050.0])
    torque = stress(limit(rpm) * [0.3, 0.2, 1.001, 0.1])
    found = m68.M68(m68.M68Settings()).check(evidence(study(line()), rpm, half={"line": torque}))
    (check,) = clauses(found, "tau_C")
    assert (check.verdict, check.speed) == ("fail", pytest.approx(800 * RPM, rel=1e-12))
    assert not clauses(found, "tau_T")


def test_resonance_below_0_8_is_barred_and_passes_both_limits(study, evidence) -> None:
    rpm = np.linspace(100, 1050, 96)
    share = 0.2 + 1.2 * np.exp(-(((rpm - 500) / 15) ** 2))
    scene = study(line())
    found = m68.M68(m68.M68Settings()).check(
        evidence(scene, rpm, half={"line": stress(limit(rpm) * share)})
    )
    (continuous,), (passing,) = clauses(found, "tau_C"), clauses(found, "tau_T")
    lower, upper = barred_range(500.0, RATED)
    (barred,) = passing.barred
    assert [barred.lower / RPM, barred.upper / RPM] == pytest.approx([lower, upper], rel=1e-12)
    assert barred.critical == pytest.approx(500 * RPM, rel=1e-12)
    assert barred.shaft == "line"
    assert (continuous.verdict, passing.verdict) == ("pass", "restricted")
    assert passing.limit == pytest.approx(float(tau_t(600, 100, 1, 0.5)), rel=1e-12)
    assert passing.value == pytest.approx(1.4 * float(limit(500.0)), rel=1e-12)
    assert "to be passed rapidly" in passing.note
    outside = ~((rpm >= lower) & (rpm <= upper))
    assert continuous.value / continuous.limit == pytest.approx(np.max(share[outside]), rel=1e-12)


def test_stress_above_tau_t_fails_in_the_barred_range(judged) -> None:
    share = np.full(96, 0.3)
    share[40] = 1.71
    found = judged(share)
    assert clauses(found, "tau_T")[0].verdict == "fail"
    assert clauses(found, "tau_C")[0].verdict == "pass"


@pytest.mark.parametrize("feature", ["taper keyway", "cylinder keyway", "propeller keyed"])
def test_keyway_fails_with_a_barred_range_and_not_without(study, evidence, feature) -> None:
    rpm = np.linspace(100, 1050, 96)
    c_k = {"taper keyway": 0.6, "cylinder keyway": 0.45, "propeller keyed": 0.55}[feature]
    share = np.full(96, 0.3)
    scene = study(line(features=[feature]))
    quiet = m68.M68(m68.M68Settings()).check(
        evidence(scene, rpm, half={"line": stress(limit(rpm, c_k) * share)})
    )
    assert {check.verdict for check in quiet} == {"pass"}
    share[40] = 1.1
    loud = m68.M68(m68.M68Settings()).check(
        evidence(scene, rpm, half={"line": stress(limit(rpm, c_k) * share)})
    )
    (passing,) = clauses(loud, "tau_T")
    assert passing.verdict == "fail"
    assert "keyway" in passing.note


@pytest.mark.parametrize("peak", [68, 72, 85])  # 780, 820, 950 rpm
def test_no_range_is_barred_that_reaches_0_8(judged, peak) -> None:
    share = np.full(96, 0.3)
    share[peak - 4 : peak + 5] += 0.2 * (5 - np.abs(np.arange(-4, 5)))
    found = judged(share)
    assert not clauses(found, "tau_T")
    (check,) = clauses(found, "tau_C")
    assert (check.verdict, check.speed) == ("fail", pytest.approx((100 + 10 * peak) * RPM))
    assert "no barred range is permitted there (lambda >= 0.8): detune" in check.note
    lower, upper = barred_range(100.0 + 10 * peak, RATED)
    stated = re.search(r"would run from (\S+) rpm to (\S+) rpm", check.note)
    assert [float(end) for end in stated.groups()] == pytest.approx([lower, upper], rel=1e-4)
    assert all(one.barred == () for one in found)


def test_range_below_0_8_is_barred_beside_one_that_is_refused(judged) -> None:
    share = np.full(96, 0.3)
    share[[40, 72]] = 1.1, 1.2  # 500, 820 rpm
    found = judged(share)
    (continuous,), (passing,) = clauses(found, "tau_C"), clauses(found, "tau_T")
    assert (continuous.verdict, passing.verdict) == ("fail", "restricted")
    assert [one.critical / RPM for one in passing.barred] == pytest.approx([500])
    assert continuous.speed == pytest.approx(820 * RPM)


@pytest.mark.parametrize(("status", "word"), [(1, "near-singular"), (2, "singular")])
@pytest.mark.parametrize("at", [40, 85])
def test_response_that_is_not_ok_fails_with_its_word(study, evidence, status, word, at) -> None:
    rpm = np.linspace(100, 1050, 96)
    flags = np.zeros(96)
    flags[at] = status
    torque = stress(limit(rpm) * 0.1)
    torque[at] = math.nan if status == 2 else torque[at]
    found = m68.M68(m68.M68Settings()).check(
        evidence(study(line()), rpm, half={"line": torque}, status=flags)
    )
    failed = [check for check in found if check.verdict == "fail"]
    assert failed
    assert all(f"is {word} at" in check.note for check in failed)
    assert all(math.isinf(check.value) for check in failed)


def test_value_that_is_no_number_never_passes(judged) -> None:
    share = np.full(96, 0.1)
    share[85] = math.nan
    (check,) = clauses(judged(share), "tau_C")
    assert (check.verdict, math.isnan(check.value)) == ("not judged", True)
    assert "no value at 950 rpm" in check.note


def test_speeds_above_1_05_are_a_restriction(study, evidence) -> None:
    rpm = np.array([500.0, 1050.0, 1100.0, 1200.0])
    found = m68.M68(m68.M68Settings()).check(
        evidence(study(line()), rpm, half={"line": stress([1, 2, 400, 300])})
    )
    (beyond,) = [check for check in found if math.isnan(check.limit)]
    assert beyond.value == pytest.approx(400, rel=1e-12)
    assert beyond.speed == pytest.approx(1100 * RPM, rel=1e-12)
    assert math.isnan(beyond.limit)
    assert clauses(found, "tau_C")[0].verdict == "pass"


@pytest.mark.parametrize(
    ("role", "features", "c_k", "words"),
    [
        ("intermediate", [], 1.0, "integral flange assumed"),
        ("thrust", [], 0.85, "thrust collar assumed"),
        ("propeller", [], 0.55, "mounting not given"),
        ("intermediate", ["flange", "radial hole"], 0.5, "radial hole"),
        ("propeller", ["tube shaft"], 0.8, "tube shaft"),
    ],
)
def test_smallest_factor_of_the_features_governs(
    study, evidence, role, features, c_k, words
) -> None:
    rpm = np.array([500.0, 1000.0])
    scene = study(line(role, features=features))
    (check,) = clauses(
        m68.M68(m68.M68Settings()).check(evidence(scene, rpm, half={"line": stress([1, 1])})),
        "tau_C",
    )
    assert check.limit == pytest.approx(float(tau_c(600, 100, c_k, 1.0)), rel=1e-12)
    assert words in check.note


def test_dimensions_of_a_slot_replace_its_factor(study, evidence) -> None:
    rpm = np.array([500.0, 1000.0])
    scene = study(line(features=["slot"], bore=0.05))
    requested = m68.M68Settings.model_validate(
        {"slots": {"line": {"length": "70 mm", "width": "20 mm"}}}
    )
    seen = evidence(scene, rpm, half={"line": stress([1, 1])})
    (check,) = clauses(m68.M68(requested).check(seen), "tau_C")
    assert check.limit / clauses(m68.M68(m68.M68Settings()).check(seen), "tau_C")[
        0
    ].limit == pytest.approx(0.39564 / 0.3, rel=2e-5)
    assert (check.standing, check.verdict) == ("to be verified", "restricted")
    assert clauses(m68.M68(m68.M68Settings()).check(seen), "tau_C")[0].standing == "rule text"
    loud = evidence(scene, rpm, half={"line": stress([1, 100])})
    verdicts = [
        clauses(m68.M68(one).check(loud), "tau_C")[0].verdict
        for one in (requested, m68.M68Settings())
    ]
    assert verdicts == ["not kept", "fail"]


def test_limit_of_a_steel_whose_strength_is_not_stated_is_to_be_verified(study, evidence) -> None:
    rpm = np.array([500.0, 1000.0])
    plain = {"plain": STEEL}
    scene = study(line(material="plain"), materials=plain)
    for share, verdict in ((0.99, "pass"), (1.01, "not kept"), (math.nan, "not judged")):
        torque = stress([0.0, share * tau_c(400, 100, 1.0, 1.0)])
        (check,) = clauses(
            m68.M68(m68.M68Settings()).check(evidence(scene, rpm, half={"line": torque})), "tau_C"
        )
        assert (check.standing, check.verdict) == ("to be verified", verdict)


def test_alloy_steel_may_be_used_up_to_800(study, evidence) -> None:
    rpm = np.array([500.0, 1000.0])
    strong = {"strong": Material(shear_modulus=79e9, density=7850.0, tensile_strength=900e6)}
    seen = evidence(
        study(line(material="strong"), materials=strong), rpm, half={"line": stress([1, 1])}
    )
    carbon, alloy = (
        clauses(m68.M68(m68.M68Settings(alloy=names)).check(seen), "tau_C")[0]
        for names in ((), ("line",))
    )
    assert alloy.limit / carbon.limit == pytest.approx(960 / 760, rel=1e-12)
    assert "600 N/mm2 (of 900)" in carbon.note


@pytest.mark.parametrize(
    "features", [["tube shaft"], ["tube shaft", "flange"], ["flange", "tube shaft"]]
)
def test_alloy_steel_of_a_tube_shaft_may_be_used_up_to_600_whatever_its_role(
    study, evidence, features
) -> None:
    """950 N/mm2, 300 mm, C_K 0.8, C_D 0.64722, lambda 1.05: 30.168 N/mm2, as of a propeller shaft."""
    rpm = np.array([1000.0, 1050.0])
    strong = {"strong": Material(shear_modulus=79e9, density=7850.0, tensile_strength=950e6)}
    requested = m68.M68Settings(alloy=("line",), drive="electric")
    found = {}
    for role in ("intermediate", "propeller"):
        scene = study(
            line(role, material="strong", features=features, diameter=0.3), materials=strong
        )
        seen = evidence(scene, rpm, half={"line": stress([0, 27])}, mean={"line": [1e5, 1e5]})
        found[role] = m68.M68(requested).check(seen)
    (check,) = clauses(found["intermediate"], "tau_C")
    assert check.limit == pytest.approx(
        760 / 18 * 0.8 * (0.35 + 0.93 * 300**-0.2) * 1.38, rel=1e-12
    )
    assert check.limit == pytest.approx(30.168, abs=5e-4)
    assert "600 N/mm2 (of 950)" in check.note
    tube, propeller = (clauses(found[role], "minimum diameter")[0].limit for role in found)
    load = 1e5 * RPM / 1e3  # kW per rpm
    assert tube == pytest.approx(100 * 1.15 * (load * 560 / 760) ** (1 / 3), rel=1e-12)
    assert tube == propeller


def test_cone_takes_the_smaller_end_of_each_piece_and_the_greatest_diameter(
    study, evidence
) -> None:
    rpm = np.array([500.0, 1000.0])
    scene = study(line(diameter=[0.1, 0.12]))
    (check,) = clauses(
        m68.M68(m68.M68Settings()).check(evidence(scene, rpm, half={"line": stress([7, 7])})),
        "tau_C",
    )
    assert check.value == pytest.approx(7, rel=1e-12)
    assert check.limit == pytest.approx(float(tau_c(600, 120, 1, 1.0)), rel=1e-12)
    assert "conical" in check.note


def test_stress_of_a_cone_follows_the_torque_of_each_piece(study, evidence) -> None:
    rpm = np.array([500.0, 1000.0])
    half = {"line [1]": stress([1, 1]), "line [2]": stress([5, 5])}
    (check,) = clauses(
        m68.M68(m68.M68Settings()).check(
            evidence(study(line(diameter=[0.1, 0.12])), rpm, half=half)
        ),
        "tau_C",
    )
    assert check.value == pytest.approx(5 / 1.1**3, rel=1e-12)


def test_hollow_shaft_has_its_own_section_modulus(study, evidence) -> None:
    rpm = np.array([500.0, 1000.0])
    seen = evidence(study(line(bore=0.08)), rpm, half={"line": stress([7, 7])})
    (check,) = clauses(m68.M68(m68.M68Settings()).check(seen), "tau_C")
    assert check.value == pytest.approx(7 / (1 - 0.8**4), rel=1e-12)


def test_least_diameter_follows_the_rated_mean_torque_and_is_to_be_verified(
    study, evidence
) -> None:
    rpm = np.array([500.0, 900.0, 1100.0])
    torque = 100e3 / (RATED * RPM)
    seen = evidence(study(line()), rpm, half={}, mean={"line": torque * (rpm / RATED) ** 2})
    (check,) = clauses(m68.M68(m68.M68Settings()).check(seen), "minimum diameter")
    assert check.limit == pytest.approx(least_diameter(100 / RATED, 600, 100, 1), rel=1e-12)
    assert (check.value, check.unit, check.at_least) == (pytest.approx(100), "mm", True)
    assert (check.verdict, check.standing, check.fails) == ("pass", "to be verified", False)
    (smooth,) = clauses(m68.M68(m68.M68Settings(drive="electric")).check(seen), "minimum diameter")
    assert smooth.limit == pytest.approx(0.95 * check.limit, rel=1e-12)
    heavy = evidence(study(line()), rpm, half={}, mean={"line": [1e6, 1e6, 1e6]})
    (thin,) = clauses(m68.M68(m68.M68Settings()).check(heavy), "minimum diameter")
    assert (thin.verdict, thin.standing, thin.fails) == ("not kept", "to be verified", True)


@pytest.mark.parametrize(
    ("outer", "bore", "worst"),
    [
        ([0.1, 0.2], [0.06, 0.06], (100.0, 0.6)),
        ([0.2, 0.1], [0.06, 0.06], (100.0, 0.6)),
        ([0.1, 0.1], [0.08, 0.02], (100.0, 0.8)),
        ([0.1, 0.1], [0.02, 0.08], (100.0, 0.8)),
    ],
)
def test_the_end_that_lacks_most_of_its_diameter_is_judged_with_its_bore(
    study, evidence, outer, bore, worst
) -> None:
    rpm = np.array([500.0, 900.0, 1100.0])
    torque = 100e3 / (RATED * RPM)
    seen = evidence(
        study(line(diameter=outer, bore=bore)),
        rpm,
        half={},
        mean={"line": torque * (rpm / RATED) ** 2},
    )
    (check,) = clauses(m68.M68(m68.M68Settings()).check(seen), "minimum diameter")
    diameter, share = worst
    assert check.value == pytest.approx(diameter)
    assert check.limit == pytest.approx(least_diameter(100 / RATED, 600, 100, 1, share), rel=1e-12)


def test_geared_shaft_counts_the_rated_speed_of_its_own(study, evidence) -> None:
    parts = [("motor", {"inertia": 3.0}), ("gear", {"ratio": 2}), *line()[1:]]
    rpm = np.array([500.0, 1000.0])
    torque = 2 * 100e3 / (RATED * RPM)
    found = m68.M68(m68.M68Settings()).check(
        evidence(study(parts), rpm, half={"line": stress([1, 1])}, mean={"line": [0.0, torque]})
    )
    assert clauses(found, "tau_C")[0].limit == pytest.approx(float(limit(1000.0)), rel=1e-12)
    assert clauses(found, "minimum diameter")[0].limit == pytest.approx(
        least_diameter(100 / 500, 600, 100, 1), rel=1e-12
    )


def test_limits_over_speed_are_those_of_the_formulas(study, evidence) -> None:
    rpm = np.array([500.0, 900.0, 1100.0])
    scene = study(line("thrust"), [("iacs-m68", m68.M68Settings())])
    seen = evidence(scene, rpm, half={"line": stress([3, 4, 5])})
    rule, shaft = m68.judging(seen, "line")
    assert rule.name == "iacs-m68"
    speed, continuous, passing, tau = limits_of(seen, shaft)
    assert speed == pytest.approx(rpm * RPM, rel=1e-15)
    assert tau == pytest.approx([3, 4, 5], rel=1e-12)
    np.testing.assert_allclose(continuous, tau_c(600, 100, 0.85, rpm / RATED), rtol=1e-14)
    np.testing.assert_allclose(passing, tau_t(600, 100, 0.85, rpm / RATED), rtol=1e-14)
    with pytest.raises(KeyError):
        m68.judging(seen, "another")


def test_limits_use_the_settings_of_the_study(study, evidence) -> None:
    strong = {"steel": Material(shear_modulus=79e9, density=7850.0, tensile_strength=900e6)}
    scene = study(line(), [("iacs-m68", m68.M68Settings(alloy=("line",)))], materials=strong)
    seen = evidence(scene, np.array([500.0]), half={"line": stress([3])})
    assert limits_of(seen, m68.judging(seen, "line")[1]).tau_c == pytest.approx(
        tau_c(800, 100, 1, [0.5]), rel=1e-14
    )


def test_shaft_without_a_role_is_left_out_and_said_so(study, evidence) -> None:
    parts = [*line()[:2], ("shaft", {"name": "stub", "length": 0.1, "diameter": 0.1}), SCREW]
    scene = study(parts)
    found = m68.M68(m68.M68Settings()).check(
        evidence(scene, np.array([500.0]), half={"stub": stress([9e9])})
    )
    assert {check.where for check in found} == {"line"}
    assert ("iacs-m68 for stub", "the shaft has no `role`") in m68.M68(m68.M68Settings()).left_out(
        scene
    )
