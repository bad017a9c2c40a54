"""A rule over speed: what it reads, its clauses, the worst point of each against its limit, and the speeds of these."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from torsion import fields
from torsion.analyses.power_balance import power_balance, rated_power
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.grid import apart, missed_peaks
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.speed_tables import SAME_SPEED
from torsion.analyses.steady import Steady
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault
from torsion.fields import given, required
from torsion.findings import Results
from torsion.kernels.tree_response import Status
from torsion.primitives import Torque
from torsion.rules import needed as read_by_rules
from torsion.rules import of_study
from torsion.rules.reached_speeds import BARRED_BELOW, demanded_study, distinct, in_rpm, with_reach
from torsion.rules.verdict_line import Check, Rule, RuleSettings, Standing, verdict_of
from torsion.study import Operation, Range, Study

FEWEST_JUDGED = 201  # evenly spaced over the range, as many as a file has that names no number
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
        """(speeds,) value / limit; infinite where the response is not ok or the limit negative, 0 where both are 0."""
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
    spans: IntArray = field(
        default_factory=lambda: np.flatnonzero(())
    )  # whose vibration it is; none of a mean torque
    size: FloatArray | None = (
        None  # (speeds, lines) of every harmonic component; None: of the torque in the spans
    )
    infinite_fails: bool = False  # an infinite value is one that runs away, not one that is missing
    if_kept: bool = False  # a value beyond the limit is judged otherwise, as in a barred range


class Continuous(Range):
    """Speeds of the component `operation.at` at which the train is run for long."""

    first: fields.Speed = required("lowest speed", alias="from")
    last: fields.Speed = required("highest speed", alias="to")


class UseSettings(RuleSettings):
    """Settings of a rule with a range of continuous use."""

    continuous: Continuous | None = given("speeds of continuous use: {from, to} (default: all)")


Settings = TypeVar("Settings", bound=RuleSettings)


class RuleOverSpeed(Rule[Settings]):
    """Base of the rules whose clauses each judge the worst point of a value over speed, some in continuous use."""

    needs: tuple[str, ...] = ("steady", "response")
    begin: float = BARRED_BELOW  # speed ratio from which it is to be judged
    has_limits_outside_use = (
        False  # of the same values, so that continuous use at the rated speed leaves none out
    )

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
        """Yield what the rule judges."""
        return iter(())

    def settling(self, evidence: Results) -> Iterator[Clause]:
        """Yield what says all of a train that keeps it, each speed by itself."""
        return self.clauses(evidence)

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Return a check for every clause that has a speed."""
        checks, rated = list[Check](), evidence.study.operation.rated
        has_rated = rated is not None and bool(within(self.use, np.array([rated.speed]))[0])
        for clause in self.clauses(evidence):
            check = judge_clause(self.name, clause, evidence)
            if check is None:
                continue
            judges_all = clause.within.all() or (self.has_limits_outside_use and has_rated)
            checks += with_reach(
                check,
                evidence.study,
                self.scope,
                clause.curve.speed,
                None if judges_all else self.use,
                begin=self.begin,
            )
        return distinct(checks)

    def speeds(self, study: Study) -> tuple[float, ...]:
        """Return in rad/s the rated speed and the ends of continuous use."""
        rated = study.operation.rated
        speeds = () if rated is None else (rated.speed,)
        return speeds if self.use is None else (*speeds, self.use.first, self.use.last)

    def speeds_between(self, evidence: Results) -> FloatArray:
        """Return (speeds,) rad/s between those computed at which a vibration may be worse."""
        clauses = self.clauses(evidence)
        return between((clause.curve, clause.within) for clause in clauses if clause.spans.size)

    def vibration_faults(self, study: Study) -> list[Fault]:
        """Return what the file lacks for any rule that reads the response over speed."""
        faults = []
        operation, train = study.operation, study.train
        if operation.speeds is None:
            message = f"`speeds` is missing; {self.name} judges a speed range"
            hint = "speeds: {from: 300 rpm, to: 1800 rpm}"
            faults.append(Fault(("operation", "speeds"), message, hint))

        acting = [torque for torque in train.torques if _acts(torque)]
        if not study.excites or not (acting or any(mesh.error for mesh in train.constraints)):
            reason = "nothing excites the train by order or at a frequency of its own"
            if study.excites:
                reason = "every excitation of the train is 0"
            message = f"{reason}, so {self.name} has nothing to judge"
            hint = "give an excitation, or leave the rule out"
            faults.append(Fault(self.path(study), message, hint))

        for torque in acting:
            part = train.parts[train.stations[torque.station].part]
            if part.is_opposed:
                message = f"what acts at '{part.name}' moves the halves unlike, and {self.name} judges both by their mean"
                hint = "leave it out of what is judged, as by a case with other `rules`, and judge its torques by hand"
                faults.append(Fault(torque.path, message, hint))

        return faults + self.continuous_faults(study)

    def continuous_faults(self, study: Study) -> list[Fault]:
        """Return the fault of a range of continuous use that was not wholly computed, and cannot be judged."""
        speeds, use = study.operation.speeds, self.use
        if use is None or speeds is None or within(speeds, np.array([use.first, use.last])).all():
            return []
        computed = f"computed: {in_rpm(speeds.first)} to {in_rpm(speeds.last)}"
        path = (*self.path(study), self.name, "continuous")
        return [Fault(path, "the speeds of continuous use leave operation.speeds", computed)]


def curve_of(found: Response | Steady, value: FloatArray, limit: float | FloatArray) -> Curve:
    """The values (speeds,) against a limit, with the worst status of any harmonic component of a response."""
    status = np.zeros(len(found.speed), dtype=np.int64)
    if isinstance(found, Response):
        status = np.asarray(np.max(found.status, axis=1, initial=Status.OK), dtype=np.int64)
    return Curve(found.speed, value, np.broadcast_to(limit, value.shape), status)


def judge_clause(rule: str, clause: Clause, evidence: Results) -> Check | None:
    """The check at the worst of the speeds that are judged; None where there is no speed.

    A singular response fails. A value that is missing for another reason is not judged.
    """
    curve = clause.curve
    if not np.any(clause.within):
        return None
    share = np.where(clause.within, curve.utilisation(), -np.inf)
    is_unknown = np.isnan(curve.value) if clause.infinite_fails else ~np.isfinite(curve.value)
    is_missing = (curve.status == Status.OK) & is_unknown
    is_exceeded = ~is_missing & (share > 1.0)
    if np.any(
        is_exceeded
    ):  # a limit that is exceeded somewhere fails whatever is missing elsewhere
        share = np.where(is_exceeded, share, -np.inf)
    at = worst_of(share, curve.value)
    is_known = curve.status[at] == Status.OK and not is_missing[at]
    main = main_component(evidence, at, clause.spans, clause.size)
    said = "" if main is None else f"{MOSTLY} {main.words}"
    notes = [
        *(said if note == MOSTLY else note for note in clause.notes),
        *_exact_words(evidence, clause, at),
    ]
    doubt = _doubt(evidence, clause)
    return Check(
        rule,
        clause.clause,
        clause.where,
        clause.what,
        value=float(curve.value[at]) if is_known else math.nan if is_missing[at] else math.inf,
        limit=float(curve.limit[at]),
        unit=clause.unit,
        verdict="not judged"
        if is_missing[at]
        else verdict_of(bool(share[at] <= 1.0), clause.standing)
        if is_known and not doubt
        else "fail",
        standing=clause.standing,
        speed=float(curve.speed[at]),
        order=None if main is None else main.order,
        note="; ".join(note for note in (_status_words(curve, at), *notes, doubt) if note),
    )


def _exact_words(evidence: Results, clause: Clause, at: int) -> Iterator[str]:
    """What the exact motion at the peaks of nonlinear couplings did to a vibration; nothing where it did nothing."""
    if evidence.study.train.has_nonlinear_couplings:
        from torsion.rules.beside_exact_motion import words

        yield words(evidence, clause.spans, float(clause.curve.speed[at]))


def _doubt(evidence: Results, clause: Clause) -> str:
    """Why no vibration of a train with nonlinear couplings passes, with the first speed; empty where it may."""
    if not (evidence.study.train.has_nonlinear_couplings and clause.spans.size):
        return ""
    from torsion.rules.beside_exact_motion import UNPROVEN, unproven

    found = np.flatnonzero(unproven(evidence) & clause.within)
    return UNPROVEN.format(speed=in_rpm(float(clause.curve.speed[found[0]]))) if found.size else ""


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
    return missed_peaks(
        speed, np.array(shares).T[:, None, :], np.ones(len(speed), dtype=bool)[:, None]
    )[0]


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


def main_component(
    evidence: Results, at: int, spans: IntArray, sizes: FloatArray | None = None
) -> Line | None:
    """The greatest harmonic component at a speed, of the torque in the spans or of `sizes`; None where not known."""
    if not spans.size:
        return None
    response = evidence.need(Response)
    size = np.abs(response.torque[at][:, spans]).max(axis=1) if sizes is None else sizes[at]
    known = bool(np.all(np.isfinite(size)) and np.any(size > 0))
    return response.lines[int(np.argmax(size))] if known else None


def named_speeds(study: Study) -> FloatArray:
    """(speeds,) rad/s, ascending: at which a rule of the study, or a table of torque, bends or begins."""
    named = [speed for rule in _vibration_rules(study) for speed in rule.speeds(study)]
    return np.unique([*named, *_corners(study)])


def analyses_read(study: Study) -> frozenset[str]:
    """The analyses that the study's rules read."""
    return read_by_rules(study)


def are_pointwise(study: Study) -> bool:
    """All that the rules of the study say of a train that keeps their limits are clauses at each speed by itself."""
    rules = list(of_study(study))
    rows = (row for rule in rules for row in rule.demanded_rows(study))
    return (
        all(rule.is_pointwise for rule in rules)
        and all(row.verdict in ("pass", "restricted") for row in rows)
        and (not study.operation.load.table or demanded_study(study) is None)
    )


def judged_band(study: Study) -> tuple[float, float]:
    """rad/s: the first speed of the operation, and the last that it has or a rule demands above it."""
    speeds, above = study.operation.speeds, demanded_study(study)
    if speeds is None:
        raise ValueError("no speeds")
    last = (
        speeds.last
        if above is None or above.operation.speeds is None
        else above.operation.speeds.last
    )
    return speeds.first, last


def pointwise(evidence: Results) -> Iterator[tuple[str, Clause]]:
    """Every such clause with the name of its rule."""
    above, speeds = demanded_study(evidence.study), evidence.study.operation.speeds
    demanding = set() if above is None else {name for name, _ in above.rules}
    for rule in of_study(evidence.study):
        if not isinstance(rule, RuleOverSpeed):
            continue
        for clause in rule.settling(evidence):
            # what another rule demands above the operation is no speed of this one
            judged = (
                clause.within
                if rule.name in demanding
                else clause.within & within(speeds, clause.curve.speed)
            )
            if np.any(judged):
                yield rule.name, replace(clause, within=judged)


def judged_speeds(study: Study) -> FloatArray:
    """(speeds,) rad/s, ascending, in the range of the operation: what its rules need beyond the speeds requested."""
    speeds = study.operation.speeds
    if speeds is None:
        return np.empty(0)
    found = named_speeds(study)
    even = np.linspace(speeds.first, speeds.last, FEWEST_JUDGED)
    if speeds.steps < FEWEST_JUDGED:
        found = np.union1d(found, apart(found, even)) if found.size else even
    return np.asarray(found[(found >= speeds.first) & (found <= speeds.last)])


def speeds_between(evidence: Results) -> FloatArray:
    """(speeds,) rad/s, ascending, not yet computed, at which a rule may find more than at those beside them."""
    speed = evidence.need(Response).speed
    between = [rule.speeds_between(evidence) for rule in _vibration_rules(evidence.study)]
    further = np.unique(np.concatenate([np.empty(0), *between]))
    return apart(speed, further[(further > speed[0]) & (further < speed[-1])])


def _vibration_rules(study: Study) -> Iterator[Rule[Any]]:
    """Yield the study's rules that read the response over speed."""
    return (rule for rule in of_study(study) if "response" in rule.needs)


def _corners(study: Study) -> list[float]:
    """rad/s of the reference station at the rows of every table of torque, between which it is straight."""
    stations, torques = study.train.stations, study.train.torques
    own = [
        row[0] / float(stations[torque.station].ratio) for torque in torques for row in torque.table
    ]
    return (
        [*own, *power_balance(study.train, study.operation).corners]
        if study.has_mean_torque
        else own
    )


def within(use: Range | None, speed: FloatArray) -> BoolArray:
    """(speeds,) which speeds lie in a range, but for rounding; all where there is none."""
    if use is None:
        return np.ones(len(speed), dtype=bool)
    return (speed >= use.first * (1 - SAME_SPEED)) & (speed <= use.last * (1 + SAME_SPEED))


def spans_of(system: System, part: int) -> IntArray:
    """(spans of the part,) positions of the spans that a component was made into, from driving to driven."""
    return np.flatnonzero(system.span_part == part)


def rated_torque(evidence: Results) -> FloatArray | None:
    """(spans,) N m: magnitude of the mean torque at the rated speed, which is computed; None where it is not known."""
    known, rated, law = (
        evidence.get(Steady),
        evidence.study.operation.rated,
        evidence.study.operation.load,
    )
    if known is None or rated is None:
        return None
    first, last = known.speed[0], known.speed[-1]
    if not first * (1 - SAME_SPEED) <= rated.speed <= last * (1 + SAME_SPEED):
        return None
    power = law.exponent if law.exponent > 0 and not law.table else 1.0
    rows = [np.interp(rated.speed**power, known.speed**power, torque) for torque in known.torque]
    return np.asarray(np.abs(np.array(rows)))


def full_torque(evidence: Results) -> FloatArray | None:
    """(spans,) N m at the rated speed, of the full power at least: what the train carries with less is scaled up.

    That is `rated.power`, or what all loads take when every cylinder fires. A table of the load may give less, and an
    engine with a cylinder that does not fire. Where nothing is carried there, every span has the whole rated power.
    """
    every, known, rated = (
        rated_torque(evidence),
        evidence.get(Steady),
        evidence.study.operation.rated,
    )
    power = rated_power(evidence.study)
    if every is None or known is None or rated is None or power is None:
        return every
    at = int(np.argmin(np.abs(known.speed - rated.speed)))
    ratios = np.array([abs(float(station.ratio)) for station in evidence.system.stations])[
        : len(known.applied)
    ]
    carried = float(np.maximum(known.applied[:, at], 0.0) @ ratios) * rated.speed
    whole = power / rated.speed / np.abs(evidence.system.span_ratio)
    if carried > 0:
        return every * max(1.0, power / carried)
    return every if np.any(every) else np.asarray(whole)


def share_of_rated(operation: Operation) -> float:
    """Rated torque over what a table of load gives at the rated speed, at most 1: a larger load is no better rating."""
    rated, table = operation.rated, operation.load.table
    if not table or rated is None or rated.power is None:
        return 1.0
    there = abs(float(np.interp(rated.speed, [row[0] for row in table], [row[1] for row in table])))
    return min(1.0, rated.power / rated.speed / there) if there else 1.0


def knows_rated_torque(study: Study) -> bool:
    """The mean torque at the rated speed is known."""
    return study.operation.rated is not None and study.has_mean_torque


def rated_speed(study: Study) -> float:
    """rad/s of the reference station; raises ValueError where the study has none."""
    if study.operation.rated is None:
        raise ValueError("the rule needs the rated speed")
    return study.operation.rated.speed


def _acts(torque: Torque) -> bool:
    """A torque by order or at a frequency has an amplitude."""
    of_speed = any(row[1] for row in torque.table)
    return torque.cylinder is not None or of_speed or bool(torque.torque or torque.of_mean)
