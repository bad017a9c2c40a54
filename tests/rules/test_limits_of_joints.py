"""Rule `universal-joints`: both sides of every limit, whose limit it is, and the words beside it."""

import math

import pytest

from torsion.analyses.joints.joint_analysis import joints
from torsion.analyses.lateral.shaft_bending import lateral
from torsion.assembly import assemble
from torsion.findings import Results
from torsion.model.component import Material
from torsion.rules.universal_joints import (
    PUBLISHED,
    JointRuleSettings,
    UniversalJoints,
    critical_speed,
    tubes,
)

RPM = math.pi / 30.0
STEEL = Material(shear_modulus=80e9, youngs_modulus=210e9, density=7850.0)
TUBE = ("shaft", {"name": "tube", "length": 1.5, "diameter": 0.12, "bore": 0.108})
CRITICAL = critical_speed(1.5, 0.12, 0.108, 210e9, 7850.0)  # rad/s
DISC = ("disc", {"inertia": 1.0})


def joint(angle, **more):
    return ("joint", {"angle": f"{angle} deg", **more})


@pytest.fixture
def judge(study):
    """Checks of parts by clause and place, at a rated speed in rad/s."""

    def checks(parts, speed, **settings):
        scene = study(
            parts, materials={"steel": STEEL}, speeds=None, rated={"speed": f"{speed!r} rad/s"}
        )
        found = {"system": assemble(scene.train), "joints": joints(scene.train, scene.operation)}
        bent = lateral(scene.train, scene.operation) if scene.has_supports else None
        lines = UniversalJoints(JointRuleSettings(**settings)).check(
            Results(scene, {**found, "lateral": bent})
        )
        return {(line.clause, line.where): line for line in lines}

    return checks


def test_limits_are_those_that_makers_publish() -> None:
    assert {key: limit for key, (limit, _) in PUBLISHED.items()} == {
        "unevenness": 0.0027,
        "torsional": 300.0,
        "inertial": 1000.0,
    }
    for key, (limit, _) in PUBLISHED.items():
        assert getattr(JointRuleSettings(), key) == limit
    assert (JointRuleSettings().critical_share, JointRuleSettings().speed_angle) == (0.65, None)
    assert JointRuleSettings(torsional=0.5, inertial=0.25).torsional == 0.5, (
        "a model in a laboratory"
    )


CROSSED = [joint(5), joint(5, phase="90 deg"), DISC]
PAIR = "joint-1, joint-2"
AT = {"U": PAIR, "torsional": PAIR, "inertial": "joint-1", "n b": "joint-2"}
KEYS = {"U": "unevenness", "torsional": "torsional", "inertial": "inertial", "n b": "speed_angle"}


@pytest.mark.parametrize("clause", AT)
def test_a_limit_may_be_used_up_and_not_exceeded(judge, clause) -> None:
    place = clause, AT[clause]
    value = judge(CROSSED, 70.0, speed_angle=1.0)[place].value
    for limit, verdict in ((value, "pass"), (value * (1 - 1e-12), "fail")):
        check = judge(CROSSED, 70.0, **{KEYS[clause]: limit})[place]
        assert (check.limit, check.value, check.verdict) == (limit, value, verdict)
        assert (check.standing, f"setting `{KEYS[clause]}`" in check.note) == ("setting", True)


def test_a_verdict_names_whose_limit_it_is_what_was_compared_and_the_resulting_angle(judge) -> None:
    """1/cos2 - cos2 of 5 degrees is tan b sin b = 1/cos b - cos b of the angle whose cosine is cos2."""
    found = judge(CROSSED, 70.0)
    whole, torsional, inertial = (
        found["U", PAIR],
        found["torsional", PAIR],
        found["inertial", "joint-1"],
    )
    bend = f"resulting angle of the cross joints {math.degrees(math.acos(math.cos(math.radians(5)) ** 2)):.4g} deg"
    assert whole.note == f"{bend}; limit after Elbe, 3 deg in round figures"
    assert torsional.note == "limit after Spicer"
    assert inertial.note == "limit after Spicer; driven from its first end"
    assert [one.standing for one in (whole, torsional, inertial)] == ["maker"] * 3
    assert [one.unit for one in (whole, torsional, inertial)] == ["1", "rad/s2", "rad/s2"]
    assert [one.speed for one in (whole, torsional, inertial)] == [None, 70.0, 70.0]
    assert {one.rule for one in found.values()} == {"universal-joints"}
    assert len(found) == 3, "nothing about speed times angle without a limit"
    angle = judge(CROSSED, 70.0, speed_angle=1e9)["n b", "joint-1"]
    assert (angle.value, angle.unit, angle.speed) == (pytest.approx(70 / RPM * 5), "deg/min", 70.0)
    assert (angle.note, angle.what) == ("setting `speed_angle`", "Speed times angle")


def test_acceleration_behind_the_second_of_three_joints_is_its_own(judge) -> None:
    """Joints of 4 degrees in line cancel in pairs: behind the second the shaft turns evenly."""
    found = judge([("gear", {"ratio": 2}), joint(4), joint(4), joint(4), DISC], 90.0)
    alone = judge([joint(4), DISC], 45.0)["torsional", "joint-1"].value
    assert found["inertial", "joint-1"].value == pytest.approx(alone, rel=1e-12)
    assert found["inertial", "joint-2"].value == pytest.approx(0.0, abs=1e-9 * alone)
    assert found["torsional", "joint-1, joint-2, joint-3"].value == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize(
    ("share", "verdict"),
    [(0.5, "pass"), (0.5 * (1 + 1e-12), "fail"), (0.25, "pass"), (0.75, "fail")],
)
def test_a_tube_may_run_at_its_share_of_the_critical_speed(judge, share, verdict) -> None:
    check = judge([joint(1), TUBE, joint(1)], share * CRITICAL, critical_share=0.5)[
        "n_crit", "tube"
    ]
    assert (check.verdict, check.standing, check.speed) == (verdict, "setting", share * CRITICAL)
    assert check.limit == pytest.approx(0.5 * CRITICAL / RPM, rel=1e-14)
    assert (check.value, check.unit) == (pytest.approx(share * CRITICAL / RPM, rel=1e-14), "rpm")


@pytest.mark.parametrize(
    ("share", "words"),
    [
        (0.4, "stays below it"),
        (0.5 * (1 - 1e-12), "stays below it"),
        (0.5, "passes it within the speeds"),
        (0.6, "passes it within the speeds"),
    ],
)
def test_the_secondary_couple_turns_at_twice_the_speed_of_the_tube(judge, share, words) -> None:
    check = judge([joint(1), TUBE, joint(1)], share * CRITICAL)["n_crit", "tube"]
    limit = (
        f"0.65 x critical bending speed {CRITICAL / RPM:.5g} rpm (simply supported at the joints)"
    )
    couple = f"the secondary couple turns at twice the speed, {2 * share * CRITICAL / RPM:.5g} rpm, and {words}"
    assert check.note == f"{limit}; {couple}"
    assert check.standing == "to be verified"


def test_what_is_not_judged_is_said(study) -> None:
    scene = study(
        [joint(1), ("shaft", {**TUBE[1], "diameter": [0.12, 0.13]}), joint(1)],
        materials={"steel": STEEL},
    )
    tube = ("universal-joints: bending of tube", "it is conical")
    angle = (
        "universal-joints: speed times angle",
        "`speed_angle` gives no limit; it depends on the joint's size",
    )
    assert tuple(UniversalJoints(JointRuleSettings()).left_out(scene)) == (tube, angle)
    assert tuple(UniversalJoints(JointRuleSettings(speed_angle=1.0)).left_out(scene)) == (tube,)
    plain = study([joint(1), TUBE, joint(1)], materials={"steel": STEEL})
    assert not list(UniversalJoints(JointRuleSettings(speed_angle=1.0)).left_out(plain))


@pytest.mark.parametrize(("density", "lacks"), [(0.0, True), (1.0, False), (7850.0, False)])
def test_a_tube_without_mass_has_no_critical_speed(study, density, lacks) -> None:
    light = Material(shear_modulus=80e9, youngs_modulus=210e9, density=density, unusual=True)
    (tube,) = tubes(study([joint(1), TUBE, joint(1)], materials={"steel": light}).train)
    assert ("no density" in tube.lacks) == lacks == math.isnan(tube.critical)
    if not lacks:
        assert tube.critical == pytest.approx(CRITICAL * math.sqrt(7850.0 / density), rel=1e-12)


def test_a_tube_between_rigid_couplings_is_one_tube(study) -> None:
    rigid = ("coupling", {"flexibility": 0.0})
    scene = study(
        [("gear", {"ratio": 4}), joint(1), rigid, TUBE, rigid, joint(1)], materials={"steel": STEEL}
    )
    (tube,) = tubes(scene.train)
    assert (tube.name, tube.lacks, float(tube.ratio)) == ("tube", "", 0.25)
    assert tube.critical == pytest.approx(CRITICAL, rel=1e-14)


def test_tube_that_bends_on_supports_names_what_it_lacks_alone(study) -> None:
    """Beside it another shaft has no support."""
    held = ("shaft", {**TUBE[1], "support": {"at": 0.75, "stiffness": 1e10}})
    soft = ("coupling", {"stiffness": 1e4})
    loose = ("shaft", {"name": "loose", "length": 0.5, "diameter": 0.1})
    (tube,) = tubes(
        study([loose, soft, joint(1), held, joint(1), soft, DISC], materials={"steel": STEEL}).train
    )
    assert (tube.lacks, tube.has_support) == ("", True)


def test_a_rule_about_joints_needs_them_and_a_speed(study) -> None:
    scene = study([joint(1), DISC])
    found = {"system": assemble(scene.train), "joints": joints(scene.train, scene.operation)}
    still = study([joint(1), DISC], speeds=None, rated=None)
    for evidence in (Results(scene, {"system": found["system"]}), Results(still, found)):
        with pytest.raises(ValueError, match="needs them and a speed"):
            UniversalJoints(JointRuleSettings()).check(evidence)
