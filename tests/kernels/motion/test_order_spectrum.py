"""Samples at equal angles as orders: a cosine has its own phasor, and the angles are met."""

import numpy as np
import pytest

from torsion.kernels.motion.order_spectrum import hann, phasors, phasors_of, times_at

SAMPLES, TURNS = 64, 8
FIRST = np.array([0.3, 17.0, 4000.5])  # rad
ANGLE = FIRST[:, None] + np.arange(SAMPLES * TURNS) * 2.0 * np.pi / SAMPLES


@pytest.mark.parametrize("order", [0.5, 2.0, 3.125, 9.875])
def test_a_cosine_of_a_whole_number_of_cycles_in_the_window_has_its_amplitude_and_phase(
    order: float,
) -> None:
    wanted = 3.7 * np.exp(0.4j)
    values = 5.0 + (wanted * np.exp(1j * order * ANGLE)).real
    every = phasors(values, FIRST, TURNS, 12 * TURNS)
    assert every[:, 0] == pytest.approx(5.0, rel=1e-14)
    assert (
        np.abs(every[:, round(order * TURNS)] - wanted).max() < 1e-11
    )  # angles of 4000 rad are so sharp
    assert np.abs(phasors_of(values, FIRST, TURNS, np.array([order]))[:, 0] - wanted).max() < 1e-11
    beside = np.abs(every[:, round(order * TURNS) + 1])
    assert beside == pytest.approx(3.7 / 2.0, rel=1e-12)  # the shoulder of Hann's window
    far = np.delete(every, np.arange(round(order * TURNS) - 1, round(order * TURNS) + 2), axis=1)[
        :, 1:
    ]
    assert np.abs(far[:, 1:]).max() < 1e-11 if order > 0.5 else True


def leakage(off: np.ndarray, revolutions: int) -> np.ndarray:
    """H of the module's text, of a difference of orders, for samples without number."""
    x = off * revolutions
    return np.sinc(x) / (1.0 - x * x)


@pytest.mark.parametrize("order", [2.03, 5.55])
def test_other_orders_leak_as_the_window_does(order: float) -> None:
    wanted, at = 2.0 * np.exp(-1.1j), np.array([2.0, 2.03, 2.3, 5.5, 7.0])
    values = (wanted * np.exp(1j * order * ANGLE)).real
    middle = FIRST[:, None] + np.pi * TURNS
    main, image = (
        c * leakage(at - sign * order, TURNS) * np.exp(1j * (sign * order - at) * middle)
        for c, sign in ((wanted, 1.0), (wanted.conjugate(), -1.0))
    )
    found = phasors_of(values, FIRST, TURNS, at)
    assert np.abs(found - main - image).max() < 1e-4  # of samples without number, and here are 64
    finer = FIRST[:, None] + np.arange(64 * SAMPLES * TURNS) * 2.0 * np.pi / SAMPLES / 64
    found = phasors_of((wanted * np.exp(1j * order * finer)).real, FIRST, TURNS, at)
    assert np.abs(found - main - image).max() < 3e-8  # the error falls with the square


def test_the_window_has_mean_1() -> None:
    assert hann(512).mean() == pytest.approx(1.0, rel=1e-15)


def test_times_at_equal_angles_of_a_vibrating_shaft_that_speeds_up_from_rest() -> None:
    def turned(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return 20.0 * time**2 - 0.02 * np.cos(60.0 * time), 40.0 * time + 1.2 * np.sin(60.0 * time)

    time = np.linspace(0.0, 5.0, 200)  # coarse: two and a half samples to a period of the vibration
    angle = turned(time)[0]
    wanted = np.linspace(angle[0], angle[-1], 3000)
    found, speed = times_at(wanted, time, angle, turned)
    assert np.abs(turned(found)[0] - wanted).max() < 1e-12 * angle[-1]
    assert speed == pytest.approx(turned(found)[1], rel=1e-15)
    assert (np.diff(found) > 0.0).all()
