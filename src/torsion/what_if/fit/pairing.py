"""Which mode a measured natural frequency is: modes rise with the frequencies, each in its band where they can."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.what_if.fit.fit_results import OUTSIDE
from torsion.what_if.fit.fit_settings import FIT, Measured
from torsion.what_if.fit.predictions import Train

BEHIND = 1e4  # more than the squared logarithms of all ratios of frequencies of one train together


@dataclass(frozen=True)
class Pairs:
    """Measured frequencies with the modes that they are paired with."""

    index: tuple[int, ...]  # in `measured`
    number: tuple[int, ...]  # of the mode, from 0
    lower: FloatArray  # Hz, band of that mode
    upper: FloatArray


def paired(train: Train, deviation: FloatArray, measured: Sequence[Measured]) -> Pairs:
    """Each frequency with the mode that the file names, the others with those to which all together are nearest.

    The number of a mode rises with its frequency whatever the figures, so that no others can be. A mode in whose band a
    frequency lies goes before all in whose it does not. deviation: (figures,) of the logarithms beforehand. Raises
    InputError for more frequencies than modes, or a mode that is not there.
    """
    places = [
        index for index, measurement in enumerate(measured) if measurement.frequency is not None
    ]
    if not places:
        return Pairs((), (), np.empty(0), np.empty(0))
    nominal = train.modes(np.ones(len(deviation)).tolist()).frequency
    lower, upper = _bands(train, deviation, len(nominal))
    numbers = dict[int, int]()
    for index in places:
        mode = measured[index].mode
        if mode is not None:
            if mode > len(nominal):
                message = f"mode {mode} is not among the {len(nominal)} of the train"
                raise InputError(
                    [Fault((*FIT, "measured", index, "mode"), message, "a lower number")]
                )
            numbers[index] = mode - 1
    unnamed = sorted(
        (index for index in places if index not in numbers),
        key=lambda k: measured[k].frequency or 0.0,
    )
    if len(places) > len(nominal):
        message = f"of {len(places)} measured natural frequencies the train has {len(nominal)}"
        raise InputError(
            [Fault((*FIT, "measured", places[-1], "frequency"), message, "leave one out")]
        )
    hertz = np.array([measured[index].frequency for index in unnamed], dtype=float)[:, None]
    slack = np.exp([[OUTSIDE * measured[index].within] for index in unnamed]).reshape(-1, 1)

    # Squared logarithms of ratios (frequencies, modes); a mode outside whose band one lies is behind all others.
    is_inside = (lower / slack <= hertz) & (hertz <= upper * slack)
    distance = np.square(np.log(hertz / nominal)) + np.where(is_inside, 0.0, BEHIND)
    for row, index in enumerate(unnamed):
        for paired_index, mode in numbers.items():
            above = (measured[index].frequency or 0.0) >= (measured[paired_index].frequency or 0.0)
            distance[row, slice(mode + 1) if above else slice(mode, None)] = np.inf
    rising = _rising(distance)
    if rising is None:
        message = "no mode is left between those that are named for a frequency that is not"
        raise InputError(
            [
                Fault(
                    (*FIT, "measured", unnamed[0], "frequency"), message, "say which `mode` each is"
                )
            ]
        )
    numbers |= dict(zip(unnamed, rising, strict=True))
    modes = [numbers[index] for index in places]
    return Pairs(tuple(places), tuple(modes), lower[modes], upper[modes])


def _rising(cost: FloatArray) -> list[int] | None:
    """The rising columns, one of each row (rows, columns), that cost least together; None where there are none.

    >>> _rising(np.array([[0.0, 1.0, 9.0], [0.0, 2.0, 9.0]]))
    [0, 1]
    """
    states: list[tuple[float, list[int]]] = [(0.0, [])]  # of every last column the best
    for row in cost:
        below = [
            min(
                ((total, chosen) for total, chosen in states if not chosen or chosen[-1] < k),
                default=(np.inf, []),
            )
            for k in range(len(row))
        ]
        states = [
            (total + row[k], [*chosen, k])
            for k, (total, chosen) in enumerate(below)
            if total + row[k] < np.inf
        ]
    return min(states, default=(0.0, None))[1]


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
            chosen = np.flatnonzero((corners == corner).all(axis=1))
            ends[row, chosen] = train.modes(corner.tolist()).frequency[chosen]
    return ends[0], ends[1]
