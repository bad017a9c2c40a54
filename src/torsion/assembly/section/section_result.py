"""A cross-section by mesh: torsion constant, polar moment and stress modulus, with how far each can be trusted."""

from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import skfem

from torsion.arrays import BoolArray, FloatArray
from torsion.assembly.section.section_mesh import (
    Boundary,
    SectionFault,
    Triangles,
    boundary,
    edges_of,
    read_triangles,
    refined,
)
from torsion.assembly.section.section_torsion import Level, Moments, moments, solve_level
from torsion.kernels.trees.tree import connected
from torsion.primitives import SectionMesh

SAME = 1e-9  # of the extent: points nearer than this are one
FLAT = 1e-10  # of a triangle's longest side squared: twice the area of one that is a line
SMALLEST, LARGEST = 1e-6, 1e3  # m, extent of a section; beyond it the unit is wrong
_BLOCK = 256  # sides that are compared with all others at once


def sound(mesh: Triangles) -> Triangles:
    """The mesh with its triangles counterclockwise; raises SectionFault where it is not one whole cross-section.

    Overlaps are found without comparing triangles: where all turn the same way, a point is covered as often as the
    boundary winds around it, and that is once where the boundary has one outline and does not meet itself.
    """
    from scipy.spatial import cKDTree

    tolerance = SAME * float(np.ptp(mesh.points, axis=0).max())
    mesh = _counterclockwise(mesh)
    corners = mesh.points[np.unique(mesh.nodes[:, :3])]
    pairs = cKDTree(corners).query_pairs(tolerance, output_type="ndarray")
    if len(pairs):
        hint = "merge them, so that triangles join"
        raise SectionFault("two points of the mesh coincide", hint, corners[pairs[0, 0]])

    # Two triangles at a side run along it in opposite directions and have the same node amid it.
    sides, edges = mesh.sides, edges_of(mesh.sides)[2]
    count, forward = np.bincount(edges), np.bincount(edges, weights=sides[:, 0] < sides[:, 1])
    bad = ((count > 2) | ((count == 2) & (forward != 1)))[edges]
    if np.any(bad):
        hint = "a side belongs to one triangle or to two, one on each hand"
        raise SectionFault("triangles overlap", hint, mesh.points[sides[np.argmax(bad), 0]])
    low = np.full(len(count), len(mesh.points))
    np.minimum.at(low, edges, sides[:, 2])
    torn = sides[:, 2] != low[edges]
    if np.any(torn):
        point = mesh.points[sides[np.argmax(torn), 2]]
        raise SectionFault(
            "two triangles do not share the node amid their side", "mesh anew", point
        )
    ends = mesh.sides[:, :2].T
    pieces = len(np.unique(connected(len(mesh.points), *ends)[ends[0]]))
    if pieces > 1:
        raise SectionFault(f"the mesh is in {pieces} pieces", "a cross-section is one piece")
    edge = boundary(mesh)
    _refuse_meetings(mesh, edge, tolerance)
    passed = np.bincount(edge.sides[:, 0], minlength=len(mesh.points))
    if np.any(passed > 1):
        message, point = "the parts of the section meet only in a point", np.argmax(passed)
        raise SectionFault(message, "a cross-section is one piece", mesh.points[point])
    if np.count_nonzero(edge.area > 0) != 1:
        hint = "one outline around the section, holes within it"
        raise SectionFault("the triangles overlap", hint)
    return mesh


def _counterclockwise(mesh: Triangles) -> Triangles:
    """All triangles turned if all are clockwise (seen from behind); raises SectionFault if only some are."""
    # Determinant (triangles, 7) of the map from the unit triangle, at its six nodes and in its middle.
    at = np.array([[0, 1, 0, 0.5, 0.5, 0, 1 / 3], [0, 0, 1, 0, 0.5, 0.5, 1 / 3]])
    shape = skfem.MeshTri2(*(np.ascontiguousarray(rows.T) for rows in (mesh.points, mesh.nodes)))
    by = partial(shape.mapping().J, X=at)
    twice = np.asarray(by(0, 0) * by(1, 1) - by(0, 1) * by(1, 0))
    x = mesh.points[mesh.nodes[:, :3]]
    longest = np.max(np.sum((x - np.roll(x, 1, axis=1)) ** 2, axis=2), axis=1)
    small = np.min(np.abs(twice), axis=1) <= FLAT * longest
    if np.any(small):
        raise _triangle(mesh, small, "has no area", "remove it or mesh anew")
    if np.all(twice < 0):
        return Triangles(mesh.points, mesh.nodes[:, [0, 2, 1, 5, 4, 3]])
    turned = np.any(twice < 0, axis=1) & np.any(twice > 0, axis=1)
    if np.any(turned):
        raise _triangle(mesh, turned, "is turned inside out by a node amid its sides", "mesh anew")
    inverted = twice[:, 0] < 0
    if np.any(inverted):
        minority = inverted if np.count_nonzero(inverted) * 2 <= len(inverted) else ~inverted
        raise _triangle(
            mesh, minority, "is inverted", "the corners of all triangles turn the same way"
        )
    return mesh


def _triangle(mesh: Triangles, where: BoolArray, what: str, hint: str) -> SectionFault:
    """The fault of the first of some triangles."""
    first = int(np.argmax(where))
    return SectionFault(
        f"triangle {first + 1} {what},", hint, mesh.points[mesh.nodes[first, :3]].mean(axis=0)
    )


def _refuse_meetings(mesh: Triangles, edge: Boundary, tolerance: float) -> None:
    """The boundary nowhere touches or crosses itself: no overlap, no crack, no hanging node."""
    first, last, amid = edge.sides.T
    start, end = np.concatenate([first, amid]), np.concatenate([amid, last])
    p, q = mesh.points[start], mesh.points[end]
    low, high = np.minimum(p, q) - tolerance, np.maximum(p, q) + tolerance
    for begin in range(0, len(start), _BLOCK):
        block = slice(begin, begin + _BLOCK)
        near = np.all((low[block, None] <= high) & (low <= high[block, None]), axis=2)
        side, facing = np.nonzero(
            near & (np.arange(len(start)) > np.arange(begin, begin + len(near))[:, None])
        )
        side = side + begin

        # Segments (2, pairs) that touch or cross, but at an end that they share.
        segment, other = (np.stack([start[some], end[some]]) for some in (side, facing))
        touches, apart = np.zeros(len(side), dtype=bool), list[BoolArray]()
        for (a, b), ends in ((segment, other), (other, segment)):
            origin, along = mesh.points[a], mesh.points[b] - mesh.points[a]
            hand = list[FloatArray]()
            for point in ends:
                x, y = (mesh.points[point] - origin).T
                hand.append(np.sign(along[:, 0] * y - along[:, 1] * x))
                share = (x * along[:, 0] + y * along[:, 1]) / (along**2).sum(axis=1)
                share = np.clip(share, 0.0, 1.0)
                away = np.hypot(x - share * along[:, 0], y - share * along[:, 1])
                touches |= (point != a) & (point != b) & (away <= tolerance)
            apart.append(hand[0] * hand[1] < 0)
        shared = (segment[:, None] == other).any(axis=(0, 1))
        meets = touches | (~shared & apart[0] & apart[1])
        if np.any(meets):
            hint = "no overlaps, no cracks and no hanging nodes: neighbours share their corners"
            raise SectionFault(
                "the boundary of the section meets itself", hint, p[side[np.argmax(meets)]]
            )


FEW = 2_000  # triangles of a mesh that is solved with degree 4; a finer one needs no more than degree 2
LEVELS = 3  # the mesh, its refinement, and one more
QUICK = 3_000  # triangles that one more refinement may make
# Relative: gap of the bounds, last change of the stress; no further refinement below both.
CLOSE, STEADY = 1e-9, 1e-6
# Relative change of the stress by the last refinement, up to which it counts as known.
SETTLED = 0.05
# Centroid from the origin / radius of gyration; a keyway according to DIN 6885 makes 0.05.
OFF_AXIS = 0.1


@dataclass(frozen=True)
class SectionResult:
    """Constants of a cross-section, SI units; the axis of the shaft is the origin of the mesh.

    The torsion constant is the middle of its bounds on the finest level, which hold but for rounding. They are those
    of the outline as meshed: straight triangles make a polygon of a circle, and refinement does not mend that.
    """

    file: str
    moments: Moments  # m2, m, m4
    levels: tuple[Level, ...]  # m; the mesh, then every refinement
    degree: int  # of the elements

    @property
    def torsion_constant(self) -> float:
        """Middle of the bounds on the finest level, m4."""
        return (self.levels[-1].lower + self.levels[-1].upper) / 2.0

    @property
    def error(self) -> float:
        """Half the gap between the bounds of the torsion constant, relative."""
        return abs(self.levels[-1].upper - self.levels[-1].lower) / 2.0 / self.torsion_constant

    @property
    def changes(self) -> tuple[float, ...]:
        """Relative change of the largest stress (at one twist) by each refinement."""
        return tuple(
            abs(fine.stress / coarse.stress - 1.0) for coarse, fine in pairwise(self.levels)
        )

    @property
    def stress_modulus(self) -> float:
        """Torque / largest shear stress, m3; NaN where the stress grows with every refinement, at a sharp corner."""
        return (
            self.torsion_constant / self.levels[-1].stress
            if self.changes[-1] <= SETTLED
            else float("nan")
        )

    @property
    def words(self) -> str:
        """One line for the plan of a report."""
        stress = f"W_t {self.stress_modulus:.6g} m3, last changed by {self.changes[-1]:.1g}"
        if self.changes[-1] > SETTLED:
            stress = f"no W_t: refinement raises the stress (by {self.changes[-1]:.1g}), as at a sharp inner corner"
        off_axis = np.hypot(*self.moments.centroid)
        triangles = ", ".join(str(level.triangles) for level in self.levels)
        return (
            f"{Path(self.file).name}: I_t {self.torsion_constant:.10g} m4 within {self.error:.1g} (two-sided bound), "
            f"I_p {self.moments.polar:.10g} m4 about the origin, centroid {off_axis:.3g} m off it, {stress}; "
            f"{triangles} triangles of degree {self.degree}"
        )


def section_result(mesh: SectionMesh) -> SectionResult:
    """The cross-section in a mesh file, solved once as long as the file stays the same. Raises SectionFault."""
    return _solved(mesh, _stamp(mesh.file))


def section_mesh(mesh: SectionMesh) -> Triangles:
    """The triangles of a cross-section in metres, all conditions checked. Raises SectionFault."""
    return _checked(mesh, _stamp(mesh.file))


def _stamp(file: str) -> tuple[int, int]:
    """Time and size of a file; zeros where it cannot be read, which reading it will report."""
    try:
        seen = Path(file).stat()
    except (OSError, ValueError):
        return 0, 0
    return seen.st_mtime_ns, seen.st_size


@lru_cache(maxsize=64)
def _checked(mesh: SectionMesh, _: tuple[int, int]) -> Triangles:
    mesh_as_drawn = read_triangles(mesh.file)
    extent = float(np.ptp(mesh_as_drawn.points, axis=0).max()) * mesh.scale
    unit = "`unit` is the unit of the mesh: m, cm, mm or in"
    if not SMALLEST <= extent <= LARGEST:
        raise SectionFault(f"the section is {extent:.3g} m wide", unit)
    if extent > mesh.widest:
        usual = f"usual: at most {mesh.widest:g} m"
        hint = f"{unit}; {usual}; if it is meant, `unusual: true` on the shaft says so"
        raise SectionFault(f"the section is {extent:.3g} m wide", hint)
    mesh_as_drawn = sound(mesh_as_drawn)
    scaled = Triangles(mesh_as_drawn.points * mesh.scale, mesh_as_drawn.nodes)
    section_moments = moments(scaled)
    eccentricity = np.hypot(*section_moments.centroid)
    gyration2 = section_moments.polar / section_moments.area
    if eccentricity > OFF_AXIS * np.sqrt(gyration2 - eccentricity**2):
        x, y = (value / mesh.scale for value in section_moments.centroid)
        raise SectionFault(
            f"the centroid of the section, ({x:.6g}, {y:.6g}), is not on the axis of the shaft",
            "the origin of the mesh is the axis; a keyway may move the centroid, but little",
        )
    return scaled


@lru_cache(maxsize=64)
def _solved(mesh: SectionMesh, stamp: tuple[int, int]) -> SectionResult:
    triangles = _checked(mesh, stamp)
    section_moments, degree = moments(triangles), 4 if len(triangles.nodes) <= FEW else 2
    levels = [solve_level(triangles, degree)]
    while len(levels) < LEVELS:
        if len(levels) > 1:
            before, last = levels[-2:]
            is_close = last.upper - last.lower <= CLOSE * last.upper
            is_steady = abs(last.stress / before.stress - 1.0) <= STEADY
            if 4 * len(triangles.nodes) > QUICK or (is_close and is_steady):
                break
        triangles = refined(triangles)
        levels.append(solve_level(triangles, degree))
    return SectionResult(mesh.file, section_moments, tuple(levels), degree)
