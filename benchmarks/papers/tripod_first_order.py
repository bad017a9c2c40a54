"""Motion and couples of a single-bearing tripod joint to first order in radius/arm, as Chang and Li have them."""

import numpy as np
from numpy.typing import ArrayLike

from torsion.kernels.joints.tripod import TripodMotion, TripodStatics, error_size


def first_order_motion(
    driving: ArrayLike, angle: ArrayLike, radius: ArrayLike, arm: ArrayLike
) -> TripodMotion:
    """Motion to first order in radius/arm: ratio 1 - 3 E sin 3x with E of `error_size` (Chang and Li, eqs 1 to 7)."""
    bend, turned = np.asarray(angle, dtype=float), 3.0 * np.asarray(driving, dtype=float)
    size, length = error_size(bend, radius, arm), np.asarray(arm, dtype=float)
    slope = np.asarray(radius, dtype=float) / 2.0 * np.tan(bend / 2.0)
    along, across = slope * np.tan(bend) * np.cos(turned), slope * np.sin(bend) * np.sin(turned)
    precession = -slope / length / np.cos(bend) * np.cos(turned)
    leaning = bend + across / (length * np.cos(bend))
    return TripodMotion(
        size * np.cos(turned),
        1.0 - 3.0 * size * np.sin(turned),
        leaning,
        precession,
        (along, across),
    )


def first_order_statics(
    driving: ArrayLike, angle: ArrayLike, radius: ArrayLike, arm: ArrayLike, torque: ArrayLike
) -> TripodStatics:
    """Couples to first order in radius/arm (Chang and Li, eqs 9 to 13, denominators corrected), and their force.

    V1 = T (1/i - cos b)/sin b and V2 = T (1 - cos b/i)/sin b without their differences, i the speed ratio;
    U1 = T radius/(2 arm) tan(b/2)^2 sec b (sec b + 2) cos 3x.
    """
    bend, turned = np.asarray(angle, dtype=float), 3.0 * np.asarray(driving, dtype=float)
    given, length = np.asarray(torque, dtype=float), np.asarray(arm, dtype=float)
    cosine, half = np.cos(bend), np.tan(bend / 2.0)
    share = np.asarray(radius, dtype=float) / (2.0 * length) * half * half
    ratio = first_order_motion(driving, bend, radius, length).ratio
    surplus, wave = 3.0 * share * np.sin(turned) / ratio, np.sin(turned)
    normal = given * share * (1.0 / cosine + 2.0) / cosine * np.cos(turned)
    leaning = (
        share * (1.0 + cosine) / (2.0 * cosine)
    )  # half of the pivot's tilt of the driven torque
    along = -given / length * (half - surplus + leaning * wave)
    across = -(normal - given * leaning * np.cos(turned)) / (length * cosine)
    inplane, behind = given * (half + surplus / cosine), given * (half - surplus)
    return TripodStatics(given / ratio, normal, inplane, behind, (along, across))
