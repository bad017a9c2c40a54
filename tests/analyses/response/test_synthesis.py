"""The sum of all lines over the common cycle."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.response.synthesis import common_cycle, extremes, synthesis
from torsion.kernels.trees.tree_response import Status


def _response(orders: list, torque: np.ndarray, mean: np.ndarray | None = None) -> Response:
    """A response of one speed from phasors (lines, spans); an order that is text is a fixed frequency."""
    lines = tuple(
        Line(None, float(order), ()) if isinstance(order, str) else Line(Fraction(order), None, ())
        for order in orders
    )
    blank = np.zeros((1, len(lines)))
    torque = np.asarray(torque, dtype=complex)[None]
    mean = np.zeros((1, torque.shape[2])) if mean is None else mean[None]
    answered = blank.astype(np.uint8)
    return Response(
        np.array([1.0]),
        np.array([True]),
        lines,
        blank,
        torque,
        torque,
        mean,
        blank,
        answered,
        blank,
        None,
    )


@pytest.mark.parametrize("seed", range(6))
def test_half_range_agrees_with_brute_force(seed):
    random = np.random.default_rng(seed)
    harmonics = np.sort(random.choice(np.arange(1, 13), size=random.integers(2, 6), replace=False))
    phasors = random.normal(size=(20, len(harmonics))) + 1j * random.normal(
        size=(20, len(harmonics))
    )
    highest, lowest = extremes(phasors, harmonics)
    angle = np.linspace(0.0, 2 * np.pi, 60001)
    wave = (phasors @ np.exp(1j * np.outer(harmonics, angle))).real
    loss = (
        0.5 * (12 * np.pi / 60000) ** 2 * np.abs(phasors).sum(axis=1)
    )  # that a sample may lie below the extreme
    assert (highest >= wave.max(axis=1) - 1e-12).all()
    assert (highest <= wave.max(axis=1) + loss + 1e-12).all()
    assert (lowest <= wave.min(axis=1) + 1e-12).all()
    assert (lowest >= wave.min(axis=1) - loss - 1e-12).all()


def _densely_sampled(phasors: np.ndarray, harmonics: np.ndarray, number: int = 2**14) -> float:
    """The largest value of one wave: samples, and all that may stand beside the maximum sampled finer, twice."""
    spectrum = np.zeros(number // 2 + 1, dtype=complex)
    spectrum[harmonics] = phasors * number / 2
    value, step = np.fft.irfft(spectrum, number), 2 * np.pi / number
    angle = step * np.arange(number)
    for _ in range(2):
        loss = 0.5 * (harmonics.max() * step / 2) ** 2 * np.abs(phasors).sum()
        near = angle[value >= value.max() - loss]
        step /= 400
        angle = (near[:, None] + step * np.arange(-200, 201)).ravel()
        value = np.concatenate(
            [
                (np.exp(1j * np.outer(t, harmonics)) @ phasors).real
                for t in np.split(angle, len(near))
            ]
        )
    return float(value.max())


def _worst_error(phasors: np.ndarray, harmonics: np.ndarray) -> float:
    """The largest relative error of both extremes of waves (rows, harmonics)."""
    highest, lowest = extremes(phasors, harmonics)
    dense = np.array(
        [[_densely_sampled(one, harmonics), -_densely_sampled(-one, harmonics)] for one in phasors]
    )
    return float(np.abs(np.array([highest, lowest]).T / dense - 1).max())


def test_no_extreme_of_two_to_six_orders_up_to_200_is_too_low():
    random = np.random.default_rng(0)
    for _ in range(300):
        harmonics = np.sort(
            random.choice(np.arange(1, 201), size=random.integers(2, 7), replace=False)
        )
        phasors = random.normal(size=(1, len(harmonics))) + 1j * random.normal(
            size=(1, len(harmonics))
        )
        assert _worst_error(phasors, harmonics) < 1e-12


def test_the_true_one_of_two_near_maxima_is_refined():
    """A parabola is misled by the third derivative: in one of these waves it takes one 2.3e-5 lower."""
    random = np.random.default_rng(2)
    phasors = random.normal(size=(3000, 3)) + 1j * random.normal(size=(3000, 3))
    assert _worst_error(phasors[100:200], np.array([12, 59, 118])) < 1e-12


@pytest.mark.parametrize("excess", [0.0, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("shift", [0.0, 0.0123, 0.049])
def test_maxima_that_almost_coincide_are_told_apart(excess, shift):
    """cos t + b cos 2t with b = -(1 + excess)/4 has two maxima of -b - 1/(8 b) that meet where the excess is zero."""
    b = -(1 + excess) / 4
    phasors = np.array([[1.0, b]]) * np.exp(1j * shift * np.array([1, 2]))
    assert extremes(phasors, np.array([1, 2]))[0][0] == pytest.approx(-b - 1 / (8 * b), rel=1e-14)


@pytest.mark.parametrize(
    ("excess", "shift"),
    [(0.000287721, 0.012367), (0.000158797, 0.04297), (0.001119294, 0.049411), (0.1645888, -9e-5)],
)
def test_a_maximum_at_the_end_of_a_halved_cell_is_kept(excess, shift):
    """The same waves, so placed that a half has its maximum at its end, far above its middle."""
    b = -(1 + excess) / 4
    phasors = np.array([[1.0, b]]) * np.exp(1j * shift * np.array([1, 2]))
    assert extremes(phasors, np.array([1, 2]))[0][0] == pytest.approx(-b - 1 / (8 * b), rel=1e-14)


def test_a_maximum_whose_second_derivative_varies_much_is_found_by_halving():
    """Newton's method from the middle of a cell in which it varies by more than itself errs by 8e-13."""
    phasors = np.array([3.98508533 + 0.37715417j, -0.98413344 - 0.18794027j])
    found = extremes(phasors[None], np.array([1, 2]))[0][0]
    assert found == pytest.approx(_densely_sampled(phasors, np.array([1, 2])), rel=2e-14)


@pytest.mark.parametrize("tilt", [1e-7, 1e-6, 1e-5, 1e-4])
def test_the_higher_of_two_maxima_in_one_step_is_taken(tilt):
    harmonics = np.array([1, 2, 3])
    phasors = np.array([1.0, -0.2502, -1j * tilt])
    for turned in (phasors, phasors.conj()):
        assert extremes(turned[None], harmonics)[0][0] == pytest.approx(
            _densely_sampled(turned, harmonics), rel=1e-13
        )


def test_wave_of_one_order_amid_others_of_nothing():
    """All its maxima are as high; a row of zeros has none."""
    highest, lowest = extremes(
        np.array([[0.0, 0.0, 2j], [0.0, 0.0, 0.0], [1e-9, 0.0, 2.0]]), np.array([1, 7, 118])
    )
    assert highest == pytest.approx([2.0, 0.0, 2.0 + 1e-9], rel=1e-15)
    assert lowest[:2] == pytest.approx([-2.0, 0.0], rel=1e-15)


def test_wave_of_one_order_is_its_amplitude():
    highest, lowest = extremes(np.array([[3.0 + 4.0j], [0.0]]), np.array([7]))
    assert (highest.tolist(), lowest.tolist()) == ([5.0, 0.0], [-5.0, 0.0])
    single = extremes(np.array([[2j]]), np.array([1]))
    assert (single[0].tolist(), single[1].tolist()) == ([2.0], [-2.0])


@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_extremes_grow_with_the_size_of_the_wave(size):
    """cos t + b cos 2t about b = -1/4, where two maxima meet, and below it at its one maximum of 1 + b."""
    b = -np.array([0.1, 0.2, 0.249, 0.2499, 0.25, 0.2501, 0.251, 0.3, 0.5, 2.0])
    shift = np.array([[0.0], [0.0123], [0.049], [0.1], [1.0]])
    phasors = np.stack([np.ones_like(b), b], axis=1) * np.exp(
        1j * shift[:, :, None] * np.array([1, 2])
    )
    highest, lowest = extremes(size * phasors.reshape(-1, 2), np.array([1, 2]))
    two = b < -0.25
    expected = np.where(two, -b - 1 / (8 * np.where(two, b, 1.0)), 1 + b)
    np.testing.assert_allclose(highest, np.tile(size * expected, 5), rtol=2e-15)
    np.testing.assert_allclose(lowest, np.tile(size * (b - 1.0), 5), rtol=2e-15)


@pytest.mark.parametrize(("phasors", "highest"), [([15, -6, 1], 10), ([56, -28, 8, -1], 35)])
def test_a_maximum_flat_to_the_fifth_or_the_seventh_order_is_found(phasors, highest):
    """Of (-1)^(k+1) binomial(2n, n - k) cos k t, which is 2^(2n-1) (1 - sin^2n(t/2)) but for its mean."""
    harmonics = np.arange(1, len(phasors) + 1)
    turned = np.array(phasors) * np.exp(1j * np.outer([0.0, 0.01, 0.05, 3.0], harmonics))
    assert extremes(turned, harmonics)[0] == pytest.approx(np.full(4, highest), rel=4e-15)


def test_the_highest_of_two_maxima_may_lie_between_samples_and_the_other_on_one():
    """Order 64 of 65 has 32.5 samples: every other maximum lies half a step off. Order 1 makes that one the higher."""
    half_step = np.pi / 32 * 64 / 65
    for excess in (1e-4, 1e-3):
        phase = -np.pi / 64 - excess / (
            2 * np.sin(np.pi / 64)
        )  # of order 1, highest beside the second maximum
        phasors = np.array([[0.5 * np.exp(1j * phase), 1.0, 1e-9]])
        assert half_step**2 / 2 > excess
        assert _worst_error(phasors, np.array([1, 64, 65])) < 1e-12


def test_two_orders_at_their_closed_form():
    """cos t + b cos 2t: the largest value is 1 + b, the smallest -b - 1/(8 b) for b > 1/4."""
    highest, lowest = extremes(np.array([[1.0, 0.7]]), np.array([1, 2]))
    assert highest[0] == pytest.approx(1.7, rel=1e-14)
    assert lowest[0] == pytest.approx(-0.7 - 1 / 5.6, rel=1e-14)


def test_half_range_does_not_depend_on_where_the_cycle_starts():
    random = np.random.default_rng(3)
    harmonics = np.array([2, 3, 7])
    phasors = random.normal(size=(1, 3)) + 1j * random.normal(size=(1, 3))
    plain = np.array(extremes(phasors, harmonics))
    turned = np.array(extremes(phasors * np.exp(0.777j * harmonics), harmonics))
    assert turned == pytest.approx(plain, rel=1e-14)


@pytest.mark.parametrize(
    ("orders", "turns", "harmonics"),
    [
        ([Fraction(1, 2), Fraction(1), Fraction(3, 2)], Fraction(2), [1, 2, 3]),
        ([Fraction(6), Fraction(4)], Fraction(1, 2), [3, 2]),
        ([Fraction(40, 21), Fraction(80, 21)], Fraction(21, 40), [1, 2]),
        ([Fraction(2, 3), Fraction(4, 5)], Fraction(15, 2), [5, 6]),
    ],
)
def test_common_cycle_is_the_inverse_of_the_greatest_common_divisor(orders, turns, harmonics):
    found = common_cycle(orders)
    assert found[0] == turns
    assert found[1].tolist() == harmonics


def test_sum_is_true_to_phase_and_not_a_sum_of_magnitudes():
    found = synthesis(_response([1, 3], [[1.0], [1.0 / 9.0]]))
    assert found.half_range[0, 0] == pytest.approx(10 / 9, rel=1e-14)
    found = synthesis(_response([1, 3], [[1.0], [-1.0 / 3.0]]))
    assert found.half_range[0, 0] == pytest.approx(2 * np.sqrt(2) / 3, rel=1e-14)
    assert found.bound[0, 0] == pytest.approx(4 / 3, rel=1e-15)
    assert found.rms[0, 0] == pytest.approx(np.sqrt((1 + 1 / 9) / 2), rel=1e-15)


def test_peak_holds_the_mean_torque_and_its_sign():
    found = synthesis(_response([1, 2], [[1.0], [0.7]], np.array([-5.0])))
    assert found.peak[0, 0] == pytest.approx(5.7 + 1 / 5.6, rel=1e-14)


def test_fixed_frequencies_add_their_magnitude():
    found = synthesis(_response([1, 3, "35"], [[1.0], [1.0 / 9.0], [0.5j]], np.array([2.0])))
    assert found.half_range[0, 0] == pytest.approx(10 / 9 + 0.5, rel=1e-14)
    assert found.peak[0, 0] == pytest.approx(2 + 10 / 9 + 0.5, rel=1e-14)
    assert found.turns == 1


def test_a_cycle_is_too_long_by_its_highest_order():
    """20 000 samples are 625 harmonics."""
    for base in (Fraction(1), Fraction(3, 7)):
        turns, harmonics = common_cycle([base, base * 625])
        assert (turns, harmonics.tolist()) == (1 / base, [1, 625])
        turns, harmonics = common_cycle([base, base * 626])
        assert (turns, harmonics.size) == (0, 0)


def test_lines_of_fixed_frequency_alone_have_no_common_cycle():
    turns, harmonics = common_cycle([])
    assert (turns, harmonics.size) == (0, 0)
    found = synthesis(_response(["35", "40"], [[3.0], [4.0j]], np.array([-2.0])))
    assert (found.turns, found.common_cycle_turns) == (0, None)
    values = [each[0, 0] for each in (found.half_range, found.peak, found.bound, found.rms)]
    assert values == pytest.approx([7.0, 9.0, 7.0, np.sqrt(12.5)], rel=1e-15)


def test_cycle_that_is_too_long_gives_its_bound_and_says_so():
    found = synthesis(_response([Fraction(1), Fraction(1001, 1000)], [[1.0], [0.5j]]))
    assert found.turns == 0
    assert found.half_range[0, 0] == pytest.approx(1.5, rel=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("turning", "torque"), [([1, 2], [1.0, 0.7]), ([1, Fraction(1001, 1000)], [1.0, 0.5j])]
)
def test_peak_is_that_of_the_side_on_which_the_mean_torque_stands(sign, turning, torque):
    """1.7 above and 0.7 + 1/5.6 below the mean; 1.5 on both sides where the cycle is too long. 0.4 at 35 Hz."""
    found = synthesis(
        _response([*turning, "35"], [[one] for one in [*torque, 0.4]], np.array([3.0 * sign]))
    )
    above, below = (1.7, 0.7 + 1 / 5.6) if turning == [1, 2] else (1.5, 1.5)
    assert found.peak[0, 0] == pytest.approx(3.4 + (above if sign > 0 else below), rel=1e-14)
    assert found.half_range[0, 0] == pytest.approx((above + below) / 2 + 0.4, rel=1e-14)


def test_every_span_and_speed_has_its_own_sum():
    """Orders 1 and 3 in two spans at three speeds: 1 + b where they add, and the plain sum at every other phase."""
    share = np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]])  # (speeds, spans)
    torque = np.stack([np.ones((3, 2)), share], axis=1) * np.array(
        [[[1.0, 2.0]], [[3.0, 4.0]], [[5.0, 6.0]]]
    )
    one = _response([1, 3], torque[0])
    blank = np.zeros((3, 2))
    whole = replace(
        one,
        speed=np.arange(3.0),
        torque=torque.astype(complex),
        mean=np.zeros((3, 2)),
        status=blank,
    )
    found = synthesis(whole)
    size = torque[:, 0]
    assert found.half_range == pytest.approx(size * (1 + share), rel=1e-14)
    assert found.peak == pytest.approx(size * (1 + share), rel=1e-14)
    assert found.bound == pytest.approx(size * (1 + share), rel=1e-14)
    assert found.rms == pytest.approx(size * np.sqrt((1 + share**2) / 2), rel=1e-14)
    assert found.turns == 1


@pytest.mark.parametrize("status", [Status.NEAR_SINGULAR, Status.SINGULAR])
def test_line_that_is_not_ok_leaves_no_finite_number(status):
    response = _response([1, 2], [[1.0], [1e15]])
    found = synthesis(replace(response, status=np.array([[Status.OK, status]], dtype=np.uint8)))
    assert np.isinf([found.half_range, found.peak, found.rms, found.bound]).all()


def test_line_without_a_value_leaves_no_finite_number():
    found = synthesis(_response([1, 2], [[1.0, np.nan], [0.7, 1.0]]))
    assert np.isfinite(found.half_range[0, 0])
    assert np.isinf(found.half_range[0, 1])
    assert np.isinf(found.rms[0, 1])
    assert np.isinf(found.peak[0, 1])


@pytest.mark.parametrize("orders", [[1], [1, 2], [1, "3"], []])
def test_sum_over_a_train_without_spans_has_none(orders):
    found = synthesis(_response(orders, np.empty((len(orders), 0))))
    assert found.half_range.shape == found.peak.shape == found.rms.shape == (1, 0)
