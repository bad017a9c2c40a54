"""Which method to take, from rows that were made up."""

import math

import pytest

from torsion.analyses.compare.timing import Spread, TimedRow, fastest, unbeaten


def row(name: str, error: float, *solve: float, assembly: float = 0.0) -> TimedRow:
    return TimedRow(name, "8 segments", 8, (error / 2.0, error), (assembly,) * len(solve), solve)


ROWS = (
    row("lumped", 3e-4, 4e-4, 4e-4, 4e-4),
    row("coarse", 2e-2, 1e-4, 1e-4, 1e-4),
    row("fem", 1e-9, 2e-3, 2e-3, 2e-3),
    row("exact", 1e-15, 5e-4, 5e-4, 5e-4),
    row("fewer modes", math.inf, 1e-5, 1e-5, 1e-5),
)


def names(rows: tuple[TimedRow, ...]) -> list[str]:
    return [one.curve for one in rows]


@pytest.mark.parametrize(
    ("tolerance", "name"),
    [(0.1, "coarse"), (2e-2, "coarse"), (1e-3, "lumped"), (1e-4, "exact"), (1e-12, "exact")],
)
def test_the_fastest_method_that_keeps_the_tolerance_is_recommended(
    tolerance: float, name: str
) -> None:
    found = fastest(ROWS, tolerance)
    assert found is not None
    assert found.curve == name


def test_nothing_is_recommended_where_no_method_keeps_the_tolerance() -> None:
    assert fastest(ROWS[:2], 1e-6) is None
    assert fastest((), 1.0) is None


def test_the_time_of_a_method_is_that_of_assembly_and_solve_together() -> None:
    slow_start = row("slow start", 1e-4, 1e-5, 1e-5, 1e-5, assembly=1.0)
    found = fastest((slow_start, ROWS[0]), 1e-3)
    assert found is not None
    assert found.curve == "lumped"


def test_one_slow_run_does_not_change_the_recommendation() -> None:
    disturbed = row("disturbed", 1e-4, 1e-4, 1e-4, 9.0)
    assert fastest((disturbed, ROWS[0]), 1e-3) is disturbed


def test_no_method_of_the_pareto_set_is_beaten_by_any_other() -> None:
    found = unbeaten(ROWS)
    assert names(found) == ["coarse", "lumped", "exact"]
    for one in found:
        assert not any(
            other.total.median < one.total.median and other.error <= one.error
            for other in ROWS
            if other is not one
        )


def test_what_is_no_answer_is_in_no_pareto_set() -> None:
    nothing = (row("none", math.inf, 1e-6), row("unknown", math.nan, 2e-6))
    assert names(unbeaten((*nothing, *ROWS))) == ["coarse", "lumped", "exact"]
    assert unbeaten(nothing) == ()


def test_of_errors_that_hardly_differ_the_faster_method_alone_is_kept() -> None:
    slower = row("slower", 0.995 * 1e-15, 9e-4, 9e-4, 9e-4)
    assert names(unbeaten((*ROWS, slower))) == ["coarse", "lumped", "exact"]


def test_errors_below_the_bound_of_the_reference_count_as_equal() -> None:
    slower = row("slower", 1e-16, 9e-4, 9e-4, 9e-4)
    assert names(unbeaten((*ROWS, slower))) == ["coarse", "lumped", "exact", "slower"]
    assert names(unbeaten((*ROWS, slower), bound=2e-15)) == ["coarse", "lumped", "exact"]


def test_the_spread_is_of_quartiles() -> None:
    assert Spread.of([5.0, 1.0, 2.0, 4.0, 3.0]) == Spread(1.0, 2.0, 3.0, 4.0, 5)
