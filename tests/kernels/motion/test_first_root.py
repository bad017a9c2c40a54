"""The first fall of a polynomial below zero against its known roots."""

import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsion.kernels.motion.first_root import first_root


def of_roots(roots: list[Fraction], factor: int = 1) -> list[Fraction]:
    """Coefficients of factor * product of (root - s)."""
    found = [Fraction(factor)]
    for root in roots:
        found = [root * one - two for one, two in zip([*found, 0], [0, *found], strict=True)]
    return found


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.sets(st.integers(-12, 32).filter(lambda one: not 0 <= one <= 2), min_size=1, max_size=6))
def test_the_first_fall_is_at_a_known_root(fortieths: set[int]) -> None:
    roots = [Fraction(2 * one + 1, 40) for one in fortieths]  # none at 0 or 1, nor soon after 0
    for factor in (1, -1):
        exact = of_roots(roots, factor)
        falls = [one for one in sorted(roots) if one > 0][:1]
        known = 0.0 if exact[0] < 0 else float(falls[0]) if falls and falls[0] < 1 else None
        found = first_root([float(one) for one in exact], 1e-14 * float(max(map(abs, exact))))
        assert found == (None if known is None else pytest.approx(known, rel=1e-9))


@pytest.mark.parametrize("apart", [0.3, 1e-3, 1e-5])
@pytest.mark.parametrize("middle", [0.2, 0.5, 0.77])
def test_a_double_crossing_is_found_unless_rounding_hides_it(apart: float, middle: float) -> None:
    low, high = Fraction(middle) - Fraction(apart) / 2, Fraction(middle) + Fraction(apart) / 2
    rising = [
        float(one) for one in of_roots([low, high, Fraction(-1, 20)], -1)
    ]  # (s + 1/20) rises at both ends
    for polynomial in ([float(one) for one in of_roots([low, high])], rising):
        assert first_root(polynomial, 1e-15) == pytest.approx(float(low), abs=1e-15 / apart)
        assert first_root(polynomial, 1.1 * apart**2 / 4.0) is None


@pytest.mark.parametrize("at_first", [-1e-17, 0.0, 1e-17])
def test_what_begins_at_zero_by_rounding_may_rise_first(at_first: float) -> None:
    assert first_root([at_first, 0.25, -1.0], 1e-15) == pytest.approx(0.25, abs=1e-15)
    assert first_root([at_first, 0.25, 1.0], 1e-15) is None
    assert (
        first_root([at_first, 0.0, 1.0, -0.25], 1e-15) is None
    )  # sticks, and the torque goes back
    assert first_root([at_first, -1.0], 1e-15) == pytest.approx(0.0, abs=1e-16)
    assert first_root([at_first, 0.0, -1.0], 1e-15) == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("depth", [1e-3, 1e-12])
def test_what_is_below_zero_falls_at_once_unless_it_is_rising_through_it(depth: float) -> None:
    assert first_root([-depth, 0.5 * depth], 1e-15) == 0.0
    assert first_root([-depth, 16.0 * depth], 1e-15) is None
    assert first_root([-depth, 16.0 * depth, -20.0 * depth], 1e-15) == pytest.approx(
        (4.0 + math.sqrt(11.0)) / 10.0
    )
