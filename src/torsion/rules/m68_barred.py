"""Barred speed ranges of IACS UR M68: the least width about every critical speed, and every speed above tau_C."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray
from torsion.rules.judgement import Curve, worst_of
from torsion.rules.m68_formulas import barred_range, may_be_barred
from torsion.rules.verdict_line import BarredRange


@dataclass(frozen=True)
class Barring:
    """What the stress above tau_C asks to be barred, and where the rule permits it."""

    permitted: tuple[BarredRange, ...]  # ascending and apart
    refused: tuple[BarredRange, ...]  # those that reach 0.8 of the rated speed, ascending and apart
    passed: BoolArray  # (speeds,) inside a permitted range, and not above tau_C within a refused one


def barring(curve: Curve, rated: float, shaft: str, tolerance: float = 0.0) -> Barring:
    """The ranges for stress over speed against tau_C; rated in rad/s.

    A run of speeds above tau_C has its critical speed at its worst, wherever that lies; the range about it is refused
    where its upper end reaches 0.8 of the rated speed. Both ends move outward by the `tolerance` of the tachometer.
    """
    passed, ranges = np.zeros(len(curve.speed), dtype=bool), []
    above = np.zeros(len(curve.speed), dtype=bool)
    for first, last in _runs(curve.exceeds()):
        one = _range(curve, rated, shaft, tolerance, first, last)
        ranges.append(one)
        above[first : last + 1] |= not may_be_barred(one.upper / rated)
    permitted = _apart(curve, [one for one in ranges if may_be_barred(one.upper / rated)])
    for one in permitted:
        passed |= (curve.speed > one.lower) & (curve.speed < one.upper)
    refused = _apart(curve, [one for one in ranges if not may_be_barred(one.upper / rated)])
    return Barring(permitted, refused, passed & ~above)


def _apart(curve: Curve, ranges: list[BarredRange]) -> tuple[BarredRange, ...]:
    """Ascending ranges with those that overlap as one."""
    merged: list[BarredRange] = []
    for later in ranges:
        if merged and later.lower <= merged[-1].upper:
            merged[-1] = _together(curve, merged[-1], later)
        else:
            merged.append(later)
    return tuple(merged)


def _runs(mask: BoolArray) -> list[tuple[int, int]]:
    """First and last position of every unbroken run."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    pairs = zip(np.flatnonzero(edges > 0).tolist(), np.flatnonzero(edges < 0).tolist(), strict=True)
    return [(first, end - 1) for first, end in pairs]


def _range(curve: Curve, rated: float, shaft: str, tolerance: float, first: int, last: int) -> BarredRange:
    """One range from a run of speeds above tau_C."""
    run = slice(first, last + 1)
    critical = float(curve.speed[first + worst_of(curve.utilisation()[run], curve.value[run])])
    lower, upper = barred_range(critical, rated)
    lower = min(lower, _crossing(curve, first, first - 1)) * (1.0 - tolerance)
    upper = max(upper, _crossing(curve, last, last + 1)) * (1.0 + tolerance)
    return BarredRange(lower, upper, critical, shaft)


def _crossing(curve: Curve, above: int, beyond: int) -> float:
    """Speed between two neighbours at which the stress meets its limit, by a straight line.

    The flank of a resonance is hollow, so the line errs outward. The far neighbour where a value is not finite.
    """
    if not 0 <= beyond < len(curve.speed):
        return float(curve.speed[above])
    share = curve.utilisation()[[above, beyond]]
    if not np.all(np.isfinite(share)) or share[1] > 1.0:
        return float(curve.speed[beyond])
    step = (share[0] - 1.0) / (share[0] - share[1])
    return float(curve.speed[above] + step * (curve.speed[beyond] - curve.speed[above]))


def _together(curve: Curve, one: BarredRange, other: BarredRange) -> BarredRange:
    """Two overlapping ranges as one, about the worse critical speed."""
    at = [int(np.flatnonzero(curve.speed == each.critical)[0]) for each in (one, other)]
    worse = (one, other)[worst_of(curve.utilisation()[at], curve.value[at])]
    return BarredRange(min(one.lower, other.lower), max(one.upper, other.upper), worse.critical, one.shaft)
