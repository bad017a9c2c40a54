"""Orders of a rotation that is known in closed form: a run-up at constant acceleration with known vibrations."""

import numpy as np
import pytest

from torsion.kernels.order_tracking import of_pulses, of_speeds, uneven

BEGIN, ACCELERATION, MARKS = 80.0, 6.0, 60  # rad/s, rad/s2
ORDERS = {1.0: 0.002 * np.exp(0.3j), 2.0: 0.01 * np.exp(-1.0j), 2.5: 0.004 + 0j}


def turned(time: np.ndarray, orders: dict[float, complex]) -> np.ndarray:
    mean = BEGIN * time + ACCELERATION * time**2 / 2.0
    return mean + sum((size * np.exp(1j * order * mean)).real for order, size in orders.items())


def speed(time: np.ndarray, orders: dict[float, complex]) -> np.ndarray:
    mean = BEGIN * time + ACCELERATION * time**2 / 2.0
    rate = sum(
        (1j * order * size * np.exp(1j * order * mean)).real for order, size in orders.items()
    )
    return (BEGIN + ACCELERATION * time) * (1.0 + rate)


def pulses(orders: dict[float, complex], revolutions: int = 200) -> np.ndarray:
    """Times at which the marks pass, by Newton's steps."""
    angle = 2.0 * np.pi * np.arange(MARKS * revolutions) / MARKS + turned(np.zeros(1), orders)
    time = (np.sqrt(BEGIN**2 + 2.0 * ACCELERATION * angle) - BEGIN) / ACCELERATION
    for _ in range(40):
        time = time - (turned(time, orders) - angle) / speed(time, orders)
    return time


def error(found: np.ndarray, expected: dict[float, complex]) -> float:
    """Largest, over the amplitude of that order."""
    sizes = np.abs(list(expected.values()))
    return float((np.abs(np.abs(found) - sizes) / sizes).max())


def test_pulses_of_a_run_up_give_every_amplitude_to_ten_digits() -> None:
    found = of_pulses(pulses(ORDERS), MARKS, np.array(list(ORDERS)), 16)
    assert found.angle.shape == (12, 3)
    assert error(found.angle, ORDERS) < 1e-9


def test_samples_of_the_speed_give_them_to_twelve_digits() -> None:
    time = np.arange(0.0, 12.0, 5e-4)
    assert (
        error(of_speeds(time, speed(time, ORDERS), np.array(list(ORDERS)), 16).angle, ORDERS)
        < 1e-11
    )


def test_the_phase_of_pulses_counts_from_the_first_mark() -> None:
    start = turned(np.zeros(1), ORDERS)[
        0
    ]  # angle at the first mark, from which the mean angle of the fit counts
    found = of_pulses(pulses(ORDERS), MARKS, np.array(list(ORDERS)), 16).angle[0]
    shifted = [size * np.exp(1j * order * start) for order, size in ORDERS.items()]
    assert np.abs(found - shifted).max() < 1e-10


def test_an_order_that_is_not_fitted_leaks_four_digits_below_itself() -> None:
    present = ORDERS | {4.0: 0.01 + 0j}
    found = of_pulses(pulses(present), MARKS, np.array(list(ORDERS)), 16).angle
    assert np.abs(np.abs(found) - np.abs(list(ORDERS.values()))).max() < 2e-4 * 0.01


def test_the_error_at_a_resonance_falls_with_the_square_of_the_window() -> None:
    """An amplitude that bends over the window is averaged: error ~ (window)^2 of its curvature."""

    def resonance(time: np.ndarray) -> np.ndarray:
        mean = BEGIN * time + ACCELERATION * time**2 / 2.0
        here = BEGIN + ACCELERATION * time
        size = 0.01 / np.sqrt(1.0 + ((here - 120.0) / 12.0) ** 2)
        rate = -size * np.sin(2.0 * mean) * 2.0 * here
        drift = -0.01 * (here - 120.0) / 144.0 * (size / 0.01) ** 3 * ACCELERATION
        return here + rate + drift * np.cos(2.0 * mean)

    time, errors = np.arange(0.0, 12.0, 5e-4), []
    for revolutions in (32, 16, 8):
        found = of_speeds(time, resonance(time), np.array([2.0]), revolutions)
        exact = 0.01 / np.sqrt(1.0 + ((found.speed - 120.0) / 12.0) ** 2)
        errors.append(float((np.abs(np.abs(found.angle[:, 0]) - exact) / exact).max()))
    assert errors[2] < 2e-3
    assert errors[0] > 8.0 * errors[2]


def test_too_few_samples_are_refused() -> None:
    with pytest.raises(ValueError, match="too few"):
        of_speeds(np.arange(0.0, 4.0, 0.05), np.full(80, 100.0), np.array([1.0, 2.0, 3.0]), 2)


def test_a_run_up_from_rest_is_even_and_a_lost_or_extra_pulse_in_it_is_located() -> None:
    time = np.sqrt(2.0 * (np.arange(400) * 2.0 * np.pi / 8.0 + 0.2) / 60.0)
    assert uneven(time) is None
    assert uneven(np.delete(time, 50)) == 50
    assert uneven(np.insert(time, 50, (time[49] + time[50]) / 2.0)) in (50, 51)


@pytest.mark.parametrize("noise", [1e-6, 1e-5])
def test_amplitude_and_phase_of_pulses_in_noise_are_right_within_their_stated_error(noise) -> None:
    """Seeded jitter of the times, in rad of the shaft: errors stand between 4/5 and 5/4 of what they say."""
    rng, time, orders = np.random.default_rng(4), pulses(ORDERS), np.array(list(ORDERS))
    start = turned(np.zeros(1), ORDERS)[0]
    exact = np.array([size * np.exp(1j * order * start) for order, size in ORDERS.items()])
    apart, stated = [], []
    for _ in range(12):
        jitter = noise * rng.standard_normal(time.size) / speed(time, ORDERS)
        found = of_pulses(time + jitter, MARKS, orders, 16)
        apart.append(found.angle - exact)
        stated.append(found.error)
    share = np.array(apart) / np.array(stated)
    assert np.abs(share).max() < 6.0
    for part in (share.real, share.imag):
        assert 0.8 < np.sqrt(np.square(part).mean()) < 1.25
    assert np.array(stated).mean() == pytest.approx(
        noise * np.sqrt(2.0 * 35.0 / 18.0 / (16 * MARKS)), rel=0.2
    )


def test_the_stated_error_of_speeds_is_that_of_their_noise() -> None:
    rng, time, orders = np.random.default_rng(5), np.arange(0.0, 12.0, 1e-3), np.array(list(ORDERS))
    share = []
    for _ in range(12):
        found = of_speeds(
            time, speed(time, ORDERS) + 0.1 * rng.standard_normal(time.size), orders, 16
        )
        share.append((np.abs(found.angle) - np.abs(list(ORDERS.values()))) / found.error)
    assert 0.8 < np.sqrt(np.square(share).mean()) < 1.25
    assert of_speeds(time, speed(time, ORDERS), orders, 16).error.max() < 1e-9


@pytest.mark.parametrize("run", ["steady", "from rest", "to rest", "up and down"])
def test_every_lost_pulse_is_located_at_the_ends_too(run) -> None:
    """Of 8 marks a revolution; not the first and the last, behind which nothing is known."""
    angle = np.arange(120) * 2.0 * np.pi / 8.0 + 0.1
    rest = np.sqrt(2.0 * angle / 60.0)
    time = {
        "steady": angle / 50.0,
        "from rest": rest,
        "to rest": rest[-1] - rest[::-1],
        "up and down": np.concatenate([rest, 2.0 * rest[-1] + 0.01 - rest[::-1]]),
    }[run]
    assert uneven(time) is None
    for lost in range(1, time.size - 1):
        found = uneven(np.delete(time, lost))
        assert found is not None
        assert abs(found - lost) <= 2  # near rest the intervals beside it differ as much
