"""Enclosures by Temple's inequality and by counts, against exact arithmetic."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.lapack import is_expected
from torsion.kernels.long_chain.long_chain_modes import sums_in_groups
from torsion.kernels.long_chain.lowest_modes import (
    Counts,
    _counted,
    are_available,
    factor_of,
    negative_count,
    twisted_vector,
)
from torsion.kernels.long_chain.temple import Chain, quotient, running_sum

DOUBLES = "__pyx_t_5scipy_6linalg_13cython_lapack_d *"


def _chain(seed, size, free):
    rng = np.random.default_rng(seed)
    return Chain(10 ** rng.uniform(-6, 4, size), 10 ** -rng.uniform(0, 12, size - free))


def _exact(chain):
    """Elastic squares of the frequency, ascending, in 80 digits."""
    with mp.workdps(80):
        size, inertia = len(chain.inertia), [mp.mpf(float(a)) for a in chain.inertia]
        matrix = mp.zeros(size)
        for i, h in enumerate(chain.flexibility.tolist()):
            matrix[i, i] += 1 / mp.mpf(h)
            if i + 1 < size:
                matrix[i + 1, i + 1] += 1 / mp.mpf(h)
                matrix[i, i + 1] -= 1 / mp.mpf(h)
                matrix[i + 1, i] -= 1 / mp.mpf(h)
        root = [mp.sqrt(a) for a in inertia]
        scaled = mp.matrix(
            [[matrix[i, j] / root[i] / root[j] for j in range(size)] for i in range(size)]
        )
        return sorted(mp.eigsy(scaled, eigvals_only=True))[int(chain.is_free) :]


@pytest.mark.parametrize("free", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_every_enclosure_holds_whatever_the_vector(seed, free):
    chain, rng = _chain(seed, 9, free), np.random.default_rng(seed)
    exact = [mp.sqrt(s) for s in _exact(chain)]
    factor = factor_of(chain)
    for mode, w in enumerate(exact):
        below = 0.0 if mode == 0 else float(exact[mode - 1]) * (1 + 1e-12)
        above = float(exact[mode + 1]) * (1 - 1e-12) if mode + 1 < len(exact) else 1e30
        good = twisted_vector(factor, float(w) ** 2).vector / np.sqrt(chain.inertia)
        for noise in (0.0, 1e-10, 1e-4, 1e-2):
            vector = good * (1 + noise * rng.standard_normal(9))
            bounds = quotient(chain, vector).enclosure(below, above)
            assert bounds is None or bounds[0] <= w <= bounds[1]
            if noise == 0.0 and mode == 0:
                assert bounds is not None
                assert bounds[1] < bounds[0] * (1 + 1e-12)


@pytest.mark.parametrize("j", [2, 3, 5])
def test_the_shape_of_another_mode_proves_nothing(j):
    chain, second = Chain(np.ones(6), np.ones(5)), 2 * np.sin(np.pi / 6)
    shape = np.cos(j * np.pi * (np.arange(6) + 0.5) / 6)
    assert quotient(chain, shape).enclosure(0.0, second * (1 - 1e-12)) is None


def test_an_even_mixture_of_two_modes_gives_a_wide_but_true_enclosure_of_either():
    chain, station = Chain(np.ones(6), np.ones(5)), np.arange(6)[:, None]
    even = np.cos(np.array([2, 3]) * np.pi * (station + 0.5) / 6).sum(axis=1)
    w = 2 * np.sin(np.arange(5) * np.pi / 12)
    for mode in (2, 3):
        bounds = quotient(chain, even).enclosure(
            w[mode - 1] * (1 + 1e-12), w[mode + 1] * (1 - 1e-12)
        )
        assert bounds is None or bounds[0] <= w[mode] <= bounds[1]


@pytest.mark.parametrize("free", [True, False])
def test_counts_are_right_beyond_their_slack(free):
    chain = _chain(3, 12, free)
    factor, exact = factor_of(chain), _exact(chain)
    for mode, square in enumerate(exact, int(free)):
        assert negative_count(factor, float(square) * (1 - 2 * chain.slack)) <= mode
        assert negative_count(factor, float(square) * (1 + 2 * chain.slack)) > mode


@pytest.mark.parametrize("free", [True, False])
def test_an_enclosure_by_counts_alone_holds(free):
    chain = _chain(4, 10, free)
    counts = Counts(factor_of(chain))
    for mode, square in enumerate(_exact(chain), int(free)):
        counts.at(1e-40)
        counts.at(1e40)
        counts.halve(mode, 2.0**-52)
        _, lower, upper = _counted(chain, counts, mode)
        assert lower <= mp.sqrt(square) <= upper <= lower * (1 + 4 * chain.slack)


def test_running_sums_are_right_to_their_bound():
    terms = np.random.default_rng(0).standard_normal(1000)
    sums, roundings = running_sum(terms, np.float64)
    exact, total = [], Fraction(0)
    for term in terms.tolist():
        total += Fraction(term)
        exact.append(total)
    worst = max(abs(Fraction(s) - e) for s, e in zip(sums.tolist(), exact, strict=True))
    assert roundings < 70
    assert worst <= roundings * Fraction(1, 2**53) * Fraction(float(np.abs(terms).sum()))


def test_running_sums_begin_anew_with_every_group():
    before, behind = sums_in_groups(np.ones(7), np.array([0, 1, 1, 1, 2, 2, 3]))
    np.testing.assert_array_equal(before, [1, 1, 2, 3, 1, 2, 1])
    np.testing.assert_array_equal(behind, [1, 3, 2, 1, 2, 1, 1])


def test_the_routines_of_this_scipy_are_used():
    assert are_available()


@pytest.mark.parametrize(
    ("signature", "fits"),
    [
        (f"int (int *, {DOUBLES})", True),
        ("int (int *, double *)", True),
        ("void (int *, double *)", False),
        ("int (npy_int64 *, double *)", False),
        ("int (int *, float *)", False),
        ("int (int *, double *, int *)", False),
    ],
)
def test_a_routine_is_called_only_by_the_signature_expected(signature, fits):
    assert is_expected(signature, "i id") is fits
