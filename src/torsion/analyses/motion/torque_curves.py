"""Torques of spans and speeds of stations over time, from the motion of the modes: at samples, and between them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from torsion.analyses.motion.carrier import Carrier
from torsion.analyses.motion.peaks import Extremes, turns_within
from torsion.analyses.motion.state_before import State
from torsion.analyses.motion.times_looked_at import (
    MOST_TIMES,
    PER_PERIOD,
    PER_PERIOD_COUNTED,
    Looked,
    Wave,
    looked_at,
    waves_of,
)
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress
from torsion.kernels.motion.damped_motion import Motion
from torsion.kernels.motion.torque_history import Piece

BLOCK = 2**21  # values of one array at once
ALIKE = (
    1e-13  # of a greatest value: others within it are as great, and the first of them is reported
)
SAFETY, LEAST_NEAR, MOST_NEAR = (
    10.0,
    1e-6,
    0.02,
)  # how far below the highest sampled peak others are looked at
MOST_SUMS = 5e8  # products of all torques at all times that are formed to look for peaks between the samples
EXPONENTIAL = 50  # products that take the time of one exponential
Patch = Callable[
    [FloatArray, FloatArray], None
]  # angles (stations, times), and speeds that it changes


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

    @property
    def waves(self) -> tuple[Wave, ...]:
        """What vibrates besides the modes."""

    @property
    def quickest(self) -> float:
        """1/s of the fastest that dies away."""

    def torque(
        self, time: FloatArray
    ) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
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

    @property
    def waves(self) -> tuple[Wave, ...]:
        """What vibrates besides the modes: torques, and the steady vibration."""
        steady = Wave(0.0, math.inf, float(self.before.frequency.max(initial=0.0)))
        return (*waves_of(self.motion.loads), steady)

    @property
    def quickest(self) -> float:
        """1/s of the fastest that dies away."""
        rates = [abs(complex(piece.rate)) for pieces in self.motion.loads for piece in pieces]
        return max([float(np.abs(self.motion.coordinates.root).max(initial=0.0)), *rates])

    def unseen(self, w: float) -> FloatArray:
        """(spans,) N m that vibrations as fast as w (rad/s) and faster add at most."""
        steady = np.abs(self.before.amplitude[self.before.frequency >= w]).sum(axis=0)
        rows = self.found.torque, self.slowed, self.direct
        return np.asarray(
            steady + forced(rows, self.motion.train.w, self.motion.force, self.motion.loads, w)
        )

    def torque(
        self, time: FloatArray
    ) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        """Torques (spans, times) with the damping part, their rates, and places and speeds (both, times)."""
        place, speed = self.motion.at(time)
        rate = (
            self.found.torque @ speed[self.motion.train.rigid :] + _vibration(self.before, time)[1]
        )
        if self.slowed.any():
            rate += self.slowed @ self.motion.acceleration(time, place, speed)
        if self.direct.any():
            rate = rate + self.direct @ self.motion.load_rates_at(time)
        torque = self.carried(time, place, speed)
        return torque, rate, (place, speed)

    def carried(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """Torques (spans, times) with the damping part, of places and speeds (rigid motions + modes, times)."""
        elastic = self.found.torque @ place[self.motion.train.rigid :]
        torque = (
            self.before.torque[:, None]
            + elastic
            + self.slowed @ speed
            + _vibration(self.before, time)[0]
        )
        return torque + self.direct @ self.motion.loads_at(time) if self.direct.any() else torque

    def turning(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(stations, times) rad/s from places and speeds (rigid motions + modes, times)."""
        angle, turning, _ = self.carrier.at(time)
        turning += self.shape @ speed
        for patch in self.patches:
            patch(angle + self.shape @ place, turning)
        return turning

    def turned(self, station: int, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Angle (rad) and speed (times,) of a station with inertia."""
        (angle, turning, _), (place, speed), row = (
            self.carrier.at(time),
            self.motion.at(time),
            self.shape[station],
        )
        return angle[station] + row @ place, turning[station] + row @ speed

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""
        order = np.argsort(at, kind="stable")
        place, speed, gained = np.empty((3, self.shape.shape[1], len(at)))
        place[:, order], speed[:, order] = self.motion.at(at[order])
        vibration, its_rate = _vibration(self.before, at, span)
        elastic, slowed = self.found.torque[span], self.slowed[span]
        rigid = self.motion.train.rigid
        torque = (
            self.before.torque[span]
            + _paired(elastic, place[rigid:])
            + _paired(slowed, speed)
            + vibration
        )
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


@dataclass(frozen=True)
class Seen:
    """What was seen of curves at all times looked at."""

    torque: FloatArray  # (spans, samples)
    turning: FloatArray  # (stations, samples)
    ends: tuple[
        tuple[FloatArray, FloatArray], ...
    ]  # greatest torques (spans,) and when; those of the negative
    turns: tuple[
        FloatArray, ...
    ]  # of every span, in the order of time: all values at which it turns


def sampled(curves: Readable, looked: Looked, progress: Progress) -> Seen:
    """Torques and speeds at samples, peaks and turns also between the times looked at."""
    time, sample = looked.time, looked.sample
    spans, stations = len(curves.slowed), len(curves.shape)
    torque, turning = np.empty((spans, len(sample))), np.empty((stations, len(sample)))
    near = min(
        max(SAFETY * looked.turn**4 / 384.0, LEAST_NEAR), MOST_NEAR
    )  # error of a cubic of values and rates
    extremes = Extremes.none(spans, near), Extremes.none(spans, near)
    best, when, turns = (
        np.full((2, spans), -np.inf),
        np.zeros((2, spans)),
        list[tuple[IntArray, FloatArray]](),
    )
    size = max(2, BLOCK // max(curves.shape.shape[1], spans, stations))
    for first in range(0, len(time) - 1, size):
        part = slice(
            first, min(first + size, len(time) - 1) + 1
        )  # a block begins with the last time before it
        values, rate, there = curves.torque(time[part])
        for number, (sense, found) in enumerate(zip((1.0, -1.0), extremes, strict=True)):
            found.add(time[part], sense * values, sense * rate)
            top = (sense * values).max(axis=1)
            at = (sense * values >= (top - ALIKE * np.abs(top))[:, None]).argmax(
                axis=1
            )  # a slipping clutch: the first
            when[number] = np.where(
                top - ALIKE * np.abs(top) > best[number], time[part][at], when[number]
            )
            best[number] = np.maximum(best[number], top)
        turns.append(turns_within(time[part], values, rate))
        here = slice(*np.searchsorted(sample, (part.start, part.stop)))
        own = sample[here] - part.start
        torque[:, here] = values[:, own]
        turning[:, here] = curves.turning(time[sample[here]], *(one[:, own] for one in there))
        progress("motion over time", part.stop / len(time))

    def negative(span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, rate = curves.torque_of(span, at)
        return -value, -rate

    ends = []
    for number, function in enumerate((curves.torque_of, negative)):
        top, place = extremes[number].exact(function)
        slack = ALIKE * np.abs(best[number])
        alike = np.where(top < best[number] - slack, when[number], np.minimum(place, when[number]))
        ends.append(
            (np.maximum(top, best[number]), np.where(top > best[number] + slack, place, alike))
        )
    span, value = (np.concatenate(one) for one in zip(*turns, strict=True))
    order = np.argsort(span, kind="stable")
    cut = np.searchsorted(span[order], np.arange(1, spans))
    return Seen(torque, turning, tuple(ends), tuple(np.split(value[order], cut)) if spans else ())


def _vibration(
    before: State, time: FloatArray, span: IntArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Torque of the steady vibration and its rate of change, (spans, times); with `span` of its pairs with times."""
    turned = np.exp(1j * np.multiply.outer(before.frequency, time))
    growing = 1j * before.frequency[:, None] * turned
    if span is None:
        torque, rate = (before.amplitude.T @ wave for wave in (turned, growing))
    else:
        torque, rate = (
            (before.amplitude[:, span] * wave).sum(axis=0) for wave in (turned, growing)
        )
    return torque.real, rate.real


def looked_at_of(
    curves: Readable, found: Modes, time: FloatArray, *, counts: bool
) -> tuple[Looked, int]:
    """The times at which curves of some modes are looked at, and how many times finer than samples the modes are.

    As fine as it pays; counts: cycles are counted.
    """
    step, per = float(time[1] - time[0]), PER_PERIOD_COUNTED if counts else PER_PERIOD
    most = MOST_SUMS / (found.torque.size + EXPONENTIAL * len(found.frequency) + 1)
    finer = int(
        np.clip(np.ceil(per * step * found.frequency.max(initial=0.0)), 1, max(most / len(time), 1))
    )
    finer = max(1, min(finer, MOST_TIMES // len(time)))
    looked = looked_at(time, finer, curves.cuts, curves.waves, curves.quickest, most, per)
    return replace(looked, turn=max(looked.turn, step / finer * curves.fastest)), finer


def forced(
    rows: tuple[FloatArray, FloatArray, np.ndarray],
    w: FloatArray,
    force: np.ndarray,
    loads: Sequence[Sequence[Piece]],
    fast: float,
) -> FloatArray:
    """(spans,) N m that torques as fast as `fast` (rad/s) and faster shake at most, without what dies away.

    rows: torques of places, of speeds, and of loads. Resonances count twentyfold, as a damping ratio of 0.025 does.
    """
    elastic, slowed, direct = (np.abs(one) for one in rows)
    found = np.zeros(len(elastic))
    for load, pieces in enumerate(loads):
        for piece in pieces:
            turning = abs(complex(piece.rate).imag)
            if turning < fast:
                continue
            length = piece.end - piece.begin if math.isfinite(piece.end) else 0.0
            size, acting = abs(piece.level) + abs(piece.slope) * length, np.abs(force[:, load])
            rigid = len(acting) - len(w)
            square = np.concatenate([np.full(rigid, turning**2), np.abs(turning**2 - w**2)])
            moved = size * acting / np.maximum(square, 0.05 * turning**2)
            found += elastic @ moved[rigid:] + slowed @ (moved * turning) + direct[:, load] * size
    return found


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
    gained, speed = (
        rows[rigid:][fast] for rows in (moved.acceleration(chosen, place, speed), speed)
    )
    w = (2.0 * math.pi * found.frequency[fast])[:, None]
    return np.asarray(
        np.abs(found.torque[:, fast]) @ np.hypot(gained / w**2, speed / w).max(axis=1)
    )
