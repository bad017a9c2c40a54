"""Tripod joints: first-order formulas against the reference values, exact motion and statics against lines in space."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

from torsion.errors import SolveError
from torsion.kernels.joints import tripod

ORACLES = json.loads(
    (Path(__file__).parents[1] / "kernels" / "joints" / "oracles.json").read_text()
)
RADIUS, ARM, TORQUE = 0.03, 0.6, 200.0
ANGLES = (10, 20, 30, 40)
RANGES = {  # N m: couple of the single bearing least, greatest; twin bearing
    10: (17.3811593206, 17.6143296922, 17.4977327052),
    20: (34.7695184780, 35.7621162435, 35.2653961417),
    30: (52.3501360565, 54.8372731549, 53.5898384862),
    40: (70.2214996492, 75.4098489999, 72.7940468532),
}


def close(found: object, expected: object, relative: float = 1e-13) -> None:
    np.testing.assert_allclose(
        np.asarray(found, dtype=float), np.asarray(expected, dtype=float), rtol=relative, atol=0.0
    )


@for_all("turned", [0, 15, 30, 90])
@for_all("degrees", ANGLES)
def test_first_order_statics_agree_with_the_reference_values(
    degrees: int, turned: int, paper
) -> None:
    expected = {
        key: float(value)
        for key, value in ORACLES[f"tripod_gamma{degrees}"][f"phi{turned}"].items()
    }
    geometry = (np.radians(turned), np.radians(degrees), RADIUS, ARM)
    found = paper["tripod_first_order"].first_order_statics(*geometry, TORQUE)
    close(paper["tripod_first_order"].first_order_motion(*geometry).ratio, expected["i"])
    close(
        [-found.torque, found.driving_inplane, found.driven_inplane, found.couple],
        [expected[key] for key in ("To", "V1", "V2", "M1")],
    )
    np.testing.assert_allclose(
        found.driving_normal, expected["U1"], rtol=1e-13, atol=1e-15 * TORQUE
    )


@pytest.mark.parametrize("degrees", ANGLES)
def test_amplitudes_and_twin_couple_agree_with_the_reference_values(degrees: int) -> None:
    expected, angle = ORACLES[f"tripod_gamma{degrees}"], np.radians(degrees)
    size = tripod.error_size(angle, RADIUS, ARM)
    close([size, 3.0 * size], [expected["e_amp_rad"], expected["i_amp"]])
    close(tripod.constant_velocity_couple(angle, TORQUE), expected["twin_M1"])


@pytest.mark.parametrize("degrees", ANGLES)
def test_couple_ranges_over_a_turn(degrees: int, paper) -> None:
    """As its figure 5: the couple is least where sin 3x = -1 and greatest where it is 1."""
    x, angle = np.linspace(0.0, 2.0 * np.pi, 721), np.radians(degrees)
    couple = paper["tripod_first_order"].first_order_statics(x, angle, RADIUS, ARM, TORQUE).couple
    found = couple.min(), couple.max(), tripod.constant_velocity_couple(angle, TORQUE)
    close(found, RANGES[degrees], 1e-11)


def test_complex_amplitude_of_order_three(paper) -> None:
    x, spider = np.linspace(0.0, 6.0, 20), 0.4
    amplitude = tripod.error_amplitude(0.5, spider, RADIUS, ARM)
    expected = paper["tripod_first_order"].first_order_motion(x + spider, 0.5, RADIUS, ARM).error
    np.testing.assert_allclose((amplitude * np.exp(3j * x)).real, expected, rtol=0.0, atol=1e-18)


def least_turn(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Rotation matrix about start x end that brings one unit vector to the other."""
    axis = np.cross(start, end)
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + skew + skew @ skew / (1.0 + start @ end)


def spun(angle: float) -> np.ndarray:
    return np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]]
    )


def shafts(bend: float, yaw: float) -> np.ndarray:
    return np.array([np.sin(bend) * np.sin(yaw), -np.sin(bend) * np.cos(yaw), np.cos(bend)])


@for_all("degrees", [0.0, 1e-5, 10.0, 40.0, 60.0])
@for_all("share", [1e-6, 0.05, 0.2])
def test_every_arm_meets_its_line_in_space(degrees: float, share: float) -> None:
    """Axes n, d x n, d: the driven body is turned about its pivot by three rotations from the driving one."""
    angle, axis = np.radians(degrees), np.array([0.0, 0.0, 1.0])
    outgoing = shafts(angle, 0.0)
    for x in np.linspace(-3.0, 8.0, 23):
        found = tripod.exact_motion(x, angle, share, 1.0)
        shaft = shafts(float(found.bend), float(found.yaw))
        body = (
            least_turn(outgoing, shaft) @ least_turn(axis, outgoing) @ spun(x + float(found.error))
        )
        centre = outgoing - shaft
        np.testing.assert_allclose(centre[:2], found.orbit, rtol=0.0, atol=1e-15)
        for place in 2.0 * np.pi / 3.0 * np.arange(3):
            arm = body @ np.array([np.cos(place), np.sin(place), 0.0])
            point = share * np.array([np.cos(x + place), np.sin(x + place), 0.0])
            assert abs(np.cross(arm, axis) @ (point - centre)) < 1e-15


@pytest.mark.parametrize("degrees", [10.0, 40.0, 60.0])
def test_exact_ratio_is_the_derivative_of_the_exact_angle(degrees: float) -> None:
    """By the trigonometric interpolant of 96 equal steps of the revolution, exact to rounding."""
    x = 2.0 * np.pi * np.arange(96) / 96
    found = tripod.exact_motion(x, np.radians(degrees), RADIUS, ARM)
    series = np.fft.fft(found.error)
    slope = np.fft.ifft(1j * np.fft.fftfreq(96, 1 / 96) * series).real
    np.testing.assert_allclose(found.ratio, 1.0 + slope, rtol=0.0, atol=3e-15)


@pytest.mark.parametrize("degrees", ANGLES)
def test_first_order_is_the_limit_of_the_exact_joint(degrees: int, paper) -> None:
    """Relative errors of motion and statics fall with the square and the first power of radius/arm."""
    x, angle = np.linspace(0.0, 2.0 * np.pi, 25), np.radians(degrees)
    motions, forces, theory = [], [], paper["tripod_first_order"]
    for radius in (1e-3, 5e-4):
        size = tripod.error_size(angle, radius, 1.0)
        first, exact = (
            theory.first_order_motion(x, angle, radius, 1.0),
            tripod.exact_motion(x, angle, radius, 1.0),
        )
        motions.append(np.abs(first.error - exact.error).max() / size)
        near, true = (
            pick(x, angle, radius, 1.0, 1.0)
            for pick in (theory.first_order_statics, tripod.exact_statics)
        )
        for name in ("driving_normal", "driving_inplane", "driven_inplane"):
            forces.append(np.abs(getattr(near, name) - getattr(true, name)).max() / radius**2)
        forces.extend(
            np.abs(a - b).max() / radius**2 for a, b in zip(near.force, true.force, strict=True)
        )
    close(motions[0] / motions[1], 2.0, 0.05)
    close(np.divide(forces[:5], forces[5:]), 1.0, 0.05)


def test_third_harmonic_of_forty_degrees_beside_the_first_order() -> None:
    """Spin read from the shafts' normal at rest, not through a constant-velocity pivot: 6.8e-4, and 6e-3 of order 6."""
    x, angle = 2.0 * np.pi * np.arange(48) / 48, np.radians(40.0)
    found = tripod.exact_motion(x, angle, RADIUS, ARM)
    spins = []
    for turned, error, bend, yaw in zip(x, found.error, found.bend, found.yaw, strict=True):
        outgoing, shaft = shafts(angle, 0.0), shafts(bend, yaw)
        body = (
            least_turn(outgoing, shaft)
            @ least_turn(np.array([0, 0, 1.0]), outgoing)
            @ spun(turned + error)
        )
        square = np.cross(shaft, np.array([1.0, 0, 0]))
        square = square / np.linalg.norm(square)
        spins.append(
            np.angle(
                np.exp(
                    1j
                    * (
                        np.arctan2(body[:, 0] @ square, body[:, 0] @ np.cross(square, shaft))
                        - turned
                    )
                )
            )
        )
    series = np.fft.fft(spins) / 24
    assert round(abs(series[3]) / tripod.error_size(angle, RADIUS, ARM) - 1.0, 5) == 6.8e-4
    assert round(abs(series[6]) / abs(series[3]), 3) == 6e-3


@pytest.mark.parametrize("degrees", [1e-4, 10.0, 40.0, 60.0])
def test_contact_forces_do_the_work_of_the_torques(degrees: float) -> None:
    x, angle = np.linspace(-4.0, 4.0, 41), np.radians(degrees)
    ratio = tripod.exact_motion(x, angle, RADIUS, ARM).ratio
    close(tripod.exact_statics(x, angle, RADIUS, ARM, TORQUE).torque * ratio, np.full(41, TORQUE))


@pytest.mark.parametrize(("degrees", "force"), [(10, 29.2), (40, 121.0)])
def test_a_single_bearing_joint_carries_a_lateral_force(degrees: int, force: float) -> None:
    x = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    found = tripod.exact_statics(x, np.radians(degrees), RADIUS, ARM, TORQUE)
    close(np.hypot(*found.force).mean(), force, 5e-3)


def test_a_straight_joint_turns_and_carries_as_one_shaft() -> None:
    x = np.linspace(0.0, 3.0, 7)
    found, load = (
        tripod.exact_motion(x, 0.0, RADIUS, ARM),
        tripod.exact_statics(x, 0.0, RADIUS, ARM, TORQUE),
    )
    np.testing.assert_array_equal(found.error, 0.0)
    np.testing.assert_array_equal(found.ratio, 1.0)
    np.testing.assert_allclose(load.couple, 0.0, rtol=0.0, atol=1e-12)
    close(load.torque, TORQUE)


def test_a_shaft_whose_end_cannot_run_around_is_refused() -> None:
    with pytest.raises(SolveError, match="arm longer"):
        tripod.exact_motion(np.linspace(0.0, 6.0, 50), np.radians(88.0), RADIUS, ARM)
