"""Base of the rules that limit the stress of shafts over the speed ratio: continuous use, barred ranges, what is above.

The stress amplitude is the half range of the synthesis of all orders, nominal on the plain section.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import Fault
from torsion.findings import Results
from torsion.rules import barred_time, of_study, rule_over_speed
from torsion.rules.demands import (
    BARRED_BELOW,
    START,
    distinct,
    in_rpm,
    restricted,
    with_reach,
)
from torsion.rules.m68_shafts import M68Settings
from torsion.rules.over_tolerances import over_tolerances
from torsion.rules.rule_over_speed import (
    MOSTLY,
    RATED,
    Clause,
    Curve,
    RuleOverSpeed,
    UseSettings,
    curve_of,
    judge_clause,
    rated_speed,
    spans_of,
    worst_of,
)
from torsion.rules.shaft_limits import (
    NEAR_LIMIT,
    ROUNDING,
    LimitedShaft,
    Mark,
    barred_range,
    may_be_barred,
    nominal_stress,
)
from torsion.rules.verdict_line import BarredRange, Check, Verdict
from torsion.study import Study

STRESS = "Torsional stress amplitude, continuous operation"
PASSING = "Torsional stress amplitude, passing a barred range"
ABOVE = "Torsional stress amplitude above the last speed with a limit"
SUBJECT = "Torsional stress amplitude"  # of the rows about speeds that were not computed


class Limits(NamedTuple):
    """Stress amplitude of a shaft and its limits over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    tau_c: FloatArray  # (speeds,) N/mm2 in continuous use, NaN where there is no limit
    tau_t: FloatArray  # (speeds,) N/mm2 while a barred range is passed, NaN where none is permitted
    tau: FloatArray  # (speeds,) N/mm2, half range of the synthesis


@dataclass(frozen=True)
class Barring:
    """What is to be barred for the stress above its limit, and where the rule permits it."""

    permitted: tuple[BarredRange, ...]  # ascending and apart
    refused: tuple[BarredRange, ...]  # those that reach 0.8 of the rated speed, ascending and apart
    passed: BoolArray  # (speeds,) inside a permitted range, and not above the limit within a refused one


@dataclass(frozen=True)
class Stressed:
    """A shaft with its stress against the limit of continuous use, and what is barred."""

    shaft: LimitedShaft
    spans: IntArray
    curve: Curve
    tau_t: FloatArray  # (speeds,) N/mm2, the limit of passing a barred range
    barred: Barring
    ruled: dict[str, BoolArray]  # by clause (speeds,) where it holds

    @property
    def is_ruled(self) -> BoolArray:
        """(speeds,) true where the rule has a limit."""
        return np.isfinite(self.curve.limit)


class ShaftStress(RuleOverSpeed[M68Settings]):
    """Base of the rules that limit the stress of shafts over the speed ratio."""

    title = ""  # as reports cite it
    mark: Mark = "rule text"  # of where its limits end
    begin = START

    def shafts(self, study: Study) -> Iterator[LimitedShaft]:
        """Yield every shaft that is judged, with its limits."""
        return iter(())

    def faults(self, study: Study) -> list[Fault]:
        """Return what the file lacks for any of these rules."""
        faults = self.vibration_faults(study)
        if study.operation.rated is None:
            message = f"`rated` is missing; the limits of {self.name} count from it"
            faults.append(Fault(("operation", "rated"), message, RATED))
        return faults

    def speeds(self, study: Study) -> tuple[float, ...]:
        """Return in rad/s the rated speed, and those at which the limits bend or end."""
        corners = {share for shaft in self.shafts(study) for share in shaft.curve.corners}
        return tuple(share * rated_speed(study) for share in sorted(corners))

    def speeds_between(self, evidence: Results) -> FloatArray:
        """Return (speeds,) rad/s between those computed: where a shaft may be worse, and the ends of its barred ranges."""
        curves, ends = list[tuple[Curve, BoolArray]](), list[float]()
        for stressed in self.stressed(evidence):
            curve, is_ruled, barred = stressed.curve, stressed.is_ruled, stressed.barred
            curves += [(curve, is_ruled), (curve, is_ruled & ~barred.passed)]
            ends += [end for band in barred.permitted for end in (band.lower, band.upper)]
        speeds = np.union1d(rule_over_speed.between(curves), ends)
        return np.union1d(speeds, super().speeds_between(evidence))

    def stressed(self, evidence: Results) -> Iterator[Stressed]:
        """Yield every shaft against its limits."""
        response, rated = evidence.need(Response), rated_speed(evidence.study)
        for shaft in self.shafts(evidence.study):
            speed, tau_c, tau_t, tau = limits_of(evidence, shaft)
            curve = curve_of(response, tau, tau_c)
            barred = Barring((), (), np.zeros(len(speed), dtype=bool))
            if shaft.curve.passing is not None:
                barred = barring(curve, rated, shaft.name, self.settings.tachometer)
            spans = spans_of(evidence.system, shaft.part)
            yield Stressed(shaft, spans, curve, tau_t, barred, shaft.curve.ranges(speed / rated))

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Return the checks of every shaft: in continuous use, passing barred ranges, and above the last limit."""
        checks = list[Check]()
        for stressed in self.stressed(evidence):
            for check in self.stresses(evidence, stressed):
                checks += with_reach(
                    conditioned(check, stressed.shaft),
                    evidence.study,
                    self.scope,
                    subject=SUBJECT,
                    begin=self.begin,
                )
            checks += self.beyond_stress(evidence, stressed.shaft)
        return distinct((*checks, *super().judge(evidence)))

    def beyond_stress(self, evidence: Results, shaft: LimitedShaft) -> Iterator[Check]:
        """Yield what is judged of a shaft beside its stress, behind that."""
        return iter(())

    def stresses(self, evidence: Results, stressed: Stressed) -> Iterator[Check]:
        """Yield the checks of the stress amplitude of one shaft.

        Outside the permitted barred ranges it is at most the limit of continuous use, in them that of passing, which
        no keyway allows; the greatest stress above the last limit is stated.
        """
        shaft, curve, barred = stressed.shaft, stressed.curve, stressed.barred
        refusal = ""
        if barred.refused:
            critical = " and ".join(in_rpm(band.critical) for band in barred.refused)
            refusal = (
                f"the stress exceeds {' or '.join(stressed.ruled)} about {critical}: no barred range is permitted "
                f"there (lambda >= {BARRED_BELOW:g}): detune; it would run from {_words(barred.refused)}"
            )
        outside = f"outside the barred range {_words(barred.permitted)}" if barred.permitted else ""
        notes = MOSTLY, refusal, outside, *shaft.notes
        for clause, ruled in stressed.ruled.items():
            name, within = (clause, STRESS), ruled & ~barred.passed
            yield from self._judge_at(evidence, stressed, name, curve.limit, within, notes)
        if shaft.curve.passing is not None:
            yield from self._passing(evidence, stressed, shaft.curve.passing.clause)
        yield from self._above(evidence, stressed)

    def _judge_at(
        self,
        evidence: Results,
        stressed: Stressed,
        name: tuple[str, str],
        limit: FloatArray,
        within: BoolArray,
        notes: tuple[str, ...],
    ) -> Iterator[Check]:
        """Yield the check of a stress at the worst of some speeds, if there are any; name: clause and what is compared."""
        (clause, what), shaft = name, stressed.shaft
        curve = replace(stressed.curve, limit=limit)
        about = clause, shaft.name, what, shaft.standing, curve, within
        row = Clause(*about, "N/mm2", notes, stressed.spans)
        if (check := judge_clause(self.name, row, evidence)) is not None:
            yield check

    def _passing(self, evidence: Results, stressed: Stressed, clause: str) -> Iterator[Check]:
        """Yield the check of the stress while the barred ranges are passed, with these ranges; nothing without them."""
        permitted, meter = stressed.barred.permitted, self.settings.tachometer
        keyways = tuple(
            f"{feature}: keyways are not for use with a barred range"
            for feature in stressed.shaft.keyways
        )
        times = barred_time.barred_times(evidence, permitted)
        notes = (
            *keyways,
            f"barred range {_words(permitted)}, to be passed rapidly",
            f"tachometer tolerance {100 * meter:.3g} % {'added' if meter else 'assumed'}",
            MOSTLY,
            barred_time.words(times),
        )
        name, within = (clause, PASSING), stressed.barred.passed
        for check in self._judge_at(evidence, stressed, name, stressed.tau_t, within, notes):
            rated, ranges = rated_speed(evidence.study), list[BarredRange]()
            for band in permitted:
                # The order with the greatest torque in the shaft at the critical speed.
                row = int(np.argmin(np.abs(stressed.curve.speed - band.critical)))
                main = rule_over_speed.main_component(evidence, row, stressed.spans)
                ordered = replace(band, order=None if main is None else main.order)
                ranges.append(over_tolerances(evidence, ordered, rated, meter))
            met: Verdict = "restricted" if check.verdict == "pass" else check.verdict
            verdict: Verdict = "fail" if keyways else met
            yield replace(check, verdict=verdict, barred=tuple(ranges), times=times)

    def _above(self, evidence: Results, stressed: Stressed) -> Iterator[Check]:
        """Yield the stress above the last limit: a restriction, or NOT JUDGED if the file has continuous use there."""
        curve = stressed.shaft.curve
        last = curve.last * rated_speed(evidence.study)
        share = f"{curve.last:g} of the rated speed"
        without = (
            f"no continuous operation above {in_rpm(last)}, {share}: the rule has no limit there"
        )
        name, unlimited = (curve.pieces[-1].clause, ABOVE), np.ones(len(stressed.curve.speed))
        # Continuous use is stated by any rule, or by the highest speed of the train.
        highest = [evidence.study.operation.highest or 0.0]
        for _, settings in evidence.study.rules:
            if isinstance(settings, UseSettings) and settings.continuous is not None:
                highest.append(settings.continuous.last)
        beyond = ~stressed.is_ruled
        for check in self._judge_at(evidence, stressed, name, unlimited, beyond, (without,)):
            bare = replace(check, limit=math.nan, standing=self.mark)
            if max(highest) > last * (1 + ROUNDING):
                yield replace(bare, verdict="not judged")
            else:
                yield replace(bare, verdict="restricted", restrictions=(without,))


def conditioned(check: Check, shaft: LimitedShaft) -> Check:
    """Return a check of a stress with the conditions of its limit: NOT JUDGED if one is broken, else restricted."""
    if check.fails or not check.has_limit:
        return check
    if shaft.doubts:
        note = "; ".join(filter(None, (*shaft.doubts, check.note)))
        return replace(check, verdict="not judged", note=note)
    passing = shaft.curve.passing
    is_passing = passing is not None and check.clause == passing.clause
    is_near = is_passing or (check.utilisation or 0.0) > NEAR_LIMIT
    return restricted(check, *shaft.restrictions, *(shaft.near_limit if is_near else ()))


def limits_of(evidence: Results, shaft: LimitedShaft) -> Limits:
    """Return stress and limits of one shaft over speed."""
    response, torque = evidence.need(Response), evidence.need(Synthesis).half_range
    _, tau = nominal_stress(evidence.system, shaft.part, torque)
    ratio, curve = response.speed / rated_speed(evidence.study), shaft.curve
    return Limits(response.speed, curve.continuous(ratio), curve.while_passing(ratio), tau)


def judging(evidence: Results, shaft: str) -> tuple[ShaftStress, LimitedShaft]:
    """Return the first rule of the file that limits the stress of a shaft, and its limits; raises KeyError if none does."""
    for rule in of_study(evidence.study):
        if isinstance(rule, ShaftStress):
            for limited in rule.shafts(evidence.study):
                if limited.name == shaft:
                    return rule, limited
    raise KeyError(shaft)


def _words(ranges: tuple[BarredRange, ...]) -> str:
    return " and ".join(f"{in_rpm(barred.lower)} to {in_rpm(barred.upper)}" for barred in ranges)


def barring(curve: Curve, rated: float, shaft: str, tolerance: float = 0.0) -> Barring:
    """Return the barred ranges for stress over speed against its limit; rated in rad/s.

    A run of speeds above it has its critical speed at its worst, wherever that lies; the range about it is refused
    where its upper end reaches 0.8 of the rated speed. Both ends move apart by the `tolerance` of the tachometer.
    """
    share, permitted, refused = curve.utilisation(), list[BarredRange](), list[BarredRange]()
    passed, above = np.zeros((2, len(curve.speed)), dtype=bool)
    exceeds = np.isfinite(curve.limit) & (share > 1.0)
    edges = np.flatnonzero(np.diff(exceeds, prepend=False, append=False))
    for first, end in edges.reshape(-1, 2).tolist():
        critical = float(curve.speed[first + worst_of(share[first:end], curve.value[first:end])])
        formula = barred_range(critical, rated)
        lower = min(formula[0], _crossing(curve, first, first - 1)) * (1.0 - tolerance)
        upper = max(formula[1], _crossing(curve, end - 1, end)) * (1.0 + tolerance)
        is_permitted = bool(may_be_barred(upper / rated))
        ranges = permitted if is_permitted else refused
        ranges.append(BarredRange(lower, upper, critical, shaft, *formula))
        above[first:end] |= not is_permitted
    merged = _merged(curve, permitted)
    for barred in merged:
        passed |= (curve.speed > barred.lower) & (curve.speed < barred.upper)
    return Barring(merged, _merged(curve, refused), passed & ~above)


def _merged(curve: Curve, ranges: list[BarredRange]) -> tuple[BarredRange, ...]:
    """Return ascending ranges, those that overlap as one about the worst of their critical speeds."""
    merged: list[BarredRange] = []
    for barred in ranges:
        if not merged or barred.lower > merged[-1].upper:
            merged.append(barred)
            continue
        pair = merged.pop(), barred
        rows = [int(np.flatnonzero(curve.speed == band.critical)[0]) for band in pair]
        worse = pair[worst_of(curve.utilisation()[rows], curve.value[rows])]
        lower, upper = min(band.lower for band in pair), max(band.upper for band in pair)
        merged.append(replace(worse, lower=lower, upper=upper))
    return tuple(merged)


def _crossing(curve: Curve, above: int, beyond: int) -> float:
    """Return the speed between two neighbours at which the stress meets its limit, by a straight line.

    The flank of a resonance is hollow, so the line errs toward the wider range. The far neighbour where a value is not
    finite.
    """
    if not 0 <= beyond < len(curve.speed):
        return float(curve.speed[above])
    share = curve.utilisation()[[above, beyond]]
    if not np.all(np.isfinite(share)):
        return float(curve.speed[beyond])
    step = (share[0] - 1.0) / (share[0] - share[1])
    return float(curve.speed[above] + step * (curve.speed[beyond] - curve.speed[above]))
