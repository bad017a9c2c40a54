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
    # Its class is not loaded where there is none.
    transients: Transients | None = evidence.results.get("transient")
    return () if transients is None else tuple(_times(evidence, transients, ranges))


def _times(
    evidence: Results, transients: "Transients", ranges: tuple[BarredRange, ...]
) -> Iterator[BarredTime]:
    from torsion.analyses.motion.derived.resonances_passed import mean_speed

    for motion in transients.each:
        speed = np.abs(mean_speed(evidence.system, motion.speed))
        passages = [(abs(passage.speed), passage.share) for passage in motion.passages]
        for barred in ranges:
            low, high = barred.lower, barred.upper
            seconds = within(motion.time, speed, low, high)
            if seconds:
                shares = [share for passed, share in passages if low <= passed <= high]
                stays = low < float(speed[-1]) < high
                yield BarredTime(motion.name, low, high, seconds, max(shares, default=None), stays)


def within(time: FloatArray, speed: FloatArray, lower: float, upper: float) -> float:
    """Seconds for which a speed, straight between its samples, lies between two ends.

    >>> within(np.array([0.0, 1.0, 3.0]), np.array([0.0, 10.0, 10.0]), 4.0, 6.0)
    0.2
    >>> within(np.array([0.0, 1.0, 3.0]), np.array([0.0, 10.0, 10.0]), 9.0, 11.0)
    2.1
    """
    low, high = np.minimum(speed[:-1], speed[1:]), np.maximum(speed[:-1], speed[1:])
    common = np.minimum(high, upper) - np.maximum(low, lower)
    still = ((high == low) & (common >= 0.0)).astype(float)
    share = np.divide(np.maximum(common, 0.0), high - low, out=still, where=high > low)
    return float(round(float(share @ np.diff(time)), 12))


def words(times: tuple[BarredTime, ...]) -> str:
    """Of all motions within barred ranges in a remark; empty where none enters one."""
    return "; ".join(map(_words, times))


def unstable_words(times: tuple[BarredTime, ...]) -> str:
    """Of all motions within unstable ranges."""
    ends = "within an unstable range, where it grows"
    return "; ".join(f"{_name(time)} is {time.seconds:.3g} s {ends}" for time in times)


def _name(time: BarredTime) -> str:
    return f"the motion over time {time.motion}".rstrip()


def _words(time: BarredTime) -> str:
    reaches = ""
    if time.share is not None:
        reaches = f", {100.0 * time.share:.3g} % of the steady resonance"
    if time.stays:
        return f"{_name(time)} ends within the range, after {time.seconds:.3g} s in it{reaches}"
    return f"passed in {time.seconds:.3g} s{reaches} by {_name(time)}: as fast as possible, without a limit"
