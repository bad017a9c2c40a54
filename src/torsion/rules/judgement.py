"""A rule over speed: what it reads, its clauses, and the worst point of each against its limit."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from pydantic import model_validator

from torsion import fields
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.grid import missed_peaks
from torsion.analyses.steady import SAME_SPEED, Steady
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, Path
from torsion.fields import Declared, refuse, required
from torsion.findings import Results
from torsion.kernels.tree_response import Status
from torsion.rules.verdict_line import Check, Rule, Standing, verdict_of
from torsion.study import Study

OBVIOUS = 100.0  # times its limit: a larger value needs no sharper place
RATED = "rated: {speed: 1500 rpm, power: 100 kW}"  # what to write into the file
MOSTLY = "mostly"  # note that stands for the harmonic component of the greatest torque


@dataclass(frozen=True)
class Curve:
    """A value and its limit over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    value: FloatArray  # (speeds,)
    limit: FloatArray  # (speeds,) NaN where the rule has no limit
    status: IntArray  # (speeds,) kernels.tree_response.Status of the worst line

    def utilisation(self) -> FloatArray:
        """(speeds,) value / limit; infinite where the response is not ok, 0 where both are nothing."""
        with np.errstate(divide="ignore", invalid="ignore"):
            share = self.value / self.limit
        share[(self.value == 0) & (self.limit == 0)] = 0.0
        return np.where((self.status != Status.OK) | ~np.isfinite(self.value), np.inf, share)

    def exceeds(self) -> BoolArray:
        """(speeds,) where the limit exists and is not kept."""
        return np.isfinite(self.limit) & (self.utilisation() > 1.0)


@dataclass(frozen=True)
class Clause:
    """What a verdict is about: a value over speed, its limit, and where it is judged."""

    rule: str
    clause: str
    where: str
    what: str
    standing: Standing  # of its limit
    curve: Curve
    within: BoolArray  # (speeds,) speeds that are judged
    unit: str = "N m"
    notes: tuple[str, ...] = ()  # empty ones are left out
    spans: IntArray | None = None  # (spans,) whose vibration it is; None for the mean torque


class RuleOverSpeed(Rule):
    """Base of the rules whose clauses each judge the worst point of a value over speed."""

    needs = ("steady", "response")

    def clauses(self, evidence: Results, settings: Any) -> Iterator[Clause]:
        """What it judges."""
        return iter(())

    def check(self, evidence: Results, settings: Any) -> tuple[Check, ...]:
        """A verdict for every clause that has a speed."""
        found = (judge(clause, evidence) for clause in self.clauses(evidence, settings))
        return tuple(line for line in found if line is not None)

    def speeds(self, study: Study, settings: Any) -> tuple[float, ...]:
        """rad/s: the rated speed and the ends of continuous use."""
        rated, use = study.operation.rated, settings.continuous
        return (*(() if rated is None else (rated.speed,)), *(() if use is None else (use.first, use.last)))

    def speeds_between(self, evidence: Results, settings: Any) -> FloatArray:
        """(speeds,) rad/s between those computed at which a vibration may be worse."""
        every = self.clauses(evidence, settings)
        return between((clause.curve, clause.within) for clause in every if clause.spans is not None)


def curve_of(speed: FloatArray, value: FloatArray, limit: float | FloatArray, of: Response | None = None) -> Curve:
    """The values (speeds,) against a limit, with the worst status of any harmonic component `of` the response."""
    status = np.zeros(len(speed), dtype=np.int64)
    if of is not None:
        status = np.asarray(np.max(of.status, axis=1, initial=Status.OK), dtype=np.int64)
    return Curve(speed, value, np.broadcast_to(limit, value.shape), status)


def judge(clause: Clause, evidence: Results) -> Check | None:
    """The check at the worst of the speeds that are judged; None where there is no speed."""
    curve = clause.curve
    if not np.any(clause.within):
        return None
    share = np.where(clause.within, curve.utilisation(), -np.inf)
    at = worst_of(share, curve.value)
    is_known = curve.status[at] == Status.OK and np.isfinite(curve.value[at])
    notes = [_largest_component(evidence, at, clause.spans) if note == MOSTLY else note for note in clause.notes]
    return Check(
        clause.rule, clause.clause, clause.where, clause.what,
        value=float(curve.value[at]) if is_known else math.inf, limit=float(curve.limit[at]), unit=clause.unit,
        verdict=verdict_of(bool(share[at] <= 1.0), clause.standing) if is_known else "fail",  # whatever the limit
        standing=clause.standing, speed=float(curve.speed[at]),
        note="; ".join(note for note in (_status_words(curve, at), *notes) if note),
    )  # fmt: skip


def between(curves: Iterable[tuple[Curve, BoolArray]]) -> FloatArray:
    """(speeds,) rad/s, ascending: where a share of a limit stands higher than at the computed speeds beside it.

    curves: over the same speeds, each with the speeds at which it is judged.
    """
    shares, speed = [], np.empty(0)
    for curve, within in curves:
        share, speed = curve.utilisation(), curve.speed
        shares.append(np.where(within & (share <= OBVIOUS), share, np.nan))
    if not shares:
        return speed
    share = np.array(shares).T[:, None, :]
    return missed_peaks(speed, share, np.ones((len(speed), 1), dtype=bool))[0]


def worst_of(share: FloatArray, value: FloatArray) -> int:
    """The place of the greatest share; among infinite ones that of the greatest value."""
    top = np.flatnonzero(share == np.max(share))
    return int(top[np.argmax(np.where(np.isfinite(value[top]), value[top], np.inf))])


def _status_words(curve: Curve, at: int) -> str:
    """Why a number is not one to pass on; empty where the response is ok."""
    if curve.status[at] == Status.OK:
        return "" if np.isfinite(curve.value[at]) else f"no value at {in_rpm(curve.speed[at])}"
    word = Status(int(curve.status[at])).name.lower().replace("_", "-")
    return f"the response is {word} at {in_rpm(curve.speed[at])}, which is never a pass"


def _largest_component(evidence: Results, at: int, spans: IntArray | None) -> str:
    """Words for the harmonic component with the greatest torque in the spans at a speed."""
    response = evidence.need(Response)
    size = np.abs(response.torque[at][:, slice(None) if spans is None else spans]).max(axis=1, initial=0.0)
    if not np.all(np.isfinite(size)) or not np.any(size > 0):
        return ""
    return f"{MOSTLY} {response.lines[int(np.argmax(size))].words}"


class Continuous(Declared):
    """Speeds of the component `operation.at` at which the train is run for long."""

    first: fields.Speed = required("lowest speed", alias="from")
    last: fields.Speed = required("highest speed", alias="to")

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if self.first >= self.last:
            raise refuse("`from` is not below `to`", "a range runs from the lower to the higher value", "to")
        return self


def within(use: Continuous | None, speed: FloatArray) -> BoolArray:
    """(speeds,) which speeds are of continuous use."""
    if use is None:
        return np.ones(len(speed), dtype=bool)
    return (speed >= use.first * (1 - SAME_SPEED)) & (speed <= use.last * (1 + SAME_SPEED))


def continuous_words(use: Continuous | None) -> str:
    """Which speeds were judged; empty for the whole range."""
    return "" if use is None else f"in continuous use, {in_rpm(use.first)} to {in_rpm(use.last)}"


def continuous_faults(study: Study, settings: Declared, rule: str, use: Continuous | None) -> list[Fault]:
    """A range of continuous use that was not wholly computed cannot be judged."""
    speeds = study.operation.speeds
    if use is None or speeds is None:
        return []
    if speeds.first * (1 - SAME_SPEED) <= use.first and use.last <= speeds.last * (1 + SAME_SPEED):
        return []
    path = (*rule_path(study, settings), rule, "continuous")
    computed = f"{in_rpm(speeds.first)} to {in_rpm(speeds.last)}"
    return [Fault(path, "the speeds of continuous use leave operation.speeds", f"computed: {computed}")]


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


def rule_path(study: Study, settings: Declared) -> Path:
    """Where the rule with these settings stands in the file."""
    for position, (_, given) in enumerate(study.rules):
        if given is settings:
            return ("rules", position)
    return ("rules",)


def rated_speed(study: Study) -> float:
    """rad/s of the reference station; raises ValueError where the study has none."""
    if study.operation.rated is None:
        raise ValueError("the rule needs the rated speed")
    return study.operation.rated.speed


def vibration_faults(study: Study, settings: Declared, rule: str) -> list[Fault]:
    """What the file lacks for any rule that reads the response over speed."""
    found = []
    if study.operation.speeds is None:
        hint = "speeds: {from: 300 rpm, to: 1800 rpm}"
        found.append(Fault(("operation", "speeds"), f"`speeds` is missing; {rule} judges a speed range", hint))
    if not study.excites:
        hint = "give an excitation, or leave the rule out"
        message = f"nothing excites the train by order or at a frequency of its own, so {rule} has nothing to judge"
        found.append(Fault(rule_path(study, settings), message, hint))
    return found


def coverage(last: float, rated: float, needed: float = 1.0) -> str:
    """That the speeds end below a share of the rated speed up to which is judged; empty where they do not; rad/s."""
    if last >= needed * rated * (1 - SAME_SPEED):
        return ""
    return f"judged up to {in_rpm(last)} only, {last / rated:.3g} of the rated speed"


def in_rpm(speed: float) -> str:
    """A speed in words, per minute."""
    return f"{speed * 30.0 / math.pi:.5g} rpm"
