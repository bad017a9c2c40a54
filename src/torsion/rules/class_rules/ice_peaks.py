"""Rule `ice`: greatest torques of motion over time in ice, against yield of the shafts and ratings of couplings, gears.

From memory of the Finnish-Swedish ice class rules (2017): to be verified against the edition in force.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsion.analyses.motion.events.machine_events import Start
from torsion.analyses.motion.events.milling_ice import CASES, Ice
from torsion.analyses.motion.events.transient_settings import TransientSettings, cases
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.undamped_modes import Modes
from torsion.errors import Fault, Path
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.model.parts import Part
from torsion.rules.demands import in_rpm, unjudged
from torsion.rules.rule_over_speed import RATED, spans_of
from torsion.rules.verdict_line import (
    TO_BE_VERIFIED,
    Check,
    Rule,
    RuleSettings,
    Standing,
    Verdict,
    verdict_of,
)
from torsion.study import Study

PA = 1e-6  # N/mm2
SHEAR = 1.0 / math.sqrt(3.0)  # yield in shear / yield in tension (von Mises)
# beyond the speeds of the operation, within which the first blade order is to meet no mode
MARGIN = 0.2
SAME_SPEED = 0.01  # a motion this near to a resonance is at it
MAKER: Standing = "maker"
STRESS = "Shear stress at the greatest torque in ice"
LACKING = {
    "shaft": "not judged: give `yield_strength` of its material",
    "coupling": "not judged: give `max_torque`",
    "gear": "not judged: give `max_torque`",
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
    def words(self) -> str:
        """What the motion computes: its cases or contact angles, and its name."""
        contacts = (
            f"case {ice.case}"
            if ice.case
            else f"contact over {math.degrees(ice.angle or 0.0):g} deg"
            for _, ice, _ in self.milled
        )
        name = f" ({self.settings.name})" if self.settings.name else ""
        return " and ".join(dict.fromkeys(contacts)) + name


class IcePeaks(Rule[IceSettings]):
    """The rule, as the study reads it."""

    name = "ice"
    edition = "Finnish-Swedish ice class rules 2017"
    settings_class = IceSettings
    needs = ("transient",)
    has_clutches_stuck = False

    def faults(self, study: Study) -> Iterable[Fault]:
        """What the file lacks for this rule."""
        motions, path = ice_motions(study), self.path(study)
        if not motions:
            hint = "analyses: {transient: {duration: 4 s, events: [{at: propeller-1, ice: {class: IA, case: 1}}]}}"
            yield Fault(path, "no transient response has an event `ice`", hint)
            return
        if not any(_limit(study, part, self.settings) for part in study.train.parts):
            message = "no shaft has a yield strength, and no coupling or gear a maximum torque"
            hint = "`yield_strength` of a material, or `max_torque` of a coupling or gear"
            yield Fault(path, message, hint)
        # A motion begins with the mean torques of the operation, or starts.
        steady = [motion.settings.initial in (None, "steady") for motion in motions]
        if any(steady) and not study.has_mean_torque:
            yield Fault(("operation", "rated", "power"), UNDRIVEN, RATED)
        hint = "initial: steady, or an event `start`"
        for motion, is_steady in zip(motions, steady, strict=True):
            starts = any(isinstance(event.body, Start) for event in motion.settings.events)
            if not (is_steady or starts):
                yield Fault((*motion.path, "initial"), UNDRIVEN, hint)

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """What was not judged, and why."""
        for part in study.train.parts:
            is_missing = part.kind in LACKING and not part.is_bar
            if is_missing and _limit(study, part, self.settings) is None:
                yield f"ice for {part.name}", LACKING[part.kind]
        yield (
            "ice for fatigue and for failure of a blade",
            "the rule judges the maximum torques only",
        )

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Of every part with a limit, at the worst of the motions in ice; where one is not ok nothing passes."""
        study = evidence.study
        by_name = {motion.name: motion for motion in evidence.need(Transients).each}
        computed, notes = dict[str, TransientMotion](), list[str]()
        for in_ice in ice_motions(study):
            motion = by_name.get(in_ice.settings.name)
            if motion is not None:
                computed[in_ice.words] = motion
            if doubt := _doubt(evidence, in_ice, motion):
                notes.append(f"{in_ice.words}: {doubt}; such a motion is never a pass")
        is_sound = not notes
        resonances = tuple(_resonances(evidence, list(computed.values())))
        notes += [f"{words} at {where} not judged" for where, words in _missing_cases(study)]
        notes += [words for _, words, _ in resonances]

        for number, part in enumerate(study.train.parts):
            if (limited := _limit(study, part, self.settings)) is None:
                continue
            # The greatest shear stress or torque in every motion, mean torque included; NaN where not known.
            (clause, limit), spans = limited, spans_of(evidence.system, number)
            what, unit, standing, scale = "Greatest torque in ice", "N m", MAKER, 1.0
            if part.is_bar:
                what, unit, standing, scale = STRESS, "N/mm2", TO_BE_VERIFIED, PA
            values = dict[str, float]()
            for words, motion in computed.items():
                amount = motion.stress if part.is_bar else motion.peak
                values[words] = math.nan if amount is None else float(amount[spans].max()) * scale
            verdict: Verdict = "fail"
            note, worst = "no value is known", math.inf
            if values and all(map(math.isfinite, values.values())):
                words, worst = max(values.items(), key=lambda pair: pair[1])
                note = f"worst in {words}"
                verdict = verdict_of(worst <= limit, standing) if is_sound else "fail"
            about = "ice", clause, part.name, what, worst, limit, unit, verdict, standing
            yield Check(*about, note="; ".join((note, *notes)))
        what = "Transient response at the resonance"
        for name, words, is_open in resonances:
            if is_open:
                yield unjudged("ice", "resonance", name, what, words, TO_BE_VERIFIED)

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Cases of the ice rules that no motion has, and shafts without a yield strength."""
        for name, words in _missing_cases(study):
            about = "cases", name, "Cases of the ice rules", f"no motion has {words}"
            yield unjudged("ice", *about, TO_BE_VERIFIED)
        for part in study.train.parts:
            if part.is_bar and _limit(study, part, self.settings) is None:
                about = "yield", part.name, STRESS, LACKING["shaft"]
                yield unjudged("ice", *about, TO_BE_VERIFIED)


def ice_motions(study: Study) -> list[InIce]:
    """The motions with an event `ice`."""
    motions = list[InIce]()
    for settings, path in cases(study):
        milled = tuple(
            (event.at, event.body, event.time)
            for event in settings.events
            if isinstance(event.body, Ice)
        )
        if milled:
            motions.append(InIce(settings, path, milled))
    return motions


def _doubt(evidence: Results, in_ice: InIce, motion: TransientMotion | None) -> str:
    """Why the greatest torques of a motion are no verdict; empty where they are."""
    if motion is None or motion.status != "ok":
        return "no answer" if motion is None else motion.status
    for name, ice, begin in in_ice.milled:
        station = evidence.study.train[name].stations[0]
        ratio, late = abs(float(evidence.system.speed_ratio[station])), motion.time >= begin
        turned = motion.speed_before * ratio * (float(motion.time[-1]) - begin)
        if motion.steps:  # by the angle that it turns in truth
            turned = abs(float(np.trapezoid(motion.speed[station, late], motion.time[late])))
        if turned < 2.0 * math.pi * ice.revolutions * (1.0 - SAME_SPEED):
            return f"it ends before the {ice.revolutions:g} revolutions in ice do: give a longer `duration`"
    return ""


def _missing_cases(study: Study) -> list[tuple[str, str]]:
    """Every propeller with cases that no motion has, and these in words."""
    computed = [(at, ice.case) for motion in ice_motions(study) for at, ice, _ in motion.milled]
    rows = []
    for part in study.train.parts:
        missing = [str(case) for case in CASES if (part.name, case) not in computed]
        if part.propeller is not None and missing:
            rows.append((part.name, f"case{'s' if len(missing) > 1 else ''} {', '.join(missing)}"))
    return rows


def _limit(study: Study, part: Part, settings: IceSettings) -> tuple[str, float] | None:
    """The clause and its limit, N/mm2 of a shaft and N m of a coupling or gear; None where the file gives none."""
    if part.shaft is None or not part.is_bar:
        return part.greatest_torque(is_rare=False)
    strength, factor = study.train.materials[part.shaft.material].yield_strength, settings.factor
    if strength is None:
        return None
    return f"0.577 R_e/{factor:g}", SHEAR * strength * PA / factor


def _resonances(
    evidence: Results, motions: list[TransientMotion]
) -> Iterator[tuple[str, str, bool]]:
    """Where the first blade order of a propeller that mills ice meets a mode: motion over time is then required.

    Its name, the words, and whether no motion is computed at that speed.
    """
    study, operation, modes = evidence.study, evidence.study.operation, evidence.get(Modes)
    speeds = [] if operation.speed is None else [operation.speed]
    if operation.speeds is not None:
        speeds += operation.speeds.first, operation.speeds.last
    if modes is None or not speeds:
        return
    low, high = (1.0 - MARGIN) * min(speeds), (1.0 + MARGIN) * max(speeds)
    milling = (name for motion in ice_motions(study) for name, _, _ in motion.milled)
    for name in dict.fromkeys(milling):
        part = study.train[name]
        if part.propeller is None or not (blades := part.propeller.blades):
            continue
        ratio = abs(float(evidence.system.speed_ratio[part.stations[0]]))
        met = 2.0 * math.pi * modes.frequency / (blades * ratio)
        met = met[(met >= low) & (met <= high)]
        where = f"between {in_rpm(low)} and {in_rpm(high)} the first blade order of {name} meets"
        if not met.size:
            yield name, f"{where} no mode", False
        for speed in met.tolist():
            offsets = (abs(motion.speed_before - speed) for motion in motions)
            is_open = not any(offset <= SAME_SPEED * speed for offset in offsets)
            more = " (none is computed at that speed)" * is_open
            words = (
                f"{where} a mode at {in_rpm(speed)}: the rule then requires motion over time{more}"
            )
            yield name, words, is_open
