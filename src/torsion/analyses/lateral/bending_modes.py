"""A bending shaft in the coordinates of its own modes at rest: all of them, so that nothing is left out."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, eigh, solve_triangular

from torsion.analyses.lateral.beam_matrices import LateralSystem
from torsion.arrays import FloatArray
from torsion.errors import SolveError

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Plane:
    """One plane; shapes (unknowns, modes) have the elastic energy 1/2 and the kinetic energy square/2."""

    shape: FloatArray
    square: FloatArray  # (modes,) 1/frequency^2, s2, descending; 0 of a mode without inertia

    @property
    def frequency(self) -> FloatArray:
        """(modes,) frequencies of the modes with inertia, rad/s, ascending."""
        return 1.0 / np.sqrt(self.square[self.square > 0])


@dataclass(frozen=True)
class Planes:
    """A turning shaft in modal coordinates p, for motions exp(i w t): (1 - w2 M + i w C + w Omega G) p = load.

    Isotropic supports: p is that of y + i z, of length n; w < 0 is backward whirl. Else p holds y and i z, of length
    2 n. All matrices are real and symmetric.
    """

    system: LateralSystem
    y: Plane
    z: Plane  # `y` itself where the supports are isotropic
    square: FloatArray  # (coordinates,) s2: M
    gyroscopic: FloatArray  # (coordinates, coordinates) s2: G
    damping: FloatArray  # (coordinates, coordinates) s: C, dampers of the supports
    lossy: FloatArray  # (coordinates, coordinates) 1: stiffness of the shaft times its loss factors
    crossed: FloatArray  # (n, n) 1: the same between a shape of y and one of z

    @property
    def is_isotropic(self) -> bool:
        """The supports are alike in both planes, which are then one."""
        return self.y is self.z

    @property
    def is_damped(self) -> bool:
        """A support of the shaft has a damper."""
        return any(any(point.damping) for point in self.system.beam.points)


def planes(system: LateralSystem) -> Planes:
    """Return the modal coordinates of a shaft on its joints and supports; raises SolveError where it is not supported."""
    for name, plane in (("y", 0), ("z", 1)):
        if system.beam.rigid_motions(plane):
            where = system.beam.name or "the shaft"
            raise SolveError(
                f"{where} is not supported in the plane {name}; give it a `support`, or a joint at either end"
            )
    y = _plane(system, 0)
    turning = _projected(system.gyroscopic, y, y)
    crossed = _projected(system.lossy, y, y)
    damping = _projected(system.support("damping", 0), y, y)
    if system.beam.is_isotropic:
        return Planes(system, y, y, y.square, turning, damping, crossed, crossed)
    z = _plane(system, 1)
    none = np.zeros_like(turning)
    turning = _projected(system.gyroscopic, y, z)
    crossed = _projected(system.lossy, y, z)
    return Planes(
        system,
        y,
        z,
        np.concatenate([y.square, z.square]),
        np.block([[none, turning], [turning.T, none]]),
        np.block([[damping, none], [none, _projected(system.support("damping", 1), z, z)]]),
        np.block([[_projected(system.lossy, y, y), none], [none, _projected(system.lossy, z, z)]]),
        crossed,
    )


def _projected(matrix: FloatArray, plane: Plane, other_plane: Plane) -> FloatArray:
    return plane.shape.T @ matrix @ other_plane.shape


def _plane(system: LateralSystem, plane: int) -> Plane:
    """Modes of a supported plane, by the inverse of the stiffness scaled to a diagonal of 1."""
    stiffness = system.stiffness + system.support("stiffness", plane)
    free = np.ix_(system.free, system.free)
    scale = 1.0 / np.sqrt(np.diagonal(stiffness)[system.free])
    factor = np.tril(cho_factor(scale[:, None] * stiffness[free] * scale, lower=True)[0])
    half = solve_triangular(factor, scale[:, None] * system.inertia[free] * scale, lower=True)
    inverse = solve_triangular(factor, half.T, lower=True)
    square, turned = eigh((inverse + inverse.T) / 2.0)
    shape = np.zeros((stiffness.shape[0], len(square)))
    shape[system.free] = scale[:, None] * solve_triangular(
        factor, turned[:, ::-1], lower=True, trans="T"
    )
    square = square[::-1]
    return Plane(shape, np.where(square > len(square) * EPS * square[0], square, 0.0))
