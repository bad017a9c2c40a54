"""Secondary couples of cross joints, on the shafts they bend and in the rotating yokes.

A joint without friction carries a couple along the normal of its cross; what each shaft does not pass on as torque
bends it. Fixed axes of a shaft of direction d at a joint of plane normal n = d_driving x d_driven/sin(angle):
`normal` about n, `inplane` about d x n. A couple is what the joint puts on that shaft. With T the constant torque, x
the angle of the shaft that carries it and s, t = sin, tan(angle), the couples have a mean and order 2 only.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.joints.cross import Convention, transfer
from torsion.sources import source

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
    return (
        CoupleHarmonics(before, 1j * sign * slope, sign * before + 0j),
        CoupleHarmonics(behind, -1j * sign * slope, -sign * behind + 0j),
    )
