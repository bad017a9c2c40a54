"""Matrices of one element of a bending shaft, from scikit-fem's functions and quadrature on a cell of length 1.

Without shear: the cubic Hermite functions (displacement and slope at both ends) and inner functions whose second
derivatives are Legendre polynomials, so that in a uniform shaft they do not couple by stiffness (Szabo and Babuska
1991, Finite Element Analysis, ch. 3). With shear (Timoshenko): displacement of one degree and rotation of one less,
independent of each other, which do not lock; the shear coefficient is that of Cowper 1966, J. Appl. Mech. 33:335.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.sources import source

DEGREE = 13  # of the displacement in an element
POINTS = (
    DEGREE + 4
)  # of Gauss: exact for the product of two functions and a moment of area of degree 4


@dataclass(frozen=True, slots=True)
class Segment:
    """A piece of shaft, uniform or conical; an element is one too."""

    length: float  # m
    outer: tuple[float, float]  # m, diameters at both ends
    bore: tuple[float, float]  # m
    youngs_modulus: float  # Pa
    density: float  # kg/m3
    shear_modulus: float = math.inf  # Pa, of the shear only
    loss_factor: float = 0.0

    def diameters(self, share: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return outer diameter and bore, m, at shares of the length."""
        outer, bore = (ends[0] + (ends[1] - ends[0]) * share for ends in (self.outer, self.bore))
        return outer, bore

    def between(self, start: float, end: float) -> "Segment":
        """Return the part between two distances from its start, m."""
        (o1, o2), (b1, b2) = (
            diameters.tolist() for diameters in self.diameters(np.array([start, end]) / self.length)
        )
        return replace(self, length=end - start, outer=(o1, o2), bore=(b1, b2))

    def area(self, share: FloatArray) -> FloatArray:
        """Return the area of the section at shares of the length, m2."""
        outer, bore = self.diameters(share)
        return math.pi / 4.0 * (outer - bore) * (outer + bore)

    def moment(self, share: FloatArray) -> FloatArray:
        """Return the second moment of area about a diameter, m4."""
        outer, bore = self.diameters(share)
        return math.pi / 64.0 * (outer - bore) * (outer + bore) * (outer**2 + bore**2)

    @source("Cowper1966")
    def shear_coefficient(self, share: FloatArray) -> FloatArray:
        """Return Cowper's coefficient of a hollow circular section with the Poisson's ratio of E and G."""
        poisson = self.youngs_modulus / (2.0 * self.shear_modulus) - 1.0
        outer, bore = self.diameters(share)
        square = (bore / outer) ** 2
        sum_square = (1.0 + square) ** 2
        return (
            6.0
            * (1.0 + poisson)
            * sum_square
            / ((7.0 + 6.0 * poisson) * sum_square + (20.0 + 12.0 * poisson) * square)
        )

    def phase(self, frequency: float, shear: bool) -> float:
        """Return the phase (rad) of the bending wave along the element at a frequency, rad/s; not less than it is."""
        ends = np.array([0.0, 1.0])
        bending = (
            np.sqrt(self.density * self.area(ends) / (self.youngs_modulus * self.moment(ends)))
            * frequency
        )
        slow = self.density / self.youngs_modulus
        if shear:
            slow += float(
                (self.density / (self.shear_coefficient(ends) * self.shear_modulus)).max()
            )
        return float(np.sqrt(bending.max() + slow * frequency**2)) * self.length


@dataclass(frozen=True)
class Functions:
    """Shape functions at points of the cell [0, 1], (functions, points), the slopes at the ends being those in it."""

    deflection: FloatArray
    rotation: FloatArray
    bending: FloatArray  # derivative of the rotation
    shear: (
        FloatArray  # derivative of the deflection alone; the shear strain is that less the rotation
    )


def size(shear: bool) -> int:
    """Return the unknowns of one element, those at its ends included."""
    return 2 * DEGREE + 1 if shear else DEGREE + 1


@source("SzaboBabuska1991", "ch. 3")
def element(section: Segment, shear: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the stiffness, N/m, mass, kg, and rotary inertia of the sections, kg, by quadrature that is exact for cones.

    Each (functions, functions) of one plane over displacements, m, slopes, and inner unknowns.
    """
    points, weights = gauss(POINTS)
    shapes = scaled(functions(tuple(points), shear), section.length, shear)
    weights = weights * section.length
    area = section.area(points)
    moment = section.moment(points)
    stiffness = _product(shapes.bending, weights * section.youngs_modulus * moment)
    if shear:
        coefficient = section.shear_coefficient(points) * section.shear_modulus
        stiffness += _product(shapes.shear - shapes.rotation, weights * coefficient * area)
    mass = _product(shapes.deflection, weights * section.density * area)
    return stiffness, mass, _product(shapes.rotation, weights * section.density * moment)


def scaled(shapes: Functions, length: float, shear: bool) -> Functions:
    """Return the functions on an element of a length, m, whose unknowns at the ends are displacements and slopes."""
    if shear:
        return Functions(
            shapes.deflection, shapes.rotation, shapes.bending / length, shapes.shear / length
        )
    factor = np.ones((shapes.deflection.shape[0], 1))
    factor[[1, 3]] = length
    by_length = factor / length
    by_square = factor / length**2
    return Functions(
        factor * shapes.deflection,
        by_length * shapes.rotation,
        by_square * shapes.bending,
        by_length * shapes.shear,
    )


@lru_cache(maxsize=16)
def functions(points: tuple[float, ...], shear: bool) -> Functions:
    """Return all functions of the cell at points in [0, 1]: displacement and slope at both ends, then the inner ones.

    Without shear they are cubic Hermite functions and integrated Legendre polynomials, and deflection' is the rotation;
    with it displacement of DEGREE, then rotation of one degree less, each by its own functions.
    """
    import skfem

    at_points = np.array(points)
    if shear:
        along = _on_cell(skfem.ElementLinePp(DEGREE), at_points)
        turned = _on_cell(skfem.ElementLinePp(DEGREE - 1), at_points)
        w, r = (np.array([np.asarray(field)[0] for field in fields]) for fields in (along, turned))
        dw, dr = (np.array([field.grad[0, 0] for field in fields]) for fields in (along, turned))
        return Functions(_mixed(w, 0 * r), _mixed(0 * w, r), _mixed(0 * w, dr), _mixed(dw, 0 * r))
    fields = _on_cell(skfem.ElementLineHermite(), at_points)
    value = np.array([np.asarray(field)[0] for field in fields])
    slope = np.array([field.grad[0, 0] for field in fields])
    bend = np.array([field.hess[0, 0, 0] for field in fields])
    legendre = np.polynomial.legendre.legvander(2.0 * at_points - 1.0, DEGREE).T
    j = np.arange(2, DEGREE - 1)[:, None]
    norm = np.sqrt(2.0 * j + 1.0)
    inner = (legendre[4:] - legendre[2:-2]) / ((2 * j + 1) * (2 * j + 3))
    inner -= (legendre[2:-2] - legendre[:-4]) / ((2 * j + 1) * (2 * j - 1))
    first = (legendre[3:-1] - legendre[1:-3]) / (2 * j + 1)
    rotation = np.vstack([slope, norm * first / 2.0])
    deflection = np.vstack([value, norm * inner / 4.0])
    return Functions(deflection, rotation, np.vstack([bend, norm * legendre[2:-2]]), rotation)


def _mixed(of_deflection: FloatArray, of_rotation: FloatArray) -> FloatArray:
    """Rows in the order of the unknowns: both fields at the start, at the end, and inside."""
    ends = [of_deflection[0], of_rotation[0], of_deflection[1], of_rotation[1]]
    return np.vstack([*ends, of_deflection[2:], of_rotation[2:]])


def _on_cell(kind: Any, points: FloatArray) -> list[Any]:
    """The fields of scikit-fem's element at points of the cell [0, 1]."""
    import skfem

    mesh = skfem.MeshLine(np.array([0.0, 1.0]))
    basis = skfem.Basis(mesh, kind, quadrature=(points[None, :], np.ones(points.size)))
    return [fields[0] for fields in basis.basis]


@lru_cache(maxsize=2)
def gauss(number: int) -> tuple[FloatArray, FloatArray]:
    """Return the points and weights of Gauss on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(number)
    return (points + 1.0) / 2.0, weights / 2.0


def _product(rows: FloatArray, weights: FloatArray) -> FloatArray:
    """Symmetric sum of weight * row * row."""
    local = np.einsum("ip,p,jp->ij", rows, weights, rows)
    return np.asarray((local + local.T) / 2.0)
