"""Mean and fundamental of piecewise linear torques of a cosine, against quadrature of 30 digits; all amplitudes."""

import math
from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import mpmath
import numpy as np
import pytest

from torsion.kernels.amplitude_equation import amplitudes
from torsion.kernels.describing_functions import PiecewiseCoupling, Slider, ramp, slider

PI = mpmath.pi


@pytest.fixture(autouse=True)
def _digits() -> Iterator[None]:
    with mpmath.workdps(30):
        yield


def moments(torque, breaks):
    """Mean, and the coefficients of cosine and of -sine, of torque(phi) of a whole cycle by Gauss-Legendre pieces."""
    at = sorted({mpmath.mpf(0), 2 * PI, *breaks, *(2 * PI - one for one in breaks)})
    parts = [mpmath.linspace(a, b, 4) for a, b in pairwise(at)]

    torque = cache(torque)  # of the same angles for each of the three

    def over(factor):
        return sum(
            mpmath.quad(lambda phi: torque(phi) * factor(phi), part, method="gauss-legendre")
            for part in parts
        )

    return over(lambda phi: 1) / (2 * PI), over(mpmath.cos) / PI, -over(mpmath.sin) / PI


@pytest.mark.parametrize("level", [-0.99999999, -0.999, -0.6, -1e-9, 0.0, 0.3, 0.9999])
def test_mean_and_fundamental_of_a_ramp(level: float) -> None:
    amplitude = 0.3
    offset = level * amplitude
    exact = mpmath.mpf(offset) / mpmath.mpf(amplitude)
    known = moments(
        lambda phi: max(mpmath.mpf(offset) + mpmath.mpf(amplitude) * mpmath.cos(phi), 0),
        [mpmath.acos(-exact)],
    )
    mean, share, _ = ramp(np.array(offset), np.array(amplitude))
    assert float(mean) == pytest.approx(float(known[0]), rel=1e-14)
    assert float(share) == pytest.approx(float(known[1] / mpmath.mpf(amplitude)), rel=1e-14)


def test_a_ramp_that_never_ends_is_linear_to_the_last_digit() -> None:
    mean, share, time = ramp(np.array([0.2, -0.2]), np.array([0.1, 0.1]))
    assert (mean.tolist(), share.tolist(), time.tolist()) == ([0.2, 0.0], [1.0, 0.0], [1.0, 0.0])


@pytest.mark.parametrize(
    ("amplitude", "torque", "stiffness", "half"),
    [(1e-3, 5.0, 5e4, 0.0), (2.0, 5.0, 5e4, 0.0), (0.01, 5.0, 5e4, 0.004), (1.0, 5.0, 3e2, 0.02)],
)
def test_the_loop_of_a_slider_behind_a_play(
    amplitude: float, torque: float, stiffness: float, half: float
) -> None:
    size, most, k, h = (mpmath.mpf(one) for one in (amplitude, torque, stiffness, half))
    ends = most / k, most / k + 2 * h, 2 * most / k + 2 * h

    def loop(phi):  # down from the largest twist, and up again with the sign turned
        down = size * (1 - mpmath.cos(phi if phi <= PI else phi - PI))
        value = most - k * (min(down, ends[0]) - min(down, ends[1]) + min(down, ends[2]))
        return value if phi <= PI else -value

    turns = [mpmath.acos(1 - end / size) for end in ends]
    _, stored, lost = moments(loop, [*turns, PI, *(PI - one for one in turns)])
    found = slider(np.array([amplitude]), torque, stiffness, half)[0]
    assert found.real == pytest.approx(float(stored / size), rel=1e-13)
    assert found.imag == pytest.approx(float(lost / size), rel=1e-14)
    assert math.pi * found.imag * amplitude**2 == pytest.approx(
        4.0 * torque * (amplitude - half - torque / stiffness), rel=1e-13
    )  # the area of the loop


def test_the_loop_of_a_slider_is_continuous_where_slipping_begins() -> None:
    most = 0.004 + 5.0 / 5e4
    before, after = slider(np.array([most, most * (1.0 + 1e-12)]), 5.0, 5e4, 0.004)
    assert after == pytest.approx(before, rel=1e-9)


COUPLINGS = {
    "play": (
        PiecewiseCoupling(3e4, 0.01),
        lambda u: 3e4 * (max(u - mpmath.mpf(0.01), 0) - max(-u - mpmath.mpf(0.01), 0)),
    ),
    "stages": (
        PiecewiseCoupling(900.0, 0.0, ((0.02, 4e3), (0.05, 2e4))),
        lambda u: (
            900 * u
            + sum(
                k * (max(u - mpmath.mpf(b), 0) - max(-u - mpmath.mpf(b), 0))
                for b, k in ((0.02, 4000), (0.05, 20000))
            )
        ),
    ),
}


@pytest.mark.parametrize("name", list(COUPLINGS))
@pytest.mark.parametrize(
    ("mean", "amplitude"), [(7.0, 1e-3), (7.0, 0.004), (50.0, 0.03), (2.0, 0.2), (0.0, 0.06)]
)
def test_a_coupling_carries_its_mean_torque_and_answers_at_the_fundamental(
    name: str, mean: float, amplitude: float
) -> None:
    coupling, torque = COUPLINGS[name]
    at, size = coupling.bias(np.array([amplitude]), np.array([mean])), mpmath.mpf(amplitude)
    twist = mpmath.mpf(float(at[0]))
    begins = [side * mpmath.mpf(begin) for begin, _ in coupling.springs for side in (1, -1)]
    breaks = [mpmath.acos((b - twist) / size) for b in begins if abs(b - twist) < size]
    carried, stored, lost = moments(lambda phi: torque(twist + size * mpmath.cos(phi)), breaks)
    assert float(carried) == pytest.approx(mean, rel=1e-12, abs=1e-11)
    one = coupling.secant(np.array([amplitude]), np.array([mean]))
    stiffness = coupling.stiffness * one.share[0] + one.extra[0]
    assert stiffness.real == pytest.approx(float(stored / size), rel=1e-12)
    assert stiffness.imag == 0.0
    assert abs(float(lost)) < 1e-20


def test_a_play_is_closed_to_the_last_digit_below_the_mean_torque() -> None:
    coupling, mean = PiecewiseCoupling(3e4, 0.01), np.array([7.0, 7.0])
    assert coupling.first(mean) == pytest.approx(7.0 / 3e4, rel=1e-12)
    share = coupling.secant(np.array([0.999, 1.001]) * 7.0 / 3e4, mean).share
    assert share[0] == 1.0
    assert share[1] < 1.0


def test_a_play_without_mean_torque_is_open_until_it_is_filled_and_stiff_beyond() -> None:
    coupling, none = PiecewiseCoupling(3e4, 0.01), np.zeros(3)
    share = coupling.secant(np.array([0.0099, 0.0101, 1e4]), none).share
    assert share[0] < 1e-11
    assert 0.0 < share[1] < 1e-2
    assert share[2] == pytest.approx(1.0 - 4.0 * 0.01 / (math.pi * 1e4), rel=1e-12)


def test_friction_does_not_carry_a_mean_torque() -> None:
    coupling = PiecewiseCoupling(900.0, sliders=(Slider(5.0, 9e4),))
    assert coupling.bias(np.array([0.1]), np.array([9.0]))[0] == 0.01


def test_every_solution_is_found_also_those_in_a_dip_between_two_samples() -> None:
    roots = np.array(
        [[1e-6, 0.3, 0.3004], [2e-5, 1e-3, 5.0]]
    )  # two of the first lie between two samples

    def ratio(amplitude, columns):
        x = np.log(amplitude / roots[columns].T)
        return np.exp(np.tanh(x[0]) * np.tanh(x[1]) * np.tanh(x[2]))

    found = amplitudes(ratio, np.full(2, 1e-8), np.full(2, 1e3), np.full(2, 2e-3))
    assert found.number.tolist() == [3, 3]
    assert found.largest == pytest.approx([0.3004, 5.0], rel=1e-12)
    assert found.smallest == pytest.approx([1e-6, 2e-5], rel=1e-12)
    assert found.nearest[1] == pytest.approx(1e-3, rel=1e-12)


def test_without_a_solution_there_is_none() -> None:
    found = amplitudes(
        lambda amplitude, _: amplitude * 0.0 + 2.0,
        np.full(1, 1e-8),
        np.full(1, 1e3),
        np.full(1, 1.0),
    )
    assert (found.number[0], found.largest[0], found.smallest[0]) == (0, 0.0, 0.0)
