"""Rule `iacs-m68`: torsional vibration stresses and least diameters of shafts, IACS UR M68 (Rev. 3, 2021)."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np

from torsion.analyses.steady import SAME_SPEED, has_mean_torque
from torsion.components.material import STEEL
from torsion.components.shaft import Shaft
from torsion.errors import Fault, Path
from torsion.kernels.tree import BoolArray, FloatArray
from torsion.rules import m68_formulas as formulas
from torsion.rules.check import BarredRange, Check, Verdict
from torsion.rules.evidence import (
    Evidence,
    in_rpm,
    parts_of_kind,
    rated_is_computed,
    rated_torque,
    rule_path,
    spans_of,
    vibration_faults,
)
from torsion.rules.judgement import (
    EDITION,
    Clause,
    Curve,
    judge,
    largest_line,
    noted,
    stated,
    status_words,
    worst_of,
    worst_status,
)
from torsion.rules.m68_barred import barred_ranges, inside
from torsion.rules.m68_formulas import BARRED_BELOW, LAST_CONTINUOUS
from torsion.rules.m68_shafts import PA, Asked, ClassedShaft, Slot, classed_shafts, is_classed, stress_modulus
from torsion.study import Study

__all__ = ["Asked", "Limits", "Slot", "check", "faults", "left_out", "limits", "needs"]

RULE = "iacs-m68"
NOT_ROUND = "its section is a mesh; limits, factors and least diameters of the rule are those of round shafts"
KW_PER_RPM = 2.0 * math.pi / 60.0 / 1e3  # power in kW per rpm of a torque of 1 N m


class Limits(NamedTuple):
    """Stress amplitude of a shaft and its limits over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    tau_c: FloatArray  # (speeds,) N/mm2, NaN above 1.05 of the rated speed
    tau_t: FloatArray  # (speeds,) N/mm2, NaN above 0.8 of the rated speed
    tau: FloatArray  # (speeds,) N/mm2, half range of the synthesis


def needs(asked: Asked) -> tuple[str, ...]:
    """The analyses that the rule reads."""
    return ("steady", "response")


def faults(study: Study, asked: Asked) -> list[Fault]:
    """What the file lacks for this rule."""
    classed = [part for _, part in parts_of_kind(study, "shaft") if is_classed(cast(Shaft, part.component))]
    where = rule_path(study, asked)
    if not classed:
        hint = "role: intermediate, thrust or propeller; a shaft with a `section` is not judged"
        return [Fault(where, f"no round shaft has a `role`, so {RULE} has nothing to judge", hint)]
    found = vibration_faults(study, asked, RULE)
    if study.operation.rated is None:
        hint = "rated: {speed: 1500 rpm, power: 100 kW}"
        found.append(Fault(("operation", "rated"), f"`rated` is missing; the limits of {RULE} count from it", hint))
    for part in classed:
        material = cast(Shaft, part.component).material
        made_of = study.train.materials[material]
        if made_of.tensile_strength is None and made_of != STEEL:
            message = f"`tensile_strength` of '{material}' is not given, and {RULE} needs it for '{part.name}'"
            hint = f"materials: {{{material}: {{..., tensile_strength: 600 MPa}}}}"
            found.append(Fault((*part.path, "material"), message, hint))
    return found + _settings_faults(asked, {part.name: cast(Shaft, part.component) for part in classed}, where)


def _settings_faults(asked: Asked, shafts: Mapping[str, Shaft], where: Path) -> list[Fault]:
    """Settings that name a shaft which the rule does not judge, or a slot that is no feature of it."""
    found, names = [], f"there is {', '.join(shafts)}"
    for position, name in enumerate(asked.alloy):
        if name not in shafts:
            path = (*where, RULE, "alloy", position)
            found.append(Fault(path, f"no shaft with a role is called '{name}'", names))
    for name in asked.slots:
        if name not in shafts or "slot" not in shafts[name].features:
            path = (*where, RULE, "slots", name)
            found.append(
                Fault(path, f"no shaft with a role and the feature `slot` is called '{name}'", names, at_key=True)
            )
    return found


def left_out(study: Study, asked: Asked) -> tuple[tuple[str, str], ...]:
    """What was not judged, and why."""
    found = []
    for _, part in parts_of_kind(study, "shaft"):
        shaft = cast(Shaft, part.component)
        if shaft.role is None:
            found.append((f"{RULE} for {part.name}", "the shaft has no `role`"))
        elif not is_classed(shaft):
            found.append((f"{RULE} for {part.name}", NOT_ROUND))
    if not has_mean_torque(study.operation):
        found.append((f"{RULE}: least diameters", "the rated power is not given"))
    elif not rated_is_computed(study.operation):
        found.append((f"{RULE}: least diameters", "the rated speed is not among the speeds that are computed"))
    return tuple(found)


def check(evidence: Evidence, asked: Asked) -> tuple[Check, ...]:
    """Stress in continuous use, while barred ranges are passed, and above 1.05; least diameter; of every shaft."""
    found: list[Check | None] = []
    for shaft in classed_shafts(evidence.study, asked):
        found += [*_stresses(evidence, shaft, asked), _diameter(evidence, shaft, asked)]
    return tuple(line for line in found if line is not None)


def limits(evidence: Evidence, shaft: str, asked: Asked | None = None) -> Limits:
    """Stress and limits of one shaft over speed, with the study's own settings. Raises KeyError for another name."""
    settings = asked or next((own for name, own in evidence.study.rules if name == RULE), Asked())
    for classed in classed_shafts(evidence.study, cast(Asked, settings)):
        if classed.name == shaft:
            return _limits(evidence, classed)
    raise KeyError(shaft)


def _limits(evidence: Evidence, shaft: ClassedShaft) -> Limits:
    response, synthesis = evidence.vibration()
    spans, modulus = stress_modulus(evidence.system, shaft)
    tau = np.max(synthesis.half_range[:, spans] / modulus * PA, axis=1)
    ratio = response.speed / _rated_speed(evidence.study)
    return Limits(response.speed, shaft.tau_c(ratio), shaft.tau_t(ratio), tau)


def _rated_speed(study: Study) -> float:
    """rad/s of the reference station; raises ValueError where the study has none."""
    if study.operation.rated is None:
        raise ValueError(f"{RULE} needs the rated speed")
    return study.operation.rated.speed


def _stresses(evidence: Evidence, shaft: ClassedShaft, asked: Asked) -> list[Check | None]:
    """The three clauses about the stress amplitude."""
    response, _ = evidence.vibration()
    rated, status = _rated_speed(evidence.study), worst_status(response)
    speed, tau_c, tau_t, tau = _limits(evidence, shaft)
    curve = Curve(speed, tau, tau_c, status)
    barred = barred_ranges(curve, rated, shaft.name, asked.tachometer)
    passed = inside(barred, curve, rated)
    ruled = speed <= LAST_CONTINUOUS * rated * (1 + SAME_SPEED)
    return [
        _continuous(evidence, shaft, curve, ruled & ~passed, barred),
        _passing(evidence, shaft, Curve(speed, tau, tau_t, status), passed, barred, asked),
        _outside(shaft, curve, ~ruled),
    ]


def _continuous(
    evidence: Evidence, shaft: ClassedShaft, curve: Curve, within: BoolArray, barred: tuple[BarredRange, ...]
) -> Check | None:
    """tau <= tau_C outside the barred ranges, up to 1.05."""
    line = judge(_clause(shaft, "tau_C", "synthesis stress amplitude"), curve, within)
    if line is None:
        return None
    mostly = largest_line(evidence.vibration()[0], line, spans_of(evidence.system, shaft.part))
    rest = f"outside the barred range {_words(barred)}" if barred else ""
    coverage = _coverage(curve.speed, _rated_speed(evidence.study))
    return noted(line, mostly, rest, *shaft.notes, coverage)


def _passing(
    evidence: Evidence, shaft: ClassedShaft, curve: Curve, within: BoolArray, barred: tuple[BarredRange, ...],
    asked: Asked,
) -> Check | None:  # fmt: skip
    """tau <= tau_T in the barred ranges, which no keyway allows and which end below 0.8."""
    line = judge(_clause(shaft, "tau_T", "stress amplitude in the barred range"), curve, within)
    if line is None:
        return None
    ceiling = BARRED_BELOW * _rated_speed(evidence.study)
    reasons = [f"{feature}: keyways are not for use with a barred range" for feature in shaft.keyways]
    if any(one.upper > ceiling for one in barred):
        reasons.append(f"the barred range reaches above 0.8 of the rated speed, {in_rpm(ceiling)}")
    verdict: Verdict = "fail" if reasons else line.verdict
    tachometer = f"tachometer tolerance {100 * asked.tachometer:.3g} % " + ("added" if asked.tachometer else "assumed")
    mostly = largest_line(evidence.vibration()[0], line, spans_of(evidence.system, shaft.part))
    found = noted(line, *reasons, f"barred range {_words(barred)}, to be passed rapidly", tachometer, mostly)
    return replace(found, verdict=verdict, barred=barred)


def _outside(shaft: ClassedShaft, curve: Curve, within: BoolArray) -> Check | None:
    """The greatest stress above 1.05 of the rated speed, for which the rule has no limit."""
    if not np.any(within):
        return None
    blank = np.where(within, np.where(np.isfinite(curve.value) & (curve.status == 0), curve.value, np.inf), -np.inf)
    at = worst_of(blank, curve.value)
    line = Check(
        RULE, "tau_C", shaft.name, "stress amplitude above 1.05 of the rated speed", stated(curve.value[at]),
        math.nan, "N/mm2", "outside", float(curve.speed[at]),
    )  # fmt: skip
    return noted(line, status_words(curve, at), "outside the rule: it has no limit above 1.05 of the rated speed")


def _diameter(evidence: Evidence, shaft: ClassedShaft, asked: Asked) -> Check | None:
    """The less favourable end against its least diameter, for the rated mean torque."""
    torque = rated_torque(evidence, spans_of(evidence.system, shaft.part))
    if torque is None:
        return None
    factor = formulas.drive_factor(shaft.role, smooth=asked.drive != "other")
    load = float(np.max(torque)) * KW_PER_RPM
    ends = [
        (outer, formulas.least_diameter(load, shaft.strength, factor, shaft.k, bore / outer))
        for outer, bore in shaft.ends
    ]
    diameter, least = max(ends, key=lambda end: end[1] / end[0])
    kept = "kept" if diameter >= least else "not kept"
    used = f"F {factor:g} (drive: {asked.drive}), k {shaft.k:g}, {load:.5g} kW per rpm"
    return Check(
        RULE, "minimum diameter", shaft.name, "outer diameter, at least", diameter, least, "mm", "to be verified",
        _rated_speed(evidence.study), note=f"{kept}; {used}; {EDITION}", at_least=True,
    )  # fmt: skip


def _clause(shaft: ClassedShaft, clause: str, what: str) -> Clause:
    return Clause(RULE, clause, shaft.name, what, "N/mm2")


def _words(barred: tuple[BarredRange, ...]) -> str:
    return " and ".join(f"{in_rpm(one.lower)} to {in_rpm(one.upper)}" for one in barred)


def _coverage(speed: FloatArray, rated: float) -> str:
    """That the speeds computed end below 1.05 of the rated speed; empty where they do not."""
    if speed[-1] >= LAST_CONTINUOUS * rated * (1 - SAME_SPEED):
        return ""
    return f"judged up to {in_rpm(speed[-1])} only, {speed[-1] / rated:.3g} of the rated speed"
