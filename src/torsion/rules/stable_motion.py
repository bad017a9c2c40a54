"""The verdict on stability: no small deviation may grow at any speed of the operation."""

import numpy as np

from torsion.analyses.motion.stability_over_speed import Stability
from torsion.arrays import FloatArray
from torsion.findings import Results
from torsion.rules.verdict_line import Check, Rule
from torsion.study import Operation

NOTHING_DAMPS = "nothing in the train damps, so that a growth of 0 is the best there is"
WHOLE = "whole train"
MOST = 4  # stretches without an answer that are told one by one
_RPM = 30.0 / np.pi
Stretch = tuple[float, float]  # rad/s


class StableMotion(Rule):
    """The rule on whatever stability was computed."""

    def check(self, evidence: Results, asked: None) -> tuple[Check, ...]:
        """Of the whole train."""
        return (stability_check(evidence.need(Stability), evidence.study.operation),)


def stability_check(found: "Stability", operation: Operation) -> Check:
    """The largest growth rate within the operation's speeds (else those asked for) against 0.

    It fails also where a speed has no periodic motion to be stable about, or part of the operation was not looked at.
    """
    first, last = _operated(found, operation)
    inside = (found.speed >= first) & (found.speed <= last)
    within = [one for one in found.ranges if one.meets(first, last)]
    growth, speed = _worst(found.growth[inside], found.speed[inside])
    for one in within:
        if one.growth > growth and (first <= one.at <= last or growth <= 0):
            growth, speed = one.growth, min(max(one.at, first), last)
    bare = _bare(found, first, last)
    missed = first < found.speed[0] * (1 - 1e-9) or last > found.speed[-1] * (1 + 1e-9)
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


def _operated(found: "Stability", operation: Operation) -> Stretch:
    """The speeds that must be stable, rad/s: those of the operation, else all that were looked at."""
    if operation.speeds is None:
        return float(found.speed[0]), float(found.speed[-1])
    return operation.speeds.first, operation.speeds.last


def _worst(growth: FloatArray, speed: FloatArray) -> tuple[float, float]:
    known = np.isfinite(growth)
    if not known.any():
        return -np.inf, float(speed[0]) if speed.size else 0.0
    at = int(np.argmax(np.where(known, growth, -np.inf)))
    return float(growth[at]), float(speed[at])


def _bare(found: "Stability", first: float, last: float) -> list[Stretch]:
    """What of the operated speeds lies between speeds without a periodic motion and their neighbours that have one."""
    met = [(max(low, first), min(high, last)) for low, high in found.unknown if low <= last and high >= first]
    there = ((found.unsolved >= low) & (found.unsolved <= high) for low, high in met)
    return [one for one, at in zip(met, there, strict=True) if one[0] < one[1] or at.any()]


def _note(found: "Stability", missed: bool, operated: Stretch) -> str:
    """What the figure does not say."""
    words, bare = [], _bare(found, *operated)
    if bare and np.isnan(found.growth).all():
        words.append(f"no periodic motion was found at any of the {found.speed.size} speeds tried")
    elif bare:
        where = ", ".join(f"{low * _RPM:.5g} to {high * _RPM:.5g}" for low, high in bare[:MOST])
        more = f" and in {len(bare) - MOST} further stretches" if len(bare) > MOST else ""
        words.append(f"no periodic motion was found, and so nothing is known, from {where} rpm{more}")
    if missed:
        words.append("stability was not asked for at all speeds of the operation")
    if not found.loses:
        words.append(NOTHING_DAMPS)
    words.extend(_nearest(found, operated))
    return "; ".join(words)


def _nearest(found: "Stability", operated: Stretch) -> list[str]:
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
