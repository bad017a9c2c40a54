"""Lumped assembly: every shaft as segments, half of a segment's inertia at each of its ends."""

import math

from torsion.assembly.collected import Collected
from torsion.assembly.shafts import bar_segments, is_uniform, phase
from torsion.assembly.system import System
from torsion.primitives import Bar
from torsion.train import Train

SHARE_OF_ERROR = 1e-3  # a frequency of a lumped shaft is right to this share
FEWEST, MOST = 1, 20_000


def segments_for(bar: Bar, frequency: float) -> int:
    """Segments that keep the error of a frequency (Hz) below SHARE_OF_ERROR.

    n lumped segments lower a frequency by (mu/n)^2/24, with mu the phase along the shaft (from 2n/mu sin(mu/2n), the
    closed form of a uniform chain). A cone is given twice as many.
    """
    if bar.segments is not None:
        return bar.segments
    if bar.density == 0:
        return 1
    number = math.ceil(phase(bar, frequency) / math.sqrt(24.0 * SHARE_OF_ERROR))
    return min(max(number * (1 if is_uniform(bar) else 2), FEWEST), MOST)


def assemble_lumped(train: Train, *, frequency: float = 0.0) -> System:
    """The system in which every shaft has enough segments for a highest frequency (Hz)."""
    found = Collected.of(train)
    segments: dict[str, int] = {}
    for bar in train.bars:
        segments[bar.name] = number = segments_for(bar, frequency)
        found.row(bar, *bar_segments(bar, number))
    return found.system("lumped", segments)
