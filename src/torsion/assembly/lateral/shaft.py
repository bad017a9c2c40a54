"""A shaft that bends: its pieces, what stands on it, and its matrices by Hermite elements of high degree.

Displacement u = y + i z, slope u' (m/m), x along the shaft in the direction of power flow, y, z, x right-handed. A
round shaft turning at Omega obeys M u'' - i Omega G u' + K u = f (Genta 2005, Dynamics of Rotating Systems).
A couple M_y + i M_z acts on the slope as f = -i (M_y + i M_z).
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.lateral.elements import Section, element, end_unknowns, size
from torsion.errors import SolveError

LONGEST_PHASE = 4.5  # rad of the bending wave along an element: the error of a frequency is then below 1e-13
STEEPEST = 1.5  # ratio of the diameters at the ends of one element of a cone
MOST_ELEMENTS = 400


@dataclass(frozen=True, slots=True)
class Segment:
    """A piece of shaft, uniform or conical."""

    length: float  # m
    outer: tuple[float, float]  # m, diameters at both ends
    bore: tuple[float, float]  # m
    youngs_modulus: float  # Pa
    density: float  # kg/m3
    shear_modulus: float = math.inf  # Pa, of the shear only
    loss_factor: float = 0.0


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
    held: Literal["free", "pinned", "clamped"] = "free"


@dataclass(frozen=True)
class Beam:
    """A shaft between joints or ends."""

    segments: tuple[Segment, ...]
    points: tuple[Point, ...] = ()
    name: str = ""

    @property
    def length(self) -> float:
        """m."""
        return math.fsum(segment.length for segment in self.segments)

    @property
    def is_isotropic(self) -> bool:
        """Its supports are the same in both planes."""
        return all(p.stiffness[0] == p.stiffness[1] and p.damping[0] == p.damping[1] for p in self.points)

    def rigid_motions(self, plane: int) -> int:
        """Motions of a plane (0 is y, 1 is z) that bend nothing and meet no spring: 0, 1 or 2."""
        if any(point.held == "clamped" for point in self.points):
            return 0
        held = {point.at for point in self.points if point.held == "pinned" or point.stiffness[plane] > 0}
        return max(0, 2 - len(held))

    def hold(self, plane: int) -> float:
        """How stiffly its points hold it against the softest motion that bends nothing, over E I/length^3; at most 1.

        The motions are 1 - x/L and x/L; no point counts for more than the bending stiffness.
        """
        if any(point.held == "clamped" for point in self.points):
            return 1.0
        bent, total = self.bending_stiffness, np.zeros((2, 2))
        for point in self.points:
            share = 1.0 if point.held == "pinned" else min(1.0, point.stiffness[plane] / bent)
            motion = np.array([1.0 - point.at / self.length, point.at / self.length])
            total += share * np.outer(motion, motion)
        return float(min(1.0, np.linalg.eigvalsh(total)[0]))

    @property
    def bending_stiffness(self) -> float:
        """E I/length^3 of its weakest section, N/m."""
        sections = [
            each.youngs_modulus * math.pi / 64.0 * (each.outer[end] ** 4 - each.bore[end] ** 4)
            for each in self.segments for end in (0, 1)
        ]  # fmt: skip
        return min(sections) / self.length**3


@dataclass(frozen=True)
class Cell:
    """One element: where it lies, its section and its unknowns."""

    start: float  # m
    section: Section
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
    frequency: float  # rad/s up to which the elements are fine enough
    shear: bool

    def support(self, what: Literal["stiffness", "damping"], plane: int) -> FloatArray:
        """(n, n) springs, N/m, or dampers, N s/m, of the points in a plane."""
        matrix = np.zeros_like(self.stiffness)
        for point, row in zip(self.beam.points, self.place, strict=True):
            matrix[row, row] += getattr(point, what)[plane]
        return matrix


def assemble_lateral(
    beam: Beam, *, frequency: float = 0.0, shear: bool = False, rotary_inertia: bool = True, elements: int = 1
) -> LateralSystem:
    """The system of a shaft, divided finely enough for a highest frequency, rad/s, and into `elements` at least.

    An interval between two points or changes of section has as many elements as keep the bending wave's phase along
    one of them below LONGEST_PHASE. rotary_inertia False is the beam of Euler: no inertia and no gyroscopic moment of
    the sections. shear True is the beam of Timoshenko with the coefficient of Cowper. Raises ValueError for a beam
    without length or a point beside it, SolveError where too many elements were needed.
    """
    cells, nodes = _cells(beam, frequency, shear, elements)
    order = int(cells[-1].unknowns.max()) + 1
    stiffness, lossy, inertia, gyroscopic = (np.zeros((order, order)) for _ in range(4))
    for cell in cells:
        at = np.ix_(cell.unknowns, cell.unknowns)
        local = element(cell.section, shear)
        stiffness[at] += local.stiffness
        lossy[at] += cell.section.loss_factor * local.stiffness
        inertia[at] += local.mass + (local.rotary if rotary_inertia else 0.0)
        gyroscopic[at] += 2.0 * local.rotary if rotary_inertia else 0.0
    place = np.array([2 * int(np.argmin(np.abs(nodes - point.at))) for point in beam.points], dtype=np.intp)
    held: set[int] = set()
    for point, row in zip(beam.points, place.tolist(), strict=True):
        inertia[row, row] += point.mass
        inertia[row + 1, row + 1] += point.diametral
        gyroscopic[row + 1, row + 1] += point.polar
        held |= {"free": set(), "pinned": {row}, "clamped": {row, row + 1}}[point.held]
    free = np.array([k for k in range(order) if k not in held], dtype=np.intp)
    return LateralSystem(beam, cells, stiffness, lossy, inertia, gyroscopic, free, place, frequency, shear)


def _cells(beam: Beam, frequency: float, shear: bool, elements: int) -> tuple[tuple[Cell, ...], FloatArray]:
    """Elements from start to end, and the places of their nodes, m."""
    if not beam.length > 0 or any(not 0 <= point.at <= beam.length * (1 + 1e-12) for point in beam.points):
        raise ValueError(f"{beam.name or 'beam'}: it has no length, or a point stands beside it")
    sections: list[tuple[float, Section]] = []
    begin = 0.0
    for segment in beam.segments:
        marks = [p.at - begin for p in beam.points if _apart(p.at - begin, 0.0, beam) and p.at - begin > 0]
        inner = sorted({mark for mark in marks if mark < segment.length and _apart(mark, segment.length, beam)})
        ends = [0.0, *inner, segment.length]
        for left, right in pairwise(ends):
            sections += _divided(segment, begin, (left, right), (frequency, shear, elements))
        begin += segment.length
    if len(sections) > MOST_ELEMENTS:
        why = f"its bending needs {len(sections)} elements, and at most {MOST_ELEMENTS} are possible"
        raise SolveError(f"{beam.name or 'beam'}: {why}; request fewer `modes` or lower `speeds`")
    starts = [start for start, _ in sections]
    inside = size(shear) - 4
    first = 2 * (len(sections) + 1)
    cells = [
        Cell(start, section, np.r_[end_unknowns(k), first + inside * k : first + inside * (k + 1)])
        for k, (start, section) in enumerate(sections)
    ]
    return tuple(cells), np.array([*starts, beam.length])


def _apart(place: float, other: float, beam: Beam) -> bool:
    """Two places are not one but for rounding."""
    return abs(place - other) > 1e-12 * beam.length


def _divided(
    segment: Segment, begin: float, part: tuple[float, float], asked: tuple[float, bool, int]
) -> list[tuple[float, Section]]:
    """Elements of the part (from, to) of a segment that starts at `begin`."""
    frequency, shear, elements = asked
    left, right = part

    def section(start: float, end: float) -> Section:
        share = np.array([start, end]) / segment.length
        outer, bore = (ends[0] + (ends[1] - ends[0]) * share for ends in (segment.outer, segment.bore))
        return Section(
            end - start, (float(outer[0]), float(outer[1])), (float(bore[0]), float(bore[1])),
            segment.youngs_modulus, segment.density, segment.shear_modulus, segment.loss_factor,
        )  # fmt: skip

    whole = section(left, right)
    steep = abs(math.log(whole.outer[1] / whole.outer[0])) / math.log(STEEPEST)
    number = max(elements, math.ceil(whole.phase(frequency, shear) / LONGEST_PHASE), math.ceil(steep))
    ends = np.linspace(left, right, number + 1).tolist()
    pairs = pairwise(ends)
    return [(begin + start, section(start, end)) for start, end in pairs]
