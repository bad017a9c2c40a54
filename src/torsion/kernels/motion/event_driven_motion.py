"""A motion in steps of linear regimes: to be read at any time, exactly."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.linear_regime import Reading, Regime
from torsion.kernels.motion.loaded_modes import LoadedModes, Start


@dataclass(frozen=True)
class Event:
    """A change of the regime of an element."""

    time: float  # s
    element: int
    word: str  # contact, separation, slip, stuck, open


@dataclass(frozen=True)
class EventDrivenMotion:
    """The motion of a train from step to step."""

    train: LoadedModes
    steps: tuple[tuple[int, int, Start], ...]  # regime and interval of the history of each
    regimes: tuple[Regime, ...]
    events: tuple[Event, ...]
    end: float  # s

    @cached_property
    def begin(self) -> FloatArray:
        """(steps,) s."""
        return np.concatenate([start.time for *_, start in self.steps])

    @cached_property
    def _alike(self) -> tuple[IntArray, list[tuple[Regime, int, IntArray, Start]]]:
        """(steps,) which group each is of; of every regime and interval its steps, beside each other."""
        keys = [step[:2] for step in self.steps]
        numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
        group, groups = np.array([numbers[key] for key in keys]), []
        for (regime, interval), number in numbers.items():
            chosen = np.flatnonzero(group == number)
            columns = zip(*(self.steps[step][2] for step in chosen.tolist()), strict=True)
            starts = Start(*(np.concatenate(column, axis=-1) for column in columns))
            groups.append((self.regimes[regime], interval, chosen, starts))
        return group, groups

    def readings(
        self, time: FloatArray, step: IntArray
    ) -> Iterator[tuple[Regime, IntArray, Reading, FloatArray]]:
        """Regimes, which of some times (s) are in each, the motion there in a step each, and where that began.

        Positions of rigid motions (motions, times) rad count from there.
        """
        group, groups = self._alike
        for number in np.unique(group[step]).tolist():
            columns = np.flatnonzero(group[step] == number)
            regime, interval, chosen, starts = groups[number]
            which = np.searchsorted(chosen, step[columns])
            start = Start(*(column[..., which] for column in starts))
            reading = regime.read(interval, start, time[columns] - start.time)
            yield regime, columns, reading, start.begun

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
