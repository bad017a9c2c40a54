"""What a rule reads: the study, its system and the results that were computed."""

import math

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import SAME_SPEED, Steady
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, Path
from torsion.fields import Declared
from torsion.findings import Results
from torsion.study import Study


def vibration(evidence: Results) -> tuple[Response, Synthesis]:
    """The response over speed and its synthesis; raises LookupError where they were not computed."""
    return evidence.need(Response), evidence.need(Synthesis)


def spans_of(system: System, part: int) -> IntArray:
    """(spans of the part,) positions of the spans that a component was made into, from driving to driven."""
    return np.flatnonzero(system.span_part == part)


def rated_torque(evidence: Results, spans: IntArray) -> FloatArray | None:
    """(spans,) N m: magnitude of the mean torque at the rated speed; None where it is not known.

    Between computed speeds the torque is taken linear in the squared speed for the propeller law, which is exact.
    """
    steady, rated = evidence.get(Steady), evidence.study.operation.rated
    if steady is None or rated is None:
        return None
    first, last = steady.speed[0], steady.speed[-1]
    if not first * (1 - SAME_SPEED) <= rated.speed <= last * (1 + SAME_SPEED):
        return None
    power = 2 if evidence.study.operation.load == "propeller" else 1
    rows = [np.interp(rated.speed**power, steady.speed**power, steady.torque[span]) for span in spans]
    return np.asarray(np.abs(np.array(rows)))


def rule_path(study: Study, asked: Declared) -> Path:
    """Where the rule with these settings stands in the file."""
    for position, (_, settings) in enumerate(study.rules):
        if settings is asked:
            return ("rules", position)
    return ("rules",)


def vibration_faults(study: Study, asked: Declared, rule: str) -> list[Fault]:
    """What the file lacks for any rule that reads the response over speed."""
    found = []
    if study.operation.speeds is None:
        hint = "speeds: {from: 300 rpm, to: 1800 rpm}"
        found.append(Fault(("operation", "speeds"), f"`speeds` is missing; {rule} judges a speed range", hint))
    if not study.excites:
        hint = "give an excitation, or leave the rule out"
        found.append(Fault(rule_path(study, asked), f"nothing excites the train, so {rule} has nothing to judge", hint))
    return found


def coverage(last: float, rated: float, needed: float = 1.0) -> str:
    """That the speeds end below a share of the rated speed up to which is judged; empty where they do not; rad/s."""
    if last >= needed * rated * (1 - SAME_SPEED):
        return ""
    return f"judged up to {in_rpm(last)} only, {last / rated:.3g} of the rated speed"


def in_rpm(speed: float) -> str:
    """A speed in words, per minute."""
    return f"{speed * 30.0 / math.pi:.5g} rpm"
