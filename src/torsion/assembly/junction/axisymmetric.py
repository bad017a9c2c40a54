"""Torsion of a round shaft line of any profile by finite elements (scikit-fem): bounds of its flexibility.

Angle psi(z, r) of a ring (Michell 1899): div(G r^3 grad psi) = 0, on a free surface d psi/dn = 0, the ends plane.
Stiffness 2 pi int G r^3 |grad psi|^2 at a twist of 1: elements store too much, a lower bound of the flexibility.

Stress function phi (Foeppl 1905): the torque / 2 pi inside of a line of constant phi; 0 on the axis or bore, 1 on the
outer surface, div(grad phi / (G r^3)) = 0. Flexibility int |grad phi|^2 / (G r^3) / 2 pi: an upper bound. Around the
axis phi is r^4 times what the elements give, so that the integrals stay finite.

The two together measure their own error in every triangle (Prager and Synge 1947): the integral of
|G r^3 grad psi - rot phi|^2 / (G r^3) sums to the gap of the bounds. It says what to divide.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import skfem
from scipy.sparse import coo_array, csc_array

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.junction.profile import Profile
from torsion.assembly.junction.profile_mesh import CLOSE, Meridian, meridian, walls
from torsion.assembly.triangle_fields import places_along, solve_symmetric
from torsion.errors import SolveError
from torsion.kernels.round_sections import section_modulus
from torsion.sources import source

ORDER = 10  # of the quadrature: r^3 with two gradients of degree 3, and one more for curved sides
GRADED = 10  # halvings of the triangles at a sharp corner before the first solution
SHARE = 0.8  # of the squared gap that the triangles to be divided have
MOST = 10_000  # triangles
FINE = 3e-5  # length in units of the diameter: gap at which the elements are fine enough


@dataclass(frozen=True)
class Bounds:
    """What one mesh says of a line of shear modulus 1."""

    triangles: int
    lower: float  # flexibility, 1/length^3
    upper: float
    gap: FloatArray  # (triangles,) share of upper - lower


@dataclass(frozen=True)
class Solved:
    """A line, solved: lengths in units of the smaller diameter."""

    profile: Profile
    meridian: Meridian
    levels: tuple[Bounds, ...]
    # Bounds of the excess length: of the smaller shaft, over the sum of its lengths each as if it were long.
    excess: tuple[float, float]

    @property
    def excess_length(self) -> float:
        return sum(self.excess) / 2.0

    @property
    def error(self) -> float:
        """Half the gap between the bounds of the excess length."""
        return (self.excess[1] - self.excess[0]) / 2.0


@source("Foeppl1905")
@source("PragerSynge1947")
def solved(profile: Profile, fine: float = FINE) -> Solved:
    """A line by elements of degree 4, divided until the bounds of its excess length are `fine` apart.

    Of an excess length beyond a diameter, in a soft hub, `fine` is a share.
    """
    mesh, levels = meridian(profile).graded(GRADED), list[Bounds]()
    end = profile.smaller
    # Its lengths each as if it were long; of a hub none.
    long = profile.lengths if profile.fixed == "end" else profile.lengths[:-1]
    plain = sum(length.twist for length in long)
    unit = end.twist / end.length * end.outer[0]
    while True:
        bounds, *_ = on_mesh(profile, mesh)
        levels.append(bounds)
        if bounds.upper - bounds.lower <= fine * max(unit, bounds.lower - plain):
            excess = (bounds.lower - plain) / unit, (bounds.upper - plain) / unit
            return Solved(profile, mesh, tuple(levels), excess)
        if bounds.triangles > MOST:
            raise SolveError(
                "the finite elements of a junction do not converge; look at its dimensions"
            )
        mesh = mesh.refined(skfem.adaptive_theta(bounds.gap, theta=1.0 - SHARE))


def on_mesh(profile: Profile, mesh: Meridian) -> tuple[Bounds, Any, FloatArray, FloatArray]:
    """Return the bounds on one mesh, its elements, and psi and phi (unknowns,) for a torque of 2 pi.

    phi is over r^4 / core^4 within the core.
    """
    basis, values, slopes, r, modulus = functions_of(profile, mesh)
    weight = modulus * r**3
    twist = energy_matrix(basis, slopes, weight * basis.dx)
    end, begin, outer, inner = _boundaries(profile, mesh, basis)
    psi = _solution(twist, basis.N, {0.0: begin, 1.0: end})
    stiffness = float(psi @ (twist @ psi))
    inside = r < mesh.core
    share = np.where(inside, r / mesh.core, 1.0) ** 4 if mesh.core else np.ones_like(r)
    steep = np.where(inside, 4.0 * share / r, 0.0)  # d share / dr
    flows = slopes * share
    flows[:, 1] += values * steep
    flow = energy_matrix(basis, flows, basis.dx / weight)
    chi = _solution(flow, basis.N, {0.0: inner, 1.0: outer})
    flexibility = float(chi @ (flow @ chi))
    by_angle, by_function = (
        np.einsum("udtp,ut->dtp", parts, field[basis.element_dofs])
        for parts, field in ((slopes, psi / stiffness), (flows, chi))
    )
    difference = np.array(
        [weight * by_angle[0] - by_function[1], weight * by_angle[1] + by_function[0]]
    )
    gap = np.sum(np.sum(difference**2, axis=0) / weight * basis.dx, axis=1) / (2.0 * math.pi)
    lower, upper = 1.0 / stiffness / (2.0 * math.pi), flexibility / (2.0 * math.pi)
    return Bounds(r.shape[0], lower, upper, gap), basis, psi / stiffness, chi


def functions_of(
    profile: Profile, mesh: Meridian
) -> tuple[Any, FloatArray, FloatArray, FloatArray, FloatArray]:
    """The elements; their functions (unknowns, triangles, places) and slopes (.., z and r, ..); radius and modulus."""
    basis = skfem.Basis(mesh.curved, skfem.ElementTriP4(), intorder=ORDER)
    z, r = np.asarray(basis.global_coordinates())
    values = np.array(
        [np.broadcast_to(np.asarray(function[0]), r.shape) for function in basis.basis]
    )
    slopes = np.array([function[0].grad for function in basis.basis])
    owner = np.searchsorted(np.array(profile.places[1:-1]), z)
    if profile.seat:
        owner = np.where(r < profile.seat, 0, owner)
    return basis, values, slopes, r, np.array([length.modulus for length in profile.lengths])[owner]


def energy_matrix(basis: Any, slopes: FloatArray, weight: FloatArray) -> csc_array:
    """The energy of every pair of unknowns."""
    left = slopes.transpose(2, 0, 1, 3).reshape(slopes.shape[2], slopes.shape[0], -1)
    right = (slopes * weight).transpose(2, 1, 3, 0).reshape(slopes.shape[2], -1, slopes.shape[0])
    energy, unknowns = left @ right, basis.element_dofs.T
    row, column = (
        np.broadcast_to(numbers, energy.shape)
        for numbers in (unknowns[:, :, None], unknowns[:, None, :])
    )
    return csc_array(
        coo_array((energy.ravel(), (row.ravel(), column.ravel())), shape=(basis.N, basis.N))
    )


def _boundaries(profile: Profile, meridian_mesh: Meridian, basis: Any) -> tuple[IntArray, ...]:
    """Unknowns where it is fixed, at its begin, on the outer and on the inner surface; the axis is none of them.

    Where a hub ends the line its last end is free but for the face of the hub, and continues the inner surface.
    """
    mesh = meridian_mesh.mesh
    facets = mesh.boundary_facets()
    z, r = mesh.p[:, mesh.facets[:, facets]].mean(axis=1)
    places = profile.places
    near = CLOSE * places[-1]
    at_begin, at_end = z < near, z > places[-1] - near
    side = ~(at_begin | at_end | (r < near))

    # The outer surface lies beyond a radius that is in the material on both sides of every place.
    sides = np.array([walls(profile, place, (place, place)) for place in z.tolist()])
    middle = (sides[:, :, 1].min(axis=1) + sides[:, :, 0].max(axis=1)) / 2.0
    outer = side & (r > middle)
    fixed, inner = at_end, side & ~outer
    if profile.fixed == "rim":
        fixed = outer & (r > profile.lengths[-1].outer[1] / 2.0 - near)
    elif profile.fixed == "face":
        fixed = at_end & (r > profile.lengths[0].outer[1] / 2.0)
    return tuple(
        np.asarray(basis.get_dofs(facets[chosen]).all(), dtype=np.int64)
        if chosen.any()
        else np.zeros(0, dtype=np.int64)
        for chosen in (fixed, at_begin, outer & ~fixed, inner | (at_end & ~fixed))
    )


def _solution(matrix: Any, number: int, given: dict[float, IntArray]) -> FloatArray:
    """Return the field of least energy with some values given."""
    field, free = np.zeros(number), np.ones(number, dtype=bool)
    for value, unknowns in given.items():
        field[unknowns], free[unknowns] = value, False
    rows = matrix[free]
    field[free] = solve_symmetric(rows[:, free], -(rows @ field))
    return field


STEADY = 1e-3  # relative error at which the triangles are fine enough
ROUNDS = 6


@dataclass(frozen=True)
class FilletStress:
    """Largest shear stress in the fillets / nominal stress T/W_p of the smaller end."""

    factor: float  # K_t
    error: float  # relative: half the difference of what angle and stress function say, or the last change
    place: tuple[float, float]  # z, r where it is


@lru_cache(maxsize=256)
def fillet_stress(profile: Profile, steady: float = STEADY, beyond: float = 0.0) -> FilletStress:
    """K_t of the fillets of a line, the triangles along them divided until both fields agree.

    The angle says the stress as G r |grad psi|, the stress function as |grad phi| / r^2; their mean is reported.
    steady: relative error at which they do; beyond: place on the axis, of the fillets from there on.
    Raises ValueError where no corner is round, SolveError where the two do not meet.

    >>> from torsion.assembly.junction.profile import Corner, junction
    >>> round(fillet_stress(junction((1.0, 0.0), (2.0, 0.0), Corner("fillet", 0.1))).factor, 2)
    1.39
    """
    mesh = solved(profile).meridian
    if not mesh.arcs:
        raise ValueError("the line has no fillet")
    before, end = math.inf, profile.smaller
    nominal = 2.0 * math.pi / float(section_modulus(end.outer[0], end.bore[0]))
    # The first mesh is as good as the stiffness needs; the stress needs a finer one.
    for _ in range(ROUNDS):
        mesh = mesh.refined(np.unique(mesh.mesh.f2t[0, mesh.fillets]))
        _, basis, psi, phi = on_mesh(profile, mesh)
        middles = mesh.mesh.p[0, mesh.mesh.facets[:, mesh.fillets]].mean(axis=0)
        places, shown = places_along(basis, mesh.fillets[middles > beyond])
        z, r = np.asarray(places.global_coordinates())
        by_angle, by_function = (
            np.where(shown, np.hypot(*np.asarray(places.interpolate(field).grad)) * weight, 0.0)
            for field, weight in ((psi, r), (phi, r**-2))
        )
        low, high = sorted(float(stress.max()) / nominal for stress in (by_angle, by_function))
        factor, half = (low + high) / 2.0, (high - low) / (high + low)
        error = max(half, abs(factor - before) / factor)
        if error <= steady:
            worst = np.unravel_index(int(np.argmax(by_angle + by_function)), r.shape)
            return FilletStress(factor, error, (float(z[worst]), float(r[worst])))
        before = factor
    raise SolveError("the stress in a fillet does not converge; look at its dimensions")
