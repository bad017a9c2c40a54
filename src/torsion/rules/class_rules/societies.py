"""Rules `kr`, `lr`, `dnv`, `abs`, `bv`, `ccs`, `nk`, `rina`: M68 for line shafts, and what a society has of its own.

Crankshafts and generator shafts are judged by the society's own table where one is known; what is not judged is said.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.errors import Fault, Path
from torsion.fields import given
from torsion.findings import Results
from torsion.model.parts import ShaftRecord
from torsion.results import listed
from torsion.rules import rule_over_speed
from torsion.rules.class_rules.m68 import M68
from torsion.rules.class_rules.m68_shafts import Drive, M68Settings
from torsion.rules.class_rules.shaft_limits import (
    MM,
    PA,
    ROUNDING,
    LimitedShaft,
    diameters,
    with_role,
)
from torsion.rules.class_rules.society_limits import (
    ALLOY_CAP,
    CARBON_CAP,
    CCS_CRANK,
    KR_IN_LINE,
    KR_OTHER,
    KR_SET_CRANK,
    KR_SET_SHAFT,
    SOCIETIES,
    Duty,
    crank_curve,
    set_curve,
    strength_factor,
    yield_factor,
)
from torsion.rules.demands import (
    MISFIRE,
    STIFFNESS,
    coverage,
    engines_of,
    is_varied,
    unjudged,
    unknown_gears,
)
from torsion.rules.rule_over_speed import Clause, rated_speed
from torsion.rules.strength.gear_hammer import VIBRATORY, meshes
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, verdict_of
from torsion.study import Study

OTHER_ROLES = ("crank", "generator")
MAJORS_FROM = {"propulsion": 0.8, "generator set": 0.9}  # speed ratio, up to 1.1 (KR 5-4-204)
MAJORS_TO = 1.1
MAJOR = "major critical speed"  # clause
DUTIES: Mapping[str | None, Duty] = {
    "propeller": "propulsion",
    "generator": "generator set",
}  # by role of what is driven
DRIVES: Mapping[str, Drive] = {"motor": "electric", "turbine": "turbine"}  # by kind of component
AGREEMENT = "limits by agreement with KR, values of 202.1: 202.2 has none for `drive: {}`"


class SocietySettings(M68Settings):
    """Settings of the rule set of a society: those of `iacs-m68`."""


class LrSettings(SocietySettings):
    """Settings of `lr`."""

    tachometer: fields.Tolerance = given(
        "tolerance of the tachometer, added to both ends of a barred range (2 % to be verified)",
        0.02,
    )


class CrankSettings(SocietySettings):
    """Settings of the rule set of a society that has limits of crankshafts."""

    strokes: Literal[2, 4] | None = given(
        "strokes of a cycle of the engine (default: the less favourable)"
    )
    arrangement: Literal["in-line", "V45", "V60", "other V"] | None = given(
        "of its cylinders, a V with its angle in degrees (default: the less favourable)"
    )
    cylinders: Annotated[int, Field(ge=1, le=100)] | None = given(
        "of the engine, for its major critical speeds"
    )
    duty: Duty = given("what the engine drives", "propulsion")


class SocietyRule(M68):
    """The rule set of one society: M68 for line shafts, and of some a table for crankshafts and generator shafts."""

    settings_class = SocietySettings

    def __init__(self, settings: M68Settings, name: str) -> None:
        super().__init__(settings, name)
        self.society = society = SOCIETIES[name]
        self.title, self.mark, self.scope = society.title, society.mark, society.scope
        self.letters = society.letters
        # The engine, of societies with tables by the engine, those of KR; the other table goes by the diameter.
        self.engine = settings if isinstance(settings, CrankSettings) else None
        if self.engine is not None:
            self.needs = (*M68.needs, "modes")
            self.has_limits_of = (*M68.has_limits_of, *OTHER_ROLES)
        elif society.crank:
            self.has_limits_of = (*M68.has_limits_of, "crank")

    def edition_of(self, check: Check, study: Study) -> str:
        """Return the text of the society that limits line shafts, or that of crankshafts and generator shafts."""
        names = {part.name for _, part, _ in with_role(study.train, *OTHER_ROLES)}
        is_other = check.where in names or check.clause == MAJOR
        return (is_other and self.society.crank_edition) or self.society.edition

    def shafts(self, study: Study) -> Iterator[LimitedShaft]:
        """Yield line shafts by the formulas of M68 under the society's names, others by the society's own table."""
        # A train without an engine is driven by the motor or turbine of the file, if the rule does not state another.
        society, drive, mark = self.society, self.settings.drive, self.society.crank_mark
        kinds = {part.kind for part in study.train.parts}
        if drive == "other" and "engine" not in kinds and not any(with_role(study.train, "crank")):
            drive = next((word for kind, word in DRIVES.items() if kind in kinds), drive)
        agreed = () if drive == "other" or self.name != "kr" else (AGREEMENT.format(drive),)
        for shaft in super().shafts(study):
            standing = shaft.standing if society.mark == "rule text" else society.mark
            restrictions = (*shaft.restrictions, *agreed)
            yield replace(shaft, standing=standing, restrictions=restrictions)

        roles = [role for role in OTHER_ROLES if role in self.has_limits_of]
        for number, part, record in with_role(study.train, *roles):
            if self.engine is None:  # a table by diameter, of which the greatest limits most
                diameter = max(outer for outer, _ in diameters(study.train, number)) * MM
                curve = crank_curve(CCS_CRANK, society.letters, diameter)
                notes: tuple[str, ...] = (f"diameter {diameter:.4g} mm",)
                yield LimitedShaft(number, part.name, curve, mark, notes)
                continue

            material = study.train.materials[record.material]
            tensile = (material.tensile_strength or 0.0) * PA
            is_alloy = not {part.name, part.whole}.isdisjoint(self.settings.alloy)
            strength = strength_factor(tensile, alloy=is_alloy)
            yields = yield_factor((material.yield_strength or 0.0) * PA)
            cap = ALLOY_CAP if is_alloy else CARBON_CAP
            beyond = f"strength above {cap:g} N/mm2 by agreement with {society.title}"
            restrictions = (beyond,) if tensile > cap * (1 + ROUNDING) else ()

            factor, (engine, is_better) = min(strength, yields), _kind(self.engine)
            curve = set_curve(KR_SET_SHAFT, factor)
            notes = "generator shaft", f"f_m {factor:.4g}"
            if record.role == "crank" and self.engine.duty == "propulsion":
                table = KR_IN_LINE if is_better else KR_OTHER
                curve = crank_curve(table, society.letters, 0.0, strength, yields)
                factors = f"f_m {strength:.4g}, of tau_2 {yields:.4g}"
                notes = engine, factors, "without a calculation by IACS UR M53"
            elif record.role == "crank":
                limits = KR_SET_CRANK["in-line" if is_better else "other"]
                curve, notes = set_curve(limits, factor), (engine, notes[1])
            yield LimitedShaft(number, part.name, curve, mark, notes, restrictions=restrictions)

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield the vibratory torque of gears, where the society limits it."""
        share = self.society.mesh
        if share is None or rule_over_speed.rated_torque(evidence) is None:
            return
        response = evidence.need(Response)
        reach = coverage(float(response.speed[-1]), rated_speed(evidence.study))
        for mesh in meshes(evidence):
            if mesh.rated > 0:
                yield self.compare(
                    response,
                    ("gears", mesh.name, VIBRATORY),
                    TO_BE_VERIFIED,
                    mesh.vibratory,
                    share * mesh.rated,
                    spans=mesh.spans,
                    notes=(f"{share:.4g} x {mesh.rated:.5g} N m", reach),
                )

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Yield what was not judged, and why; nothing is skipped silently."""
        yield from super().left_out(study)
        train, named = study.train, dict(study.rules)
        for what, why in self.society.not_judged:
            yield f"{self.name}: {what}", why
        if any(train.of_kind("gear")) and self.society.mesh is None and "gear-hammer" not in named:
            why = "the rule `gear-hammer` judges them, and the file does not name it"
            yield f"{self.name}: gears", why
        if any(part.ratings is not None for part in train.parts) and "coupling-maker" not in named:
            judges = "the rule `coupling-maker` judges their torque and heat"
            yield f"{self.name}: couplings", f"{judges}, and the file does not name it"

    def _settings_faults(
        self, study: Study, shafts: Mapping[str, ShaftRecord], where: Path
    ) -> Iterator[Fault]:
        """Yield the faults of M68, and settings of an engine that no engine of the file has."""
        yield from super()._settings_faults(study, shafts, where)
        if (settings := self.engine) is None:
            return
        roles = {shaft.role for shaft in shafts.values()}
        driven = roles & {"propeller", "generator"}
        right = DUTIES[next(iter(driven))] if len(driven) == 1 else settings.duty
        if "crank" in roles and settings.duty != right:
            message = f"`duty` {settings.duty} of {self.name} contradicts the shaft of role {listed(map(str, driven))}"
            yield Fault(where, message, f"duty: {right}, or another `role` of the shaft")

        engines = engines_of(study)
        stated = {
            "strokes": (settings.strokes, [2 * engine.revolutions for engine in engines]),
            "cylinders": (settings.cylinders, [len(engine.cylinders) for engine in engines]),
        }
        for key, (value, values) in stated.items():
            if value is not None and values and value not in values:
                message = f"`{key}` {value} of {self.name} contradicts the engine of the file, which has {values[0]}"
                hint = f"{key}: {values[0]}, or leave it out"
                yield Fault((*where, self.name, key), message, hint)

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Yield the rows of M68, of crankshafts and gears of unknown size or torque, and of other stiffnesses."""
        society, engine = self.society, self.engine
        # A generator set has no propulsion to misfire.
        is_set = engine is not None and engine.duty == "generator set"
        for row in super().demanded_rows(study):
            if not (is_set and row.clause == MISFIRE):
                yield row
        cranks = [part.name for _, part, _ in with_role(study.train, "crank")]
        what, note = (
            "Torsional stress amplitude of the crankshaft",
            "`journal` of the engine is not given",
        )
        for part in study.train.parts if society.crank and not cranks else ():
            if part.engine is not None:
                about = "crankshaft", part.name, what, note
                yield unjudged(self.name, *about, society.crank_mark)
        # Major critical speeds of an engine, in line as far as is known, of unknown cylinders.
        is_in_line = engine is not None and engine.arrangement in (None, "in-line")
        if society.has_majors and cranks and is_in_line and not self._cylinders(study):
            note = "`cylinders` of the engine is not given"
            about = MAJOR, cranks[0], "Major critical speeds", note
            yield unjudged(self.name, *about, society.crank_mark)
        if society.mesh is not None:
            yield from unknown_gears(self.name, study, TO_BE_VERIFIED)
        rated = [
            (part, ratings)
            for part in study.train.parts
            if part.kind == "coupling" and (ratings := part.ratings) is not None
        ]
        varied = [
            part.name
            for part, _ in rated
            if is_varied(study, self.name, part, "stiffness", part.stiffness_tolerance)
        ]
        # Couplings that can be cold, warm, soft or stiff as far as the file says so; else any of them.
        soft = [
            part.name
            for part, ratings in rated
            if ratings.limit_anything or ratings.tolerance or "psi" in (part.damping or ())
        ]
        unvaried = [name for name in soft if name not in varied]
        if not soft and not varied:
            unvaried = [part.name for part, _ in rated]
        if unvaried:
            note = (
                f"cold, warm, soft and stiff couplings: cases with another stiffness of {listed(unvaried)}, "
                "at both ends of a tolerance (`cases: {from: tolerances}`)"
            )
            about = STIFFNESS, unvaried[0], "Other stiffness of the couplings", note
            yield unjudged(self.name, *about, society.mark)

    def check(self, evidence: Results) -> tuple[Check, ...]:
        """Return all checks, and last where major critical speeds lie.

        They are of every mode with one node that of the order of the number of cylinders, and of half of it of four
        strokes. Where the strokes are not given both are judged; without a crankshaft those of the reference's speed.
        """
        checks, cylinders = list(super().check(evidence)), self._cylinders(evidence.study)
        if self.engine is None or not self.society.has_majors or not cylinders:
            return tuple(checks)
        first, rated = MAJORS_FROM[self.engine.duty], rated_speed(evidence.study)
        ratios = {part.ratio for _, part, _ in with_role(evidence.study.train, "crank")}
        divisors = (1,) if self.engine.strokes == 2 else (1, 2)
        orders = {
            Fraction(cylinders, divisor) * ratio
            for ratio in ratios or {Fraction(1)}
            for divisor in divisors
        }
        modes, mark = evidence.need(Modes), self.society.crank_mark
        for mode in np.flatnonzero(modes.nodes == 1).tolist():
            for order in sorted(orders, reverse=True):
                speed = 2.0 * math.pi * float(modes.frequency[mode]) / float(order)
                ratio = speed / rated
                is_above = ratio > (first + MAJORS_TO) / 2.0
                major = Check(
                    self.name,
                    MAJOR,
                    f"mode {mode + 1}",
                    f"Major critical speed of order {order} / rated speed",
                    ratio,
                    MAJORS_TO if is_above else first,
                    "1",
                    verdict_of(ratio >= MAJORS_TO if is_above else ratio <= first, mark),
                    mark,
                    speed,
                    order,
                    f"not within {first:g} to {MAJORS_TO:g}",
                    at_least=is_above,
                )
                checks.append(major)
        return tuple(checks)

    def _cylinders(self, study: Study) -> int:
        """Return the cylinders by the setting, else of an engine in line, the only one of the file; 0 if not known."""
        if self.engine is not None and self.engine.cylinders is not None:
            return self.engine.cylinders
        engines = engines_of(study)
        if len(engines) != 1 or len(engines[0].throws) != len(engines[0].cylinders):
            return 0
        return len(engines[0].cylinders)


class LloydsRule(SocietyRule):
    """The rule set of LR, with a tolerance of the tachometer of its own."""

    settings_class = LrSettings


class EngineSocietyRule(SocietyRule):
    """The rule set of a society with tables of crankshafts and generator shafts by the engine, those of KR."""

    settings_class = CrankSettings


def _kind(settings: CrankSettings) -> tuple[str, bool]:
    """Return the engine in words, and whether the higher limits hold: four strokes, in line or a V of 45 or 60 degrees."""
    if settings.strokes == 2 or settings.arrangement == "other V":
        return "two-stroke, or another V than of 45 or 60 degrees", False
    values = {"strokes": settings.strokes, "arrangement": settings.arrangement}
    if missing := " and ".join(key for key, value in values.items() if value is None):
        return f"{missing} of the engine not given, the less favourable taken", False
    return f"four-stroke, {settings.arrangement}", True
