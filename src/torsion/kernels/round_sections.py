"""Round cross-sections: polar moment of area and torsional section modulus."""

import math

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray


def polar_area_moment(outer: ArrayLike, bore: ArrayLike = 0.0) -> FloatArray:
    """I_p = pi/32 (D^4 - d^4), m4, without the difference of the fourth powers of a thin tube."""
    big, small = 1.0 * np.asarray(outer), 1.0 * np.asarray(bore)
    return np.asarray(math.pi / 32.0 * (big - small) * (big + small) * (big * big + small * small))


def section_modulus(outer: ArrayLike, bore: ArrayLike = 0.0) -> FloatArray:
    """W_p = pi/16 (D^4 - d^4)/D, m3: torque / largest nominal shear stress."""
    return np.asarray(2.0 * polar_area_moment(outer, bore) / np.asarray(outer))
