"""The verdict on motion over time: no coupling may carry more than the greatest torque that its maker allows.

Where damage is counted, a life that is used up fails too.
"""

import numpy as np

from torsion.analyses.transient.transient_motion import TransientMotion, Transients
from torsion.findings import Results
from torsion.rules.judgement import spans_of
from torsion.rules.verdict_line import Check, Rule, verdict_of

WHOLE_LIFE = 1.0  # Miner's sum at which it is used up


class GreatestTorque(Rule):
    """The rule on every motion over time that was computed; a coupling without the rating is not judged."""

    def check(self, evidence: Results, settings: None) -> tuple[Check, ...]:
        """Of every coupling with a `max_torque`, and of every part whose damage is counted.

        Modes that the samples do not resolve are added to a peak, and how far it scatters. A motion whose status is not
        ok never passes.
        """
        found = evidence.need(Transients).each
        parts = range(len(evidence.study.train.parts))
        marks = [f", {one.name}" if len(found) > 1 else "" for one in found]
        pairs = zip(found, marks, strict=True)
        return tuple(line for one, mark in pairs for part in parts for line in _lines(evidence, one, part, mark))


def _lines(evidence: Results, found: TransientMotion, number: int, mark: str) -> list[Check]:
    """Of one motion and one part; mark: of the motion, where there are several."""
    part, spans = evidence.study.train.parts[number], spans_of(evidence.system, number)
    is_sound, lines = found.status == "ok", list[Check]()
    note = "" if is_sound else f"{found.status}; such a motion is never a pass"
    if found.switching is not None and found.switching.scatter is not None and is_sound:
        note = "the larger of two motions that impacts set apart, and their difference added"
    limit = None if part.ratings is None else part.ratings.max_torque
    if limit is not None:
        what = f"greatest torque of the motion over time {found.name}".rstrip()
        peak = float(found.peak[spans].max())
        verdict = verdict_of(is_sound and peak <= limit, "maker")
        clause = f"T_Kmax{mark}"
        lines.append(Check("transient", clause, part.name, what, peak, limit, "N m", verdict, "maker", note=note))
    if found.damage is not None and spans.size and not np.isnan(found.damage[spans]).all():
        what = f"damage (Miner) by the motion over time {found.name}".rstrip()
        damage = float(found.damage[spans].max())
        verdict = verdict_of(is_sound and damage < WHOLE_LIFE, "setting")
        lines.append(
            Check("transient", f"D{mark}", part.name, what, damage, WHOLE_LIFE, "1", verdict, "setting", note=note)
        )
    return lines
