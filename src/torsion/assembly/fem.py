"""Finite elements (scikit-fem): every shaft as elements of one degree, with their consistent inertia."""

import math
from dataclasses import replace

from torsion.assembly.divided import collect, made
from torsion.assembly.element_error import element_error, phase_error, section_error
from torsion.assembly.lumped import MOST
from torsion.assembly.shafts import phase
from torsion.assembly.system import Discretisation, System
from torsion.primitives import Bar
from torsion.train import Train

DEGREE, HIGHEST_DEGREE = 4, 10
SHARE_OF_ERROR = 1e-6  # a frequency of a shaft is right to this share, by the estimate of `element_error`
LARGEST_PHASE = 2.5  # rad along an element: the inner unknowns alone swing at pi or more
FEWEST = 4  # elements of a shaft, for the picture of its shape


def accurate_phase(degree: int) -> float:
    """Phase (rad) along one element at which the error is SHARE_OF_ERROR."""
    return float((SHARE_OF_ERROR / phase_error(degree, 1.0)) ** (0.5 / degree))


def longest_phase(degree: int) -> float:
    """Phase (rad) along one element that keeps the error below SHARE_OF_ERROR, and counts in reach."""
    return min(accurate_phase(degree), LARGEST_PHASE)


def elements_for(bar: Bar, frequency: float, degree: int) -> int:
    """Elements that keep the error of a shaft below SHARE_OF_ERROR up to a highest frequency (Hz), at least FEWEST."""
    number = max(math.ceil(phase(bar, frequency) / longest_phase(degree)), FEWEST)
    while number < MOST:
        error = section_error(bar, number, degree)
        if error <= SHARE_OF_ERROR:
            break
        number = max(number + 1, math.ceil(number * min((error / SHARE_OF_ERROR) ** (0.5 / degree), 4.0)))
    return min(number, MOST)


def degree_for(train: Train, frequency: float, elements: int) -> int:
    """The least degree, from DEGREE on, that keeps the error below SHARE_OF_ERROR with so many elements a shaft."""
    for degree in range(DEGREE, HIGHEST_DEGREE):
        errors = (element_error(bar, _number(bar, elements), degree, frequency) for bar in train.bars)
        if max(errors, default=0.0) <= SHARE_OF_ERROR:
            return degree
    return HIGHEST_DEGREE


def assemble_fem(
    train: Train, *, frequency: float = 0.0, degree: int | None = None, elements: int | None = None
) -> System:
    """The system in which every shaft has elements of one degree, enough for a highest frequency (Hz).

    degree, elements (of every shaft): where not given, what keeps the error below SHARE_OF_ERROR. Raises SolveError
    for a train with closed loops.
    """
    requested = Discretisation(frequency, degree, elements)
    if degree is None:
        degree = DEGREE if elements is None else degree_for(train, frequency, elements)
    order = degree

    def number_of(bar: Bar) -> int:
        return _number(bar, elements_for(bar, frequency, order) if elements is None else elements)

    found, bars, numbers = collect(train, number_of)
    if bars is not None:
        shafts = {piece.bar.name: piece.bar for piece in bars.pieces}.values()
        error = max(element_error(bar, numbers[bar.name], order, frequency) for bar in shafts)
        bars = replace(bars, degree=order, error=error)
    stated = elements is not None and (requested.degree is not None or order == HIGHEST_DEGREE)
    longest = longest_phase(order) if elements is None else accurate_phase(order)
    resolved = (
        numbers[bar.name] * longest / phase(bar, 1.0)
        for bar in train.bars if bar.density > 0 and not stated
    )  # fmt: skip
    return made(found, "fem", numbers, requested, min(resolved, default=math.inf), bars)


def _number(bar: Bar, elements: int) -> int:
    """At least the segments that the shaft itself asks for."""
    return max(elements, bar.segments or 1)
