"""Torques of spans and speeds of stations over time, from the motion of the modes: at samples, and between them."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from torsion.analyses.transient.peaks import Extremes
from torsion.analyses.transient.state_before import State
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress
from torsion.kernels.transient.damped_motion import Motion
from torsion.kernels.transient.torque_history import value

BLOCK = 2**21  # values of one array at once
PER_PERIOD = 4.0  # samples from which a mode is resolved
SAFETY, LEAST_NEAR, MOST_NEAR = 10.0, 1e-6, 0.02  # how far below the highest sampled peak others are looked at
MOST_SUMS = 5e8  # products of all torques at all times that are formed to look for peaks between the samples
EXPONENTIAL = 50  # products that take the time of one exponential
MOST_CUTS = 10_000  # begins and ends of torques at which the curves are looked at besides the samples


class Readable(Protocol):
    """Torques and speeds that can be read at any time."""

    @property
    def shape(self) -> FloatArray:
        """(stations, rigid motions + modes)."""

    @property
    def slowed(self) -> FloatArray:
        """(spans, rigid motions + modes)."""

    @property
    def cuts(self) -> FloatArray:
        """Times at which a torque may jump."""

    @property
    def fastest(self) -> float:
        """rad/s of the fastest mode."""

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Torques (spans, times), their rates, and speeds (rigid motions + modes, times)."""

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""

    def turning(self, speed: FloatArray) -> FloatArray:
        """Speeds (stations, times) of the stations."""


@dataclass(frozen=True)
class Curves:
    """Torques and speeds at any time."""

    system: System
    found: Modes
    before: State
    shape: FloatArray  # (stations, rigid motions + modes)
    motion: Motion
    slowed: FloatArray  # (spans, rigid motions + modes) N m s/rad: the damping part of the torques, of speeds
    direct: FloatArray  # (spans, loads) share of the loads that a span carries at once

    @property
    def cuts(self) -> FloatArray:
        """Times at which a torque of an event begins or ends."""
        return self.motion.coordinates.history.begin

    @property
    def fastest(self) -> float:
        """rad/s of the fastest mode."""
        return float(self.motion.train.w.max(initial=0.0))

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Torques (spans, times) with the damping part, their rates, and speeds (rigid motions + modes, times)."""
        place, speed = self.motion.at(time)
        vibration, its_rate = _vibration(self.before, time)
        elastic = self.found.torque @ place[self.motion.train.rigid :]
        torque = self.before.torque[:, None] + elastic + self.slowed @ speed + vibration
        rate = self.found.torque @ speed[self.motion.train.rigid :] + its_rate
        if self.slowed.any():
            rate += self.slowed @ self.motion.acceleration(time, place, speed)
        if self.direct.any():
            acting, changing = self._loads(time)
            torque, rate = torque + self.direct @ acting, rate + self.direct @ changing
        return torque, rate, speed

    def turning(self, speed: FloatArray) -> FloatArray:
        """(stations, times) rad/s from speeds (rigid motions + modes, times)."""
        return np.asarray(self.before.speed * np.abs(self.system.speed_ratio)[:, None] + self.shape @ speed)

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""
        order = np.argsort(at, kind="stable")
        place, speed, gained = np.empty((3, self.shape.shape[1], len(at)))
        place[:, order], speed[:, order] = self.motion.at(at[order])
        vibration, its_rate = _vibration(self.before, at, span)
        elastic, slowed = self.found.torque[span], self.slowed[span]
        rigid = self.motion.train.rigid
        torque = self.before.torque[span] + _paired(elastic, place[rigid:]) + _paired(slowed, speed) + vibration
        rate = _paired(elastic, speed[rigid:]) + its_rate
        if slowed.any():
            gained[:, order] = self.motion.acceleration(at[order], place[:, order], speed[:, order])
            rate = rate + _paired(slowed, gained)
        if self.direct.any():
            acting, changing = self._loads(at)
            torque, rate = torque + _paired(self.direct[span], acting), rate + _paired(self.direct[span], changing)
        return torque, rate

    def _loads(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Loads and their rates of change (loads, times)."""
        rates = [[piece.rate_of_change() for piece in pieces] for pieces in self.motion.loads]
        acting, changing = (np.array([value(one, time) for one in each]) for each in (self.motion.loads, rates))
        return acting, changing


def _paired(rows: FloatArray, columns: FloatArray) -> FloatArray:
    """Of row k and column k."""
    return np.asarray(np.einsum("km,mk->k", rows, columns))


def sampled(
    curves: Readable, time: FloatArray, finer: int, progress: Progress
) -> tuple[FloatArray, FloatArray, tuple[tuple[FloatArray, FloatArray], ...]]:
    """Torques (spans, times), speeds (stations, times); values and times of the greatest torque and its negative.

    These are looked for at `finer` times as many samples.
    """
    spans, stations = len(curves.slowed), len(curves.shape)
    torque, turning = np.empty((spans, len(time))), np.empty((stations, len(time)))
    turn = float(time[1]) / finer * curves.fastest  # rad of the fastest mode in a step
    near = min(max(SAFETY * turn**4 / 384.0, LEAST_NEAR), MOST_NEAR)  # the error of a cubic through values and rates
    high, low = Extremes.none(spans, near), Extremes.none(spans, near)
    size = max(2, BLOCK // max(curves.shape.shape[1], spans, stations) // finer)
    for first in range(0, len(time) - 1, size):
        part = slice(first, min(first + size, len(time) - 1) + 1)  # a block begins with the last sample before it
        fine = np.interp(
            np.arange((part.stop - first - 1) * finer + 1) / finer, np.arange(part.stop - first), time[part]
        )
        values, rate, speed = curves.torque(fine)
        high.add(fine, values, rate)
        low.add(fine, -values, -rate)
        torque[:, part], turning[:, part] = values[:, ::finer], curves.turning(speed[:, ::finer])
        progress("motion over time", part.stop / len(time))

    def negative(span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, rate = curves.torque_of(span, at)
        return -value, -rate

    cuts = curves.cuts
    cuts = cuts[(cuts > 0.0) & (cuts < time[-1])][:MOST_CUTS]
    cuts = np.ravel(np.column_stack([np.nextafter(cuts, 0.0), cuts]))  # both sides of what may jump
    jumps = curves.torque(cuts)[0] if cuts.size else np.empty((spans, 0))
    ends = []
    for sense, extremes, function in ((1.0, high, curves.torque_of), (-1.0, low, negative)):
        top, when = extremes.exact(function)
        for values, at in ((torque, time), (jumps, cuts)):
            if at.size:
                best = (sense * values).argmax(axis=1)
                found = sense * values[np.arange(spans), best]
                when, top = np.where(found > top, at[best], when), np.maximum(top, found)
        ends.append((top, when))
    return torque, turning, tuple(ends)


def _vibration(before: State, time: FloatArray, span: IntArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Torque of the steady vibration and its rate of change, (spans, times); with `span` of its pairs with times."""
    turned = np.exp(1j * np.multiply.outer(before.frequency, time))
    growing = 1j * before.frequency[:, None] * turned
    if span is None:
        torque, rate = (before.amplitude.T @ wave for wave in (turned, growing))
    else:
        torque, rate = ((before.amplitude[:, span] * wave).sum(axis=0) for wave in (turned, growing))
    return torque.real, rate.real


def times_finer(found: Modes, step: float, samples: int) -> int:
    """How many times finer than samples of a step (s) the peaks are looked for: 4 to a period, as far as that pays."""
    most = MOST_SUMS / (samples * (found.torque.size + EXPONENTIAL * len(found.frequency) + 1))
    return int(np.clip(np.ceil(PER_PERIOD * step * found.frequency.max(initial=0.0)), 1, max(most, 1)))


class Moved(Protocol):
    """A motion of rigid motions and modes."""

    @property
    def rigid_motions(self) -> int:
        """Number of rigid motions."""

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and speeds (rigid motions + modes, times)."""

    def acceleration(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(rigid motions + modes, times), of what `at` returned."""


def missed(found: Modes, moved: Moved, time: FloatArray, finer: int) -> FloatArray:
    """(spans,) N m that modes with fewer than 4 samples in a period add at most, by their amplitudes at the samples.

    The amplitude is that about the place to which the torques of the moment would move the mode slowly: of its
    acceleration and speed.
    """
    step = float(time[1] - time[0]) / finer
    fast = np.flatnonzero(found.frequency * step > 1.0 / PER_PERIOD)
    if not fast.size:
        return np.zeros(len(found.torque))
    chosen, rigid = time[:: max(1, len(time) // 1000)], moved.rigid_motions
    place, speed = moved.at(chosen)
    gained, speed = (rows[rigid:][fast] for rows in (moved.acceleration(chosen, place, speed), speed))
    w = (2.0 * math.pi * found.frequency[fast])[:, None]
    return np.asarray(np.abs(found.torque[:, fast]) @ np.hypot(gained / w**2, speed / w).max(axis=1))
