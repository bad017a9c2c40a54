"""A coarse mesh of the meridian of a round shaft line, graded to its corners, and its refinement along curved fillets.

Slabs between lines across the shaft, each in triangles between the points on its two lines; a fan of triangles from a
point inside surrounds a filled corner, so that no triangle ends in the cusp between a fillet and its tangent. All
coordinates are (z, r).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import skfem

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.junction.profile import Corner, Profile

CLOSE = 1e-9  # relative to the largest radius: one point
SLICES = 8  # of the fan in a fillet
GRADING = 2.0  # from line to line away from a corner
# To so many lines, more than any wall takes.
GRADINGS = GRADING ** np.arange(24.0)
CROWDED = 0.35  # of a point's distance from its corner: no second point so near


@dataclass(frozen=True)
class Arc:
    """A fillet: its circle, and the box in which every point of the boundary is on it."""

    center: tuple[float, float]
    radius: float
    box: tuple[tuple[float, float], tuple[float, float]]  # of z, of r


@dataclass(frozen=True)
class Meridian:
    """A mesh and what its refinement must know."""

    mesh: Any  # skfem.MeshTri1
    arcs: tuple[Arc, ...]
    sharp: tuple[tuple[float, float], ...]  # corners at which the stress is unbounded
    core: float  # radius up to which the stress function is a multiple of r^4; 0 where the whole line is bored

    def refined(self, marked: Any) -> "Meridian":
        """Some of its triangles divided, new points of a fillet moved to its circle."""
        mesh = self.mesh.refined(marked)
        outline = np.zeros(mesh.p.shape[1], dtype=bool)
        outline[mesh.boundary_nodes()] = True
        return replace(self, mesh=skfem.MeshTri1(self._snapped(mesh.p, outline), mesh.t))

    def _snapped(self, points: FloatArray, outline: BoolArray) -> FloatArray:
        """The points (2, points) with those of the outline in a fillet moved to its circle."""
        moved = np.ascontiguousarray(points)
        for arc in self.arcs:
            (z0, z1), (r0, r1) = arc.box
            (z, r), edge = moved, CLOSE * max(r1, abs(z1))
            inside = outline & (z > z0 + edge) & (z < z1 - edge) & (r > r0 + edge) & (r < r1 - edge)
            center = np.array(arc.center)[:, None]
            away, moved = moved[:, inside] - center, moved.copy()
            moved[:, inside] = center + away * (arc.radius / np.hypot(*away))
        return moved

    def graded(self, times: int) -> "Meridian":
        """The triangles at sharp corners divided several times."""
        graded = self
        for _ in range(times if self.sharp else 0):
            z, r = graded.mesh.p
            is_sharp = np.any(
                [np.hypot(z - z0, r - r0) <= CLOSE * r0 for z0, r0 in self.sharp], axis=0
            )
            graded = graded.refined(np.flatnonzero(is_sharp[graded.mesh.t].any(axis=0)))
        return graded

    @property
    def fillets(self) -> IntArray:
        """Numbers of the mesh's facets along its fillets."""
        facets = np.asarray(self.mesh.boundary_facets())
        z, r = self.mesh.p[:, self.mesh.facets[:, facets]].mean(axis=1)
        is_round = np.zeros(len(facets), dtype=bool)
        for arc in self.arcs:
            (z0, z1), (r0, r1) = arc.box
            is_round |= (z > z0) & (z < z1) & (r > r0) & (r < r1)
        return facets[is_round]

    @property
    def curved(self) -> Any:
        """The mesh with curved sides along fillets."""
        if not self.arcs:
            return self.mesh
        second = skfem.MeshTri2.from_mesh(self.mesh)
        outline = np.zeros(second.doflocs.shape[1], dtype=bool)
        vertices = self.mesh.p.shape[1]
        outline[:vertices][self.mesh.boundary_nodes()] = True
        outline[vertices + self.mesh.boundary_facets()] = True
        return skfem.MeshTri2(self._snapped(second.doflocs, outline), second.t)


@dataclass(frozen=True)
class _Fill:
    """What fills a corner, and the patch around it that is meshed by a fan."""

    corner: Corner
    z: float
    r: float
    begin: float  # z where it begins on the smaller shaft
    top: float  # r where it ends on the face
    behind: float  # z behind the face where the patch ends
    below: float  # r below the corner where it ends
    span: tuple[float, float]  # ends of the patch along the axis, ascending
    size: float  # of the triangles that it wants beside it


def meridian(profile: Profile) -> Meridian:
    """The coarse mesh of a line. Raises ValueError where a corner cannot be filled as stated."""
    thinnest = min(min(length.outer) for length in profile.lengths)
    core = thinnest / 4.0 if any(0.0 in length.bore for length in profile.lengths) else 0.0
    fills = _fills(profile, core)
    grains, sharp = _grains(profile, fills)

    # Lines across the shaft: where a length or a patch ends, and graded away from every corner.
    kept = [*profile.places, *(z for fill in fills for z in fill.span)]
    wanted = [
        (z + side * step, step)
        for z, _, size in grains
        for step in size * GRADINGS
        for side in (-1, 1)
    ]
    for begin, length in zip(profile.places, profile.lengths, strict=False):
        wall = (max(length.outer) - min(length.bore)) / 2.0
        number = max(int(length.length / wall), 1)
        wanted += [(begin + length.length * k / number, wall) for k in range(1, number)]
    closed = [fill.span for fill in fills]
    lines = _thinned(
        kept, [line for line in wanted if not any(low < line[0] < high for low, high in closed)]
    )
    radii = [_radii(profile, z, core, fills, grains) for z in lines]
    points = _Points(max(max(length.outer) for length in profile.lengths))
    triangles = list[tuple[int, int, int]]()
    for (z0, left), (z1, right) in pairwise(zip(lines, radii, strict=True)):
        for (low0, low1), (high0, high1) in _strips(profile, (z0, z1), core, fills):
            sides = (z0, left, low0, high0), (z1, right, low1, high1)
            rows = []
            for z, row, low, high in sides:
                inside = [r for r in row if low * (1 - CLOSE) <= r <= high * (1 + CLOSE)]
                rows.append([points.at(z, r) for r in inside])
            triangles += _strip(points, *rows)
    arcs = tuple(arc for fill in fills for arc in _fan(points, triangles, fill))
    mesh = skfem.MeshTri1(np.array(points.found).T.copy(), np.array(triangles).T.copy())
    return Meridian(mesh, arcs, tuple(sharp), core)


@dataclass(frozen=True)
class _Points:
    """Points by their place."""

    scale: float
    found: list[tuple[float, float]] = field(default_factory=list)
    places: dict[tuple[int, int], int] = field(default_factory=dict)

    def at(self, z: float, r: float) -> int:
        """The number of the point there."""
        key = round(z / self.scale / CLOSE), round(r / self.scale / CLOSE)
        for neighbour in ((key[0] + i, key[1] + k) for i in (0, -1, 1) for k in (0, -1, 1)):
            if neighbour in self.places:
                return self.places[neighbour]
        self.found.append((z, r))
        return self.places.setdefault(key, len(self.found) - 1)


def _fills(profile: Profile, core: float) -> list[_Fill]:
    fills = []
    joints = zip(profile.corners, pairwise(profile.lengths), profile.places[1:-1], strict=True)
    for corner, (first, second), z in joints:
        before, after = first.outer[1], second.outer[0]
        if corner is None or before == after:
            continue
        low, high = sorted((before / 2.0, after / 2.0))
        along, up = corner.legs(high - low)
        smaller, larger = (first, second) if before < after else (second, first)
        if along >= smaller.length:
            raise ValueError("a fillet or chamfer is longer than the shaft that it begins on")
        inner = max(2.0 * core, *smaller.bore, *larger.bore) / 2.0
        depth = min(along, (low - inner) / 2.0, larger.length / 3.0)
        begin = z - along if before < after else z + along
        behind = z + math.copysign(depth, z - begin)
        span = min(begin, behind), max(begin, behind)
        size = max(abs(z - begin), up)
        fills.append(_Fill(corner, z, low, begin, low + up, behind, low - depth, span, size))
    return fills


def _grains(
    profile: Profile, fills: list[_Fill]
) -> tuple[list[tuple[float, float, float]], list[tuple[float, float]]]:
    """Every corner (z, r) with the size of the triangles that it wants; and those corners that are sharp."""
    grains = [(fill.z, fill.r, fill.size) for fill in fills]
    sharp = [(fill.begin, fill.r) for fill in fills if fill.corner.kind == "chamfer"]
    filled = {(fill.z, fill.r) for fill in fills}
    walls_at_ends = [
        outer - bore
        for length in profile.lengths
        for outer, bore in zip(length.outer, length.bore, strict=True)
    ]
    wall = min(walls_at_ends) / 2.0
    for z, (before, two) in zip(profile.places[1:], pairwise(profile.lengths), strict=False):
        outer = (before.outer[1] / 2.0, two.outer[0] / 2.0)
        bore = (before.bore[1] / 2.0, two.bore[0] / 2.0)
        for pair, r in (
            (outer, min(outer)),
            (bore, max(bore)),
        ):  # where a face meets the outside, or the inside
            if pair[0] != pair[1] and (z, r) not in filled:
                grains.append((z, r, min(abs(pair[1] - pair[0]), wall) / 2.0))
                sharp.append((z, r))
    if profile.fixed == "face":
        edge = profile.places[-1], profile.lengths[0].outer[1] / 2.0
        grains.append((*edge, wall / 2.0))
        sharp.append(edge)
    return grains, sharp


def _radii(
    profile: Profile,
    z: float,
    core: float,
    fills: list[_Fill],
    grains: Sequence[tuple[float, float, float]],
) -> list[float]:
    """Points on a line across the shaft: its walls on both sides, the core, a patch, graded to corners."""
    # Kept are points on which a boundary lies; wanted ones around corners may be thinned out.
    kept = [r for pair in walls(profile, z, (z, z)) for r in pair]
    low, high = min(kept), max(kept)
    if low < core:
        kept.append(core)
    if low < profile.seat < high:
        kept.append(profile.seat)
    if profile.fixed == "face" and z == profile.places[-1]:
        kept.append(profile.lengths[0].outer[1] / 2.0)
    near = CLOSE * high
    crossed = [
        fill
        for fill in fills
        if min(abs(z - edge) for edge in (fill.begin, fill.z, fill.behind)) <= near
    ]
    kept += [fill.below for fill in crossed]
    kept += [fill.top for fill in crossed if abs(z - fill.begin) > near]
    wanted = [
        (r0 + side * step, step)
        for z0, r0, size in grains
        for step in size * GRADINGS
        if step >= abs(z - z0) / GRADING
        for side in (-1, 0, 1)
    ]
    return _thinned(
        kept,
        [
            (r, step)
            for r, step in wanted
            if max(low, core) < r < high and not any(fill.below < r < fill.top for fill in crossed)
        ],
    )


def _thinned(kept: list[float], wanted: list[tuple[float, float]]) -> list[float]:
    """All that is kept, and of what is wanted with its spacing what does not crowd; inside of what is kept."""
    low, high = min(kept), max(kept)
    radii: list[float] = []
    for radius in sorted(kept):
        if not radii or radius - radii[-1] > CLOSE * high:
            radii.append(radius)
    for radius, step in sorted(wanted, key=lambda pair: pair[1]):
        if low < radius < high and min(abs(radius - present) for present in radii) > CROWDED * step:
            radii.append(radius)
    return sorted(radii)


Pair = tuple[float, float]


def _strips(
    profile: Profile, ends: Pair, core: float, fills: list[_Fill]
) -> list[tuple[Pair, Pair]]:
    """The inner and outer edge of each strip of triangles of a slab, their radii at its two lines."""
    amid = (ends[0] + ends[1]) / 2.0
    (bore0, outer0), (bore1, outer1) = walls(profile, amid, ends)
    edges = [(bore0, bore1), (outer0, outer1)]
    if bore0 < core:
        edges.insert(1, (core, core))
    if bore0 < profile.seat < outer0 * (1.0 - CLOSE):
        edges.insert(-1, (profile.seat, profile.seat))
    strips = list(pairwise(edges))
    for fill in fills:
        if fill.span[0] < amid < fill.span[1]:
            inner, outer = strips.pop()
            strips.append((inner, (fill.below, fill.below)))
            if min(fill.z, fill.behind) < amid < max(fill.z, fill.behind) and fill.top < outer0 * (
                1.0 - CLOSE
            ):
                strips.append(((fill.top, fill.top), outer))
    return strips


def walls(profile: Profile, inside: float, ends: Pair) -> tuple[Pair, Pair]:
    """Bore and outer radius at two places of the length that a place is inside of; of both lengths at their joint."""
    sides = list[Pair]()
    owners = [
        (begin, length)
        for begin, length in zip(profile.places, profile.lengths, strict=False)
        if begin - CLOSE * length.length <= inside <= begin + length.length * (1.0 + CLOSE)
    ]
    for (begin, length), z in zip((owners[0], owners[-1]), ends, strict=True):
        share = (z - begin) / length.length
        bore, outer = (
            (pair[0] + (pair[1] - pair[0]) * share) / 2.0 for pair in (length.bore, length.outer)
        )
        sides.append((bore, outer))
    return sides[0], sides[1]


def _strip(points: _Points, left: list[int], right: list[int]) -> list[tuple[int, int, int]]:
    """Triangles between two rows of points."""
    triangles, i, k = list[tuple[int, int, int]](), 0, 0
    rows = [[points.found[number][1] for number in row] for row in (left, right)]
    share = [[(r - row[0]) / (row[-1] - row[0]) for r in row] for row in rows]
    while i < len(left) - 1 or k < len(right) - 1:
        if k == len(right) - 1 or (i < len(left) - 1 and share[0][i + 1] <= share[1][k + 1]):
            triangles.append((left[i], right[k], left[i + 1]))
            i += 1
        else:
            triangles.append((left[i], right[k], right[k + 1]))
            k += 1
    return triangles


def _fan(points: _Points, triangles: list[tuple[int, int, int]], fill: _Fill) -> list[Arc]:
    """Adds the triangles of a patch; its arc, if it is round."""
    center, radius = (fill.begin, fill.r + fill.corner.size), fill.corner.size
    rim = [(fill.z, fill.top), (fill.begin, fill.r)]
    is_round = fill.corner.kind == "fillet"
    if is_round:
        turns = np.linspace(0.0, math.acos(1.0 - (fill.top - fill.r) / radius), SLICES + 1)[-2:0:-1]
        toward = math.copysign(radius, fill.z - fill.begin)
        rim[1:1] = [
            (center[0] + toward * math.sin(turn), center[1] - radius * math.cos(turn))
            for turn in turns
        ]
    around = [
        (fill.begin, fill.below),
        (fill.z, fill.below),
        (fill.behind, fill.below),
        (fill.behind, fill.top),
        *rim,
    ]
    apex = points.at((fill.z + fill.behind) / 2.0, (fill.r + fill.below) / 2.0)
    loop = [points.at(*point) for point in around]
    triangles += [(apex, corner, two) for corner, two in pairwise([*loop, loop[0]])]
    low, high = sorted((fill.begin, fill.z))
    return [Arc(center, radius, ((low, high), (fill.r, fill.top)))] if is_round else []
