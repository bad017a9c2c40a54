"""Which of several checks is the worst: its verdict decides, and only then its share of the limit."""

from itertools import pairwise

import pytest

from torsion.output import check_words
from torsion.rules.verdict_line import WORDS, Check, rank, worst_checks, worst_verdict


def check(verdict, value):
    return Check("r", "c", "w", "x", value, 1.0, "1", verdict, "maker")


@pytest.mark.parametrize(("worse", "better"), list(pairwise(WORDS)))
def test_a_worse_verdict_stands_before_a_larger_share(worse, better) -> None:
    """FAIL, then NOT JUDGED, then PASS with restrictions, then PASS, for every use of a rank alike."""
    low, high = check(worse, 0.1), check(better, 0.9)
    assert rank(low) > rank(high)
    if WORDS[worse] != WORDS[better] and worse != "restricted":
        assert min((high, low), key=check_words.rank) is low
    assert worst_verdict([high, low]) == worse
    for cases in ({"a": (low,), "b": (high,)}, {"b": (high,), "a": (low,)}):
        ((case, found),) = worst_checks(cases).values()
        assert (case, found.verdict) == ("a", worse)


@pytest.mark.parametrize("verdict", list(WORDS))
def test_of_one_verdict_the_larger_share_is_worse(verdict) -> None:
    low, high = check(verdict, 0.2), check(verdict, 0.7)
    assert rank(high) > rank(low)
    assert min((low, high), key=check_words.rank) is high


@pytest.mark.parametrize(
    ("share", "grade"),
    [(0.49, "low"), (0.5, "middle"), (0.79, "middle"), (0.8, "high"), (0.99, "high")],
)
def test_a_pass_is_graded_at_a_half_and_at_four_fifths_of_its_limit(share, grade) -> None:
    assert check_words.use(check("pass", share)).grade == grade
