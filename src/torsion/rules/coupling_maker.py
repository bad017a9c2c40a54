"""Rule `coupling-maker`: the limits in a coupling's catalogue (terms of DIN 740-2: T_KN, T_KW, T_Kmax, P_KW)."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import harmonic_heat, raised
from torsion.analyses.response.synthesis import half_range as half_range_of
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray, IntArray
from torsion.errors import Fault
from torsion.fields import given
from torsion.findings import Results
from torsion.model.parts import CouplingRatings, Part
from torsion.rules.demands import engines_of, unfailing_engines, unjudged
from torsion.rules.rule_over_speed import (
    MOSTLY,
    Clause,
    Continuous,
    Curve,
    RuleOverSpeed,
    UseSettings,
    curve_of,
    spans_of,
    within,
)
from torsion.rules.verdict_line import Check
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.model.elastic_element import OverFrequency

LIMITS = ("rated_torque", "vibratory_torque", "max_torque", "heat_limit")


class CouplingSettings(UseSettings):
    """Settings of `coupling-maker`."""

    continuous: Continuous | None = given(
        "speeds of continuous use, for T_KW and P_KW: {from, to} (default: all)"
    )


class CouplingMaker(RuleOverSpeed[CouplingSettings]):
    """The rule, as the study reads it."""

    name = "coupling-maker"
    settings_class = CouplingSettings

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        limited = [entry for entry in _couplings(study) if entry[2].limit_anything]
        if not limited:
            hint = f"give {', '.join(LIMITS)} of a coupling, or leave the rule out"
            yield Fault(self.path(study), "no coupling has a limit of its maker", hint)
            return
        vibrates = any(ratings.limit_vibration for _, _, ratings in limited)
        yield from self.vibration_faults(study) if vibrates else self.continuous_faults(study)
        # A coupling whose heat is judged states its damping: that it loses none is no answer.
        springs = study.train.springs
        damps = {spring.part for spring in springs if spring.table and spring.table.damps}
        for number, part, ratings in _couplings(study):
            key = "heat_limit" if ratings.heat_limit is not None else "temperature"
            is_judged = ratings.heat_limit is not None or part.warming is not None
            is_stated = part.damping is not None or part.nonlinear is not None or number in damps
            if is_judged and not is_stated:
                message = (
                    f"{self.name} judges the heat of '{part.name}', whose damping is not given"
                )
                hint = "its `psi`, or another damping; `psi: 0` if it has none"
                yield Fault((*part.path, key), message, hint)
        for _, part, ratings in limited:
            if (ratings.rated_torque, ratings.max_torque) != (None, None):
                yield from self.mean_torque_faults(study, f"that of '{part.name}'")
                return

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Yield what was not judged, and why."""
        has_states = study.cases or study.case
        for _, part, ratings in _couplings(study):
            if not ratings.limit_anything:
                yield f"{self.name} for {part.name}", "its maker's limits are not given"
        words = "one calculation has one stiffness: compute the cold and the warm coupling as cases"
        for _, part, ratings in _couplings(study) if misfires(study) and not has_states else ():
            if ratings.heat_in_misfire and part.kind == "coupling" and not part.warming:
                yield f"{self.name}: heat of {part.name} in misfire, cold and warm", words

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Yield limits of the heat in misfire where every cylinder of an engine fires, in all cases."""
        if not (names := unfailing_engines(self.name, study)):
            return
        note = f"every cylinder of {', '.join(names)} fires: compute a misfire, as a case"
        for _, part, ratings in _couplings(study):
            if ratings.heat_in_misfire is not None:
                about = "P_KW misfire", part.name, "Heat in misfire", note
                yield unjudged(self.name, *about, "maker")

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield mean torque, vibratory torque and heat in continuous use, and maximum torque always, of every coupling."""
        steady = evidence.get(Steady)
        for number, part, ratings in _couplings(evidence.study):
            spans = spans_of(evidence.system, number)  # (1,): a coupling is one spring
            if ratings.rated_torque is not None and steady is not None:
                curve = curve_of(steady, np.abs(steady.torque[spans[0]]), ratings.rated_torque)
                always = np.ones(len(curve.speed), dtype=bool)
                yield Clause("T_KN", part.name, "Mean torque", "maker", curve, always)
            if ratings.limit_vibration:
                yield from self._vibration(evidence, part, ratings, spans)
            if part.warming is None:
                continue
            # The highest temperature of equilibrium; one that runs away, or has no answer, never passes.
            from torsion.analyses.response.coupling_temperatures import CouplingTemperatures

            temperatures, speed = evidence.get(CouplingTemperatures), evidence.need(Response).speed
            rise = np.full(speed.shape, np.nan)
            reason = "its temperatures were not solved, which is never a pass"
            for coupling in () if temperatures is None else temperatures.each:
                if coupling.coupling == part.name:
                    speed, reason = coupling.speed, ""
                    runs_away = np.isnan(coupling.highest)
                    rise = np.where(runs_away, np.inf, coupling.highest - coupling.surroundings)
            limit = np.full(speed.shape, part.warming.highest - part.warming.now)
            curve = Curve(speed, rise, limit, np.zeros(speed.shape, dtype=int))
            use, what = within(self.use, speed), "Temperature rise by its own heat"
            about, notes = ("ΔT", part.name, what), (reason, self.use_words, MOSTLY)
            yield Clause(*about, "maker", curve, use, "K", notes, infinite_fails=True)

    def _vibration(
        self, evidence: Results, part: Part, ratings: CouplingRatings, spans: IntArray
    ) -> Iterator[Clause]:
        """Yield the clauses about the vibration of one coupling; a tolerance that was not varied is noted."""
        response, synthesis = evidence.need(Response), evidence.need(Synthesis)
        varied = ""
        if ratings.tolerance:
            varied = f"at nominal stiffness, its tolerance of {100 * ratings.tolerance:.3g} % was not varied"

        def compare(
            name: str,
            what: str,
            value: FloatArray,
            limit: float | FloatArray,
            unit: str = "N m",
            words: str = "",
            **options: Any,
        ) -> Clause:
            about, remarks = (name, part.name, what), (words, varied)
            options |= {"spans": spans, "remarks": remarks}
            return self.compare(response, about, "maker", value, limit, unit, **options)

        if (limit := ratings.vibratory_torque) is not None:
            yield compare("T_KW", "Vibratory torque", synthesis.half_range[:, spans[0]], limit)
        if (law := ratings.vibratory_over_frequency) is not None:
            # Each harmonic component against a torque that depends on its frequency.
            limits, (frequency, lowest) = law.at(response.frequency), law.rows[0]
            phasors = response.torque[:, :, spans[0]]
            share = raised(evidence, spans, np.abs(phasors)) / limits
            worst = np.arange(len(share)), np.argmax(np.nan_to_num(share, nan=np.inf), axis=1)
            about = "T_KW(f)", "Vibratory torque of one harmonic component"
            yield compare(*about, (share * limits)[worst], limits[worst], size=share)
            # All together, each times the limit of the lowest frequency of the maker's data / that of its own: the
            # half range, and the root of the sum of squares where that is larger, which stands for the heat.
            weighted = phasors * (lowest / limits)
            squares = np.sqrt(np.sum(np.abs(weighted) ** 2, axis=1))
            value = raised(evidence, spans, np.maximum(half_range_of(response, weighted), squares))
            about = "T_KW(f)", "Vibratory torque of all components, weighted by frequency"
            words = f"each component times T_KW({frequency:g} Hz) / T_KW(f)"
            yield compare(*about, value, lowest, words=words, size=share)
        if (heat_limit := _heat_limit(evidence.study, ratings)) is not None:
            name, what, limit_of_heat, words = heat_limit
            heat = harmonic_heat(response, evidence.system, spans)
            power = raised(evidence, spans, heat, power=2)
            if not isinstance(limit_of_heat, float):
                # Every share of a limit over frequency counts as a share of the smallest limit.
                limit_at = limit_of_heat.at(response.frequency)
                limit_of_heat = float(limit_at.min())
                power = power * (limit_of_heat / limit_at)
            yield compare(name, what, np.sum(power, axis=1), limit_of_heat, "W", words)
        if (limit := ratings.max_torque) is not None:
            what, always = "Greatest torque in steady operation", np.ones(len(response.speed), bool)
            yield compare("T_Kmax", what, synthesis.peak[:, spans[0]], limit, is_judged=always)


def _couplings(study: Study) -> Iterator[tuple[int, Part, CouplingRatings]]:
    """Yield every coupling with its position in the train's parts, and its maker's limits."""
    for number, part in enumerate(study.train.parts):
        if part.ratings is not None:
            yield number, part, part.ratings


def _heat_limit(
    study: Study, ratings: CouplingRatings
) -> "tuple[str, str, float | OverFrequency, str] | None":
    """Return clause, what is compared, the limit and a remark; None where there is none in this state of the engine."""
    case = "" if study.case is None else f"case {study.case.name}"
    words = ""
    if misfires(study):
        if (limit := ratings.heat_in_misfire) is not None:
            duration = "" if limit.time is None else f"for {limit.time / 60.0:.4g} min at most"
            remark = "; ".join(filter(None, (duration, case)))
            return "P_KW misfire", "Heat in misfire", limit.power, remark
        words = f"a cylinder does not fire: {case or 'judged'} by the limit of continuous operation"
    if ratings.heat_over_frequency is not None:
        return "P_KW(f)", "Heat, weighted by frequency", ratings.heat_over_frequency, words
    return None if ratings.heat_limit is None else ("P_KW", "Heat", ratings.heat_limit, words)


def misfires(study: Study) -> bool:
    """Return whether a cylinder of an engine does not fire."""
    cylinders = (cylinder for engine in engines_of(study) for cylinder in engine.cylinders)
    return any(cylinder.state != "firing" for cylinder in cylinders)
