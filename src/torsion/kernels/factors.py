"""Factors G of J^-1/2 K J^-1/2 = G G^T whose singular values are the natural frequencies, and those values.

The stiffness matrix is never assembled: rounding its diagonal would already spoil the low frequencies of a stiff train.
On a tree G has one column a spring, for a chain it is bidiagonal; on any other graph the star-mesh elimination gives a
triangular factor whose entries are sums, products and quotients of positive numbers.
"""

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.lapack import bidiagonal_singular_values, call, jacobi_svd
from torsion.kernels.reduction import ReducedTrain
from torsion.kernels.tree import Tree, rerooted_at_middle

_BODIES_FOR_JACOBI = (
    30  # above, rotations are slower than a plain decomposition followed by a correction (measured)
)
_BODIES_FOR_SQUARE = 150  # above, the eigenvalues of the square take a third of the time of a decomposition (measured)
_BODIES_FOR_BAND = (
    150  # above, rotations within a narrow band take a third to a tenth of the time (measured)
)
_SPREAD = 1e6  # of singular values that a plain decomposition leaves right to about 1e-10
_SPREAD_OF_COLUMNS = 1e3  # beyond which that of the singular values is not worth finding first
_SPREAD_OF_SQUARE = 1e5  # whose squares are right to about 1e-5
_BODIES_FOR_DENSE = 2000  # above, a dense decomposition is slower than counting
_WIDEST_BAND = 0.04  # of the bodies; a wider band is reduced sooner as a full matrix (measured)


def start_frequencies(train: ReducedTrain, elastic: int) -> FloatArray | None:
    """The elastic natural frequencies (elastic,) rad/s, ascending; None where the train is too large for this way.

    To full accuracy for chains, and for small trains whose frequencies are far apart; otherwise to about eps times the
    highest frequency, or so that Rayleigh's quotients are sure to correct them.
    """
    ends = _chain_grounds(train)
    if ends is not None:
        way = slice(None, None, -1 if ends[0] > 0.0 else 1)
        factor = bidiagonal_factor(
            train.inertia[way], train.stiffness[way], ends[0] if ends[0] > 0.0 else ends[1]
        )
        return bidiagonal_singular_values(*factor)[:elastic][::-1]
    values = banded_values(train) if len(train.inertia) > _BODIES_FOR_BAND else None
    if values is not None or len(train.inertia) > _BODIES_FOR_DENSE:
        return values
    if train.acyclic and len(train.stiffness) + np.count_nonzero(train.ground) == elastic:
        return _singular_values(incidence_factor(train))
    return _singular_values(star_mesh_factor(train)[:, :elastic])


def _singular_values(factor: FloatArray) -> FloatArray:
    """Singular values (columns,), ascending, by the cheapest way that is accurate enough for how far apart they are."""
    size = np.linalg.norm(
        factor, axis=0
    )  # of the columns; singular values are at least as far apart
    if len(factor) > _BODIES_FOR_SQUARE and size.min() * _SPREAD_OF_SQUARE > size.max():
        square: FloatArray = np.linalg.eigvalsh(factor.T @ factor).astype(np.float64, copy=False)
        if square[0] * _SPREAD_OF_SQUARE**2 > square[-1]:
            return np.asarray(np.sqrt(square))
    is_small = len(factor) <= _BODIES_FOR_JACOBI
    if is_small and not size.min() * _SPREAD_OF_COLUMNS > size.max():
        return jacobi_svd(factor)[1][::-1]
    values: FloatArray = np.linalg.svd(factor, compute_uv=False)[::-1].astype(
        np.float64, copy=False
    )
    if is_small and not values[0] * _SPREAD > values[-1]:
        return jacobi_svd(factor)[1][::-1]
    return values


def incidence_factor(train: ReducedTrain) -> FloatArray:
    """G (bodies, springs + ties to ground): a column sqrt(k/J) at both ends of a spring, with opposite signs."""
    springs, tied = len(train.stiffness), np.flatnonzero(train.ground)
    root, column = 1.0 / np.sqrt(train.inertia), np.arange(springs)
    factor = np.zeros((len(train.inertia), springs + len(tied)), order="F")
    strength = np.sqrt(train.stiffness)
    factor[train.inner, column] = strength * root[train.inner]
    factor[train.outer, column] = -strength * root[train.outer]
    factor[tied, springs + np.arange(len(tied))] = np.sqrt(train.ground[tied]) * root[tied]
    return factor


def star_mesh_factor(train: ReducedTrain) -> FloatArray:
    """G (bodies, rank) of any graph of springs; parallel ones add.

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


def _chain_grounds(train: ReducedTrain) -> tuple[float, float] | None:
    """Ties to ground of the first and the last body, if the train is a chain in its numbering tied at most at one."""
    bodies, ground = len(train.inertia), train.ground.tolist()
    along = list(range(bodies))
    if not (
        train.acyclic and train.inner.tolist() == along[:-1] and train.outer.tolist() == along[1:]
    ):
        return None
    if any(ground[1:-1]) or (bodies > 1 and ground[0] > 0.0 and ground[-1] > 0.0):
        return None
    return (0.0, ground[0]) if bodies == 1 else (ground[0], ground[-1])


def bidiagonal_factor(
    inertia: FloatArray, stiffness: FloatArray, ground: float
) -> tuple[FloatArray, FloatArray]:
    """Diagonal (n,) and superdiagonal (n - 1,) of diag(k)^1/2 B diag(J)^-1/2, last row for the tie to ground."""
    diagonal = np.empty(len(inertia))
    diagonal[:-1] = np.sqrt(stiffness / inertia[:-1])
    diagonal[-1] = np.sqrt(ground / inertia[-1])
    return diagonal, -np.sqrt(stiffness / inertia[1:])


def banded_values(train: ReducedTrain) -> FloatArray | None:
    """Singular values (springs,), ascending, of J^-1/2 B' k^1/2 of a free tree, right to about eps times the largest.

    By a banded factor. None for any other train, where joined bodies cannot be numbered close to each other, or
    without scipy's dgbbrd.
    """
    bodies, order = len(train.inertia), np.argsort(train.outer)
    if train.ground.any() or not np.array_equal(train.outer[order], np.arange(1, bodies)):
        return None
    parent, soft = np.append(-1, train.inner[order]), np.append(0.0, 1.0 / train.stiffness[order])
    if not (train.acyclic and (parent[1:] < train.outer[order]).all()):
        return None
    tree = rerooted_at_middle(
        Tree(parent, soft, train.inertia, np.zeros(bodies, dtype=np.bool_))
    ).tree
    above = np.arange(bodies - 1) - tree.parent[1:]
    if above.max() > _WIDEST_BAND * bodies:
        return None
    root, strength = 1.0 / np.sqrt(tree.inertia), 1.0 / np.sqrt(tree.flexibility[1:])
    band = np.zeros(
        (int(above.max()) + 2, bodies - 1), order="F"
    )  # the main diagonal is the last row but one
    band[-1] = -strength * root[1:]
    band[-2 - above, np.arange(bodies - 1)] = strength * root[tree.parent[1:]]
    two = _two_diagonals(band)
    return None if two is None else bidiagonal_singular_values(*two)[::-1]


def _two_diagonals(band: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Sizes of the main and the upper diagonal of a matrix with the same singular values and one row more than columns.

    `band` (diagonals, columns) holds its diagonals from the uppermost to the first below the main one; it is given up.
    Rotations within the band: dgbbrd.
    """
    rows, columns = band.shape
    diagonal, off, work, none = (
        np.empty(columns),
        np.empty(columns),
        np.empty(2 * columns + 2),
        np.empty(1),
    )
    found = call(
        "dgbbrd",
        "v ciiiiididddidididi",
        b"N",
        columns + 1,
        columns,
        0,
        1,
        rows - 2,
        band,
        rows,
        diagonal,
        off,
        none,
        1,
        none,
        1,
        none,
        1,
        work,
        0,
    )
    return None if found is None or found[-1] != 0 else (np.abs(diagonal), np.abs(off[:-1]))
