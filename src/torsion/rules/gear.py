"""Rule `gear-hammer`: vibratory torque in a gear mesh against its rating (K_A) and against the mean torque."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.components.lowering import Part
from torsion.errors import Fault
from torsion.fields import Declared, Quantity, given
from torsion.findings import Results
from torsion.rules.base_rule import Rule
from torsion.rules.check import TO_BE_VERIFIED, Check, Standing
from torsion.rules.continuous import Continuous, continuous_faults, continuous_words, ends, within
from torsion.rules.evidence import (
    coverage,
    rated_torque,
    rule_path,
    spans_of,
    vibration,
    vibration_faults,
)
from torsion.rules.judgement import Clause, Curve, between, judge, largest_line, noted, worst_status
from torsion.study import Operation, Study

RULE = "gear-hammer"
USUAL_SHARE = 0.35  # K_A - 1 with the usual application factor 1.35 (to be verified)
NO_LOAD = 1e-9  # a mesh with a smaller share of the train's greatest mean torque is unloaded


class GearHammerSettings(Declared):
    """Settings of `gear-hammer`."""

    limit: Annotated[float, Quantity("1", above=0, usual=(None, 5.0), slip=("%",))] | None = given(
        "vibratory torque / rated torque (default: application_factor - 1 of the gear, else 0.35)"
    )
    continuous: Continuous | None = given(
        "speeds of continuous use, for the torque reversal: {from, to} (default: all)"
    )


class GearHammer(Rule):
    """The rule, as the study reads it."""

    settings = GearHammerSettings
    needs = ("steady", "response")

    def faults(self, study: Study, asked: GearHammerSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        if not any(study.train.of_kind("gear")):
            return [Fault(rule_path(study, asked), f"{RULE} finds no gear in the train", "leave the rule out")]
        missing = [*_rated_faults(study.operation), *continuous_faults(study, asked, RULE, asked.continuous)]
        return missing + vibration_faults(study, asked, RULE)

    def check(self, evidence: Results, asked: GearHammerSettings) -> tuple[Check, ...]:
        """Both clauses at every mesh; torques are told at the driving gear's speed."""
        found = []
        for number, part in evidence.study.train.of_kind("gear"):
            for span in spans_of(evidence.system, number).tolist():
                found += list(_mesh(evidence, part, span, asked))
        return tuple(found)

    def speeds(self, study: Study, asked: GearHammerSettings) -> tuple[float, ...]:
        """rad/s: the rated speed and the ends of continuous use."""
        return (_rated_speed(study), *ends(asked.continuous))

    def speeds_between(self, evidence: Results, asked: GearHammerSettings) -> FloatArray:
        """(speeds,) rad/s between those computed at which a mesh may be worse."""
        found = []
        for number, part in evidence.study.train.of_kind("gear"):
            for span in spans_of(evidence.system, number).tolist():
                found += [(curve, use) for _, curve, use, _ in _clauses(evidence, part, span, asked)]
        return between(found)


def _rated_speed(study: Study) -> float:
    """rad/s of the reference station; raises ValueError where the study has none."""
    if study.operation.rated is None:
        raise ValueError(f"{RULE} needs the rated speed")
    return study.operation.rated.speed


def _mesh(evidence: Results, part: Part, span: int, asked: GearHammerSettings) -> Iterator[Check]:
    """The verdicts on one mesh."""
    response = vibration(evidence)[0]
    for clause, curve, use, words in _clauses(evidence, part, span, asked):
        if (line := judge(clause, curve, use)) is not None:
            yield noted(line, *words, largest_line(response, line, np.array([span])))


def _clauses(
    evidence: Results, part: Part, span: int, asked: GearHammerSettings
) -> Iterator[tuple[Clause, Curve, BoolArray, tuple[str, ...]]]:
    """Vibratory torque against (K_A - 1) T_rated over all speeds, and against the mean torque in continuous use."""
    response, synthesis = vibration(evidence)
    status, vibratory = worst_status(response), synthesis.half_range[:, span]
    where, rated = evidence.system.spans[span].name, _rated(evidence, span)
    share, origin, standing = _share(part, asked)
    if rated > 0:
        clause = Clause(RULE, "(K_A - 1) T_rated", where, "vibratory mesh torque, synthesis", "N m", standing)
        curve = Curve(response.speed, vibratory, np.full(len(vibratory), share * rated), status)
        reach = coverage(float(response.speed[-1]), _rated_speed(evidence.study))
        yield clause, curve, np.ones(len(vibratory), dtype=bool), (f"{share:.4g} ({origin}) x {rated:.5g} N m", reach)
    clause = Clause(RULE, "torque reversal", where, "vibratory against mean mesh torque", "N m", TO_BE_VERIFIED)
    curve = Curve(response.speed, vibratory, np.abs(response.mean[:, span]), status)
    words = "" if rated > 0 else "the mesh carries no mean torque", continuous_words(asked.continuous)
    yield clause, curve, within(asked.continuous, response.speed), words


def _share(part: Part, asked: GearHammerSettings) -> tuple[float, str, Standing]:
    """Permissible vibratory share of the rated torque, where it comes from and how that stands."""
    factor = part.application_factor
    if asked.limit is not None:
        return asked.limit, "setting `limit`", "setting"
    share, origin = (USUAL_SHARE, "usual K_A 1.35") if factor is None else (factor - 1.0, f"K_A {factor:.4g}")
    return share, origin, TO_BE_VERIFIED


def _rated(evidence: Results, span: int) -> float:
    """Mean torque at the rated speed, N m; exactly 0 in a mesh that carries nothing but rounding."""
    everywhere = rated_torque(evidence, np.arange(len(evidence.system.spans)))
    if everywhere is None:
        raise ValueError("the torque at the rated speed is not known")
    return float(everywhere[span]) if everywhere[span] > NO_LOAD * np.max(everywhere) else 0.0


def _rated_faults(operation: Operation) -> list[Fault]:
    """The rated torque must be known."""
    rated = operation.rated
    hint = "rated: {speed: 1500 rpm, power: 100 kW}"
    if rated is None:
        return [Fault(("operation", "rated"), f"`rated` is missing; {RULE} compares with the rated torque", hint)]
    if not operation.has_mean_torque:
        message = f"`power` is missing; {RULE} compares with the rated torque"
        return [Fault(("operation", "rated", "power"), message, hint)]
    return []
