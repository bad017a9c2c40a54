"""The boundary of a triangle mesh: its sides, joined to loops around the section and around every hole."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.section.section_mesh import Triangles

_GAUSS = np.polynomial.legendre.leggauss(2)  # exact for the area under a parabola


@dataclass(frozen=True)
class Boundary:
    """Sides that one triangle alone has, the section on their left; the loop 0 is the outer one."""

    sides: IntArray  # (sides, 3) first corner, last corner, node amid
    loop: IntArray  # (sides,)
    area: FloatArray  # (loops,) within each loop, negative around holes


def all_sides(mesh: Triangles) -> IntArray:
    """(3 triangles, 3) first corner, last corner, node amid, around every triangle."""
    corners, middles = mesh.nodes[:, :3], mesh.nodes[:, 3:]
    return np.stack([corners, np.roll(corners, -1, axis=1), middles], axis=2).reshape(-1, 3)


def boundary(mesh: Triangles) -> Boundary:
    """The boundary of a sound mesh, the loop of the largest area first."""
    sides = all_sides(mesh)
    _, place, count = np.unique(np.sort(sides[:, :2], axis=1), axis=0, return_inverse=True, return_counts=True)
    sides = sides[count[place.ravel()] == 1]
    number = len(mesh.points)
    graph = coo_array((np.ones(len(sides)), (sides[:, 0], sides[:, 1])), shape=(number, number))
    loop = np.unique(connected_components(graph, directed=False)[1][sides[:, 0]], return_inverse=True)[1]
    area = np.asarray(np.bincount(loop, weights=_area_under(mesh.points, sides)), dtype=float)
    order = np.argsort(-area, kind="stable")
    return Boundary(sides, np.argsort(order, kind="stable")[loop], area[order])


def _area_under(points: FloatArray, sides: IntArray) -> FloatArray:
    """(sides,) int (x dy - y dx)/2 along each parabola."""
    first, last, amid = (points[sides[:, k]] for k in range(3))
    slope, bend = (last - first) / 2.0, (first + last) / 2.0 - amid
    found = np.zeros(len(sides))
    for t, weight in zip(*_GAUSS, strict=True):
        at, along = amid + slope * t + bend * t**2, slope + 2.0 * bend * t
        found += weight * (at[:, 0] * along[:, 1] - at[:, 1] * along[:, 0]) / 2.0
    return found
