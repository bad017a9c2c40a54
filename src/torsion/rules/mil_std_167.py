"""Rule `mil-std-167`: torsional vibration, type III of MIL-STD-167, of shafts and gears; from memory, to be verified.

Vibratory stress of a steel shaft at most its tensile strength / 25 in the operating range, 1.75 times that below it;
vibratory torque of gears at most 75 % of the mean torque there and 25 % of the rated torque.
"""

from collections.abc import Iterable, Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.errors import Fault
from torsion.fields import given
from torsion.findings import Results
from torsion.model.parts import ROLES
from torsion.rules import rule_over_speed
from torsion.rules.class_rules.m68_shafts import LEAST_STRENGTH
from torsion.rules.class_rules.shaft_limits import PA, nominal_stress, unknown_strengths, with_role
from torsion.rules.demands import START, in_rpm, unknown_gears
from torsion.rules.rule_over_speed import Clause, Continuous, RuleOverSpeed, UseSettings, within
from torsion.rules.strength.gear_hammer import VIBRATORY, meshes
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check
from torsion.study import Study

SHARE_OF_STRENGTH = 1.0 / 25.0
BELOW = 1.75  # times the limit, below the operating range
MESH_OF_MEAN, MESH_OF_RATED = 0.75, 0.25


class MilSettings(UseSettings):
    """Settings of `mil-std-167`."""

    continuous: Continuous | None = given("operating range: {from, to} (default: all speeds)")


class MilStd167(RuleOverSpeed[MilSettings]):
    """The rule, as the study reads it."""

    name = "mil-std-167"
    edition = "MIL-STD-167 type III"
    settings_class = MilSettings
    begin = START
    has_limits_outside_use = True

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        yield from self.vibration_faults(study)
        if not any(with_role(study.train, *ROLES)) and not any(study.train.of_kind("gear")):
            hint = f"role: {', '.join(ROLES[:-1])} or {ROLES[-1]}"
            message = f"no round shaft has a `role` and there is no gear, so {self.name} has nothing to judge"
            yield Fault(self.path(study), message, hint)
        yield from unknown_strengths(study, self, *ROLES)

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Yield what was not judged, and why."""
        judged = {number for number, _, _ in with_role(study.train, *ROLES)}
        why = "the shaft has no `role`, or its section is a mesh"
        for number, part in enumerate(study.train.parts):
            if part.shaft is not None and number not in judged:
                yield f"{self.name} for {part.name}", why
        yield f"{self.name}: propulsion shafts of other metals", "the limit is for steel"

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Return a row for each gear of unknown torque."""
        return unknown_gears(self.name, study, TO_BE_VERIFIED)

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield the stress of every shaft with a role in the operating range and below it, and every gear mesh in it."""
        response, torque = evidence.need(Response), evidence.need(Synthesis).half_range
        train, use, in_use = evidence.study.train, self.use, ""
        below = np.zeros(len(response.speed), dtype=bool)
        if use is not None:  # what is above the range is judged as what is in it
            below = ~within(use, response.speed) & (response.speed < use.first)
            in_use = f"operating range from {in_rpm(use.first)}"
        ranges = (
            ("S_v", "operating range", 1.0, ~below, in_use),
            ("S_v below", "below the operating range", BELOW, below, ""),
        )
        for number, part, shaft in with_role(train, *ROLES):
            spans, stress = nominal_stress(evidence.system, number, torque)
            stated = train.materials[shaft.material].tensile_strength
            strength = LEAST_STRENGTH if stated is None else stated * PA
            assumed = " (none stated: the least of shaft steel assumed)" if stated is None else ""
            for clause, speeds, times, judged, words in ranges:
                yield self.compare(
                    response,
                    (clause, part.name, f"Torsional stress amplitude, {speeds}"),
                    TO_BE_VERIFIED,
                    stress,
                    times * (strength * SHARE_OF_STRENGTH),
                    "N/mm2",
                    spans=spans,
                    notes=(words, f"sigma_B {strength:.4g} N/mm2{assumed}"),
                    is_judged=judged,
                )
        if rule_over_speed.rated_torque(evidence) is None:
            return
        for mesh in meshes(evidence):
            text = f"the smaller of {MESH_OF_MEAN:g} of the mean torque and {MESH_OF_RATED:g} x {mesh.rated:.5g} N m"
            yield self.compare(
                response,
                ("gears", mesh.name, VIBRATORY),
                TO_BE_VERIFIED,
                mesh.vibratory,
                np.minimum(MESH_OF_MEAN * mesh.mean, MESH_OF_RATED * mesh.rated),
                spans=mesh.spans,
                notes=(in_use, text),
                is_judged=~below,
            )
