"""Finite elements (scikit-fem): every shaft as elements of one degree, with their consistent inertia."""

import math
from dataclasses import replace

import numpy as np

from torsion.assembly import MOST
from torsion.assembly.distributed_shafts import collect
from torsion.assembly.segments import (
    GAUSS,
    LARGEST_PHASE_OF_TORQUES,
    area_along,
    bar_segments,
    is_uniform,
    phase,
)
from torsion.assembly.system import Discretisation, System
from torsion.primitives import Bar
from torsion.sources import source
from torsion.train import Train

DEGREE, HIGHEST_DEGREE = 4, 10
# A frequency of a shaft is right to this share, by the estimate of `element_error`.
SHARE_OF_ERROR = 1e-6
LARGEST_PHASE = 2.5  # rad along an element: the inner unknowns alone oscillate at pi or more
FEWEST = 4  # elements of a shaft, for the picture of its shape


def accurate_phase(degree: int) -> float:
    """Phase (rad) along one element at which the error is SHARE_OF_ERROR."""
    return float((SHARE_OF_ERROR / phase_error(degree, 1.0)) ** (0.5 / degree))


def assemble_fem(train: Train, requested: Discretisation) -> System:
    """The system in which every shaft has elements of one degree, enough for a highest frequency (Hz).

    A degree or number of elements that is not requested is what keeps the error below SHARE_OF_ERROR. Raises SolveError
    for a train with closed loops.
    """
    frequency, degree, elements = requested.frequency, requested.degree, requested.elements
    order = degree or DEGREE

    def number_of(bar: Bar) -> int:
        """As many as requested, or as keep the error below SHARE_OF_ERROR; at least the segments that it states."""
        if elements is not None:
            return max(elements, bar.segments or 1)
        longest = min(accurate_phase(order), LARGEST_PHASE)
        needed = phase(bar, requested.excited) / LARGEST_PHASE_OF_TORQUES
        number = math.ceil(max(phase(bar, frequency) / longest, needed, FEWEST))
        while number < MOST and (error := section_error(bar, number, order)) > SHARE_OF_ERROR:
            factor = min((error / SHARE_OF_ERROR) ** (0.5 / order), 4.0)
            number = max(number + 1, math.ceil(number * factor))
        return max(min(number, MOST), bar.segments or 1)

    if degree is None and elements is not None:
        # The least degree that keeps the error below SHARE_OF_ERROR with so many elements a shaft.
        while order < HIGHEST_DEGREE and any(
            element_error(bar, number_of(bar), order, frequency) > SHARE_OF_ERROR
            for bar in train.bars
        ):
            order += 1

    collected, bars, numbers = collect(train, number_of)
    moving = [bar for bar in train.bars if bar.density > 0]
    if bars is not None:
        error = max(element_error(bar, numbers[bar.name], order, frequency) for bar in moving)
        bars = replace(bars, degree=order, error=error)
    is_stated = elements is not None and (degree is not None or order == HIGHEST_DEGREE)
    longest = (
        accurate_phase(order) if elements is not None else min(accurate_phase(order), LARGEST_PHASE)
    )
    resolved = (numbers[bar.name] * longest / phase(bar, 1.0) for bar in moving if not is_stated)
    return collected.system("fem", numbers, requested, min(resolved, default=math.inf), bars)


def element_error(bar: Bar, number: int, degree: int, frequency: float) -> float:
    """Relative error of a frequency (Hz) of a shaft by so many elements of a degree."""
    return max(
        phase_error(degree, phase(bar, frequency) / number), section_error(bar, number, degree)
    )


@source("Ainsworth2004", "section 3.1")
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
    x, weight = GAUSS
    points = (np.arange(number)[:, None] + (x + 1.0) / 2.0) / number
    polynomials = np.polynomial.legendre.legvander(x, degree - 1)
    energy = np.einsum("ng,gi,gj->nij", area_along(bar, points) * weight, polynomials, polynomials)
    across = np.zeros((degree, 1))
    across[0] = 2.0
    flexibility = np.linalg.solve(energy, across)[:, 0, 0]
    element_flexibility = (bar.length / number / bar.shear_modulus) * flexibility
    exact = bar_segments(bar, number)[0]
    return float(max(np.sum(exact - element_flexibility) / np.sum(exact), 0.0) / 2.0)
