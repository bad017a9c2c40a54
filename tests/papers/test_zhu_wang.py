"""Zhu and Wang: growth, boundaries, motion and page, each number against the reference or an independent way."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsion.analyses.lateral.misaligned_shaft import EXACT, Model, growth, linearised
from torsion.analyses.lateral.tilt_stability import zones

PAGES = Path(__file__).parents[2] / "reports" / "papers"
SPEEDS = np.array([25.9, 26.2])
TURN = np.linspace(0.0, np.pi, 31)


def test_frequencies_and_constants_of_the_example(paper) -> None:
    """Reference values of 15 digits."""
    shaft, own = paper["zhu_wang_motion"].SHAFT, paper["zhu_wang_equations"]
    low, high = np.sort(shaft.square)
    np.testing.assert_allclose([high, low], [1068.81705460082663, 356.272351533608875], rtol=1e-14)
    middle = (low + high) / 2.0
    found = [shaft.torque / shaft.inertia / (2.0 * middle), shaft.decay[0] / np.sqrt(middle)]
    np.testing.assert_allclose(found, [0.0457935845019856098, 0.00172438843553709198], rtol=1e-13)
    first = own.averaged(shaft)
    found = [
        own.half_width_right(shaft),
        first.half_width,
        own.half_width_printed(shaft),
        first.circulation,
    ]
    expected = [
        0.328386572001251838,
        0.328386572001251838,
        0.0264389383393792663,
        0.0915871690039712196,
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    np.testing.assert_allclose(
        first.boundaries(), [25.2449361693980998, 26.3230096352481803], rtol=1e-13
    )


@pytest.mark.parametrize(
    ("name", "damped", "expected"),
    [
        ("EXACT", True, (0.28903193, 0.01699056)),
        ("EXACT", False, (0.31205048, 0.04000852)),
        ("SMALL_ANGLE", True, (0.28775593, 0.01660612)),
        ("SMALL_ANGLE", False, (0.31077450, 0.03962402)),
    ],
)
def test_growth_at_the_two_speeds(
    name: str, damped: bool, expected: tuple[float, float], paper
) -> None:
    shaft, theory = paper["zhu_wang_motion"].shaft(damped=damped), paper["zhu_wang_theory"]
    model = getattr(theory, name)
    np.testing.assert_allclose(growth(shaft, SPEEDS, model).rate, expected, rtol=0.0, atol=6e-9)
    np.testing.assert_allclose(
        theory.hill_growth(shaft, SPEEDS, model), expected, rtol=0.0, atol=6e-9
    )


@pytest.mark.parametrize(
    ("name", "lower", "upper"),
    [
        ("(7) corrected", 25.2412094394, 26.3253892466),
        ("(7) corrected, driven speed uneven", 25.2412212936, 26.3253779743),
        ("(8), signs of (7)", 25.2434791008, 26.3235226567),
        ("(7) as printed but sec for csc", 25.2461674098, 26.3209182810),
        ("(8) without E2, the paper's mechanism", 25.4590245404, 26.1132260458),
        ("(8) without E2, C = 0, kappa = 0", 25.4582367588, 26.1140382264),
    ],
)
def test_boundaries_of_the_sum_zone(name: str, lower: float, upper: float, paper) -> None:
    found = paper["zhu_wang"].zone(name)
    assert found.kind == "sum of 1 and 2"
    np.testing.assert_allclose([found.first, found.last], [lower, upper], rtol=0.0, atol=2e-10)


def test_every_unstable_range_of_the_damped_shaft(paper) -> None:
    found = paper["zhu_wang"].every_zone()
    assert [one.kind for one in found] == [
        "difference of 2 and 1",
        "principal of 1",
        "sum of 1 and 2",
        "principal of 2",
    ]
    expected = [
        (6.6247381078, 7.1833181926),
        (18.4726571828, 19.3380958794),
        (25.2412094394, 26.3253892466),
        (32.4240786602, 32.9273342758),
    ]
    np.testing.assert_allclose(
        [(one.first, one.last) for one in found], expected, rtol=0.0, atol=2e-10
    )
    rate = growth(paper["zhu_wang_motion"].SHAFT, np.array([6.908795])).rate
    assert rate[0] == pytest.approx(0.00713234, abs=6e-9)


def test_without_circulation_the_difference_type_never_grows(paper) -> None:
    model = Model(paper["zhu_wang_equations"].without_circulation)
    shaft = paper["zhu_wang_motion"].SHAFT
    assert zones(shaft, 4.0, 10.0, model, 60) == ()
    assert growth(shaft, np.array([6.908795]), model).rate[0] == pytest.approx(
        -shaft.decay[0] / 2.0, rel=1e-4
    )


def test_without_damping_every_speed_is_unstable(paper) -> None:
    (found,) = zones(paper["zhu_wang_motion"].shaft(damped=False), 4.0, 38.0, points=100)
    assert found.is_open == (True, True)


def test_printed_matrix_is_the_derivative_with_a_frozen_denominator(paper) -> None:
    own, tilt = paper["zhu_wang_equations"], np.radians(5.0)
    truth = paper["zhu_wang_faults"].derivative(own.frozen_couple)
    turn = paper["zhu_wang_faults"].TURN
    np.testing.assert_allclose(own.frozen(turn, tilt), truth, rtol=0.0, atol=1e-10)
    assert np.abs(linearised(turn, tilt) - truth).max() > 3e-3
    np.testing.assert_allclose(own.frozen(turn, 1e-8), linearised(turn, 1e-8), rtol=0.0, atol=1e-14)
    rates = growth(paper["zhu_wang_motion"].SHAFT, SPEEDS, Model(own.printed)).rate
    np.testing.assert_allclose(rates, 6.2, atol=0.05)


def test_exact_equations_are_those_of_the_body_in_space(paper) -> None:
    motion, times = paper["zhu_wang_motion"], np.linspace(0.0, 1.0, 21)
    shaft = replace(motion.SHAFT, polar=0.2, tilt=0.4)
    truth = paper["zhu_wang_space"].angles(motion.body(shaft, 25.9), times)
    found = solve_ivp(
        paper["zhu_wang_theory"].exact_rate,
        (0.0, 1.0),
        np.zeros(4),
        "DOP853",
        t_eval=times,
        rtol=1e-9,
        atol=1e-12,
        args=(shaft, 25.9),
    )
    np.testing.assert_allclose(found.y[:2], truth, rtol=0.0, atol=1e-7 * np.abs(truth).max())
    assert np.abs(truth).max() > 0.05


@pytest.mark.parametrize("damped", [True, False])
def test_linear_motion_is_the_one_integrated_in_time(damped: bool, paper) -> None:
    shaft = paper["zhu_wang_motion"].shaft(damped=damped)
    times, angles = paper["zhu_wang_motion"].linear(shaft, 26.2, 8)
    span = (0.0, float(times[-1]))
    run = solve_ivp(
        paper["zhu_wang_theory"].linear_rate,
        span,
        np.zeros(4),
        "DOP853",
        t_eval=times,
        rtol=1e-11,
        atol=1e-14,
        args=(shaft, 26.2, EXACT),
    )
    np.testing.assert_allclose(angles, run.y[:2], rtol=0.0, atol=1e-10)


def test_damped_shaft_at_26_2_looks_steady_for_20_seconds_and_is_not(paper) -> None:
    motion = paper["zhu_wang_motion"]
    _, angles = motion.linear(motion.SHAFT, 26.2, int(300.0 * 26.2 / np.pi))
    early = angles[0, : angles.shape[1] // 15]
    assert np.abs(early[-200:]).max() == pytest.approx(0.012, abs=5e-4)
    assert np.abs(angles[0, -200:]).max() == pytest.approx(1.0, abs=0.05)


def test_committed_page_is_what_the_program_says(paper) -> None:
    page = paper["zhu_wang"].page()
    written = (PAGES / "zhu_wang.md").read_text(encoding="utf-8")
    assert written == page.text(), "run python -m benchmarks.papers"
    assert len(page.misprints) >= 15
    shown = re.findall(r"\]\((\S+\.svg)\)", written)
    assert len(shown) == 4
    for file in shown:
        assert "</svg>" in (PAGES / file).read_text(encoding="utf-8")
