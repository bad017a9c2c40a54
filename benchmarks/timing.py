"""Timing of several functions in one process, taken in turn so that a slow minute of the machine falls on all alike."""

import gc
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import Any

CALLS_A_TURN = 20  # at most, of a function that is faster than its partners


@dataclass(frozen=True)
class Timing:
    """Seconds a call."""

    best: float
    median: float
    calls: int

    def __add__(self, other: "Timing") -> "Timing":
        """Two steps done one after the other."""
        return Timing(self.best + other.best, self.median + other.median, min(self.calls, other.calls))


def interleaved(functions: dict[str, Callable[[], Any]], seconds: float) -> dict[str, Timing]:
    """Times A B A B ... until about `seconds` are used.

    Each is called once to warm up; a function that takes more than a fifth of the time allowed is then not called
    again, and that call is its only sample.
    """
    first = {name: _timed(function) for name, function in functions.items()}
    samples = {name: [time] if time > seconds / 5 else [] for name, time in first.items()}
    turning = [name for name, times in samples.items() if not times]
    longest = max(first.values())
    calls = {name: max(1, min(CALLS_A_TURN, int(longest / first[name]))) for name in turning}
    end = perf_counter() + seconds
    while turning and (perf_counter() < end or not samples[turning[0]]):
        gc.collect()
        for name in turning:
            samples[name].extend(_timed(functions[name]) for _ in range(calls[name]))
    return {name: Timing(min(times), statistics.median(times), len(times)) for name, times in samples.items()}


def _timed(function: Callable[[], Any]) -> float:
    gc.disable()
    try:
        start = perf_counter()
        function()
        return perf_counter() - start
    finally:
        gc.enable()
