"""Cross (Cardan, Hooke) joints: angle, speed, acceleration and torque ratio of one joint, their harmonics and extremes.

Two zeros of the driving angle x are in use. Convention P counts it from the plane of the two shafts: the driving yoke
lies in that plane at x = 0 and tan(out) = tan(in)/cos(angle). Convention N counts from the plane's normal:
tan(out) = cos(angle) tan(in). They differ by 90 degrees on both sides of the joint. The driven angle is counted
likewise, from where the driven yoke stands at x = 0. With c = cos(angle), s = sin(angle), q = tan(angle/2)^2 and
z = exp(2 i x), the transmission error out - in is -arg(1 - q z) in convention P: no branch of a tangent disturbs it
below 90 degrees.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray

Convention = Literal["P", "N"]


@dataclass(frozen=True, slots=True)
class Transfer:
    """What a joint does to an angle: driven minus driving angle and the derivatives of the driven angle."""

    error: FloatArray  # rad
    ratio: FloatArray  # first derivative: driven speed / driving speed
    curvature: FloatArray  # second derivative, 1/rad: driven acceleration / driving speed^2 at constant driving speed


def unevenness(angle: ArrayLike) -> FloatArray:
    """Return q = tan(angle/2)^2: order-2 amplitude of the transmission error, rad."""
    return np.asarray(np.tan(np.asarray(angle, dtype=float) / 2.0) ** 2)


def rapidity(angle: ArrayLike) -> FloatArray:
    """Return ln(1/cos(angle)), the logarithm of the greatest speed ratio; q = tanh(rapidity/2)."""
    return np.asarray(0.5 * np.log1p(np.tan(np.asarray(angle, dtype=float)) ** 2))


def fluctuation(angle: ArrayLike) -> FloatArray:
    """Return (greatest - least)/mean driven speed at constant driving speed: 1/cos(angle) - cos(angle)."""
    return np.asarray(np.sin(angle) * np.tan(angle))


def transfer(driving: ArrayLike, angle: ArrayLike, convention: Convention = "P") -> Transfer:
    """Return transmission error, speed ratio and second derivative from one sine and one cosine of the driving angle."""
    bend, turned = np.asarray(angle, dtype=float), np.asarray(driving, dtype=float)
    across, along = (
        (np.sin(turned), np.cos(turned)) if convention == "P" else (np.cos(turned), -np.sin(turned))
    )
    cosine, sine, product = np.cos(bend), np.sin(bend), across * along
    squared = across * across + (cosine * along) ** 2  # 1 - (s cos x)^2 without the difference
    ratio = cosine / squared
    leaning = 2.0 * np.sin(bend / 2.0) ** 2 * product  # (1 - c) sin x cos x
    error = np.arctan2(leaning, across * across + cosine * along * along)
    return Transfer(error, ratio, -2.0 * sine * sine * product * ratio / squared)


def behind(before: Transfer, joint: Transfer) -> Transfer:
    """Return the transfer up to behind a joint, from that up to it and its own at the angles where it stands."""
    rate = before.ratio
    gain = joint.curvature * rate * rate + joint.ratio * before.curvature
    return Transfer(before.error + joint.error, joint.ratio * rate, gain)


def error_amplitude(angle: float, yoke: float) -> complex:
    """Return the complex amplitude of order 2 of the transmission error, over the driving shaft's angle (convention P).

    Of order 2k it is -i q^k/k exp(2 i k yoke).
    """
    return complex(-1j * unevenness(angle) * np.exp(2j * yoke))


def greatest_curvature(angle: ArrayLike) -> FloatArray:
    """Return the greatest second derivative over a revolution, 1/rad; the least is its negative.

    It stands where cos 2x = -+4 s^2/(1 + c^2 + sqrt(4 c^2 + 9 s^4)), the root of its derivative written without a
    difference.
    """
    bend = np.asarray(angle, dtype=float)
    cosine, square = np.cos(bend), np.sin(bend) ** 2
    root = np.sqrt(4.0 * cosine**2 + 9.0 * square**2)
    denominator = 1.0 + cosine**2 + root
    cosine_term = (
        cosine**2 * (2.0 + 4.0 / (root + 3.0 * square)) / denominator
    )  # 1 + cos 2x of convention N
    steepest = np.arctan2(np.sqrt(1.0 + 4.0 * square / denominator), np.sqrt(cosine_term))
    return transfer(steepest, bend, "N").curvature
