"""Rule `universal-joints`: makers' limits of lines of joints, and the tubes between them."""

import math

import numpy as np
import pytest

from torsion.analyses.joints.joint_analysis import joints
from torsion.analyses.lateral.shaft_bending import lateral
from torsion.assembly import assemble
from torsion.findings import Results
from torsion.model.component import Material
from torsion.model.joint import Joint
from torsion.rules.universal_joints import JointRuleSettings, UniversalJoints, critical_speed, tubes

RPM = math.pi / 30.0
STEEL = Material(shear_modulus=80e9, youngs_modulus=210e9, density=7850.0)
TUBE = ("shaft", {"name": "tube", "length": 1.5, "diameter": 0.12, "bore": 0.108})


@pytest.fixture
def judge(study):
    """Checks of parts by clause and place."""

    def checks(parts, requested=None, **operation):
        scene = study(parts, materials={"steel": STEEL}, **operation)
        found = joints(scene.train, scene.operation)
        bent = lateral(scene.train, scene.operation) if scene.has_supports else None
        lines = UniversalJoints(requested or JointRuleSettings()).check(
            Results(scene, {"system": assemble(scene.train), "joints": found, "lateral": bent})
        )
        return {(line.clause, line.where): line for line in lines}

    return checks


def joint(angle, **more):
    return ("joint", {"angle": f"{angle} deg", **more})


@pytest.mark.parametrize(("angle", "verdict"), [(2.97, "pass"), (2.98, "fail"), (5, "fail")])
def test_one_joint_is_judged_by_tan_b_sin_b(judge, angle, verdict):
    line = judge([joint(angle)])["U", "joint-1"]
    bend = math.radians(angle)
    assert line.value == pytest.approx(math.tan(bend) * math.sin(bend), rel=1e-13)
    assert (line.limit, line.verdict) == (0.0027, verdict)


def test_double_cardan_in_line_passes_and_crossed_fails(judge):
    in_line, crossed = (judge([joint(5), joint(5, phase=phase)]) for phase in ("0 deg", "90 deg"))
    place = "joint-1, joint-2"
    for clause in ("U", "torsional"):
        assert in_line[clause, place].verdict == "pass"
        assert in_line[clause, place].value == pytest.approx(0.0, abs=1e-12)
    exact = math.cos(math.radians(5)) ** -2 - math.cos(math.radians(5)) ** 2
    assert crossed["U", place].value == pytest.approx(exact, rel=1e-12)
    assert crossed["U", place].verdict == "fail"


@pytest.mark.parametrize(
    ("angle", "value"), [(3, 9.87413904680), (5, 27.4509010319), (8, 70.4209476186)]
)
def test_accelerations_are_those_of_liu_2023_at_the_highest_speed(judge, angle, value):
    """Of the end of the range and the rated speed the higher one counts, whichever it is: 60 rad/s."""
    ends = "60 rad/s", "50 rad/s"
    last, rated = ends if angle != 5 else reversed(ends)
    speeds, rated = {"from": "10 rad/s", "to": last}, {"speed": rated}
    found = judge([joint(angle), joint(1)], speeds=speeds, rated=rated)
    assert found["inertial", "joint-1"].value == pytest.approx(value, rel=1e-11)
    assert judge([joint(angle)], speeds=speeds, rated=rated)[
        "torsional", "joint-1"
    ].value == pytest.approx(value, rel=1e-11)
    assert found["inertial", "joint-1"].speed == 60.0


def test_limits_of_acceleration_and_angle_are_the_settings(judge):
    requested = JointRuleSettings(
        unevenness=1.0, torsional=9.0, inertial="28 rad/s**2", speed_angle=1700.0
    )
    speeds = {"from": "10 rad/s", "to": "60 rad/s"}
    verdicts = {
        key: line.verdict
        for key, line in judge([joint(5), joint(3)], requested, speeds=speeds, rated=None).items()
    }
    assert verdicts == {
        ("U", "joint-1, joint-2"): "pass",
        ("torsional", "joint-1, joint-2"): "fail",
        ("inertial", "joint-1"): "pass",
        ("n b", "joint-1"): "fail",
        ("n b", "joint-2"): "fail",
    }


def test_speed_times_angle_is_at_the_joint_s_own_speed(judge):
    found = judge(
        [("gear", {"ratio": 4}), joint(7)],
        JointRuleSettings(speed_angle=2100.0),
        speeds=None,
        rated={"speed": "1200 rpm"},
    )
    line = found["n b", "joint-1"]
    assert line.value == pytest.approx(300.0 * 7.0, rel=1e-13)


def test_joints_behind_a_gear_accelerate_with_the_square_of_their_own_speed(judge):
    plain = judge([joint(5), joint(4)])
    geared = judge([("gear", {"ratio": 2}), joint(5), joint(4)])
    for clause, place in (("torsional", "joint-1, joint-2"), ("inertial", "joint-1")):
        assert geared[clause, place].value == pytest.approx(
            plain[clause, place].value / 4.0, rel=1e-13
        )


def test_shaft_between_joints_of_two_lines_is_judged_once(judge):
    branch = ("branch", {"train": (Joint(name="side", angle="3 deg"),)})
    found = judge([joint(5), ("disc", {"inertia": 1.0}), branch, joint(4), joint(3)])
    between = [place for clause, place in found if clause == "inertial"]
    assert sorted(between) == ["joint-1", "joint-3"]
    assert ("U", "joint-1, side") in found


def test_critical_bending_speed_of_a_published_tube():
    """120/108 mm, 1.5 m, E 210 GPa, 7850 kg/m3: 8744 per minute."""
    found = critical_speed(1.5, 0.12, 0.108, 210e9, 7850.0) / RPM
    assert found == pytest.approx(8744.0, abs=0.5)
    section = math.pi / 4 * (0.12**2 - 0.108**2), math.pi / 64 * (0.12**4 - 0.108**4)
    beam = (math.pi / 1.5) ** 2 * math.sqrt(210e9 * section[1] / (7850.0 * section[0]))
    assert found * RPM == pytest.approx(beam, rel=1e-13)


@pytest.mark.parametrize(("rpm", "verdict"), [(5680, "pass"), (5690, "not kept")])
def test_tube_runs_at_most_at_65_percent_of_its_critical_speed(judge, rpm, verdict):
    found = judge([joint(1), TUBE, joint(1)], speeds=None, rated={"speed": f"{rpm} rpm"})
    line = found["n_crit", "tube"]
    assert (line.verdict, line.value) == (verdict, pytest.approx(rpm, rel=1e-13))
    assert line.limit == pytest.approx(0.65 * 8744.278, rel=1e-6)
    assert "twice the speed" in line.note
    assert "passes it" in line.note


HELD = ("shaft", {**TUBE[1], "support": {"at": 0.75, "stiffness": 1e10}})


@pytest.mark.parametrize(("share", "verdict"), [(0.6499, "pass"), (0.6501, "not kept")])
def test_tube_on_a_support_is_judged_by_its_critical_speeds_on_it(judge, share, verdict):
    """A stiff support in the middle: a whole wave between the joints, w2 rho (A + 3 I b2) = E I b4 with b = 2 pi/l.

    The term of I is that of an element's backward whirl at its own frequency (gyroscopic moment and rotary inertia).
    """
    wave, gyration = (2.0 * math.pi / 1.5) ** 2, (0.12**2 + 0.108**2) / 16.0
    first = wave * math.sqrt(210e9 / 7850.0 * gyration / (1.0 + 3.0 * gyration * wave)) / RPM
    rated = {"speed": f"{share * first} rpm"}
    line = judge([joint(1), HELD, joint(1)], speeds=None, rated=rated)["n_crit", "tube"]
    assert line.limit == pytest.approx(0.65 * first, rel=1e-9)
    assert (line.verdict, line.standing) == (verdict, "to be verified")
    assert "on its supports" in line.note
    assert "simply supported" not in line.note


@pytest.mark.parametrize(
    ("rpm", "words"), [(16_900, "stays below it"), (17_100, "passes it within the speeds")]
)
def test_twice_the_speed_of_a_tube_on_a_support_meets_its_critical_speed_of_order_2(
    judge, rpm, words
):
    """Backward whirl at twice the speed: w2 rho (A + 2 I b2) = E I b4, half of which is 17026 rpm."""
    wave, gyration = (2.0 * math.pi / 1.5) ** 2, (0.12**2 + 0.108**2) / 16.0
    half = wave * math.sqrt(210e9 / 7850.0 * gyration / (1.0 + 2.0 * gyration * wave)) / RPM / 2.0
    assert abs(half - 17_000.0) < 90.0
    line = judge([joint(1), HELD, joint(1)], speeds=None, rated={"speed": f"{rpm} rpm"})[
        "n_crit", "tube"
    ]
    assert words in line.note


def test_tube_on_a_support_is_not_judged_where_bending_was_not_computed(study):
    scene = study([joint(1), HELD, joint(1)], materials={"steel": STEEL})
    seen = Results(
        scene, {"system": assemble(scene.train), "joints": joints(scene.train, scene.operation)}
    )
    (line,) = [
        line for line in UniversalJoints(JointRuleSettings()).check(seen) if line.clause == "n_crit"
    ]
    assert (line.where, line.verdict) == ("tube", "not judged")


def test_shafts_between_joints_that_nothing_holds_beside_one_on_a_support_are_left_out_with_the_cause(
    study,
):
    loose = ("shaft", {**TUBE[1], "name": "loose", "length": 0.5})
    between = [HELD, ("coupling", {"stiffness": 1e4}), loose, ("coupling", {"stiffness": 1e4})]
    scene = study([joint(1), *between, joint(1)], materials={"steel": STEEL})
    assert "it is not supported" in " ".join(
        why for _, why in UniversalJoints(JointRuleSettings()).left_out(scene)
    )


def test_share_of_the_critical_speed_is_a_setting(judge):
    parts, speed = [joint(1), TUBE, joint(1)], {"speed": "6000 rpm"}
    assert (
        judge(parts, JointRuleSettings(critical_share="80 %"), speeds=None, rated=speed)[
            "n_crit", "tube"
        ].verdict
        == "pass"
    )


def test_tube_behind_a_gear_turns_at_its_own_speed(judge):
    found = judge(
        [("gear", {"ratio": 2}), joint(1), TUBE, joint(1)], speeds=None, rated={"speed": "3000 rpm"}
    )
    assert found["n_crit", "tube"].value == pytest.approx(1500.0, rel=1e-13)


@pytest.mark.parametrize(
    ("between", "why"),
    [
        ([TUBE, ("shaft", {"name": "b", "length": 1.0, "diameter": 0.1})], "not one tube"),
        ([TUBE, ("coupling", {"stiffness": 1e4})], "not one tube"),
        ([("shaft", {"name": "cone", "length": 1.0, "diameter": [0.1, 0.12]})], "conical"),
        (
            [("shaft", {"name": "light", "length": 1.0, "diameter": 0.1, "material": "unknown"})],
            "youngs_modulus",
        ),
    ],
)
def test_what_lies_between_joints_and_is_no_tube_is_not_judged_and_said(study, between, why):
    unknown = Material(shear_modulus=80e9, density=7850.0)
    scene = study([joint(1), *between, joint(1)], materials={"steel": STEEL, "unknown": unknown})
    (line,) = tubes(scene.train)
    assert np.isnan(line.critical)
    assert why in " ".join(text for _, text in UniversalJoints(JointRuleSettings()).left_out(scene))


def test_joints_without_a_shaft_between_them_and_shafts_outside_have_no_tube(study):
    assert tubes(study([TUBE, joint(1), ("coupling", {"stiffness": 1e4}), joint(1)]).train) == ()
    assert tubes(study([joint(1), TUBE, ("gear", {"ratio": 2}), joint(1)]).train) == ()


def test_what_the_file_lacks_is_told(study):
    parts = [joint(1), ("disc", {"inertia": 1.0})]
    assert UniversalJoints(JointRuleSettings()).faults(study(parts)) == []
    assert (
        "no speed"
        in UniversalJoints(JointRuleSettings())
        .faults(study(parts, speeds=None, rated=None))[0]
        .message
    )
    assert "no joint" in UniversalJoints(JointRuleSettings()).faults(study(parts[1:]))[0].message
    assert UniversalJoints.needs == ("joints",)


def test_tripod_is_judged_by_its_own_unevenness(judge):
    """3 E 2 = 6 E between the greatest and the least speed, to first order in radius/arm."""
    found = judge([joint(30, kind="tripod", radius=0.03, arm=0.6)])
    size = 0.03 / 1.2 * math.tan(math.radians(15)) ** 2 * math.tan(math.radians(30))
    assert found["U", "joint-1"].value == pytest.approx(6.0 * size, rel=1e-3)
    assert found["U", "joint-1"].verdict == "fail"


@pytest.mark.parametrize(
    ("ends", "lacks"),
    [
        ({"diameter": [0.12, 0.13]}, "it is conical"),
        ({"bore": [0.1, 0.11]}, "it is conical"),
        ({"diameter": [0.13, 0.12]}, "it is conical"),
        ({"bore": [0.11, 0.1]}, "it is conical"),
        ({}, ""),
    ],
)
def test_a_conical_tube_lacks_what_the_closed_formula_needs(study, ends, lacks) -> None:
    tube = ("shaft", {**TUBE[1], **ends, "material": "steel"})
    parts = [("motor", {"inertia": 1.0}), joint(5), tube, joint(5), ("disc", {"inertia": 1.0})]
    (found,) = tubes(study(parts, materials={"steel": STEEL}).train)
    assert found.lacks == lacks
    assert math.isnan(found.critical) == bool(lacks)


def test_names_of_a_line_follow_the_power_and_its_parts_the_greatest_non_uniformity(judge, study):
    """The report marks the first of the parts: the joint whose angle is to be made smaller."""
    for angles in ((3, 5), (5, 3)):
        parts = [joint(angle, name=f"of {angle} deg") for angle in angles]
        train = study(parts).train
        found = judge(parts)
        place = ", ".join(f"of {angle} deg" for angle in angles)
        for clause in ("U", "torsional"):
            named = [train.parts[part].name for part in found[clause, place].parts]
            assert named == ["of 5 deg", "of 3 deg"]


def test_shafts_between_two_joints_are_named_from_the_second_joint_back(study):
    pieces = [("shaft", {"name": name, "length": 0.5, "diameter": 0.1}) for name in ("fore", "aft")]
    scene = study([joint(1), *pieces, joint(2)], materials={"steel": STEEL})
    (tube,) = tubes(scene.train)
    assert tube.name == "aft, fore"
    assert [scene.train.parts[part].name for part in tube.parts] == ["aft", "fore"]
    assert tube.lacks == "it is not one tube from joint to joint"
