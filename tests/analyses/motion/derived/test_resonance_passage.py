"""What of the steady amplitude is reached in passing, against the equation of the passage itself."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsion.analyses.motion.derived.resonances_passed import share_of_steady


@pytest.mark.parametrize("p", [0.16, 0.4, 1.58])
def test_the_greatest_amplitude_is_that_of_the_slowly_varying_equation(p: float) -> None:
    def rates(x: float, a: np.ndarray) -> np.ndarray:
        return -p * a + np.exp(0.5j * x * x)

    x = np.linspace(0.0, 4.0, 4001)
    start = -40.0 / max(p, 0.5)
    found = solve_ivp(rates, (start, 4.0), [0j], "DOP853", t_eval=x, rtol=1e-10, atol=1e-12).y[0]
    assert share_of_steady(p) == pytest.approx(p * float(np.abs(found).max()), rel=2e-6)


def test_without_damping_the_peak_factor_is_that_of_the_cornu_spiral() -> None:
    # 1.47 w / sqrt(a); the steady factor is 1 / (2 zeta), p = zeta w / sqrt(a)
    p = 1e-7
    assert share_of_steady(p) / (2.0 * p) == pytest.approx(1.467, abs=1e-3)


def test_a_slow_passage_reaches_all_of_the_steady_amplitude() -> None:
    assert share_of_steady(30.0) == pytest.approx(1.0, abs=1e-6)
    assert math.isclose(share_of_steady(0.04) / (2.0 * 0.04) / 1.467, 0.93, abs_tol=5e-3)
