"""A cross-section by mesh: torsion constant, polar moment and stress modulus, with how far each can be trusted."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from torsion.assembly.section.section_checks import refuse_size, sound
from torsion.assembly.section.section_mesh import SectionFault, Triangles, read_triangles, refined
from torsion.assembly.section.section_torsion import Level, Moments, moments, solve_level
from torsion.primitives import Section, SectionMesh

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
    def eccentricity(self) -> float:
        """Distance of the centroid from the axis, m."""
        return float(np.hypot(*self.moments.centroid))

    @property
    def section(self) -> Section:
        """What the train needs of it."""
        return Section(self.torsion_constant, self.moments.polar, self.stress_modulus)

    @property
    def words(self) -> str:
        """One line for the plan of a report."""
        stress = f"W_t {self.stress_modulus:.6g} m3, last changed by {self.changes[-1]:.1g}"
        if self.changes[-1] > SETTLED:
            stress = f"no W_t: refinement raises the stress (by {self.changes[-1]:.1g}), as at a sharp inner corner"
        triangles = ", ".join(str(level.triangles) for level in self.levels)
        return (
            f"{Path(self.file).name}: I_t {self.torsion_constant:.10g} m4 within {self.error:.1g} (two-sided bound), "
            f"I_p {self.moments.polar:.10g} m4 about the origin, centroid {self.eccentricity:.3g} m off it, {stress}; "
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
    refuse_size(float(np.ptp(mesh_as_drawn.points, axis=0).max()) * mesh.scale, mesh.widest)
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
