"""Rule `shrink-fits`: the greatest torque of a shaft in a shrunk hub against the torque at which the fit slips."""

import math
from collections.abc import Iterable, Iterator
from typing import Annotated

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.errors import Fault
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.model.shafts.shaft_details import Hub
from torsion.primitives import Bar
from torsion.rules.demands import unjudged
from torsion.rules.rule_over_speed import Clause, RuleOverSpeed, spans_of
from torsion.rules.verdict_line import (
    TO_BE_VERIFIED,
    Check,
    RuleSettings,
    Standing,
    restricted,
    verdict_of,
)
from torsion.study import Study
from torsion.train import Train

IN_FIT = "Maximum torque in the fit, {} end"
UNLOADED = "no axial load, no start or shock in the fit"
BEYOND_MOTIONS = (
    "no axial load, no start or shock in the fit but the transient responses of the file"
)
USUAL_SAFETY = 2.0  # against slip, of shrunk couplings in class rules (from memory, to be verified)


class ShrinkFitSettings(RuleSettings):
    """Settings of `shrink-fits`."""

    safety: Annotated[float, Quantity("1", at_least=1, usual="safety")] | None = given(
        "required slip torque / maximum torque (default: 2, to be verified)"
    )


class ShrinkFits(RuleOverSpeed[ShrinkFitSettings]):
    """The rule, as the study reads it."""

    name = "shrink-fits"
    edition = "usual safety of class rules for shrink fits"
    settings_class = ShrinkFitSettings

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        if any(fits(study.train)):
            yield from self.vibration_faults(study)
            yield from self.mean_torque_faults(study, "it")
            return
        hint = "give `pressure` and `friction` of a hub with `fit: shrink`, or leave the rule out"
        yield Fault(self.path(study), f"{self.name} finds no hub with a `pressure`", hint)

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Return the checks with what a pass stands on."""
        transients = evidence.results.get("transient")
        motions = () if transients is None else transients.each
        condition = BEYOND_MOTIONS if motions else UNLOADED
        for check in super().judge(evidence):
            yield restricted(check, condition) if check.clause == "slip" else check

        safety = self.settings.safety or USUAL_SAFETY
        standing: Standing = TO_BE_VERIFIED if self.settings.safety is None else "setting"
        for motion in motions:
            from torsion.rules.strength.greatest_torque import conditions_of

            conditions = BEYOND_MOTIONS, *conditions_of(evidence, motion)
            mark = f", {motion.name}" if len(motions) > 1 else ""
            for bar, hub, capacity in fits(evidence.study.train):
                torque = float(motion.peak[spans_of(evidence.system, bar.part)].max())
                verdict, words = verdict_of(torque <= capacity, standing), f"safety {safety:g}"
                if verdict == "pass" and (motion.status != "ok" or torque > capacity / safety):
                    verdict = "not judged"
                    words = f"slip torque / torque {capacity / torque:.3g}, below the safety {safety:g} of steady operation"
                    words = words if motion.status == "ok" else f"{motion.status}; never a pass"
                what = f"Maximum torque over time in the fit, {hub.end} end"
                about = self.name, f"slip over time{mark}", bar.name, what
                check = Check(*about, torque, capacity, "N m", verdict, standing, note=words)
                yield restricted(check, *conditions)

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Yield a row for each shrunk hub without `pressure` or `friction`."""
        note = "its `pressure` and `friction` are not given"
        for bar in study.train.bars:
            for hub in study.train.shaft(bar).hubs:
                if hub.fit == "shrink" and (hub.pressure is None or hub.friction is None):
                    about = "slip", bar.name, IN_FIT.format(hub.end), note
                    yield unjudged(self.name, *about, TO_BE_VERIFIED)

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield mean torque and vibration, true to phase, of the shaft at every speed, over all of its length."""
        response, peak = evidence.need(Response), evidence.need(Synthesis).peak
        safety = self.settings.safety or USUAL_SAFETY
        for bar, hub, capacity in fits(evidence.study.train):
            spans = spans_of(evidence.system, bar.part)
            torque, length = np.max(peak[:, spans], axis=1), 1e3 * hub.length
            reach = length * float(np.nan_to_num(torque, nan=np.inf).max()) / capacity
            yield self.compare(
                response,
                ("slip", bar.name, IN_FIT.format(hub.end)),
                TO_BE_VERIFIED if self.settings.safety is None else "setting",
                torque,
                capacity / safety,
                spans=spans,
                notes=(
                    f"slips at {capacity:.5g} N m, safety {safety:g}",
                    f"slip reaches over at most {min(reach, length):.3g} of {length:g} mm of the seat",
                ),
            )


def fits(train: Train) -> Iterator[tuple[Bar, Hub, float]]:
    """Yield every shrunk hub whose pressure is given, and the torque (N m) at which all of its fit slips."""
    for bar in train.bars:
        for hub in train.shaft(bar).hubs:
            if hub.pressure is not None and hub.friction is not None:
                yield bar, hub, slip_torque(bar.outer[0], hub.length, hub.pressure, hub.friction)


def slip_torque(diameter: float, length: float, pressure: float, friction: float) -> float:
    """Return the torque (N m) at which a fit slips: friction * pressure over its cylinder, times its radius (m, m, Pa, 1).

    A torque below it slips as far into the seat of a rigid hub as friction takes to balance it: that share of its
    length; less far where the part that still sticks takes a share.

    >>> round(slip_torque(0.1, 0.12, 60e6, 0.15), 3)
    16964.6
    """
    return 0.5 * math.pi * diameter**2 * length * friction * pressure
