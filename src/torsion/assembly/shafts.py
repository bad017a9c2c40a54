"""A shaft along its length: phase, static flexibility and inertia of its pieces."""

import math
from functools import cache

import numpy as np

from torsion.kernels.sections import polar_area_moment
from torsion.kernels.tree import FloatArray
from torsion.primitives import Bar


def phase(bar: Bar, frequency: float) -> float:
    """Phase (rad) of a wave of some frequency (Hz) along a shaft: omega length sqrt(density/shear modulus)."""
    return 2.0 * math.pi * frequency * bar.length * math.sqrt(bar.density / bar.shear_modulus)


def is_uniform(bar: Bar) -> bool:
    """The same section all along."""
    return bar.outer[0] == bar.outer[1] and bar.bore[0] == bar.bore[1]


def bar_segments(bar: Bar, number: int) -> tuple[FloatArray, FloatArray]:
    """Flexibility (segments,) rad/(N m) and lumped inertia (segments + 1,) kg m2 along a bar, by exact integrals."""
    edge = np.linspace(0.0, 1.0, number + 1)
    x, weight = gauss()
    at = edge[:-1, None] + (x + 1.0) / 2.0 / number
    outer = bar.outer[0] + (bar.outer[1] - bar.outer[0]) * at
    bore = bar.bore[0] + (bar.bore[1] - bar.bore[0]) * at
    area = polar_area_moment(outer, bore)
    length = bar.length / number
    mean_flexibility = (1.0 / area) @ weight / 2.0
    mean_inertia = area @ weight / 2.0
    flexibility = length * mean_flexibility / bar.shear_modulus
    half = bar.density * length * mean_inertia / 2.0
    return flexibility, np.concatenate([half, [0.0]]) + np.concatenate([[0.0], half])


@cache
def gauss() -> tuple[FloatArray, FloatArray]:
    """Points in -1..1 and weights of a Gauss rule that is exact to rounding for every cone."""
    x, weight = np.polynomial.legendre.leggauss(24)
    return x, weight
