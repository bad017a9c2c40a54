"""The stress in the fillets of a round shaft line, from the finite elements of its torsion."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from torsion.assembly.junction.axisymmetric import Fields, on_mesh, solved
from torsion.assembly.junction.profile import Profile
from torsion.assembly.junction.profile_mesh import Meridian
from torsion.assembly.triangle_fields import places_along
from torsion.errors import SolveError
from torsion.kernels.round_sections import section_modulus

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
    before = math.inf
    for _ in range(
        ROUNDS
    ):  # the first mesh is as good as the stiffness needs; the stress needs a finer one
        mesh = mesh.refined(np.unique(mesh.mesh.f2t[0, mesh.fillets]))
        stress = _largest(profile, mesh, on_mesh(profile, mesh)[1], beyond)
        error = max(stress.error, abs(stress.factor - before) / stress.factor)
        if error <= steady:
            return replace(stress, error=error)
        before = stress.factor
    raise SolveError("the stress in a fillet does not converge; look at its dimensions")


def _largest(profile: Profile, mesh: Meridian, fields: Fields, beyond: float) -> FilletStress:
    facets = mesh.fillets[mesh.mesh.p[0, mesh.mesh.facets[:, mesh.fillets]].mean(axis=0) > beyond]
    places, shown = places_along(fields.basis, facets)
    z, r = np.asarray(places.global_coordinates())
    slopes = (
        np.hypot(*np.asarray(places.interpolate(field).grad)) for field in (fields.psi, fields.chi)
    )
    by_angle, by_function = (
        np.where(shown, slope * factor, 0.0)
        for slope, factor in zip(slopes, (r, r**-2), strict=True)
    )
    end = profile.smaller
    nominal = 2.0 * math.pi / float(section_modulus(end.outer[0], end.bore[0]))
    low, high = sorted(float(stress.max()) / nominal for stress in (by_angle, by_function))
    worst = np.unravel_index(int(np.argmax(by_angle + by_function)), r.shape)
    return FilletStress(
        (low + high) / 2.0, (high - low) / (high + low), (float(z[worst]), float(r[worst]))
    )
