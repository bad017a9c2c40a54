"""Rule `fillets`: the vibratory shear stress in the fillets of shafts against the endurance that the file states."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.fillet_stresses import stated_fillets
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.errors import Fault
from torsion.fields import Declared, given
from torsion.findings import Results
from torsion.rules import judgement
from torsion.rules.judgement import MOSTLY, Clause, Continuous, RuleOverSpeed, curve_of
from torsion.study import Study


class FilletEnduranceSettings(Declared):
    """Settings of `fillets`."""

    continuous: Continuous | None = given("speeds of continuous use: {from, to} (default: all)")


class FilletEndurance(RuleOverSpeed):
    """The rule, as the study reads it."""

    name = "fillets"
    settings = FilletEnduranceSettings

    def faults(self, study: Study, settings: FilletEnduranceSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        records = [part.shaft for part in study.train.parts if part.shaft is not None]
        if not study.train.has_fillets or all(one.endurance is None for one in records):
            hint = "for example `step: {fillet: 4 mm}` and `endurance: 120 MPa` of a shaft"
            return [Fault(self.path(study, settings), f"{self.name} finds no fillet with an `endurance`", hint)]
        return self.continuous_faults(study, settings) + judgement.vibration_faults(self, study, settings)

    def clauses(self, evidence: Results, settings: FilletEnduranceSettings) -> Iterator[Clause]:
        """K_t times the half range of the nominal stress at every speed, of every fillet with an endurance."""
        response, torque = evidence.need(Response), evidence.need(Synthesis).half_range
        use = judgement.within(settings.continuous, response.speed)
        for one in stated_fillets(response.system):
            if one.endurance is None:
                continue
            spans = np.array(one.spans)
            stress = one.factor * (1.0 + one.error) * torque[:, one.spans[0]] / one.modulus * 1e-6
            notes = (
                f"K_t {one.factor:.4g} by finite elements, with its error",
                judgement.in_use(settings.continuous),
                MOSTLY,
            )
            yield Clause(
                "endurance", one.shaft, f"vibratory shear stress in the fillet to {one.following}", "setting",
                curve_of(response, stress, 1e-6 * one.endurance), use, "N/mm2", notes, spans,
            )  # fmt: skip
