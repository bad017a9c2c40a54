"""Rule `gear-hammer`: vibratory torque in a gear mesh against its rating (K_A) and against the mean torque."""

from collections.abc import Iterator
from typing import Annotated, cast

import numpy as np

from torsion.analyses.steady import has_mean_torque
from torsion.components.gear import Gear
from torsion.components.lowering import Part
from torsion.errors import Fault
from torsion.fields import Declared, Quantity, given
from torsion.rules.check import Check
from torsion.rules.continuous import Continuous, continuous_faults, continuous_words, within
from torsion.rules.evidence import (
    Evidence,
    parts_of_kind,
    rated_is_computed,
    rated_torque,
    rule_path,
    spans_of,
    vibration_faults,
)
from torsion.rules.judgement import EDITION, Clause, Curve, judge, largest_line, noted, worst_status
from torsion.study import Operation, Study

RULE = "gear-hammer"
USUAL_SHARE = 0.35  # K_A - 1 with the usual application factor 1.35 (to be verified)
NO_LOAD = 1e-9  # a mesh with a smaller share of the train's greatest mean torque is unloaded


class Asked(Declared):
    """Settings of `gear-hammer`."""

    limit: Annotated[float, Quantity("1", above=0)] | None = given(
        "vibratory torque / rated torque (default: application_factor - 1 of the gear, else 0.35)"
    )
    continuous: Continuous | None = given(
        "speeds of continuous use, for the torque reversal: {from, to} (default: all)"
    )


def needs(asked: Asked) -> tuple[str, ...]:
    """The analyses that the rule reads."""
    return ("steady", "response")


def faults(study: Study, asked: Asked) -> list[Fault]:
    """What the file lacks for this rule."""
    if not any(parts_of_kind(study, "gear")):
        return [Fault(rule_path(study, asked), f"{RULE} finds no gear in the train", "leave the rule out")]
    missing = [*_rated_faults(study.operation), *continuous_faults(study, asked, RULE, asked.continuous)]
    return missing + vibration_faults(study, asked, RULE)


def left_out(study: Study, asked: Asked) -> tuple[tuple[str, str], ...]:
    """What was not judged, and why: nothing is left out."""
    return ()


def check(evidence: Evidence, asked: Asked) -> tuple[Check, ...]:
    """Both clauses at every mesh; torques are told at the driving gear's speed."""
    found = []
    for number, part in parts_of_kind(evidence.study, "gear"):
        for span in spans_of(evidence.system, number).tolist():
            found += list(_mesh(evidence, part, span, asked))
    return tuple(found)


def _mesh(evidence: Evidence, part: Part, span: int, asked: Asked) -> Iterator[Check]:
    """Vibratory torque against (K_A - 1) T_rated over all speeds, and against the mean torque in continuous use."""
    response, synthesis = evidence.vibration()
    status, vibratory = worst_status(response), synthesis.half_range[:, span]
    where, spans = evidence.system.spans[span].name, np.array([span])
    share, origin = _share(part, asked)
    rated = _rated(evidence, span)
    if rated > 0:
        curve = Curve(response.speed, vibratory, np.full(len(vibratory), share * rated), status)
        clause = Clause(RULE, "(K_A - 1) T_rated", where, "vibratory mesh torque, synthesis", "N m")
        if (line := judge(clause, curve, np.ones(len(vibratory), dtype=bool))) is not None:
            factor = f"{share:.4g} ({origin}) x {rated:.5g} N m"
            yield noted(line, factor, largest_line(response, line, spans), EDITION)
    mean = np.abs(response.mean[:, span])
    clause = Clause(RULE, "torque reversal", where, "vibratory against mean mesh torque", "N m")
    line = judge(clause, Curve(response.speed, vibratory, mean, status), within(asked.continuous, response.speed))
    if line is not None:
        use, idle = continuous_words(asked.continuous), "" if rated > 0 else "the mesh carries no mean torque"
        yield noted(line, idle, use, largest_line(response, line, spans), EDITION)


def _share(part: Part, asked: Asked) -> tuple[float, str]:
    """Permissible vibratory share of the rated torque, and where it comes from."""
    factor = cast(Gear, part.component).application_factor
    if asked.limit is not None:
        return asked.limit, "setting `limit`"
    return (USUAL_SHARE, "usual K_A 1.35") if factor is None else (factor - 1.0, f"K_A {factor:.4g}")


def _rated(evidence: Evidence, span: int) -> float:
    """Mean torque at the rated speed, N m; exactly 0 in a mesh that carries nothing but rounding."""
    everywhere = rated_torque(evidence, np.arange(len(evidence.system.spans)))
    if everywhere is None:
        raise ValueError("the torque at the rated speed is not known")
    return float(everywhere[span]) if everywhere[span] > NO_LOAD * np.max(everywhere) else 0.0


def _rated_faults(operation: Operation) -> list[Fault]:
    """The rated torque must be known, and lie at a speed that is computed."""
    rated = operation.rated
    hint = "rated: {speed: 1500 rpm, power: 100 kW}"
    if rated is None:
        return [Fault(("operation", "rated"), f"`rated` is missing; {RULE} compares with the rated torque", hint)]
    if not has_mean_torque(operation):
        message = f"`power` is missing; {RULE} compares with the rated torque"
        return [Fault(("operation", "rated", "power"), message, hint)]
    if not rated_is_computed(operation):
        message = f"the rated speed is not among the speeds that are computed, and {RULE} needs its torque"
        return [Fault(("operation", "rated", "speed"), message, "let operation.speeds hold the rated speed")]
    return []
