"""The misaligned shaft as a body in space: direction and angular momentum in fixed axes, no angle of the shaft at all.

The truth with which the equations in two angles are compared; nothing of torsion's kernels is used. Vectors are plain
tuples, which integrate faster than short arrays.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
CLOSE = 1e-9  # relative tolerance of the integration


def dot(a: Vector, b: Vector) -> float:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True)
class Body:
    """A rigid shaft on a ball at the origin; axes: x normal of the plane of the shafts, z along the shaft at rest."""

    inertia: float
    polar: float  # kg m2
    length: float
    stiffness: tuple[float, float]
    damping: tuple[float, float]
    torque: float
    tilt: float
    speed: float

    def moment(self, time: float, along: Vector) -> Vector:
        """Of the cross: square to both pins, with `torque` about the driving shaft."""
        x = self.speed * time
        s, c = math.sin(self.tilt), math.cos(self.tilt)
        pin = math.cos(x), math.sin(x) * c, -math.sin(x) * s
        normal = cross(pin, cross(along, pin))
        size = self.torque / dot(normal, (0.0, s, c))
        return size * normal[0], size * normal[1], size * normal[2]

    def rate(self, time: float, state: Array) -> tuple[float, ...]:
        """(6,) of direction z and transverse angular momentum L: z' = L x z/J, L' = M less its part along z.

        The spin is even: what the moment has along the shaft is taken by the load behind it.
        """
        along: Vector = (state[0], state[1], state[2])
        momentum: Vector = (state[3], state[4], state[5])
        size = math.sqrt(dot(along, along))
        along = along[0] / size, along[1] / size, along[2] / size
        moved = cross(momentum, along)
        moved = moved[0] / self.inertia, moved[1] / self.inertia, moved[2] / self.inertia
        force = tuple(
            -self.length * (self.stiffness[k] * along[k] + self.damping[k] * moved[k])
            for k in range(2)
        )
        held = cross(along, (force[0] * self.length, force[1] * self.length, 0.0))
        own = self.moment(time, along)
        total = own[0] + held[0], own[1] + held[1], own[2] + held[2]
        lost = dot(total, along)
        spin = self.polar * self.speed
        pushed = (total[k] - lost * along[k] - spin * moved[k] for k in range(3))
        return (*moved, *pushed)


def angles(body: Body, times: Array, tolerance: float = CLOSE) -> Array:
    """(2, times) the two angles of the shaft, from rest along z, by Dormand and Prince's method of order 8."""
    from scipy.integrate import solve_ivp

    start = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    span = (0.0, float(times[-1]))
    found = solve_ivp(
        body.rate, span, start, "DOP853", t_eval=times, rtol=tolerance, atol=1e-3 * tolerance
    )
    x, y, z = found.y[:3] / np.linalg.norm(found.y[:3], axis=0)
    return np.stack((np.arctan2(-y, z), np.arcsin(x)))
