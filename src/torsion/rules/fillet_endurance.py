"""Rule `fillets`: the vibratory shear stress in fillets and notches of shafts against the endurance that is stated."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.fillet_stresses import has_judged, stated_fillets, unjudged
from torsion.errors import Fault
from torsion.fields import given
from torsion.findings import Results
from torsion.rules import judgement
from torsion.rules.judgement import MOSTLY, Clause, Continuous, RuleOverSpeed, curve_of
from torsion.rules.verdict_line import Check, RuleSettings
from torsion.study import Study

UNKNOWN = "no fillet is stated there, and no K_t is known"


class FilletEnduranceSettings(RuleSettings):
    """Settings of `fillets`."""

    continuous: Continuous | None = given("speeds of continuous use: {from, to} (default: all)")


class FilletEndurance(RuleOverSpeed):
    """The rule, as the study reads it."""

    name = "fillets"
    settings = FilletEnduranceSettings

    def faults(self, study: Study, settings: FilletEnduranceSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        if not has_judged(study.train):
            hint = "for example `step: {fillet: 4 mm}` and `endurance: 120 MPa` of a shaft"
            return [
                Fault(
                    self.path(study, settings),
                    f"{self.name} finds no fillet or notch with an `endurance`",
                    hint,
                )
            ]
        return self.continuous_faults(study, settings) + judgement.vibration_faults(
            self, study, settings
        )

    def check(self, evidence: Results, settings: FilletEnduranceSettings) -> tuple[Check, ...]:
        """Also what an endurance is stated at and no K_t is known of, as a row NOT JUDGED."""
        nan = math.nan
        return *super().check(evidence, settings), *(
            Check(
                self.name,
                "endurance",
                one.name,
                what,
                nan,
                nan,
                "N/mm2",
                "not judged",
                "setting",
                note=UNKNOWN,
            )
            for one, what in unjudged(evidence.need(Response).system.train)
        )

    def clauses(self, evidence: Results, settings: FilletEnduranceSettings) -> Iterator[Clause]:
        """K_t times the half range of the nominal stress at every speed, of every fillet with an endurance."""
        response, torque = evidence.need(Response), evidence.need(Synthesis).half_range
        use = judgement.within(settings.continuous, response.speed)
        for one in stated_fillets(response.system):
            if one.endurance is None:
                continue
            spans = np.array(one.spans)
            stress = (
                one.factor * (1.0 + (one.error or 0.0)) * one.torque(torque) / one.modulus * 1e-6
            )
            source = (
                "by formula (IACS UR M53)"
                if one.error is None
                else "by finite elements, with its error"
            )
            notes = (
                f"K_t {one.factor:.4g} {source}",
                judgement.in_use(settings.continuous),
                MOSTLY,
            )
            yield Clause(
                "endurance",
                one.shaft,
                f"Shear stress amplitude in the {one.words}",
                "setting",
                curve_of(response, stress, 1e-6 * one.endurance),
                use,
                "N/mm2",
                notes,
                spans,
            )
