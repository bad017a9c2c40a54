"""A shaft that bends: its segments, what stands on it, its matrices by elements of high degree, values along it.

Displacement u = y + i z, slope u' (m/m), x along the shaft in the direction of power flow, y, z, x right-handed. A
round shaft turning at Omega obeys M u'' - i Omega G u' + K u = f (Genta 2005, Dynamics of Rotating Systems).
A couple M_y + i M_z acts on the slope as f = -i (M_y + i M_z).
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.errors import SolveError
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
        square = (bore / outer) ** 2 / (1.0 + (bore / outer) ** 2) ** 2
        return 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson + (20.0 + 12.0 * poisson) * square)

    def phase(self, frequency: float, shear: bool) -> float:
        """Return the phase (rad) of the bending wave along the element at a frequency, rad/s; not less than it is."""
        ends = np.array([0.0, 1.0])
        slow = self.density / self.youngs_modulus
        bending = np.sqrt(slow * self.area(ends) / self.moment(ends)).max() * frequency
        if shear:
            slow += float((self.density / self.shear_modulus / self.shear_coefficient(ends)).max())
        return float(np.sqrt(bending + slow * frequency**2)) * self.length


@dataclass(frozen=True)
class Functions:
    """Shape functions at points of the cell [0, 1], (functions, points), the slopes at the ends being those in it."""

    deflection: FloatArray
    rotation: FloatArray
    bending: FloatArray  # derivative of the rotation
    shear: (
        FloatArray  # derivative of the deflection alone; the shear strain is that less the rotation
    )


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


LONGEST_PHASE = (
    4.5  # rad of the bending wave along an element: the error of a frequency is then below 1e-13
)
STEEPEST = 1.5  # ratio of the diameters at the ends of one element of a cone
MOST_ELEMENTS = 400
SHARES = (
    0.0,
    0.25,
    0.5,
    0.75,
    1.0,
)  # of an element; both ends, as a moment may jump between two of them


@dataclass(frozen=True, slots=True)
class Point:
    """What stands at one place of the shaft: a disc, a spring and damper to ground, or a fixation."""

    at: float  # m from the start
    name: str = ""
    mass: float = 0.0  # kg
    diametral: float = 0.0  # kg m2
    polar: float = 0.0  # kg m2
    stiffness: tuple[float, float] = (0.0, 0.0)  # N/m in y and z
    damping: tuple[float, float] = (0.0, 0.0)  # N s/m
    fixation: Literal["free", "pinned", "clamped"] = "free"


@dataclass(frozen=True)
class Beam:
    """A shaft between joints or ends."""

    segments: tuple[Segment, ...]
    points: tuple[Point, ...] = ()
    name: str = ""

    @property
    def length(self) -> float:
        """Length of all segments together, m."""
        return math.fsum(segment.length for segment in self.segments)

    def rigid_motions(self, plane: int) -> int:
        """Return the motions of a plane (0 is y, 1 is z) that bend nothing and meet no spring: 0, 1 or 2."""
        if any(point.fixation == "clamped" for point in self.points):
            return 0
        places = {
            point.at
            for point in self.points
            if point.fixation == "pinned" or point.stiffness[plane] > 0
        }
        return max(0, 2 - len(places))

    def hold(self, plane: int) -> float:
        """Return how stiffly its points hold it against the softest motion that bends nothing, over E I/length^3; at most 1.

        The motions are 1 - x/L and x/L; no point counts for more than the bending stiffness.
        """
        if any(point.fixation == "clamped" for point in self.points):
            return 1.0
        bent = self.bending_stiffness
        total = np.zeros((2, 2))
        for point in self.points:
            share = 1.0 if point.fixation == "pinned" else min(1.0, point.stiffness[plane] / bent)
            motion = np.array([1.0 - point.at / self.length, point.at / self.length])
            total += share * np.outer(motion, motion)
        return float(min(1.0, np.linalg.eigvalsh(total)[0]))

    @property
    def bending_stiffness(self) -> float:
        """E I/length^3 of its weakest section, N/m."""
        ends = np.array([0.0, 1.0])
        rigidity = [segment.youngs_modulus * segment.moment(ends) for segment in self.segments]
        return float(np.min(rigidity)) / self.length**3


@dataclass(frozen=True)
class Cell:
    """One element: where it lies, its section and its unknowns."""

    start: float  # m
    section: Segment
    unknowns: IntArray


@dataclass(frozen=True)
class LateralSystem:
    """Matrices of one plane, (n, n), over the displacements (m) and slopes (1) of the nodes and inner unknowns.

    The two planes differ by the springs and dampers of the points alone.
    """

    beam: Beam
    cells: tuple[Cell, ...]
    stiffness: FloatArray  # N/m, of the shaft
    lossy: FloatArray  # N/m, of the shaft, every piece times its loss factor
    inertia: FloatArray  # kg
    gyroscopic: FloatArray  # kg: of the polar inertia
    free: IntArray  # unknowns that no fixation holds
    place: IntArray  # (points,) unknown of the displacement; the slope is the next one
    shear: bool

    def support(self, what: Literal["stiffness", "damping"], plane: int) -> FloatArray:
        """Return (n, n) springs, N/m, or dampers, N s/m, of the points in a plane."""
        matrix = np.zeros_like(self.stiffness)
        for point, row in zip(self.beam.points, self.place, strict=True):
            matrix[row, row] += getattr(point, what)[plane]
        return matrix


def assemble_lateral(
    beam: Beam,
    *,
    frequency: float = 0.0,
    shear: bool = False,
    rotary_inertia: bool = True,
    elements: int = 1,
) -> LateralSystem:
    """Return the system of a shaft, divided finely enough for a highest frequency, rad/s, and into `elements` at least.

    An interval between two points or changes of section has as many elements as keep the bending wave's phase along
    one of them below LONGEST_PHASE. rotary_inertia False is the beam of Euler: no inertia and no gyroscopic moment of
    the sections. shear True is the beam of Timoshenko with the coefficient of Cowper. Raises ValueError for a beam
    without length or a point beside it, SolveError where too many elements were needed.
    """
    cells, nodes = _cells(beam, frequency, shear, elements)
    order = int(cells[-1].unknowns.max()) + 1
    stiffness, lossy, inertia, gyroscopic = (np.zeros((order, order)) for _ in range(4))
    for cell in cells:
        block = np.ix_(cell.unknowns, cell.unknowns)
        stiff, mass, rotary = element(cell.section, shear)
        stiffness[block] += stiff
        lossy[block] += cell.section.loss_factor * stiff
        inertia[block] += mass + (rotary if rotary_inertia else 0.0)
        gyroscopic[block] += 2.0 * rotary if rotary_inertia else 0.0
    unknown_of_point = np.array(
        [2 * int(np.argmin(np.abs(nodes - point.at))) for point in beam.points], dtype=np.intp
    )
    fixed: set[int] = set()
    for point, row in zip(beam.points, unknown_of_point.tolist(), strict=True):
        inertia[row, row] += point.mass
        inertia[row + 1, row + 1] += point.diametral
        gyroscopic[row + 1, row + 1] += point.polar
        fixed |= {"free": set(), "pinned": {row}, "clamped": {row, row + 1}}[point.fixation]
    free = np.array([k for k in range(order) if k not in fixed], dtype=np.intp)
    return LateralSystem(
        beam, cells, stiffness, lossy, inertia, gyroscopic, free, unknown_of_point, shear
    )


def _cells(
    beam: Beam, frequency: float, shear: bool, elements: int
) -> tuple[tuple[Cell, ...], FloatArray]:
    """Elements from start to end, and the places of their nodes, m."""
    if not beam.length > 0 or any(
        not 0 <= point.at <= beam.length * (1 + 1e-12) for point in beam.points
    ):
        raise ValueError(f"{beam.name or 'beam'}: it has no length, or a point is next to it")
    same_place = 1e-12 * beam.length  # places nearer to each other are one, but for rounding
    sections: list[tuple[float, Segment]] = []
    begin = 0.0
    for segment in beam.segments:
        inner = sorted(
            {
                p.at - begin
                for p in beam.points
                if same_place < p.at - begin < segment.length - same_place
            }
        )
        for left, right in pairwise([0.0, *inner, segment.length]):
            piece = segment.between(left, right)
            steep = abs(math.log(piece.outer[1] / piece.outer[0])) / math.log(STEEPEST)
            number = max(
                elements, math.ceil(piece.phase(frequency, shear) / LONGEST_PHASE), math.ceil(steep)
            )
            marks = pairwise(np.linspace(left, right, number + 1).tolist())
            sections += [(begin + start, segment.between(start, end)) for start, end in marks]
        begin += segment.length
    if len(sections) > MOST_ELEMENTS:
        why = (
            f"its bending needs {len(sections)} elements, and at most {MOST_ELEMENTS} are possible"
        )
        raise SolveError(f"{beam.name or 'beam'}: {why}; request fewer `modes` or lower `speeds`")
    inside = (2 * DEGREE if shear else DEGREE) - 3
    first = 2 * (len(sections) + 1)
    cells = [
        Cell(
            start, section, np.r_[2 * k : 2 * k + 4, first + inside * k : first + inside * (k + 1)]
        )
        for k, (start, section) in enumerate(sections)
    ]
    return tuple(cells), np.array([*(start for start, _ in sections), beam.length])


@dataclass(frozen=True)
class Places:
    """Rows that give the values of one plane, (places, unknowns); an end between two elements is there twice."""

    position: FloatArray  # (places,) m from the start
    displacement: FloatArray  # m
    moment: FloatArray  # N m: E I u'', which bends in the plane of y (about z) or of z
    moment_of_loss: FloatArray  # N m: loss factor times that, in quadrature


def places(system: LateralSystem, shares: tuple[float, ...] = SHARES) -> Places:
    """Return the rows at shares of the length of every element."""
    local = np.array(shares)
    rows = np.zeros((3, len(system.cells), len(shares), len(system.inertia)))
    for k, cell in enumerate(system.cells):
        section = cell.section
        shapes = scaled(functions(shares, system.shear), section.length, system.shear)
        moment = shapes.bending * (section.youngs_modulus * section.moment(local))
        for row, values in zip(
            rows, (shapes.deflection, moment, section.loss_factor * moment), strict=True
        ):
            row[k][:, cell.unknowns] = values.T
    position = [cell.start + cell.section.length * local for cell in system.cells]
    return Places(np.concatenate(position), *rows.reshape(3, -1, rows.shape[3]))
