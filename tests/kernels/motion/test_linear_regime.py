"""One linear motion against closed forms: its states, and the first event in a block of it."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from torsion.kernels.motion.linear_regime import BLOCK, PARTS, RADIANS, Regime, fastest


def turning(*w: float) -> np.ndarray:
    """(states, states) of pairs that turn: (cos wt, sin wt) from (1, 0)."""
    found = np.zeros((2 * len(w), 2 * len(w)))
    for k, one in enumerate(w):
        found[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [[0.0, -one], [one, 0.0]]
    return found


def regime(matrix: np.ndarray, *events: np.ndarray) -> Regime:
    """With steps for the fastest motion."""
    none, step = (
        np.zeros((0, len(matrix))),
        RADIANS / float(np.abs(np.linalg.eigvals(matrix)).max()),
    )
    return Regime(matrix, np.array(events).reshape(-1, len(matrix)), none, none, step)


@pytest.mark.parametrize("parts", [0.0, 0.3, 1.0, 5.7, 63.999, 64.0, 200.5, 255.0, 256.0])
def test_states_are_those_of_the_closed_form(parts: float) -> None:
    w = np.array([1e3, 37.0, 0.01])
    one = regime(turning(*w))
    time = parts * one.part
    known = np.stack([np.cos(w * time), np.sin(w * time)], axis=1).ravel()
    start = np.array([1.0, 0.0] * 3)
    assert one.after(start, time) == pytest.approx(known, abs=2e-16 * (10.0 + parts))
    assert one.moved(start[:, None], np.array([time]))[:, 0] == pytest.approx(
        known, abs=2e-16 * (10.0 + parts)
    )
    assert one.over_step(start)[4] == pytest.approx(math.cos(0.01 * one.step), abs=1e-16)


@pytest.mark.parametrize("parts", [0.4, 3.5, 15.99, 16.01, 63.5, 64.5, 255.9])
def test_an_event_anywhere_in_a_block_is_met_to_rounding(parts: float) -> None:
    matrix = np.zeros((5, 5))
    matrix[:4, :4] = turning(800.0, 1.0)
    one = regime(matrix, np.zeros(5))
    time = parts * one.part
    row = np.array([0.0, 0.0, 0.0, -1.0, math.sin(time)])  # sin(time) - sin(t)
    one = regime(matrix, np.array([0.0, 0.0, 0.0, 0.0, 1.0]), row)
    start = np.array([1.0, 0.0, 1.0, 0.0, 1.0])
    found = one.first_event(start, BLOCK * one.part)
    assert found == (pytest.approx(time, rel=1e-13), 1)
    assert one.first_event(start, 0.999 * time) is None
    assert one.first_event(start, time * (1.0 + 1e-12)) is not None


@pytest.mark.parametrize(
    "shares", [(0.4, 0.6, -0.05), (0.3, 0.31, -0.05), (0.5, 0.5001, -0.2), (0.4, 0.6, 1.05)]
)
def test_a_double_crossing_within_a_part_is_met_however_the_function_goes_at_its_ends(
    shares,
) -> None:
    """sin(w (t - a)) sin(w (t - b)) sin(w (t - c)) of the motions w and 3 w, falling or rising at both ends."""
    w = 10.0
    one = regime(turning(w, 3.0 * w))
    a, b, c = (w * share * one.part for share in shares)
    sign = 1.0 if shares[2] < 0.0 else -1.0
    row = np.zeros(4)  # sin(nwt - p) = cos p * sin - sin p * cos
    for phase, place, factor in (
        (a + b - c, 0, 1),
        (b + c - a, 0, 1),
        (c + a - b, 0, 1),
        (a + b + c, 2, -1),
    ):
        row[place : place + 2] += (
            0.25 * factor * sign * np.array([-math.sin(phase), math.cos(phase)])
        )
    one = regime(turning(w, 3.0 * w), row)
    found = one.first_event(np.array([1.0, 0.0, 1.0, 0.0]), one.part)
    assert found == (
        pytest.approx(shares[0] * one.part, rel=1e-14 / (shares[1] - shares[0]) ** 1.5),
        0,
    )


def test_of_two_functions_that_fall_in_one_part_the_first_is_met() -> None:
    one = regime(turning(10.0))
    ends = [math.cos(10.0 * share * one.part) for share in (0.7, 0.6, 0.8)]
    matrix = np.zeros((3, 3))
    matrix[:2, :2] = turning(10.0)
    one = regime(matrix, *(np.array([1.0, 0.0, -end]) for end in ends))
    found = one.first_event(np.array([1.0, 0.0, 1.0]), BLOCK * one.part)
    known = brentq(lambda t: math.cos(10.0 * t) - ends[1], 0.0, one.part, xtol=1e-18)
    assert found == (pytest.approx(known, rel=1e-13), 1)
    assert one.part * PARTS == one.step


def test_the_spectral_radius_is_bounded_closely() -> None:
    rng = np.random.default_rng(4)
    for size in (1, 2, 7, 40):
        for _ in range(20):
            matrix = rng.normal(size=(size, size)) * 10.0 ** rng.uniform(-9.0, 9.0)
            for one in (matrix, matrix - matrix.T, np.diag(np.diag(matrix))):
                known = float(np.abs(np.linalg.eigvals(one)).max())
                assert known * (1.0 - 1e-13) <= fastest(one) <= known * size ** (1.0 / 64.0) * 1.15
    assert (
        fastest(np.array([[0.0, 1e9], [0.0, 0.0]]))
        == fastest(np.zeros((3, 3)))
        == fastest(np.zeros((0, 0)))
        == 0.0
    )
