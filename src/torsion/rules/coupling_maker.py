"""Rule `coupling-maker`: the limits in a coupling's catalogue (terms of DIN 740-2: T_KN, T_KW, T_Kmax, P_KW)."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.synthesis import half_range as half_range_of
from torsion.analyses.steady import Steady
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.components.lowering import CouplingRatings, Part
from torsion.errors import Fault
from torsion.fields import given
from torsion.findings import Results
from torsion.rules import judgement
from torsion.rules.demanded_states import MISFIRE, unjudged
from torsion.rules.judgement import (
    MOSTLY,
    RATED,
    Clause,
    Continuous,
    Curve,
    RuleOverSpeed,
    curve_of,
)
from torsion.rules.verdict_line import Check, RuleSettings
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.components.coupling_limits import OverFrequency

LIMITS = ("rated_torque", "vibratory_torque", "max_torque", "heat_limit")


class CouplingSettings(RuleSettings):
    """Settings of `coupling-maker`."""

    continuous: Continuous | None = given(
        "speeds of continuous use, for T_KW and P_KW: {from, to} (default: all)"
    )


class CouplingMaker(RuleOverSpeed):
    """The rule, as the study reads it."""

    name = "coupling-maker"
    settings = CouplingSettings
    is_pointwise = True

    def faults(self, study: Study, settings: CouplingSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        judged = [
            (part, ratings) for _, part, ratings in _couplings(study) if ratings.limit_anything
        ]
        if not judged:
            hint = f"give {', '.join(LIMITS)} of a coupling, or leave the rule out"
            return [Fault(self.path(study, settings), "no coupling has a limit of its maker", hint)]
        found = self.continuous_faults(study, settings)
        if any(ratings.limit_vibration for _, ratings in judged):
            found += judgement.vibration_faults(self, study, settings)
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

    def left_out(self, study: Study, settings: CouplingSettings) -> tuple[tuple[str, str], ...]:
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

    def check(self, evidence: Results, settings: CouplingSettings) -> tuple[Check, ...]:
        """With a row for each limit of the heat in misfire that no state of the train is compared with."""
        return *super().check(evidence, settings), *self.demanded_rows(evidence.study, settings)

    def demanded_rows(self, study: Study, settings: CouplingSettings) -> tuple[Check, ...]:
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

    def clauses(self, evidence: Results, settings: CouplingSettings) -> Iterator[Clause]:
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
                yield from _vibration(evidence, part, ratings, spans, settings)
            yield from _warm(evidence, part, settings)


def _warm(evidence: Results, part: Part, settings: CouplingSettings) -> Iterator[Clause]:
    """The highest temperature of equilibrium; one that runs away, or has no answer, never passes."""
    if part.warming is None:
        return
    from torsion.analyses.response.coupling_temperatures import CouplingTemperatures

    known, speed = evidence.get(CouplingTemperatures), evidence.need(Response).speed
    rise, why = (
        np.full(speed.shape, np.nan),
        "its temperatures were not solved, which is never a pass",
    )
    for one in known.each if known is not None else ():
        if one.coupling == part.name:
            speed, rise, why = one.speed, one.rise, ""
    limit = np.full(speed.shape, part.warming.highest - part.warming.now)
    curve = Curve(speed, rise, limit, np.zeros(speed.shape, dtype=int))
    use, in_use = (
        judgement.within(settings.continuous, speed),
        judgement.in_use(settings.continuous),
    )
    what = "Temperature rise by its own heat"
    yield Clause(
        "ΔT", part.name, what, "maker", curve, use, "K", (why, in_use, MOSTLY), infinite_fails=True
    )


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


def _vibration(
    evidence: Results,
    part: Part,
    ratings: CouplingRatings,
    spans: IntArray,
    settings: CouplingSettings,
) -> Iterator[Clause]:
    """The clauses about the vibration of one coupling; that the tolerance of its stiffness was not varied is noted."""
    response, synthesis, tolerance = (
        evidence.need(Response),
        evidence.need(Synthesis),
        ratings.tolerance,
    )
    use, in_use = (
        judgement.within(settings.continuous, response.speed),
        judgement.in_use(settings.continuous),
    )
    half_range, peak = synthesis.half_range[:, spans[0]], synthesis.peak[:, spans[0]]
    varied = (
        f"at nominal stiffness, its tolerance of {100 * tolerance:.3g} % was not varied"
        if tolerance
        else ""
    )

    def clause(
        name: str, what: str, unit: str, curve: Curve, judged: BoolArray, where: str, *more: Any
    ) -> Clause:
        words, *size = more or ("",)
        return Clause(
            name,
            part.name,
            what,
            "maker",
            curve,
            judged,
            unit,
            (where, MOSTLY, words, varied),
            spans,
            *size,
        )

    if (limit := ratings.vibratory_torque) is not None:
        yield clause(
            "T_KW", "Vibratory torque", "N m", curve_of(response, half_range, limit), use, in_use
        )
    if ratings.vibratory_over_frequency is not None:
        for curve, what, words, size in _over_frequency(
            evidence, ratings.vibratory_over_frequency, spans
        ):
            yield clause("T_KW(f)", what, "N m", curve, use, in_use, words, size)
    if (of_heat := _heat_limit(evidence.study, ratings)) is not None:
        name, what, most, words = of_heat
        power = raised_heat(evidence, spans)
        at = np.full(power.shape, most) if isinstance(most, float) else most.at(response.frequency)
        least = float(at.min())  # of a limit over frequency every share counts as one of the least
        yield clause(
            name,
            what,
            "W",
            curve_of(response, np.sum(power * (least / at), axis=1), least),
            use,
            in_use,
            words,
        )
    if (limit := ratings.max_torque) is not None:
        curve = curve_of(response, peak, limit)
        yield clause("T_Kmax", "Greatest torque in steady operation", "N m", curve, use | True, "")


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
    from torsion.analyses.transient.raised_synthesis import surplus

    factor = surplus(evidence)[0][:, spans].max(axis=1) ** power
    unknown = ~np.isfinite(
        evidence.need(Synthesis).half_range[:, spans[0]]
    )  # no exact motion is known
    shape = (-1, *(1,) * (values.ndim - 1))
    return np.where(unknown.reshape(shape), np.inf, values * factor.reshape(shape))
