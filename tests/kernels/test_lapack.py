"""Singular values of high relative accuracy, by the capsules and by the public routines."""

import subprocess
import sys

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.factors import bidiagonal_factor
from torsion.kernels.lapack import (
    _at,
    bidiagonal_singular_values,
    golub_kahan_singular_values,
    jacobi_svd,
    preconditioned_jacobi_svd,
    routine,
)


@pytest.mark.parametrize("values", [bidiagonal_singular_values, golub_kahan_singular_values])
@pytest.mark.parametrize("size", [2, 3, 10, 40])
def test_uniform_free_chain_has_the_frequencies_2_sin(values, size):
    diagonal, off_diagonal = bidiagonal_factor(np.ones(size), np.ones(size - 1), 0.0)
    found = values(diagonal, off_diagonal)
    expected = 2 * np.sin(np.arange(size - 1, 0, -1) * np.pi / (2 * size))
    np.testing.assert_allclose(found[:-1], expected, rtol=2e-15)
    assert found[-1] <= 1e-300


@pytest.mark.parametrize("size", [2, 7, 40])
def test_chain_tied_at_one_end_has_odd_quarter_waves(size):
    found = bidiagonal_singular_values(*bidiagonal_factor(np.ones(size), np.ones(size - 1), 1.0))[
        ::-1
    ]
    np.testing.assert_allclose(
        found, 2 * np.sin((2 * np.arange(size) + 1) * np.pi / (4 * size + 2)), rtol=2e-15
    )


@pytest.mark.parametrize("values", [bidiagonal_singular_values, golub_kahan_singular_values])
def test_graded_bidiagonal_values_are_right_to_the_last_digits(values):
    rng = np.random.default_rng(7)
    diagonal, off_diagonal = 10 ** rng.uniform(-8, 8, 8), 10 ** rng.uniform(-8, 8, 7)
    with mp.workdps(80):
        matrix = mp.zeros(8)
        for i in range(8):
            matrix[i, i] = mp.mpf(diagonal[i])
            if i < 7:
                matrix[i, i + 1] = mp.mpf(off_diagonal[i])
        exact = sorted(
            (float(mp.sqrt(v)) for v in mp.eigsy(matrix.T * matrix, eigvals_only=True)),
            reverse=True,
        )
    np.testing.assert_allclose(values(diagonal, off_diagonal), exact, rtol=2e-15)


@pytest.mark.parametrize("svd", [jacobi_svd, preconditioned_jacobi_svd])
def test_badly_scaled_columns_keep_their_small_singular_values(svd):
    rng = np.random.default_rng(3)
    matrix = rng.standard_normal((9, 6)) * 10.0 ** np.array([9, -9, 0, 4, -6, 2])
    with mp.workdps(80):
        exact_matrix = mp.matrix(matrix.tolist())
        exact = [mp.sqrt(v) for v in mp.eigsy(exact_matrix.T * exact_matrix, eigvals_only=True)]
    left, values, right = svd(matrix, "UV")
    np.testing.assert_allclose(values, sorted(map(float, exact), reverse=True), rtol=1e-13)
    np.testing.assert_allclose(left.T @ left, np.eye(6), atol=2e-15)
    scale = np.abs(matrix).max(axis=0)
    np.testing.assert_allclose(
        (left * values @ right.T) / scale, matrix / scale, rtol=0, atol=1e-13
    )
    np.testing.assert_allclose(svd(matrix)[1], values, rtol=1e-14)


def test_more_columns_than_rows_are_refused():
    with pytest.raises(ValueError, match="rows >= columns"):
        jacobi_svd(np.ones((2, 3)))


def test_an_unknown_routine_is_not_called():
    assert routine("no_such_routine", "v i") is None


def test_the_capsules_of_this_scipy_are_used():
    assert routine("dlasq1", "v idddi") is not None
    assert routine("dgesvj", "v ccciididididii") is not None
    assert routine("dgbbrd", "v ciiiiididddidididi") is not None


@pytest.mark.parametrize("array", [np.ones(4, dtype=np.float32), np.ones(8)[::2]])
def test_only_contiguous_double_precision_is_handed_over(array):
    with pytest.raises(ValueError, match="contiguous float64"):
        _at(array)


def test_importing_the_modal_kernels_does_not_import_scipy():
    code = "import sys, torsion.kernels.loops; sys.exit('scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
