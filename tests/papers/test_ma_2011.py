"""Ma, Yu and Han (2011): both worked examples, the best phase, and each misprint against two joints in space."""

import numpy as np
import pytest

from torsion.kernels.joints import line

SPEED = 60.0  # degrees a second
FIRST, SECOND, PLANE = np.radians([15.0, 20.0, 10.0])
TURN = np.linspace(0.0, 2.0 * np.pi, 97)
EXPECTED = {  # greatest and least speed, where the greatest stands (degrees), index
    10: (61.6750076518353, 58.3704832324066, 90.0, 0.0550754069904797),
    55: (64.4291789399247, 55.8753046248925, 30.4154079182582, 0.142564571917204),
    100: (66.1030739739704, 54.4604022714221, 0.0, 0.194044528375804),
}
PRINTED = {10: (61.68, 58.37), 100: (66.10, 64.64)}


def in_space(
    paper, x: object, degrees: float, plane: float = PLANE, second: float = SECOND
) -> np.ndarray:
    return paper["space"].line_ratio(x, (FIRST, second), (0.0, plane), (0.0, np.radians(degrees)))


@pytest.mark.parametrize("degrees", EXPECTED)
def test_extremes_and_index_of_the_scene(degrees: int, paper) -> None:
    found, expected = paper["ma_2011"].output(degrees), EXPECTED[degrees]
    np.testing.assert_allclose(
        [SPEED * found.greatest.speed_ratio, SPEED * found.least.speed_ratio],
        expected[:2],
        rtol=1e-14,
    )
    assert found.index == pytest.approx(expected[3], rel=1e-13)
    turned = np.degrees(found.greatest.at) - expected[2]
    assert turned - 180.0 * np.round(turned / 180.0) == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize("degrees", EXPECTED)
def test_extremes_stand_where_two_joints_in_space_have_them(degrees: int, paper) -> None:
    greatest, least, at, _ = EXPECTED[degrees]
    truth = SPEED * in_space(paper, np.radians([at, at + 90.0]), degrees)
    np.testing.assert_allclose(truth, [greatest, least], rtol=1e-14)


def test_best_phase_is_the_angle_between_the_planes(paper) -> None:
    optimum = paper["ma_2011"].output(55).optimum
    assert np.degrees(optimum.best[0]) == pytest.approx(10.0, rel=1e-14)
    assert optimum.index_best == pytest.approx(0.0550754069904797, rel=1e-13)
    searched = paper["ma_equations"].closed_index(
        FIRST, SECOND, np.radians(np.arange(-90.0, 91.0)) - PLANE
    )
    assert searched.min() == pytest.approx(optimum.index_best, rel=1e-11)
    assert np.arange(-90, 91)[searched.argmin()] == 10


def test_printed_speeds_are_ours_but_for_64_64(paper) -> None:
    for degrees, printed in PRINTED.items():
        found = paper["ma_2011"].output(degrees)
        for speed, value in zip(
            (SPEED * found.greatest.speed_ratio, SPEED * found.least.speed_ratio),
            printed,
            strict=True,
        ):
            assert (abs(speed - value) < 0.005 + 1e-9) == (value != 64.64)


def test_least_speed_of_phase_100_is_54_46(paper) -> None:
    truth = SPEED * in_space(paper, TURN, 100.0)
    assert truth.min() == pytest.approx(SPEED * np.cos(FIRST) * np.cos(SECOND), rel=1e-14)
    assert truth.min() == pytest.approx(54.4604022714221, rel=1e-14)
    assert truth.min() < SPEED < 64.64, "a least speed lies below the mean"


def test_restored_equations_agree_with_forty_geometries_in_space(paper) -> None:
    """Planes of the first two shafts and of the last two: with the plane of intermediate and OUTPUT shaft."""
    rng = np.random.default_rng(5)
    for _ in range(40):
        first, second = rng.uniform(0.02, 1.2, 2)
        phase, plane = rng.uniform(-3.0, 3.0, 2)
        truth = paper["space"].line_ratio(TURN, (first, second), (0.0, plane), (0.0, phase))
        np.testing.assert_allclose(
            paper["ma_equations"].output(first, second, phase, plane, TURN),
            truth,
            rtol=1e-12,
            atol=0.0,
        )
        ours = line.motion(TURN, line.line_of([first, second], [0.0, plane], [0.0, phase])).ratio[
            -1
        ]
        np.testing.assert_allclose(ours, truth, rtol=1e-12, atol=0.0)


def test_lead_at_45_degrees(paper, oracles) -> None:
    found = np.degrees(paper["ma_equations"].lead(FIRST, np.pi / 4.0))
    assert found == pytest.approx(float(oracles["ma2011_dx_at_x1_45deg_deg"]), rel=1e-14)


def test_closed_form_of_the_index_is_that_of_the_speeds(paper) -> None:
    x = np.linspace(0.0, np.pi, 20001)
    for degrees in (0.0, 25.0, 70.0):
        sampled = paper["ma_equations"].index(in_space(paper, x, degrees))
        closed = paper["ma_equations"].closed_index(FIRST, SECOND, np.radians(degrees) - PLANE)
        assert sampled == pytest.approx(closed, rel=1e-7)


def test_shafts_in_one_plane_would_need_another_phase(paper) -> None:
    """3.2 speaks of shafts that are not in one plane: with gamma = 0 the phase of 10 degrees is not the best."""
    x = np.linspace(0.0, np.pi, 181)
    index = [
        paper["ma_equations"].index(in_space(paper, x, degrees, plane=0.0))
        for degrees in (0.0, 10.0)
    ]
    assert index[0] == pytest.approx(0.0550754069904797, rel=1e-12)
    assert index[1] > 1.1 * index[0]


def test_equal_angles_would_run_evenly(paper) -> None:
    """5.2 prints alpha = beta = 15 degrees: the index would vanish."""
    assert np.ptp(in_space(paper, TURN, 10.0, second=FIRST)) < 1e-14


def test_sixty_turns_a_minute_are_not_sixty_degrees_a_second(paper) -> None:
    found = paper["ma_2011"].at(10)
    assert found.joints[0].speed == pytest.approx(np.radians(60.0), rel=1e-15)
    assert 360.0 * EXPECTED[10][0] / SPEED == pytest.approx(370.05, abs=0.005)
