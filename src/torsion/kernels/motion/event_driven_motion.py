"""A motion in steps of linear regimes: to be read at any time, exactly."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.linear_regime import Reading, Regime
from torsion.kernels.motion.loaded_modes import LoadedModes, Start

BLOCK = 20_000  # coordinates at a time


@dataclass(frozen=True)
class Event:
    """A change of the regime of an element."""

    time: float  # s
    element: int
    word: str  # contact, separation, slip, stuck, open


@dataclass(eq=False)
class EventDrivenMotion:
    """The motion of a train from step to step; begin: (steps,) s."""

    train: LoadedModes
    steps: tuple[tuple[int, int, Start], ...]  # regime and interval of the history of each
    regimes: tuple[Regime, ...]
    events: tuple[Event, ...]
    end: float  # s

    def __post_init__(self) -> None:
        self.begin = np.concatenate([start.time for *_, start in self.steps])
        # Which group each step is of; of every regime and interval its steps, beside each other.
        keys = [step[:2] for step in self.steps]
        numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
        self._group = np.array([numbers[key] for key in keys])
        self._groups = list[tuple[Regime, int, IntArray, Start]]()
        for (regime, interval), number in numbers.items():
            chosen = np.flatnonzero(self._group == number)
            columns = zip(*(self.steps[step][2] for step in chosen.tolist()), strict=True)
            starts = Start(*(np.concatenate(column, axis=-1) for column in columns))
            self._groups.append((self.regimes[regime], interval, chosen, starts))

    def readings(
        self, time: FloatArray, step: IntArray
    ) -> Iterator[tuple[Regime, IntArray, Reading, FloatArray]]:
        """Regimes, which of some times (s) are in each, the motion there in a step each, and where that began.

        Positions of rigid motions (motions, times) rad count from there.
        """
        group = self._group[step]
        for number in np.unique(group).tolist():
            columns = np.flatnonzero(group == number)
            regime, interval, chosen, starts = self._groups[number]
            for part in np.array_split(columns, 1 + columns.size * len(regime.root) // BLOCK):
                which = np.searchsorted(chosen, step[part])
                start = Start(*(column[..., which] for column in starts))
                yield (
                    regime,
                    part,
                    regime.read(interval, start, time[part] - start.time),
                    start.begun,
                )

    def at(self, time: FloatArray) -> Reading:
        """The motion at times (s); positions are whole ones."""
        step = np.maximum(np.searchsorted(self.begin, time, side="right") - 1, 0)
        n, m, number = self.train.motions, self.train.inputs, len(self.train.elements)
        whole = Reading(*(np.empty((size, len(time))) for size in (n, n, m, m, n, number, number)))
        for _, columns, reading, begun in self.readings(time, step):
            reading.position[: len(begun)] += begun
            for values, part in zip(whole, reading, strict=True):
                values[:, columns] = part
        return whole
