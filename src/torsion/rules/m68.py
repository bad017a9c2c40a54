"""Rule `iacs-m68`: stresses, barred speed ranges and least diameters of shafts, IACS UR M68 (Rev. 3, 2021)."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.components.lowering import ShaftRecord
from torsion.components.material import STEEL
from torsion.errors import Fault, Path
from torsion.findings import Results
from torsion.rules import barred_time, judgement, m68_shafts
from torsion.rules.judgement import MOSTLY, RATED, Clause, Curve, curve_of, in_rpm, judge, rated_speed, worst_of
from torsion.rules.m68_shafts import BARRED_BELOW, FLAT_FROM, LAST_CONTINUOUS, PA, ClassedShaft, M68Settings
from torsion.rules.verdict_line import TO_BE_VERIFIED, BarredRange, Check, Rule, verdict_of
from torsion.study import Study

RULE = "iacs-m68"
NOT_ROUND = "its section is a mesh; limits, factors and least diameters of the rule are those of round shafts"
KW_PER_RPM = 2.0 * math.pi / 60.0 / 1e3  # power in kW per rpm of a torque of 1 N m


class Limits(NamedTuple):
    """Stress amplitude of a shaft and its limits over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    tau_c: FloatArray  # (speeds,) N/mm2, NaN above 1.05 of the rated speed
    tau_t: FloatArray  # (speeds,) N/mm2, NaN above 0.8 of the rated speed
    tau: FloatArray  # (speeds,) N/mm2, half range of the synthesis


@dataclass(frozen=True)
class Barring:
    """What is to be barred for the stress above tau_C, and where the rule permits it."""

    permitted: tuple[BarredRange, ...]  # ascending and apart
    refused: tuple[BarredRange, ...]  # those that reach 0.8 of the rated speed, ascending and apart
    passed: BoolArray  # (speeds,) inside a permitted range, and not above tau_C within a refused one


class M68(Rule):
    """The rule, as the study reads it."""

    name = RULE
    settings = M68Settings
    needs = ("steady", "response")

    def faults(self, study: Study, settings: M68Settings) -> list[Fault]:
        """What the file lacks for this rule."""
        classed, where = m68_shafts.judged(study.train), self.path(study, settings)
        if not classed:
            hint = "role: intermediate, thrust or propeller; a shaft with a `section` is not judged"
            return [Fault(where, f"no round shaft has a `role`, so {RULE} has nothing to judge", hint)]
        found = judgement.vibration_faults(self, study, settings)
        if study.operation.rated is None:
            message = f"`rated` is missing; the limits of {RULE} count from it"
            found.append(Fault(("operation", "rated"), message, RATED))
        for bar, shaft in classed:
            made_of = study.train.materials[shaft.material]
            if made_of.tensile_strength is None and made_of != STEEL:
                message = f"`tensile_strength` of '{shaft.material}' is not given, and {RULE} needs it for '{bar.name}'"
                hint = f"materials: {{{shaft.material}: {{..., tensile_strength: 600 MPa}}}}"
                found.append(Fault((*study.train.parts[bar.part].path, "material"), message, hint))
        return found + _settings_faults(settings, {bar.name: shaft for bar, shaft in classed}, where)

    def left_out(self, study: Study, settings: M68Settings) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        found = []
        for bar in study.train.bars:
            if study.train.shaft(bar).role is None:
                found.append((f"{RULE} for {bar.name}", "the shaft has no `role`"))
            elif bar.section is not None:
                found.append((f"{RULE} for {bar.name}", NOT_ROUND))
        if not study.operation.has_mean_torque:
            found.append((f"{RULE}: least diameters", "the rated power is not given"))
        speeds, rated = study.operation.speeds, study.operation.rated
        if speeds is not None and rated is not None and judgement.coverage(speeds.last, rated.speed, LAST_CONTINUOUS):
            reach = f"the limits reach to {in_rpm(LAST_CONTINUOUS * rated.speed)}"
            found.append((f"{RULE} above {in_rpm(speeds.last)}", f"`operation.speeds` ends there; {reach}"))
        return tuple(found)

    def speeds(self, study: Study, settings: M68Settings) -> tuple[float, ...]:
        """rad/s: the rated speed, and those at which the limits bend or end."""
        return tuple(share * rated_speed(study) for share in (BARRED_BELOW, FLAT_FROM, 1.0, LAST_CONTINUOUS))

    def speeds_between(self, evidence: Results, settings: M68Settings) -> FloatArray:
        """(speeds,) rad/s between those computed: where a shaft may be worse, and the ends of its barred ranges."""
        found, ends = [], list[float]()
        for shaft in m68_shafts.classed_shafts(evidence.study, settings):
            curve, barred, ruled = _judged(evidence, shaft, settings)
            found += [(curve, ruled), (curve, ruled & ~barred.passed)]
            ends += [end for one in barred.permitted for end in (one.lower, one.upper)]
        return np.union1d(judgement.between(found), ends)

    def check(self, evidence: Results, settings: M68Settings) -> tuple[Check, ...]:
        """Stress in continuous use, while barred ranges are passed, and above 1.05; least diameter; of every shaft."""
        found: list[Check | None] = []
        for shaft in m68_shafts.classed_shafts(evidence.study, settings):
            found += [*_stresses(evidence, shaft, settings), _diameter(evidence, shaft, settings)]
        return tuple(line for line in found if line is not None)


def _settings_faults(settings: M68Settings, shafts: Mapping[str, ShaftRecord], where: Path) -> list[Fault]:
    """Settings that name a shaft which the rule does not judge, or a slot that is no feature of it."""
    found, names = [], f"there is {', '.join(shafts)}"
    for position, name in enumerate(settings.alloy):
        if name not in shafts:
            path = (*where, RULE, "alloy", position)
            found.append(Fault(path, f"no shaft with a role is called '{name}'", names))
    for name in settings.slots:
        if name not in shafts or "slot" not in shafts[name].features:
            path = (*where, RULE, "slots", name)
            found.append(
                Fault(path, f"no shaft with a role and the feature `slot` is called '{name}'", names, at_key=True)
            )
    return found


def limits(evidence: Results, shaft: str) -> Limits:
    """Stress and limits of one shaft over speed, with the study's own settings. Raises KeyError for another name."""
    return _limits(evidence, _shaft(evidence, shaft))


def section(evidence: Results, shaft: str) -> tuple[IntArray, FloatArray]:
    """Spans of one shaft and the moduli (m3) by which the rule takes its stress. Raises KeyError for another name."""
    return m68_shafts.stress_modulus(evidence.system, _shaft(evidence, shaft))


def _shaft(evidence: Results, shaft: str) -> ClassedShaft:
    settings = next((given for _, given in evidence.study.rules if isinstance(given, M68Settings)), M68Settings())
    return {classed.name: classed for classed in m68_shafts.classed_shafts(evidence.study, settings)}[shaft]


def _limits(evidence: Results, shaft: ClassedShaft) -> Limits:
    response, synthesis = evidence.need(Response), evidence.need(Synthesis)
    spans, modulus = m68_shafts.stress_modulus(evidence.system, shaft)
    tau = np.max(synthesis.half_range[:, spans] / modulus * PA, axis=1)
    ratio = response.speed / rated_speed(evidence.study)
    made_of = shaft.strength, shaft.diameter, shaft.c_k
    return Limits(response.speed, m68_shafts.tau_c(*made_of, ratio), m68_shafts.tau_t(*made_of, ratio), tau)


def _judged(evidence: Results, shaft: ClassedShaft, settings: M68Settings) -> tuple[Curve, Barring, BoolArray]:
    """Stress against tau_C, what is barred, and (speeds,) which speeds are not above 1.05."""
    _, tau_c, _, tau = _limits(evidence, shaft)
    curve = curve_of(evidence.need(Response), tau, tau_c)
    barred = barring(curve, rated_speed(evidence.study), shaft.name, settings.tachometer)
    return curve, barred, np.isfinite(tau_c)


def _stresses(evidence: Results, shaft: ClassedShaft, settings: M68Settings) -> Iterator[Check | None]:
    """The three clauses about the stress amplitude.

    tau <= tau_C outside the permitted barred ranges, up to 1.05; tau <= tau_T in them, which no keyway allows; and the
    greatest stress above 1.05 of the rated speed, for which the rule has no limit.
    """
    curve, barred, ruled = _judged(evidence, shaft, settings)

    def judged(clause: str, what: str, limit: FloatArray, within: BoolArray, *notes: str) -> Check | None:
        about, spans = replace(curve, limit=limit), judgement.spans_of(evidence.system, shaft.part)
        return judge(
            RULE, Clause(clause, shaft.name, what, shaft.standing, about, within, "N/mm2", notes, spans), evidence
        )

    rest = f"outside the barred range {_words(barred.permitted)}" if barred.permitted else ""
    reach = judgement.coverage(float(curve.speed[-1]), rated_speed(evidence.study), LAST_CONTINUOUS)
    notes = (MOSTLY, _refusal(barred), rest, *shaft.notes, reach)
    yield judged("tau_C", "synthesis stress amplitude", curve.limit, ruled & ~barred.passed, *notes)
    reasons = [f"{feature}: keyways are not for use with a barred range" for feature in shaft.keyways]
    passed = f"barred range {_words(barred.permitted)}, to be passed rapidly"
    meter = settings.tachometer
    tachometer = f"tachometer tolerance {100 * meter:.3g} % " + ("added" if meter else "assumed")
    times = barred_time.barred_times(evidence, barred.permitted)
    notes = *reasons, passed, tachometer, MOSTLY, barred_time.words(times)
    tau_t = _limits(evidence, shaft).tau_t
    line = judged("tau_T", "stress amplitude in the barred range", tau_t, barred.passed, *notes)
    if line is not None:
        ranges = tuple(
            _with_order(evidence, one, judgement.spans_of(evidence.system, shaft.part)) for one in barred.permitted
        )
        yield replace(line, verdict="fail" if reasons else line.verdict, barred=ranges, times=times)
    what, note = "stress amplitude above 1.05 of the rated speed", "outside the rule: it has no limit above 1.05"
    line = judged("tau_C", what, np.ones(len(curve.speed)), ~ruled, f"{note} of the rated speed")
    if line is not None:
        yield replace(line, limit=math.nan, verdict="outside", standing="rule text")


def _with_order(evidence: Results, barred: BarredRange, spans: IntArray) -> BarredRange:
    """With the order that has the greatest torque in the shaft at the critical speed."""
    at = int(np.argmin(np.abs(evidence.need(Response).speed - barred.critical)))
    main = judgement.main_component(evidence, at, spans)
    return replace(barred, order=None if main is None else main.order)


def _refusal(barred: Barring) -> str:
    """That the stress above tau_C cannot be barred; empty where it can."""
    if not barred.refused:
        return ""
    critical = " and ".join(in_rpm(one.critical) for one in barred.refused)
    return (
        f"the stress exceeds tau_C about {critical}: no barred range is permitted there (lambda >= "
        f"{BARRED_BELOW:g}): detune; it would run from {_words(barred.refused)}"
    )


def _diameter(evidence: Results, shaft: ClassedShaft, settings: M68Settings) -> Check | None:
    """The less favourable end against its least diameter, for the rated mean torque."""
    every = judgement.rated_torque(evidence)
    if every is None:
        return None
    factor = m68_shafts.drive_factor(shaft.role, smooth=settings.drive != "other")
    load = float(np.max(every[judgement.spans_of(evidence.system, shaft.part)])) * KW_PER_RPM
    ends = [
        (outer, m68_shafts.least_diameter(load, shaft.strength, factor, shaft.k, bore / outer))
        for outer, bore in shaft.ends
    ]
    diameter, least = max(ends, key=lambda end: end[1] / end[0])
    used = f"F {factor:g} (drive: {settings.drive}), k {shaft.k:g}, {load:.5g} kW per rpm"
    return Check(
        RULE, "minimum diameter", shaft.name, "outer diameter, at least", diameter, least, "mm",
        verdict_of(diameter >= least, TO_BE_VERIFIED), TO_BE_VERIFIED, rated_speed(evidence.study), note=used,
        at_least=True,
    )  # fmt: skip


def _words(barred: tuple[BarredRange, ...]) -> str:
    return " and ".join(f"{in_rpm(one.lower)} to {in_rpm(one.upper)}" for one in barred)


def barring(curve: Curve, rated: float, shaft: str, tolerance: float = 0.0) -> Barring:
    """The ranges for stress over speed against tau_C; rated in rad/s.

    A run of speeds above tau_C has its critical speed at its worst, wherever that lies; the range about it is refused
    where its upper end reaches 0.8 of the rated speed. Both ends move apart by the `tolerance` of the tachometer.
    """
    share, none = curve.utilisation(), np.zeros(len(curve.speed), dtype=bool)
    permitted, refused, passed, above = list[BarredRange](), list[BarredRange](), none.copy(), none
    exceeds = np.isfinite(curve.limit) & (share > 1.0)
    edges = np.flatnonzero(np.diff(exceeds, prepend=False, append=False))
    for first, end in edges.reshape(len(edges) // 2, 2).tolist():
        critical = float(curve.speed[first + worst_of(share[first:end], curve.value[first:end])])
        formula = m68_shafts.barred_range(critical, rated)
        lower = min(formula[0], _crossing(curve, first, first - 1)) * (1.0 - tolerance)
        upper = max(formula[1], _crossing(curve, end - 1, end)) * (1.0 + tolerance)
        is_permitted = bool(m68_shafts.may_be_barred(upper / rated))
        (permitted if is_permitted else refused).append(BarredRange(lower, upper, critical, shaft, *formula))
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
