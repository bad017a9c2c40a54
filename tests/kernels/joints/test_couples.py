"""Couples of cross joints against statics in space, Liu 2023, and the balance of power and moments."""

import json
from pathlib import Path

import numpy as np
import pytest

from torsion.kernels.joints import cross, line

ORACLES = json.loads((Path(__file__).parent / "oracles.json").read_text())
CARRIERS = ["driving", "driven"]


def intermediate_couples(
    driving: object, case: line.Line, torque: object, carrier: cross.Carrier = "driving"
) -> tuple[cross.Couple, ...]:
    """Net couple of the two joints on each shaft between joints, in the axes of the joint before it.

    `torque` is constant on the first shaft (carrier "driving") or on the last. A plane of 180 degrees with equal
    angles is the Z arrangement (outer shafts parallel), a plane of 0 the W arrangement.
    """
    every = line_couples(driving, case, torque, carrier)
    nets = []
    for before, behind, plane in zip(every[:-1], every[1:], case.plane[1:], strict=True):
        turned = (behind.driving.normal + 1j * behind.driving.inplane) * np.exp(1j * plane)
        normal, inplane = before.driven.normal + turned.real, before.driven.inplane + turned.imag
        nets.append(cross.Couple(normal, inplane, np.zeros(0)))
    return tuple(nets)


def line_couples(
    driving: object, case: line.Line, torque: object, carrier: cross.Carrier = "driving"
) -> tuple[cross.Couples, ...]:
    """Couples of every joint of a line, each with the torque that its own shafts carry at that angle."""
    turning = line.motion(driving, case)
    offsets = np.cumsum(case.offset).reshape(-1, *np.ones(np.ndim(driving), dtype=int))
    given = np.asarray(torque, dtype=float)
    power = given if carrier == "driving" else given * turning.ratio[-1]
    before = [
        power + np.zeros_like(turning.ratio[0]),
        *(power / ratio for ratio in turning.ratio[:-1]),
    ]
    yokes = driving + np.array([0.0 * turning.error[0], *turning.error[:-1]]) + offsets
    triples = zip(yokes, case.angle, before, strict=True)
    return tuple(cross.couples(yoke, angle, carried) for yoke, angle, carried in triples)


def double_cardan(angle: object, torque: object, arrangement: str) -> cross.CoupleHarmonics:
    """Net couple on the intermediate shaft of two equal joints with yokes in line, over x (P).

    Z: none. W: T t sin 2x about the normal, T s (1 - cos 2x) in the plane (x counted in convention N; peak 2 T s).
    """
    bend, given = np.asarray(angle, dtype=float), np.asarray(torque, dtype=float)
    factor = 1.0 if arrangement == "W" else 0.0
    slope, tilt = factor * given * np.tan(bend), factor * given * np.sin(bend)
    return cross.CoupleHarmonics(tilt, 1j * slope, tilt + 0j)


def close(found: object, expected: object, relative: float = 1e-13) -> None:
    np.testing.assert_allclose(
        np.asarray(found, dtype=float), np.asarray(expected, dtype=float), rtol=relative, atol=0.0
    )


def size(couple: cross.Couple) -> np.ndarray:
    return np.hypot(couple.normal, couple.inplane)


def follows(
    history: cross.Couple, closed: cross.CoupleHarmonics, angle: np.ndarray, within: float
) -> None:
    """A couple over the angle is its mean and second harmonic."""
    turn = np.exp(2j * angle)
    np.testing.assert_allclose(history.normal, (closed.normal * turn).real, rtol=0.0, atol=within)
    np.testing.assert_allclose(
        history.inplane, closed.mean + (closed.inplane * turn).real, rtol=0.0, atol=within
    )


def test_liu_2023_couples_at_eight_degrees_and_its_corrected_torque() -> None:
    expected = {key: float(value) for key, value in ORACLES["liu2023_r8_alpha30_T800"].items()}
    angle = np.radians(8.0)
    found = cross.couples(np.radians(30.0), angle, 800.0, convention="N")
    close(
        [-found.driving.yoke, found.driven.yoke, found.driven_torque],
        [expected[key] for key in ("M1", "M2", "T2")],
    )
    close(size(found.driving), -expected["M1"])
    close(size(found.driven), -expected["M2"])
    zero, quarter = (cross.couples(x, angle, 800.0, convention="N") for x in (0.0, np.pi / 2.0))
    close([zero.driving.yoke, zero.driven_torque], [expected["M1_max"], expected["T2_max"]])
    close([-quarter.driven.yoke, quarter.driven_torque], [expected["M2_max"], expected["T2_min"]])
    printed = (1.0 - (np.sin(angle) * np.cos(np.radians(30.0))) ** 2) / np.cos(angle) * 800.0
    close(printed, expected["T2_printed_wrong"])
    assert abs(printed - found.driven_torque) > 7.0


@pytest.mark.parametrize("degrees", [3, 5, 8, 10, 15, 20, 30])
def test_harmonics_of_unit_torque_agree_with_the_reference_values(degrees: int) -> None:
    expected, (driving, driven) = (
        ORACLES[f"joint_{degrees}"],
        cross.couple_harmonics(np.radians(degrees), 1.0),
    )
    close([driving.mean, np.abs(driven.normal)], [expected["tan_b_over_2"]] * 2)
    close([driven.mean, np.abs(driven.inplane)], [expected["sin_b_over_2"]] * 2)


def turn(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    return np.cos(angle) * vector + np.sin(angle) * np.cross(axis, vector)


@pytest.mark.parametrize("convention", ["P", "N"])
@pytest.mark.parametrize("carrier", CARRIERS)
def test_couple_stands_square_to_both_pins_of_the_cross(
    carrier: cross.Carrier, convention: cross.Convention
) -> None:
    rng = np.random.default_rng(1)
    for _ in range(300):
        normal, first = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        angle, driving = rng.uniform(0.01, 1.4), rng.uniform(-9.0, 9.0)
        second = np.cos(angle) * first + np.sin(angle) * np.cross(normal, first)
        zero, start = (
            (normal, np.cross(second, normal))
            if convention == "N"
            else (np.cross(first, normal), -normal)
        )
        pin = np.cos(driving) * zero + np.sin(driving) * np.cross(first, zero)
        driven_pin = np.cross(second, pin)
        driven_pin *= np.sign(
            driven_pin
            @ turn(start, second, driving + cross.transfer(driving, angle, convention).error)
        )
        square = np.cross(pin, driven_pin)
        along = square / (square @ (first if carrier == "driving" else second)) * 3.0
        found = cross.couples(driving, angle, 3.0, carrier, convention)
        scale = 1e-14 * np.linalg.norm(along)
        assert abs(found.driving_torque - along @ first) < scale
        assert abs(found.driven_torque - along @ second) < scale
        assert abs(found.driving.normal + along @ normal) < scale
        assert abs(found.driving.inplane + along @ np.cross(first, normal)) < scale
        assert abs(found.driven.normal - along @ normal) < scale
        assert abs(found.driven.inplane - along @ np.cross(second, normal)) < scale
        assert abs(found.driving.yoke + along @ np.cross(first, pin)) < scale
        bar = driven_pin / np.linalg.norm(driven_pin)
        assert abs(found.driven.yoke - along @ np.cross(second, bar)) < scale
        assert abs(along @ driven_pin) < scale


@pytest.mark.parametrize("convention", ["P", "N"])
@pytest.mark.parametrize("carrier", CARRIERS)
def test_fixed_axes_hold_a_mean_and_a_second_harmonic_only(
    carrier: cross.Carrier, convention: cross.Convention
) -> None:
    x, angle = np.linspace(0.0, 7.0, 71), 0.7
    found = cross.couples(x, angle, 5.0, carrier, convention)
    own = x if carrier == "driving" else x + cross.transfer(x, angle, convention).error
    closed = cross.couple_harmonics(angle, 5.0, carrier, convention)
    for history, part in zip((found.driving, found.driven), closed, strict=True):
        follows(history, part, own, 2e-14)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_torque_varies_along_a_line_as_speed_does_inversely(carrier: cross.Carrier) -> None:
    x, case = (
        np.linspace(0.0, 6.0, 31),
        line.line_of([0.3, 0.5, 0.2], [0.0, 0.4, 1.0], [0.1, 0.7, -0.3]),
    )
    every, turning = line_couples(x, case, 4.0, carrier), line.motion(x, case)
    close(
        [each.driven_torque * speed for each, speed in zip(every, turning.ratio, strict=True)],
        every[0].driving_torque + np.zeros((3, 1)),
        1e-14,
    )
    close(every[0].driving_torque if carrier == "driving" else every[-1].driven_torque, 4.0, 1e-14)


@pytest.mark.parametrize(("plane", "arrangement"), [(np.pi, "Z"), (0.0, "W")])
def test_intermediate_shaft_is_free_of_couple_in_z_and_bears_twice_in_w(
    plane: float, arrangement: str
) -> None:
    x, angle, torque = np.linspace(0.0, 6.0, 61), 0.4, 7.0
    case = line.line_of([angle, angle], [0.0, plane], [0.0, plane])
    (net,) = intermediate_couples(x, case, torque)
    follows(net, double_cardan(angle, torque, arrangement), x, 1e-14)
    peak = intermediate_couples(np.array(0.0), case, torque)[0].inplane
    assert abs(peak - (2.0 * torque * np.sin(angle) if arrangement == "W" else 0.0)) < 1e-14


def test_moments_of_a_whole_line_in_space_balance() -> None:
    """Driving torque, net couples of the intermediate shafts and end couples sum to the driven torque in space."""
    rng = np.random.default_rng(2)
    for _ in range(50):
        angles, planes, phases = (
            rng.uniform(0.05, 0.9, 3),
            rng.uniform(-3, 3, 3),
            rng.uniform(-3, 3, 3),
        )
        planes[0], driving = 0.0, rng.uniform(-3, 3)
        case = line.line_of(angles, planes, phases)
        every = line_couples(driving, case, 2.0)
        nets = intermediate_couples(driving, case, 2.0)
        normal, shaft = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        total = -in_space(every[0].driving, shaft, normal) + every[0].driving_torque * shaft
        for rank, angle in enumerate(angles):
            if rank:
                normal = np.cos(planes[rank]) * normal + np.sin(planes[rank]) * np.cross(
                    shaft, normal
                )
            shaft = np.cos(angle) * shaft + np.sin(angle) * np.cross(normal, shaft)
            if rank < 2:
                total = total - in_space(nets[rank], shaft, normal)
        expected = in_space(every[-1].driven, shaft, normal) + every[-1].driven_torque * shaft
        np.testing.assert_allclose(total, expected, rtol=0.0, atol=1e-13)


def in_space(couple: cross.Couple, shaft: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return couple.normal * normal + couple.inplane * np.cross(shaft, normal)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_couples_at_almost_ninety_degrees_do_the_work_of_the_torques(
    carrier: cross.Carrier,
) -> None:
    angle, x = np.radians(89.99), np.linspace(-4.0, 4.0, 101)
    found = cross.couples(x, angle, 1.0, carrier)
    assert np.all(np.isfinite(size(found.driving)))
    close(found.driven_torque * cross.transfer(x, angle).ratio, found.driving_torque, 1e-14)
    close(
        np.hypot(found.driving_torque, size(found.driving)),
        np.hypot(found.driven_torque, size(found.driven)),
    )
