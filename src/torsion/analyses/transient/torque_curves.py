"""Torques of spans and speeds of stations over time, from the motion of the modes: at samples, and between them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from torsion.analyses.transient.carrier import Carrier
from torsion.analyses.transient.peaks import Extremes
from torsion.analyses.transient.state_before import State
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress
from torsion.kernels.transient.damped_motion import Motion

BLOCK = 2**21  # values of one array at once
PER_PERIOD = 4.0  # samples from which a mode is resolved
SAFETY, LEAST_NEAR, MOST_NEAR = 10.0, 1e-6, 0.02  # how far below the highest sampled peak others are looked at
MOST_SUMS = 5e8  # products of all torques at all times that are formed to look for peaks between the samples
EXPONENTIAL = 50  # products that take the time of one exponential
MOST_CUTS = 10_000  # begins and ends of torques at which the curves are looked at besides the samples
Patch = Callable[[FloatArray, FloatArray], None]  # angles (stations, times), and speeds that it changes


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

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        """Torques (spans, times), their rates, and places and speeds (both, times)."""

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""

    def turning(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """Speeds (stations, times) of the stations, from places and speeds of the modes."""


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
    carrier: Carrier
    patches: Sequence[Patch] = ()  # speeds of stations without inertia beside a joint

    @property
    def cuts(self) -> FloatArray:
        """Times at which a torque begins, ends or changes its law."""
        return self.motion.cuts

    @property
    def fastest(self) -> float:
        """rad/s of the fastest mode."""
        return float(self.motion.train.w.max(initial=0.0))

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        """Torques (spans, times) with the damping part, their rates, and places and speeds (both, times)."""
        place, speed = self.motion.at(time)
        vibration, its_rate = _vibration(self.before, time)
        elastic = self.found.torque @ place[self.motion.train.rigid :]
        torque = self.before.torque[:, None] + elastic + self.slowed @ speed + vibration
        rate = self.found.torque @ speed[self.motion.train.rigid :] + its_rate
        if self.slowed.any():
            rate += self.slowed @ self.motion.acceleration(time, place, speed)
        if self.direct.any():
            torque = torque + self.direct @ self.motion.loads_at(time)
            rate = rate + self.direct @ self.motion.load_rates_at(time)
        return torque, rate, (place, speed)

    def turning(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(stations, times) rad/s from places and speeds (rigid motions + modes, times)."""
        angle, turning, _ = self.carrier.at(time)
        turning += self.shape @ speed
        for patch in self.patches:
            patch(angle + self.shape @ place, turning)
        return turning

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
            torque = torque + _paired(self.direct[span], self.motion.loads_at(at))
            rate = rate + _paired(self.direct[span], self.motion.load_rates_at(at))
        return torque, rate


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
        values, rate, there = curves.torque(fine)
        high.add(fine, values, rate)
        low.add(fine, -values, -rate)
        torque[:, part] = values[:, ::finer]
        turning[:, part] = curves.turning(time[part], *(one[:, ::finer] for one in there))
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
