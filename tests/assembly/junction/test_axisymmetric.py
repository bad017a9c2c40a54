"""Junctions of round shafts by finite elements against closed forms, published and independent figures."""

import math

import pytest
from benchmarks.junction_table import errors_between

from torsion.assembly.junction.axisymmetric import Solved, solved
from torsion.assembly.junction.profile import Corner, Length, Profile, junction, mirrored
from torsion.kernels.junction_table import junction_table

# Independent: psi alone, elements of degree 2 divided by jumps of the gradient; from below, the last digit is open.
SHARP = {1.1: 0.014013, 1.25: 0.045315, 1.5: 0.085674, 2.0: 0.125704, 3.0: 0.149316, 6.0: 0.158695}


@pytest.mark.parametrize("larger", SHARP)
def test_sharp_step_of_a_solid_shaft_agrees_with_an_independent_solution(larger: float) -> None:
    found = solved(junction((1.0, 0.0), (larger, 0.0)), 4e-7)
    assert found.error <= 2e-7
    assert found.excess_length == pytest.approx(SHARP[larger], abs=2.5e-6)
    assert found.excess[0] > SHARP[larger] - 5e-7  # what stores too much energy is too short


@pytest.mark.parametrize("bore", [0.0, 0.6])
def test_equal_diameters_have_no_excess(bore: float) -> None:
    found = solved(junction((1.0, bore), (1.0, bore), moduli=(1.0, 0.5)))
    assert max(map(abs, found.excess)) < 1e-11


def test_bounds_enclose_and_close() -> None:
    """Each coarser enclosure holds the finer one."""
    profile = junction((1.0, 0.3), (1.6, 0.3), Corner("chamfer", 0.1))
    coarse, fine = solved(profile, 1e-2), solved(profile, 1e-6)
    assert (
        coarse.levels[-1].lower
        <= fine.levels[-1].lower
        < fine.levels[-1].upper
        <= coarse.levels[-1].upper
    )
    shares = [(one.gap.sum(), one.upper - one.lower) for one in fine.levels]
    assert all(total == pytest.approx(gap, rel=1e-4) for total, gap in shares)


def test_cone_is_that_of_its_closed_form() -> None:
    """Foeppl 1905: in a cone of half angle a, 2 pi G (2/3 - cos a + cos^3 a / 3) twist = T (1/R1^3 - 1/R2^3) / 3.

    Its ends against cylinders add what grows as 1/d^3: of three cones of one angle that begin alike, the differences
    leave one unknown.
    """
    slope = 0.25  # radius over length
    cosine = 1.0 / math.hypot(1.0, slope)
    unit = 2.0 * math.pi * (2.0 / 3.0 - cosine + cosine**3 / 3.0)

    def measured(end: float) -> float:
        """Flexibility with both cylinders taken off, and that of the cone between its end circles taken off too."""
        cone = Length((end - 1.0) / 2.0 / slope, (1.0, end))
        found = solved(junction((1.0, 0.0), (end, 0.0), between=(cone,)), 1e-6)
        level, lengths = found.levels[-1], found.profile.lengths
        rest = (level.lower + level.upper) / 2.0 - lengths[0].twist - lengths[-1].twist
        first, last = (d / 2.0 / math.sqrt(1.0 - cosine**2) for d in (1.0, end))
        return rest - (first**-3 - last**-3) / 3.0 / unit

    two, four, eight = map(measured, (2.0, 4.0, 8.0))
    whole = Length(2.0, (1.0, 2.0)).twist
    assert abs(four - two) > 1e-4 * whole  # the ends are there
    assert (eight - four) / (four - two) == pytest.approx(1.0 / 8.0, abs=0.02)


def test_line_from_its_other_end_is_the_same() -> None:
    profile = junction((1.0, 0.0), (2.0, 0.4), Corner("fillet", 0.15))
    here, there = solved(profile, 1e-6), solved(mirrored(profile), 1e-6)
    assert here.excess_length == pytest.approx(there.excess_length, abs=2e-6)


def test_step_in_two_far_apart_is_the_sum_of_both() -> None:
    """The flexibility of a step falls as 1 / (G I_p) of its smaller shaft."""
    one, two = (
        solved(junction((1.0, 0.0), (q, 0.0)), 1e-6).excess_length for q in (1.5, 2.0 / 1.5)
    )
    both = solved(junction((1.0, 0.0), (2.0, 0.0), between=(Length(5.0, (1.5, 1.5)),)), 1e-6)
    assert both.excess_length == pytest.approx(one + two * 1.5 / 1.5**4, abs=3e-6)


@pytest.mark.parametrize(
    "profile",
    [
        junction(
            (1.0, 0.0), (2.0, 0.0), Corner("fillet", 0.02), between=(Length(0.1, (0.94, 0.94)),)
        ),
        junction((1.0, 0.0), (1.0, 0.0), Corner("fillet", 0.1), between=(Length(0.2, (2.0, 2.0)),)),
        junction((1.0, 0.3), (2.0, 0.0)),
        junction((1.0, 0.0), (1.2, 0.0), Corner("fillet", 0.3)),
    ],
    ids=["undercut", "flange", "bore on one side", "truncated fillet"],
)
def test_every_form_is_enclosed(profile: Profile) -> None:
    found: Solved = solved(profile, 1e-4)
    assert 0.0 <= found.excess[1] - found.excess[0] <= 1e-4


def test_undercut_twists_more_than_without_and_fillet_less() -> None:
    plain, groove, fillet = (
        solved(junction((1.0, 0.0), (2.0, 0.0), corner, between=between)).excess_length
        for corner, between in (
            (None, ()),
            (None, (Length(0.1, (0.94, 0.94)),)),
            (Corner("fillet", 0.1), ()),
        )
    )
    assert (
        fillet
        < plain
        < groove + Length(0.1, (0.94, 0.94)).twist / Length(1.0, (1.0, 1.0)).twist - 0.1
    )


def test_table_is_the_elements_within_its_error() -> None:
    table = junction_table()
    assert table.error <= 1e-4
    assert max(errors_between(table, 12, seed=7)) <= table.error
    assert table.excess_length(0.0, 0.5, 0.0) == pytest.approx(SHARP[2.0], abs=table.error)
    assert table.excess_length(0.9, 0.5, 0.0) is None
    assert table.excess_length(0.0, 0.5, 0.6) is None
