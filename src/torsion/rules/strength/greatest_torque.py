"""The verdict on motion over time: nothing may carry more than the greatest torque that its maker allows.

Where damage is counted, a life that is used up fails too.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from torsion.analyses.motion.events.transient_settings import ROUNDING, cases
from torsion.analyses.motion.train.state_before import LEFT_OUT, point
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.undamped_modes import Modes, modes
from torsion.arrays import FloatArray
from torsion.findings import Results
from torsion.model.parts import Part
from torsion.rules.rule_over_speed import spans_of
from torsion.rules.verdict_line import Check, Rule, RuleSettings, Standing, restricted, verdict_of

WHOLE_LIFE = 1.0  # Miner's sum at which it is used up


class GreatestTorque(Rule[RuleSettings]):
    """The rule on every motion over time that was computed; what has no rating is not judged."""

    has_clutches_stuck = False

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Of every coupling and gear with a `max_torque`, and of every part whose damage is counted.

        Modes that the samples do not resolve are added to a peak, and how far it scatters. A motion whose status is not
        ok never passes. What the rule `ice` judges at the worst of the motions in ice is left to it.
        """
        motions, in_ice = evidence.need(Transients).each, set[str | None]()
        if any(name == "ice" for name, _ in evidence.study.rules):
            from torsion.rules.class_rules.ice_peaks import ice_motions

            in_ice = {motion.settings.name for motion in ice_motions(evidence.study)}
        for motion in motions:
            mark = f", {motion.name}" if len(motions) > 1 else ""
            for number, part in enumerate(evidence.study.train.parts):
                rated = part.greatest_torque(is_rare=False)
                for check in _checks(evidence, motion, number, part, mark):
                    # The rule `ice` compares the same torque with the same rating.
                    is_of_ice = rated and check.clause.partition(", ")[0] == rated[0]
                    if not (motion.name in in_ice and is_of_ice):
                        yield check


def conditions_of(evidence: Results, motion: TransientMotion) -> tuple[str, ...]:
    """Return what keeps a verdict on a motion from a plain pass: torques that do not act, an early end; or empty words."""
    without = [words for words in motion.not_acting if words.endswith(LEFT_OUT)]
    left_out = f"does not act: {'; '.join(without)}" if without else ""
    # The largest torque of a step comes half a period of the lowest mode after it, a beat of several modes later; the
    # end of a torque is a step as its begin is.
    early = unreached = ""
    changes = {
        event.time + late: f"{event.body.key} at {event.at}"
        for settings, _ in cases(evidence.study)
        if settings.name == motion.name
        for event in settings.events
        for late in event.body.changes(
            point(evidence.study, evidence.system, motion.speed_before, event.at)
        )
    }
    # A clutch that ceases to slip is a step too.
    for change in () if motion.switching is None else motion.switching.events:
        if change.what == "stuck" and evidence.study.train[change.coupling].is_clutch:
            changes[change.time] = f"{change.coupling} stuck"
    end = float(motion.time[-1])
    later = {time: name for time, name in changes.items() if time > end * (1.0 + ROUNDING)}
    if later:
        last = max(later)
        unreached = f"ends at {end:g} s, {later[last]} at {last:.6g} s"
    known = evidence.get(Modes) or modes(evidence.system, 1)
    if changes and len(known.frequency):
        period = 1.0 / float(known.frequency[0])
        left = end - max((time for time in changes if time not in later), default=-math.inf)
        if left < period:
            early = f"ends {max(left, 0.0):.3g} s after the last change of an event"
            early += f", within a period of mode 1 ({period:.3g} s)"
    return left_out, unreached, early


def _checks(
    evidence: Results, motion: TransientMotion, number: int, part: Part, mark: str
) -> Iterator[Check]:
    """Checks of one motion and one part; mark: of the motion, where there are several."""
    spans, is_sound = spans_of(evidence.system, number), motion.status == "ok"
    note = "" if is_sound else f"{motion.status}; such a motion is never a pass"
    if motion.switching is not None and motion.switching.scatter is not None and is_sound:
        note = "the larger of two motions that impacts set apart, and their difference added"
    conditions = conditions_of(evidence, motion)

    def judge(
        clause: str, what: str, values: FloatArray, limit: float, unit: str, standing: Standing
    ) -> Check:
        value = float(values[spans].max())
        is_met = value < limit if standing == "setting" else value <= limit
        compared = f"{what}: {motion.name}" if motion.name else what
        about, verdict = ("transient", clause + mark), verdict_of(is_sound and is_met, standing)
        check = Check(*about, part.name, compared, value, limit, unit, verdict, standing, note=note)
        return restricted(check, *conditions)

    if (rated := part.greatest_torque(is_rare=motion.is_rare)) is not None:
        clause, limit = rated
        yield judge(clause, "Greatest torque over time", motion.peak, limit, "N m", "maker")
    widest = None if part.ratings is None or motion.is_rare else part.ratings.max_torque_range
    if widest is not None:
        yield judge("dT_max", "Range of torque over time", motion.range, widest, "N m", "maker")
    if motion.damage is not None and spans.size and not np.isnan(motion.damage[spans]).all():
        # A life that is used up fails.
        yield judge("D", "Damage of one event", motion.damage, WHOLE_LIFE, "1", "setting")
