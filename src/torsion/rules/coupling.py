"""Rule `coupling-maker`: the limits in a coupling's catalogue (terms of DIN 740-2: T_KN, T_KW, T_Kmax, P_KW)."""

import math
from typing import TYPE_CHECKING, cast

import numpy as np

from torsion.analyses.steady import Steady
from torsion.components.coupling import Coupling
from torsion.components.lowering import Part
from torsion.errors import Fault
from torsion.fields import Declared, given
from torsion.findings import Results
from torsion.kernels.tree import BoolArray, FloatArray, IntArray
from torsion.rules.base_rule import Rule
from torsion.rules.check import Check
from torsion.rules.continuous import Continuous, continuous_faults, continuous_words, ends, within
from torsion.rules.evidence import parts_of_kind, rule_path, spans_of, vibration, vibration_faults
from torsion.rules.judgement import Clause, Curve, between, judge, largest_line, noted, worst_status
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.response.over_speed import Response
    from torsion.assembly.system import System

RULE = "coupling-maker"
LIMITS = ("rated_torque", "vibratory_torque", "max_torque", "heat_limit")
VIBRATORY = LIMITS[1:]


class CouplingSettings(Declared):
    """Settings of `coupling-maker`."""

    continuous: Continuous | None = given("speeds of continuous use, for T_KW and P_KW: {from, to} (default: all)")


class CouplingMaker(Rule):
    """The rule, as the study reads it."""

    settings = CouplingSettings
    needs = ("steady", "response")

    def faults(self, study: Study, asked: CouplingSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        judged = [(part, limits) for _, part in parts_of_kind(study, "coupling") if (limits := _limits(part))]
        if not judged:
            hint = f"give {', '.join(LIMITS)} of a coupling, or leave the rule out"
            return [Fault(rule_path(study, asked), "no coupling has a limit of its maker", hint)]
        found = continuous_faults(study, asked, RULE, asked.continuous)
        if any(key in limits for _, limits in judged for key in VIBRATORY):
            found += vibration_faults(study, asked, RULE)
        means = [part for part, limits in judged if "rated_torque" in limits or "max_torque" in limits]
        if means and not study.operation.has_mean_torque:
            message = f"the mean torque is not known, and {RULE} compares that of '{means[0].name}'"
            found.append(Fault(("operation", "rated", "power"), message, "rated: {speed: 1500 rpm, power: 100 kW}"))
        return found

    def left_out(self, study: Study, asked: CouplingSettings) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        silent = (part.name for _, part in parts_of_kind(study, "coupling") if not _limits(part))
        return tuple((f"{RULE} for {name}", "its maker's limits are not given") for name in silent)

    def check(self, evidence: Results, asked: CouplingSettings) -> tuple[Check, ...]:
        """Mean, vibratory and greatest torque and the heat of every coupling, as far as its limits are given."""
        found: list[Check | None] = []
        for number, part in parts_of_kind(evidence.study, "coupling"):
            limits, spans = _limits(part), spans_of(evidence.system, number)
            if "rated_torque" in limits and evidence.get(Steady) is not None:
                found.append(_mean(evidence, part, spans, limits["rated_torque"]))
            if any(key in limits for key in VIBRATORY):
                found += _vibration(evidence, part, spans, asked)
        return tuple(line for line in found if line is not None)

    def speeds(self, study: Study, asked: CouplingSettings) -> tuple[float, ...]:
        """rad/s: the rated speed and the ends of continuous use."""
        rated = study.operation.rated
        return (*(() if rated is None else (rated.speed,)), *ends(asked.continuous))

    def speeds_between(self, evidence: Results, asked: CouplingSettings) -> FloatArray:
        """(speeds,) rad/s between those computed at which a coupling may be worse."""
        found = []
        for number, part in parts_of_kind(evidence.study, "coupling"):
            spans = spans_of(evidence.system, number)
            found += [(curve, use) for _, curve, use, _ in _clauses(evidence, part, spans, asked)]
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


def _limits(part: Part) -> dict[str, float]:
    """The limits that the file gives for a coupling."""
    values = {key: getattr(cast(Coupling, part.component), key) for key in LIMITS}
    return {key: value for key, value in values.items() if value is not None}


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


def _vibration(evidence: Results, part: Part, spans: IntArray, asked: CouplingSettings) -> list[Check]:
    """The verdicts on the vibration of one coupling."""
    response, found = vibration(evidence)[0], []
    for clause, curve, use, words in _clauses(evidence, part, spans, asked):
        if (line := judge(clause, curve, use)) is not None:
            found.append(noted(line, words, largest_line(response, line, spans), _tolerance(part)))
    return found


def _clauses(
    evidence: Results, part: Part, spans: IntArray, asked: CouplingSettings
) -> list[tuple[Clause, Curve, BoolArray, str]]:
    """Vibratory torque against T_KW and heat against P_KW in continuous use, greatest torque against T_Kmax always."""
    response, synthesis = vibration(evidence)
    always = np.ones(len(response.speed), dtype=bool)
    use, words = within(asked.continuous, response.speed), continuous_words(asked.continuous)
    half_range, peak = synthesis.half_range[:, spans].max(axis=1), synthesis.peak[:, spans].max(axis=1)
    power = _heat(evidence.system, response, spans)
    rows = (
        ("vibratory_torque", _clause(part, "T_KW", "vibratory torque, synthesis"), half_range, use, words),
        ("heat_limit", _clause(part, "P_KW", "power loss, sum of all lines", "W"), power, use, words),
        ("max_torque", _clause(part, "T_Kmax", "greatest torque, mean and vibration"), peak, always, ""),
    )
    limits, status = _limits(part), worst_status(response)
    return [
        (clause, Curve(response.speed, value, np.full(len(value), limits[key]), status), judged, where)
        for key, clause, value, judged, where in rows
        if key in limits
    ]


def _heat(system: "System", response: "Response", spans: IntArray) -> FloatArray:
    """(speeds,) W of the whole coupling."""
    data = zip(system.flexibility[spans], system.viscous[spans], system.loss_factor[spans], spans.tolist(), strict=True)
    rows = [heat(response, flexibility, viscous, loss, span) for flexibility, viscous, loss, span in data]
    return np.asarray(np.sum(rows, axis=0))


def _tolerance(part: Part) -> str:
    """That the tolerance of the stiffness was not varied; empty where none is given."""
    tolerance = cast(Coupling, part.component).tolerance
    return f"at nominal stiffness, its tolerance of {100 * tolerance:.3g} % was not varied" if tolerance else ""
