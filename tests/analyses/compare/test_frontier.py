"""Which method to take, from rows that were made up."""

import math

import pytest

from torsion.analyses.compare.timing import Spread, TimedQuantity, TimedRow, Timings, as_fast, fastest, unbeaten
from torsion.output.run_time_study import best, csv_text, recommendation, share


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
    ("tolerance", "name"), [(0.1, "coarse"), (2e-2, "coarse"), (1e-3, "lumped"), (1e-4, "exact"), (1e-12, "exact")]
)
def test_the_fastest_method_that_keeps_the_tolerance_is_recommended(tolerance: float, name: str) -> None:
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
            other.total.median < one.total.median and other.error <= one.error for other in ROWS if other is not one
        )


def test_what_is_no_answer_is_in_no_pareto_set() -> None:
    nothing = (row("none", math.inf, 1e-6), row("unknown", math.nan, 2e-6))
    assert names(unbeaten((*nothing, *ROWS))) == ["coarse", "lumped", "exact"]
    assert unbeaten(nothing) == ()


def test_of_errors_that_hardly_differ_the_faster_method_alone_is_kept() -> None:
    slower = row("slower", 0.995 * 1e-15, 9e-4, 9e-4, 9e-4)
    assert names(unbeaten((*ROWS, slower))) == ["coarse", "lumped", "exact"]


def test_the_table_of_the_best_marks_the_recommended_row_alone() -> None:
    quantity = TimedQuantity("frequencies", "Natural frequencies", "", "", 1e-15, 120.0, ("mode 1", "mode 2"), ROWS)
    table = best(quantity, 1e-3)
    assert [(line[0], line[-1]) for line in table.rows] == [("coarse", ""), ("lumped", "recommended"), ("exact", "")]
    assert table.marks == ("", "pass", "")


def test_the_table_of_all_runs_states_the_worst_error_and_the_median() -> None:
    quantity = TimedQuantity("frequencies", "Natural frequencies", "", "", 1e-15, 120.0, ("mode 1", "mode 2"), ROWS)
    _, lumped, *_ = csv_text(Timings(1e-3, (quantity,), (), 3, ())).splitlines()
    assert lumped.split(",")[:8] == ["frequencies", "lumped", "8 segments", "8", "0.0003", "0.0004", "0.0004", "0.0004"]


def test_errors_below_the_bound_of_the_reference_count_as_equal() -> None:
    slower = row("slower", 1e-16, 9e-4, 9e-4, 9e-4)
    assert names(unbeaten((*ROWS, slower))) == ["coarse", "lumped", "exact", "slower"]
    assert names(unbeaten((*ROWS, slower), bound=2e-15)) == ["coarse", "lumped", "exact"]


def test_methods_whose_runs_overlap_are_told_to_be_as_fast() -> None:
    wide = row("wide", 1e-4, 3e-4, 6e-4, 6e-4)
    best = row("best", 1e-4, 3e-4, 4e-4, 7e-4)
    assert names(as_fast((best, wide, ROWS[2]), 1e-3)) == ["wide"]


def test_the_spread_is_of_quartiles() -> None:
    assert Spread.of([5.0, 1.0, 2.0, 4.0, 3.0]) == Spread(1.0, 2.0, 3.0, 4.0, 5)


def test_the_recommendation_is_one_sentence() -> None:
    quantity = TimedQuantity("frequencies", "Natural frequencies", "", "", 1e-15, 120.0, ("mode 1", "mode 2"), ROWS)
    assert recommendation(quantity, 1e-3) == "For 0.1 % up to 120 Hz: lumped, 8 segments, 0.400 ms (error 0.03 %)."
    assert recommendation(quantity, 1e-20).startswith("For 1.0·10⁻²⁰ up to 120 Hz: no method that was run is as")


@pytest.mark.parametrize(("error", "text"), [(1e-3, "0.1 %"), (0.25, "25 %"), (2.3e-9, "2.3·10⁻⁹"), (0.0, "0")])
def test_an_error_is_told_as_people_read_it(error: float, text: str) -> None:
    assert share(error) == text
