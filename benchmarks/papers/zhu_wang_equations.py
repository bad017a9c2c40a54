"""Equations of Zhu and Wang as printed and as they must be: the couple's matrix, its parts, the criteria.

Matrices are for the left side, / (T0/J0), as in
`torsion.analyses.lateral.tilt_stability`; x driving angle, phi misalignment, rad.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks.papers.zhu_wang_theory import small_angle
from torsion.analyses.lateral.misaligned_shaft import MisalignedShaft, linearised, small_angle_part

Array = NDArray[np.float64]


def frozen(turned: ArrayLike, tilt: float) -> Array:
    """(7) with sec phi for csc phi: what is left if e_n . K0 stays at cos phi while the shaft moves."""
    cosine = np.cos(2.0 * np.asarray(turned, dtype=float))
    matrix = linearised(turned, tilt)
    matrix[..., 0, 0] = -0.5 * np.sin(2.0 * np.asarray(turned, dtype=float))
    matrix[..., 1, 0] = -0.5 * np.cos(2.0 * tilt) / np.cos(tilt) * (1.0 - cosine)
    return matrix


def printed(turned: ArrayLike, tilt: float) -> Array:
    """(7) as printed: csc phi in both entries next to the diagonal."""
    matrix = frozen(turned, tilt)
    matrix[..., [0, 1], [1, 0]] /= np.tan(tilt)
    return matrix


def turned_sign(turned: ArrayLike, tilt: float) -> Array:
    """(8) as printed: E0, E1 and E2 with the sign opposite to (7)."""
    return -small_angle(turned, tilt)


def without_circulation(turned: ArrayLike, tilt: float) -> Array:
    """(8) without its constant part E2: all that the first order of multiple scales sees."""
    return small_angle_part(turned, sine=1.0, cosine=1.0, constant=0.0)


def frozen_couple(turned: Array, tilt: float, first: float, second: float) -> Array:
    """(..., 2) the exact couple but for e_n . K0, which stays at cos phi: its derivative is `frozen`."""
    pin = np.stack(
        (np.cos(turned), np.sin(turned) * np.cos(tilt), -np.sin(turned) * np.sin(tilt)), axis=-1
    )
    a, b = first, second
    across = np.array([np.cos(b), np.sin(a) * np.sin(b), -np.cos(a) * np.sin(b)])
    over = np.array([0.0, np.cos(a), np.sin(a)])
    along = np.array([np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)])
    return -(pin @ along)[..., None] * np.stack((pin @ across, pin @ over), axis=-1) / np.cos(tilt)


@dataclass(frozen=True)
class Averaged:
    """Multiple scales of the sum type: what first and second order say."""

    middle: float  # rad/s, half the sum of both frequencies
    strength: float  # G, 1/s: the fastest growth without damping
    circulation: float  # eta: share of the constant part E2
    decay: float  # delta, 1/s

    @property
    def half_width(self) -> float:
        """rad/s of speed, without damping: (20) and the right form of (21), (22)."""
        return self.strength

    def growth(self, speed: ArrayLike) -> Array:
        """1/s by the second order: s^2 = G^2 (1 - i eta)^2 - sigma^2/4, less the decay; sigma = 2 (speed - middle)."""
        shift = np.asarray(speed, dtype=float) - self.middle
        root = np.sqrt(self.strength**2 * (1.0 - 1j * self.circulation) ** 2 - shift**2 + 0j)
        return np.abs(root.real) - self.decay

    def boundaries(self) -> tuple[float, float]:
        """rad/s, second order, with damping; without it there is none."""
        G, eta, delta = self.strength, self.circulation, self.decay
        half = np.sqrt(G**2 * (1.0 - eta**2) - delta**2 + eta**2 * G**4 / delta**2)
        return self.middle - half, self.middle + half


def averaged(shaft: MisalignedShaft) -> Averaged:
    """Constants of the sum type."""
    low, high = np.sqrt(np.sort(shaft.square))
    strength = shaft.torque / shaft.inertia / (8.0 * np.sqrt(low * high))
    circulation = shaft.torque / shaft.inertia / (high**2 - low**2)
    return Averaged(
        float((low + high) / 2.0), float(strength), float(circulation), float(shaft.decay[0] / 2.0)
    )


def half_width_printed(shaft: MisalignedShaft) -> float:
    """(22): T0/(4 l^2 sqrt(Kx Ky)), a pure number where rad/s is due."""
    return float(
        shaft.torque / (4.0 * shaft.length**2 * np.sqrt(shaft.stiffness[0] * shaft.stiffness[1]))
    )


def half_width_right(shaft: MisalignedShaft) -> float:
    """T0/(8 l sqrt(J0) (Kx Ky)^(1/4)), rad/s."""
    product = shaft.stiffness[0] * shaft.stiffness[1]
    return float(shaft.torque / (8.0 * shaft.length * np.sqrt(shaft.inertia) * product**0.25))
