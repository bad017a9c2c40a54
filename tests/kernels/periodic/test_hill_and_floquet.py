"""Floquet exponents by Hill's matrix and by the monodromy matrix: boundaries known in closed form, and each other."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from torsion.kernels.periodic.hill import hill_exponents, toeplitz
from torsion.kernels.periodic.monodromy import at_times, exponents, monodromy, radau, steps_for

ONE_DEGREE = [
    (10, 0.992506888281466933, 1.00781536484546653),
    (20, 0.971571683204113385, 1.03375047720876649),
    (30, 0.942475378319719905, 1.08603209482879454),
]  # joint angle in deg, boundaries of speed / natural frequency


def joint_equation(
    angle: float, speed: float, zeta: float = 0.0, times: int = 193
) -> tuple[np.ndarray, ...]:
    """y'' + 2 zeta y' + y/i^2 = 0 with the speed ratio i of a joint (rad), over half a turn; and the period."""
    turned = np.pi * np.arange(times) / times
    ratio = math.cos(angle) / (1.0 - (math.sin(angle) * np.sin(turned)) ** 2)
    one = np.ones((times, 1, 1))
    return one, 2.0 * zeta * one, (ratio**-2)[:, None, None], math.pi / speed


def trace(angle: float, speed: float, steps: int = 24) -> float:
    *parts, period = joint_equation(angle, speed)
    return float(np.trace(monodromy(*parts, period, steps)))


@pytest.mark.parametrize(("angle", "lower", "upper"), ONE_DEGREE)
def test_one_degree_behind_a_joint_loses_stability_at_the_closed_boundaries(angle, lower, upper):
    beta = math.radians(angle)
    for boundary in (lower, upper):
        near = 1e-3 * boundary
        found = brentq(
            lambda w: trace(beta, w) + 2.0, boundary - near, boundary + near, xtol=1e-15, rtol=1e-15
        )
        assert found == pytest.approx(boundary, rel=1e-12)


def test_damping_narrows_the_zone_to_the_published_boundaries():
    def growth(speed: float) -> float:
        *parts, period = joint_equation(math.radians(20), speed, 0.01)
        return float(exponents(np.linalg.eigvals(monodromy(*parts, period, 24)), period).real.max())

    assert brentq(growth, 0.97, 0.98, xtol=1e-14) == pytest.approx(0.973172733024, rel=1e-11)
    assert brentq(growth, 1.025, 1.04, xtol=1e-14) == pytest.approx(1.032049654099, rel=1e-11)


def two_degrees(speed: float, zeta: float = 0.0, times: int = 97) -> tuple[np.ndarray, ...]:
    """Constant speed, 1e4 N m/rad, a joint of 25 deg, 0.1 kg m2, 2e4 N m/rad, 1 kg m2; equal modal damping ratios."""
    ratio2 = joint_equation(math.radians(25), speed, times=times)[2][:, 0, 0]
    stiffness = np.empty((times, 2, 2))
    stiffness[:] = 2e4 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    root = np.sqrt([0.1, 1.0])
    w2, vector = np.linalg.eigh((stiffness[0] + np.diag([1e4, 0.0])) / np.outer(root, root))
    onto = root[:, None] * vector
    damping = onto @ np.diag(2.0 * zeta * np.sqrt(w2)) @ onto.T
    stiffness[:, 0, 0] += 1e4 * ratio2
    one = np.ones((times, 1, 1))
    return one * np.diag(root**2), one * damping, stiffness, math.pi / speed


def growth(speed: float, zeta: float = 0.0) -> float:
    *parts, period = two_degrees(speed, zeta)
    return float(exponents(np.linalg.eigvals(monodromy(*parts, period, 24)), period).real.max())


@pytest.mark.parametrize(
    ("lower", "upper"), [(77.334541267, 82.769397402), (315.880251578, 325.424472699)]
)
def test_two_degrees_have_the_published_principal_and_sum_zone(lower, upper):
    for boundary, inward in ((lower, 1.0), (upper, -1.0)):
        step = 1e-8 * boundary * inward
        assert growth(boundary + step) > 1e-3
        assert abs(growth(boundary - step)) < 1e-8


def test_equal_damping_ratios_widen_the_sum_zone_to_the_published_boundaries():
    for boundary, inner in ((313.629753692, 318.0), (327.675624616, 322.0)):
        found = brentq(lambda w: growth(w, 0.005), 2.0 * boundary - inner, inner, rtol=1e-14)
        assert found == pytest.approx(boundary, rel=1e-11)
    assert growth(319.938556, 0.005) == pytest.approx(3.273662632, rel=2e-8)


@pytest.mark.parametrize("rank", [1, 2, 3])
def test_mathieu_equation_has_the_multiplier_of_the_zone_at_its_characteristic_values(rank):
    times, q = 64, 0.8
    t = np.pi * np.arange(times) / times
    one = np.ones((times, 1, 1))
    for value in (mathieu_a(rank, q), mathieu_b(rank, q)):
        stiffness = (value - 2.0 * q * np.cos(2.0 * t))[:, None, None]
        half_trace = np.trace(monodromy(one, 0.0 * one, stiffness, math.pi, 24)) / 2.0
        assert half_trace == pytest.approx((-1.0) ** rank, abs=1e-12)


def random_equations(random: np.random.Generator, size: int, times: int) -> tuple[np.ndarray, ...]:
    t = 2.0 * np.pi * np.arange(times) / times
    swing = np.cos(t)[:, None, None], np.sin(2.0 * t)[:, None, None]
    parts = []
    for scale, spread in ((1.0, 0.1), (0.05, 0.02), (4.0, 1.0)):
        base = scale * np.diag(random.uniform(0.7, 1.5, size))
        parts.append(base + sum(s * spread * random.normal(size=(size, size)) for s in swing))
    return tuple(parts)


@pytest.mark.parametrize("seed", range(4))
def test_hill_and_monodromy_find_the_same_exponents(seed):
    random = np.random.default_rng(seed)
    size = 3
    mass, damping, stiffness = random_equations(random, size, 64)
    period = 2.0 * math.pi / random.uniform(1.5, 3.0)
    by_steps = np.linalg.eigvals(monodromy(mass, damping, stiffness, period, 40))
    exponent, _ = hill_exponents(mass, damping, stiffness, 2.0 * math.pi / period, 12)
    by_hill = np.exp(exponent * period)
    for one in by_steps:
        assert np.abs(by_hill - one).min() < 1e-9 * max(1.0, abs(one))
    for one in by_hill:
        assert np.abs(by_steps - one).min() < 1e-9 * max(1.0, abs(one))


def test_coordinate_without_inertia_follows_and_adds_a_multiplier_of_nothing():
    """A spring split by a massless point is the same spring; with a damper there it has one exponent more."""
    times, k = 32, 3.0
    t = 2.0 * np.pi * np.arange(times) / times
    soft = (1.0 + 0.4 * np.cos(t))[:, None, None]
    series = 2.0 * k * 2.0 * k * soft / (2.0 * k + 2.0 * k * soft)
    one = np.ones((times, 1, 1))
    whole = monodromy(one, 0.1 * one, series, 2.0 * math.pi, 40)
    mass, damping, stiffness = (np.zeros((times, 2, 2)) for _ in range(3))
    mass[:, 0, 0], damping[:, 0, 0] = 1.0, 0.1
    first, second = 2.0 * k, 2.0 * k * soft[:, 0, 0]
    stiffness[:, 0, 0] = first
    stiffness[:, 0, 1] = stiffness[:, 1, 0] = -first
    stiffness[:, 1, 1] = first + second
    split = np.linalg.eigvals(monodromy(mass, damping, stiffness, 2.0 * math.pi, 40))
    split = split[np.argsort(np.abs(split))]
    assert np.abs(split[:2]) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.sort_complex(split[2:]) == pytest.approx(
        np.sort_complex(np.linalg.eigvals(whole)), rel=1e-10
    )


def test_collocation_is_exact_for_polynomials_up_to_its_stages():
    rule = radau(5)
    assert rule.node[-1] == 1.0
    for degree in range(5):
        assert rule.matrix @ rule.node**degree == pytest.approx(
            rule.node ** (degree + 1) / (degree + 1), rel=1e-13
        )
    assert rule.matrix[-1] @ rule.node**8 == pytest.approx(1.0 / 9.0, rel=1e-12)


def test_order_of_the_collocation_is_twice_its_stages_less_one():
    *parts, period = joint_equation(0.4, 0.3)
    exact = monodromy(*parts, period, 64)
    coarse, fine = (np.abs(monodromy(*parts, period, n, stages=3) - exact).max() for n in (16, 32))
    assert math.log2(coarse / fine) == pytest.approx(5.0, abs=0.3)


def test_periodic_function_is_read_between_its_samples():
    t = np.arange(33) / 33
    share = np.array([0.123, 0.77])
    wave = lambda x: 1.5 + np.cos(2 * np.pi * x + 0.3) - 0.2 * np.sin(8 * np.pi * x)  # noqa: E731
    assert at_times(wave(t)[:, None], share)[:, 0] == pytest.approx(wave(share), rel=1e-13)


def test_multiplication_matrix_of_a_periodic_function_convolves_its_harmonics():
    random = np.random.default_rng(1)
    times, count = 65, 6
    t = 2 * np.pi * np.arange(times) / times
    k = np.arange(-count, count + 1)
    f = 1.0 + 0.3 * np.cos(t) + 0.1 * np.sin(3 * t)
    u = random.normal(size=2 * count + 1) + 1j * random.normal(size=2 * count + 1)
    direct = np.fft.fft(f * (np.exp(1j * np.outer(t, k)) @ u)) / times
    assert toeplitz(f, count) @ u == pytest.approx(direct[k], rel=1e-12)


def test_steps_follow_the_highest_frequency():
    assert steps_for(2.0, 30.0) > steps_for(2.0, 3.0)
