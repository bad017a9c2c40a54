"""Rules `kr`, `lr`, `dnv`, `abs`, `bv`, `ccs`, `nk`, `rina`: M68 for line shafts, and what a society has of its own.

Crankshafts and generator shafts are judged by the society's own table where one is known; what is not judged is said.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.components.lowering import ShaftRecord
from torsion.errors import Fault, Path
from torsion.fields import given
from torsion.findings import Results
from torsion.results import listed
from torsion.rules import judgement, society_limits
from torsion.rules.demanded_states import MISFIRE, stiffness_row, unjudged, unknown_gears
from torsion.rules.gear_hammer import VIBRATORY, meshes
from torsion.rules.judgement import MOSTLY, Clause, curve_of, rated_speed
from torsion.rules.m68 import M68
from torsion.rules.m68_shafts import M68Settings
from torsion.rules.reached_speeds import coverage
from torsion.rules.shaft_limits import (
    MM,
    PA,
    ROUNDING,
    LimitCurve,
    LimitedShaft,
    diameters,
    with_role,
)
from torsion.rules.society_limits import Duty, Society
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
DRIVES = {"motor": "electric", "turbine": "turbine"}  # by kind of component, as `drive` has them
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
    """The rule set of one society."""

    def __init__(self, name: str) -> None:
        self.name, self.society = name, society_limits.SOCIETIES[name]
        self.title, self.mark = self.society.title, self.society.mark
        self.scope = self.society.scope
        self.has_limits_of, self.is_pointwise = M68.has_limits_of, not self.society.has_majors
        self.settings: type[M68Settings] = LrSettings if name == "lr" else SocietySettings
        if self.society.crank == "kr":
            self.has_limits_of, self.needs = (
                (*M68.has_limits_of, *OTHER_ROLES),
                (*M68.needs, "modes"),
            )
            self.settings = CrankSettings
        elif self.society.crank:
            self.has_limits_of = (*M68.has_limits_of, "crank")

    def edition_of(self, check: Check, study: Study) -> str:
        """Return the text of the society that limits line shafts, or that of crankshafts and generator shafts."""
        others = {
            study.train.parts[part].name for part, _, _ in with_role(study.train, *OTHER_ROLES)
        }
        is_other = check.where in others or check.clause == MAJOR
        return (
            self.society.crank_edition
            if is_other and self.society.crank_edition
            else self.society.edition
        )

    def shafts(self, study: Study, settings: M68Settings) -> Iterator[LimitedShaft]:
        """Line shafts by the formulas of M68, others by the society's own table."""
        for shaft in super().shafts(study, settings):
            standing = shaft.standing if self.society.mark == "rule text" else self.society.mark
            drive = _drive(study, settings)
            by_agreement = (
                () if drive == "other" or self.name != "kr" else (AGREEMENT.format(drive),)
            )
            yield replace(
                shaft,
                curve=_in_letters(shaft.curve, self.society),
                standing=standing,
                restrictions=(*shaft.restrictions, *by_agreement),
            )
        for part, _, record in with_role(study.train, *OTHER_ROLES):
            if record.role in self.has_limits_of:
                yield self._other(study, settings, part, record)

    def _other(
        self, study: Study, settings: M68Settings, part: int, record: ShaftRecord
    ) -> LimitedShaft:
        """A crankshaft or generator shaft."""
        name, whole, society = (
            study.train.parts[part].name,
            study.train.parts[part].whole,
            self.society,
        )
        ends = diameters(study.train, part)
        if not isinstance(
            settings, CrankSettings
        ):  # a table by diameter alone, which the greatest limits most
            diameter = max(outer for outer, _ in ends) * MM
            curve = society_limits.crank_curve(society_limits.CCS_CRANK, society.letters, diameter)
            return LimitedShaft(
                part, name, curve, society.crank_mark, (f"diameter {diameter:.4g} mm",)
            )
        material = study.train.materials[record.material]
        known = [
            None if one is None else one * PA
            for one in (material.tensile_strength, material.yield_strength)
        ]
        is_alloy = not {name, whole}.isdisjoint(settings.alloy)
        strength = society_limits.strength_factor(known[0], alloy=is_alloy)
        most = society_limits.ALLOY_CAP if is_alloy else society_limits.CARBON_CAP
        agreed = tuple[str, ...]()
        if (known[0] or 0.0) > most * (1 + ROUNDING):
            agreed = (f"strength above {most:g} N/mm2 by agreement with {society.title}",)
        yields = society_limits.yield_factor(known[1])
        engine, is_better = _engine(settings)
        if record.role == "crank" and settings.duty == "propulsion":
            table = society_limits.KR_IN_LINE if is_better else society_limits.KR_OTHER
            curve = society_limits.crank_curve(table, society.letters, 0.0, strength, yields)
            notes = (
                engine,
                f"f_m {strength:.4g}, of tau_2 {yields:.4g}",
                "without a calculation by IACS UR M53",
            )
            return LimitedShaft(part, name, curve, society.crank_mark, notes, restrictions=agreed)
        rows = society_limits.KR_SET_CRANK["in-line" if is_better else "other"]
        rows, about = (
            (rows, engine)
            if record.role == "crank"
            else (society_limits.KR_SET_SHAFT, "generator shaft")
        )
        factor = min(strength, yields)
        curve = society_limits.set_curve(rows, factor)
        about_set = about, f"f_m {factor:.4g}"
        return LimitedShaft(part, name, curve, society.crank_mark, about_set, restrictions=agreed)

    def _settings_faults(
        self, study: Study, settings: M68Settings, shafts: Mapping[str, ShaftRecord], where: Path
    ) -> list[Fault]:
        """Those of M68, and settings of an engine that no engine of the file has."""
        found = super()._settings_faults(study, settings, shafts, where)
        engines = [part.engine for part in study.train.parts if part.engine is not None]
        if not isinstance(settings, CrankSettings):
            return found
        roles = {shaft.role for shaft in shafts.values()}
        driven = roles & {"propeller", "generator"}
        right = DUTIES[next(iter(driven))] if len(driven) == 1 else settings.duty
        if "crank" in roles and settings.duty != right:
            message = f"`duty` {settings.duty} of {self.name} contradicts the shaft of role {listed(map(str, driven))}"
            found.append(Fault(where, message, f"duty: {right}, or another `role` of the shaft"))
        if not engines:
            return found
        stated = {
            "strokes": (settings.strokes, [2 * engine.revolutions for engine in engines]),
            "cylinders": (settings.cylinders, [len(engine.cylinders) for engine in engines]),
        }
        for key, (value, values) in stated.items():
            if value is not None and value not in values:
                message = f"`{key}` {value} of {self.name} contradicts the engine of the file, which has {values[0]}"
                found.append(
                    Fault((*where, self.name, key), message, f"{key}: {values[0]}, or leave it out")
                )
        return found

    def clauses(self, evidence: Results, settings: M68Settings) -> Iterator[Clause]:
        """Vibratory torque of gears, where the society limits it."""
        if self.society.mesh is None or judgement.rated_torque(evidence) is None:
            return
        response = evidence.need(Response)
        reach = coverage(float(response.speed[-1]), rated_speed(evidence.study))
        for mesh in meshes(evidence):
            if mesh.rated > 0:
                curve = curve_of(response, mesh.vibratory, self.society.mesh * mesh.rated)
                notes = f"{self.society.mesh:.4g} x {mesh.rated:.5g} N m", reach, MOSTLY
                within = np.ones(len(curve.speed), dtype=bool)
                yield Clause(
                    "gears",
                    mesh.name,
                    VIBRATORY,
                    TO_BE_VERIFIED,
                    curve,
                    within,
                    "N m",
                    notes,
                    mesh.spans,
                )

    def left_out(self, study: Study, settings: M68Settings) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why; nothing is skipped silently."""
        found = [
            *super().left_out(study, settings),
            *((f"{self.name}: {what}", why) for what, why in self._open(study)),
        ]
        return tuple(found)

    def _open(self, study: Study) -> Iterator[tuple[str, str]]:
        """What the society wants besides, with where it is to be had."""
        train, named = study.train, {name for name, _ in study.rules}
        yield from self.society.not_judged
        has_gears, limits = (
            any(train.of_kind("gear")),
            [part.ratings for part in train.parts if part.ratings is not None],
        )
        if has_gears and self.society.mesh is None and "gear-hammer" not in named:
            yield "gears", "the rule `gear-hammer` judges them, and the file does not name it"
        if limits and "coupling-maker" not in named:
            yield (
                "couplings",
                "the rule `coupling-maker` judges their torque and heat, and the file does not name it",
            )

    def demanded_rows(self, study: Study, settings: M68Settings) -> tuple[Check, ...]:
        """Those of M68, and couplings at another stiffness; a generator set has no propulsion to misfire."""
        rows = super().demanded_rows(study, settings)
        if isinstance(settings, CrankSettings) and settings.duty == "generator set":
            rows = tuple(row for row in rows if row.clause != MISFIRE)
        rows = (*rows, *self._unknown_cranks(study), *self._missing_majors(study, settings))
        gears = (
            unknown_gears(self.name, study, TO_BE_VERIFIED) if self.society.mesh is not None else ()
        )
        return (*rows, *gears, *stiffness_row(self.name, study, self.society.mark))

    def _unknown_cranks(self, study: Study) -> Iterator[Check]:
        """Yield a row for each engine without the diameter of its journals, where the society limits crankshafts."""
        if not self.society.crank:
            return
        known = {number for number, _, _ in with_role(study.train, "crank")}
        for part in study.train.parts:
            if part.engine is not None and not known:
                note = "`journal` of the engine is not given"
                what = "Torsional stress amplitude of the crankshaft"
                yield unjudged(
                    self.name, "crankshaft", part.name, what, note, self.society.crank_mark
                )

    def _missing_majors(self, study: Study, settings: M68Settings) -> Iterator[Check]:
        """Yield the row about major critical speeds of an engine, in line as far as is known, of unknown cylinders."""
        if not (self.society.has_majors and isinstance(settings, CrankSettings)) or _cylinders(
            study, settings
        ):
            return
        cranks = [part.name for _, part, _ in with_role(study.train, "crank")]
        if cranks and settings.arrangement in (None, "in-line"):
            note, mark = "`cylinders` of the engine is not given", self.society.crank_mark
            yield unjudged(
                self.name, "major critical speed", cranks[0], "Major critical speeds", note, mark
            )

    def check(self, evidence: Results, settings: M68Settings) -> tuple[Check, ...]:
        """Stresses and least diameters, and where major critical speeds lie."""
        majors = self._majors(evidence, settings) if self.society.has_majors else ()
        return (*super().check(evidence, settings), *majors)

    def _majors(self, evidence: Results, settings: M68Settings) -> Iterator[Check]:
        """Of every mode with one node, the order of the number of cylinders, and half of it of four strokes.

        Where the strokes are not given both orders are judged; without a crankshaft those of the reference's speed.
        """
        cylinders = _cylinders(evidence.study, settings)
        if not isinstance(settings, CrankSettings) or not cylinders:
            return
        first, rated = MAJORS_FROM[settings.duty], rated_speed(evidence.study)
        modes = evidence.need(Modes)
        cranks = {part.ratio for _, part, _ in with_role(evidence.study.train, "crank")} or {
            Fraction(1)
        }
        parts = (1,) if settings.strokes == 2 else (1, 2)
        orders = {Fraction(cylinders, part) * ratio for ratio in cranks for part in parts}
        for mode in np.flatnonzero(modes.nodes == 1).tolist():
            for order in sorted(orders, reverse=True):
                speed = 2.0 * math.pi * float(modes.frequency[mode]) / float(order)
                is_above = speed / rated > (first + MAJORS_TO) / 2.0
                limit = MAJORS_TO if is_above else first
                is_kept = speed / rated >= limit if is_above else speed / rated <= limit
                what = f"Major critical speed of order {order} / rated speed"
                yield Check(
                    self.name,
                    MAJOR,
                    f"mode {mode + 1}",
                    what,
                    speed / rated,
                    limit,
                    "1",
                    verdict_of(is_kept, self.society.crank_mark),
                    self.society.crank_mark,
                    speed,
                    order,
                    f"not within {first:g} to {MAJORS_TO:g}",
                    at_least=is_above,
                )


def _drive(study: Study, settings: M68Settings) -> str:
    """What drives, as the rule states it, else of a train without an engine a motor or turbine of the file."""
    kinds = {part.kind for part in study.train.parts}
    has_engine = "engine" in kinds or any(True for _ in with_role(study.train, "crank"))
    if settings.drive != "other" or has_engine:
        return settings.drive
    return next((word for kind, word in DRIVES.items() if kind in kinds), settings.drive)


def _in_letters(curve: LimitCurve, society: Society) -> LimitCurve:
    """The limits of M68 under the names that a society gives them."""
    pieces = tuple(replace(piece, clause=society.letters[0]) for piece in curve.pieces)
    return LimitCurve(pieces, curve.passing and replace(curve.passing, clause=society.letters[1]))


def _cylinders(study: Study, settings: M68Settings) -> int:
    """Cylinders of the engine by the rule, else by an engine in line, the only one of the file; 0 where not known."""
    if isinstance(settings, CrankSettings) and settings.cylinders is not None:
        return settings.cylinders
    engines = [part.engine for part in study.train.parts if part.engine is not None]
    sizes = {
        len(engine.cylinders) for engine in engines if len(engine.throws) == len(engine.cylinders)
    }
    return sizes.pop() if len(sizes) == 1 == len(engines) else 0


def _engine(settings: CrankSettings) -> tuple[str, bool]:
    """The engine in words, and whether the higher limits are its: four strokes, in line or a V of 45 or 60 degrees."""
    lacks = [
        word
        for word, value in (("strokes", settings.strokes), ("arrangement", settings.arrangement))
        if value is None
    ]
    if settings.strokes == 2 or settings.arrangement == "other V":
        return "two-stroke, or another V than of 45 or 60 degrees", False
    if lacks:
        return f"{' and '.join(lacks)} of the engine not given, the less favourable taken", False
    return f"four-stroke, {settings.arrangement}", True
