"""Fields on triangles (scikit-fem): the solution of least energy, and its slopes along the outline."""

from typing import Any

import numpy as np
import skfem
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from torsion.arrays import BoolArray, FloatArray, IntArray

_ALONG = np.linspace(0.0, 1.0, 17)  # places on a side of the outline at which a field is looked at


def solve_symmetric(matrix: Any, load: FloatArray) -> FloatArray:
    """Return the answer of a symmetric positive definite system of sparse rows."""
    factors = splu(
        csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return factors.solve(load)


def places_along(basis: Any, facets: IntArray) -> tuple[Any, BoolArray]:
    """Return the elements at some facets with places along all their sides, and which places lie on these facets."""
    shape = basis.mesh
    elements = np.unique(shape.f2t[0, facets])
    zero = np.zeros_like(_ALONG)
    # The sides of a triangle in the order of t2f.
    sides = np.concatenate([[_ALONG, zero], [1.0 - _ALONG, _ALONG], [zero, _ALONG]], axis=1)
    weights = np.ones(3 * len(_ALONG))
    places = skfem.Basis(shape, basis.elem, elements=elements, quadrature=(sides, weights))
    return places, np.repeat(np.isin(shape.t2f[:, elements].T, facets), len(_ALONG), axis=1)
