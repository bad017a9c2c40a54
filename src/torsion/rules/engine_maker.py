"""Rule `engine-maker`: nominal stress of the crankshaft against the limit that the maker of the engine gives."""

from collections.abc import Iterable, Iterator
from typing import Annotated

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.errors import Fault
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.rules.class_rules.shaft_limits import PA, no_crank, nominal_stress, with_role
from torsion.rules.demands import order_rows
from torsion.rules.rule_over_speed import Clause, RuleOverSpeed, UseSettings
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

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        yield from self.vibration_faults(study)
        if self.settings.crank_stress is None:
            message = f"`crank_stress` of {self.name} is missing; only the maker knows it"
            hint = f"- {self.name}: {{crank_stress: 40 MPa}}"
            yield Fault(self.path(study), message, hint)
        yield from no_crank(study, self)

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Return what the rule does not judge, and why."""
        reason = "the rule limits the torsional stress only"
        return ((f"{self.name}: damper, front end and bearings of the engine", reason),)

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Return the orders that the synthesis lacks."""
        return order_rows(self.name, study, "maker")

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield the stress of every crankshaft in continuous use."""
        response, torque = evidence.need(Response), evidence.need(Synthesis).half_range
        limit = (self.settings.crank_stress or 0.0) * PA
        for number, part, _ in with_role(evidence.study.train, "crank"):
            spans, stress = nominal_stress(evidence.system, number, torque)
            name = "tau_N", part.name, "Nominal torsional stress amplitude of the crankshaft"
            yield self.compare(response, name, "maker", stress, limit, "N/mm2", spans=spans)
