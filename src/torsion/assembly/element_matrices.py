"""Stiffness and inertia of finite elements of a shaft, by scikit-fem.

The unknowns of an element are the angles at its driving and its driven end, then those inside. The pieces of a shaft
stand one after another.
"""

from functools import cache, lru_cache
from typing import Any

import numpy as np
import skfem

from torsion.arrays import FloatArray
from torsion.assembly.pieces import Piece
from torsion.assembly.segments import area_along, is_uniform
from torsion.kernels.distributed.finite_elements import CondensedElements, condensed_elements

DEGREE_OF_SECTION = 4  # the polar moment of a conical shaft is a polynomial of this degree along it


def element_matrices(pieces: tuple[Piece, ...], degree: int) -> tuple[FloatArray, FloatArray]:
    """Stiffness N m/rad and inertia kg m2, both (pieces, degree + 1, degree + 1), at the shaft's own speed.

    Integrals of int G I u' v' dx and int rho I u v dx over each piece, exact to rounding. A cell of the mesh has the
    length 1, so that nothing of its place along the shaft enters.
    """
    stiffness, inertia = list[FloatArray](), list[FloatArray]()
    for first in (piece for piece in pieces if piece.position == 0):
        if is_uniform(first.bar):
            stiff, heavy = (np.repeat(unit, first.number, axis=0) for unit in _of_unit(degree))
            by_stiffness, by_inertia = _factors(first)
        else:
            basis = _basis(first.number, degree)
            across = first.polar_area_moment(basis.default_parameters()["x"][0])
            stiff, heavy = _integrals(basis, across)
            by_stiffness = first.bar.shear_modulus / first.length
            by_inertia = first.bar.density * first.length
        stiffness.append(stiff * by_stiffness)
        inertia.append(heavy * by_inertia)
    return np.concatenate(stiffness), np.concatenate(inertia)


def element_law(pieces: tuple[Piece, ...], degree: int, ratio2: FloatArray) -> CondensedElements:
    """The elements without their unknowns inside, multiplied by `ratio2` (spans,), the squares of their speed ratios.

    Those of uniform shafts are one element to scale: it is condensed once for a degree.
    """
    uniform = [first for first in pieces if first.position == 0 and is_uniform(first.bar)]
    number = [first.number for first in uniform]
    end, parts = sum(number), list[CondensedElements]()
    if uniform:
        factors = np.repeat([_factors(first) for first in uniform], number, axis=0).T * ratio2[:end]
        parts.append(_law_of_unit(degree).scaled(*factors))
    if end < len(pieces):
        stiffness, inertia = element_matrices(pieces[end:], degree)
        scale = ratio2[end:, None, None]
        parts.append(condensed_elements(stiffness * scale, inertia * scale))
    return CondensedElements.joined(parts)


def _factors(piece: Piece) -> tuple[float, float]:
    """G I/L in N m/rad and rho I L in kg m2 of a uniform piece."""
    area, length = float(area_along(piece.bar, 0.0)), piece.length
    return piece.bar.shear_modulus / length * area, piece.bar.density * length * area


@cache
def _law_of_unit(degree: int) -> CondensedElements:
    """The element of length 1, of stiffness and density 1, without its unknowns inside."""
    return condensed_elements(*_of_unit(degree))


@cache
def _of_unit(degree: int) -> tuple[FloatArray, FloatArray]:
    """int u' v' dx and int u v dx over one element of length 1."""
    basis = _basis(1, degree)
    return _integrals(basis, np.ones_like(basis.default_parameters()["x"][0]))


@lru_cache(maxsize=32)
def _basis(cells: int, degree: int) -> Any:
    """The elements of a mesh of `cells` cells of length 1."""
    mesh = skfem.MeshLine(np.arange(cells + 1.0))
    few = {1: skfem.ElementLineP1, 2: skfem.ElementLineP2}
    element = few[degree]() if degree in few else skfem.ElementLinePp(degree)
    return skfem.Basis(mesh, element, intorder=2 * degree + DEGREE_OF_SECTION)


def _integrals(basis: Any, section: FloatArray) -> tuple[FloatArray, FloatArray]:
    """int section u' v' dx and int section u v dx of every element, (elements, degree + 1, degree + 1)."""
    forms = (
        skfem.BilinearForm(lambda u, v, w: w.section * u.grad[0] * v.grad[0]),
        skfem.BilinearForm(lambda u, v, w: w.section * u * v),
    )
    stiff, heavy = (form.elemental(basis, section=section).tolocal() for form in forms)
    return (stiff + stiff.transpose(0, 2, 1)) / 2.0, (heavy + heavy.transpose(0, 2, 1)) / 2.0
