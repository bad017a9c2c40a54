"""Tripod joints with radial bearings: kinematics of third order, couples and lateral force.

The driving shaft carries three lines parallel to itself at `radius` (lambda of Chang and Li), the driven shaft three
arms square to itself; each arm meets its line. With a single bearing the driven shaft pivots about a point at `arm`
(L) from the joint and its end runs around three times a revolution; a joint of twin bearings is of constant velocity.
The driving angle counts from the plane's normal n = d_driving x d_driven/sin(angle): arm 0 stands along n at 0.
Fixed axes as of cross joints: `normal` about n, `inplane` about d x n; couples are what the joint puts on that shaft.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray
from torsion.errors import SolveError

_STEPS = 30  # Newton doubles the digits: any joint that can turn is solved in fewer than ten


@dataclass(frozen=True, slots=True)
class TripodMotion:
    """Motion of a single-bearing joint over its driving angle."""

    error: FloatArray  # driven minus driving angle, rad
    ratio: FloatArray  # driven speed / driving speed
    bend: FloatArray  # angle between the shafts as they stand, rad
    yaw: FloatArray  # of their plane about the driving shaft, rad
    orbit: tuple[
        FloatArray, FloatArray
    ]  # m, of the spider's centre off the driving axis: along n, d_driving x n


@dataclass(frozen=True, slots=True)
class TripodStatics:
    """Torque and couples at a constant driving torque, N m; force of the joint across the driving shaft, N."""

    torque: FloatArray  # driven
    driving_normal: FloatArray  # U1 of Chang and Li
    driving_inplane: FloatArray  # V1
    driven_inplane: FloatArray  # V2
    force: tuple[FloatArray, FloatArray]  # on the driving shaft: along n, along d_driving x n

    @property
    def couple(self) -> FloatArray:
        """Magnitude of the couple on the driving shaft (M1), N m."""
        return np.hypot(self.driving_normal, self.driving_inplane)


def error_size(angle: ArrayLike, radius: ArrayLike, arm: ArrayLike) -> FloatArray:
    """Return the amplitude, rad, of cos 3 x in the transmission error, to first order in radius/arm (Chang and Li, eq. 1)."""
    bend = np.asarray(angle, dtype=float)
    share = np.asarray(radius, dtype=float) / (2.0 * np.asarray(arm))
    return np.asarray(share * np.tan(bend / 2.0) ** 2 * np.tan(bend))


def error_amplitude(angle: float, spider: float, radius: float, arm: float) -> complex:
    """Return the complex amplitude of order 3 of the error over driving angles, arm 0 standing `spider` rad from n at 0."""
    return complex(error_size(angle, radius, arm) * np.exp(3j * spider))


def exact_motion(
    driving: ArrayLike, angle: ArrayLike, radius: ArrayLike, arm: ArrayLike
) -> TripodMotion:
    """Return the exact motion of three lines met by three lines, the pivot being a joint of constant velocity.

    A spider on a shaft of free end turns as the driving shaft does, and its centre runs on the orbit
    radius/2 ((sec b - 1) cos 3(x - w), (1 - cos b) sin 3(x - w)) in the axes of the plane as it stands, b the bend
    and w the yaw; the pivot ties both to the centre. The error is the spherical excess that the yaw sweeps.
    Raises SolveError if the end of the shaft cannot run around (radius tan(angle) not small against arm).
    """
    given = np.broadcast_arrays(driving, angle, radius, arm)
    turned, nominal, offset, length = (np.asarray(value, dtype=float) for value in given)
    sine, share = np.sin(nominal), offset / (2.0 * length)

    # Newton on the two conditions that the pivot sets to sin b/sin(angle), the gain, and the yaw.
    gain, yaw = np.ones_like(turned), np.zeros_like(turned)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        for _ in range(_STEPS):
            steps, _ = _pivot(turned, sine, share, gain, yaw)
            gain, yaw = gain - steps[0], yaw - steps[1]
            is_done = not np.any(np.hypot(*steps) > 8.0 * np.finfo(float).eps)
            if is_done and np.all(np.isfinite(gain)):
                break
        else:
            raise SolveError(
                "a tripod's driven shaft finds no position: make angle or radius smaller, or the arm longer"
            )
    bend = np.arcsin(gain * sine)
    local = 3.0 * (turned - yaw)
    _, (gaining, yawing) = _pivot(turned, sine, share, gain, yaw)
    half, half_nominal = np.tan(bend / 2.0), np.tan(nominal / 2.0)
    above, below = half * half_nominal * np.sin(yaw), 1.0 + half * half_nominal * np.cos(yaw)
    opening = sine * gaining / (np.cos(bend) * (1.0 + np.cos(bend)))  # derivative of `half`
    rising = half_nominal * (opening * np.sin(yaw) + half * np.cos(yaw) * yawing)
    falling = half_nominal * (opening * np.cos(yaw) - half * np.sin(yaw) * yawing)
    slope = -2.0 * (below * rising - above * falling) / (above**2 + below**2)
    centre = np.exp(1j * yaw) * (np.tan(bend) * np.cos(local) + 1j * np.sin(bend) * np.sin(local))
    centre = offset / 2.0 * half * centre
    return TripodMotion(
        -2.0 * np.arctan2(above, below), 1.0 + slope, bend, yaw, (centre.real, centre.imag)
    )


def exact_statics(
    driving: ArrayLike, angle: ArrayLike, radius: ArrayLike, arm: ArrayLike, torque: ArrayLike
) -> TripodStatics:
    """Return the couples of three contact forces, each square to its arm and line, with moments balanced at the pivot."""
    motion = exact_motion(driving, angle, radius, arm)
    given = np.broadcast_arrays(driving, angle, radius, arm, torque, motion.bend)
    turned, nominal, offset, length, carried = (
        np.asarray(value, dtype=float) for value in given[:-1]
    )
    yaw = motion.yaw
    shaft, outgoing = (
        np.stack((np.sin(bend) * np.sin(turn), -np.sin(bend) * np.cos(turn), np.cos(bend)), axis=-1)
        for bend, turn in ((motion.bend, yaw), (nominal, np.zeros_like(nominal)))
    )  # unit vectors of the driven shaft at the joint and beyond the pivot: along n, d_driving x n, d_driving

    # Where the three arms meet the three lines, and the directions of their forces on the arms; each (..., 3, 3).
    centre = length[..., None] * (outgoing - shaft)
    node = np.stack((np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)), axis=-1)
    arm_angle = turned[..., None] + 2.0 * np.pi / 3.0 * np.arange(3)
    local = (arm_angle - yaw[..., None])[..., None]
    spoke = np.cos(local) * node[..., None, :] + np.sin(local) * np.cross(shaft, node)[..., None, :]
    flat = np.stack((np.cos(arm_angle), np.sin(arm_angle)), axis=-1)
    flat = offset[..., None, None] * flat - centre[..., None, :2]
    square = np.sum(spoke[..., :2] ** 2, axis=-1)
    reach = np.sum(flat * spoke[..., :2], axis=-1) / square
    push = np.stack((spoke[..., 1], -spoke[..., 0], np.zeros_like(square)), axis=-1)
    push = push / np.sqrt(square)[..., None]
    contact = centre[..., None, :] + reach[..., None] * spoke
    about = np.cross(contact - (length[..., None] * outgoing)[..., None, :], push)
    passed = (shaft + outgoing) / (1.0 + np.sum(shaft * outgoing, axis=-1, keepdims=True))
    size = np.linalg.solve(np.swapaxes(about, -1, -2), passed[..., None])[..., 0]
    couple = np.einsum("...k,...ki->...i", size, np.cross(contact, push))
    scale = carried / couple[..., 2]
    couple = scale[..., None] * couple
    force = scale[..., None] * np.einsum("...k,...ki->...i", size, push)
    sine, cosine = np.sin(nominal), np.cos(nominal)
    return TripodStatics(
        torque=carried * cosine - couple[..., 1] * sine,
        driving_normal=-couple[..., 0],
        driving_inplane=-couple[..., 1],
        driven_inplane=couple[..., 1] * cosine + carried * sine,
        force=(-force[..., 0], -force[..., 1]),
    )


def constant_velocity_couple(angle: ArrayLike, torque: ArrayLike) -> FloatArray:
    """Return T tan(angle/2), N m: steady couple in the plane on either shaft of a twin tripod or another cv joint."""
    return np.asarray(torque, dtype=float) * np.tan(np.asarray(angle, dtype=float) / 2.0)


def _pivot(
    turned: FloatArray, sine: FloatArray, share: FloatArray, gain: FloatArray, yaw: FloatArray
) -> FloatArray:
    """Newton's step back of (gain, yaw), and their derivatives by the driving angle; (2, 2, ...).

    Both solve the pivot's conditions, made linear in (gain, yaw).
    """
    # The orbit's half axes across and along n, over sin(angle); likewise what the conditions lack.
    cosine, local = np.sqrt(1.0 - (gain * sine) ** 2), 3.0 * (turned - yaw)
    near = share * gain**2 * sine / (1.0 + cosine)
    far = near / cosine
    lack = gain - np.cos(yaw) - near * np.sin(local), np.sin(yaw) + far * np.cos(local)
    right = np.array([lack, (3.0 * near * np.cos(local), 3.0 * far * np.sin(local))])
    bending = gain * sine**2 / cosine  # minus the derivative of cosine by gain
    growth = 2.0 * near / gain + near * bending / (1.0 + cosine)
    spread = growth / cosine + near * bending / cosine**2
    corner = 1.0 - growth * np.sin(local), np.sin(yaw) + 3.0 * near * np.cos(local)
    second_row = spread * np.cos(local), np.cos(yaw) + 3.0 * far * np.sin(local)
    determinant = corner[0] * second_row[1] - corner[1] * second_row[0]
    gaining = right[:, 0] * second_row[1] - right[:, 1] * corner[1]
    yawing = right[:, 1] * corner[0] - right[:, 0] * second_row[0]
    return np.stack([gaining / determinant, yawing / determinant], axis=1)
