"""Lines of joints against directly composed joints in space, Ma 2011 and the two-joint closed form."""

import json
from pathlib import Path

import numpy as np
import pytest

from torsion.kernels.joints import cross, line

ORACLES = json.loads((Path(__file__).parent / "oracles.json").read_text())
MA = {"angle": np.radians([15.0, 20.0]), "plane": np.radians([0.0, 10.0])}


def close(found: object, expected: object, relative: float = 1e-13) -> None:
    np.testing.assert_allclose(
        np.asarray(found, dtype=float), np.asarray(expected, dtype=float), rtol=relative, atol=0.0
    )


def random_line(rng: np.random.Generator, joints: int, steepest: float = 0.9) -> line.Line:
    plane = rng.uniform(-np.pi, np.pi, joints)
    plane[0] = 0.0
    return line.line_of(
        rng.uniform(0.02, steepest, joints), plane, rng.uniform(-np.pi, np.pi, joints)
    )


def two_joint_rapidity(first: float, second: float, misphase: float) -> np.ndarray:
    """The hyperbolic law of cosines without its difference; misphase = phase - plane of the second joint."""
    apart = np.sin((first + second) / 2.0) * np.sin((first - second) / 2.0)
    crossed = np.sin(first) * np.sin(second) * np.sin(misphase) / 2.0
    return 2.0 * np.arcsinh(np.hypot(apart, crossed) / np.sqrt(np.cos(first) * np.cos(second)))


def turned(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' rotation of a vector square to the axis or along it."""
    return (
        np.cos(angle) * vector
        + np.sin(angle) * np.cross(axis, vector)
        + (1 - np.cos(angle)) * (axis @ vector) * axis
    )


def driven_pins(
    case: line.Line, driving: float, frame: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """(shaft, zero, pin) behind each joint by rotations and cross products only; the zero is shaft x plane normal."""
    normal, shaft = frame[0], frame[1]
    pin = turned(np.cross(shaft, normal), shaft, driving + case.phase[0])
    pins = []
    for rank, angle in enumerate(case.angle):
        if rank:
            normal = turned(normal, shaft, case.plane[rank])
            pin = turned(pin, shaft, case.phase[rank])
        shaft = turned(shaft, normal, angle)
        pin = np.cross(shaft, pin)
        pin = pin / np.linalg.norm(pin)
        pins.append((shaft, -normal, pin))
    return pins


@pytest.mark.parametrize("joints", [1, 2, 3, 4, 5, 6])
def test_yokes_stand_where_rotations_in_space_put_them(joints: int) -> None:
    rng = np.random.default_rng(joints)
    for _ in range(60):
        case, frame, driving = (
            random_line(rng, joints),
            np.linalg.qr(rng.normal(size=(3, 3)))[0],
            rng.uniform(-4, 4),
        )
        driven = driving + line.motion(driving, case).error + np.cumsum(case.offset)
        for angle, (shaft, zero, pin) in zip(
            driven, driven_pins(case, driving, frame), strict=True
        ):
            assert abs(turned(zero, shaft, angle) @ np.cross(shaft, pin)) < 1e-14


@pytest.mark.parametrize("joints", [2, 3, 4, 5, 6])
def test_the_equivalent_single_joint_turns_as_the_chain_does(joints: int) -> None:
    rng = np.random.default_rng(10 + joints)
    x = np.linspace(-9.0, 9.0, 181)
    for _ in range(60):
        case = random_line(rng, joints, 0.6)
        chain, whole = line.motion(x, case), line.resultant(case)
        single = cross.transfer(x + whole.phase, whole.angle)
        lead = chain.error[-1] - single.error  # of two angles counted from different zeros
        np.testing.assert_allclose(lead, lead[0], rtol=0.0, atol=1e-13)
        close(single.ratio, chain.ratio[-1])
        size = np.abs(chain.curvature).max(axis=1).max()
        np.testing.assert_allclose(
            single.curvature, chain.curvature[-1], rtol=0.0, atol=1e-13 * size
        )


def test_extremes_of_the_resultant_are_those_of_the_chain_and_stand_where_it_says() -> None:
    case, x = random_line(np.random.default_rng(3), 5), np.linspace(0.0, np.pi, 20_001)
    chain, whole = line.motion(x, case).ratio[-1], line.resultant(case)
    close([chain.max(), chain.min()], [whole.greatest, whole.least], 1e-7)
    close(np.abs(np.cos(x[chain.argmax()] - whole.greatest_at)), 1.0, 1e-7)
    close(whole.index, whole.greatest - whole.least)
    close(cross.fluctuation(whole.angle), whole.index)


def test_lines_stand_side_by_side_in_leading_axes() -> None:
    rng = np.random.default_rng(5)
    cases = [random_line(rng, 3) for _ in range(4)]
    many = line.Line(
        *(np.stack([getattr(each, name) for each in cases]) for name in ("angle", "plane", "phase"))
    )
    close(line.resultant(many).rapidity, [line.resultant(each).rapidity for each in cases], 1e-15)
    close(line.classical_angle(many), [line.classical_angle(each) for each in cases], 1e-15)


@pytest.mark.parametrize("phase", [10, 55, 100])
def test_ma_2011_extremes_index_and_equivalent_angle(phase: int) -> None:
    expected = {key: float(value) for key, value in ORACLES[f"ma2011_phi{phase}"].items()}
    found = line.resultant(line.line_of(**MA, phase=np.radians([0.0, phase])))
    close([60.0 * found.greatest, 60.0 * found.least], [expected["max"], expected["min"]])
    close(found.index, expected["index"])
    close(np.degrees(found.angle), expected["beta_eq_deg"])


def test_ma_2011_phase_55_curve_and_where_it_turns() -> None:
    expected = {key: float(value) for key, value in ORACLES["ma2011_phi55"].items()}
    case = line.line_of(**MA, phase=np.radians([0.0, 55.0]))
    curve = line.motion(np.radians([0.0, 45.0, 90.0]), case)
    close(60.0 * curve.ratio[-1], [expected["w3_x1_0"], expected["w3_x1_45"], expected["w3_x1_90"]])
    close(np.degrees(line.resultant(case).greatest_at), expected["x1_max_deg"])
    close(np.degrees(line.resultant(case).greatest_at) + 90.0, expected["x1_min_deg"])
    close(np.degrees(curve.error[0, 1]), ORACLES["ma2011_dx_at_x1_45deg_deg"])


def test_ma_2011_printed_least_speed_at_phase_100_is_a_misprint() -> None:
    found = 60.0 * line.resultant(line.line_of(**MA, phase=np.radians([0.0, 100.0]))).least
    close(found, 60.0 * np.cos(np.radians(15.0)) * np.cos(np.radians(20.0)))
    assert round(float(found), 2) == 54.46  # printed: 64.64


@pytest.mark.parametrize("plane", [0.0, 0.4, np.pi])
def test_two_joints_follow_the_hyperbolic_law_of_cosines(plane: float) -> None:
    rng = np.random.default_rng(6)
    for first, second, phase in zip(
        rng.uniform(0.01, 1.5, 40), rng.uniform(0.01, 1.5, 40), rng.uniform(-4, 4, 40), strict=True
    ):
        case = line.line_of([first, second], [0.0, plane], [0.3, phase])
        both = two_joint_rapidity(first, second, phase - plane)
        close(line.resultant(case).rapidity, both, 3e-13)
        before, behind = cross.rapidity([first, second])
        plain = np.cosh(before) * np.cosh(behind) - np.sinh(before) * np.sinh(behind) * np.cos(
            2 * (phase - plane)
        )
        close(np.cosh(both), plain)


def test_equal_angles_with_yokes_in_line_cancel() -> None:
    case = line.line_of(np.radians([30.0, 30.0]), [0.0, 0.7], [0.2, 0.7])
    assert line.resultant(case).rapidity < 1e-15
    np.testing.assert_allclose(
        line.motion(np.linspace(0, 6, 50), case).error[-1], 0.0, rtol=0.0, atol=3e-16
    )


def test_cancelling_joints_of_almost_ninety_degrees() -> None:
    """Speeds between span a range of 5730 to 1, so that 1e-13 of it is the rounding of the joint's own angle."""
    case = line.line_of(np.radians([89.99, 89.99]))
    found = line.motion(np.linspace(-7.0, 7.0, 2001), case)
    np.testing.assert_allclose(found.error[-1], 0.0, rtol=0.0, atol=1e-11)
    close(found.ratio[-1], 1.0, 1e-11)
    assert two_joint_rapidity(np.radians(89.99), np.radians(89.99), 0.0) == 0.0


def test_classical_sum_of_squares_is_its_small_angle_limit() -> None:
    shape, plane, phase = np.array([1.0, 1.3, 0.4]), [0.0, 0.3, -1.0], [0.1, 0.9, 0.2]
    errors = []
    for scale in (0.04, 0.02, 0.01):
        case = line.line_of(scale * shape, plane, phase)
        errors.append(abs(line.classical_angle(case) / line.resultant(case).angle - 1.0))
    close(np.log2([errors[0] / errors[1], errors[1] / errors[2]]), 2.0, 0.05)


def test_classical_angle_of_ma_2011() -> None:
    close(np.degrees(line.classical_angle(line.line_of(np.radians([15.0, 20.0])))), np.sqrt(175.0))


def test_first_joint_has_no_plane() -> None:
    with pytest.raises(ValueError, match="plane"):
        line.line_of([0.1, 0.2], [0.1, 0.0])
