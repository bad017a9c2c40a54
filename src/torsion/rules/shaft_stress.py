"""Base of the rules that limit the stress of shafts over the speed ratio: continuous use, barred ranges, what is above.

The stress amplitude is the half range of the synthesis of all orders, nominal on the plain section.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import Fault
from torsion.findings import Results
from torsion.rules import barred_time, judgement, of_study
from torsion.rules.judgement import (
    MOSTLY,
    RATED,
    Clause,
    Curve,
    RuleOverSpeed,
    UseSettings,
    curve_of,
    judge_clause,
    rated_speed,
    worst_of,
)
from torsion.rules.m68_shafts import M68Settings
from torsion.rules.over_tolerances import over_tolerances
from torsion.rules.reached_speeds import (
    BARRED_BELOW,
    START,
    distinct,
    in_rpm,
    restricted,
    with_reach,
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
    curve: Curve
    barred: Barring
    ruled: dict[str, BoolArray]  # by clause (speeds,) where it holds

    @property
    def is_ruled(self) -> BoolArray:
        """(speeds,) there is a limit."""
        return np.isfinite(self.curve.limit)


class ShaftStress(RuleOverSpeed[M68Settings]):
    """Base of the rules that limit the stress of shafts over the speed ratio."""

    title = ""  # as reports cite it
    mark: Mark = "rule text"  # of where its limits end
    begin = START

    def shafts(self, study: Study) -> Iterator[LimitedShaft]:
        """Every shaft that is judged, with its limits."""
        return iter(())

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for any of them."""
        found = self.vibration_faults(study)
        if study.operation.rated is None:
            message = f"`rated` is missing; the limits of {self.name} count from it"
            found.append(Fault(("operation", "rated"), message, RATED))
        return found

    def speeds(self, study: Study) -> tuple[float, ...]:
        """rad/s: the rated speed, and those at which the limits bend or end."""
        corners = {share: None for shaft in self.shafts(study) for share in shaft.curve.corners}
        return tuple(share * rated_speed(study) for share in sorted(corners))

    def speeds_between(self, evidence: Results) -> FloatArray:
        """(speeds,) rad/s between those computed: where a shaft may be worse, and the ends of its barred ranges."""
        found, ends = [], list[float]()
        for one in self.stressed(evidence):
            found += [(one.curve, one.is_ruled), (one.curve, one.is_ruled & ~one.barred.passed)]
            ends += [end for band in one.barred.permitted for end in (band.lower, band.upper)]
        return np.union1d(
            np.union1d(judgement.between(found), ends), super().speeds_between(evidence)
        )

    def stressed(self, evidence: Results) -> Iterator[Stressed]:
        """Every shaft against its limits."""
        rated, tolerance = rated_speed(evidence.study), self.settings.tachometer
        for shaft, curve, ruled in self._curves(evidence):
            barred = Barring((), (), np.zeros(len(curve.speed), dtype=bool))
            if shaft.curve.passing is not None:
                barred = barring(curve, rated, shaft.name, tolerance)
            yield Stressed(shaft, curve, barred, ruled)

    def _curves(
        self, evidence: Results
    ) -> Iterator[tuple[LimitedShaft, Curve, dict[str, BoolArray]]]:
        """Every shaft, its stress against the limit of continuous use, and by clause (speeds,) where it holds."""
        for shaft in self.shafts(evidence.study):
            speed, tau_c, _, tau = limits_of(evidence, shaft)
            curve = curve_of(evidence.need(Response), tau, tau_c)
            yield shaft, curve, shaft.curve.ranges(speed / rated_speed(evidence.study))

    def settling(self, evidence: Results) -> Iterator[Clause]:
        """The stress against the limit of continuous use; nothing is barred where that is kept."""
        for shaft, curve, ruled in self._curves(evidence):
            spans = judgement.spans_of(evidence.system, shaft.part)
            for clause, within in ruled.items():
                about = clause, shaft.name, STRESS, shaft.standing, curve, within, "N/mm2"
                yield Clause(*about, spans=spans, if_kept=True)
        yield from self.clauses(evidence)

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Stress in continuous use, while barred ranges are passed, and above the last limit; of every shaft."""
        found = list[Check]()
        for one in self.stressed(evidence):
            for line in self.stresses(evidence, one):
                found += with_reach(
                    conditioned(line, one.shaft),
                    evidence.study,
                    self.scope,
                    subject=SUBJECT,
                    begin=self.begin,
                )
        return distinct((*found, *super().judge(evidence)))

    def stresses(self, evidence: Results, one: Stressed) -> Iterator[Check]:
        """The clauses about the stress amplitude of one shaft.

        Outside the permitted barred ranges it is at most the limit of continuous use, in them that of passing, which
        no keyway allows; the greatest stress above the last limit is stated.
        """
        shaft, barred = one.shaft, one.barred
        spans = judgement.spans_of(evidence.system, shaft.part)

        def judged(
            clause: str, what: str, limit: FloatArray, within: BoolArray, *notes: str
        ) -> Check | None:
            about = replace(one.curve, limit=limit)
            return judge_clause(
                self.name,
                Clause(
                    clause, shaft.name, what, shaft.standing, about, within, "N/mm2", notes, spans
                ),
                evidence,
            )

        rest = f"outside the barred range {_words(barred.permitted)}" if barred.permitted else ""
        last = shaft.curve.last
        notes = (MOSTLY, _refusal(one), rest, *shaft.notes)
        for clause, within in one.ruled.items():
            line = judged(clause, STRESS, one.curve.limit, within & ~barred.passed, *notes)
            if line is not None:
                yield line
        line = self._passing(evidence, one, judged)
        if line is not None:
            yield line
        what = "Torsional stress amplitude above the last speed with a limit"
        end = in_rpm(last * rated_speed(evidence.study))
        without = f"no continuous operation above {end}, {last:g} of the rated speed: the rule has no limit there"
        clause = shaft.curve.pieces[-1].clause
        line = judged(clause, what, np.ones(len(one.curve.speed)), ~one.is_ruled, without)
        if line is not None:
            verdict = self._above(evidence.study, last)
            restrictions = (without,) if verdict == "restricted" else ()
            yield replace(
                line, limit=math.nan, verdict=verdict, restrictions=restrictions, standing=self.mark
            )

    def _above(self, study: Study, last: float) -> Verdict:
        """Verdict above the last limit: a restriction, or NOT JUDGED if a rule has continuous use there."""
        ranges = [
            settings.continuous for _, settings in study.rules if isinstance(settings, UseSettings)
        ]
        highest = max(
            [*(use.last for use in ranges if use is not None), study.operation.highest or 0.0]
        )
        return (
            "not judged" if highest > last * rated_speed(study) * (1 + ROUNDING) else "restricted"
        )

    def _passing(
        self, evidence: Results, one: Stressed, judged: Callable[..., Check | None]
    ) -> Check | None:
        """The stress while the barred ranges are passed; None where nothing is barred."""
        shaft, barred, meter = one.shaft, one.barred, self.settings.tachometer
        if shaft.curve.passing is None:
            return None
        reasons = [
            f"{feature}: keyways are not for use with a barred range" for feature in shaft.keyways
        ]
        passed = f"barred range {_words(barred.permitted)}, to be passed rapidly"
        tachometer = f"tachometer tolerance {100 * meter:.3g} % " + (
            "added" if meter else "assumed"
        )
        times = barred_time.barred_times(evidence, barred.permitted)
        notes = *reasons, passed, tachometer, MOSTLY, barred_time.words(times)
        limit = limits_of(evidence, shaft).tau_t
        line = judged(shaft.curve.passing.clause, PASSING, limit, barred.passed, *notes)
        if line is None:
            return None
        spans = judgement.spans_of(evidence.system, shaft.part)
        rated = rated_speed(evidence.study)
        ordered = (_with_order(evidence, band, spans) for band in barred.permitted)
        ranges = tuple(over_tolerances(evidence, band, rated, meter) for band in ordered)
        verdict = "fail" if reasons else "restricted" if line.verdict == "pass" else line.verdict
        return replace(line, verdict=verdict, barred=ranges, times=times)


def conditioned(line: Check, shaft: LimitedShaft) -> Check:
    """Return a check of a stress with the conditions of its limit: NOT JUDGED if one is broken, else restricted."""
    if line.fails or not line.has_limit:
        return line
    if shaft.doubts:
        return replace(
            line, verdict="not judged", note="; ".join(filter(None, (*shaft.doubts, line.note)))
        )
    passing = shaft.curve.passing
    is_near = (line.utilisation or 0.0) > NEAR_LIMIT or (
        passing is not None and line.clause == passing.clause
    )
    for words in (*shaft.restrictions, *(shaft.near_limit if is_near else ())):
        line = restricted(line, words)
    return line


def limits_of(evidence: Results, shaft: LimitedShaft) -> Limits:
    """Stress and limits of one shaft over speed."""
    response, synthesis = evidence.need(Response), evidence.need(Synthesis)
    _, tau = nominal_stress(evidence.system, shaft.part, synthesis.half_range)
    ratio = response.speed / rated_speed(evidence.study)
    return Limits(
        response.speed, shaft.curve.continuous(ratio), shaft.curve.while_passing(ratio), tau
    )


def judging(evidence: Results, shaft: str) -> tuple[ShaftStress, LimitedShaft]:
    """The first rule of the file that limits the stress of a shaft, and its limits. Raises KeyError where none does."""
    for rule in of_study(evidence.study):
        if isinstance(rule, ShaftStress):
            for limited in rule.shafts(evidence.study):
                if limited.name == shaft:
                    return rule, limited
    raise KeyError(shaft)


def _with_order(evidence: Results, barred: BarredRange, spans: IntArray) -> BarredRange:
    """With the order that has the greatest torque in the shaft at the critical speed."""
    at = int(np.argmin(np.abs(evidence.need(Response).speed - barred.critical)))
    main = judgement.main_component(evidence, at, spans)
    return replace(barred, order=None if main is None else main.order)


def _refusal(one: Stressed) -> str:
    """That the stress above the limit cannot be barred; empty where it can."""
    if not one.barred.refused:
        return ""
    critical = " and ".join(in_rpm(band.critical) for band in one.barred.refused)
    return (
        f"the stress exceeds {' or '.join(one.ruled)} about {critical}: no barred range is permitted there (lambda >= "
        f"{BARRED_BELOW:g}): detune; it would run from {_words(one.barred.refused)}"
    )


def _words(barred: tuple[BarredRange, ...]) -> str:
    return " and ".join(f"{in_rpm(one.lower)} to {in_rpm(one.upper)}" for one in barred)


def barring(curve: Curve, rated: float, shaft: str, tolerance: float = 0.0) -> Barring:
    """The ranges for stress over speed against its limit; rated in rad/s.

    A run of speeds above it has its critical speed at its worst, wherever that lies; the range about it is refused
    where its upper end reaches 0.8 of the rated speed. Both ends move apart by the `tolerance` of the tachometer.
    """
    share, none = curve.utilisation(), np.zeros(len(curve.speed), dtype=bool)
    permitted, refused, passed, above = list[BarredRange](), list[BarredRange](), none.copy(), none
    exceeds = np.isfinite(curve.limit) & (share > 1.0)
    edges = np.flatnonzero(np.diff(exceeds, prepend=False, append=False))
    for first, end in edges.reshape(len(edges) // 2, 2).tolist():
        critical = float(curve.speed[first + worst_of(share[first:end], curve.value[first:end])])
        formula = barred_range(critical, rated)
        lower = min(formula[0], _crossing(curve, first, first - 1)) * (1.0 - tolerance)
        upper = max(formula[1], _crossing(curve, end - 1, end)) * (1.0 + tolerance)
        is_permitted = bool(may_be_barred(upper / rated))
        (permitted if is_permitted else refused).append(
            BarredRange(lower, upper, critical, shaft, *formula)
        )
        above[first:end] |= not is_permitted
    together = _apart(curve, permitted)
    for one in together:
        passed |= (curve.speed > one.lower) & (curve.speed < one.upper)
    return Barring(together, _apart(curve, refused), passed & ~above)


def _apart(curve: Curve, ranges: list[BarredRange]) -> tuple[BarredRange, ...]:
    """Ascending ranges, those that overlap as one about the worst of their critical speeds."""
    merged: list[BarredRange] = []
    for later in ranges:
        if not merged or later.lower > merged[-1].upper:
            merged.append(later)
            continue
        pair = merged.pop(), later
        at = [int(np.flatnonzero(curve.speed == one.critical)[0]) for one in pair]
        worse = pair[worst_of(curve.utilisation()[at], curve.value[at])]
        lower, upper = min(one.lower for one in pair), max(one.upper for one in pair)
        merged.append(replace(worse, lower=lower, upper=upper))
    return tuple(merged)


def _crossing(curve: Curve, above: int, beyond: int) -> float:
    """Speed between two neighbours at which the stress meets its limit, by a straight line.

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
