"""Rule `coupling-maker`: the limits in a coupling's catalogue (terms of DIN 740-2: T_KN, T_KW, T_Kmax, P_KW)."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.synthesis import half_range as half_range_of
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault
from torsion.fields import given
from torsion.findings import Results
from torsion.model.lowering import CouplingRatings, Part
from torsion.rules import judgement
from torsion.rules.demanded_states import MISFIRE, unjudged
from torsion.rules.judgement import (
    MOSTLY,
    RATED,
    Clause,
    Continuous,
    Curve,
    RuleOverSpeed,
    UseSettings,
    curve_of,
    within,
)
from torsion.rules.verdict_line import Check
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.model.coupling_limits import OverFrequency

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
    is_pointwise = True

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for this rule."""
        judged = [
            (part, ratings) for _, part, ratings in _couplings(study) if ratings.limit_anything
        ]
        if not judged:
            hint = f"give {', '.join(LIMITS)} of a coupling, or leave the rule out"
            return [Fault(self.path(study), "no coupling has a limit of its maker", hint)]
        is_vibration = any(ratings.limit_vibration for _, ratings in judged)
        found = self.vibration_faults(study) if is_vibration else self.continuous_faults(study)
        found += self._lossless(study)
        means = [
            part
            for part, ratings in judged
            if (ratings.rated_torque, ratings.max_torque) != (None, None)
        ]
        if means and not study.has_mean_torque:
            message = (
                f"the mean torque is not known, and {self.name} compares that of '{means[0].name}'"
            )
            found.append(Fault(("operation", "rated", "power"), message, RATED))
        return found

    def _lossless(self, study: Study) -> Iterator[Fault]:
        """Couplings whose heat is judged and of which nothing says what they lose: that they lose none is no answer."""
        by_table = {
            one.part for one in study.train.springs if one.table is not None and one.table.damps
        }
        for number, part, ratings in _couplings(study):
            key = (
                "heat_limit"
                if ratings.heat_limit is not None
                else "temperature"
                if part.warming is not None
                else ""
            )
            if key and part.damping is None and part.nonlinear is None and number not in by_table:
                message = (
                    f"{self.name} judges the heat of '{part.name}', whose damping is not given"
                )
                yield Fault(
                    (*part.path, key),
                    message,
                    "its `psi`, or another damping; `psi: 0` if it has none",
                )

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        silent = (part.name for _, part, ratings in _couplings(study) if not ratings.limit_anything)
        found = [(f"{self.name} for {name}", "its maker's limits are not given") for name in silent]
        for _, part, ratings in _couplings(study):
            if ratings.heat_in_misfire is None:
                continue
            if (
                any(map(misfires, (study, *study.cases.values())))
                and part.kind == "coupling"
                and not (study.cases or study.case or part.warming)
            ):
                words = "one calculation has one stiffness: compute the cold and the warm coupling as cases"
                found.append((f"{self.name}: heat of {part.name} in misfire, cold and warm", words))
        return tuple(found)

    def demanded_rows(self, study: Study) -> tuple[Check, ...]:
        """Limits of the heat in misfire where every cylinder of an engine fires."""
        has_engine = any(part.engine is not None for part in study.train.parts)
        if (
            not has_engine
            or study.covers(MISFIRE, self.name)
            or any(map(misfires, (study, *study.cases.values())))
        ):
            return ()
        note, limited = "every cylinder fires: compute a misfire, as a case", _couplings(study)
        return tuple(
            unjudged(self.name, "P_KW misfire", part.name, "Heat in misfire", note, "maker")
            for _, part, ratings in limited
            if ratings.heat_in_misfire is not None
        )

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Of every coupling, as far as its limits are given.

        Mean torque, vibratory torque and heat in continuous use, and greatest torque always.
        """
        steady = evidence.get(Steady)
        for number, part, ratings in _couplings(evidence.study):
            spans = judgement.spans_of(evidence.system, number)  # (1,): a coupling is one spring
            if ratings.rated_torque is not None and steady is not None:
                mean = curve_of(steady, np.abs(steady.torque[spans[0]]), ratings.rated_torque)
                yield Clause(
                    "T_KN",
                    part.name,
                    "Mean torque",
                    "maker",
                    mean,
                    np.ones(len(mean.speed), dtype=bool),
                )
            if ratings.limit_vibration:
                yield from self._vibration(evidence, part, ratings, spans)
            yield from self._temperature(evidence, part)

    def _vibration(
        self, evidence: Results, part: Part, ratings: CouplingRatings, spans: IntArray
    ) -> Iterator[Clause]:
        """Yield the clauses about the vibration of one coupling; a tolerance that was not varied is noted."""
        response, synthesis = evidence.need(Response), evidence.need(Synthesis)
        use, always = within(self.use, response.speed), np.ones(len(response.speed), dtype=bool)
        varied = ""
        if ratings.tolerance:
            varied = f"at nominal stiffness, its tolerance of {100 * ratings.tolerance:.3g} % was not varied"

        def clause(name: str, what: str, unit: str, curve: Curve, words: str = "") -> Clause:
            notes = self.use_words, MOSTLY, words, varied
            return Clause(name, part.name, what, "maker", curve, use, unit, notes, spans)

        if (limit := ratings.vibratory_torque) is not None:
            curve = curve_of(response, synthesis.half_range[:, spans[0]], limit)
            yield clause("T_KW", "Vibratory torque", "N m", curve)
        if (limits := ratings.vibratory_over_frequency) is not None:
            for curve, what, words, sizes in _over_frequency(evidence, limits, spans):
                yield replace(clause("T_KW(f)", what, "N m", curve, words), size=sizes)
        if (heat_limit := _heat_limit(evidence.study, ratings)) is not None:
            name, what, limit_of_heat, words = heat_limit
            power = raised_heat(evidence, spans)
            limit_at = (
                np.full(power.shape, limit_of_heat)
                if isinstance(limit_of_heat, float)
                else limit_of_heat.at(response.frequency)
            )
            # Of a limit over frequency every share counts as a share of the smallest limit.
            smallest = float(limit_at.min())
            weighted = np.sum(power * (smallest / limit_at), axis=1)
            yield clause(name, what, "W", curve_of(response, weighted, smallest), words)
        if (limit := ratings.max_torque) is not None:
            curve = curve_of(response, synthesis.peak[:, spans[0]], limit)
            row = clause("T_Kmax", "Greatest torque in steady operation", "N m", curve)
            yield replace(row, within=always, notes=("", MOSTLY, "", varied))

    def _temperature(self, evidence: Results, part: Part) -> Iterator[Clause]:
        """Yield the highest temperature of equilibrium; one that runs away, or has no answer, never passes."""
        if part.warming is None:
            return
        from torsion.analyses.response.coupling_temperatures import CouplingTemperatures

        temperatures, speed = evidence.get(CouplingTemperatures), evidence.need(Response).speed
        rise, reason = np.full(speed.shape, np.nan), "its temperatures were not solved"
        reason += ", which is never a pass"
        for coupling in () if temperatures is None else temperatures.each:
            if coupling.coupling == part.name:
                speed, rise, reason = coupling.speed, coupling.rise, ""
        limit = np.full(speed.shape, part.warming.highest - part.warming.now)
        curve = Curve(speed, rise, limit, np.zeros(speed.shape, dtype=int))
        use, what = within(self.use, speed), "Temperature rise by its own heat"
        notes = reason, self.use_words, MOSTLY
        yield Clause("ΔT", part.name, what, "maker", curve, use, "K", notes, infinite_fails=True)


def heat(response: Response, system: System, spans: IntArray) -> FloatArray:
    """(speeds,) W: mean power that spans turn into heat, all lines together."""
    return np.asarray(np.sum(harmonic_heat(response, system, spans), axis=1))


def harmonic_heat(response: Response, system: System, spans: IntArray) -> FloatArray:
    """(speeds, lines) W: mean power that spans turn into heat.

    Of each line omega Im K |twist|^2/2 with twist = torque/K and K = k (1 + i eta) + i omega c, of a coupling with
    play, friction or stages as harmonic balance has it; with damping by hysteresis alone it is
    psi omega T_el^2/(4 pi k) of the elastic torque T_el. A rigid span loses nothing.
    """
    omega, power = 2.0 * math.pi * response.frequency, np.zeros(response.frequency.shape)
    added = {} if response.balanced is None else response.balanced.added
    for span in spans[np.all(system.flexibility[spans].reshape(len(spans), -1) > 0, axis=1)]:
        stiffness, loss = system.elastic(
            span, omega, response.carried(span), response.speed[:, None]
        )
        if span in added:
            one = added[span]
            loss = one.share[:, None] * loss + one.extra.imag[:, None]
            stiffness = one.share[:, None] * stiffness + one.extra.real[:, None]
        size, dynamic = np.abs(response.torque[:, :, span]), np.hypot(stiffness, loss)
        twist = np.divide(size, dynamic, out=np.zeros_like(omega), where=loss > 0)
        power += 0.5 * omega * loss * twist**2
    return power


def raised_heat(evidence: Results, spans: IntArray) -> FloatArray:
    """(speeds, lines) W: the heat of the spans, raised as the exact motions beside harmonic balance raise the torque.

    Infinite where such a motion is needed and none is known.
    """
    return _nonlinear(
        evidence, spans, harmonic_heat(evidence.need(Response), evidence.system, spans), power=2
    )


def _couplings(study: Study) -> Iterator[tuple[int, Part, CouplingRatings]]:
    """Every coupling with its position in the train's parts, and its maker's limits."""
    return (
        (k, part, part.ratings)
        for k, part in enumerate(study.train.parts)
        if part.ratings is not None
    )


def _heat_limit(
    study: Study, ratings: CouplingRatings
) -> "tuple[str, str, float | OverFrequency, str] | None":
    """Clause, what is compared, the limit and a remark; None where there is none but for a misfire, and none is."""
    case = "" if study.case is None else f"case {study.case.name}"
    if misfires(study) and ratings.heat_in_misfire is not None:
        time = ratings.heat_in_misfire.time
        most = "" if time is None else f"for {time / 60.0:.4g} min at most"
        words = "; ".join(filter(None, (most, case)))
        return "P_KW misfire", "Heat in misfire", ratings.heat_in_misfire.power, words
    words = (
        f"a cylinder does not fire: {case or 'judged'} by the limit of continuous operation"
        * misfires(study)
    )
    if ratings.heat_over_frequency is not None:
        what = "Heat, weighted by frequency"
        return "P_KW(f)", what, ratings.heat_over_frequency, words
    if ratings.heat_limit is None:
        return None
    return "P_KW", "Heat", ratings.heat_limit, words


def _over_frequency(
    evidence: Results, limit: "OverFrequency", spans: IntArray
) -> Iterator[tuple[Curve, str, str, FloatArray]]:
    """Every harmonic component by itself, and all together, against a torque that depends on the frequency of each.

    Together each counts times the limit of the lowest frequency of the maker's data / that of its own; of these the
    half range, and the root of the sum of squares where that is larger, which stands for the heat.
    """
    response = evidence.need(Response)
    own, known = limit.at(response.frequency), limit.rows[0]
    phasors = response.torque[:, :, spans[0]]
    share = _nonlinear(evidence, spans, np.abs(phasors)) / own
    at, rows = np.argmax(np.nan_to_num(share, nan=np.inf), axis=1), np.arange(len(share))
    alone = curve_of(response, (share * own)[rows, at], own[rows, at])
    yield alone, "Vibratory torque of one harmonic component", "", share
    weighted = phasors * (known[1] / own)
    squares = np.sqrt(np.sum(np.abs(weighted) ** 2, axis=1))
    value = np.maximum(half_range_of(response, weighted), squares)
    together = curve_of(response, _nonlinear(evidence, spans, value), known[1])
    words = f"each component times T_KW({known[0]:g} Hz) / T_KW(f)"
    yield together, "Vibratory torque of all components, weighted by frequency", words, share


def misfires(study: Study) -> bool:
    """A cylinder of an engine does not fire."""
    engines = [part.engine for part in study.train.parts if part.engine is not None]
    return any(one.state != "firing" for engine in engines for one in engine.cylinders)


def _nonlinear(
    evidence: Results, spans: IntArray, values: FloatArray, power: int = 1
) -> FloatArray:
    """Values (speeds, ...) of a torque to that power, as large as exact motions beside harmonic balance have them."""
    if not evidence.study.train.has_nonlinear_couplings:
        return values
    from torsion.analyses.motion.raised_synthesis import surplus

    factor = surplus(evidence)[0][:, spans].max(axis=1) ** power
    unknown = ~np.isfinite(
        evidence.need(Synthesis).half_range[:, spans[0]]
    )  # no exact motion is known
    shape = (-1, *(1,) * (values.ndim - 1))
    return np.where(unknown.reshape(shape), np.inf, values * factor.reshape(shape))
