"""Laws against their moments, intervals against scipy's and their coverage of a closed form."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats

from torsion.what_if.variants.laws import SCRAMBLES, Law, factors, probability, uniform_samples

EXACT = 0.110455774875150582  # two equal discs exceed 34 Hz: ln f is normal
LAWS = [
    (Law(uniform=0.15), stats.uniform(0.85, 0.3)),
    (Law(triangular=0.2), stats.triang(0.5, 0.8, 0.4)),
    (Law(triangular=(0.7, 0.8, 1.0)), stats.triang(1 / 3, 0.7, 0.3)),
    (Law(triangular=(0.8, 0.8, 1.0)), stats.triang(0.0, 0.8, 0.2)),
    (Law(lognormal=0.1), stats.lognorm(0.1)),
    (Law(normal=0.05), stats.truncnorm(-3.0, 3.0, 1.0, 0.05)),
    (Law(normal=0.05, within=0.1), stats.truncnorm(-2.0, 2.0, 1.0, 0.05)),
]


@pytest.mark.parametrize(("law", "exact"), LAWS, ids=[law.words for law, _ in LAWS])
def test_a_law_is_the_inverse_of_its_distribution(law: Law, exact: stats.rv_continuous) -> None:
    unit = np.linspace(0.001, 0.999, 97)
    assert factors(law, unit) == pytest.approx(exact.ppf(unit), rel=1e-12)


@pytest.mark.parametrize("method", ["sobol", "latin", "random"])
def test_samples_of_a_seed_are_the_same_and_fill_the_square_evenly(method: str) -> None:
    drawn = uniform_samples(1024, 2, method, 7)
    assert np.array_equal(drawn, uniform_samples(1024, 2, method, 7))
    assert not np.array_equal(drawn, uniform_samples(1024, 2, method, 8))
    assert drawn.shape == (1024, 2)
    boxes = np.histogram2d(*drawn.T, bins=4, range=[[0, 1], [0, 1]])[0]
    assert abs(boxes - 64).max() <= {"sobol": 0, "latin": 40, "random": 40}[method]


def test_random_samples_are_those_of_one_generator() -> None:
    assert np.array_equal(
        uniform_samples(100, 3, "random", 7), np.random.default_rng(7).random((100, 3))
    )


def test_sobol_draws_each_of_its_sequences_whole() -> None:
    each = uniform_samples(1024, 3, "sobol", 2).reshape(SCRAMBLES, 128, 3)
    for sequence in each:
        for column in sequence.T:
            assert np.array_equal(np.sort((column * 128).astype(int)), np.arange(128))


@pytest.mark.parametrize(("count", "size"), [(0, 128), (5, 100), (64, 128), (128, 128)])
def test_independent_samples_have_wilsons_interval(count: int, size: int) -> None:
    share, low, high = probability(np.arange(size) < count, "random")
    exact = stats.binomtest(count, size).proportion_ci(0.95, "wilson")
    assert (share, low, high) == pytest.approx((count / size, exact.low, exact.high), abs=1e-15)


def test_sobol_has_students_interval_of_the_shares_of_its_sequences() -> None:
    counts, length = np.arange(4, 4 + SCRAMBLES), 32
    share, *ends = probability((np.arange(length) < counts[:, None]).ravel(), "sobol")
    shares = counts / length
    exact = stats.t.interval(0.95, SCRAMBLES - 1, loc=shares.mean(), scale=stats.sem(shares))
    assert share == pytest.approx(shares.mean(), rel=1e-15)
    assert ends == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("few", [1, 9])
def test_few_that_keep_a_limit_are_counted_as_few_that_exceed_it(few: int) -> None:
    """Sequences with hardly any of either hide their spread: Wilson's interval of the count, from both sides."""
    happens = np.zeros(SCRAMBLES * 32, dtype=bool)
    happens[:few] = True
    exact = stats.binomtest(few, happens.size).proportion_ci(0.95, "wilson")
    _, low, high = probability(happens, "sobol")
    assert (low, high) == pytest.approx((exact.low, exact.high), rel=1e-12)
    _, low, high = probability(~happens, "sobol")
    assert (low, high) == pytest.approx((1.0 - exact.high, 1.0 - exact.low), rel=1e-12)


def test_none_of_the_samples_is_no_probability_of_nothing() -> None:
    share, low, high = probability(np.zeros(512, dtype=bool), "sobol")
    assert share == low == 0.0
    assert 3.0 / 512 < high < 4.0 / 512


@pytest.mark.parametrize("method", ["sobol", "random"])
def test_intervals_cover_the_probability_of_a_closed_form(method: str) -> None:
    stiffness, inertia, covered, wide = Law(lognormal=0.10), Law(lognormal=0.04), 0, []
    for seed in range(20000, 20200):
        unit = uniform_samples(2048, 2, method, seed)
        k, j = factors(stiffness, unit[:, 0]), factors(inertia, unit[:, 1])
        share, low, high = probability(np.sqrt(2 * 20000.0 * k / j) / (2.0 * np.pi) > 34.0, method)
        covered += low <= EXACT <= high
        wide.append(high - low)
        assert low <= share <= high
    assert covered >= 0.93 * 200
    assert np.mean(wide) < {"sobol": 0.012, "random": 0.029}[method]


@pytest.mark.parametrize(("end", "missing"), [("from", "to"), ("to", "from")])
def test_a_range_needs_both_of_its_ends(end: str, missing: str) -> None:
    with pytest.raises(ValidationError, match=f"`{end}` needs `{missing}`"):
        Law.model_validate({end: "80 mm"})
