"""Rule `coupling-maker`: the limits in a coupling's catalogue (terms of DIN 740-2: T_KN, T_KW, T_Kmax, P_KW)."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.steady import Steady
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.components.lowering import Part
from torsion.components.part_records import CouplingRatings
from torsion.errors import Fault
from torsion.fields import Declared, given
from torsion.findings import Results
from torsion.rules.base_rule import Rule
from torsion.rules.check import Check
from torsion.rules.continuous import Continuous, continuous_faults, continuous_words, ends, within
from torsion.rules.evidence import rule_path, spans_of, vibration, vibration_faults
from torsion.rules.judgement import Clause, Curve, between, judge, largest_line, noted, worst_status
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.response.over_speed import Response
    from torsion.assembly.system import System

RULE = "coupling-maker"
LIMITS = ("rated_torque", "vibratory_torque", "max_torque", "heat_limit")


class CouplingSettings(Declared):
    """Settings of `coupling-maker`."""

    continuous: Continuous | None = given("speeds of continuous use, for T_KW and P_KW: {from, to} (default: all)")


class CouplingMaker(Rule):
    """The rule, as the study reads it."""

    settings = CouplingSettings
    needs = ("steady", "response")

    def faults(self, study: Study, asked: CouplingSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        judged = [(part, ratings) for _, part, ratings in _couplings(study) if ratings.limit_anything]
        if not judged:
            hint = f"give {', '.join(LIMITS)} of a coupling, or leave the rule out"
            return [Fault(rule_path(study, asked), "no coupling has a limit of its maker", hint)]
        found = continuous_faults(study, asked, RULE, asked.continuous)
        if any(ratings.limit_vibration for _, ratings in judged):
            found += vibration_faults(study, asked, RULE)
        means = [part for part, ratings in judged if (ratings.rated_torque, ratings.max_torque) != (None, None)]
        if means and not study.operation.has_mean_torque:
            message = f"the mean torque is not known, and {RULE} compares that of '{means[0].name}'"
            found.append(Fault(("operation", "rated", "power"), message, "rated: {speed: 1500 rpm, power: 100 kW}"))
        return found

    def left_out(self, study: Study, asked: CouplingSettings) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        silent = (part.name for _, part, ratings in _couplings(study) if not ratings.limit_anything)
        return tuple((f"{RULE} for {name}", "its maker's limits are not given") for name in silent)

    def check(self, evidence: Results, asked: CouplingSettings) -> tuple[Check, ...]:
        """Mean, vibratory and greatest torque and the heat of every coupling, as far as its limits are given."""
        found: list[Check | None] = []
        for number, part, ratings in _couplings(evidence.study):
            spans = spans_of(evidence.system, number)
            if ratings.rated_torque is not None:
                found.append(_mean(evidence, part, spans, ratings.rated_torque))
            if ratings.limit_vibration:
                found += _vibration(evidence, part, ratings, spans, asked)
        return tuple(line for line in found if line is not None)

    def speeds(self, study: Study, asked: CouplingSettings) -> tuple[float, ...]:
        """rad/s: the rated speed and the ends of continuous use."""
        rated = study.operation.rated
        return (*(() if rated is None else (rated.speed,)), *ends(asked.continuous))

    def speeds_between(self, evidence: Results, asked: CouplingSettings) -> FloatArray:
        """(speeds,) rad/s between those computed at which a coupling may be worse."""
        found = []
        for number, part, ratings in _couplings(evidence.study):
            spans = spans_of(evidence.system, number)
            found += [(curve, use) for _, curve, use, _ in _clauses(evidence, part, ratings, spans, asked)]
        return between(found)


def heat(response: "Response", flexibility: float, viscous: float, loss_factor: float, span: int) -> FloatArray:
    """(speeds,) W: mean power that a span turns into heat, all lines together.

    Of each line omega k eta |twist|^2/2 + omega^2 c |twist|^2/2 with twist = torque/(k (1 + i eta) + i omega c); with
    damping by hysteresis alone it is psi omega T_el^2/(4 pi k) of the elastic torque T_el. A rigid span loses nothing.
    """
    omega = 2.0 * math.pi * response.frequency
    if flexibility == 0:
        return np.zeros(len(response.speed))
    stiffness = 1.0 / flexibility
    loss = stiffness * loss_factor + omega * viscous
    dynamic = stiffness + 1j * loss
    lossy = loss > 0
    twist = np.divide(response.torque[:, :, span], dynamic, out=np.zeros(omega.shape, complex), where=lossy)
    return np.asarray(np.sum(0.5 * omega * loss * np.abs(twist) ** 2, axis=1))


def _couplings(study: Study) -> Iterator[tuple[int, Part, CouplingRatings]]:
    """Every coupling with its position in the train's parts, and its maker's limits."""
    return ((k, part, part.ratings) for k, part in enumerate(study.train.parts) if part.ratings is not None)


def _clause(part: Part, clause: str, what: str, unit: str = "N m") -> Clause:
    return Clause(RULE, clause, part.name, what, unit, "maker")


def _mean(evidence: Results, part: Part, spans: IntArray, limit: float) -> Check | None:
    """Mean torque against T_KN."""
    steady = evidence.get(Steady)
    if steady is None:
        return None
    value = np.abs(steady.torque[spans]).max(axis=0)
    curve = Curve(steady.speed, value, np.full(len(value), limit), np.zeros(len(value), dtype=np.int64))
    return judge(_clause(part, "T_KN", "mean torque"), curve, np.ones(len(value), dtype=bool))


def _vibration(
    evidence: Results, part: Part, ratings: CouplingRatings, spans: IntArray, asked: CouplingSettings
) -> list[Check]:
    """The verdicts on the vibration of one coupling."""
    response, found = vibration(evidence)[0], []
    for clause, curve, use, words in _clauses(evidence, part, ratings, spans, asked):
        if (line := judge(clause, curve, use)) is not None:
            found.append(noted(line, words, largest_line(response, line, spans), _tolerance(ratings)))
    return found


def _clauses(
    evidence: Results, part: Part, ratings: CouplingRatings, spans: IntArray, asked: CouplingSettings
) -> list[tuple[Clause, Curve, BoolArray, str]]:
    """Vibratory torque against T_KW and heat against P_KW in continuous use, greatest torque against T_Kmax always."""
    response, synthesis = vibration(evidence)
    always = np.ones(len(response.speed), dtype=bool)
    use, words = within(asked.continuous, response.speed), continuous_words(asked.continuous)
    half_range, peak = synthesis.half_range[:, spans].max(axis=1), synthesis.peak[:, spans].max(axis=1)
    power = _heat(evidence.system, response, spans)
    rows = (
        (ratings.vibratory_torque, _clause(part, "T_KW", "vibratory torque, synthesis"), half_range, use, words),
        (ratings.heat_limit, _clause(part, "P_KW", "power loss, sum of all lines", "W"), power, use, words),
        (ratings.max_torque, _clause(part, "T_Kmax", "greatest torque, mean and vibration"), peak, always, ""),
    )
    status = worst_status(response)
    return [
        (clause, Curve(response.speed, value, np.full(len(value), limit), status), judged, where)
        for limit, clause, value, judged, where in rows
        if limit is not None
    ]


def _heat(system: "System", response: "Response", spans: IntArray) -> FloatArray:
    """(speeds,) W of the whole coupling."""
    data = zip(system.flexibility[spans], system.viscous[spans], system.loss_factor[spans], spans.tolist(), strict=True)
    rows = [heat(response, flexibility, viscous, loss, span) for flexibility, viscous, loss, span in data]
    return np.asarray(np.sum(rows, axis=0))


def _tolerance(ratings: CouplingRatings) -> str:
    """That the tolerance of the stiffness was not varied; empty where none is given."""
    tolerance = ratings.tolerance
    return f"at nominal stiffness, its tolerance of {100 * tolerance:.3g} % was not varied" if tolerance else ""
