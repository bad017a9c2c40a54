"""Factors G of J^-1/2 K J^-1/2 = G G^T whose singular values are the natural frequencies, and those values.

The stiffness matrix is never assembled: rounding its diagonal would already spoil the low frequencies of a stiff train.
The star-mesh elimination gives a triangular factor whose entries are sums, products and quotients of positive numbers.
"""

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.reduction import ReducedTrain

_DGEJSV_FULL_ACCURACY = 2  # joba='F': columns are scaled, rows may be badly scaled too


def star_mesh_factor(train: ReducedTrain) -> FloatArray:
    """Return G (bodies, rank) of any graph of springs; parallel springs add.

    Cholesky's factorisation with the largest s/J as pivot, s being the row's sum, by the star-mesh rule; it ends at
    s = 0, so that the rank is exact.
    """
    inertia, tie, root = train.inertia, train.ground.copy(), 1.0 / np.sqrt(train.inertia)
    mesh = np.zeros((len(inertia), len(inertia)))
    np.add.at(mesh, (train.inner, train.outer), train.stiffness)
    mesh += mesh.T
    np.fill_diagonal(mesh, 0.0)
    left, columns = np.ones(len(inertia), dtype=bool), []
    for _ in range(len(inertia)):
        total = mesh.sum(axis=1) + tie
        pivot = int(np.argmax(np.where(left, total / inertia, -1.0)))
        if not total[pivot] > 0.0:
            break
        share = mesh[pivot] / total[pivot]
        column = -share
        column[pivot] = 1.0
        columns.append(np.sqrt(total[pivot]) * column * root)
        mesh += np.outer(share, mesh[pivot])
        tie += share * tie[pivot]
        mesh[pivot], mesh[:, pivot], tie[pivot], left[pivot] = 0.0, 0.0, 0.0, False
        np.fill_diagonal(mesh, 0.0)
    return np.array(columns).reshape(-1, len(inertia)).T.copy(order="F")


def jacobi_svd(matrix: FloatArray, vectors: str = "") -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return left singular vectors (rows, columns), singular values (columns,), descending, and right ones.

    `vectors` holds "U" and "V" where they are wanted. One-sided Jacobi rotations after a QR decomposition, dgejsv
    (Drmac and Veselic 2008): relative accuracy wherever the columns are well conditioned once scaled. Needs at least
    as many rows as columns; raises SolveError where the rotations do not converge.
    """
    from scipy.linalg import lapack

    columns = matrix.shape[1]
    if columns == 0:
        return np.empty((matrix.shape[0], 0)), np.empty(0), np.empty((0, 0))
    jobs = {"jobu": 0 if "U" in vectors else 3, "jobv": 0 if "V" in vectors else 3}
    values, left, right, work, _, info = lapack.dgejsv(
        matrix, joba=_DGEJSV_FULL_ACCURACY, jobr=1, jobt=0, jobp=0, **jobs
    )
    if info != 0:
        raise SolveError(
            f"dgejsv did not converge (info {info}); check the train for spans of 0 or infinite stiffness"
        )
    return left[:, :columns], values * (work[0] / work[1]), right
