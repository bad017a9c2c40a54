"""Rule `mil-std-167`: torsional vibration, type III of MIL-STD-167, of shafts and gears; from memory, to be verified.

Vibratory stress of a steel shaft at most its tensile strength / 25 in the operating range, 1.75 times that below it;
vibratory torque of gears at most 75 % of the mean torque there and 25 % of the rated torque.
"""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import FloatArray
from torsion.errors import Fault
from torsion.fields import given
from torsion.findings import Results
from torsion.model.lowering import ROLES
from torsion.model.material import STEEL
from torsion.rules import judgement
from torsion.rules.demanded_states import unknown_gears
from torsion.rules.gear_hammer import VIBRATORY, meshes
from torsion.rules.judgement import MOSTLY, Clause, Continuous, RuleOverSpeed, UseSettings, curve_of
from torsion.rules.m68_shafts import LEAST_STRENGTH
from torsion.rules.reached_speeds import START, in_rpm
from torsion.rules.shaft_limits import PA, nominal_stress, with_role
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

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for this rule."""
        shafts = list(with_role(study.train, *ROLES))
        found = self.vibration_faults(study)
        if not shafts and not any(study.train.of_kind("gear")):
            hint = f"role: {', '.join(ROLES[:-1])} or {ROLES[-1]}"
            message = f"no round shaft has a `role` and there is no gear, so {self.name} has nothing to judge"
            found.append(Fault(self.path(study), message, hint))
        for _, part, shaft in shafts:
            made_of = study.train.materials[shaft.material]
            if made_of.tensile_strength is None and made_of != STEEL:
                message = f"`tensile_strength` of '{shaft.material}' is not given"
                hint = f"materials: {{{shaft.material}: {{..., tensile_strength: 600 MPa}}}}"
                found.append(
                    Fault((*part.path, "material"), f"{message}, and {self.name} needs it", hint)
                )
        return found

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        judged = {number for number, _, _ in with_role(study.train, *ROLES)}
        found = [
            (f"{self.name} for {part.name}", "the shaft has no `role`, or its section is a mesh")
            for number, part in enumerate(study.train.parts)
            if part.shaft is not None and number not in judged
        ]
        return (
            *found,
            (f"{self.name}: propulsion shafts of other metals", "the limit is for steel"),
        )

    def demanded_rows(self, study: Study) -> tuple[Check, ...]:
        """Gears of unknown torque."""
        return tuple(unknown_gears(self.name, study, TO_BE_VERIFIED))

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Of every shaft with a role in the operating range and below it, and of every gear mesh in it."""
        response, train = evidence.need(Response), evidence.study.train
        below, in_use = np.zeros(len(response.speed), dtype=bool), ""
        if self.use is not None:  # what is above the range is judged as what is in it
            below = ~judgement.within(self.use, response.speed) & (response.speed < self.use.first)
            in_use = f"operating range from {in_rpm(self.use.first)}"
        for number, part, shaft in with_role(train, *ROLES):
            spans, stress = nominal_stress(
                evidence.system, number, evidence.need(Synthesis).half_range
            )
            given_strength = train.materials[shaft.material].tensile_strength
            strength = LEAST_STRENGTH if given_strength is None else given_strength * PA
            assumed = (
                " (none stated: the least of shaft steel assumed)" if given_strength is None else ""
            )
            notes = f"sigma_B {strength:.4g} N/mm2{assumed}", MOSTLY
            limit = strength * SHARE_OF_STRENGTH
            ranges = (
                ("S_v", "operating range", 1.0, ~below, in_use),
                ("S_v below", "below the operating range", BELOW, below, ""),
            )
            for clause, speeds, times, judged, where in ranges:
                curve = curve_of(response, stress, times * limit)
                what = f"Torsional stress amplitude, {speeds}"
                yield Clause(
                    clause,
                    part.name,
                    what,
                    TO_BE_VERIFIED,
                    curve,
                    judged,
                    "N/mm2",
                    (where, *notes),
                    spans,
                )
        if not any(train.of_kind("gear")) or judgement.rated_torque(evidence) is None:
            return
        for mesh in meshes(evidence):
            most: FloatArray = np.minimum(MESH_OF_MEAN * mesh.mean, MESH_OF_RATED * mesh.rated)
            text = f"the smaller of {MESH_OF_MEAN:g} of the mean torque and {MESH_OF_RATED:g} x {mesh.rated:.5g} N m"
            curve, notes = curve_of(response, mesh.vibratory, most), (text, MOSTLY)
            yield Clause(
                "gears",
                mesh.name,
                VIBRATORY,
                TO_BE_VERIFIED,
                curve,
                ~below,
                "N m",
                (in_use, *notes),
                mesh.spans,
            )
