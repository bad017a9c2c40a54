"""Damage of a motion over time: cycles by rainflow (ASTM E1049, the residue as half cycles), their sum after Miner."""

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsion.analyses.motion.events.transient_settings import Fatigue
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.sources import source


@source("ASTM-E1049")
def cycles(points: FloatArray) -> Iterator[tuple[float, float, float]]:
    """(half range, mean, count) of every cycle of turning points (points,) N m."""
    import rainflow

    for spread, mean, count, *_ in rainflow.extract_cycles(points):
        yield spread / 2.0, mean, count


@source("Miner1945")
def miner(counted: Iterable[tuple[float, float, float]], line: Fatigue) -> float:
    """The sum of count / cycles borne; by Goodman an amplitude is divided by 1 - mean/ultimate, infinite from there."""
    damage = 0.0
    for amplitude, mean, count in counted:
        left = 1.0 if line.ultimate is None else 1.0 - abs(mean) / line.ultimate
        if left <= 0.0:
            return math.inf
        damage += count * (amplitude / left / line.amplitude) ** line.slope / line.cycles
    return damage


def damages(system: System, line: Fatigue, turns: Sequence[FloatArray]) -> FloatArray:
    """(spans,) Miner's sum of torques, each given by all values at which it turns; NaN where the file names others."""
    names = (system.train.parts[part].name for part in system.span_part.tolist())
    return np.array(
        [
            miner(cycles(points), line) if not line.at or name in line.at else np.nan
            for name, points in zip(names, turns, strict=True)
        ]
    )
