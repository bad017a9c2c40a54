"""Torques of spans and speeds of stations over time, from the motion of the modes: at samples, and between them."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from torsion.analyses.motion.curves.peaks import (
    MOST_TIMES,
    PER_PERIOD,
    PER_PERIOD_COUNTED,
    Extremes,
    Looked,
    Wave,
    looked_at,
    turns_within,
)
from torsion.analyses.motion.events.transient_settings import (
    DEFAULT_MOST,
    DEFAULT_PER_PERIOD,
    TransientSettings,
)
from torsion.analyses.motion.train.loaded_train import Built, LoadedTrain
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.findings import Progress
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion

BLOCK = 2**21  # values of one array at once
# of a greatest value: others within it are as great, and the first of them is reported
ALIKE = 1e-13
# how far below the highest sampled peak others are chosen at
SAFETY, LEAST_NEAR, MOST_NEAR = 10.0, 1e-6, 0.02
MOST_SUMS = 5e8  # products of all torques at all times that are formed to look for peaks between the samples
EXPONENTIAL = 50  # products that take the time of one exponential
RESONANT = 0.05  # of the square of a frequency: resonances count twentyfold, as with a damping ratio of 0.025


Moved = tuple[FloatArray, FloatArray]  # positions and speeds (rigid motions + modes, times)


@dataclass(frozen=True)
class Curves:
    """Torques and speeds of a train that can be read at any time of its motion."""

    built: Built
    motion: EventDrivenMotion

    @property
    def loaded(self) -> LoadedTrain:
        """The train with what acts on it."""
        return self.built.loaded

    @cached_property
    def regimes(self) -> tuple[Wave, ...]:
        """Every regime of the couplings while it lasts, with its fastest vibration; none of a linear train."""
        motion = self.motion
        if not motion.train.elements:
            return ()
        w = [float(np.abs(regime.root.imag).max(initial=0.0)) for regime in motion.regimes]
        of_step = np.array([regime for regime, *_ in motion.steps])
        first = np.flatnonzero(np.diff(of_step, prepend=-1))
        begins = motion.begin[first].tolist()
        lasting = zip(begins, [*begins[1:], motion.end], of_step[first].tolist(), strict=True)
        return tuple(Wave(begin, end, w[regime]) for begin, end, regime in lasting)

    @property
    def waves(self) -> tuple[Wave, ...]:
        """What vibrates besides the modes."""
        steady = Wave(0.0, math.inf, float(self.loaded.before.frequency.max(initial=0.0)))
        # Of torques that turn while they act, the fastest of every range of time.
        fastest = dict[tuple[float, float], float]()
        for piece in (piece for pieces in self.motion.train.loads for piece in pieces):
            w, lasts = abs(complex(piece.rate).imag), (piece.begin, piece.end)
            if w > 0.0:
                fastest[lasts] = max(w, fastest.get(lasts, 0.0))
        loads = (Wave(begin, end, w) for (begin, end), w in fastest.items())
        return (*loads, steady, *self.regimes)

    def torque(
        self, time: FloatArray, span: IntArray | None = None
    ) -> tuple[FloatArray, FloatArray, Moved]:
        """Torques (spans, times) with the damping part, their rates, and positions and speeds (both, times).

        With `span` (times,) of each that span at its time, (times,). The times ascend.
        """

        def product(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
            if span is None:
                return np.asarray(rows @ columns)
            return np.asarray(np.einsum("km,mk->k", rows[span], columns))

        built, loaded, before = self.built, self.loaded, self.loaded.before
        moved, rigid = self.motion.at(time), loaded.rigid
        acting = slice(1, self.motion.train.following.stop)
        torque = product(loaded.modes.torque, moved.position[rigid:])
        torque = torque + product(loaded.slowed, moved.speed)
        rate = product(loaded.modes.torque, moved.speed[rigid:])
        if loaded.slowed.any():
            rate = rate + product(loaded.slowed, moved.acceleration)
        if built.direct.any():
            torque = torque + product(built.direct, moved.inputs[acting])
            rate = rate + product(built.direct, moved.input_rates[acting])
        if built.couplings:
            torque = torque + product(built.of_elements, moved.torque)
            rate = rate + product(built.of_elements, moved.torque_rate)
        else:  # beside the steady motion
            turned = np.exp(1j * np.multiply.outer(before.frequency, time))
            growing = 1j * before.frequency[:, None] * turned
            mean = before.torque[:, None] if span is None else before.torque[span]
            torque = torque + mean + product(before.amplitude.T, turned).real
            rate = rate + product(before.amplitude.T, growing).real
        return torque, rate, (moved.position, moved.speed)

    def turning(
        self, time: FloatArray, position: FloatArray, speed: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Angles (rad; of stations with inertia) and speeds (both, stations, times) from those of the motions."""
        loaded = self.loaded
        angle, turning, _ = loaded.carrier.at(time)
        angle += loaded.shape @ position
        turning += loaded.shape @ speed
        for cut in loaded.cuts:
            if cut.massless:
                cut.fill_speeds(loaded.system, angle, turning)
        return angle, turning

    def unseen(self, fast: float) -> FloatArray:
        """(spans,) N m that torques as fast as `fast` (rad/s) and faster shake at most, without what dies away."""
        loaded, before = self.loaded, self.loaded.before
        unseen = np.abs(before.amplitude[before.frequency >= fast]).sum(axis=0)
        rows = (np.abs(row) for row in (loaded.modes.torque, loaded.slowed, self.built.direct))
        elastic, slowed, direct = rows
        w, force = self.motion.train.modes.w_of_all, self.motion.train.force
        for load, pieces in enumerate(self.motion.train.loads):
            for piece in pieces:
                turning = abs(complex(piece.rate).imag)
                if turning < fast:
                    continue
                length = piece.end - piece.begin if math.isfinite(piece.end) else 0.0
                size = abs(piece.level) + abs(piece.slope) * length
                square = np.maximum(np.abs(turning**2 - w**2), RESONANT * turning**2)
                moved = size * np.abs(force[:, load]) / square
                unseen += elastic @ moved[loaded.rigid :] + slowed @ (moved * turning)
                unseen += direct[:, load] * size
        return np.asarray(unseen)

    def missed(self, time: FloatArray, finer: int) -> FloatArray:
        """(spans,) N m that modes with fewer than 4 samples in a period add at most, by their amplitudes at the samples.

        The amplitude is that about the position to which the torques of the moment would move the mode slowly: of its
        acceleration and speed.
        """
        modes, rigid = self.loaded.modes, self.loaded.rigid
        step = float(time[1] - time[0]) / finer
        fast = np.flatnonzero(modes.frequency * step > 1.0 / PER_PERIOD)
        if not fast.size:
            return np.zeros(len(modes.torque))
        times = time[:: max(1, len(time) // 1000)]
        moved, w = self.motion.at(times), self.loaded.w[fast, None]
        gained, speed = moved.acceleration[rigid:][fast], moved.speed[rigid:][fast]
        amplitude = np.hypot(gained / w**2, speed / w).max(axis=1)
        return np.asarray(np.abs(modes.torque[:, fast]) @ amplitude)

    def turned(self, station: int, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Angle (rad) and speed (times,) of a station with inertia."""
        angle, turning, _ = self.loaded.carrier.at(time)
        moved, row = self.motion.at(time), self.loaded.shape[station]
        return angle[station] + row @ moved.position, turning[station] + row @ moved.speed


@dataclass(frozen=True)
class Seen:
    """What was seen of curves at all times chosen at."""

    time: FloatArray  # (samples,) s
    torque: FloatArray  # (spans, samples)
    angle: FloatArray  # (stations, samples) rad; of stations with inertia
    turning: FloatArray  # (stations, samples)
    # greatest torques (spans,) and when; those of the negative
    ends: tuple[tuple[FloatArray, FloatArray], ...]
    # of every span, in the order of time: all values at which it turns
    turns: tuple[FloatArray, ...]
    lacking: FloatArray  # (spans,) N m that what is too fast for the times chosen at may add
    left: float  # rad/s from which on some waves are not resolved


def sample_times(settings: TransientSettings, modes: Modes) -> FloatArray:
    """Times of the samples (s), both ends among them."""
    number = settings.samples
    if number is None:
        highest = float(modes.frequency.max(initial=1.0 / settings.duration))
        finest = max(DEFAULT_PER_PERIOD * highest * settings.duration, 1000.0)
        number = int(min(finest, DEFAULT_MOST))
    return np.linspace(0.0, settings.duration, number + 1)


def look_at(curves: Curves, progress: Progress, *, counts: bool) -> Seen:
    """Read torques and speeds at samples, peaks and turns also between; counts: cycles are counted."""
    loaded = curves.loaded
    time = sample_times(loaded.settings, loaded.modes)
    chosen, finer = _choose_times(curves, time, counts=counts)
    spans, (stations, motions) = len(loaded.slowed), loaded.shape.shape
    times, sample = chosen.time, chosen.sample
    torque, turned = np.empty((spans, len(sample))), np.empty((2, stations, len(sample)))
    # The error of a cubic of values and rates.
    near = min(max(SAFETY * chosen.turn**4 / 384.0, LEAST_NEAR), MOST_NEAR)
    extremes = [Extremes(near, np.full(spans, -np.inf)) for _ in range(2)]
    best, when = np.full((2, spans), -np.inf), np.zeros((2, spans))
    turns = list[tuple[IntArray, FloatArray]]()
    size = max(2, BLOCK // max(motions, spans, stations))
    for first in range(0, len(times) - 1, size):
        # A block begins with the last time before it.
        part = slice(first, min(first + size, len(times) - 1) + 1)
        block = times[part]
        values, rate, moved = curves.torque(block)
        for number, (sense, extreme) in enumerate(zip((1.0, -1.0), extremes, strict=True)):
            extreme.add(block, sense * values, sense * rate)
            top = (sense * values).max(axis=1)
            lowest = top - ALIKE * np.abs(top)
            first_time = block[(sense * values >= lowest[:, None]).argmax(axis=1)]
            when[number] = np.where(lowest > best[number], first_time, when[number])
            best[number] = np.maximum(best[number], top)
        turns.append(turns_within(block, values, rate))
        columns = slice(*np.searchsorted(sample, (part.start, part.stop)))
        inside = sample[columns] - part.start
        torque[:, columns] = values[:, inside]
        turned[:, :, columns] = curves.turning(block[inside], *(rows[:, inside] for rows in moved))
        progress("motion over time", part.stop / len(times))

    ends = []
    for number, sense in enumerate((1.0, -1.0)):

        def read(
            span: IntArray, time: FloatArray, sense: float = sense
        ) -> tuple[FloatArray, FloatArray]:
            order = np.argsort(time, kind="stable")
            read = np.empty((2, len(time)))
            read[:, order] = curves.torque(time[order], span[order])[:2]
            return sense * read[0], sense * read[1]

        top, position = extremes[number].exact(read)
        sampled, earliest = best[number], when[number]
        slack = ALIKE * np.abs(sampled)
        alike = np.where(top < sampled - slack, earliest, np.minimum(position, earliest))
        peak_time = np.where(top > sampled + slack, position, alike)
        ends.append((np.maximum(top, sampled), peak_time))
    span, value = (np.concatenate(parts) for parts in zip(*turns, strict=True))
    order = np.argsort(span, kind="stable")
    edges = np.searchsorted(span[order], np.arange(1, spans))
    lacking = curves.missed(time, finer) + curves.unseen(chosen.left)
    by_span = tuple(np.split(value[order], edges)) if spans else ()
    angle, turning = turned
    return Seen(time, torque, angle, turning, tuple(ends), by_span, lacking, chosen.left)


def _choose_times(curves: Curves, time: FloatArray, *, counts: bool) -> tuple[Looked, int]:
    """The times at which curves are chosen at, and how many times finer than samples the modes are: as it pays."""
    modes, motion = curves.loaded.modes, curves.motion
    # 1/s of the fastest that vibrates or dies away.
    quickest = max(regime.fastest for regime in motion.regimes)
    # Times (s) at which a torque may jump or has a kink.
    steps = () if curves.loaded.follows is None else motion.begin
    events = (event.time for event in motion.events)
    cuts = np.unique([*motion.train.history.begin, *events, *steps])
    step, per_period = float(time[1] - time[0]), PER_PERIOD_COUNTED if counts else PER_PERIOD
    most = MOST_SUMS / (modes.torque.size + EXPONENTIAL * len(modes.frequency) + 1)
    needed = np.ceil(per_period * step * modes.frequency.max(initial=0.0))
    finer = int(np.clip(needed, 1, max(most / len(time), 1)))
    finer = max(1, min(finer, MOST_TIMES // len(time)))
    chosen = looked_at(time, finer, cuts, curves.waves, quickest, most, per_period)
    return replace(chosen, turn=max(chosen.turn, step / finer * quickest)), finer
