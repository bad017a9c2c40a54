"""How far finite elements of a shaft change its frequencies, estimated before anything is solved."""

import math

import numpy as np

from torsion.assembly.shafts import bar_segments, gauss, is_uniform, phase
from torsion.kernels.round_sections import polar_area_moment
from torsion.primitives import Bar


def element_error(bar: Bar, number: int, degree: int, frequency: float) -> float:
    """Relative error of a frequency (Hz) of a shaft by so many elements of a degree."""
    return max(phase_error(degree, phase(bar, frequency) / number), section_error(bar, number, degree))


def phase_error(degree: int, element_phase: float) -> float:
    """The share of inertia: (p!/(2p)!)^2 phase^(2p) / (2 (2p + 1)), to leading order in the phase along one element.

    Of a uniform shaft (Ainsworth 2004, SIAM J. Numer. Anal. 42:553, section 3.1); for degree 1 the phase^2/24 of a
    chain with consistent inertia.
    """
    size = (math.factorial(degree) / math.factorial(2 * degree)) ** 2 / (2.0 * (2 * degree + 1))
    return float(size * element_phase ** (2 * degree))


def section_error(bar: Bar, number: int, degree: int) -> float:
    """The share of a varying section: half the relative error of the static flexibility, which comes out too small.

    Elements twist as polynomials q of degree p - 1; their flexibility is the largest (int q)^2 / int G I q^2.
    """
    if is_uniform(bar):
        return 0.0
    x, weight = gauss()
    at = (np.arange(number)[:, None] + (x + 1.0) / 2.0) / number
    area = polar_area_moment(bar.outer[0] + (bar.outer[1] - bar.outer[0]) * at,
                             bar.bore[0] + (bar.bore[1] - bar.bore[0]) * at)  # fmt: skip
    polynomials = np.polynomial.legendre.legvander(x, degree - 1)
    energy = np.einsum("ng,gi,gj->nij", area * weight, polynomials, polynomials)
    across = np.zeros(degree)
    across[0] = 2.0
    flexibility = np.linalg.solve(energy, np.broadcast_to(across[:, None], (number, degree, 1)))[:, 0, 0] * 2.0
    own = (bar.length / number / bar.shear_modulus) * flexibility / 2.0
    exact = bar_segments(bar, number)[0]
    return float(max(np.sum(exact - own) / np.sum(exact), 0.0) / 2.0)
