"""The lumped pump train: the article's complex and real steps, in time and through the gears, beside the program."""

import numpy as np
import pytest

CLOSE = 1e-11  # of each frequency's largest value


def by_line(found: np.ndarray, truth: np.ndarray) -> float:
    return float((np.abs(found - truth).max(axis=0) / np.abs(truth).max(axis=0)).max())


@pytest.fixture(scope="module")
def pump(paper):
    return paper["pump_lumped"]


@pytest.fixture(scope="module")
def ten(pump, paper):
    """(10) at every frequency of the program's answer."""
    return pump.dense(paper["pump_steps"].complex_steps, pump.frequencies_of(pump.found()))


def test_complex_and_real_equations_have_one_answer(pump, paper, ten) -> None:
    fifteen = pump.dense(paper["pump_steps"].real_steps, pump.frequencies_of(pump.found()))
    assert by_line(fifteen.angle, ten.angle) < CLOSE


def test_program_gives_the_complex_amplitudes_of_10(pump, ten) -> None:
    ours = pump.program(pump.found())
    assert by_line(ours.angle, ten.angle) < CLOSE
    assert by_line(ours.torque, ten.torque) < 10 * CLOSE


def test_amplitudes_in_time_satisfy_the_equation_of_motion(pump, paper) -> None:
    frequencies, ours = pump.frequencies_of(pump.found()), pump.program(pump.found())
    for k in range(0, frequencies.size, 40):
        w = 2.0 * np.pi * frequencies[k]
        cycle = np.linspace(0.0, 2.0 * np.pi / w, 33)
        assert paper["pump_steps"].imbalance(pump.chain(), ours.angle[:, k], w, cycle) < 1e-12


def test_angle_in_time_is_cosine_less_sine(paper) -> None:
    """(16), (17): A_c cos wt - A_i sin wt has the amplitude |A*| and the phase atan2(A_i, A_c)."""
    amplitude, w, time = np.array([0.3 - 0.4j]), 7.0, np.linspace(0.0, 2.0, 50)
    angle, speed, gain = paper["pump_steps"].in_time(amplitude, w, time)
    np.testing.assert_allclose(
        angle[0], 0.3 * np.cos(w * time) + 0.4 * np.sin(w * time), rtol=0.0, atol=1e-15
    )
    np.testing.assert_allclose(
        angle[0], 0.5 * np.cos(w * time + np.arctan2(-0.4, 0.3)), rtol=0.0, atol=1e-15
    )
    np.testing.assert_allclose(
        speed[0], w * (0.4 * np.cos(w * time) - 0.3 * np.sin(w * time)), rtol=0.0, atol=1e-14
    )
    np.testing.assert_allclose(gain, -w * w * angle, rtol=0.0, atol=1e-14)


def test_equation_18_leaves_out_the_torque_of_the_damper(pump, paper, ten) -> None:
    steps, frequencies = paper["pump_steps"], pump.frequencies_of(pump.found())
    program = np.abs(pump.program(pump.found()).torque)
    lacking = 0.0
    for k in range(0, frequencies.size, 40):
        w, amplitude = 2.0 * np.pi * frequencies[k], ten.angle[:, k]
        np.testing.assert_allclose(
            program[:, k], steps.section_right(pump.chain(), amplitude, w), rtol=1e-8
        )
        lacking = max(
            lacking,
            float((1.0 - steps.section_printed(pump.chain(), amplitude) / program[:, k]).max()),
        )
    assert lacking > 0.5, "the rubber coupling's damper carries most of its torque at 200 Hz"


def test_gears_and_referred_figures_are_one_train(pump) -> None:
    """theta2 = i theta1, J' = i^2 J, K' = i^2 K, C' = i^2 C, T' = i T with i = 42/125; a section's torque likewise."""
    free, referred = pump.geared(), pump.found()
    left = np.isin(pump.frequencies_of(free), pump.frequencies_of(referred))
    right = np.isin(pump.frequencies_of(referred), pump.frequencies_of(free))
    assert left.sum() >= 400
    real, chain = pump.program(free), pump.program(referred)
    own = np.array([1.0, 1.0, 1.0, 1.0, pump.RATIO, pump.RATIO])[:, None]
    assert by_line(real.angle[:, left] / own, chain.angle[:, right]) < CLOSE
    sections = np.array([1.0, 1.0, 1.0, pump.RATIO, pump.RATIO])[:, None]
    assert by_line(real.torque[:, left] * sections, chain.torque[:, right]) < 10 * CLOSE
    np.testing.assert_allclose(
        pump.modes_of(free).frequency[:5], pump.modes_of(referred).frequency, rtol=1e-12
    )


def test_natural_frequencies_are_those_of_the_matrices(pump) -> None:
    from scipy.linalg import eigh

    inertia, _, stiffness = pump.chain().matrices()
    values = eigh(stiffness, inertia, eigvals_only=True)
    np.testing.assert_allclose(
        pump.modes_of(pump.found()).frequency, np.sqrt(values[1:]) / (2.0 * np.pi), rtol=1e-10
    )


@pytest.mark.parametrize(("share", "stable"), [(1.99, True), (2.01, False)])
def test_central_differences_need_a_step_below_two_over_the_highest_frequency(
    share, stable, pump, paper
) -> None:
    modes = pump.modes_of(pump.found())
    step = share / (2.0 * np.pi * modes.frequency[-1])
    growth = paper["pump_steps"].central_differences(pump.chain(), modes.shape[:, -1], step)
    assert (growth < 20.0) == stable
