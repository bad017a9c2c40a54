"""The greatest and least value of curves between their samples, from the motion itself."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray

NEAR = 1e-3  # of the range of a curve: how far below the highest a sampled peak is looked at exactly
MOST = 64  # peaks of one curve that are looked at; those that a steady vibration repeats are alike
HALVINGS = 26  # of the interval: a value is flat at its peak, and its error is the square of that of the time
Curves = Callable[[IntArray, FloatArray], tuple[FloatArray, FloatArray]]  # curve and time of each: value and rate


@dataclass
class Extremes:
    """Candidates for the greatest value of every curve, gathered block by block of samples."""

    best: FloatArray  # (curves,) of the samples and of the cubics through them
    curve: IntArray
    begin: FloatArray  # s, of the intervals between samples that may hold the greatest value
    end: FloatArray
    height: FloatArray  # of the cubic there

    @classmethod
    def none(cls, curves: int) -> "Extremes":
        """Nothing gathered yet."""
        empty = np.empty(0)
        return cls(np.full(curves, -np.inf), np.empty(0, dtype=np.int64), empty, empty, empty)

    def add(self, time: FloatArray, value: FloatArray, rate: FloatArray) -> None:
        """Take in samples (curves, times) with their rates of change, a block that begins with the last sample."""
        step = np.diff(time)
        rises, falls = rate[:, :-1] > 0.0, rate[:, 1:] < 0.0
        curve, at = np.nonzero(rises & falls)
        height = _cubic_peak(value[curve, at], value[curve, at + 1], rate[curve, at], rate[curve, at + 1], step[at])
        np.maximum.at(self.best, curve, height)
        self.best = np.maximum(self.best, value.max(axis=1, initial=-np.inf))
        close = height >= self.best[curve] - NEAR * np.ptp(value, axis=1)[curve]
        self.curve = np.concatenate([self.curve, curve[close]])
        self.begin = np.concatenate([self.begin, time[at[close]]])
        self.end = np.concatenate([self.end, time[at[close] + 1]])
        self.height = np.concatenate([self.height, height[close]])

    def exact(self, curves: Curves) -> tuple[FloatArray, FloatArray]:
        """(curves,) greatest values of all peaks inside, and their times; -inf where a curve has none."""
        order = np.lexsort((-self.height, self.curve))
        place = np.arange(len(order)) - np.searchsorted(self.curve[order], self.curve[order])
        chosen = order[place < MOST]
        chosen = chosen[np.argsort(self.begin[chosen], kind="stable")]
        curve, low, high = self.curve[chosen], self.begin[chosen].copy(), self.end[chosen].copy()
        for _ in range(HALVINGS):
            middle = low + (high - low) / 2.0
            if ((middle <= low) | (middle >= high)).all():
                break
            rises = curves(curve, middle)[1] > 0.0
            low, high = np.where(rises, middle, low), np.where(rises, high, middle)
        top, when = np.full(len(self.best), -np.inf), np.zeros(len(self.best))
        if len(curve):
            found = curves(curve, low)[0]
            for number in np.argsort(found, kind="stable").tolist():
                top[curve[number]], when[curve[number]] = found[number], low[number]
        return top, when


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
