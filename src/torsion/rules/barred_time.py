"""How long motions over time stay within barred or unstable ranges, and how much of the steady resonance they reach."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import FloatArray
from torsion.findings import Results
from torsion.rules.verdict_line import BarredRange, BarredTime

if TYPE_CHECKING:
    from torsion.analyses.motion.transient_motion import Transients


def barred_times(evidence: Results, ranges: tuple[BarredRange, ...]) -> tuple[BarredTime, ...]:
    """Of every motion that enters a range, in the order of the motions."""
    found: Transients | None = evidence.results.get(
        "transient"
    )  # its class is not loaded where there is none
    return () if found is None else tuple(_times(evidence, found, ranges))


def _times(
    evidence: Results, found: "Transients", ranges: tuple[BarredRange, ...]
) -> Iterator[BarredTime]:
    from torsion.analyses.motion.resonances_passed import mean_speed

    for motion in found.each:
        speed = np.abs(mean_speed(evidence.system, motion.speed))
        for one in ranges:
            seconds = within(motion.time, speed, one.lower, one.upper)
            if seconds:
                reached = [
                    passed.share
                    for passed in motion.passages
                    if one.lower <= abs(passed.speed) <= one.upper
                ]
                stays = one.lower < float(speed[-1]) < one.upper
                yield BarredTime(
                    motion.name, one.lower, one.upper, seconds, max(reached, default=None), stays
                )


def within(time: FloatArray, speed: FloatArray, lower: float, upper: float) -> float:
    """Seconds for which a speed, straight between its samples, lies between two ends.

    >>> within(np.array([0.0, 1.0, 3.0]), np.array([0.0, 10.0, 10.0]), 4.0, 6.0)
    0.2
    >>> within(np.array([0.0, 1.0, 3.0]), np.array([0.0, 10.0, 10.0]), 9.0, 11.0)
    2.1
    """
    low, high = np.minimum(speed[:-1], speed[1:]), np.maximum(speed[:-1], speed[1:])
    common = np.minimum(high, upper) - np.maximum(low, lower)
    still = (high == low) & (common >= 0.0)
    share = np.divide(
        np.maximum(common, 0.0), high - low, out=still.astype(float), where=high > low
    )
    return float(round(float(share @ np.diff(time)), 12))


def words(times: tuple[BarredTime, ...]) -> str:
    """Of all motions within barred ranges in a remark; empty where none enters one."""
    return "; ".join(map(_words, times))


def unstable_words(times: tuple[BarredTime, ...]) -> str:
    """Of all motions within unstable ranges."""
    return "; ".join(
        f"{_name(one)} is {one.seconds:.3g} s within an unstable range, where it grows"
        for one in times
    )


def _name(one: BarredTime) -> str:
    return f"the motion over time {one.motion}".rstrip()


def _words(one: BarredTime) -> str:
    reaches = "" if one.share is None else f", {100.0 * one.share:.3g} % of the steady resonance"
    if one.stays:
        return f"{_name(one)} ends within the range, after {one.seconds:.3g} s in it{reaches}"
    return f"passed in {one.seconds:.3g} s{reaches} by {_name(one)}: as fast as possible, without a limit"
