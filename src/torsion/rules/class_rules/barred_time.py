"""How long motions over time stay within barred or unstable ranges, and how much of the steady resonance they reach."""

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
    if transients is None:
        return ()
    from torsion.analyses.motion.derived.resonances_passed import mean_speed

    times = list[BarredTime]()
    for motion in transients.each:
        speed = np.abs(mean_speed(evidence.system, motion.speed))
        for barred in ranges:
            low, high = barred.lower, barred.upper
            if seconds := within(motion.time, speed, low, high):
                passed = (part for part in motion.passages if low <= abs(part.speed) <= high)
                share = max((passage.share for passage in passed), default=None)
                stays = low < float(speed[-1]) < high
                times.append(BarredTime(motion.name, low, high, seconds, share, stays))
    return tuple(times)


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


def words(times: tuple[BarredTime, ...], within_range: str = "") -> str:
    """Of all motions within ranges in a remark: how they pass barred ones, or that they are `within_range`."""
    remarks = list[str]()
    for time in times:
        name, seconds = f"the motion over time {time.motion}".rstrip(), f"{time.seconds:.3g} s"
        reaches = ""
        if time.share is not None:
            reaches = f", {100.0 * time.share:.3g} % of the steady resonance"
        if within_range:
            remarks.append(f"{name} is {seconds} {within_range}")
        elif time.stays:
            remarks.append(f"{name} ends within the range, after {seconds} in it{reaches}")
        else:
            fast = "as fast as possible, without a limit"
            remarks.append(f"passed in {seconds}{reaches} by {name}: {fast}")
    return "; ".join(remarks)
