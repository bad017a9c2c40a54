"""All modes of a small tree by one singular value decomposition: the shortest way, without a certificate.

For many variants of one train. `modes.tree_modes` proves its frequencies and keeps the relative accuracy of every
component of a shape; here frequencies are as accurate, shapes are so in the norm (Drmac and Veselic 2008).
"""

import ctypes
from dataclasses import dataclass

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.factors import incidence_factor
from torsion.kernels.lapack import routine
from torsion.kernels.reduction import reduce_tree, rigidity
from torsion.kernels.tree import FloatArray, Tree


@dataclass(frozen=True)
class PlainModes:
    """Elastic modes in ascending order, scaled to a generalised inertia of 1 kg m2."""

    frequency: FloatArray  # (m,) rad/s
    angle: FloatArray  # (stations, m) rad
    torque: FloatArray  # (stations, m) N m, on station i: (angle[parent] - angle[i]) / flexibility; 0 at the root


def plain_modes(tree: Tree) -> PlainModes:
    """All elastic modes of a tree of one root in which every station moves, has inertia and an elastic span.

    With G = J^-1/2 B' k^1/2 = U s V': frequencies s, angles J^-1/2 U, torques k^1/2 s V, no difference of angles.
    Raises ValueError for any other tree.
    """
    if not tree.is_plain:
        raise ValueError("plain_modes takes trees of one root without held stations, rigid spans or massless stations")
    train = reduce_tree(tree, rigidity(tree))
    left, values, right = _decomposed(incidence_factor(train))
    angle = left[:, ::-1] / np.sqrt(tree.inertia)[:, None]
    torque = np.zeros((tree.size, len(values)))
    torque[1:] = np.sqrt(train.stiffness)[:, None] * right[:, ::-1] * values[::-1]
    return PlainModes(values[::-1], angle, torque)


def _decomposed(matrix: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """U (rows, columns), s (columns,) descending and V (columns, columns), by one-sided Jacobi rotations (dgesvj)."""
    rows, columns = matrix.shape
    dgesvj = routine("dgesvj")
    if dgesvj is None or columns == 0:
        return _preconditioned(matrix)
    left, right = np.array(matrix, order="F"), np.empty((columns, columns), order="F")
    values, work = np.empty(columns), np.zeros(max(6, rows + columns))
    m, n, none = ctypes.c_int(rows), ctypes.c_int(columns), ctypes.c_int(0)
    length, info = ctypes.c_int(len(work)), ctypes.c_int(0)
    dgesvj(
        *(b"G", b"U", b"V"),
        *(ctypes.byref(m), ctypes.byref(n), left.ctypes.data, ctypes.byref(m), values.ctypes.data),
        *(ctypes.byref(none), right.ctypes.data, ctypes.byref(n)),
        *(work.ctypes.data, ctypes.byref(length), ctypes.byref(info)),
    )
    if info.value != 0:
        return _preconditioned(matrix)
    return left, values * work[0], right


def _preconditioned(matrix: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The same through scipy's public dgejsv, with joba=2: its default loses the small values."""
    from scipy.linalg import lapack

    columns = matrix.shape[1]
    if columns == 0:
        return np.empty((matrix.shape[0], 0)), np.empty(0), np.empty((0, 0))
    values, left, right, work, _, info = lapack.dgejsv(matrix, joba=2, jobu=0, jobv=0, jobr=1, jobt=0, jobp=0)
    if info != 0:
        raise SolveError(f"dgejsv did not converge (info {info}); check the train for spans of 0 or infinite stiffness")
    return left[:, :columns], values * (work[0] / work[1]), right
