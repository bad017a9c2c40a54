"""Barred speed ranges of IACS UR M68: the least width about every critical speed, and every speed above tau_C."""

import numpy as np

from torsion.kernels.tree import BoolArray
from torsion.rules.check import BarredRange
from torsion.rules.judgement import Curve, worst_of
from torsion.rules.m68_formulas import barred_range, may_be_barred


def barred_ranges(curve: Curve, rated: float, shaft: str, tolerance: float = 0.0) -> tuple[BarredRange, ...]:
    """The ranges, ascending and apart, for stress over speed against tau_C below 0.8 of the rated speed (rad/s).

    `tolerance` is the tachometer's, by which both ends move outward.
    """
    exceeds = curve.exceeds() & may_be_barred(curve.speed / rated)
    ranges = [_range(curve, rated, shaft, tolerance, first, last) for first, last in _runs(exceeds)]
    merged: list[BarredRange] = []
    for later in ranges:
        if merged and later.lower <= merged[-1].upper:
            merged[-1] = _together(curve, merged[-1], later)
        else:
            merged.append(later)
    return tuple(merged)


def inside(ranges: tuple[BarredRange, ...], curve: Curve, rated: float) -> BoolArray:
    """(speeds,) which speeds are barred; none from 0.8 of the rated speed."""
    barred = np.zeros(len(curve.speed), dtype=bool)
    for one in ranges:
        barred |= (curve.speed >= one.lower) & (curve.speed <= one.upper)
    return barred & may_be_barred(curve.speed / rated)


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
