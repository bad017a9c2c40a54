"""What the studies make of their rows: the fastest within a tolerance, the frontier, where answers are useful."""

import math

import pytest

from torsion.analyses.compare.timing import Effort, TimedRow, run


@pytest.fixture(scope="module")
def accuracy(benchmark):
    pytest.importorskip("mpmath")
    return benchmark("accuracy_page")


@pytest.fixture(scope="module")
def extremes(benchmark):
    return benchmark("extremes")


def row(curve: str, size: int, error: float, *seconds: float) -> TimedRow:
    return TimedRow(curve, f"{size} pieces", size, (error,), (0.0,) * len(seconds), seconds)


def test_page_of_accuracy_names_the_fastest_within_a_tolerance_and_what_none_beats(accuracy):
    rows = (
        row("lumped", 8, 1e-2, 1.0),
        row("exact", 3, 1e-15, 4.0),
        row("fem, degree 10", 2, 1e-13, 5.0),
        row("openTorsion", 8, 1e-1, 2.0),
        row("openTorsion", 100, 1e-3, 300.0),
        row("lumped", 1, 2.0, 0.5),
        row("fem, degree 1", 1, math.inf, 0.1),
    )
    stepped = [one for one in rows if one.error < 1.0]
    text = "\n\n".join(
        accuracy.parts([accuracy.Study("a line", rows, rows, ("something was left out",))], stepped)
    )
    assert "| 0.01 | lumped, 8 pieces: 1e+03 ms | openTorsion, 100 pieces: 3e+05 ms |" in text
    assert "| 1e-06 | exact, 3 pieces: 4e+03 ms | none |" in text
    frontier = text[text.index("| method") : text.index("Fewer than ten modes")]
    assert [line.split("|")[1].strip() for line in frontier.splitlines()[2:] if line] == [
        "lumped",
        "exact",
    ]
    assert "fem, degree 1 with 1." in text
    assert "- something was left out" in text
    assert (
        "times faster: 75 by the medians, 75 by the smallest times, both meant >= 50: met" in text
    )
    assert "times more accurate: 1e+12, meant >= 1e+10: met" in text
    assert accuracy.figure(accuracy.Study("a line", rows, rows, ())).count(">openTorsion<") == 1


@pytest.mark.parametrize("name", ["CONE", "MARINE"])
def test_torques_at_mid_shaft_of_exact_and_high_degree_models_are_those_of_two_ports(
    benchmark, accuracy, name
):
    scenes, methods = benchmark("accuracy_scenes"), benchmark("accuracy_methods")
    effort = Effort(rounds=1, segments=64, unknowns=20, degrees=(10,), speeds=0)
    w = benchmark("accuracy").np.array([40.0, 333.0, 2000.0])
    lumped, fem, exact, peers = methods.torque_curves(getattr(scenes, name), w, effort, ())
    errors = [one.errors(run(one)[0])[0] for one in lumped]
    assert errors[-2] / errors[-1] == pytest.approx(4.0, rel=0.1)
    assert exact[0].errors(run(exact[0])[0])[0] < 1e-12
    assert fem[-1].errors(run(fem[-1])[0])[0] < 1e-8
    assert peers == []


def test_answers_that_fail_are_kept_with_their_reason(extremes):
    sweep = extremes.Sweep("name", "title", "what", "along")
    sweep.add("peer", 1.0, lambda: 1e-12)
    sweep.add("peer", 10.0, lambda: math.nan)
    sweep.add("peer", 100.0, lambda: 1 / 0)
    assert [point.error for point in sweep.points["peer"]] == [1e-12, math.inf, math.inf]
    assert sweep.points["peer"][2].fault.startswith("ZeroDivisionError")


@pytest.mark.parametrize(
    ("errors", "stated"),
    [
        ([0.0, 1e-7, 1e-9], "throughout"),
        ([0.0, 1e-7, 1.0], "1 to 10"),
        ([1.0, 1e-7, 1.0], "10"),
        ([0.0, 1.0, 0.0], "1, 1e+02"),
        ([1.0, math.inf, 2e-6], "nowhere"),
    ],
)
def test_useful_stretches_of_a_sweep(extremes, errors, stated):
    points = [extremes.Point(10.0**k, error) for k, error in enumerate(errors)]
    assert extremes.ranges_in_words(points) == stated


def test_reading_tells_the_largest_errors_of_both_sides(extremes):
    sweep = extremes.Sweep("name", "title", "what", "along")
    sweep.points = {
        "torsion tree": [extremes.Point(1.0, 1e-16), extremes.Point(2.0, 3e-16)],
        "peer": [extremes.Point(1.0, 1e-16), extremes.Point(2.0, math.inf)],
    }
    words = extremes.reading(sweep)
    assert "torsion tree throughout; peer 1;" in words
    assert words.endswith("torsion is 3.0e-16, of the others beyond all bounds (no result).")
