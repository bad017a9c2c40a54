"""Torsion of a cross-section by finite elements (scikit-fem): bounds of the torsion constant, and the shear stress.

Stress function (Prandtl 1903): -laplace(phi) = 2, phi = 0 on the outline and a constant c on every hole, around which
the integral of its normal derivative is 2 A. Torsion constant 2 int phi + 2 sum(c A) = int |grad phi|^2, and shear
stress = shear modulus * twist per length * |grad phi|. Elements store too little of this energy: a lower bound.

Warping (Saint-Venant 1855): laplace(omega) = 0 with d omega/dn = y n_x - x n_y. Torsion constant = int (x^2 + y^2) -
int |grad omega|^2: an upper bound, for the same reason (Weinstein 1947).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import skfem
from scipy.sparse import csc_array

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.section.section_mesh import Triangles, boundary
from torsion.assembly.triangle_fields import places_along, solve_symmetric
from torsion.sources import source

ORDER = 8  # of the quadrature: exact for degree 4 on straight triangles, and for r^2 on curved ones


@dataclass(frozen=True)
class Moments:
    """Area and its moments about the origin, in the unit of the mesh."""

    area: float
    centroid: tuple[float, float]
    polar: float


@dataclass(frozen=True)
class Level:
    """What one mesh says, in the unit of the mesh."""

    triangles: int
    lower: float  # bounds of the torsion constant of the outline as meshed
    upper: float
    stress: float  # largest shear stress / (shear modulus * twist per length)
    at: tuple[float, float]  # where; always on the boundary


def moments(mesh: Triangles) -> Moments:
    """Area, centroid and polar moment about the origin."""
    basis = skfem.Basis(shape_of(mesh), skfem.ElementTriP1(), intorder=ORDER)
    (x, y), dx = basis.default_parameters()["x"], basis.dx
    area = float(np.sum(dx))
    centroid = (float(np.sum(x * dx)) / area, float(np.sum(y * dx)) / area)
    return Moments(area, centroid, float(np.sum((x * x + y * y) * dx)))


@source("Prandtl1903")
def solve_level(mesh: Triangles, degree: int) -> Level:
    """Bounds of the torsion constant and the largest stress, by elements of degree 2 or 4 on a sound mesh."""
    element = skfem.ElementTriP4() if degree == 4 else skfem.ElementTriP2()
    basis, edge = skfem.Basis(shape_of(mesh), element, intorder=ORDER), boundary(mesh)
    stiffness, turning, polar = plane_forms(basis)

    # The number that scikit-fem gives every side of the boundary.
    corners = np.unique(mesh.nodes[:, :3])
    ends = np.sort(np.searchsorted(corners, edge.sides[:, :2]), axis=1)
    present, wanted = (
        np.asarray(pair, dtype=np.int64) @ [len(corners), 1] for pair in (basis.mesh.facets.T, ends)
    )
    order = np.argsort(present)
    facets = order[np.searchsorted(present, wanted, sorter=order)]
    lower, phi = stress_function(basis, stiffness, facets, edge.loop, edge.area)
    turning = turning[1:]  # omega is known but for a constant, so one unknown is left out
    upper = polar - float(turning @ solve_symmetric(stiffness[1:, 1:], turning))
    stress, point = largest_slope(basis, phi)
    return Level(len(mesh.nodes), lower, upper, stress, point)


def plane_forms(basis: Any) -> tuple[Any, FloatArray, float]:
    """The energy of a gradient, the load of the warping, and the polar moment."""
    (x, y), dx = basis.default_parameters()["x"], basis.dx
    gradients = skfem.BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1])
    around = skfem.LinearForm(lambda v, w: w.x[1] * v.grad[0] - w.x[0] * v.grad[1])
    return (
        gradients.assemble(basis),
        np.asarray(around.assemble(basis)),
        float(np.sum((x * x + y * y) * dx)),
    )


def shape_of(mesh: Triangles) -> Any:
    """The mesh for scikit-fem, whose elements of degree 4 want the corners of a triangle in ascending order."""
    order = np.argsort(mesh.nodes[:, :3], axis=1)
    corners = np.take_along_axis(mesh.nodes[:, :3], order, 1)
    opposite = np.take_along_axis(mesh.nodes[:, [4, 5, 3]], order, 1)
    nodes = np.concatenate([corners, opposite[:, [2, 0, 1]]], axis=1)
    return skfem.MeshTri2(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(nodes.T))


def stress_function(
    basis: Any, stiffness: Any, facets: IntArray, loop: IntArray, area: FloatArray
) -> tuple[float, FloatArray]:
    """Torsion constant, and phi (unknowns,): 0 on the outline, one unknown for each hole, all others free.

    facets: of the boundary, with the loop (facets,) of each and the area (loops,) within it, as of a `Boundary`.
    """
    number, holes = stiffness.shape[0], len(area) - 1
    column = np.arange(holes, holes + number)
    for hole in range(-1, holes):
        column[basis.get_dofs(facets[loop == hole + 1]).all()] = hole
    free = np.flatnonzero(column >= 0)
    used, position = np.unique(column[free], return_inverse=True)
    spread = csc_array((np.ones(len(free)), (free, position)), shape=(number, len(used)))
    force = spread.T @ skfem.LinearForm(lambda v, _: 2.0 * v).assemble(basis)
    force[:holes] -= 2.0 * area[1:]  # negative around a hole
    answer = solve_symmetric(spread.T @ stiffness @ spread, force)
    return float(force @ answer), np.asarray(spread @ answer)


def largest_slope(
    basis: Any, field: FloatArray, turning: float = 0.0
) -> tuple[float, tuple[float, float]]:
    """Largest |grad phi| and where; |grad phi| is subharmonic, so it is nowhere larger than on the boundary.

    turning: that times (-y, x) is added, 1 where the field is the warping.
    """
    places, shown = places_along(basis, basis.mesh.boundary_facets())
    x, y = places.default_parameters()["x"]
    grad = np.asarray(places.interpolate(field).grad) + turning * np.stack([-y, x])
    slope = np.where(shown, np.hypot(*grad), 0.0)
    worst = np.unravel_index(int(np.argmax(slope)), slope.shape)
    return float(slope[worst]), (float(x[worst]), float(y[worst]))
