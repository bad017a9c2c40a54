"""Sobol's indices and their intervals against closed forms."""

import numpy as np
import pytest
from scipy import stats

from torsion.what_if.sweep.sweep_run import estimated
from torsion.what_if.variants.laws import SCRAMBLES, uniform_samples

PER_SEQUENCE = 16


def test_the_interval_of_means_over_sequences_is_students() -> None:
    """Sets A and B of -1 and 1, balanced in every sequence: indices are means over sequences, exactly.

    The jackknife of a mean is its standard error s/sqrt(n).
    """
    choose = np.random.default_rng(3)
    signs = np.repeat([-1.0, 1.0], PER_SEQUENCE // 2)
    first, second = (
        np.array([choose.permutation(signs) for _ in range(SCRAMBLES)]) for _ in range(2)
    )
    mixed = choose.normal(size=(2, SCRAMBLES, PER_SEQUENCE))
    index, half_width = estimated(np.array([first, second, *mixed]).reshape(4, -1))

    of_sequences = np.array(
        [
            [(second * (one - first)).mean(axis=1) for one in mixed],
            [((first - one) ** 2).mean(axis=1) / 2.0 for one in mixed],
        ]
    )
    np.testing.assert_allclose(index, of_sequences.mean(axis=2), rtol=1e-12)
    student = stats.t(SCRAMBLES - 1).ppf(0.975)
    exact = student * of_sequences.std(axis=2, ddof=1) / np.sqrt(SCRAMBLES)
    np.testing.assert_allclose(half_width, exact, rtol=1e-9)


def test_intervals_cover_the_indices_of_a_sum() -> None:
    """Of 2 x + y, uniform and independent, first and total indices are 4/5 and 1/5."""
    covered, exact = 0, np.array([[0.8, 0.2], [0.8, 0.2]])
    for seed in range(200):
        a, b = (uniform_samples(1024, 4, "random", seed)[:, k : k + 2] for k in (0, 2))
        sets = [a, b, np.column_stack([b[:, 0], a[:, 1]]), np.column_stack([a[:, 0], b[:, 1]])]
        index, half_width = estimated(np.array([2.0 * one[:, 0] + one[:, 1] for one in sets]))
        covered += int((np.abs(index - exact) <= half_width).sum())
    assert covered / 800 == pytest.approx(0.95, abs=0.03)
