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

from torsion.arrays import ComplexArray, FloatArray
from torsion.sources import source

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


Carrier = Literal["driving", "driven"]  # the shaft whose torque is constant


@dataclass(frozen=True, slots=True)
class Couple:
    """Couple on one shaft, N m: in fixed axes, and turning with the yoke of that shaft."""

    normal: FloatArray
    inplane: FloatArray
    yoke: FloatArray  # about d x pin; there is none about the pin itself


@dataclass(frozen=True, slots=True)
class Couples:
    """Torques and couples of one joint over its driving angle; N m, shape of the broadcast inputs.

    At driving angle 0 the driving pin points along n (convention N) or d x n (P), the driven pin along d x n or -n.
    """

    driving_torque: FloatArray
    driven_torque: FloatArray
    driving: Couple
    driven: Couple


@dataclass(frozen=True, slots=True)
class CoupleHarmonics:
    """Couple on one shaft in fixed axes: mean + Re(amplitude exp(2 i x)), x of the shaft with the constant torque; N m.

    About the normal there is no mean.
    """

    mean: FloatArray  # in the plane
    normal: ComplexArray
    inplane: ComplexArray


@source("Liu2023", "eq. 13, T2 corrected")
def couples(
    driving: ArrayLike,
    angle: ArrayLike,
    torque: ArrayLike,
    carrier: Carrier = "driving",
    convention: Convention = "P",
) -> Couples:
    """Return the couples at driving angles, the torque of one shaft being given (Liu 2023, eq. 13, with T2 corrected).

    In convention N, T on the driving shaft: driven shaft T t/2 sin 2x and T s/2 (1 - cos 2x), driving shaft
    -T t/2 sin 2x and T t/2 (1 + cos 2x).
    """
    bend, turned = np.asarray(angle, dtype=float), np.asarray(driving, dtype=float)
    ratio = transfer(turned, bend, convention).ratio
    given = np.asarray(torque, dtype=float)
    before, behind = (given, given / ratio) if carrier == "driving" else (given * ratio, given)
    sine, cosine = (
        (np.sin(turned), np.cos(turned)) if convention == "N" else (np.cos(turned), -np.sin(turned))
    )
    slope, tilt = np.tan(bend), np.sin(bend)
    normal = before * slope * sine * cosine
    driven_yoke = -before * slope * sine * np.sqrt(cosine * cosine + (np.cos(bend) * sine) ** 2)
    return Couples(
        driving_torque=before + np.zeros_like(normal),
        driven_torque=behind + np.zeros_like(normal),
        driving=Couple(-normal, before * slope * cosine * cosine, before * slope * cosine),
        driven=Couple(normal, before * tilt * sine * sine, driven_yoke),
    )


def couple_harmonics(
    angle: ArrayLike, torque: ArrayLike, carrier: Carrier = "driving", convention: Convention = "P"
) -> tuple[CoupleHarmonics, CoupleHarmonics]:
    """Return the harmonics of the couples on the driving and the driven shaft."""
    bend, given = np.asarray(angle, dtype=float), np.asarray(torque, dtype=float)
    slope, tilt = 0.5 * given * np.tan(bend), 0.5 * given * np.sin(bend)
    sign = 1.0 if convention == "N" else -1.0
    before, behind = (slope, tilt) if carrier == "driving" else (tilt, slope)
    normal = np.asarray(1j * sign * slope, dtype=complex)
    before_in_plane = np.asarray(sign * before + 0j, dtype=complex)
    behind_in_plane = np.asarray(-sign * behind + 0j, dtype=complex)
    return (
        CoupleHarmonics(before, normal, before_in_plane),
        CoupleHarmonics(behind, -normal, behind_in_plane),
    )
