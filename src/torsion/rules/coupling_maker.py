"""Rule `coupling-maker`: the limits in a coupling's catalogue (terms of DIN 740-2: T_KN, T_KW, T_Kmax, P_KW)."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.components.lowering import CouplingRatings, Part
from torsion.errors import Fault
from torsion.fields import Declared, given
from torsion.findings import Results
from torsion.rules import judgement
from torsion.rules.judgement import MOSTLY, RATED, Clause, Continuous, Curve, RuleOverSpeed, curve_of
from torsion.study import Study

LIMITS = ("rated_torque", "vibratory_torque", "max_torque", "heat_limit")


class CouplingSettings(Declared):
    """Settings of `coupling-maker`."""

    continuous: Continuous | None = given("speeds of continuous use, for T_KW and P_KW: {from, to} (default: all)")


class CouplingMaker(RuleOverSpeed):
    """The rule, as the study reads it."""

    name = "coupling-maker"
    settings = CouplingSettings

    def faults(self, study: Study, settings: CouplingSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        judged = [(part, ratings) for _, part, ratings in _couplings(study) if ratings.limit_anything]
        if not judged:
            hint = f"give {', '.join(LIMITS)} of a coupling, or leave the rule out"
            return [Fault(self.path(study, settings), "no coupling has a limit of its maker", hint)]
        found = self.continuous_faults(study, settings)
        if any(ratings.limit_vibration for _, ratings in judged):
            found += judgement.vibration_faults(self, study, settings)
        means = [part for part, ratings in judged if (ratings.rated_torque, ratings.max_torque) != (None, None)]
        if means and not study.operation.has_mean_torque:
            message = f"the mean torque is not known, and {self.name} compares that of '{means[0].name}'"
            found.append(Fault(("operation", "rated", "power"), message, RATED))
        return found

    def left_out(self, study: Study, settings: CouplingSettings) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        silent = (part.name for _, part, ratings in _couplings(study) if not ratings.limit_anything)
        return tuple((f"{self.name} for {name}", "its maker's limits are not given") for name in silent)

    def clauses(self, evidence: Results, settings: CouplingSettings) -> Iterator[Clause]:
        """Of every coupling, as far as its limits are given.

        Mean torque, vibratory torque and heat in continuous use, and greatest torque always.
        """
        steady = evidence.get(Steady)
        for number, part, ratings in _couplings(evidence.study):
            spans = judgement.spans_of(evidence.system, number)  # (1,): a coupling is one spring
            if ratings.rated_torque is not None and steady is not None:
                mean = curve_of(steady, np.abs(steady.torque[spans[0]]), ratings.rated_torque)
                yield Clause("T_KN", part.name, "mean torque", "maker", mean, np.ones(len(mean.speed), dtype=bool))
            if ratings.limit_vibration:
                yield from _vibration(evidence, part, ratings, spans, settings)
            yield from _warm(evidence, part, settings)


def _warm(evidence: Results, part: Part, settings: CouplingSettings) -> Iterator[Clause]:
    """The highest temperature of equilibrium; one that runs away, or has no answer, never passes."""
    if part.warming is None:
        return
    from torsion.analyses.coupling_temperatures import CouplingTemperatures

    known, speed = evidence.get(CouplingTemperatures), evidence.need(Response).speed
    rise, why = np.full(speed.shape, np.inf), "its temperatures have no answer, which is never a pass"
    for one in known.each if known is not None else ():
        if one.coupling == part.name:
            speed, rise, why = one.speed, one.rise, ""
    limit = np.full(speed.shape, part.warming.highest - part.warming.now)
    curve = Curve(speed, rise, limit, np.zeros(speed.shape, dtype=int))
    use, in_use = judgement.within(settings.continuous, speed), judgement.in_use(settings.continuous)
    what = "rise of its temperature by its own heat, highest equilibrium"
    yield Clause("ΔT", part.name, what, "maker", curve, use, "K", (why, in_use, MOSTLY))


def heat(response: Response, system: System, spans: IntArray) -> FloatArray:
    """(speeds,) W: mean power that spans turn into heat, all lines together.

    Of each line omega Im K |twist|^2/2 with twist = torque/K and K = k (1 + i eta) + i omega c, of a coupling with
    play, friction or stages as harmonic balance has it; with damping by hysteresis alone it is
    psi omega T_el^2/(4 pi k) of the elastic torque T_el. A rigid span loses nothing.
    """
    omega, power = 2.0 * math.pi * response.frequency, np.zeros_like(response.speed)
    added = {} if response.balanced is None else response.balanced.added
    for span in spans[system.flexibility[spans] > 0]:
        stiffness, loss = system.elastic(span, omega, response.carried(span))
        if span in added:
            one = added[span]
            loss = one.share[:, None] * loss + one.extra.imag[:, None]
            stiffness = one.share[:, None] * stiffness + one.extra.real[:, None]
        size, dynamic = np.abs(response.torque[:, :, span]), np.hypot(stiffness, loss)
        twist = np.divide(size, dynamic, out=np.zeros_like(omega), where=loss > 0)
        power += np.sum(0.5 * omega * loss * twist**2, axis=1)
    return power


def _couplings(study: Study) -> Iterator[tuple[int, Part, CouplingRatings]]:
    """Every coupling with its position in the train's parts, and its maker's limits."""
    return ((k, part, part.ratings) for k, part in enumerate(study.train.parts) if part.ratings is not None)


def _vibration(
    evidence: Results, part: Part, ratings: CouplingRatings, spans: IntArray, settings: CouplingSettings
) -> Iterator[Clause]:
    """The clauses about the vibration of one coupling; that the tolerance of its stiffness was not varied is noted."""
    response, synthesis, tolerance = evidence.need(Response), evidence.need(Synthesis), ratings.tolerance
    use, in_use = judgement.within(settings.continuous, response.speed), judgement.in_use(settings.continuous)
    half_range, peak = synthesis.half_range[:, spans[0]], synthesis.peak[:, spans[0]]
    power = heat(response, evidence.system, spans)
    if evidence.study.train.has_nonlinear_couplings:
        from torsion.rules.beside_exact_motion import surplus

        power *= surplus(evidence)[0][:, spans].max(axis=1) ** 2
        power[~np.isfinite(half_range)] = np.inf  # no exact motion is known
    varied = f"at nominal stiffness, its tolerance of {100 * tolerance:.3g} % was not varied" if tolerance else ""
    rows = (
        ("T_KW", "vibratory torque, synthesis", "N m", ratings.vibratory_torque, half_range, use, in_use),
        ("P_KW", "power loss, sum of all harmonic components", "W", ratings.heat_limit, power, use, in_use),
        ("T_Kmax", "greatest torque, mean and vibration", "N m", ratings.max_torque, peak, use | True, ""),
    )
    for clause, what, unit, limit, value, judged, where in rows:
        if limit is not None:
            curve, notes = curve_of(response, value, limit), (where, MOSTLY, varied)
            yield Clause(clause, part.name, what, "maker", curve, judged, unit, notes, spans)
