"""Rule `fillets`: the vibratory shear stress in fillets and notches of shafts against the endurance that is stated."""

from collections.abc import Iterable, Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.fillet_stresses import endurance, stated_fillets
from torsion.errors import Fault
from torsion.findings import Results
from torsion.rules.class_rules.shaft_limits import PA
from torsion.rules.demands import unjudged
from torsion.rules.rule_over_speed import Clause, RuleOverSpeed, UseSettings
from torsion.rules.verdict_line import Check
from torsion.study import Study

UNKNOWN = "no fillet is stated there, and no K_t is known"


class FilletEnduranceSettings(UseSettings):
    """Settings of `fillets`."""


class FilletEndurance(RuleOverSpeed[FilletEnduranceSettings]):
    """The rule, as the study reads it."""

    name = "fillets"
    settings_class = FilletEnduranceSettings

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        from torsion.assembly.junction.stepped_shafts import corners

        train = study.train
        shafts = (part.shaft for part in train.parts if part.shaft is not None)
        has_notch = any(shaft.notches and shaft.endurance is not None for shaft in shafts)
        if not has_notch and not any(
            step is not None and step.round > 0.0 and endurance(train, first, second) is not None
            for step, first, second, _, _ in corners(train)
        ):
            hint = "for example `step: {fillet: 4 mm}` and `endurance: 120 MPa` of a shaft"
            message = f"{self.name} finds no fillet or notch with an `endurance`"
            return [Fault(self.path(study), message, hint)]
        return self.vibration_faults(study)

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Yield also a row NOT JUDGED of each endurance that is stated where no K_t is known."""
        from torsion.assembly.junction.stepped_shafts import unrounded

        yield from super().judge(evidence)
        train = evidence.need(Response).system.train
        for first, second, words in unrounded(train):
            if endurance(train, first, second) is not None:
                of_corner = first.name, f"{words} to {second.name}"
                yield unjudged(self.name, "endurance", *of_corner, UNKNOWN, "setting", "N/mm2")

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield K_t times the half range of the nominal stress, of every fillet with an endurance."""
        response, torque = evidence.need(Response), evidence.need(Synthesis).half_range
        for fillet in stated_fillets(response.system):
            if fillet.endurance is None:
                continue
            factor = fillet.factor * (1.0 + (fillet.error or 0.0))
            source = "by finite elements, with its error"
            if fillet.error is None:
                source = "by formula (IACS UR M53)"
            yield self.compare(
                response,
                ("endurance", fillet.shaft, f"Shear stress amplitude in the {fillet.label}"),
                "setting",
                factor * torque[:, list(fillet.spans)].max(axis=1) / fillet.modulus * PA,
                PA * fillet.endurance,
                "N/mm2",
                spans=np.array(fillet.spans),
                notes=(f"K_t {fillet.factor:.4g} {source}",),
            )
