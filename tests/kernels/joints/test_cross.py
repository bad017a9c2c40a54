"""Cross joints against 40-digit reference values, three-dimensional geometry and their own Fourier series."""

import json
from pathlib import Path

import numpy as np
import pytest

from torsion.kernels.joints import cross

ORACLES = json.loads((Path(__file__).parent / "oracles.json").read_text())
DEGREES = (3, 5, 8, 10, 15, 20, 30)


def close(found: object, expected: object, relative: float = 1e-13) -> None:
    np.testing.assert_allclose(
        np.asarray(found, dtype=float), np.asarray(expected, dtype=float), rtol=relative, atol=0.0
    )


def driven_angle(driving, angle, convention="P"):
    return driving + cross.transfer(driving, angle, convention).error


def harmonics(angle, count, convention):
    """Of error (sine), ratio (cosine), second derivative (sine): +-q^k/k, +-2 q^k, -+4 k q^k, of orders 2 k."""
    rank = np.arange(1, count + 1)
    power = (cross.unevenness(angle) * (1.0 if convention == "P" else -1.0)) ** rank
    return power / rank, 2.0 * power, -4.0 * rank * power


def torque_ratio_harmonics(angle, convention):
    """Mean (1 + c^2)/(2 c) and coefficient -+s^2/(2 c) of cos 2x; there is no other."""
    second = cross.fluctuation(angle) / 2.0
    return (1.0 + np.cos(angle) ** 2) / (
        2.0 * np.cos(angle)
    ), -second if convention == "P" else second


@pytest.mark.parametrize("degrees", DEGREES)
def test_one_joint_agrees_with_the_reference_values(degrees: int) -> None:
    expected = {key: float(value) for key, value in ORACLES[f"joint_{degrees}"].items()}
    angle = np.radians(degrees)
    leading = np.arctan(np.sqrt(np.cos(angle))) + np.pi / 2.0  # where the error is greatest
    steepest = np.radians(expected["at_input_angle_deg"])
    close(cross.unevenness(angle), expected["q"])
    close(cross.rapidity(angle), expected["rapidity"])
    close(cross.fluctuation(angle), expected["fluct_index"])
    close(harmonics(angle, 3, "N")[0], [expected["e2"], expected["e4"], expected["e6"]])
    close(
        torque_ratio_harmonics(angle, "N"),
        [expected["torque_ratio_mean_T2_T1"], expected["torque_ratio_2x"]],
    )
    ratio = cross.transfer(np.array([0.0, np.pi / 2.0]), angle, "N").ratio
    close(ratio, [expected["i_min"], expected["i_max"]])
    close(cross.transfer(leading, angle, "N").error, expected["max_e_rad"])
    close(cross.greatest_curvature(angle), expected["max_d2out_din2"])
    close(cross.transfer(steepest, angle, "N").curvature, expected["max_d2out_din2"])


def test_angle_ratio_and_its_derivative_of_twenty_degrees_at_seven_tenths() -> None:
    expected = ORACLES["joint_20_at_alpha_0.7rad_convN"]
    joint = cross.transfer(0.7, np.radians(20.0), "N")
    close(driven_angle(0.7, np.radians(20.0), "N"), expected["beta_out"])
    close([joint.ratio, joint.curvature], [expected["ratio"], expected["dratio"]])


@pytest.mark.parametrize("convention", ["P", "N"])
def test_driven_pin_is_square_to_driving_pin_and_driven_shaft(convention: cross.Convention) -> None:
    rng = np.random.default_rng(1)
    for _ in range(300):
        normal, first = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        angle, driving = rng.uniform(0.01, 1.5), rng.uniform(-20.0, 20.0)
        second = np.cos(angle) * first + np.sin(angle) * np.cross(normal, first)
        driven = driven_angle(driving, angle, convention)
        zeros = normal, np.cross(second, normal)
        if convention == "P":
            zeros = np.cross(first, normal), -normal
        driving_pin = np.cos(driving) * zeros[0] + np.sin(driving) * np.cross(first, zeros[0])
        driven_pin = np.cos(driven) * zeros[1] + np.sin(driven) * np.cross(second, zeros[1])
        assert abs(driving_pin @ driven_pin) < 1e-14
        assert abs(driven_pin @ second) < 1e-14


def test_ratio_is_that_of_the_velocities_of_the_rigid_cross() -> None:
    """No rate of cross and shafts about either pin but its own: the rates w1 d1 + u a = w2 d2 + v b in space."""
    rng = np.random.default_rng(2)
    for _ in range(300):
        normal, first = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        angle, driving = rng.uniform(0.01, 1.5), rng.uniform(-7.0, 7.0)
        second = np.cos(angle) * first + np.sin(angle) * np.cross(normal, first)
        pin = np.cos(driving) * normal + np.sin(driving) * np.cross(first, normal)
        across = np.cross(second, pin)
        speed, *_ = np.linalg.solve(
            np.stack((second, pin, across / np.linalg.norm(across)), axis=1), first
        )
        close(cross.transfer(driving, angle, "N").ratio, speed, 3e-14)


@pytest.mark.parametrize("convention", ["P", "N"])
@pytest.mark.parametrize("angle", [0.05, 0.3, 0.8])
def test_harmonics_sum_to_the_curves(angle: float, convention: cross.Convention) -> None:
    x = np.linspace(-5.0, 5.0, 41)
    (error, ratio, curvature), rank = (
        harmonics(angle, 80, convention),
        2.0 * np.arange(1, 81)[:, None],
    )
    curve = cross.transfer(x, angle, convention)
    np.testing.assert_allclose(error @ np.sin(rank * x), curve.error, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(1.0 + ratio @ np.cos(rank * x), curve.ratio, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(curvature @ np.sin(rank * x), curve.curvature, rtol=0.0, atol=3e-14)
    mean, second = torque_ratio_harmonics(angle, convention)
    close(1.0 / curve.ratio, mean + second * np.cos(2.0 * x), 1e-14)


def test_complex_amplitude_is_the_sine_coefficient_turned_with_the_yoke() -> None:
    """And that of order 2k is its kth power by k, times a power of i, so that the sum is the whole error."""
    angle, yoke, x, k = 0.6, 0.7, np.linspace(0.0, 3.0, 13), np.arange(1, 60)
    amplitudes = -1j * (1j * cross.error_amplitude(angle, yoke)) ** k / k
    summed = (amplitudes @ np.exp(2j * k[:, None] * x)).real
    np.testing.assert_allclose(summed, cross.transfer(x + yoke, angle).error, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("degrees", [1e-6, 1.0, 35.0, 80.0, 89.99])
def test_no_acceleration_exceeds_the_greatest_which_stands_at_the_root_of_its_derivative(
    degrees: float,
) -> None:
    angle = np.radians(degrees)
    most, square = cross.greatest_curvature(angle), np.sin(angle) ** 2
    cosine = (
        -4.0
        * square
        / (1.0 + np.cos(angle) ** 2 + np.sqrt(4.0 * np.cos(angle) ** 2 + 9.0 * square**2))
    )
    at = np.pi - np.arccos(-cosine) / 2.0  # cos 2x of convention P
    x = np.concatenate([np.linspace(0.0, np.pi, 2001), at + np.linspace(-1e-3, 1e-3, 2001)])
    curve = cross.transfer(x, angle).curvature
    assert np.abs(curve).max() <= most * (1.0 + 1e-13)
    close(np.abs(curve).max(), most, 1e-4)


def test_no_branch_is_jumped_at_almost_ninety_degrees_over_many_turns() -> None:
    x = np.linspace(-40.0, 40.0, 200_001)
    driven = driven_angle(x, np.radians(89.99))
    assert np.all(np.diff(driven) >= 0.0)
    assert np.abs(driven - x).max() < np.pi / 2.0
    np.testing.assert_allclose(
        np.cos(driven) * np.sin(x),
        np.cos(np.radians(89.99)) * np.sin(driven) * np.cos(x),
        atol=1e-13,
    )


def test_derivatives_are_those_of_the_angle() -> None:
    """Against the derivative of the analytic continuation, exact to rounding: Im f(x + i h)/h."""
    x, angle, step = np.linspace(0.0, 6.0, 25), 0.9, 1e-20
    shifted = x + 1j * step
    squared = np.sin(shifted) ** 2 + np.cos(angle) ** 2 * np.cos(shifted) ** 2
    curve = cross.transfer(x, angle)
    np.testing.assert_allclose(
        curve.curvature, (np.cos(angle) / squared).imag / step, rtol=0.0, atol=3e-15
    )
    start = cross.Transfer(np.zeros_like(x), np.full_like(x, 3.0), np.full_like(x, 0.5))
    close(cross.behind(start, curve).curvature, 9.0 * curve.curvature + 0.5 * curve.ratio, 1e-14)


@pytest.mark.parametrize(
    ("degrees", "acceleration"), [(3.0, 9.87413904680), (5.0, 27.4509010319), (8.0, 70.4209476186)]
)
def test_liu_2023_accelerations_at_sixty_radians_a_second(
    degrees: float, acceleration: float
) -> None:
    close(3600.0 * cross.greatest_curvature(np.radians(degrees)), acceleration, 1e-11)


def test_liu_2023_speeds_at_eight_degrees() -> None:
    ratio = cross.transfer(np.array([np.pi / 2.0, 0.0]), np.radians(8.0)).ratio
    close(60.0 * ratio, [59.4160841245, 60.5896543511], 1e-11)
