"""Frequencies of a free tree from a banded factor: reduced to two diagonals by rotations (dgbbrd), then by dlasq1."""

import ctypes

import numpy as np

from torsion.kernels.lapack import bidiagonal_singular_values, routine
from torsion.kernels.reduction import ReducedTrain
from torsion.kernels.rerooting import rerooted_at_middle
from torsion.kernels.tree import FloatArray, Tree

_WIDEST = 0.04  # of the bodies; a wider band is reduced sooner as a full matrix (measured)


def banded_values(train: ReducedTrain) -> FloatArray | None:
    """Singular values (springs,), ascending, of J^-1/2 B' k^1/2 of a free tree, right to about eps times the largest.

    None for any other train, where joined bodies cannot be numbered close to each other, or without scipy's dgbbrd.
    """
    bodies, order = len(train.inertia), np.argsort(train.outer)
    if train.ground.any() or not np.array_equal(train.outer[order], np.arange(1, bodies)):
        return None
    parent, soft = np.append(-1, train.inner[order]), np.append(0.0, 1.0 / train.stiffness[order])
    if not (train.acyclic and (parent[1:] < train.outer[order]).all()):
        return None
    tree = rerooted_at_middle(Tree(parent, soft, train.inertia, np.zeros(bodies, dtype=np.bool_))).tree
    above = np.arange(bodies - 1) - tree.parent[1:]
    if above.max() > _WIDEST * bodies:
        return None
    root, strength = 1.0 / np.sqrt(tree.inertia), 1.0 / np.sqrt(tree.flexibility[1:])
    band = np.zeros((int(above.max()) + 2, bodies - 1), order="F")  # the main diagonal is the last row but one
    band[-1] = -strength * root[1:]
    band[-2 - above, np.arange(bodies - 1)] = strength * root[tree.parent[1:]]
    two = _two_diagonals(band)
    return None if two is None else bidiagonal_singular_values(*two)[::-1]


def _two_diagonals(band: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Sizes of the main and the upper diagonal of a matrix with the same singular values and one row more than columns.

    `band` (diagonals, columns) holds its diagonals from the uppermost to the first below the main one; it is given up.
    """
    dgbbrd = routine("dgbbrd")
    if dgbbrd is None:
        return None
    rows, columns = band.shape
    diagonal, off, work, none = np.empty(columns), np.empty(columns), np.empty(2 * columns + 2), np.empty(1)
    number = [ctypes.c_int(v) for v in (columns + 1, columns, 0, 1, rows - 2, rows, 1, 0)]
    m, n, zero, lower, upper, leading, one, info = map(ctypes.byref, number)
    dgbbrd(
        *(b"N", m, n, zero, lower, upper, band.ctypes.data, leading, diagonal.ctypes.data, off.ctypes.data),
        *(none.ctypes.data, one, none.ctypes.data, one, none.ctypes.data, one, work.ctypes.data, info),
    )
    return (np.abs(diagonal), np.abs(off[:-1])) if number[-1].value == 0 else None
