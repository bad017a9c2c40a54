"""Lumped assembly: every shaft as segments, half of a segment's inertia at each of its ends."""

import math

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray
from torsion.assembly.spans import Row, bar_segments, is_uniform, phase
from torsion.assembly.system import Discretisation, System
from torsion.assembly.system_builder import Collected
from torsion.primitives import Bar
from torsion.train import Train

SHARE_OF_ERROR = 1e-3  # a frequency of a lumped shaft is right to this share
LARGEST_PHASE = math.sqrt(24.0 * SHARE_OF_ERROR)  # rad along a segment of a uniform shaft
FEWEST, MOST = 1, 19_999  # with both ends the stations that a train may have


def segments_along(phase: ArrayLike, excess: ArrayLike) -> FloatArray:
    """Segments of shafts with a phase (rad) along each, and as many times more as a uniform one.

    They keep the error of a frequency below SHARE_OF_ERROR: n lumped segments lower it by (mu/n)^2/24, with mu the
    phase along the shaft (from 2n/mu sin(mu/2n), the closed form of a uniform chain). A cone is given twice as many.
    """
    return np.clip(np.ceil(np.asarray(phase) / LARGEST_PHASE) * excess, FEWEST, MOST)


def is_refined(bar: Bar) -> bool:
    """The number of its segments depends on the highest frequency."""
    return bar.density > 0 and bar.segments is None


def excess(bar: Bar) -> int:
    """How many times more segments a shaft is given than a uniform one."""
    return 1 if is_uniform(bar) else 2


def assemble_lumped(train: Train, requested: Discretisation) -> System:
    """The system in which every shaft has enough segments for a highest frequency (Hz)."""
    collected = Collected.of(train)
    segments = {
        bar.name: int(segments_along(phase(bar, requested.frequency), excess(bar)))
        if is_refined(bar)
        else bar.segments or 1
        for bar in train.bars
    }
    collected.refuse_more(len(train.stations) + sum(segments.values()) - len(segments), segments)
    for bar in train.bars:
        row = Row(bar, segments[bar.name], len(collected.stations), collected.stations[bar.driving])
        collected.add_shaft(row, *bar_segments(bar, row.number))
        collected.rows.append(row)
    resolved = (
        segments[bar.name] / excess(bar) * LARGEST_PHASE / phase(bar, 1.0)
        for bar in filter(is_refined, train.bars)
    )
    return collected.system("lumped", segments, requested, min(resolved, default=math.inf))
