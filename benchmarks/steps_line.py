"""A stepped line of shafts: its natural frequencies by a fine axisymmetric model, and by shafts one after another."""

import math

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import eigsh

from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.assembly.junction.axisymmetric import energy_matrix, functions_of, solved
from torsion.assembly.junction.profile import Corner, Length, Profile
from torsion.assembly.junction.profile_mesh import Meridian
from torsion.assembly.junction.stepped_shafts import with_steps
from torsion.model.component import Material
from torsion.model.shafts.shaft import Shaft
from torsion.model.shafts.shaft_details import Step
from torsion.train import train

DIAMETERS = (0.10, 0.12, 0.20, 0.14, 0.28, 0.16, 0.12, 0.10)  # m
LENGTHS = (0.45, 0.60, 0.70, 0.75, 0.90, 0.60, 0.55, 0.45)  # m
MATERIAL = Material(shear_modulus=80e9, youngs_modulus=206e9, density=7800.0)


def line(fillet: float = 0.0, scale: float = 1.0) -> Profile:
    """All eight sections; fillet: radius (m) in every corner; scale: of the lengths."""
    lengths = tuple(Length(scale * one, (d, d)) for d, one in zip(DIAMETERS, LENGTHS, strict=True))
    corner = Corner("fillet", fillet) if fillet else None
    return Profile(lengths, (corner,) * (len(lengths) - 1))


def dynamic_matrices(profile: Profile, here: Meridian) -> tuple[csc_array, csc_array]:
    """Stiffness and consistent inertia of a free line of density 1 and shear modulus 1, for its vibration.

    The unknowns are psi at the points of the elements; 2 pi int G r^3 grad u grad v and 2 pi int rho r^3 u v.
    """
    basis, values, slopes, r, modulus = functions_of(profile, here)
    weight = 2.0 * math.pi * r**3 * basis.dx
    return energy_matrix(basis, slopes, modulus * weight), energy_matrix(
        basis, values[:, None], weight
    )


def axisymmetric(profile: Profile, count: int = 5, fine: float = 1e-6) -> np.ndarray:
    """The first elastic frequencies, Hz, with consistent inertia on the mesh that the static twist needs."""
    stiffness, inertia = dynamic_matrices(profile, solved(profile, fine).meridian)
    speed2 = MATERIAL.shear_modulus / MATERIAL.density
    shift = -(
        (1.0 / profile.places[-1]) ** 2
    )  # below the rigid motion, far nearer to it than to the first root
    found = eigsh(stiffness, count + 1, inertia, sigma=shift, return_eigenvectors=False)
    return np.sqrt(np.sort(found)[1:] * speed2) / (2.0 * np.pi)


def one_dimensional(
    count: int = 5, *, junctions: bool, fillet: float = 0.0, scale: float = 1.0
) -> np.ndarray:
    """The first elastic frequencies, Hz, of the exact model of the shafts, with their steps or without."""
    step = (
        (Step(fillet=fillet) if fillet else Step(form="sharp")) if junctions else Step(form="none")
    )
    shafts = [
        Shaft(
            length=scale * length,
            diameter=(diameter,),
            material="line",
            step=step if place else None,
        )
        for place, (length, diameter) in enumerate(zip(LENGTHS[::-1], DIAMETERS[::-1], strict=True))
    ][::-1]
    system = assemble(
        with_steps(train(shafts, materials={"line": MATERIAL})), "exact", frequency=5000.0
    )
    return np.asarray(modes(system, count).frequency)
