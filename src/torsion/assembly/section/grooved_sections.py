"""Torsion of a round section with equal grooves (keyway, splines): largest shear stress over that of the plain one.

Half of one groove's sector is meshed: its outline and a circle within are joined by straight lines, which a keyway
does not cut, and that circle and the bore or axis by radii. On the two mirror lines the stress function has no slope
across, and the warping is 0. x is the distance from the groove's axis y; angles count from y.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import skfem

from torsion.arrays import FloatArray
from torsion.assembly.section.section_mesh import Triangles
from torsion.assembly.section.section_torsion import (
    ORDER,
    largest_slope,
    plane_forms,
    shape_of,
    stress_function,
)
from torsion.assembly.triangle_fields import solve_symmetric
from torsion.errors import SolveError

STEADY = 1e-3  # relative error at which the triangles are fine enough
ROUNDS = 4  # of halving the sides of the first mesh
IN_FILLET = 3  # sides along a fillet in the first mesh
WIDEST = math.radians(15.0)  # a side of the outer circle
FANNED = 1.3  # rad, at most, that floor, fillet and flank take of the circle within
FAN = 0.2, 0.5, 0.8  # shares of that at the ends of the fillet and at the top of the flank
SLANT = 0.6  # of the angle at which a line from the outline would touch the circle within
SLIGHT = 0.02  # of the rest of the circle within, at least, for a flank
BELOW = 1.5  # halves of a tooth's sector, at most, from the root to the circle within: no slivers below many teeth
CLOSE = 1e-9  # relative to the radius: on a line


@dataclass(frozen=True)
class Piece:
    """A straight or round piece of the outline, from the groove's axis on, lengths in radii of the shaft."""

    start: tuple[float, float]
    end: tuple[float, float]
    within: tuple[float, float]  # angles on the circle within to which its ends are joined
    sides: tuple[float, ...]  # shares of it at which its sides end, from 0 to 1
    center: tuple[float, float] | None = None  # of an arc, taken the shorter way around

    def at(self, share: FloatArray) -> FloatArray:
        """Return the points there, (2, shares)."""
        start, end = np.array(self.start), np.array(self.end)
        if self.center is None:
            return start[:, None] + np.outer(end - start, share)
        center = np.array(self.center)
        turn = [math.atan2(*(point - center)[::-1]) for point in (start, end)]
        swept = math.remainder(turn[1] - turn[0], math.tau) * share
        return center[:, None] + math.dist(start, center) * np.array(
            [np.cos(turn[0] + swept), np.sin(turn[0] + swept)]
        )


@dataclass(frozen=True)
class Grooved:
    """The section of a shaft of radius 1."""

    pieces: tuple[Piece, ...]
    number: int  # of grooves
    within: float  # radius of the circle within
    bore: float  # radius
    first: float  # share of the way to the circle within at which the first triangles end


@dataclass(frozen=True)
class GrooveStress:
    """Largest shear stress / that of the plain section at the same torque, and the torsion constant."""

    factor: float  # K_t
    error: float  # relative: half the difference of what both fields say, or the last change
    constant: tuple[
        float, float
    ]  # bounds of the torsion constant of radius 1, of the outline as meshed
    slope: float  # largest stress / (shear modulus * twist per length * radius)


def keyway(
    width: float, depth: float, fillet: float, number: int = 1, bore: float = 0.0
) -> Grooved:
    """Grooves with parallel flanks and a flat floor, `depth` below the circumference; all in radii of the shaft."""
    half, floor = width / 2.0, 1.0 - depth
    points = [
        (0.0, floor),
        (half - fillet, floor),
        (half, floor + fillet),
        (half, math.sqrt(1.0 - half * half)),
    ]
    return _grooved(points, fillet, number, bore, is_flat=True)


def splines(root: float, tooth: float, fillet: float, number: int, bore: float = 0.0) -> Grooved:
    """Straight-sided splines: radius of the root circle, width of a tooth, fillet between; in radii of the shaft."""
    pitch, half = math.pi / number, tooth / 2.0
    away = math.asin(
        (half + fillet) / (root + fillet)
    )  # of the fillet's centre from the middle of the tooth
    along = (root + fillet) * math.cos(away)
    polar = [
        (root, pitch - away),
        (math.hypot(half, along), pitch - math.atan2(half, along)),
        (1.0, pitch - math.asin(half)),
    ]
    turned = [(radius * math.sin(angle), radius * math.cos(angle)) for radius, angle in polar]
    points = [(0.0, root), *turned]
    return _grooved(points, fillet, number, bore, is_flat=False)


def _grooved(
    points: list[tuple[float, float]], fillet: float, number: int, bore: float, *, is_flat: bool
) -> Grooved:
    """Floor, fillet, flank and circumference, from the groove's axis on; a floor that is not flat is round.

    The ends of a fillet are joined to the circle within straight down from a flat floor, toward the axis from a round
    one.
    """
    (_, root), (x, y), (half, _), _ = points
    innermost = max(bore, half) if is_flat else bore
    within = (
        innermost + (root - innermost) * 0.5
    )  # between the floor and what is below it, wide enough for the flanks
    if not is_flat:
        within = max(within, root * (1.0 - BELOW * math.pi / number))
    angles = [
        math.asin(point[0] / within) if is_flat else math.atan2(*point) for point in points[1:3]
    ]
    center = (x, y + fillet) if is_flat else (x * (1.0 + fillet / root), y * (1.0 + fillet / root))
    floor = None if is_flat else (0.0, 0.0)
    last = math.pi / number
    fine = fillet / IN_FILLET
    lengths = [math.dist(*pair) for pair in pairwise(points)]
    reach = min(last, FANNED) - angles[0]
    low, high, top = (
        min(
            angles[0] + share * reach,
            math.atan2(*point) + SLANT * math.acos(within / math.hypot(*point)),
        )
        for share, point in zip(FAN, points[1:], strict=True)
    )
    low, high = max(low, angles[0]), max(high, angles[1])
    top = max(top, high + SLIGHT * (last - high))
    arc = last - math.atan2(*points[3])
    pieces = [
        Piece(points[0], points[1], (0.0, low), graded(lengths[0], fine, at_end=True), floor),
        Piece(
            points[1], points[2], (low, high), tuple(np.linspace(0.0, 1.0, IN_FILLET + 1)), center
        ),
        Piece(points[2], points[3], (high, top), graded(lengths[2], fine)),
        Piece(
            points[3],
            (math.sin(last), math.cos(last)),
            (top, last),
            graded(arc, max(fine, lengths[2] / 4.0), longest=WIDEST),
            (0.0, 0.0),
        ),
    ]
    kept = tuple(piece for piece in pieces if math.dist(piece.start, piece.end) > CLOSE)
    foot, below = points[2], (within * math.sin(high), within * math.cos(high))
    return Grooved(kept, number, within, bore, min(fine / math.dist(foot, below), 0.5))


def graded(
    length: float, first: float, *, at_end: bool = False, longest: float = math.inf
) -> tuple[float, ...]:
    """Shares of a piece at which its sides end, each twice as long as the one before it.

    >>> graded(7.0, 1.0), graded(3.0, 1.0, at_end=True)
    ((0.0, 0.14285714285714285, 0.42857142857142855, 1.0), (0.0, 0.6666666666666667, 1.0))
    """
    ends, step = [0.0], first
    while ends[-1] + 1.5 * step < length:
        ends.append(ends[-1] + step)
        step = min(2.0 * step, longest)
    shares = [end / length if length else 0.0 for end in ends] + [1.0]
    return tuple(1.0 - share for share in reversed(shares)) if at_end else tuple(shares)


@lru_cache(maxsize=256)
def groove_stress(section: Grooved) -> GrooveStress:
    """K_t of the grooves, the triangles halved until both fields agree.

    The stress function says the stress as |grad phi|, the warping as |grad omega + (-y, x)|; their mean is reported.
    Raises SolveError where the two do not meet.

    >>> round(groove_stress(keyway(0.5, 0.25, 0.1)).factor, 2)
    2.02
    """
    before = math.inf
    for halved in range(ROUNDS):
        stress = on_mesh(section, 2**halved)
        error = max(stress.error, abs(stress.factor - before) / stress.factor)
        if error <= STEADY:
            return replace(stress, error=error)
        before = stress.factor
    raise SolveError("the stress in a groove does not converge", "look at its dimensions")


def on_mesh(section: Grooved, divided: int) -> GrooveStress:
    """What the first mesh says with each of its sides divided into so many."""
    mesh = sector(section, divided)
    shape = shape_of(mesh)
    basis = skfem.Basis(shape, skfem.ElementTriP4(), intorder=ORDER)
    stiffness, turning, polar = plane_forms(basis)

    # Facets on the mirror lines, on the outline and on the bore.
    all_facets, last = np.asarray(shape.boundary_facets()), math.pi / section.number
    x, y = shape.p[:, shape.facets[:, all_facets]]
    lines = (np.abs(x * math.cos(turn) - y * math.sin(turn)) < CLOSE for turn in (0.0, last))
    on_mirror = np.any([line.all(axis=0) for line in lines], axis=0)
    on_bore = ~on_mirror & (np.abs(np.hypot(x, y) - section.bore) < CLOSE).all(axis=0)
    mirrors, outer, inner = (
        all_facets[chosen] for chosen in (on_mirror, ~on_mirror & ~on_bore, on_bore)
    )
    facets = np.concatenate([outer, inner])
    hole = section.bore**2 * math.pi / section.number / 2.0
    loop, area = np.repeat([0, 1], [len(outer), len(inner)]), np.array([0.0, -hole])
    lower, phi = stress_function(basis, stiffness, facets, loop, area[: 1 + bool(len(inner))])
    free = np.setdiff1d(np.arange(basis.N), basis.get_dofs(mirrors).all())
    warping = np.zeros(basis.N)
    warping[free] = solve_symmetric(stiffness[free][:, free], turning[free])
    upper = polar - float(turning @ warping)
    low, high = (2.0 * section.number * bound for bound in (lower, upper))
    slopes = largest_slope(basis, phi)[0], largest_slope(basis, warping, turning=1.0)[0]
    slope, difference = sum(slopes) / 2.0, abs(slopes[1] - slopes[0]) / sum(slopes)
    plain = math.pi / 2.0 * (1.0 - section.bore**4)
    return GrooveStress(slope * plain / ((low + high) / 2.0), difference, (low, high), slope)


def sector(section: Grooved, divided: int) -> Triangles:
    """Quadratic triangles of half a sector, each side of the first mesh divided into so many."""
    outline, angles = [], []
    for number, piece in enumerate(section.pieces):
        share = _nodes(piece.sides, divided)[bool(number) :]
        outline.append(piece.at(share))
        angles.append(piece.within[0] + (piece.within[1] - piece.within[0]) * share)
    rim, turn = np.concatenate(outline, axis=1), np.concatenate(angles)
    circle = np.array([np.sin(turn), np.cos(turn)])
    toward = _nodes(graded(1.0, section.first), divided)
    down = _nodes(graded(1.0, 0.4), divided)[1:]
    radii = section.within + (section.bore - section.within) * down
    points = np.concatenate(
        [
            rim[:, :, None] * (1.0 - toward) + section.within * circle[:, :, None] * toward,
            circle[:, :, None] * radii,
        ],
        axis=2,
    )
    along, across = points.shape[1:]
    places = np.arange(along * across).reshape(along, across)
    if not section.bore:
        places[:, -1] = places[0, -1]

    # Two triangles to a cell of three by three nodes; one where its last side is a point.
    cells = slice(None) if section.bore else slice(None, -1)
    grid = {
        (i, k): places[i : along - 2 + i : 2, k : across - 2 + k : 2]
        for i in range(3)
        for k in range(3)
    }
    lower_half = [(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)]
    upper_half = [(0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1)]
    triangles = [
        np.stack([grid[key][:, cells].ravel() for key in keys], axis=1)
        for keys in (lower_half, upper_half)
    ]
    if not section.bore:
        last = [(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (0, 1)]
        triangles.append(np.stack([grid[key][:, -1] for key in last], axis=1))
    nodes = np.concatenate(triangles)
    used, position = np.unique(nodes, return_inverse=True)
    return Triangles(points.reshape(2, -1).T[used], position.reshape(nodes.shape).astype(np.int64))


def _nodes(breaks: Sequence[float], divided: int) -> FloatArray:
    """The ends and middles of all sides, each divided into so many."""
    shares = np.linspace(0.0, 1.0, 2 * divided + 1)[1:]
    first, last = np.array(breaks[:-1]), np.array(breaks[1:])
    return np.concatenate([[0.0], (first[:, None] + np.outer(last - first, shares)).ravel()])
