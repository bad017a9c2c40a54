"""Rigid shaft of two angles on an elastic bearing, driven by a universal joint: how fast its small motions grow.

The joint's secondary couple follows the shaft's own angles and makes its stiffness vary at twice the speed: the shaft
can become unstable. The driving shaft turns evenly and carries a constant torque, which may be another one at every
speed. Axes i, j, k are fixed: k is the driven shaft at rest, i the normal of the plane of both shafts, `tilt` the angle
between them, so that the driving shaft runs along j sin(tilt) + k cos(tilt). Two angles move the driven shaft: `first`
about i, then `second` about the axis that j has become; matrices stand for (first, second). `turned` is the driving
angle, 0 with the driving pin along i (convention N).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray
from torsion.kernels.joints.cross import transfer
from torsion.kernels.periodic.monodromy import ANGLE_PER_STEP, FEWEST_STEPS, radau, through_steps
from torsion.sources import source

NEUTRAL = (
    1e-10  # growth / speed that counts as none: rounding of a monodromy matrix moves it by 1e-12
)
MOST_STEPS_AT_A_TIME = 2000
SPINNING = np.array([[0.0, 1.0], [-1.0, 0.0]])


@dataclass(frozen=True)
class MisalignedShaft:
    """A rigid shaft from the joint's centre to its bearing; axes i, j as above."""

    inertia: float  # kg m2 transverse, about the joint's centre
    polar: float  # polar / transverse inertia
    length: float  # m from joint to bearing
    stiffness: tuple[float, float]  # N/m of the bearing along i and j
    damping: tuple[float, float]  # N s/m along i and j
    torque: float  # N m of the driving shaft
    tilt: float  # rad between the shafts
    load: Callable[[FloatArray], FloatArray] = (
        np.ones_like
    )  # of speeds, rad/s: the torque there / `torque`

    @property
    def square(self) -> FloatArray:
        """(2,) rad2/s2 of the two angles at rest, without torque: the angle about i moves the end along j."""
        return self.length**2 * np.array(self.stiffness[::-1]) / self.inertia

    @property
    def decay(self) -> FloatArray:
        """(2,) 1/s, twice the decay rate of each angle."""
        return self.length**2 * np.array(self.damping[::-1]) / self.inertia

    def pull_at(self, speeds: FloatArray) -> FloatArray:
        """Return torque / transverse inertia of the shaft, (speeds,) rad/s2, at speeds in rad/s."""
        return self.torque / self.inertia * self.load(np.asarray(speeds, dtype=float))

    @property
    def frequency(self) -> FloatArray:
        """(2,) rad/s of both angles at rest, without torque, ascending; 0 of one that does not oscillate."""
        return np.sort(np.sqrt(np.maximum(self.square - (self.decay / 2.0) ** 2, 0.0)))


def linearised(turned: ArrayLike, tilt: float) -> FloatArray:
    """Return (..., 2, 2) minus the derivative of couple / torque: Zhu and Wang, eq. 7, sec and two entries corrected."""
    sine = np.sin(2.0 * np.asarray(turned, dtype=float))
    cosine = np.cos(2.0 * np.asarray(turned, dtype=float))
    c = np.cos(tilt)
    double = np.cos(2.0 * tilt)
    upper = ((1.0 + double) + (3.0 - double) * cosine) / (2.0 * c)
    return _matrices(-sine / c**2, upper, -c * (1.0 - cosine), sine)


def small_angle_part(
    turned: ArrayLike, *, sine: float, cosine: float, constant: float
) -> FloatArray:
    """Return (..., 2, 2) `linearised` at no tilt with its parts in sin 2x, cos 2x and the constant one scaled.

    With all three it is minus eq. 8 of Zhu and Wang in its right sign. The constant part, [[0, 1], [-1, 0]], is
    circulatory: it comes from no potential and feeds energy in.
    """
    s = sine * np.sin(2.0 * np.asarray(turned, dtype=float))
    c = cosine * np.cos(2.0 * np.asarray(turned, dtype=float))
    return _matrices(-s, constant + c, -(constant - c), s)


def _matrices(*entries: ArrayLike) -> FloatArray:
    rows = np.broadcast_arrays(*entries)
    return 0.5 * np.stack(rows, axis=-1).reshape(*rows[0].shape, 2, 2)


@dataclass(frozen=True)
class Model:
    """What of the couple is kept: its matrix, and whether the driven shaft turns as unevenly as its joint makes it."""

    # of driving angles and a tilt, rad: (..., 2, 2) minus the derivative of couple / torque over the two angles
    couple: Callable[[FloatArray, float], FloatArray] = linearised
    is_even: bool = True


EXACT = Model()


@dataclass(frozen=True)
class Growth:
    """Fastest growth of a small motion, over speed."""

    speed: FloatArray  # (speeds,) rad/s
    rate: FloatArray  # (speeds,) 1/s, negative where every motion dies out
    frequency: FloatArray  # (speeds,) rad/s of the motion that grows fastest, 0 .. speed (up to multiples of 2 speed)


def coefficients(
    shaft: MisalignedShaft, turned: FloatArray, speeds: FloatArray, model: Model = EXACT
) -> tuple[FloatArray, FloatArray]:
    """Return damping and stiffness, each (speeds, angles, 2, 2), of y'' + C y' + K y = what shakes it at driving angles."""
    pull = shaft.pull_at(speeds)[:, None, None, None]
    stiffness = np.diag(shaft.square) + pull * model.couple(turned, shaft.tilt)
    ratio = np.ones_like(turned) if model.is_even else transfer(turned, shaft.tilt, "N").ratio
    spin = np.asarray(speeds)[:, None, None, None] * ratio[:, None, None]
    damping = np.diag(shaft.decay) + shaft.polar * spin * SPINNING
    return damping, stiffness


def monodromies(shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT) -> FloatArray:
    """Return (speeds, 4, 4): what half a turn of the driving shaft, the period of the couple, makes of angles and rates."""
    speed = np.atleast_1d(np.asarray(speeds, dtype=float))
    rule = radau()
    highest = float(np.sqrt(shaft.square.max() + np.abs(shaft.pull_at(speed)).max()))
    steps = max(FEWEST_STEPS, int(np.ceil(2.0 * np.pi * highest / (ANGLE_PER_STEP * speed.min()))))
    turned = (np.pi * (np.arange(steps)[:, None] + rule.node) / steps).ravel()
    half_turn = np.empty((speed.size, 4, 4))
    for some in np.array_split(
        np.arange(speed.size), -(-speed.size * steps // MOST_STEPS_AT_A_TIME)
    ):
        shape = (some.size, steps, rule.node.size, 2, 2)
        speed_column = speed[some, None, None, None]
        damping, stiffness = coefficients(shaft, turned, speed[some], model)
        parts = (
            (damping / speed_column).reshape(shape),
            (stiffness / speed_column**2).reshape(shape),
        )  # the angle is taken for time
        half_turn[some] = through_steps(
            np.broadcast_to(np.eye(2), shape), *parts, np.pi / steps, rule
        )
    rate = np.concatenate([np.ones((speed.size, 2)), np.repeat(speed[:, None], 2, axis=1)], axis=1)
    return np.asarray(rate[:, :, None] * half_turn / rate[:, None, :])


@source("ZhuWang", "eq. 7, corrected")
def growth(shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT) -> Growth:
    """Return the growth over positive speeds (rad/s) by the eigenvalues of the monodromy matrix."""
    speed = np.atleast_1d(np.asarray(speeds, dtype=float))
    multiplier = np.linalg.eigvals(monodromies(shaft, speed, model))
    rank = np.abs(multiplier).argmax(axis=1)[:, None]
    leading = np.take_along_axis(multiplier, rank, axis=1)[:, 0]
    return Growth(
        speed, np.log(np.abs(leading)) * speed / np.pi, np.abs(np.angle(leading)) * speed / np.pi
    )
