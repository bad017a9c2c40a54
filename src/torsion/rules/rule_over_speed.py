"""A rule over speed: what it reads, its clauses, the worst point of each against its limit, and the speeds of these."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from torsion import fields
from torsion.analyses.power_balance import SAME_SPEED, power_balance, rated_power
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.grid import apart, missed_peaks
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.steady import Steady
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault
from torsion.fields import given, required
from torsion.findings import Results
from torsion.kernels.trees.tree_response import Status
from torsion.rules import needed, of_study
from torsion.rules.demands import BARRED_BELOW, distinct, in_rpm, with_reach
from torsion.rules.verdict_line import (
    Check,
    Rule,
    RuleSettings,
    Settings,
    Standing,
    Verdict,
    verdict_of,
)
from torsion.study import Range, Study

FEWEST_JUDGED = 201  # evenly spaced over the range, as many as a file has that names no number
OBVIOUS = 100.0  # times its limit: a larger value needs no sharper place
RATED = "rated: {speed: 1500 rpm, power: 100 kW}"  # what to write into the file
MOSTLY = "mostly"  # note that stands for the harmonic component of the greatest torque
analyses_read = needed  # the name under which an analysis calls it
NO_SPANS = np.empty(0, dtype=np.int64)


@dataclass(frozen=True)
class Curve:
    """A value and its limit over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    value: FloatArray  # (speeds,)
    limit: FloatArray  # (speeds,) NaN where the rule has no limit
    status: IntArray  # (speeds,) kernels.tree_response.Status of the worst line

    def utilisation(self) -> FloatArray:
        """Return (speeds,) value / limit; infinite where the response is not ok or the limit negative, 0 where both are 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(self.limit < 0, np.inf, self.value / self.limit)
        share[(self.value == 0) & (self.limit == 0)] = 0.0
        return np.where((self.status != Status.OK) | ~np.isfinite(self.value), np.inf, share)


@dataclass(frozen=True)
class Clause:
    """What a verdict is about: a value over speed, its limit, and where it is judged."""

    clause: str
    where: str
    what: str
    standing: Standing  # of its limit
    curve: Curve
    within: BoolArray  # (speeds,) speeds that are judged
    unit: str = "N m"
    notes: tuple[str, ...] = ()  # empty ones are left out
    spans: IntArray = field(default_factory=NO_SPANS.copy)  # that vibrate; none of a mean torque
    size: FloatArray | None = None  # (speeds, lines) of harmonic components, if not the torque
    infinite_fails: bool = False  # an infinite value is one that runs away, not one that is missing


class Continuous(Range):
    """Speeds of the component `operation.at` at which the train is run for long."""

    first: fields.Speed = required("lowest speed", alias="from")
    last: fields.Speed = required("highest speed", alias="to")


class UseSettings(RuleSettings):
    """Settings of a rule with a range of continuous use."""

    continuous: Continuous | None = given("speeds of continuous use: {from, to} (default: all)")


class RuleOverSpeed(Rule[Settings]):
    """Base of the rules whose clauses each judge the worst point of a value over speed, some in continuous use."""

    needs: tuple[str, ...] = ("steady", "response")
    begin: float = BARRED_BELOW  # speed ratio from which it is to be judged
    # The same values have limits outside continuous use too: use at the rated speed leaves none out.
    has_limits_outside_use = False

    @property
    def use(self) -> Continuous | None:
        """The speeds of continuous use; None for all."""
        return self.settings.continuous if isinstance(self.settings, UseSettings) else None

    @property
    def use_words(self) -> str:
        """Which speeds are judged; empty for all."""
        if self.use is None:
            return ""
        return f"in continuous use, {in_rpm(self.use.first)} to {in_rpm(self.use.last)}"

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield the values over speed that the rule compares with limits."""
        return iter(())

    def compare(
        self,
        response: Response,
        name: tuple[str, str, str],
        standing: Standing,
        value: FloatArray,
        limit: float | FloatArray,
        unit: str = "N m",
        *,
        spans: IntArray,
        notes: tuple[str, ...] = (),
        remarks: tuple[str, ...] = (),
        is_judged: BoolArray | None = None,
        size: FloatArray | None = None,
    ) -> Clause:
        """Return a clause that compares a vibration (speeds,) with its limit, in continuous use or where `is_judged`.

        name: clause, component and what is compared. `notes` stand before the main harmonic component, `remarks`
        after it.
        """
        judged, use = is_judged, ""
        if judged is None:
            judged, use = within(self.use, response.speed), self.use_words
        curve, said = curve_of(response, value, limit), (*notes, use, MOSTLY, *remarks)
        return Clause(*name, standing, curve, judged, unit, said, spans, size)

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Return a check for every clause that has a speed."""
        checks, rated = list[Check](), evidence.study.operation.rated
        has_rated = rated is not None and within(self.use, np.array([rated.speed])).all()
        for clause in self.clauses(evidence):
            if (check := judge_clause(self.name, clause, evidence)) is not None:
                is_whole = clause.within.all() or (self.has_limits_outside_use and has_rated)
                use, speed = None if is_whole else self.use, clause.curve.speed
                checks += with_reach(
                    check, evidence.study, self.scope, speed, use, begin=self.begin
                )
        return distinct(checks)

    def speeds(self, study: Study) -> tuple[float, ...]:
        """Return in rad/s the rated speed and the ends of continuous use."""
        rated, use = study.operation.rated, self.use
        named = () if rated is None else (rated.speed,)
        return named if use is None else (*named, use.first, use.last)

    def speeds_between(self, evidence: Results) -> FloatArray:
        """Return (speeds,) rad/s between those computed at which a vibration may be worse."""
        clauses = self.clauses(evidence)
        return between((clause.curve, clause.within) for clause in clauses if clause.spans.size)

    def vibration_faults(self, study: Study) -> Iterator[Fault]:
        """Yield what the file lacks for any rule that reads the response over speed."""
        train = study.train
        if study.operation.speeds is None:
            message = f"`speeds` is missing; {self.name} judges a speed range"
            hint = "speeds: {from: 300 rpm, to: 1800 rpm}"
            yield Fault(("operation", "speeds"), message, hint)

        acting = [  # those by order or at a frequency with an amplitude
            torque
            for torque in train.torques
            if torque.cylinder is not None
            or torque.torque
            or torque.of_mean
            or any(row[1] for row in torque.table)
        ]
        if not study.excites or not (acting or any(mesh.error for mesh in train.constraints)):
            reason = "nothing excites the train by order or at a frequency of its own"
            if study.excites:
                reason = "every excitation of the train is 0"
            message = f"{reason}, so {self.name} has nothing to judge"
            hint = "give an excitation, or leave the rule out"
            yield Fault(self.path(study), message, hint)

        hint = "leave it out of what is judged, as by a case with other `rules`, and judge its torques by hand"
        for torque in acting:
            part = train.parts[train.stations[torque.station].part]
            if part.is_opposed:
                message = f"what acts at '{part.name}' moves the halves unlike, and {self.name} judges both by their mean"
                yield Fault(torque.path, message, hint)
        yield from self.continuous_faults(study)

    def continuous_faults(self, study: Study) -> Iterator[Fault]:
        """Yield the fault of a range of continuous use that was not wholly computed, and cannot be judged."""
        speeds, use = study.operation.speeds, self.use
        if use is None or speeds is None or within(speeds, np.array([use.first, use.last])).all():
            return
        computed = f"computed: {in_rpm(speeds.first)} to {in_rpm(speeds.last)}"
        path = (*self.path(study), self.name, "continuous")
        yield Fault(path, "the speeds of continuous use leave operation.speeds", computed)

    def mean_torque_faults(self, study: Study, compared: str) -> Iterator[Fault]:
        """Yield the fault of a file whose mean torque is not known; compared: what the rule compares, in words."""
        if not study.has_mean_torque:
            message = f"the mean torque is not known, and {self.name} compares {compared}"
            yield Fault(("operation", "rated", "power"), message, RATED)


def curve_of(source: Response | Steady, value: FloatArray, limit: float | FloatArray) -> Curve:
    """Return values (speeds,) against a limit, with the worst status of any harmonic component of a response."""
    status = np.zeros(len(source.speed), dtype=np.int64)
    if isinstance(source, Response):
        status = np.asarray(np.max(source.status, axis=1, initial=Status.OK), dtype=np.int64)
    return Curve(source.speed, value, np.broadcast_to(limit, value.shape), status)


def judge_clause(rule: str, clause: Clause, evidence: Results) -> Check | None:
    """Return the check at the worst of the speeds that are judged; None where there is no speed.

    A singular response fails. A value that is missing for another reason is not judged.
    """
    curve = clause.curve
    if not np.any(clause.within):
        return None
    share = np.where(clause.within, curve.utilisation(), -np.inf)
    is_unknown = np.isnan(curve.value) if clause.infinite_fails else ~np.isfinite(curve.value)
    is_missing = (curve.status == Status.OK) & is_unknown
    is_exceeded = ~is_missing & (share > 1.0)
    # A limit that is exceeded somewhere fails whatever is missing elsewhere.
    if np.any(is_exceeded):
        share = np.where(is_exceeded, share, -np.inf)
    row = worst_of(share, curve.value)
    value, limit, speed = (float(part[row]) for part in (curve.value, curve.limit, curve.speed))

    main, status = (
        main_component(evidence, row, clause.spans, clause.size),
        Status(curve.status[row]),
    )
    mainly = "" if main is None else f"{MOSTLY} {main.words}"
    notes = [mainly if note == MOSTLY else note for note in clause.notes]
    if status != Status.OK:
        word = status.name.lower().replace("_", "-")
        notes.insert(0, f"the response is {word} at {in_rpm(speed)}, which is never a pass")
    elif not math.isfinite(value):
        notes.insert(0, f"no value at {in_rpm(speed)}")
    is_open = np.zeros(len(curve.speed), dtype=bool)
    if evidence.study.train.has_nonlinear_couplings:
        from torsion.rules.class_rules.supplements import UNPROVEN, unproven, words

        notes.append(words(evidence, clause.spans, speed))
        if clause.spans.size and np.any(is_open := unproven(evidence) & clause.within):
            notes.append(UNPROVEN.format(speed=in_rpm(float(curve.speed[is_open][0]))))

    verdict: Verdict = "fail"
    if is_missing[row]:
        value, verdict = math.nan, "not judged"
    elif status != Status.OK:
        value = math.inf
    elif not np.any(is_open):
        verdict = verdict_of(bool(share[row] <= 1.0), clause.standing)
    return Check(
        rule,
        clause.clause,
        clause.where,
        clause.what,
        value,
        limit,
        clause.unit,
        verdict,
        clause.standing,
        speed,
        None if main is None else main.order,
        "; ".join(filter(None, notes)),
    )


def between(curves: Iterable[tuple[Curve, BoolArray]]) -> FloatArray:
    """Return (speeds,) rad/s, ascending: where a share of a limit stands higher than at its neighbours.

    curves: over the same speeds, each with the speeds at which it is judged.
    """
    shares, speed = list[FloatArray](), np.empty(0)
    for curve, judged in curves:
        share, speed = curve.utilisation(), curve.speed
        shares.append(np.where(judged & (share <= OBVIOUS), share, np.nan))
    is_sound = np.ones((len(speed), 1), dtype=bool)
    return missed_peaks(speed, np.array(shares).T[:, None], is_sound)[0] if shares else speed


def worst_of(share: FloatArray, value: FloatArray) -> int:
    """Return the position of the greatest share; among infinite ones that of the greatest value."""
    top = np.flatnonzero(share == np.max(share))
    return int(top[np.argmax(np.where(np.isfinite(value[top]), value[top], np.inf))])


def main_component(
    evidence: Results, row: int, spans: IntArray, sizes: FloatArray | None = None
) -> Line | None:
    """Return the greatest harmonic component at a speed, of the torque in the spans or of `sizes`; None if unknown."""
    if not spans.size:
        return None
    response = evidence.need(Response)
    size = np.abs(response.torque[row][:, spans]).max(axis=1) if sizes is None else sizes[row]
    is_known = bool(np.all(np.isfinite(size)) and np.any(size > 0))
    return response.lines[int(np.argmax(size))] if is_known else None


def judged_speeds(study: Study) -> FloatArray:
    """Return (speeds,) rad/s, ascending, in the range of the operation: what its rules need in addition.

    These are the speeds at which a rule, or a table of torque, bends or begins, and evenly spaced ones of a file
    with few.
    """
    speeds = study.operation.speeds
    if speeds is None:
        return np.empty(0)
    named = [speed for rule in of_study(study) for speed in rule.speeds(study)]
    for torque in study.train.torques:  # straight between two rows of a table
        ratio = float(study.train.stations[torque.station].ratio)
        named += [row[0] / ratio for row in torque.table]
    if study.has_mean_torque:
        named += power_balance(study.train, study.operation).corners
    judged = np.unique(named)
    if speeds.steps < FEWEST_JUDGED:
        even = np.linspace(speeds.first, speeds.last, FEWEST_JUDGED)
        judged = np.union1d(judged, apart(judged, even)) if judged.size else even
    return np.asarray(judged[(judged >= speeds.first) & (judged <= speeds.last)])


def speeds_between(evidence: Results) -> FloatArray:
    """Return (speeds,) rad/s, ascending, not yet computed, at which a rule may find more than at their neighbours."""
    speed = evidence.need(Response).speed
    between = [rule.speeds_between(evidence) for rule in of_study(evidence.study)]
    further = np.unique(np.concatenate([np.empty(0), *between]))
    return apart(speed, further[(further > speed[0]) & (further < speed[-1])])


def within(use: Range | None, speed: FloatArray) -> BoolArray:
    """Return (speeds,) which speeds lie in a range, but for rounding; all where there is none."""
    if use is None:
        return np.ones(len(speed), dtype=bool)
    return (speed >= use.first * (1 - SAME_SPEED)) & (speed <= use.last * (1 + SAME_SPEED))


def spans_of(system: System, part: int) -> IntArray:
    """Return (spans of the part,) positions of the spans that a component was made into, from driving to driven."""
    return np.flatnonzero(system.span_part == part)


def rated_torque(evidence: Results) -> FloatArray | None:
    """Return (spans,) N m: magnitude of the mean torque at the rated speed, if computed there; None if unknown.

    It is that of an engine whose cylinders all fire: what lacks of a misfire is no lower rating.
    """
    steady, operation = evidence.get(Steady), evidence.study.operation
    rated, load = operation.rated, operation.load
    if steady is None or rated is None:
        return None
    first, last = steady.speed[0], steady.speed[-1]
    if not first * (1 - SAME_SPEED) <= rated.speed <= last * (1 + SAME_SPEED):
        return None
    power = load.exponent if load.exponent > 0 and not load.table else 1.0
    rows = [np.interp(rated.speed**power, steady.speed**power, torque) for torque in steady.torque]
    return np.asarray(np.abs(np.array(rows))) / _delivered(evidence.study)


def _delivered(study: Study) -> float:
    """Return the share of the loads that an engine delivers with the cylinders that fire; 1 where none does."""
    return float(power_balance(study.train, study.operation).delivered) or 1.0


def full_torque(evidence: Results) -> FloatArray | None:
    """Return (spans,) N m at the rated speed, of the full power at least: what is carried with less is scaled up.

    That is `rated.power`, or what all loads take. A table of the load may give less. Where nothing is carried there,
    every span has the whole rated power.
    """
    torque, power = rated_torque(evidence), rated_power(evidence.study)
    rated = evidence.study.operation.rated
    if torque is None or rated is None or power is None:
        return torque
    steady, system = evidence.need(Steady), evidence.system
    row = int(np.argmin(np.abs(steady.speed - rated.speed)))
    applied = np.maximum(steady.applied[:, row], 0.0)
    ratios = np.array([abs(float(station.ratio)) for station in system.stations[: len(applied)]])
    carried = float(applied @ ratios) * rated.speed / _delivered(evidence.study)
    if carried > 0:
        return torque * max(1.0, power / carried)
    return torque if np.any(torque) else np.asarray(power / rated.speed / np.abs(system.span_ratio))


def rated_speed(study: Study) -> float:
    """Return rad/s of the reference station; raises ValueError where the study has no rated speed."""
    if study.operation.rated is None:
        raise ValueError("the rule needs the rated speed")
    return study.operation.rated.speed
