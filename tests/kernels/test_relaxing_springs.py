"""Relaxing springs and warming couplings: the bound of a slope, and the temperature that little heat leads to."""

import numpy as np
import pytest

from torsion.kernels.stiffness_laws import Warming, equilibria, prony


def test_one_relaxing_term_however_divided_reaches_the_bound_of_its_slope() -> None:
    """d ln k'/d ln w = 2 y/((1 + y)(c + (1 + c) y)), y = (w tau)^2, c = k0/k, is largest at y^2 = c/(1 + c)."""
    static, stiffness, tau = 3e3, 9e3, 0.02
    ratio = static / stiffness
    at_largest = (ratio / (1.0 + ratio)) ** 0.25 / tau
    y = (at_largest * tau) ** 2
    exact = 2.0 * y / ((1.0 + y) * (ratio + (1.0 + ratio) * y))
    parts = tuple((share * stiffness, tau) for share in (0.2, 0.3, 0.5))
    for terms in (((stiffness, tau),), parts):
        law = prony(static, terms)
        assert law.slope(at_largest) == pytest.approx(exact, rel=1e-14)
        assert law.steepest == pytest.approx(exact, rel=1e-14)


def test_no_slope_of_several_relaxing_terms_exceeds_their_bound() -> None:
    law = prony(2e3, ((3e3, 0.5), (6e3, 0.02), (4e3, 0.001)))
    assert max(law.slope(speed) for speed in np.geomspace(1e-2, 1e5, 400)) <= law.steepest


@pytest.mark.parametrize("power", [0.0, 1e-9, 60.0])
def test_a_constant_power_has_one_equilibrium(power: float) -> None:
    """Surroundings of 20 degC and 0.5 K/W: 20 + 0.5 P, also of a coupling that makes no heat."""
    warming = Warming(now=20.0, highest=100.0, rise=0.5, factor=((20.0, 1.0), (100.0, 0.8)))
    case, temperature = equilibria(warming, lambda row, _: np.full(len(row), power), 2)
    assert case.tolist() == [0, 1]
    assert temperature == pytest.approx([20.0 + 0.5 * power] * 2, abs=1e-12)
