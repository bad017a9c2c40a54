"""The verdicts on stability: nothing may grow at any speed of the operation, of the train or of a bending shaft.

What was not looked at of the operation is not passed.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.motion.stability_over_speed import Stability
from torsion.arrays import FloatArray
from torsion.findings import Results
from torsion.rules.verdict_line import Check, Rule
from torsion.study import Operation

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import Lateral, ShaftFound
    from torsion.analyses.lateral.tilt_stability import Tilting
    from torsion.analyses.motion.stability_over_speed import Stability

NOTHING_DAMPS = "nothing in the train damps, so that a growth of 0 is the best there is"
WHOLE = "whole train"
MOST = 4  # ranges without an answer that are stated one by one
_RPM = 30.0 / np.pi
SpeedRange = tuple[float, float]  # rad/s
ROUNDING = 1e-9  # of a logarithmic decrement, and of speeds relative to themselves
PART = "only a part of the operation's speeds was looked at"


class StableMotion(Rule):
    """The rule on whatever stability was computed."""

    def check(self, evidence: Results, settings: None) -> tuple[Check, ...]:
        """Of the whole train."""
        from torsion.analyses.motion.stability_over_speed import Stability

        return (stability_check(evidence.need(Stability), evidence.study.operation),)


def stability_check(found: "Stability", operation: Operation) -> Check:
    """The largest growth rate within the operation's speeds (else those requested) against 0.

    It fails also where a speed has no periodic motion to be stable about, or part of the operation was not looked at.
    """
    first, last, _ = _operated(found.speed, operation)
    inside = (found.speed >= first) & (found.speed <= last)
    within = [one for one in found.ranges if one.meets(first, last)]
    growth, speed = _worst(found.growth[inside], found.speed[inside])
    for one in within:
        if one.growth > growth and (first <= one.at <= last or growth <= 0):
            growth, speed = one.growth, min(max(one.at, first), last)
    bare = _bare(found, first, last)
    missed = first < found.speed[0] * (1 - ROUNDING) or last > found.speed[-1] * (1 + ROUNDING)
    if not within:
        growth = min(growth, 0.0)
        if bare or not inside.any():
            missing = found.unsolved[(found.unsolved >= first) & (found.unsolved <= last)]
            growth, speed = np.inf, float(np.append(missing, first)[0])
    fails = bool(within or bare) or missed
    return Check(
        "stability", "stability", WHOLE, "growth rate of small deviations", growth, 0.0, "1/s",
        "fail" if fails else "pass", "by definition", speed, note=_note(found, missed, (first, last)),
    )  # fmt: skip


def _worst(growth: FloatArray, speed: FloatArray) -> tuple[float, float]:
    known = np.isfinite(growth)
    if not known.any():
        return -np.inf, float(speed[0]) if speed.size else 0.0
    at = int(np.argmax(np.where(known, growth, -np.inf)))
    return float(growth[at]), float(speed[at])


def _bare(found: "Stability", first: float, last: float) -> list[SpeedRange]:
    """What of the operated speeds lies between speeds without a periodic motion and their neighbours that have one."""
    met = [(max(low, first), min(high, last)) for low, high in found.unknown if low <= last and high >= first]
    there = ((found.unsolved >= low) & (found.unsolved <= high) for low, high in met)
    return [one for one, at in zip(met, there, strict=True) if one[0] < one[1] or at.any()]


def _note(found: "Stability", missed: bool, operated: SpeedRange) -> str:
    """What the figure does not say."""
    words, bare = [], _bare(found, *operated)
    if bare and np.isnan(found.growth).all():
        words.append(f"no periodic motion was found at any of the {found.speed.size} speeds tried")
    elif bare:
        where = ", ".join(f"{low * _RPM:.5g} to {high * _RPM:.5g}" for low, high in bare[:MOST])
        more = f" and in {len(bare) - MOST} further ranges" if len(bare) > MOST else ""
        words.append(f"no periodic motion was found, and so nothing is known, from {where} rpm{more}")
    if missed:
        words.append("stability was not requested at all speeds of the operation")
    if not found.loses:
        words.append(NOTHING_DAMPS)
    words.extend(_nearest(found, operated))
    return "; ".join(words)


def _nearest(found: "Stability", operated: SpeedRange) -> list[str]:
    """The distance of the operation from the unstable ranges outside it."""
    first, last = operated
    outside = [one for one in found.ranges if not one.meets(first, last)]
    below = [one.unknown[1] or one.last for one in outside if one.last <= first]
    above = [one.unknown[0] or one.first for one in outside if one.first >= last]
    said = []
    if below:
        said.append(f"the next unstable range ends {100.0 * (1.0 - max(below) / first):.3g} % below the lowest speed")
    if above:
        said.append(f"the next unstable range begins {100.0 * (min(above) / last - 1.0):.3g} % above the highest speed")
    return said


class StableBending(Rule):
    """The rule on whatever bending was computed."""

    def check(self, evidence: Results, settings: None) -> tuple[Check, ...]:
        """Of every shaft that bends."""
        from torsion.analyses.lateral.shaft_bending import Lateral

        return bending_checks(evidence.need(Lateral), evidence.study.operation)


def bending_checks(found: "Lateral", operation: Operation) -> tuple[Check, ...]:
    """One for the whirl and one for the tilting of every shaft whose speeds are known."""
    return tuple(check for shaft in found.shafts for check in _checks(shaft, operation))


def _checks(shaft: "ShaftFound", operation: Operation) -> Iterator[Check]:
    if shaft.whirl is not None and np.isfinite(shaft.whirl.log_decrement).any():
        yield _whirl(shaft.name, shaft.whirl.speed, shaft.whirl.log_decrement, operation)
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
    speed = found.speed
    first, last, whole = _operated(speed, operation)
    grows = np.where((speed >= first * (1 - ROUNDING)) & (speed <= last * (1 + ROUNDING)), found.growth, -np.inf)
    at = int(np.argmax(grows))
    within = [zone for zone in found.zones if zone.lower < last and zone.upper > first]
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
