"""Shafts in segments: their flexibilities and lumped inertias, by exact integrals."""

import math

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.round_sections import polar_area_moment
from torsion.primitives import Bar

BLOCK = 2**14  # pieces of a cone, times variants, at once; 3 MB an array
GAUSS = np.polynomial.legendre.leggauss(
    24
)  # points in -1..1 and weights; exact to rounding for every cone
# rad along a piece or element at the highest frequency of a response: a torque between its ends, a sine of the place,
# is above the torque of the nearer end by at most 1/cos(phase/2) - 1, here 0.03 %
LARGEST_PHASE_OF_TORQUES = 0.05


def phase(bar: Bar, frequency: float) -> float:
    """Phase (rad) of a wave of some frequency (Hz) along a shaft: omega length sqrt(density/shear modulus)."""
    wave: float = 2.0 * math.pi * frequency * bar.length * (bar.density / bar.shear_modulus) ** 0.5
    return wave


def is_uniform(bar: Bar) -> bool:
    """Whether a shaft has the same diameters all along."""
    return bar.outer[0] == bar.outer[1] and bar.bore[0] == bar.bore[1]


def area_along(bar: Bar, share: FloatArray | float) -> FloatArray:
    """I_p in m4 at shares of the length, from 0 at the driving to 1 at the driven end of a shaft."""
    from torsion.columns import plain

    outer, outer_end, bore, bore_end = map(plain, (*bar.outer, *bar.bore))
    return polar_area_moment(outer + (outer_end - outer) * share, bore + (bore_end - bore) * share)


def bar_segments(bar: Bar, number: int) -> tuple[FloatArray, FloatArray]:
    """Flexibility (segments,) rad/(N m) and lumped inertia (segments + 1,) kg m2 along a shaft, by exact integrals.

    Of a shaft in columns a second axis is that of the variants.
    """
    from torsion.columns import plain

    length, modulus, density = map(plain, (bar.length, bar.shear_modulus, bar.density))
    begin = area_along(bar, 0.0)
    if is_uniform(bar):
        means = np.repeat(np.array([begin, begin])[:, None], number, axis=1)
    else:
        # Harmonic and arithmetic mean of I_p, m4, over each piece, block by block.
        (x, weight), block, parts = GAUSS, max(1, BLOCK // begin.size), []
        for first in range(0, number, block):
            piece = np.arange(first, min(first + block, number))[:, None]
            share = (piece + (x + 1.0) / 2.0) / number
            along = area_along(bar, share.reshape(*share.shape, *[1] * begin.ndim))
            harmonic, mean = (np.tensordot(part, weight, (1, 0)) for part in (1.0 / along, along))
            parts.append([2.0 / harmonic, mean / 2.0])
        means = np.concatenate(parts, axis=1)
    # A value of a column is beside those of every segment.
    variants = np.ndim(length + modulus + density + begin)
    means = means.reshape(2, number, *[-1] * variants)
    half = density * (length / number) * means[1] / 2.0
    none = np.zeros_like(half[:1])
    lumps = np.concatenate([half, none]) + np.concatenate([none, half])
    return length / number / (modulus * means[0]), lumps
