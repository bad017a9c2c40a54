"""The optimum of a ring on one mode, against closed forms and a search in high precision."""

import math

import mpmath
import numpy as np
import pytest

from torsion.kernels.ring_damper import magnification, tuned, viscous

# Nishihara and Asami's optimum, found again by a search to 1e-9: inertia ratio, tuning, c/(2 J_ring w), magnification
EXACT = (
    (0.05, 0.952372044, 0.127558546, 6.407920768),
    (0.1, 0.909058293, 0.168602893, 4.589165566),
    (0.2, 0.833222991, 0.210116712, 3.325438841),
    (0.5, 0.666223394, 0.240178249, 2.248029863),
)


def along(ratio: float, tuning: float, damping: float, loss: float = 0.0) -> float:
    """The greatest magnification by a search over the frequency of the equation of motion itself."""

    def size(g: float) -> float:
        ring = tuning**2 * (1 + 1j * loss) + 2j * damping * g
        matrix = np.array(
            [[1 + ratio * ring - g**2, -ratio * ring], [-ratio * ring, ratio * (ring - g**2)]]
        )
        return float(abs(np.linalg.solve(matrix, np.array([1.0, 0.0]))[0]))

    coarse = np.linspace(1e-3, 4.0, 8001)
    best = coarse[int(np.argmax([size(g) for g in coarse]))]
    fine = np.linspace(best - 1e-3, best + 1e-3, 4001)
    return max(size(g) for g in fine)


@pytest.mark.parametrize(("ratio", "tuning", "damping", "peak"), EXACT)
def test_tuned_ring_is_that_of_the_published_optimum(
    ratio: float, tuning: float, damping: float, peak: float
) -> None:
    found = tuned(ratio)
    assert found == pytest.approx((tuning, damping, peak), rel=0, abs=1e-9)


@pytest.mark.parametrize("ratio", [0.02, 0.3, 1.0, 4.0])
def test_no_other_tuned_ring_nearby_is_better(ratio: float) -> None:
    best = tuned(ratio)
    for step in (-1e-3, 1e-3):
        assert magnification(ratio, best.tuning * (1 + step), best.damping) > best.magnification
        assert magnification(ratio, best.tuning, best.damping * (1 + step)) > best.magnification


@pytest.mark.parametrize("ratio", [0.05, 0.1, 0.2, 0.5, 1.0, 3.0])
def test_viscous_ring_magnifies_by_two_over_the_ratio_plus_one(ratio: float) -> None:
    best = viscous(ratio)
    assert best.magnification == pytest.approx((2.0 + ratio) / ratio, rel=1e-15)
    assert magnification(ratio, 0.0, best.damping) == pytest.approx(best.magnification, rel=1e-12)
    assert best.damping == pytest.approx(
        float(1 / mpmath.sqrt(2 * (1 + ratio) * (2 + ratio))), rel=1e-15
    )
    for step in (0.9, 1.1):
        assert magnification(ratio, 0.0, best.damping * step) > best.magnification


@pytest.mark.parametrize(
    ("ratio", "tuning", "damping", "loss"),
    [
        (0.1, 0.9, 0.05, 0.0),
        (0.4, 1.3, 0.0, 0.2),
        (0.2, 0.7, 0.1, 0.1),
        (0.05, 0.0, 3.0, 0.0),
        (2.0, 0.3, 0.01, 0.0),
    ],
)
def test_magnification_is_the_greatest_of_the_equations_of_motion(
    ratio: float, tuning: float, damping: float, loss: float
) -> None:
    assert magnification(ratio, tuning, damping, loss) == pytest.approx(
        along(ratio, tuning, damping, loss), rel=1e-6
    )


def test_ring_without_damping_magnifies_without_end() -> None:
    assert magnification(0.2, 0.9, 0.0) == math.inf
    assert magnification(0.2, 0.0, 0.0, 0.3) == math.inf


@pytest.mark.filterwarnings("error")
def test_a_seized_ring_magnifies_without_limit_and_without_a_warning() -> None:
    assert magnification(0.2, 0.0, 1e12) > 1e6
