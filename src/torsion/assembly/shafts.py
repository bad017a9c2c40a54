"""A shaft along its length: phase, area, static flexibility and inertia of its segments."""

import math

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.round_sections import polar_area_moment
from torsion.primitives import Bar

BLOCK = 2**14  # pieces of a cone at once; 3 MB an array
GAUSS = np.polynomial.legendre.leggauss(
    24
)  # points in -1..1 and weights; exact to rounding for every cone


def phase(bar: Bar, frequency: float) -> float:
    """Phase (rad) of a wave of some frequency (Hz) along a shaft: omega length sqrt(density/shear modulus)."""
    return 2.0 * math.pi * frequency * bar.length * math.sqrt(bar.density / bar.shear_modulus)


def is_uniform(bar: Bar) -> bool:
    """Whether a shaft has the same diameters all along."""
    return bar.outer[0] == bar.outer[1] and bar.bore[0] == bar.bore[1]


def uniform_area(bar: Bar) -> float:
    """Polar moment of area of a uniform shaft, m4."""
    return float(polar_area_moment(bar.outer[0], bar.bore[0]))


def area_along(bar: Bar, share: FloatArray) -> FloatArray:
    """I_p in m4 at `at`, from 0 at the driving to 1 at the driven end of a shaft."""
    outer, bore = bar.outer, bar.bore
    return polar_area_moment(
        outer[0] + (outer[1] - outer[0]) * share, bore[0] + (bore[1] - bore[0]) * share
    )


def bar_segments(bar: Bar, number: int) -> tuple[FloatArray, FloatArray]:
    """Flexibility (segments,) rad/(N m) and lumped inertia (segments + 1,) kg m2 along a shaft, by exact integrals."""
    length = bar.length / number
    if is_uniform(bar):
        area = uniform_area(bar)
        lump = np.full(number + 1, bar.density * length * area)
        lump[[0, -1]] *= 0.5
        return np.full(number, length / (bar.shear_modulus * area)), lump
    edge, (x, weight) = np.linspace(0.0, 1.0, number + 1)[:-1], GAUSS
    means = np.empty((2, number))  # of 1 / I_p in 1/m4, and of I_p in m4, over each piece
    for begin in range(0, number, BLOCK):
        part = slice(begin, begin + BLOCK)
        along = area_along(bar, edge[part, None] + (x + 1.0) / 2.0 / number)
        means[:, part] = (1.0 / along) @ weight / 2.0, along @ weight / 2.0
    half = bar.density * length * means[1] / 2.0
    return length * means[0] / bar.shear_modulus, np.append(half, 0.0) + np.append(0.0, half)
