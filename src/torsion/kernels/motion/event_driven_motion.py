"""A motion in steps of linear regimes: to be read at any time, exactly."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.regimes.linear_regime import Layout, Regime
from torsion.kernels.motion.regimes.modal_loads import LoadedModes, Start, beside_each_other


@dataclass(frozen=True)
class Event:
    """A change of the regime of an element."""

    time: float  # s
    element: int
    word: str  # contact, separation, slip, stuck, open


@dataclass(frozen=True)
class Reading:
    """A motion at some times."""

    train: LoadedModes
    values: FloatArray  # (rows, times) positions, speeds, inputs and rates of these
    acceleration: FloatArray  # (motions, times)
    torque: FloatArray  # (elements, times) N m
    torque_rate: FloatArray  # (elements, times) N m/s

    @property
    def position(self) -> FloatArray:
        """(motions, times), of rigid motions the whole one where the reading is of the whole motion."""
        return self.values[Layout(self.train).position]

    @property
    def speed(self) -> FloatArray:
        """(motions, times)."""
        return self.values[Layout(self.train).speed]

    @property
    def inputs(self) -> FloatArray:
        """(inputs, times)."""
        return self.values[Layout(self.train).inputs]

    @property
    def input_rates(self) -> FloatArray:
        """(inputs, times)."""
        return self.values[Layout(self.train).input_rates]

    @property
    def rates(self) -> FloatArray:
        """(rows, times) rates of the values; of the rates of inputs nothing."""
        parts = (self.speed, self.acceleration, self.input_rates, 0.0 * self.inputs)
        return np.concatenate(parts)


@dataclass(frozen=True)
class EventDrivenMotion:
    """The motion of a train from step to step."""

    train: LoadedModes
    steps: tuple[tuple[int, Start], ...]  # the regime of each
    regimes: tuple[Regime, ...]
    events: tuple[Event, ...]
    end: float  # s

    @cached_property
    def begin(self) -> FloatArray:
        """(steps,) s."""
        return np.concatenate([start.time for _, start in self.steps])

    @cached_property
    def _alike(self) -> tuple[IntArray, list[tuple[Regime, IntArray, Start]]]:
        """(steps,) which group each is of; of every regime and interval its steps, beside each other."""
        keys = [(regime, start.interval) for regime, start in self.steps]
        numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
        group = np.array([numbers[key] for key in keys])
        groups = []
        for (regime, _), number in numbers.items():
            chosen = np.flatnonzero(group == number)
            starts = [self.steps[step][1] for step in chosen.tolist()]
            groups.append((self.regimes[regime], chosen, beside_each_other(starts)))
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
            regime, chosen, starts = groups[number]
            start = starts.select(np.searchsorted(chosen, step[columns]))
            late = time[columns] - start.time
            moved = regime.moved(start, late, orders=2)
            rates = moved.input_rates[:, :, 0]
            parts = (regime.positions(moved), regime.speeds(moved.y), moved.inputs, rates)
            values, gained = np.concatenate(parts), regime.speeds(regime.rates_of(moved))
            reading = Reading(self.train, values, gained, regime.torque @ values, np.empty(0))
            reading = replace(reading, torque_rate=regime.torque @ reading.rates)
            yield regime, columns, reading, start.begun

    def at(self, time: FloatArray) -> Reading:
        """The motion at times (s)."""
        step = np.maximum(np.searchsorted(self.begin, time, side="right") - 1, 0)
        count, number = len(time), len(self.train.elements)
        sizes = (Layout(self.train).size, self.train.motions, number, number)
        whole = Reading(self.train, *(np.empty((size, count)) for size in sizes))
        for _, columns, reading, begun in self.readings(time, step):
            reading.position[: len(begun)] += begun
            for name in ("values", "acceleration", "torque", "torque_rate"):
                getattr(whole, name)[:, columns] = getattr(reading, name)
        return whole
