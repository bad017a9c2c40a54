"""The verdicts on the stability of bending shafts: no whirl and no tilting may grow at any speed of the operation.

As with the stability of the train, what was not looked at of the operation is not passed.
"""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.lateral.shaft_bending import Lateral, ShaftFound
from torsion.analyses.lateral.tilt_stability import Tilting
from torsion.arrays import FloatArray
from torsion.findings import Results
from torsion.rules.verdict_line import Check, Rule
from torsion.study import Operation

ROUNDING = 1e-9  # of a logarithmic decrement, and of speeds relative to themselves
PART = "only a part of the operation's speeds was looked at"


class StableBending(Rule):
    """The rule on whatever bending was computed."""

    def check(self, evidence: Results, asked: None) -> tuple[Check, ...]:
        """Of every shaft that bends."""
        return bending_checks(evidence.need(Lateral), evidence.study.operation)


def bending_checks(found: "Lateral", operation: Operation) -> tuple[Check, ...]:
    """One for the whirl and one for the tilting of every shaft whose speeds are known."""
    return tuple(check for shaft in found.shafts for check in _checks(shaft, operation))


def _checks(shaft: "ShaftFound", operation: Operation) -> Iterator[Check]:
    if shaft.whirl is not None and np.isfinite(shaft.whirl.log_decrement).any():
        yield _whirl(shaft.name, shaft.whirl.speed / float(shaft.ratio), shaft.whirl.log_decrement, operation)
    if shaft.tilting is not None:
        yield _tilting(shaft.name, shaft.tilting, operation)


def _operated(speed: FloatArray, operation: Operation) -> tuple[float, float, bool]:
    """The speeds of the operation, else all that were looked at, and whether all of them were."""
    first, last = float(speed[0]), float(speed[-1])
    if operation.speeds is None:
        return first, last, True
    lowest, highest = operation.speeds.first, operation.speeds.last
    reached = first <= lowest * (1 + ROUNDING) or lowest == 0
    return lowest, highest, reached and last >= highest * (1 - ROUNDING)


def _whirl(name: str, speed: FloatArray, decrement: FloatArray, operation: Operation) -> Check:
    """The least logarithmic decrement within the operation against 0; decrement: (speeds, modes)."""
    first, last, whole = _operated(speed, operation)
    inside = (speed >= first * (1 - ROUNDING)) & (speed <= last * (1 + ROUNDING))
    known = np.where(inside[:, None] & np.isfinite(decrement), decrement, np.inf)
    row = int(known.min(axis=1).argmin())
    least = float(known[row].min())
    notes = ["nothing damps it"] if abs(least) <= ROUNDING else []
    return Check(
        "stability", "whirl", name, "logarithmic decrement of its whirl", 0.0 if notes else least, 0.0, "",
        "pass" if whole and least >= -ROUNDING else "fail", "by definition", float(speed[row]),
        note="; ".join(notes + ([] if whole else [PART])), at_least=True,
    )  # fmt: skip


def _tilting(name: str, found: "Tilting", operation: Operation) -> Check:
    """The fastest growth of the tilt within the operation against 0."""
    speed = found.speed / found.ratio
    first, last, whole = _operated(speed, operation)
    grows = np.where((speed >= first * (1 - ROUNDING)) & (speed <= last * (1 + ROUNDING)), found.growth, -np.inf)
    at = int(np.argmax(grows))
    within = [zone for zone in found.zones if zone.lower / found.ratio < last and zone.upper / found.ratio > first]
    growth = min(float(grows[at]), 0.0)
    if within:
        growth = float(grows[at]) if grows[at] > 0 else max(zone.rate for zone in within)
    notes = [] if found.is_damped else ["its supports do not damp it in both directions"]
    return Check(
        "stability", "tilting", name, f"growth rate of its tilt by the couple of {found.joint}",
        growth, 0.0, "1/s",
        "pass" if whole and not within else "fail", "by definition", float(speed[at]),
        note="; ".join(notes + ([] if whole else [PART])),
    )  # fmt: skip
