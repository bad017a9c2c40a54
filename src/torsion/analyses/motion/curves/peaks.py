"""The times at which curves are looked at, and their greatest and least values between these, from the motion itself.

No peak stands between the times unseen: four to a period of the fastest mode, of every torque that turns while it acts,
and of the steady vibration; some between every two cuts, at which a torque begins or ends, and closer and closer behind
each, for what dies away fast.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray, IntArray

PER_PERIOD = 4.0  # times from which a vibration is resolved
# where cycles are counted: a cubic through values and rates is then exact to 1e-4
PER_PERIOD_COUNTED = 16.0
BETWEEN = 16  # times between two cuts
MOST_BETWEEN = 200_000  # of them altogether, where cuts are many
MOST_TIMES = 4_000_000
CLOSER = math.sqrt(0.5)  # every next time behind a cut
MOST_CLOSER = 60
# peaks of one curve that are looked at; those that a steady vibration repeats are alike
ROUNDS = (0, 2, 8, 64)
DOUBT = 10.0  # times what the first of them differ from their cubics: lower ones are left out
NEGLIGIBLE = 1e-8  # of an interval: a value is flat at its peak, and its error is the square of that of the time
SECANTS = 12
HALVINGS = 26
# curve and time of each: value and rate
Curves = Callable[[IntArray, FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class Wave:
    """Something that vibrates for a time."""

    begin: float  # s
    end: float
    w: float  # rad/s


@dataclass(frozen=True)
class Looked:
    """Times that ascend, and which of them are the samples."""

    time: FloatArray
    sample: IntArray
    turn: float  # rad of the fastest in a step, at most
    left: float  # rad/s from which on some waves are not resolved: inf where all are


def looked_at(
    time: FloatArray,
    finer: int,
    cuts: FloatArray,
    waves: Iterable[Wave],
    quickest: float,
    budget: float,
    per_period: float,
) -> Looked:
    """From samples, and how many times finer the modes are resolved.

    quickest: 1/s of all that dies away. budget: times that there may be, besides samples and cuts. per_period: times to a
    period.
    """
    last, step = float(time[-1]), float(time[1] - time[0]) / finer
    samples = np.arange(len(time))
    base = np.interp(np.arange((len(time) - 1) * finer + 1) / finer, samples, time)
    cuts = np.unique(cuts[(cuts > 0.0) & (cuts < last)])
    times = [base, np.nextafter(cuts, 0.0), cuts]
    # Between cuts, and closer and closer behind each while what dies away is felt.
    edges = np.array([0.0, *cuts, last])
    starts, length = edges[:-1], np.diff(edges)
    number = max(2, min(BETWEEN, MOST_BETWEEN // len(starts)))
    times += [starts + length * (share / number) for share in range(1, number)]
    share = CLOSER / number
    for _ in range(MOST_CLOSER):
        needed = length * share * quickest > 1.0 / BETWEEN
        if not needed.any():
            break
        times.append((starts + length * share)[needed])
        share *= CLOSER
    room, left, turn, resolved = min(budget, MOST_TIMES), math.inf, 0.0, 2.0 * math.pi / per_period
    for wave in sorted(waves, key=lambda wave: wave.w):
        begin, end = max(wave.begin, 0.0), min(wave.end, last)
        if begin >= end or wave.w * step <= resolved:
            continue
        number = math.ceil((end - begin) * wave.w * per_period / (2.0 * math.pi))
        if number > room:
            left = min(left, wave.w)
            continue
        room, turn = room - number, resolved
        times.append(np.linspace(begin, end, number + 1)[:-1])
    moments = np.unique(np.concatenate(times))
    return Looked(moments, np.searchsorted(moments, time), turn, left)


@dataclass
class Extremes:
    """Candidates for the greatest value of every curve, gathered block by block of samples."""

    near: float  # of the range of a curve: how far below the highest a sampled peak is looked at exactly
    best: FloatArray  # (curves,) of the samples and of the cubics through them
    curve: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    # (candidates, 5) of the intervals between samples that may hold the greatest value: begin and end (s), height of the
    # cubic there, rate at the begin, and at the end
    interval: FloatArray = field(default_factory=lambda: np.empty((0, 5)))

    def add(self, time: FloatArray, value: FloatArray, rate: FloatArray) -> None:
        """Take in samples (curves, times) with their rates of change, a block that begins with the last sample."""
        curve, left, height = _cubic_peaks(time, value, rate)
        np.maximum.at(self.best, curve, height)
        self.best = np.maximum(self.best, value.max(axis=1, initial=-np.inf))
        close = height >= self.best[curve] - self.near * np.ptp(value, axis=1)[curve]
        curve, left = curve[close], left[close]
        columns = (
            time[left],
            time[left + 1],
            height[close],
            rate[curve, left],
            rate[curve, left + 1],
        )
        self.curve = np.concatenate([self.curve, curve])
        self.interval = np.concatenate([self.interval, np.stack(columns, axis=1)])

    def exact(self, curves: Curves) -> tuple[FloatArray, FloatArray]:
        """(curves,) greatest values of all peaks inside, and their times; -inf where a curve has none."""
        begin, height = self.interval[:, 0], self.interval[:, 2]
        order = np.lexsort((-height, self.curve))
        rank = np.arange(len(order)) - np.searchsorted(self.curve[order], self.curve[order])
        top, (when, doubt) = np.full(len(self.best), -np.inf), np.zeros((2, len(self.best)))
        for first, last in pairwise(ROUNDS):
            chosen = order[(rank >= first) & (rank < last)]
            curve = self.curve[chosen]
            chosen = chosen[height[chosen] >= top[curve] - DOUBT * doubt[curve]]
            chosen = chosen[np.argsort(begin[chosen], kind="stable")]
            curve, peak = self.curve[chosen], self._peak_times(chosen, curves)
            value = curves(curve, peak)[0] if len(curve) else np.empty(0)
            np.maximum.at(doubt, curve, np.abs(value - height[chosen]))
            for number in np.argsort(value, kind="stable").tolist():
                if value[number] > top[curve[number]]:
                    top[curve[number]], when[curve[number]] = value[number], peak[number]
        return top, when

    def _peak_times(self, chosen: IntArray, curves: Curves) -> FloatArray:
        """(chosen,) s, where the rate of each changes from rising to falling: secants within brackets, then halving.

        A secant whose end stays is taken with half of the value there (Illinois, Dowell and Jarratt 1971).
        """
        low, high, _, rising, falling = self.interval[chosen].T.copy()
        peak, near = np.array(low), (high - low) * NEGLIGIBLE
        left, before = np.arange(len(chosen)), np.full(len(chosen), 2)
        for turn in range(SECANTS + HALVINGS):
            if not left.size:
                break
            a, b, up, down = low[left], high[left], rising[left], falling[left]
            share = up / (up - down) if turn < SECANTS else 0.5
            time = np.clip(a + (b - a) * share, a, b)
            order = np.argsort(time, kind="stable")
            rate = np.empty(len(time))
            rate[order] = curves(self.curve[chosen[left[order]]], time[order])[1]
            rises = rate > 0.0
            low[left], high[left] = np.where(rises, time, a), np.where(rises, b, time)
            again = np.where(rises == before[left], 2.0, 1.0)
            rising[left] = np.where(rises, rate, up / again)
            falling[left] = np.where(rises, down / again, rate)
            before[left] = rises
            done = (np.abs(time - peak[left]) < near[left]) | (rate == 0.0)
            peak[left] = time
            left = left[~done]
        return peak


def turns_within(
    time: FloatArray, value: FloatArray, rate: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Curve and value of all turns of curves (curves, times), in the order of time: also those of the cubics between.

    The ends stand among them.
    """
    row = np.full((len(value), 2 * len(time) - 1), np.nan)
    row[:, ::2] = value
    for sense in (1.0, -1.0):
        curve, left, height = _cubic_peaks(time, sense * value, sense * rate)
        row[curve, 2 * left + 1] = sense * height
    curve, column = np.nonzero(~np.isnan(row))
    values = row[curve, column]
    way, is_next = np.sign(np.diff(values)), np.diff(curve) > 0
    kept = np.ones(len(values), dtype=bool)
    kept[1:-1] = (way[1:] != way[:-1]) | is_next[1:] | is_next[:-1]
    return curve[kept], values[kept]


def _cubic_peaks(
    time: FloatArray, value: FloatArray, rate: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Curve, left sample and height of the peaks between samples where a curve rises, then falls.

    The cubic goes through values and rates at both ends of an interval.
    """
    curve, left = np.nonzero((rate[:, :-1] > 0.0) & (rate[:, 1:] < 0.0))
    step, first, last = np.diff(time)[left], value[curve, left], value[curve, left + 1]
    start, stop = rate[curve, left] * step, rate[curve, left + 1] * step
    square = 3.0 * (last - first) - 2.0 * start - stop
    cube = start + stop - 2.0 * (last - first)
    root = np.sqrt(np.maximum(square**2 - 3.0 * cube * start, 0.0))
    x = np.clip(start / np.maximum(root - square, np.finfo(float).tiny), 0.0, 1.0)
    return curve, left, first + x * (start + x * (square + x * cube))
