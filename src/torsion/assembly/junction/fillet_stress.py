"""The stress in the fillets of a round shaft line, from the finite elements of its torsion."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import skfem

from torsion.assembly.junction.axisymmetric import Fields, on_mesh, solved
from torsion.assembly.junction.profile import Profile
from torsion.assembly.junction.profile_mesh import Meridian
from torsion.errors import SolveError
from torsion.kernels.round_sections import section_modulus

STEADY = 1e-3  # relative error at which the triangles are fine enough
ROUNDS = 6
_ALONG = np.linspace(
    0.0, 1.0, 17
)  # places on a side of the outline at which the stress is looked at


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
    here = solved(profile).meridian
    if not here.arcs:
        raise ValueError("the line has no fillet")
    before = math.inf
    for _ in range(
        ROUNDS
    ):  # the first mesh is as good as the stiffness needs; the stress needs a finer one
        here = here.refined(np.unique(here.mesh.f2t[0, here.fillets]))
        found = _largest(profile, here, on_mesh(profile, here)[1], beyond)
        error = max(found.error, abs(found.factor - before) / found.factor)
        if error <= steady:
            return replace(found, error=error)
        before = found.factor
    raise SolveError("the stress in a fillet does not converge; look at its dimensions")


def _largest(profile: Profile, here: Meridian, fields: Fields, beyond: float) -> FilletStress:
    shape = fields.basis.mesh
    facets = here.fillets[here.mesh.p[0, here.mesh.facets[:, here.fillets]].mean(axis=0) > beyond]
    elements = np.unique(shape.f2t[0, facets])
    zero, one = np.zeros_like(_ALONG), np.ones_like(_ALONG)
    sides = np.concatenate(
        [[_ALONG, zero], [1.0 - _ALONG, _ALONG], [zero, _ALONG]], axis=1
    )  # in the order of t2f
    places = skfem.Basis(
        shape, fields.basis.elem, elements=elements, quadrature=(sides, np.tile(one, 3))
    )
    shown = np.repeat(np.isin(shape.t2f[:, elements].T, facets), len(_ALONG), axis=1)
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
    at = np.unravel_index(int(np.argmax(by_angle + by_function)), r.shape)
    return FilletStress(
        (low + high) / 2.0, (high - low) / (high + low), (float(z[at]), float(r[at]))
    )
