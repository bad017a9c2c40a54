"""Couple of a joint on a misaligned rigid shaft: against statics in space, its derivative, and mechanics' laws."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsion.analyses.lateral.misaligned_shaft import linearised, small_angle_part

TILTS = [0.0, np.radians(5.0), 0.7]
TURN = np.linspace(0.0, 2.0 * np.pi, 25)
STEP = 1e-30


@pytest.mark.parametrize("tilt", TILTS)
def test_moment_is_square_to_both_pins_and_has_the_driving_torque_about_the_driving_shaft(
    tilt: float, paper
) -> None:
    theory = paper["zhu_wang_theory"]
    first, second = 0.2, -0.3
    axes = np.array(theory.frame(first, second))
    moments = theory.moment(TURN, tilt, first, second) @ axes
    driving = np.array([0.0, np.sin(tilt), np.cos(tilt)])
    normal = np.array([1.0, 0.0, 0.0])
    pin = np.cos(TURN)[:, None] * normal + np.sin(TURN)[:, None] * np.cross(driving, normal)
    other = np.cross(axes[2], pin)
    for zero in (pin @ driving, np.sum(moments * pin, axis=1), np.sum(moments * other, axis=1)):
        np.testing.assert_allclose(zero, 0.0, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(moments @ driving, 1.0, rtol=1e-14)


def test_axes_of_the_shaft_are_square_and_move_as_the_two_angles_say(paper) -> None:
    theory = paper["zhu_wang_theory"]
    axes = np.array(theory.frame(0.4, -0.9))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(np.cross(axes[0], axes[1]), axes[2], rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("tilt", TILTS)
def test_linearised_matrix_is_minus_the_derivative_of_the_moment(tilt: float, paper) -> None:
    """Richardson's central difference of the exact moment."""

    theory = paper["zhu_wang_theory"]

    def slope(step: float) -> np.ndarray:
        ends = [
            theory.moment(TURN, tilt, step * way[0], step * way[1])[..., :2]
            for way in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ]
        return np.stack(((ends[0] - ends[1]), (ends[2] - ends[3])), axis=-1) / (2.0 * step)

    better = (4.0 * slope(1e-3) - slope(2e-3)) / 3.0
    np.testing.assert_allclose(linearised(TURN, tilt), -better, rtol=0.0, atol=2e-11)


@pytest.mark.parametrize("tilt", TILTS)
def test_forcing_is_the_moment_at_rest(tilt: float, paper) -> None:
    theory = paper["zhu_wang_theory"]
    at_rest = theory.moment(TURN, tilt, 0.0, 0.0)
    np.testing.assert_allclose(theory.forcing(TURN, tilt), at_rest[:, :2], rtol=0.0, atol=2e-16)
    ratio = np.cos(tilt) / (1.0 - (np.sin(tilt) * np.sin(TURN)) ** 2)
    np.testing.assert_allclose(
        at_rest[:, 2] * ratio, 1.0, rtol=1e-14, err_msg="the joint passes its power on"
    )


def test_small_angle_matrix_is_the_linearised_one_without_tilt(paper) -> None:
    theory = paper["zhu_wang_theory"]
    np.testing.assert_allclose(
        theory.small_angle(TURN, 0.3), linearised(TURN, 0.0), rtol=0.0, atol=1e-16
    )
    mean = small_angle_part(TURN, sine=0.0, cosine=0.0, constant=1.0)
    np.testing.assert_allclose(
        mean[0], [[0.0, 0.5], [-0.5, 0.0]], rtol=0.0, atol=0.0, err_msg="circulatory"
    )


def test_free_shaft_on_its_bearing_keeps_its_energy(paper) -> None:
    """Angles of up to 0.5 rad, gyroscopic moment included: kinetic and elastic energy is constant."""
    theory = paper["zhu_wang_theory"]
    inertia, polar, length, stiffness, spin = 0.7, 0.4, 1.3, np.array([11.0, 7.0]), 9.0

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        angles, rates = state[:2], state[2:]
        held = theory.bearing(angles, rates, stiffness, np.zeros(2), length) / inertia
        return np.concatenate([rates, theory.accelerations(angles, rates, held, spin, polar)])

    found = solve_ivp(rate, (0.0, 2.0), [0.5, -0.3, 0.2, 0.4], "DOP853", rtol=1e-12, atol=1e-14).y
    a, b, one, two = found
    place = length * np.stack((np.sin(b), -np.sin(a) * np.cos(b)))
    energy = 0.5 * inertia * ((one * np.cos(b)) ** 2 + two**2) + 0.5 * stiffness @ place**2
    np.testing.assert_allclose(energy, energy[0], rtol=1e-11)
    assert np.ptp(a) > 0.3


def test_bearing_damping_takes_the_power_of_the_end(paper) -> None:
    theory = paper["zhu_wang_theory"]
    angles, rates = np.array([0.4, -0.2]), np.array([1.5, 0.7])
    damping, length, step = np.array([2.0, 5.0]), 1.7, 1e-7

    def place(at: np.ndarray) -> np.ndarray:
        return length * theory.frame(at[0], at[1])[2][:2]

    speed = (place(angles + step * rates) - place(angles - step * rates)) / (2.0 * step)
    moments = theory.bearing(angles, rates, np.zeros(2), damping, length)
    power = moments @ np.array([rates[0] * np.cos(angles[1]), rates[1]])
    assert power == pytest.approx(-damping @ speed**2, rel=1e-8)
