"""Torque laws of a single disc against closed forms: waves that begin late, and machines that turn backward."""

import math

import numpy as np
import pytest
from tests.kernels.motion.test_collocation import one_disc

from torsion.kernels.motion import torque_laws as laws

INERTIA, SYNCHRONOUS = 2.0, 50.0 * math.pi


@pytest.mark.parametrize("phase", [0.0, 0.9])
def test_a_pulsation_counts_its_phase_from_the_time_at_which_it_begins(phase: float) -> None:
    """4 cos(phase + w (t - t_0)) from t_0 on: its integral is a sine."""
    begin, w = 0.3, 7.0
    _, speed = one_disc(
        INERTIA, [laws.Wave(0, laws.constant(4.0), 0.0, phase, 1j * w, laws.Window(begin))], 1.0
    )
    for time in (0.2, begin, 0.55, 1.0):
        late = max(time - begin, 0.0)
        exact = 4.0 * (math.sin(phase + w * late) - math.sin(phase)) / (INERTIA * w)
        assert speed(time) == pytest.approx(exact, rel=1e-12, abs=1e-14)


def test_an_order_counts_its_phase_from_the_angle_at_which_it_begins() -> None:
    """Work over the angle: J (v^2 - v_0^2)/2 = A (sin(phase + m angle) - sin phase)/m, of the angle since the begin."""
    order, phase, begin, first = 3.0, 0.4, 0.25, 40.0
    wave = laws.Wave(0, laws.constant(9.0), order, phase, 0.0, laws.Window(begin), from_begin=True)
    _, speed = one_disc(INERTIA, [wave], 1.0, first)
    times = np.linspace(begin, 1.0, 4001)
    speeds = np.array([speed(time) for time in times])
    angle = np.concatenate([[0.0], np.cumsum((speeds[1:] + speeds[:-1]) / 2.0 * np.diff(times))])
    work = 9.0 * (np.sin(phase + order * angle) - math.sin(phase)) / order
    np.testing.assert_allclose(
        INERTIA * (speeds**2 - first**2) / 2.0, work, atol=2e-4 * np.abs(work).max()
    )


@pytest.mark.parametrize("first", [150.0, -150.0])
def test_a_brake_by_the_square_of_the_speed_brakes_in_both_senses(first: float) -> None:
    """J v' = -c v |v|: v = v_0/(1 + c |v_0| t/J)."""
    _, speed = one_disc(
        50.0, [laws.BySpeed(0, laws.quadratic(-0.02 * 100.0**2, 100.0))], 10.0, first
    )
    assert speed(10.0) == pytest.approx(first / (1.0 + 0.02 * abs(first) * 10.0 / 50.0), rel=1e-13)


def test_a_table_goes_on_with_its_first_line_below_its_first_row() -> None:
    """A motor of 10 - 4 v up to 1 rad/s and 6 beyond, turned backward at 3 rad/s: v = 2.5 - 5.5 exp(-2 t)."""
    _, speed = one_disc(
        INERTIA, [laws.BySpeed(0, laws.table([(0.0, 10.0), (1.0, 6.0), (5.0, 6.0)]))], 0.6, -3.0
    )
    for time in (0.1, 0.3, 0.6):
        assert speed(time) == pytest.approx(2.5 - 5.5 * math.exp(-2.0 * time), rel=1e-12)


def test_a_mirrored_table_is_odd_or_even_in_the_speed() -> None:
    rows = [(0.0, 3.0), (10.0, 5.0), (30.0, -2.0)]
    for sign in (-1.0, 1.0):
        parts = laws.table(laws.mirrored([(0.0, 0.0), *rows[1:]] if sign < 0 else rows, sign=sign))
        for speed in (2.0, 10.0, 17.0, 29.0):
            forward, backward = (
                parts.value(parts.part(one), np.array([one]))[0][0] for one in (speed, -speed)
            )
            assert backward == pytest.approx(sign * forward, rel=1e-14)


def test_an_induction_motor_that_turns_backward_is_plugged() -> None:
    """From slip 2 to standstill: t = J w_s/(2 M s_k) ((s_1^2 - s_2^2)/2 + s_k^2 ln(s_1/s_2)), s_1 = 2, s_2 = 1."""
    pull_out, slip = 900.0, 0.2
    time = 12.0 * SYNCHRONOUS / (2.0 * pull_out * slip) * (1.5 + slip**2 * math.log(2.0))
    _, speed = one_disc(
        12.0, [laws.InductionMotor(0, pull_out, slip, SYNCHRONOUS)], time, -SYNCHRONOUS
    )
    assert abs(speed(time)) < 1e-12 * SYNCHRONOUS
