"""Joints of a train: lines through its branches and gears, exact curves, resultants and optimum."""

import math

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.joints.joint_analysis import JointsSettings, joints
from torsion.analyses.joints.joint_lines import Joints, placed
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine import Motor, Propeller
from torsion.model.shafts.shaft import Shaft
from torsion.study import Operation
from torsion.train import train

TRIPOD = {"kind": "tripod", "radius": 0.03, "arm": 0.6}
NONE = Operation()


def ma(phase: float) -> list:
    """Drive shaft of Ma, Yu and Han (2011), second example."""
    return [
        Joint(angle="15 deg"),
        Joint(name="rear", angle="20 deg", plane="10 deg", phase=f"{phase} deg"),
    ]


def found(components, operation=NONE, **requested):
    return joints(train(components), operation, JointsSettings(**requested))


@pytest.mark.parametrize(
    ("phase", "greatest", "least", "at", "index"),
    [
        (10, 61.6750076518353, 58.3704832324066, 90.0, 0.0550754069904797),
        (100, 66.1030739739704, 54.4604022714221, 0.0, 0.194044528375804),
        (55, 64.4291789399247, 55.8753046248925, 30.4154079182582, 0.142564571917204),
    ],
)
def test_ma_2011_drive_shaft(phase, greatest, least, at, index):
    """Driving speed 60 rad/s; extremes, where they stand, and the index of fluctuation."""
    (line,) = found(ma(phase)).lines
    assert 60.0 * line.greatest.speed_ratio == pytest.approx(greatest, rel=1e-14)
    assert 60.0 * line.least.speed_ratio == pytest.approx(least, rel=1e-14)
    assert math.cos(2.0 * (line.greatest.at - math.radians(at))) == pytest.approx(1.0, abs=1e-14)
    assert math.cos(2.0 * (line.least.at - math.radians(at))) == pytest.approx(-1.0, abs=1e-14)
    assert line.index == pytest.approx(index, rel=1e-13)


def test_ma_2011_resulting_angle_and_its_small_angle_sum():
    (line,) = found(ma(10)).lines
    assert math.degrees(line.resultant) == pytest.approx(13.3837943796630, rel=1e-13)
    assert math.degrees(line.classical) == pytest.approx(
        13.2287565553230, rel=1e-13
    )  # sqrt(20^2 - 15^2)


def test_ma_2011_best_phase_is_that_of_the_planes():
    (line,) = found(ma(55), optimise="phase").lines
    best = line.optimum
    assert best.names == ("rear",)
    assert np.degrees([best.before[0], best.best[0]]) == pytest.approx([55.0, 10.0], rel=1e-12)
    assert (best.index_before, best.index_best) == pytest.approx(
        (0.142564571917204, 0.0550754069904797), rel=1e-12
    )
    assert np.interp(best.before[0], best.over, best.index_over) == pytest.approx(
        best.index_before, rel=1e-12
    )
    assert np.interp(best.best[0], best.over, best.index_over) == pytest.approx(
        best.index_best, rel=1e-12
    )
    assert best.sensitivity[0] > best.index_best


def test_joints_of_a_line_follow_the_tangent_formula_one_after_another():
    """tan(out) = tan(in)/cos(angle) from each plane; the next yoke stands 90 degrees + phase - plane on."""
    bends, planes, phases = (10.0, 14.0, 7.0), (None, 35.0, -80.0), (20.0, -15.0, 40.0)
    line = [
        Joint(angle=f"{b} deg", plane=None if p is None else f"{p} deg", phase=f"{f} deg")
        for b, p, f in zip(bends, planes, phases, strict=True)
    ]
    result = found(line, steps=48, turns=2)
    assert result.angle.size == 97
    angle = result.angle
    for bend, plane, phase, joint in zip(bends, planes, phases, result.joints, strict=True):
        yoke = (
            angle + math.radians(phase - (plane or 0.0)) + (0.0 if plane is None else math.pi / 2)
        )
        angle = yoke + np.angle(
            np.exp(
                1j * (np.arctan2(np.sin(yoke), math.cos(math.radians(bend)) * np.cos(yoke)) - yoke)
            )
        )
        shift = (
            joint.yoke
        )  # the angles of the line are counted with every yoke's own start taken off
        assert joint.error == pytest.approx(angle - result.angle - shift, abs=1e-14)


@pytest.mark.parametrize("first", [TRIPOD, {}, {"kind": "cv"}, {**TRIPOD, "bearing": "twin"}])
def test_speed_and_acceleration_are_the_derivatives_of_the_angle(first):
    line = [
        Joint(angle="25 deg", phase="10 deg", **first),
        Joint(angle="12 deg", plane="40 deg"),
        Joint(angle="20 deg", phase="5 deg", **TRIPOD),
    ]
    result = found(line, steps=512)
    order = 1j * np.fft.fftfreq(512, 1.0 / 512)
    for joint in result.joints:
        spectrum = np.fft.fft(joint.error[:-1])
        speed, acceleration = (np.fft.ifft(spectrum * order**k).real for k in (1, 2))
        assert joint.speed_ratio[:-1] == pytest.approx(1.0 + speed, abs=1e-12)
        assert joint.acceleration[:-1] == pytest.approx(acceleration, abs=1e-10)


def test_ends_of_the_turn_meet():
    for joint in found([Joint(angle="25 deg", **TRIPOD), Joint(angle="12 deg")], turns=3).joints:
        for curve in (joint.error, joint.speed_ratio, joint.acceleration):
            assert curve[-1] == pytest.approx(curve[0], abs=1e-13)


def test_line_with_a_tripod_is_extreme_where_its_curve_is():
    line = [
        Joint(angle="35 deg", **TRIPOD),
        Joint(angle="6 deg", phase="20 deg"),
        Joint(angle="9 deg", phase="70 deg"),
    ]
    result = found(line, steps=10_000)
    last, (one,) = result.joints[-1], result.lines
    assert one.greatest.speed_ratio == pytest.approx(last.speed_ratio.max(), rel=1e-8)
    assert one.least.speed_ratio == pytest.approx(last.speed_ratio.min(), rel=1e-8)
    assert one.greatest.speed_ratio >= last.speed_ratio.max()
    assert one.least.speed_ratio <= last.speed_ratio.min()
    assert one.index == pytest.approx(one.greatest.speed_ratio - one.least.speed_ratio, rel=1e-12)
    assert last.steepest == pytest.approx(np.abs(last.acceleration).max(), rel=1e-6)
    assert "only the cross joints" in " ".join(result.remarks)


@pytest.mark.parametrize(
    ("angle", "steepest"), [(3, 9.87413904680), (5, 27.4509010319), (8, 70.4209476186)]
)
def test_liu_2023_accelerations_at_60_rad_s(angle, steepest):
    (joint,) = found([Joint(angle=f"{angle} deg", phase="60 deg")]).joints
    assert 3600.0 * joint.steepest == pytest.approx(steepest, rel=1e-11)


def test_constant_velocity_joint_between_two_equal_cross_joints_lets_them_cancel():
    line = [Joint(angle="14 deg"), Joint(angle="30 deg", kind="cv"), Joint(angle="14 deg")]
    result = found(line)
    (one,) = result.lines
    assert one.index < 1e-15
    assert np.abs(result.joints[-1].error).max() < 1e-15
    assert result.joints[1].error == pytest.approx(result.joints[0].error, abs=0)


def test_phase_of_a_constant_velocity_joint_turns_the_next_yoke():
    through = [
        Joint(angle="14 deg"),
        Joint(angle="3 deg", kind="cv", phase="25 deg", plane="5 deg"),
        Joint(angle="9 deg"),
    ]
    direct = [Joint(angle="14 deg"), Joint(angle="9 deg", phase="20 deg")]
    assert found(through).lines[0].index == pytest.approx(found(direct).lines[0].index, rel=1e-13)


def test_a_line_follows_every_branch_and_ends_at_a_gear():
    branch = Branch(train=(Joint(name="side", angle="4 deg"), Disc(name="pump", inertia=1.0)))
    line = [
        Joint(name="a", angle="6 deg"),
        Disc(inertia=1.0),
        branch,
        Joint(name="b", angle="5 deg"),
        Gear(ratio=2),
        Joint(name="c", angle="3 deg"),
        Joint(name="d", angle="3 deg", kind="cv"),
    ]
    result = found(line, operation=Operation(rated={"speed": "100 rad/s"}))
    names = [[result.joints[k].name for k in one.joints] for one in result.lines]
    assert sorted(names) == [["a", "b"], ["a", "side"], ["c", "d"]]
    assert [joint.speed for joint in result.joints] == [100.0, 100.0, 100.0, 50.0, 50.0]


def test_joint_alone_is_its_own_resultant_whatever_turns_before_a_gear():
    line = [Joint(angle="6 deg"), Gear(ratio=3), Joint(angle="11 deg", phase="33 deg")]
    for one, angle in zip(found(line).lines, (6.0, 11.0), strict=True):
        assert math.degrees(one.resultant) == pytest.approx(angle, rel=1e-14)


def test_speed_is_the_highest_where_none_is_rated_and_unknown_where_none_is_given():
    line = [Joint(angle="6 deg")]
    span = Operation(speeds={"from": "10 rad/s", "to": "80 rad/s"})
    assert found(line, operation=span).joints[0].speed == 80.0
    unknown = found(line)
    assert unknown.joints[0].speed is None
    assert unknown.joints[0].couples == ()
    assert [("speed" in text, "torque" in text) for text in unknown.remarks] == [
        (True, False),
        (False, True),
    ]


def test_spans_of_the_joints_are_theirs_in_the_assembly():
    line = [
        Motor(inertia=1.0),
        Coupling(stiffness=1e4),
        Joint(angle="6 deg"),
        Shaft(length=1.0, diameter=0.05),
        Gear(ratio=2),
        Coupling(stiffness=1e4),
        Joint(angle="6 deg"),
        Propeller(inertia=1.0),
    ]
    built = train(line)
    system = assemble(built, frequency=2000.0)
    assert [system.spans[place.span].name for place in placed(built)] == ["joint-1", "joint-2"]


def test_best_phase_of_many_joints_leaves_what_cannot_close():
    """Three of 4, 4 and 5 degrees close; one of 20 degrees is beyond what two of 5 can undo."""
    small = [
        Joint(angle="4 deg"),
        Joint(angle="4 deg", phase="50 deg"),
        Joint(angle="5 deg", phase="10 deg"),
    ]
    great = [
        Joint(angle="20 deg"),
        Joint(angle="5 deg", phase="50 deg"),
        Joint(angle="5 deg", phase="10 deg"),
    ]
    closed, left = (found(line, optimise="phase").lines[0].optimum for line in (small, great))
    assert closed.index_best < 1e-12
    rest = math.log(math.cos(math.radians(5)) ** 2 / math.cos(math.radians(20)))
    assert left.index_best == pytest.approx(2.0 * math.sinh(rest), rel=1e-9)
    assert all(
        abs(best - before) <= math.pi / 2
        for best, before in zip(left.best, left.before, strict=True)
    )


@pytest.mark.parametrize("variable", ["phase", "plane", "angle"])
def test_best_choice_put_into_the_train_has_the_index_that_was_promised(variable):
    line = [
        Joint(angle="12 deg"),
        Joint(angle="5 deg", kind="cv", phase="8 deg", plane="3 deg"),
        Joint(angle="7 deg", phase="30 deg", plane="15 deg"),
        Joint(angle="9 deg", phase="-20 deg"),
    ]
    best = found(line, optimise=variable).lines[0].optimum
    assert best.names == ("joint-3", "joint-4")
    for place, value in zip((2, 3), best.best, strict=True):
        line[place] = line[place].model_copy(update={variable: value})
    assert found(line).lines[0].index == pytest.approx(best.index_best, rel=1e-10, abs=1e-14)


def test_one_joint_alone_may_be_changed():
    line = [
        Joint(angle="12 deg"),
        Joint(angle="7 deg"),
        Joint(name="free", angle="9 deg", phase="40 deg"),
    ]
    best = found(line, optimise="phase", joint="free").lines[0].optimum
    assert best.names == ("free",)
    assert best.index_best == pytest.approx(best.index_over.min(), rel=1e-3)
    assert best.index_best <= best.index_over.min()


def test_angle_of_the_first_joint_may_be_chosen_and_is_that_of_the_joint_opposite():
    """In one plane, yokes alike: two equal angles cancel. The picture reaches from 0 to the 50 degrees of the file."""
    line = [Joint(name="first", angle="50 deg"), Joint(angle="9 deg")]
    best = found(line, optimise="angle", joint="first").lines[0].optimum
    assert np.degrees(best.best) == pytest.approx([9.0], rel=1e-7)
    assert best.index_best == pytest.approx(0.0, abs=1e-9)
    assert np.degrees(best.over[[0, -1]]) == pytest.approx([0.0, 50.0], rel=1e-12)
    assert best.index_over[-1] == pytest.approx(best.index_before, rel=1e-12)


def test_line_with_nothing_to_choose_says_so():
    result = found([Joint(angle="12 deg"), Joint(angle="4 deg", kind="cv")], optimise="phase")
    assert result.lines[0].optimum is None
    assert "no phase" in result.remarks[-1]


@for_all(
    ("requested", "path", "words"),
    [
        ({"joint": "joint-2"}, "joint", "nothing is optimised"),
        ({"joint": "joint-9", "optimise": "phase"}, "joint", "no joint is called"),
        ({"joint": "joint-1", "optimise": "phase"}, "joint", "first of its line"),
        ({"joint": "joint-3", "optimise": "phase"}, "joint", "not a cross joint"),
        ({"bearings": {"joint-9": 0.2}}, "bearings", "no joint is called"),
    ],
)
def test_setting_that_names_no_free_joint_is_refused(requested, path, words):
    with pytest.raises(InputError, match=words) as caught:
        found(
            [Joint(angle="5 deg"), Joint(angle="5 deg"), Joint(angle="5 deg", kind="cv")],
            **requested,
        )
    assert caught.value.faults[0].path[:3] == ("analyses", "joints", path)


def test_train_without_a_joint_is_refused():
    with pytest.raises(InputError, match="no joint"):
        found([Disc(inertia=1.0)])


def test_every_train_with_a_joint_gets_its_joints_and_no_other():
    joined = (
        "name: a\ntrain: [disc: {inertia: 1}, joint: {angle: 5 deg}, disc: {name: b, inertia: 1}]\n"
    )
    assert (
        torsion.run(torsion.parse(joined + "analyses: {modes: }")).need(Joints).joints[0].name
        == "joint-1"
    )
    plain = "name: a\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 10}, disc: {name: b, inertia: 1}]\n"
    assert torsion.run(torsion.parse(plain)).get(Joints) is None


def test_scene_of_joints_alone_is_solved_and_the_rest_left_out_with_its_reason():
    result = torsion.run(
        torsion.parse("name: a\ntrain: [joint: {angle: 5 deg}, joint: {angle: 5 deg}]\n")
    )
    assert result.need(Joints).lines[0].index < 1e-15
    assert result.get(Modes) is None
    assert result.get(Response) is None
    why = dict(result.plan.left_out)
    assert why["natural frequencies"] == why["response over speed"] == "no component has an inertia"
