"""Candidates run in turn: which runs are samples, where a curve ends, and what is said of it."""

from collections.abc import Callable
from itertools import count

import numpy as np
import pytest

from torsion.analyses.compare.model_errors import over_largest, over_peaks, relative_errors
from torsion.analyses.compare.timing import Candidate, Pace, timed
from torsion.errors import SolveError


def candidate(
    curve: str, size: int, error: float, clock: "Clock", assembly: float = 0.0, solve: float = 1.0
):
    def spend(seconds: float) -> Callable[..., None]:
        return lambda *_: clock.spend(curve, size, seconds)

    return Candidate(
        curve, f"{size} pieces", size, spend(assembly), spend(solve), lambda _: (error,)
    )


class Clock:
    """A clock that only candidates move, and what it was moved by."""

    def __init__(self) -> None:
        self.now, self.runs = 0.0, list[tuple[str, int]]()

    def __call__(self) -> float:
        return self.now

    def spend(self, curve: str, size: int, seconds: float) -> None:
        self.now += seconds
        if seconds:
            self.runs.append((curve, size))


def test_every_candidate_has_its_turn_in_every_round_and_the_first_run_is_no_sample() -> None:
    clock = Clock()
    both = [[candidate("a", 1, 0.5, clock, 0.25)], [candidate("b", 1, 0.1, clock)]]
    rows, remarks = timed(both, Pace(rounds=2, slow=9.0, clock=clock))
    assert [name for name, _ in clock.runs] == ["a", "a", "b", *["a", "a", "b"] * 2]
    assert [(row.assembly, row.solve) for row in rows] == [
        ((0.25, 0.25), (1.0, 1.0)),
        ((0.0, 0.0), (1.0, 1.0)),
    ]
    assert remarks == ()


def test_a_slow_candidate_has_fewer_turns_and_at_least_its_first_run_as_a_sample() -> None:
    clock = Clock()
    both = [
        [candidate("fast", 1, 0.5, clock, solve=0.125)],
        [candidate("slow", 1, 0.5, clock, solve=8.0)],
    ]
    fast, slow = timed(both, Pace(rounds=5, slow_rounds=2, slow=1.0, clock=clock))[0]
    assert (len(fast.solve), len(slow.solve)) == (5, 2)
    fast, slow = timed(both, Pace(rounds=5, slow_rounds=0, slow=1.0, clock=clock))[0]
    assert (len(fast.solve), slow.solve) == (5, (8.0,))


def test_rounds_go_on_until_the_seconds_are_used() -> None:
    clock = Clock()
    (row,) = timed(
        [[candidate("a", 1, 0.5, clock)]], Pace(rounds=1, seconds=3.5, slow=9.0, clock=clock)
    )[0]
    assert len(row.solve) == 4


def test_a_fast_candidate_fills_its_turn() -> None:
    clock = Clock()
    (row,) = timed(
        [[candidate("a", 1, 0.5, clock, solve=2.0**-9)]],
        Pace(rounds=3, runs=4, turn=2.0**-6, clock=clock),
    )[0]
    assert len(row.solve) == 12


def test_a_curve_ends_where_one_run_is_too_long_and_that_is_said() -> None:
    clock = Clock()
    curve = [candidate("a", size, 0.5, clock, solve=float(size)) for size in (1, 2, 4, 8)]
    rows, remarks = timed([curve], Pace(rounds=1, longest=1.5, clock=clock))
    assert [row.size for row in rows] == [1, 2]
    assert remarks == (
        "a: finer discretisations are not run (2), as one run of 2 pieces takes 2 s.",
    )


def test_a_curve_ends_where_rounding_alone_is_left_twice() -> None:
    clock, errors = Clock(), [1e-3, 1e-13, 1e-5, 1e-14, 1e-14, 1e-15]
    curve = [candidate("a", size, error, clock) for size, error in zip(count(1), errors)]
    rows, remarks = timed([curve], Pace(rounds=1, clock=clock))
    assert [row.size for row in rows] == [1, 2, 3, 4, 5]
    assert remarks == ("a: finer discretisations are not run (1), as only rounding is left.",)


def test_a_candidate_that_fails_ends_its_curve_and_its_words_are_kept() -> None:
    clock = Clock()

    def fail(_: object) -> None:
        raise SolveError("no answer")

    broken = Candidate("b", "2 pieces", 2, lambda: None, fail, lambda _: (0.0,))
    rows, remarks = timed([[candidate("a", 1, 0.1, clock)], [broken]], Pace(rounds=1, clock=clock))
    assert [row.curve for row in rows] == ["a"]
    assert remarks == ("b, 2 pieces: no answer",)


def test_relative_errors_keep_the_digits_of_the_reference_and_their_sign() -> None:
    mpmath = pytest.importorskip("mpmath")
    with mpmath.workdps(40):
        exact = [mpmath.mpf(1) + mpmath.mpf(10) ** -20, mpmath.mpf(2), mpmath.mpf(3)]
        np.testing.assert_allclose(
            relative_errors([1.0, 2.5], exact), [-1e-20, 0.25, np.inf], rtol=1e-15
        )


def test_torques_err_over_the_largest_of_their_speed_or_over_their_own_peak() -> None:
    exact = np.array([[3.0, 4.0j], [1.0, 0.0]])
    found = exact + np.array([[0.4j, 0.0], [0.0, 0.1]])
    np.testing.assert_allclose(over_largest(found, exact), [0.1, 0.1], rtol=1e-15)
    assert over_peaks([exact], [found]) == pytest.approx((0.4 / 3.0,), rel=1e-15)
    assert over_peaks([exact], [found * np.nan]) == (np.inf,)
    assert np.isnan(over_largest(found, 0.0 * exact)).all()


@pytest.mark.parametrize("size", [0.0, 1e-12])
def test_torques_that_are_rounding_beside_the_others_are_not_compared(size: float) -> None:
    exact = np.array([[1.0, size], [2.0j, 0.0]])
    assert over_peaks([exact], [exact + np.array([[0.02, 1e-12], [0.0, 0.0]])]) == pytest.approx(
        (0.01,), rel=1e-15
    )
