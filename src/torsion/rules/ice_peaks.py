"""Rule `ice`: greatest torques of motion over time in ice, against yield of the shafts and ratings of couplings, gears.

From memory of the Finnish-Swedish ice class rules (2017): to be verified against the edition in force.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsion.analyses.motion.following_events import Start
from torsion.analyses.motion.milling_ice import CASES, Ice
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.motion.transient_settings import TransientSettings, cases
from torsion.analyses.undamped_modes import Modes
from torsion.errors import Fault, Path
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.model.lowering import Part
from torsion.rules.demanded_states import unjudged
from torsion.rules.reached_speeds import in_rpm
from torsion.rules.rule_over_speed import RATED, spans_of
from torsion.rules.verdict_line import (
    TO_BE_VERIFIED,
    Check,
    Rule,
    RuleSettings,
    Standing,
    verdict_of,
)
from torsion.study import Study

PA = 1e-6  # N/mm2
SHEAR = 1.0 / math.sqrt(3.0)  # yield in shear / yield in tension (von Mises)
MARGIN = (
    0.2  # beyond the speeds of the operation, within which the first blade order is to meet no mode
)
SAME_SPEED = 0.01  # a motion this near to a resonance is at it
STRESS = "Shear stress at the greatest torque in ice"
LACKING = {
    "shaft": "yield_strength` of its material",
    "coupling": "max_torque`",
    "gear": "max_torque`",
}
UNDRIVEN = (
    "the torque of the drive is not known, and the rule ice judges it together with that of the ice"
)
Factor = Annotated[float, Quantity("1", at_least=1)]


class IceSettings(RuleSettings):
    """Settings of `ice`."""

    factor: Factor = given("safety factor of the shafts against yield (to be verified)", 1.3)


@dataclass(frozen=True)
class InIce:
    """A motion over time in ice, and where it stands in the file."""

    settings: TransientSettings
    path: Path
    milled: tuple[tuple[str, Ice, float], ...]  # propellers, what they mill, and from when (s) on

    @property
    def is_steady(self) -> bool:
        """It begins with the mean torques of the operation."""
        return self.settings.initial in (None, "steady")

    @property
    def words(self) -> str:
        """What it computes."""
        each = (
            f"case {ice.case}"
            if ice.case
            else f"contact over {math.degrees(ice.angle or 0.0):g} deg"
            for _, ice, _ in self.milled
        )
        return " and ".join(dict.fromkeys(each)) + (
            f" ({self.settings.name})" if self.settings.name else ""
        )


class IcePeaks(Rule[IceSettings]):
    """The rule, as the study reads it."""

    name = "ice"
    edition = "Finnish-Swedish ice class rules 2017"
    settings_class = IceSettings
    needs = ("transient",)

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for this rule."""
        motions, here, found = ice_motions(study), self.path(study), list[Fault]()
        if not motions:
            hint = "analyses: {transient: {duration: 4 s, events: [{at: propeller-1, ice: {class: IA, case: 1}}]}}"
            return [Fault(here, "no transient response has an event `ice`", hint)]
        if not any(_limit(study, part, self.settings) for part in study.train.parts):
            hint = "`yield_strength` of a material, or `max_torque` of a coupling or gear"
            found.append(
                Fault(
                    here,
                    "no shaft has a yield strength, and no coupling or gear a maximum torque",
                    hint,
                )
            )
        if any(one.is_steady for one in motions) and not study.has_mean_torque:
            found.append(Fault(("operation", "rated", "power"), UNDRIVEN, RATED))
        undriven = [one for one in motions if not (one.is_steady or _starts(one.settings))]
        hint = "initial: steady, or an event `start`"
        return found + [Fault((*one.path, "initial"), UNDRIVEN, hint) for one in undriven]

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        found = list[tuple[str, str]]()
        for part in study.train.parts:
            if (
                part.kind in LACKING
                and not part.is_bar
                and _limit(study, part, self.settings) is None
            ):
                found.append((f"ice for {part.name}", f"not judged: give `{LACKING[part.kind]}"))
        return (
            *found,
            (
                "ice for fatigue and for failure of a blade",
                "the rule judges the maximum torques only",
            ),
        )

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Of every part with a limit, at the worst of the motions in ice; where one is not ok nothing passes."""
        study, by_name = evidence.study, {one.name: one for one in evidence.need(Transients).each}
        motions = [(one, by_name.get(one.settings.name)) for one in ice_motions(study)]
        every = ((one.words, _doubt(evidence, one, found)) for one, found in motions)
        doubts = [
            f"{words}: {doubt}; such a motion is never a pass" for words, doubt in every if doubt
        ]
        computed = [(one.words, found) for one, found in motions if found is not None]
        resonances = tuple(_resonances(evidence, [found for _, found in computed]))
        open_cases = [f"{words} at {where} not judged" for where, words in _missing(study)]
        notes, lines = (*doubts, *open_cases, *(words for _, words, _ in resonances)), list[Check]()
        for number, part in enumerate(study.train.parts):
            limit = _limit(study, part, self.settings)
            if limit is not None:
                values = {words: _value(evidence, number, part, found) for words, found in computed}
                lines.append(_line(part, limit, values, notes, is_sound=not doubts))
        lines += [
            unjudged(
                self.name,
                "resonance",
                where,
                "Transient response at the resonance",
                words,
                TO_BE_VERIFIED,
            )
            for where, words, is_open in resonances
            if is_open
        ]
        return tuple(lines)

    def demanded_rows(self, study: Study) -> tuple[Check, ...]:
        """Cases of the ice rules that no motion has, and shafts without a yield strength."""
        rows = [
            unjudged(
                self.name,
                "cases",
                at,
                "Cases of the ice rules",
                f"no motion has {words}",
                TO_BE_VERIFIED,
            )
            for at, words in _missing(study)
        ]
        rows += [
            unjudged(
                self.name,
                "yield",
                part.name,
                STRESS,
                f"not judged: give `{LACKING['shaft']}",
                TO_BE_VERIFIED,
            )
            for part in study.train.parts
            if part.is_bar and _limit(study, part, self.settings) is None
        ]
        return tuple(rows)


def _line(
    part: Part,
    limit: tuple[str, float],
    values: dict[str, float],
    notes: tuple[str, ...],
    *,
    is_sound: bool,
) -> Check:
    """The check of one part, by its value in every motion; a value that is not known (NaN) is never a pass."""
    what, unit = (STRESS, "N/mm2") if part.is_bar else ("Greatest torque in ice", "N m")
    is_known = bool(values) and bool(np.isfinite(list(values.values())).all())
    words, worst = max(values.items(), key=lambda pair: pair[1]) if is_known else ("", math.inf)
    standing: Standing = TO_BE_VERIFIED if part.is_bar else "maker"
    verdict = verdict_of(worst <= limit[1], standing) if is_known and is_sound else "fail"
    note = "; ".join((f"worst in {words}" if is_known else "no value is known", *notes))
    return Check(
        "ice", limit[0], part.name, what, worst, limit[1], unit, verdict, standing, note=note
    )


def ice_motions(study: Study) -> list[InIce]:
    """The motions with an event `ice`."""
    found = []
    for settings, path in cases(study):
        milled = tuple(
            (event.at, event.body, event.time)
            for event in settings.events
            if isinstance(event.body, Ice)
        )
        if milled:
            found.append(InIce(settings, path, milled))
    return found


def _doubt(evidence: Results, one: InIce, found: TransientMotion | None) -> str:
    """Why the greatest torques of a motion are no verdict; empty where they are."""
    if found is None or found.status != "ok":
        return "no answer" if found is None else found.status
    for at, ice, begin in one.milled:
        station = evidence.study.train.part(at).stations[0]
        ratio, late = abs(float(evidence.system.speed_ratio[station])), found.time >= begin
        turned = found.speed_before * ratio * (float(found.time[-1]) - begin)
        if found.steps:  # by the angle that it turns in truth
            turned = abs(float(np.trapezoid(found.speed[station, late], found.time[late])))
        if turned < 2.0 * math.pi * ice.revolutions * (1.0 - SAME_SPEED):
            return f"it ends before the {ice.revolutions:g} revolutions in ice do: give a longer `duration`"
    return ""


def _starts(settings: TransientSettings) -> bool:
    """A motor is switched on, and drives the train."""
    return any(isinstance(event.body, Start) for event in settings.events)


def _missing(study: Study) -> list[tuple[str, str]]:
    """Every propeller with cases that no motion has, and these in words."""
    had = [(at, ice.case) for one in ice_motions(study) for at, ice, _ in one.milled]
    found = []
    for part in study.train.parts:
        missing = [str(case) for case in CASES if (part.name, case) not in had]
        if part.propeller is not None and missing:
            found.append((part.name, f"case{'s' if len(missing) > 1 else ''} {', '.join(missing)}"))
    return found


def _limit(study: Study, part: Part, settings: IceSettings) -> tuple[str, float] | None:
    """The clause and its limit, N/mm2 of a shaft and N m of a coupling or gear; None where the file gives none."""
    if part.shaft is None or not part.is_bar:
        return part.greatest_torque(is_rare=False)
    strength = study.train.materials[part.shaft.material].yield_strength
    return (
        None
        if strength is None
        else (f"0.577 R_e/{settings.factor:g}", SHEAR * strength * PA / settings.factor)
    )


def _value(evidence: Results, number: int, part: Part, found: TransientMotion) -> float:
    """The greatest shear stress (N/mm2) or torque (N m) of a part, its mean torque included; NaN where not known."""
    spans = spans_of(evidence.system, number)
    if not part.is_bar:
        return float(found.peak[spans].max())
    return math.nan if found.stress is None else float(found.stress[spans].max()) * PA


def _resonances(
    evidence: Results, motions: list[TransientMotion]
) -> Iterator[tuple[str, str, bool]]:
    """Where the first blade order of a propeller that mills ice meets a mode: motion over time is then required.

    Its name, the words, and whether no motion is computed at that speed.
    """
    operation, known = evidence.study.operation, evidence.get(Modes)
    speeds = [one for one in (operation.speed, operation.speeds and operation.speeds.first) if one]
    speeds += [operation.speeds.last] if operation.speeds is not None else []
    if known is None or not speeds:
        return
    low, high = (1.0 - MARGIN) * min(speeds), (1.0 + MARGIN) * max(speeds)
    for name in dict.fromkeys(at for one in ice_motions(evidence.study) for at, _, _ in one.milled):
        part = evidence.study.train.part(name)
        blades = part.propeller.blades if part.propeller is not None else None
        if not blades:
            continue
        ratio = abs(float(evidence.system.speed_ratio[part.stations[0]]))
        every = 2.0 * math.pi * known.frequency / (blades * ratio)
        met = every[(every >= low) & (every <= high)].tolist()
        where = f"between {in_rpm(low)} and {in_rpm(high)} the first blade order of {name} meets"
        if not met:
            yield name, f"{where} no mode", False
        for speed in met:
            at_it = any(abs(one.speed_before - speed) <= SAME_SPEED * speed for one in motions)
            more = "" if at_it else " (none is computed at that speed)"
            yield (
                name,
                f"{where} a mode at {in_rpm(speed)}: the rule then requires motion over time{more}",
                not at_it,
            )
