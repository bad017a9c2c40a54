"""The largest singular values' right vectors of a matrix, from its square and one correction."""

import numpy as np

from torsion.arrays import FloatArray

_SPREAD = 1e6  # of the squares of singular values, whose vectors the square leaves right to about 1e-9
_MORE = 8  # columns beyond those wanted among which a gap is looked for
_GAP = 0.9  # ratio of the squares at a gap


def largest_right_vectors(matrix: FloatArray, number: int) -> FloatArray:
    """Right singular vectors (columns, number) of a matrix, of the largest singular value first.

    The eigenvectors of C'C take half the time of a decomposition of C, and are right to eps times the ratio of the
    squares. What they have of all the vectors behind a gap is taken out by one step of first order, which leaves the
    square of that error; those before it are told apart by a decomposition of their own products with C. So all are
    as right as from a decomposition of C. Where there is no gap, or the ratio is too large, C itself is decomposed.
    """
    square, vectors = np.linalg.eigh(matrix.T @ matrix)
    square, vectors = square[::-1], vectors[:, ::-1]
    kept = _before_gap(square, number)
    if kept == 0:
        return np.asarray(np.linalg.svd(matrix, full_matrices=False)[2][:number].T)
    image = matrix @ vectors
    products = image[:, kept:].T @ image[:, :kept]
    found = vectors[:, :kept] + vectors[:, kept:] @ (products / (square[:kept] - square[kept:, None]))
    turn = np.linalg.svd(matrix @ found, full_matrices=False)[2][:number]
    return np.asarray(found @ turn.T)


def _before_gap(square: FloatArray, number: int) -> int:
    """How many of the descending eigenvalues lie before the widest gap at `number` or somewhat beyond; 0: none does."""
    enough = np.flatnonzero(square[: len(square) - 1] * _SPREAD > square[0])[max(number - 1, 0) :][:_MORE]
    if not number or not len(enough):
        return 0
    ratio = square[enough + 1] / square[enough]
    return int(enough[ratio.argmin()]) + 1 if ratio.min() < _GAP else 0
