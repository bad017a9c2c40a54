"""Damage of a motion over time: cycles by rainflow (ASTM E1049, the residue as half cycles), their sum after Miner."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsion.analyses.motion.transient_settings import Fatigue
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.sources import source


@source("ASTM-E1049")
def cycles(points: FloatArray) -> Iterator[tuple[float, float, float]]:
    """(half range, mean, count) of every cycle of turning points (points,) N m."""
    import rainflow

    return (
        (spread / 2.0, mean, count) for spread, mean, count, *_ in rainflow.extract_cycles(points)
    )


@source("Miner1945")
def miner(counted: Iterable[tuple[float, float, float]], line: Fatigue) -> float:
    """The sum of count / cycles borne; by Goodman an amplitude is divided by 1 - mean/ultimate, infinite from there."""
    found = 0.0
    for amplitude, mean, count in counted:
        left = 1.0 if line.ultimate is None else 1.0 - abs(mean) / line.ultimate
        found += (
            count * (amplitude / left / line.amplitude) ** line.slope / line.cycles
            if left > 0.0
            else np.inf
        )
    return found


def damages(system: System, line: Fatigue, turns: Sequence[FloatArray]) -> FloatArray:
    """(spans,) Miner's sum of torques, each given by all values at which it turns; NaN where the file names others."""
    names = [system.train.parts[part].name for part in system.span_part.tolist()]
    known = [not line.at or name in line.at for name in names]
    return np.array(
        [
            miner(cycles(one), line) if judged else np.nan
            for one, judged in zip(turns, known, strict=True)
        ]
    )
