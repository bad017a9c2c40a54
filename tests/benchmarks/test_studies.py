"""What the studies make of their rows: the fastest within a tolerance, the frontier, where answers are useful."""

import math

import pytest


@pytest.fixture(scope="module")
def rows(benchmark):
    pytest.importorskip("mpmath")
    return benchmark("accuracy_rows")


@pytest.fixture(scope="module")
def sweeps(benchmark):
    return benchmark("sweeps")


def row(rows, name: str, error: float, *seconds: float):
    return rows.Row("family", name, error, assembly=[0.0] * len(seconds), solution=list(seconds))


def test_best_is_the_fastest_within_the_tolerance(rows):
    table = [row(rows, "coarse", 1e-1, 1.0), row(rows, "fine", 1e-3, 3.0), row(rows, "finer", 1e-4, 2.0)]
    assert rows.best(table, 1e-2).name == "finer"
    assert rows.best(table, 1.0).name == "coarse"
    assert rows.best(table, 1e-9) is None


def test_time_of_a_row_is_the_median_of_assembly_and_solution_together(rows):
    timed = rows.Row("family", "name", 0.0, assembly=[1.0, 2.0, 9.0], solution=[4.0, 1.0, 1.0])
    assert timed.seconds == 5.0


def test_frontier_keeps_what_none_beats_and_leaves_out_what_is_no_answer(rows):
    table = [
        row(rows, "slow and bad", 1e-2, 5.0), row(rows, "good", 1e-3, 2.0), row(rows, "fast", 1e-1, 1.0),
        row(rows, "none", math.inf, 0.1), row(rows, "wrong", 2.0, 0.5), row(rows, "unknown", math.nan, 0.2),
    ]  # fmt: skip
    assert [one.name for one in rows.frontier(table)] == ["fast", "good"]


def test_answers_that_fail_are_kept_with_their_reason(sweeps):
    sweep = sweeps.Sweep("name", "title", "what", "along")
    sweep.add("peer", 1.0, lambda: 1e-12)
    sweep.add("peer", 10.0, lambda: math.nan)
    sweep.add("peer", 100.0, lambda: 1 / 0)
    assert [point.error for point in sweep.points["peer"]] == [1e-12, math.inf, math.inf]
    assert sweep.points["peer"][2].fault.startswith("ZeroDivisionError")


@pytest.mark.parametrize(
    ("errors", "told"),
    [
        ([0.0, 1e-7, 1e-9], "throughout"),
        ([0.0, 1e-7, 1.0], "1 to 10"),
        ([1.0, 1e-7, 1.0], "10"),
        ([0.0, 1.0, 0.0], "1, 1e+02"),
        ([1.0, math.inf, 2e-6], "nowhere"),
    ],
)
def test_useful_stretches_of_a_sweep(sweeps, errors, told):
    points = [sweeps.Point(10.0**k, error) for k, error in enumerate(errors)]
    assert sweeps.told_ranges(points) == told


def test_reading_tells_the_largest_errors_of_both_sides(sweeps):
    sweep = sweeps.Sweep("name", "title", "what", "along")
    sweep.points = {
        "torsion tree": [sweeps.Point(1.0, 1e-16), sweeps.Point(2.0, 3e-16)],
        "peer": [sweeps.Point(1.0, 1e-16), sweeps.Point(2.0, math.inf)],
    }
    words = sweeps.reading(sweep)
    assert "torsion tree throughout; peer 1;" in words
    assert words.endswith("torsion is 3.0e-16, of the others beyond all bounds (no answer).")
