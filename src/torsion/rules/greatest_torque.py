"""The verdict on motion over time: nothing may carry more than the greatest torque that its maker allows.

Where damage is counted, a life that is used up fails too.
"""

import numpy as np

from torsion.analyses.motion.acting_torques import LEFT_OUT
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.motion.transient_settings import cases
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Results
from torsion.rules.reached_speeds import restricted
from torsion.rules.rule_over_speed import spans_of
from torsion.rules.verdict_line import Check, Rule, RuleSettings, verdict_of

WHOLE_LIFE = 1.0  # Miner's sum at which it is used up


class GreatestTorque(Rule[RuleSettings]):
    """The rule on every motion over time that was computed; what has no rating is not judged."""

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Of every coupling and gear with a `max_torque`, and of every part whose damage is counted.

        Modes that the samples do not resolve are added to a peak, and how far it scatters. A motion whose status is not
        ok never passes. What the rule `ice` judges at the worst of the motions in ice is left to it.
        """
        found = evidence.need(Transients).each
        in_ice = _motions_in_ice(evidence)
        parts = range(len(evidence.study.train.parts))
        marks = [f", {one.name}" if len(found) > 1 else "" for one in found]
        pairs = zip(found, marks, strict=True)
        lines = [
            (one, part, line)
            for one, mark in pairs
            for part in parts
            for line in _lines(evidence, one, part, mark)
        ]
        return tuple(
            line
            for one, part, line in lines
            if not (one.name in in_ice and _is_of_ice(evidence, part, line))
        )


def _motions_in_ice(evidence: Results) -> frozenset[str]:
    """Names of the motions that the rule `ice` judges; none where the study does not name it."""
    if not any(name == "ice" for name, _ in evidence.study.rules):
        return frozenset()
    from torsion.rules.ice_peaks import ice_motions

    return frozenset(one.settings.name for one in ice_motions(evidence.study))


def _is_of_ice(evidence: Results, number: int, line: Check) -> bool:
    """The rule `ice` compares the same torque with the same rating."""
    rated = evidence.study.train.parts[number].greatest_torque(is_rare=False)
    return rated is not None and line.clause.partition(", ")[0] == rated[0]


def _lines(evidence: Results, found: TransientMotion, number: int, mark: str) -> list[Check]:
    """Of one motion and one part; mark: of the motion, where there are several."""
    part, spans = evidence.study.train.parts[number], spans_of(evidence.system, number)
    is_sound, lines = found.status == "ok", list[Check]()
    note = "" if is_sound else f"{found.status}; such a motion is never a pass"
    if found.switching is not None and found.switching.scatter is not None and is_sound:
        note = "the larger of two motions that impacts set apart, and their difference added"
    judged = list[tuple[str, str, float, float]]()
    if (rated := part.greatest_torque(is_rare=found.is_rare)) is not None:
        judged.append(
            (rated[0], "Greatest torque over time", float(found.peak[spans].max()), rated[1])
        )
    widest = None if part.ratings is None or found.is_rare else part.ratings.max_torque_range
    if widest is not None:
        judged.append(
            ("dT_max", "Range of torque over time", float(found.range[spans].max()), widest)
        )
    for clause, of, torque, limit in judged:
        what, verdict = _named(of, found), verdict_of(is_sound and torque <= limit, "maker")
        lines.append(
            Check(
                "transient",
                clause + mark,
                part.name,
                what,
                torque,
                limit,
                "N m",
                verdict,
                "maker",
                note=note,
            )
        )
    if found.damage is not None and spans.size and not np.isnan(found.damage[spans]).all():
        what = _named("Damage of one event", found)
        damage = float(found.damage[spans].max())
        verdict = verdict_of(is_sound and damage < WHOLE_LIFE, "setting")
        lines.append(
            Check(
                "transient",
                f"D{mark}",
                part.name,
                what,
                damage,
                WHOLE_LIFE,
                "1",
                verdict,
                "setting",
                note=note,
            )
        )
    without = [words for words in found.not_acting if words.endswith(LEFT_OUT)]
    conditions = [f"does not act: {'; '.join(without)}"] if without else []
    if early := _early_end(evidence, found):
        conditions.append(early)
    for words in conditions:
        lines = [restricted(line, words) for line in lines]
    return lines


def _early_end(evidence: Results, motion: TransientMotion) -> str:
    """That a motion ends within a period of the lowest mode after its last event; empty if it does not.

    The largest torque of a step comes half a period after it, and a beat of several modes later.
    """
    modes = evidence.get(Modes)
    if modes is None or not len(modes.frequency):
        return ""
    period = 1.0 / float(modes.frequency[0])
    for settings, _ in cases(evidence.study):
        times = [event.time for event in settings.events]
        if settings.name == motion.name and times and settings.duration - max(times) < period:
            left = settings.duration - max(times)
            return f"ends {left:.3g} s after the last event, within a period of mode 1 ({period:.3g} s)"
    return ""


def _named(what: str, motion: TransientMotion) -> str:
    """What a check compares, with the name of the motion if it has one."""
    return f"{what}: {motion.name}" if motion.name else what
