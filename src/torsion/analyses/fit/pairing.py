"""Which mode a measured natural frequency is: the bands of the modes within what was known, and the nearest of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.analyses.fit.fit_results import OUTSIDE
from torsion.analyses.fit.fit_settings import FIT, Measured
from torsion.analyses.fit.predictions import Train
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError


@dataclass(frozen=True)
class Pairs:
    """Measured frequencies with their modes."""

    place: tuple[int, ...]  # in `measured`
    number: tuple[int, ...]  # of the mode, from 0
    lower: FloatArray  # Hz, band of that mode
    upper: FloatArray


def highest_mode(measured: Sequence[Measured], found: int) -> int:
    """How many modes the measurements need, where `found` were computed."""
    named = [one.mode for one in measured if one.mode is not None]
    return max([found, *named, sum(one.frequency is not None for one in measured)])


def paired(train: Train, deviation: FloatArray, measured: Sequence[Measured]) -> Pairs:
    """Each frequency with the mode that the file names, else the nearest whose band it lies in, or nearest at all.

    deviation: (figures,) of the logarithms beforehand. Raises InputError for two frequencies of one mode, or
    a mode that is not there.
    """
    places = [place for place, one in enumerate(measured) if one.frequency is not None]
    if not places:
        return Pairs((), (), np.empty(0), np.empty(0))
    nominal = train.modes(np.ones(len(deviation)).tolist()).frequency
    lower, upper = _bands(train, deviation, len(nominal))
    numbers = dict[int, int]()
    for place in places:
        mode = measured[place].mode
        if mode is not None:
            if mode > len(nominal):
                message = f"mode {mode} is not among the {len(nominal)} of the train"
                raise InputError([Fault((*FIT, "measured", place, "mode"), message, "a lower number")])
            numbers[place] = mode - 1
    for place in (place for place in places if place not in numbers):
        numbers[place] = _nearest(measured[place], nominal, lower, upper)
    seen: dict[int, int] = {}
    for place in places:
        if seen.setdefault(numbers[place], place) != place:
            other = measured[seen[numbers[place]]].frequency
            message = f"this frequency and {other:g} Hz are both nearest to mode {numbers[place] + 1}"
            raise InputError([Fault((*FIT, "measured", place, "frequency"), message, "say which `mode` each is")])
    at = [numbers[place] for place in places]
    return Pairs(tuple(places), tuple(at), lower[at], upper[at])


def _nearest(one: Measured, nominal: FloatArray, lower: FloatArray, upper: FloatArray) -> int:
    """The mode nearest by ratio, of those in whose band the frequency lies, else of all."""
    hertz = one.frequency or 0.0
    apart = np.abs(np.log(hertz / nominal))
    slack = np.exp(OUTSIDE * one.within)
    inside = (lower / slack <= hertz) & (hertz <= upper * slack)
    return int(np.argmin(np.where(inside, apart, np.inf) if inside.any() else apart))


def _bands(train: Train, deviation: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Least and greatest frequency of every mode (modes,) Hz with every figure within two deviations.

    Each mode at the corner to which its slopes point: the exact ends where a frequency rises or falls with each figure
    throughout, as with every stiffness and every inertia.
    """
    rise = train.mode_slopes(np.zeros(len(deviation)), range(count)) * deviation
    ends = np.empty((2, count))
    for row, side in enumerate((-1.0, 1.0)):
        corners = np.exp(OUTSIDE * side * np.sign(rise) * deviation)
        for corner in np.unique(corners, axis=0):
            here = np.flatnonzero((corners == corner).all(axis=1))
            ends[row, here] = train.modes(corner.tolist()).frequency[here]
    return ends[0], ends[1]
