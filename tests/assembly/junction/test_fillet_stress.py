"""K_t of fillets in torsion against published fits and a law of steep gradients."""

import pytest

from torsion.analyses.response.fillet_stresses import peterson
from torsion.assembly.junction.axisymmetric import fillet_stress
from torsion.assembly.junction.profile import Corner, junction


@pytest.mark.parametrize(
    ("larger", "radius"), [(1.2, 0.03), (1.2, 0.05), (1.2, 0.1), (1.2, 0.3), (2.0, 0.2), (2.0, 0.3)]
)
def test_fillet_is_that_of_peterson_within_three_per_cent(larger: float, radius: float) -> None:
    found = fillet_stress(junction((1.0, 0.0), (larger, 0.0), Corner("fillet", radius)))
    assert found.error <= 1e-3
    assert found.factor == pytest.approx(peterson((larger - 1.0) / 2.0, radius), rel=0.03)


def test_stress_is_within_its_error_of_that_on_a_finer_mesh() -> None:
    profile = junction((1.0, 0.0), (2.0, 0.0), Corner("fillet", 0.15))
    found, finer = fillet_stress(profile), fillet_stress(profile, 1e-5)
    assert finer.error <= 1e-5
    assert found.factor == pytest.approx(finer.factor, rel=found.error + finer.error)


def test_large_step_with_a_small_fillet_concentrates_as_its_corner_does() -> None:
    """In the corner of 270 degrees the stress grows as distance^(-1/3), and so K_t as radius^(-1/3)."""
    small, large = (
        fillet_stress(junction((1.0, 0.0), (2.0, 0.0), Corner("fillet", radius))).factor
        for radius in (2e-4, 16e-4)
    )
    assert small / large == pytest.approx(2.0, rel=0.03)


def test_line_without_a_fillet_has_no_such_stress() -> None:
    with pytest.raises(ValueError, match="no fillet"):
        fillet_stress(junction((1.0, 0.0), (2.0, 0.0)))
