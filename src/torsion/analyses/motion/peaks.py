"""The greatest and least value of curves between their samples, from the motion itself."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray, IntArray

ROUNDS = (
    0,
    2,
    8,
    64,
)  # peaks of one curve that are looked at; those that a steady vibration repeats are alike
DOUBT = 10.0  # times what the first of them differ from their cubics: lower ones are left out
NEGLIGIBLE = 1e-8  # of an interval: a value is flat at its peak, and its error is the square of that of the time
SECANTS = 12
HALVINGS = 26
Curves = Callable[
    [IntArray, FloatArray], tuple[FloatArray, FloatArray]
]  # curve and time of each: value and rate


@dataclass
class Extremes:
    """Candidates for the greatest value of every curve, gathered block by block of samples."""

    near: float  # of the range of a curve: how far below the highest a sampled peak is looked at exactly
    best: FloatArray  # (curves,) of the samples and of the cubics through them
    curve: IntArray
    begin: FloatArray  # s, of the intervals between samples that may hold the greatest value
    end: FloatArray
    height: FloatArray  # of the cubic there
    rising: FloatArray  # rates at the begin, and at the end
    falling: FloatArray

    @classmethod
    def none(cls, curves: int, near: float) -> "Extremes":
        """Nothing gathered yet."""
        empty = np.empty(0)
        return cls(near, np.full(curves, -np.inf), np.empty(0, dtype=np.int64), *[empty] * 5)

    def add(self, time: FloatArray, value: FloatArray, rate: FloatArray) -> None:
        """Take in samples (curves, times) with their rates of change, a block that begins with the last sample."""
        step = np.diff(time)
        rises, falls = rate[:, :-1] > 0.0, rate[:, 1:] < 0.0
        curve, at = np.nonzero(rises & falls)
        height = _cubic_peak(
            value[curve, at], value[curve, at + 1], rate[curve, at], rate[curve, at + 1], step[at]
        )
        np.maximum.at(self.best, curve, height)
        self.best = np.maximum(self.best, value.max(axis=1, initial=-np.inf))
        close = height >= self.best[curve] - self.near * np.ptp(value, axis=1)[curve]
        self.curve = np.concatenate([self.curve, curve[close]])
        self.begin = np.concatenate([self.begin, time[at[close]]])
        self.end = np.concatenate([self.end, time[at[close] + 1]])
        self.height = np.concatenate([self.height, height[close]])
        self.rising = np.concatenate([self.rising, rate[curve, at][close]])
        self.falling = np.concatenate([self.falling, rate[curve, at + 1][close]])

    def exact(self, curves: Curves) -> tuple[FloatArray, FloatArray]:
        """(curves,) greatest values of all peaks inside, and their times; -inf where a curve has none."""
        order = np.lexsort((-self.height, self.curve))
        place = np.arange(len(order)) - np.searchsorted(self.curve[order], self.curve[order])
        top, when, doubt = (
            np.full(len(self.best), -np.inf),
            np.zeros(len(self.best)),
            np.zeros(len(self.best)),
        )
        for first, last in pairwise(ROUNDS):
            chosen = order[(place >= first) & (place < last)]
            own = self.curve[chosen]
            chosen = chosen[self.height[chosen] >= top[own] - DOUBT * doubt[own]]
            chosen = chosen[np.argsort(self.begin[chosen], kind="stable")]
            curve, at = self.curve[chosen], self._settled(chosen, curves)
            found = curves(curve, at)[0] if len(curve) else np.empty(0)
            np.maximum.at(doubt, curve, np.abs(found - self.height[chosen]))
            for number in np.argsort(found, kind="stable").tolist():
                if found[number] > top[curve[number]]:
                    top[curve[number]], when[curve[number]] = found[number], at[number]
        return top, when

    def _settled(self, chosen: IntArray, curves: Curves) -> FloatArray:
        """(chosen,) s, where the rate of each changes from rising to falling: secants within brackets, then halving.

        A secant whose end stays is taken with half of the value there (Illinois, Dowell and Jarratt 1971).
        """
        low, high = self.begin[chosen].copy(), self.end[chosen].copy()
        rising, falling = self.rising[chosen].copy(), self.falling[chosen].copy()
        found, near = low.copy(), (high - low) * NEGLIGIBLE
        left, before = np.arange(len(chosen)), np.full(len(chosen), 2)
        for turn in range(SECANTS + HALVINGS):
            if not left.size:
                break
            a, b, up, down = low[left], high[left], rising[left], falling[left]
            share = up / (up - down) if turn < SECANTS else 0.5
            at = np.clip(a + (b - a) * share, a, b)
            order = np.argsort(at, kind="stable")
            rate = np.empty(len(at))
            rate[order] = curves(self.curve[chosen[left[order]]], at[order])[1]
            rises = rate > 0.0
            low[left], high[left] = np.where(rises, at, a), np.where(rises, b, at)
            again = np.where(rises == before[left], 2.0, 1.0)
            rising[left], falling[left] = (
                np.where(rises, rate, up / again),
                np.where(rises, down / again, rate),
            )
            before[left] = rises
            done = (np.abs(at - found[left]) < near[left]) | (rate == 0.0)
            found[left] = at
            left = left[~done]
        return found


def turns_within(
    time: FloatArray, value: FloatArray, rate: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Curve and value of all turns of curves (curves, times), in the order of time: also those of the cubics between.

    The ends stand among them.
    """
    step, row = np.diff(time), np.full((len(value), 2 * len(time) - 1), np.nan)
    row[:, ::2] = value
    for sense in (1.0, -1.0):
        curve, at = np.nonzero((sense * rate[:, :-1] > 0.0) & (sense * rate[:, 1:] < 0.0))
        first, last = sense * value[curve, at], sense * value[curve, at + 1]
        rising, falling = sense * rate[curve, at], sense * rate[curve, at + 1]
        row[curve, 2 * at + 1] = sense * _cubic_peak(first, last, rising, falling, step[at])
    curve, at = np.nonzero(~np.isnan(row))
    every = row[curve, at]
    way = np.sign(np.diff(every))
    kept = np.ones(len(every), dtype=bool)
    kept[1:-1] = (way[1:] != way[:-1]) | (np.diff(curve)[1:] > 0) | (np.diff(curve)[:-1] > 0)
    return curve[kept], every[kept]


def _cubic_peak(
    first: FloatArray, last: FloatArray, rising: FloatArray, falling: FloatArray, step: FloatArray
) -> FloatArray:
    """Greatest value of the cubic through values and rates at both ends of an interval: it rises, then falls."""
    start, stop = rising * step, falling * step
    square = 3.0 * (last - first) - 2.0 * start - stop
    cube = start + stop - 2.0 * (last - first)
    root = np.sqrt(np.maximum(square**2 - 3.0 * cube * start, 0.0))
    x = np.clip(start / np.maximum(root - square, np.finfo(float).tiny), 0.0, 1.0)
    return np.asarray(first + x * (start + x * (square + x * cube)))
