"""Liu et al. (2023): the published curves' numbers, and each printed equation against the joint in space."""

import numpy as np
import pytest

from torsion.kernels.joints import cross

SPEED, TORQUE, EIGHT = 60.0, 800.0, np.radians(8.0)
TURN = np.linspace(0.0, 2.0 * np.pi, 97)
RIGHT, WRONG = 1e-13, 1e-2  # of the greatest value


def apart(found: object, truth: np.ndarray) -> float:
    return float(np.abs(np.asarray(found) - truth).max() / np.abs(truth).max())


def test_speeds_at_eight_degrees(paper) -> None:
    """The paper reads 60 +- 0.6 rad/s."""
    speeds = SPEED * paper["liu_2023"].at(8).joints[0].speed_ratio
    np.testing.assert_allclose(
        [speeds.min(), speeds.max()], [59.4160841245, 60.5896543511], rtol=1e-12
    )
    np.testing.assert_allclose([60.0 - speeds.min(), speeds.max() - 60.0], 0.6, rtol=0.0, atol=0.05)


@pytest.mark.parametrize(
    ("degrees", "expected"), [(3, 9.87413904680), (5, 27.4509010319), (8, 70.4209476186)]
)
def test_greatest_accelerations(degrees: int, expected: float, paper) -> None:
    joint = paper["liu_2023"].at(degrees).joints[0]
    assert SPEED**2 * joint.steepest == pytest.approx(expected, rel=1e-11)
    assert SPEED**2 * np.abs(joint.acceleration).max() == pytest.approx(expected, rel=1e-3)


def test_forks_in_line_make_the_second_shaft_run_evenly(paper) -> None:
    found = paper["liu_2023"].at(8)
    np.testing.assert_allclose(found.joints[1].speed_ratio, 1.0, rtol=0.0, atol=2e-15)
    assert found.lines[0].index < 1e-15


def test_couples_at_thirty_degrees_are_the_reference_values(paper, oracles) -> None:
    expected = {key: float(value) for key, value in oracles["liu2023_r8_alpha30_T800"].items()}
    own, x = paper["liu_equations"], np.pi / 6.0
    found = [own.driving_couple(EIGHT, x, TORQUE), own.driven_couple_right(EIGHT, x, TORQUE)]
    found += [
        own.driven_torque_right(EIGHT, x, TORQUE),
        own.driven_torque_printed(EIGHT, x, TORQUE),
    ]
    np.testing.assert_allclose(
        found, [expected[key] for key in ("M1", "M2", "T2", "T2_printed_wrong")], rtol=1e-13
    )
    driving, driven = paper["liu_2023"].at(8).joints[0].couples
    torque = TORQUE * paper["liu_2023"].at(8).joints[0].torque_ratio
    found = [np.abs(driving.yoke).max(), np.abs(driven.yoke).max(), torque.max(), torque.min()]
    np.testing.assert_allclose(
        found, [expected[key] for key in ("M1_max", "M2_max", "T2_max", "T2_min")], rtol=1e-13
    )


@pytest.mark.parametrize("r", [0.05, 0.6, 1.2])
def test_equation_4_and_not_3_follows_from_the_pins(r: float, paper) -> None:
    truth = np.exp(1j * paper["space"].cross(TURN, r).driven_angle)
    assert apart(np.exp(1j * paper["liu_equations"].angle_right(r, TURN)), truth) < RIGHT
    assert apart(np.exp(1j * paper["liu_equations"].angle_printed(r, TURN)), truth) > r * r / 3.0


@pytest.mark.parametrize("r", [EIGHT, 0.6])
def test_equations_5_and_6_are_those_of_the_other_zero(r: float, paper) -> None:
    body, own = paper["space"].cross(TURN, r), paper["liu_equations"]
    gain = body.curvature * SPEED**2 + 5.0 * body.ratio
    assert apart(own.ratio_right(r, TURN), body.ratio) < RIGHT
    assert apart(own.acceleration_right(r, TURN, SPEED, 5.0), gain) < 10 * RIGHT
    assert apart(own.ratio_printed(r, TURN), body.ratio) > WRONG
    assert apart(own.acceleration_printed(r, TURN, SPEED, 5.0), gain) > 1.0, "its sign is turned"
    moved = paper["space"].cross(TURN + np.pi / 2.0, r)
    assert apart(own.ratio_printed(r, TURN), moved.ratio) < RIGHT
    assert (
        apart(own.acceleration_printed(r, TURN, SPEED, 0.0), moved.curvature * SPEED**2)
        < 10 * RIGHT
    )


@pytest.mark.parametrize("phase", [0, 60, 120])
def test_phase_of_one_joint_does_not_change_the_size_of_the_fluctuation(phase: int, paper) -> None:
    x = np.linspace(0.0, np.pi, 181)
    ratio = paper["liu_equations"].ratio_printed(EIGHT, x + np.radians(phase))
    np.testing.assert_allclose(
        [ratio.min(), ratio.max()], [np.cos(EIGHT), 1.0 / np.cos(EIGHT)], rtol=1e-14
    )


def test_equation_10_holds_for_a_fork_counted_from_its_own_zero_only(paper) -> None:
    r, first, second = 0.6, np.radians(30.0), np.radians(120.0)
    truth = paper["space"].line_ratio(
        TURN, (r, r), (0.0, 0.0), (first, second - first - np.pi / 2.0)
    )
    np.testing.assert_allclose(truth, 1.0, rtol=0.0, atol=1e-14)
    own = paper["liu_equations"].two_joints(r, TURN, first, second, counted_from_zero=False)
    away = paper["liu_equations"].two_joints(r, TURN, first, second, counted_from_zero=True)
    assert apart(own, truth) < RIGHT
    np.testing.assert_allclose([away.min(), away.max()], [0.967, 1.034], rtol=0.0, atol=1e-3)


def test_axes_of_equations_1_and_12_differ_in_a_sign(paper) -> None:
    own = paper["liu_equations"]
    first, second = own.pins(EIGHT, TURN, own.angle_right(EIGHT, TURN))
    np.testing.assert_allclose(np.sum(first * second, axis=-1), 0.0, rtol=0.0, atol=1e-15)
    of_1, of_12 = (np.array([0.0, np.cos(EIGHT), sign * np.sin(EIGHT)]) for sign in (-1.0, 1.0))
    assert np.abs(second @ of_1).max() < 1e-15
    assert np.abs(second @ of_12).max() == pytest.approx(np.sin(2.0 * EIGHT), rel=1e-13)


@pytest.mark.parametrize("r", [EIGHT, 0.9])
def test_couples_of_13_against_statics_in_space(r: float, paper) -> None:
    body, own = paper["space"].cross(TURN, r), paper["liu_equations"]
    assert apart(-own.driving_couple(r, TURN, 1.0), body.driving_couple) < RIGHT
    assert apart(own.driven_couple_right(r, TURN, 1.0), body.driven_couple) < RIGHT
    assert apart(own.driven_torque_right(r, TURN, 1.0), body.driven_torque) < RIGHT
    assert apart(own.driven_torque_printed(r, TURN, 1.0), body.driven_torque) > WRONG
    inner = TURN[1:48]
    truth = paper["space"].cross(inner, r).driven_couple
    assert apart(own.driven_couple_printed(r, inner, 1.0), truth) < 10 * RIGHT
    with np.errstate(invalid="ignore"):
        assert np.isnan(own.driven_couple_printed(r, 0.0, 1.0)), "0/0 where a = 0"


def test_program_agrees_with_the_joint_in_space(paper) -> None:
    body, bent = (
        paper["space"].cross(TURN, EIGHT),
        cross.couples(TURN, EIGHT, TORQUE, convention="N"),
    )
    assert apart(cross.transfer(TURN, EIGHT, "N").ratio, body.ratio) < RIGHT
    assert apart(bent.driven.yoke, TORQUE * body.driven_couple) < RIGHT
    assert apart(bent.driven_torque, TORQUE * body.driven_torque) < RIGHT


def test_both_conditions_of_a_joint_close_equation_14() -> None:
    """theta3 = f(theta2) and G3 = G2/i pass the power on: (J2 + i^2 J3) theta2'' + i i' J3 theta2'^2 = 0 keeps energy.

    1 and 2 kg m^2 behind a joint of 25 degrees: 50 rad/s at a = 0 become 43.8576131631566 rad/s at 90 degrees.
    """
    angle, steps = np.radians(25.0), 400

    def slope(x: float, w: float) -> float:
        joint = cross.transfer(x, angle, "N")
        return float(-2.0 * joint.ratio * joint.curvature * w / (1.0 + 2.0 * joint.ratio**2))

    speed, step = 50.0, np.pi / 2.0 / steps
    for x in step * np.arange(steps):
        one = slope(x, speed)
        two = slope(x + step / 2.0, speed + step / 2.0 * one)
        three = slope(x + step / 2.0, speed + step / 2.0 * two)
        four = slope(x + step, speed + step * three)
        speed += step / 6.0 * (one + 2.0 * two + 2.0 * three + four)
    assert speed == pytest.approx(43.8576131631566, rel=1e-10)
