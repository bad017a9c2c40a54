"""Natural frequencies of a chain, the commonest train: a bidiagonal matrix, whose singular values need no vectors."""

import numpy as np

from torsion.kernels.lapack import bidiagonal_singular_values
from torsion.kernels.tree import FloatArray


def chain_frequencies(inertia: FloatArray, stiffness: FloatArray, *, ground: float = 0.0) -> FloatArray:
    """Natural frequencies, rad/s, ascending, without the rigid motion: (stations - 1,), or (stations,) if `ground` > 0.

    `inertia` (stations,) kg m2, all positive; `stiffness` (stations - 1,) N m/rad, all positive and finite; `ground`
    N m/rad ties the last station to a fixed point. Each is accurate to a few units of rounding (dqds).
    """
    diagonal, off_diagonal = bidiagonal_factor(
        np.asarray(inertia, dtype=np.float64), np.asarray(stiffness, dtype=np.float64), ground
    )
    descending = bidiagonal_singular_values(diagonal, off_diagonal)
    return (descending if ground > 0.0 else descending[:-1])[::-1].copy()


def bidiagonal_factor(inertia: FloatArray, stiffness: FloatArray, ground: float) -> tuple[FloatArray, FloatArray]:
    """Diagonal (n,) and superdiagonal (n - 1,) of diag(k)^1/2 B diag(J)^-1/2, last row for the tie to ground."""
    diagonal = np.empty(len(inertia))
    diagonal[:-1] = np.sqrt(stiffness / inertia[:-1])
    diagonal[-1] = np.sqrt(ground / inertia[-1])
    return diagonal, -np.sqrt(stiffness / inertia[1:])
