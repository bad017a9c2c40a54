"""Critical speeds: where an order that excites the train meets one of its natural frequencies."""

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.analyses.damped import DampedModes
from torsion.analyses.modes import Modes
from torsion.analyses.response.excitation import Line
from torsion.study import Operation


@dataclass(frozen=True, slots=True)
class CriticalSpeed:
    """One crossing of the Campbell diagram."""

    mode: int  # counted from 1
    order: Fraction  # of the reference station
    sources: tuple[str, ...]  # names of what excites that order
    frequency: float  # Hz
    speed: float  # rad/s of the reference station
    is_inside: bool  # within the speed range
    margin: float | None  # (speed - rated)/rated, or from the nearest end of the range; None where neither is given


def critical_speeds(
    modes: Modes | DampedModes, lines: tuple[Line, ...], operation: Operation
) -> tuple[CriticalSpeed, ...]:
    """Every crossing of an order with a mode, by ascending speed; lines of fixed frequency cross nothing."""
    found = []
    for line in lines:
        if line.order is None:
            continue
        for mode, frequency in enumerate(modes.frequency.tolist(), start=1):
            speed = 2.0 * math.pi * frequency / float(line.order)
            found.append(_crossing(mode, line.order, line.sources, frequency, speed, operation))
    return tuple(sorted(found, key=lambda crossing: (crossing.speed, crossing.mode)))


def _crossing(
    mode: int, order: Fraction, sources: tuple[str, ...], frequency: float, speed: float, operation: Operation
) -> CriticalSpeed:
    speeds, rated = operation.speeds, operation.rated
    inside = speeds is not None and speeds.first <= speed <= speeds.last
    margin = None
    if rated is not None:
        margin = (speed - rated.speed) / rated.speed
    elif speeds is not None:
        ends = np.array([speeds.first, speeds.last])
        end = float(ends[np.argmin(np.abs(ends - speed))])
        margin = (speed - end) / end
    return CriticalSpeed(mode, order, sources, frequency, speed, inside, margin)
