"""Rule `iacs-m68`: stresses, barred speed ranges and least diameters of shafts, IACS UR M68 (Rev. 3, 2021)."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import Fault, Path
from torsion.findings import Results
from torsion.model.parts import ShaftRecord
from torsion.rules import of_study, rule_over_speed
from torsion.rules.class_rules import barred_time, m68_shafts
from torsion.rules.class_rules.m68_shafts import (
    DRIVE_FACTOR,
    LAST_CONTINUOUS,
    LEAST_STRENGTH,
    LEAST_STRENGTH_IN_BARRED_RANGE,
    NEAR_TRANSIENT,
    SMOOTH_DRIVE_FACTOR,
    ClassedShaft,
    M68Settings,
)
from torsion.rules.class_rules.shaft_limits import (
    NEAR_LIMIT,
    ROUNDING,
    Barring,
    LimitedShaft,
    Mark,
    barring,
    limits_of,
    unknown_strengths,
    with_role,
)
from torsion.rules.demands import (
    BARRED_BELOW,
    START,
    ZERO_PITCH,
    distinct,
    in_rpm,
    misfire_row,
    order_rows,
    restriction,
    unjudged,
    with_reach,
)
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
)
from torsion.rules.verdict_line import (
    TO_BE_VERIFIED,
    BarredRange,
    Check,
    Verdict,
    restricted,
    verdict_of,
)
from torsion.study import MOST_AT_ZERO_PITCH, Study

NOT_ROUND = (
    "its section is a mesh; limits, factors and minimum diameters of the rule hold for round shafts"
)
DIAMETER = "Outer diameter"
NO_POWER = "the rated power is not given: write `power` of `operation.rated`"
KW_PER_RPM = 2.0 * math.pi / 60.0 / 1e3  # power in kW per rpm of a torque of 1 N m
SUBJECT = "Torsional stress amplitude"  # of the rows about speeds that were not computed
STRESS, PASSING = f"{SUBJECT}, continuous operation", f"{SUBJECT}, passing a barred range"
ABOVE = f"{SUBJECT} above the last speed with a limit"


@dataclass(frozen=True)
class Stressed:
    """A shaft with its stress against the limit of continuous use, and what is barred."""

    shaft: LimitedShaft
    curve: Curve
    barred: Barring


class M68(RuleOverSpeed[M68Settings]):
    """The rule, as the study reads it, and base of those of societies that take its formulas for line shafts."""

    name = "iacs-m68"
    edition = "IACS UR M68 as in KR Rules 2025 Pt 5 Ch 4"
    settings_class: type[M68Settings] = M68Settings
    title = "IACS UR M68"  # as reports cite it
    mark: Mark = "rule text"  # of where its limits end
    begin = START
    scope = LAST_CONTINUOUS  # speed ratio to which speeds are demanded
    source = "IACS UR M68 as in KR 2025 Pt 5 Ch 4, 206.1"  # of the states that it demands
    letters = "tau_C", "tau_T"  # of its limits, in continuous use and in passing
    has_limits_of: tuple[str, ...] = m68_shafts.ROLES

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        path, roles = self.path(study), self.has_limits_of
        shafts = {part.name: shaft for _, part, shaft in with_role(study.train, *roles)}
        if not shafts:
            hint = f"role: {', '.join(roles[:-1])} or {roles[-1]}; a shaft with a `section` is not judged"
            message = f"no round shaft has a `role`, so {self.name} has nothing to judge"
            yield Fault(path, message, hint)
            return
        yield from self.vibration_faults(study)
        if study.operation.rated is None:
            message = f"`rated` is missing; the limits of {self.name} count from it"
            yield Fault(("operation", "rated"), message, RATED)
        yield from unknown_strengths(study, self, *m68_shafts.ROLES)
        yield from self._settings_faults(study, shafts, path)

    def _settings_faults(
        self, study: Study, shafts: Mapping[str, ShaftRecord], where: Path
    ) -> Iterator[Fault]:
        """Yield settings that name a shaft which the rule does not judge, or a slot that is no feature of it."""
        wholes = {part.whole for part in study.train.parts if part.name in shafts}
        path, hint = (*where, self.name), f"there is {', '.join(shafts)}"
        for position, name in enumerate(self.settings.alloy):
            if name not in shafts and name not in wholes:
                message = f"no shaft with a role is called '{name}'"
                yield Fault((*path, "alloy", position), message, hint)
        for name in self.settings.slots:
            if name not in shafts or "slot" not in shafts[name].features:
                message = f"no shaft with a role and the feature `slot` is called '{name}'"
                yield Fault((*path, "slots", name), message, hint, at_key=True)

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Yield what was not judged, and why."""
        roles = {part.name: part.shaft.role for part in study.train.parts if part.shaft is not None}
        for name, role in roles.items():
            if role is None:
                yield f"{self.name} for {name}", "the shaft has no `role`"
        if not study.has_mean_torque and _is_generator_set(study):
            yield f"{self.name}: least diameters", NO_POWER
        judged = (None, *self.has_limits_of)
        if names := ", ".join(name for name, role in roles.items() if role not in judged):
            limited = f"limits of {', '.join(self.has_limits_of)} are known: {names}"
            yield f"{self.name}: shafts of another role", limited

    def shafts(self, study: Study) -> Iterator[LimitedShaft]:
        """Yield every round line shaft that has a role."""
        return m68_shafts.classed_shafts(study, self.settings, self.letters)

    def speeds(self, study: Study) -> tuple[float, ...]:
        """Return in rad/s the rated speed, and those at which the limits bend or end."""
        corners = {share for shaft in self.shafts(study) for share in shaft.curve.corners}
        return tuple(share * rated_speed(study) for share in sorted(corners))

    def speeds_between(self, evidence: Results) -> FloatArray:
        """Return (speeds,) rad/s between those computed: where a shaft may be worse, and the ends of its barred ranges."""
        curves, ends = list[tuple[Curve, BoolArray]](), list[float]()
        for stressed in self.stressed(evidence):
            curve, barred = stressed.curve, stressed.barred
            is_ruled = np.isfinite(curve.limit)
            curves += [(curve, is_ruled), (curve, is_ruled & ~barred.passed)]
            ends += [end for band in barred.permitted for end in (band.lower, band.upper)]
        speeds = np.union1d(rule_over_speed.between(curves), ends)
        return np.union1d(speeds, super().speeds_between(evidence))

    def stressed(self, evidence: Results) -> Iterator[Stressed]:
        """Yield every shaft against its limits."""
        for shaft in self.shafts(evidence.study):
            limits = limits_of(evidence, shaft)
            curve = curve_of(evidence.need(Response), limits.tau, limits.tau_c)
            barred = Barring((), (), np.zeros(len(limits.speed), dtype=bool))
            if shaft.curve.passing is not None:
                rated, tolerance = rated_speed(evidence.study), self.settings.tachometer
                barred = barring(curve, rated, shaft.name, tolerance)
            yield Stressed(shaft, curve, barred)

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Yield the checks of every shaft, and last the strengths of those that pass a barred range."""
        checks = list[Check]()
        for stressed in self.stressed(evidence):
            shaft = stressed.shaft
            for check in self._stresses(evidence, stressed):
                conditioned = check
                if not check.fails and check.has_limit and shaft.doubts:
                    note = "; ".join(filter(None, (*shaft.doubts, check.note)))
                    conditioned = replace(check, verdict="not judged", note=note)
                elif not check.fails and check.has_limit:
                    passing = shaft.curve.passing
                    is_passing = passing is not None and check.clause == passing.clause
                    is_near = is_passing or (check.utilisation or 0.0) > NEAR_LIMIT
                    near_limit = shaft.near_limit if is_near else ()
                    conditioned = restricted(check, *shaft.restrictions, *near_limit)
                about = evidence.study, self.scope
                checks += with_reach(conditioned, *about, subject=SUBJECT, begin=self.begin)
            checks += self._diameter(evidence, shaft)
        distinct_checks = distinct((*checks, *super().judge(evidence)))
        yield from distinct_checks

        # A strength below that which the rule demands near the limit of passing a barred range.
        minimum, near = LEAST_STRENGTH_IN_BARRED_RANGE, self.settings.near_transient
        passing_checks = {check.where: check for check in distinct_checks if check.barred}
        for line_shaft in m68_shafts.classed_shafts(evidence.study, self.settings):
            stated, passed = line_shaft.stated, passing_checks.get(line_shaft.name)
            if passed is None or (stated or 0.0) >= minimum * (1 - ROUNDING):
                continue
            use = math.inf if passed.utilisation is None else passed.utilisation
            is_near = use >= near * (1 - ROUNDING)
            origin = "ours" if near == NEAR_TRANSIENT else "stated by user"
            words = f"the stress there is {use:.3g} of its limit, near is {near:g} ({origin})"
            if not is_near:
                words += "; the rule demands 500 N/mm2 near the limit of passing and does not say how near"
            verdict: Verdict = "fail" if is_near and stated is not None else "not judged"
            what = "Tensile strength where a barred range is passed"
            row = _strength(self.name, line_shaft, what, minimum, verdict)
            yield replace(row, speed=passed.speed, note=words)

    def _stresses(self, evidence: Results, stressed: Stressed) -> Iterator[Check]:
        """Yield the checks of the stress amplitude of one shaft.

        Outside the permitted barred ranges it is at most the limit of continuous use, in them that of passing, which
        no keyway allows. The greatest stress above the last limit is stated: a restriction, or NOT JUDGED if the file
        has continuous use there.
        """
        shaft, barred, study = stressed.shaft, stressed.barred, evidence.study
        spans, rated = spans_of(evidence.system, shaft.part), rated_speed(study)
        permitted, meter = barred.permitted, self.settings.tachometer

        def judge(
            clause: str, what: str, limit: FloatArray, within: BoolArray, *notes: str
        ) -> Iterator[Check]:
            """Yield the check at the worst of some speeds, if there are any."""
            curve = replace(stressed.curve, limit=limit)
            about = clause, shaft.name, what, shaft.standing, curve, within
            row = Clause(*about, "N/mm2", notes, spans)
            if (check := judge_clause(self.name, row, evidence)) is not None:
                yield check

        # In continuous use, outside the permitted barred ranges.
        ratio = stressed.curve.speed / rated
        ruled, refusal = shaft.curve.ranges(ratio), ""
        if barred.refused:
            critical = " and ".join(in_rpm(band.critical) for band in barred.refused)
            refusal = (
                f"the stress exceeds {' or '.join(ruled)} about {critical}: no barred range is permitted "
                f"there (lambda >= {BARRED_BELOW:g}): detune; it would run from {_words(barred.refused)}"
            )
        outside = f"outside the barred range {_words(permitted)}" if permitted else ""
        notes = MOSTLY, refusal, outside, *shaft.notes
        for clause, holds in ruled.items():
            yield from judge(clause, STRESS, stressed.curve.limit, holds & ~barred.passed, *notes)

        # While the barred ranges are passed.
        if (piece := shaft.curve.passing) is not None:
            times = barred_time.barred_times(evidence, permitted)
            passing_notes = (
                *(f"{name}: keyways are not for use with a barred range" for name in shaft.keyways),
                f"barred range {_words(permitted)}, to be passed rapidly",
                f"tachometer tolerance {100 * meter:.3g} % {'added' if meter else 'assumed'}",
                MOSTLY,
                barred_time.words(times),
            )
            about = piece.clause, PASSING, shaft.curve.while_passing(ratio), barred.passed
            for check in judge(*about, *passing_notes):
                ranges = tuple(self._range(evidence, stressed, spans, band) for band in permitted)
                verdict: Verdict = "restricted" if check.verdict == "pass" else check.verdict
                if shaft.keyways:
                    verdict = "fail"
                yield replace(check, verdict=verdict, barred=ranges, times=times)

        # Above the last limit; continuous use is stated by any rule, or by the highest speed of the train.
        last = shaft.curve.last * rated
        share = f"{shaft.curve.last:g} of the rated speed"
        without = (
            f"no continuous operation above {in_rpm(last)}, {share}: the rule has no limit there"
        )
        highest = [study.operation.highest or 0.0]
        for _, settings in study.rules:
            if isinstance(settings, UseSettings) and settings.continuous is not None:
                highest.append(settings.continuous.last)
        clause, unlimited = shaft.curve.pieces[-1].clause, np.ones(len(stressed.curve.speed))
        is_beyond = ~np.isfinite(stressed.curve.limit)
        for check in judge(clause, ABOVE, unlimited, is_beyond, without):
            bare = replace(check, limit=math.nan, standing=self.mark, verdict="not judged")
            if max(highest) <= last * (1 + ROUNDING):
                bare = replace(bare, verdict="restricted", restrictions=(without,))
            yield bare

    def _range(
        self, evidence: Results, stressed: Stressed, spans: IntArray, band: BarredRange
    ) -> BarredRange:
        """Return a barred range with the order of the greatest torque at its critical speed, over the tolerances."""
        row = int(np.argmin(np.abs(stressed.curve.speed - band.critical)))
        main = rule_over_speed.main_component(evidence, row, spans)
        ordered = replace(band, order=None if main is None else main.order)
        return over_tolerances(
            evidence, ordered, rated_speed(evidence.study), self.settings.tachometer
        )

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Yield strengths below the least one, and states of the train that neither the file nor a case of it has."""
        has_diameters = study.has_mean_torque or _is_generator_set(study)
        for shaft in m68_shafts.classed_shafts(study, self.settings):
            if shaft.stated is not None and shaft.stated < LEAST_STRENGTH * (1 - ROUNDING):
                what = "Tensile strength of the material"
                yield _strength(self.name, shaft, what, LEAST_STRENGTH, "fail")
            if not has_diameters:
                about = "minimum diameter", shaft.name, DIAMETER, NO_POWER
                yield unjudged(self.name, *about, TO_BE_VERIFIED)
        train, what = study.train, f"{SUBJECT}, section that is not round"
        round_shafts = {part.name for _, part, _ in with_role(train, *self.has_limits_of)}
        for bar in train.bars:
            if train.shaft(bar).role in self.has_limits_of and bar.name not in round_shafts:
                yield unjudged(self.name, "section", bar.name, what, NOT_ROUND)
        yield from order_rows(self.name, study)
        if not _is_generator_set(study):
            yield from misfire_row(self.name, study, self.source)
        # Zero pitch: NOT JUDGED of a controllable pitch, a restriction if the pitch is not stated. A `propeller` of a
        # train without a shaft of that role may be any load.
        roles = {part.shaft.role for part in train.parts if part.shaft is not None}
        for part in train.parts if not study.covers(ZERO_PITCH, self.name) else ():
            pitch = "fixed" if part.propeller is None else part.propeller.pitch
            zero = ZERO_PITCH, part.name, "Zero pitch"
            if part.kind == "propeller" and pitch == "controllable":
                most = f"at most {100 * MOST_AT_ZERO_PITCH:g} % of the normal load at every speed"
                note = (
                    f"{self.source} demands it: a case whose table of `operation.load` has {most}"
                )
                yield unjudged(self.name, *zero, note)
            elif part.kind == "propeller" and pitch is None and "propeller" in roles:
                words = f"fixed pitch of '{part.name}' assumed: the file does not state `pitch`"
                yield restriction(self.name, *zero, words)

    def _diameter(self, evidence: Results, shaft: LimitedShaft) -> Iterator[Check]:
        """Yield the less favourable end of a line shaft against its least diameter, for the rated mean torque if known."""
        torque, drive = rule_over_speed.full_torque(evidence), self.settings.drive
        if torque is None or not isinstance(shaft, ClassedShaft):
            return
        is_smooth = drive != "other" and shaft.role == "intermediate"
        factor = SMOOTH_DRIVE_FACTOR if is_smooth else DRIVE_FACTOR
        load = float(np.max(torque[spans_of(evidence.system, shaft.part)])) * KW_PER_RPM
        ends = [
            (outer, m68_shafts.least_diameter(load, shaft.strength, factor, shaft.k, bore / outer))
            for outer, bore in shaft.ends
        ]
        diameter, minimum = max(ends, key=lambda end: end[1] / end[0])
        yield Check(
            self.name,
            "minimum diameter",
            shaft.name,
            DIAMETER,
            diameter,
            minimum,
            "mm",
            verdict_of(diameter >= minimum, TO_BE_VERIFIED),
            TO_BE_VERIFIED,
            rated_speed(evidence.study),
            note=f"F {factor:g} (drive: {drive}), k {shaft.k:g}, {load:.5g} kW per rpm",
            at_least=True,
        )


def judging(evidence: Results, shaft: str) -> tuple[M68, LimitedShaft]:
    """Return the first rule of the file that limits the stress of a shaft, and its limits; raises KeyError if none does."""
    for rule in of_study(evidence.study):
        if isinstance(rule, M68):
            for limited in rule.shafts(evidence.study):
                if limited.name == shaft:
                    return rule, limited
    raise KeyError(shaft)


def _words(ranges: tuple[BarredRange, ...]) -> str:
    return " and ".join(f"{in_rpm(barred.lower)} to {in_rpm(barred.upper)}" for barred in ranges)


def _is_generator_set(study: Study) -> bool:
    """Return whether the train has no propulsion, whose misfire and least diameters the rule demands."""
    roles = {part.shaft.role for part in study.train.parts if part.shaft is not None}
    return "generator" in roles and "propeller" not in roles


def _strength(rule: str, shaft: ClassedShaft, what: str, minimum: float, verdict: Verdict) -> Check:
    """Return the row of a stated tensile strength against the least one."""
    stated = math.nan if shaft.stated is None else shaft.stated
    about = rule, "material", shaft.name, what
    return Check(*about, stated, minimum, "N/mm2", verdict, "rule text", at_least=True)
