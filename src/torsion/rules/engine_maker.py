"""Rule `engine-maker`: nominal stress of the crankshaft against the limit that the maker of the engine gives."""

from collections.abc import Iterator
from typing import Annotated

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.errors import Fault
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.rules.demanded_states import order_rows
from torsion.rules.judgement import MOSTLY, Clause, RuleOverSpeed, UseSettings, curve_of, within
from torsion.rules.shaft_limits import PA, nominal_stress, with_role
from torsion.rules.verdict_line import Check
from torsion.study import Study

Stress = Annotated[float, Quantity("Pa", above=0, usual="permissible stress")]


class EngineMakerSettings(UseSettings):
    """Settings of `engine-maker`."""

    crank_stress: Stress | None = given(
        "permissible torsional stress amplitude of the crankshaft, by its maker"
    )


class EngineMaker(RuleOverSpeed[EngineMakerSettings]):
    """The rule, as the study reads it."""

    name = "engine-maker"
    settings_class = EngineMakerSettings

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for this rule."""
        where = self.path(study)
        found = self.vibration_faults(study)
        if self.settings.crank_stress is None:
            hint = f"- {self.name}: {{crank_stress: 40 MPa}}"
            found.append(
                Fault(
                    where,
                    f"`crank_stress` of {self.name} is missing; only the maker knows it",
                    hint,
                )
            )
        if not any(with_role(study.train, "crank")):
            found.append(
                Fault(where, f"{self.name} finds no crankshaft", "role: crank, on a round shaft")
            )
        return found

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """What it does not judge, and why."""
        other = "the rule limits the torsional stress only"
        return ((f"{self.name}: damper, front end and bearings of the engine", other),)

    def demanded_rows(self, study: Study) -> tuple[Check, ...]:
        """Orders that the synthesis lacks."""
        return tuple(order_rows(self.name, study, "maker"))

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Of every crankshaft in continuous use."""
        response, limit = evidence.need(Response), self.settings.crank_stress
        use = within(self.use, response.speed)
        if limit is None:
            raise ValueError("the rule has no limit")
        for number, part, _ in with_role(evidence.study.train, "crank"):
            spans, stress = nominal_stress(
                evidence.system, number, evidence.need(Synthesis).half_range
            )
            curve, notes = curve_of(response, stress, limit * PA), (self.use_words, MOSTLY)
            what = "Nominal torsional stress amplitude of the crankshaft"
            yield Clause("tau_N", part.name, what, "maker", curve, use, "N/mm2", notes, spans)
