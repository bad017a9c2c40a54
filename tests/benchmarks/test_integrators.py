"""The compared methods of integration against the tables and closed forms of the textbooks."""

import math

import pytest

KNOWN = {  # period elongation and amplitude decay in % at h/T of 0.05, 0.1, 0.2; eigenvalues, found independently
    "central differences": [(-0.414145, 0.0), (-1.69342, 0.0), (-7.51724, 0.0)],
    "Newmark 1/4, 1/2": [(0.817124, 0.0), (3.20749, 0.0), (12.0033, 0.0)],
    "linear acceleration": [(0.408379, 0.0), (1.60019, 0.0), (5.91451, 0.0)],
    "Wilson": [(1.71063, 1.44494), (6.14622, 8.4096), (19.3653, 29.6388)],
    "HHT": [(1.02022, 0.188116), (3.95058, 1.3146), (14.2425, 6.75415)],
    "generalised alpha": [(0.862328, 0.0130924), (3.38284, 0.0987678), (12.6351, 0.644474)],
    "Bathe": [(0.409502, 0.0667535), (1.61794, 0.513063), (6.18705, 3.52024)],
    "Houbolt": [(3.90844, 7.0445), (12.3206, 29.2133), (34.3668, 65.3997)],
    "Runge-Kutta 4": [(0.00783379, 0.0131881), (0.112201, 0.405993), (1.05521, 10.7213)],
    "precise integration": [(0.0, 0.0), (0.0, 0.0), (0.0, 0.0)],
}
LIMITS = {
    "central differences": 1.0 / math.pi,
    "linear acceleration": math.sqrt(3.0) / math.pi,
    "Runge-Kutta 4": math.sqrt(2.0) / math.pi,
}


@pytest.fixture(scope="module")
def methods(benchmark):
    return benchmark("integrator_methods")


@pytest.mark.parametrize("name", KNOWN)
def test_a_method_changes_period_and_amplitude_as_known(name: str, methods) -> None:
    for ratio, (elongation, decay) in zip((0.05, 0.1, 0.2), KNOWN[name], strict=True):
        found = methods.quality(methods.METHODS[name], ratio)
        assert 100.0 * found.elongation == pytest.approx(elongation, rel=1e-5, abs=1e-7)
        assert 100.0 * found.decay == pytest.approx(decay, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("name", KNOWN)
def test_a_method_is_stable_up_to_its_limit(name: str, methods) -> None:
    assert methods.stable_to(methods.METHODS[name]) == pytest.approx(
        LIMITS.get(name, math.inf), rel=1e-4
    )


def test_every_compared_method_is_known(methods) -> None:
    assert set(methods.METHODS) == set(KNOWN)
