"""K_t of fillets in torsion against published fits and a law of steep gradients."""

import math

import pytest

from torsion.assembly.junction.fillet_stress import fillet_stress
from torsion.assembly.junction.profile import Corner, junction


def peterson(larger: float, radius: float) -> float:
    """Pilkey 1997, Peterson's Stress Concentration Factors, 2nd ed., chart 3.12, for 0.25 <= h/r <= 4."""
    height = (larger - 1.0) / 2.0
    ratio, share = height / radius, 2.0 * height / larger
    assert 0.25 <= ratio <= 4.0
    root = math.sqrt(ratio)
    terms = (
        0.905 + 0.783 * root - 0.075 * ratio, -0.437 - 1.969 * root + 0.553 * ratio,
        1.557 + 1.073 * root - 0.578 * ratio, -1.061 + 0.171 * root + 0.086 * ratio,
    )  # fmt: skip
    return sum(term * share**power for power, term in enumerate(terms))


@pytest.mark.parametrize(
    ("larger", "radius"), [(1.2, 0.03), (1.2, 0.05), (1.2, 0.1), (1.2, 0.3), (2.0, 0.2), (2.0, 0.3)]
)
def test_fillet_is_that_of_peterson_within_three_per_cent(larger: float, radius: float) -> None:
    found = fillet_stress(junction((1.0, 0.0), (larger, 0.0), Corner("fillet", radius)))
    assert found.error <= 1e-3
    assert found.factor == pytest.approx(peterson(larger, radius), rel=0.03)


def test_large_step_with_a_small_fillet_concentrates_as_its_corner_does() -> None:
    """In the corner of 270 degrees the stress grows as distance^(-1/3), and so K_t as radius^(-1/3)."""
    small, large = (
        fillet_stress(junction((1.0, 0.0), (2.0, 0.0), Corner("fillet", radius))).factor for radius in (2e-4, 16e-4)
    )
    assert small / large == pytest.approx(2.0, rel=0.03)


def test_line_without_a_fillet_has_no_such_stress() -> None:
    with pytest.raises(ValueError, match="no fillet"):
        fillet_stress(junction((1.0, 0.0), (2.0, 0.0)))
