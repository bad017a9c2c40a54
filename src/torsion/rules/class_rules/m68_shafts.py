"""A shaft as IACS UR M68 (Rev. 3, 2021) sees it: factors of its features, formulas, and what they take for it.

Diameters in mm, stresses in N/mm2. "rule text" was compared with a class society's printed rules (KR 2025, Part 5,
Ch. 4); "to be verified" is to be compared with the edition in force before it is relied on.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, Literal, cast, get_args

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from torsion import fields
from torsion.arrays import FloatArray
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.model.parts import ShaftRecord
from torsion.rules.class_rules.shaft_limits import (
    MM,
    PA,
    ROUNDING,
    LimitCurve,
    LimitedShaft,
    Mark,
    Piece,
    diameters,
    with_role,
)
from torsion.rules.demands import BARRED_BELOW
from torsion.rules.verdict_line import RuleSettings, refuse_blank
from torsion.study import Study

Drive = Literal["turbine", "electric", "slip coupling", "other"]
Role = Literal["intermediate", "thrust", "propeller"]
ROLES = get_args(Role)
Ends = tuple[tuple[float, float], tuple[float, float]]

LAST_CONTINUOUS = 1.05  # speed ratio above which the rule has no limit
FLAT_FROM = 0.9  # speed ratio from which tau_C no longer falls


@dataclass(frozen=True)
class Detail:
    """What a design feature does to the permissible stress (C_K) and to the least diameter (k)."""

    c_k: float
    k: float
    has_keyway: bool = False
    condition: str = ""  # what the factor assumes
    c_k_mark: Mark = "rule text"


DETAILS: Mapping[str, Detail] = {
    "flange": Detail(1.0, 1.0),
    "shrink fit": Detail(1.0, 1.0),
    "taper keyway": Detail(0.60, 1.10, has_keyway=True),
    "cylinder keyway": Detail(0.45, 1.10, has_keyway=True),
    "radial hole": Detail(0.50, 1.10, condition="hole at most 0.3 of the diameter"),
    "slot": Detail(0.30, 1.20),
    "thrust collar": Detail(0.85, 1.10),
    "roller bearing": Detail(0.85, 1.10),
    "propeller flange": Detail(0.55, 1.22),
    "propeller keyless": Detail(0.55, 1.22),
    "propeller keyed": Detail(0.55, 1.26, has_keyway=True),
    "tube shaft": Detail(0.80, 1.15, condition="forward of the aftmost bearing"),
}
ASSUMED: Mapping[Role, Detail] = {  # for a shaft whose features are not given
    "intermediate": Detail(1.0, 1.0, condition="integral flange assumed"),
    "thrust": Detail(0.85, 1.10, condition="thrust collar assumed"),
    "propeller": Detail(
        0.55, 1.26, condition="kind of propeller mounting not given, the least favourable taken"
    ),
}
OF_ROLE: Mapping[Role, frozenset[str]] = {  # features that state the factor of a role
    "intermediate": frozenset(DETAILS),
    "thrust": frozenset({"thrust collar", "roller bearing"}),
    "propeller": frozenset(
        {"propeller flange", "propeller keyless", "propeller keyed", "tube shaft"}
    ),
}
STRENGTH_CAP = 600.0  # N/mm2, the greatest tensile strength that counts (rule text)
ALLOY_STRENGTH_CAP = 800.0  # N/mm2, of intermediate and thrust shafts of alloy steel (rule text)
MOST_CARBON_STRENGTH = 760.0  # N/mm2 of carbon and C-Mn steel (rule text, M68.3)
LEAST_STRENGTH_IN_BARRED_RANGE = 500.0  # N/mm2, where the stress comes near tau_T (rule text)
NEAR_TRANSIENT = 0.8  # of tau_T: near it; ours, since the text has no number
MOST_SLOT_LENGTH = 0.8  # of the diameter (rule text, note 4), as the next two
MOST_SLOT_BORE = 0.7
LEAST_SLOT_WIDTH = 0.15
SLOT_NUMBERS = 1, 2, 3  # at 360, 180 and 120 degrees
SLOT_FACTOR = (
    1.45  # C_K of a longitudinal slot times its stress concentration factor (to be verified)
)
LEAST_FLANGE_FILLET = 0.08  # of the diameter, of an integral flange (to be verified)
LEAST_STRENGTH = 400.0  # N/mm2 of shaft steel; taken for the built-in steel, of which none is stated (to be verified)
SEAT = "shrink fit of '{}': seat 1 to 2 % thicker, with a blending radius of about that change"  # (rule text, note 1)
SMOOTH_DRIVE_FACTOR = (
    95.0  # F of intermediate shafts behind a turbine, motor or slip coupling (to be verified)
)
DRIVE_FACTOR = 100.0  # F of any other drive and any other shaft (to be verified)


def used_strength(strength: float, role: Role, *, alloy: bool) -> float:
    """Return the tensile strength that may be used (rule text)."""
    return min(strength, ALLOY_STRENGTH_CAP if alloy and role != "propeller" else STRENGTH_CAP)


def size_factor(diameter: float) -> float:
    """Return C_D = 0.35 + 0.93 d^-0.2 (rule text)."""
    return float(0.35 + 0.93 * diameter**-0.2)


def tau_c(strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike) -> FloatArray:
    """Return the stress amplitude permissible in continuous use (rule text); NaN above 1.05 of the rated speed."""
    ratio = np.asarray(speed_ratio, dtype=float)
    shape = np.where(ratio < FLAT_FROM, 3.0 - 2.0 * ratio**2, 1.38)
    limit = (strength + 160.0) / 18.0 * c_k * size_factor(diameter) * shape
    return np.asarray(np.where(ratio <= LAST_CONTINUOUS * (1 + ROUNDING), limit, np.nan))


def tau_t(strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike) -> FloatArray:
    """Return the stress amplitude permissible in passing, 1.7 tau_C/sqrt(C_K) (rule text); NaN above 0.8."""
    ratio = np.asarray(speed_ratio, dtype=float)
    limit = 1.7 * tau_c(strength, diameter, c_k, ratio) / np.sqrt(c_k)
    return np.asarray(np.where(ratio <= BARRED_BELOW * (1 + ROUNDING), limit, np.nan))


def slot_concentration(diameter: float, bore: float, length: float, width: float) -> float:
    """Return the stress concentration factor of a longitudinal slot, at least 2.15 (to be verified)."""
    e, hollow = width / diameter, bore / diameter
    a = 2.3 - 3.0 * e + 15.0 * e**2 + 10.0 * e**2 * hollow**2
    return float(a + 0.8 * (length - width) / diameter / np.sqrt((1.0 - hollow) * e))


def least_diameter(
    power_per_speed: float, strength: float, factor: float, k: float, bore_share: float = 0.0
) -> float:
    """Return the least diameter, mm (to be verified), from kW per rpm, F and k; a bore up to 0.4 of it does not count."""
    hollow = 1.0 - bore_share**4 if bore_share > 0.4 else 1.0
    return float(
        factor * k * (power_per_speed / hollow * 560.0 / (strength + 160.0)) ** (1.0 / 3.0)
    )


class Slot(Declared):
    """Dimensions of a longitudinal slot."""

    length: fields.Across = required("length along the shaft")
    width: fields.Across = required("width")
    end_radius: fields.Across | None = given("radius of its ends, at least half of the width")
    number: Annotated[int, Field(ge=1, le=12)] | None = given(
        "evenly spaced slots in one section, at most 3"
    )

    def refuse_clashes(self) -> None:
        if self.length < self.width:
            raise refuse(
                "the slot is shorter than it is wide", "the length runs along the shaft", "length"
            )


class M68Settings(RuleSettings):
    """Settings of `iacs-m68`."""

    alloy: Annotated[tuple[str, ...], OneOrMany] = given(
        "shafts of alloy steel; others are carbon or C-Mn steel", ()
    )
    drive: Drive = given("what drives, for F", "other")
    tachometer: fields.Tolerance = given(
        "tolerance of the tachometer, added to both ends of a barred range", 0.0
    )
    slots: Mapping[str, Slot] = given(
        "slots by name of the shaft: {length, width, end_radius, number}; C_K 1.45/scf in place of 0.30",
        {},
    )
    near_transient: Annotated[float, Quantity("1", above=0, at_most=1, usual="tolerance")] = given(
        "share of tau_T from which a stress is near it, where 500 MPa are demanded (the rule has no number)",
        NEAR_TRANSIENT,
    )
    conditions: str | None = given(
        "document that answers the conditions of the factors which the file does not, as a drawing"
    )

    def refuse_clashes(self) -> None:
        refuse_blank(self, "conditions")


@dataclass(frozen=True, kw_only=True)
class ClassedShaft(LimitedShaft):
    """A shaft with a role and the limits of the rule, and what these take for it."""

    role: Role  # as the rule sees it: a tube shaft is one of the propeller shafts
    strength: float  # N/mm2, as used
    stated: float | None  # N/mm2: strength as the file gives it
    governing: tuple[str, Detail]  # the feature with the smallest C_K
    k: float  # the greatest of its features, for the least diameter
    ends: Ends  # mm, (outer, bore) of the driving and the driven end


def classed_shafts(
    study: Study, settings: M68Settings, letters: tuple[str, str] = ("tau_C", "tau_T")
) -> Iterator[ClassedShaft]:
    """Yield every round line shaft of the train that has a role; letters: of its limits, in use and in passing."""
    for number, part, record in with_role(study.train, *ROLES):
        # A tube shaft is ruled with the propeller shafts (cap of sigma_B, F).
        is_tube = "tube shaft" in record.features
        role: Role = "propeller" if is_tube else cast(Role, record.role)
        sizes = diameters(study.train, number)
        ends = cast(Ends, tuple((outer * MM, bore * MM) for outer, bore in sizes))
        outers = [outer for outer, _ in ends]
        details = _details(record, role, part.name, ends, settings)
        governing = min(details, key=lambda entry: entry[1].c_k)
        feature, detail = governing
        open_conditions, broken = _conditions(record, part.name, ends, settings)

        # The strength that is used, and what is to be said of the one that is stated.
        tensile = study.train.materials[record.material].tensile_strength
        stated, origin = None if tensile is None else tensile * PA, ""
        is_alloy = not {part.name, part.whole}.isdisjoint(settings.alloy)
        steel = LEAST_STRENGTH if stated is None else stated
        strength = used_strength(steel, role, alloy=is_alloy)
        strongest = ALLOY_STRENGTH_CAP if is_alloy else MOST_CARBON_STRENGTH
        if stated is None:
            origin = " (none stated: the least of shaft steel assumed, to be verified)"
        elif strength < stated:
            origin = f" (of {stated:.4g})"
        if steel < LEAST_STRENGTH * (1 - ROUNDING):
            weak = f"tensile strength {steel:.4g} N/mm2, below {LEAST_STRENGTH:g}: no limit holds"
            broken.insert(0, weak)
        if steel > strongest * (1 + ROUNDING):
            kind = f"{'alloy' if is_alloy else 'carbon'} steel of {steel:.4g} N/mm2"
            approval = f"special approval of '{part.name}': {kind}, above {strongest:g}"
            open_conditions.append(approval)

        doubt = "" if detail.c_k_mark == "rule text" else ", to be verified"
        condition = f": {detail.condition}" if detail.condition else ""
        factors = (
            f"C_K {detail.c_k:.4g} ({feature}{condition}{doubt}), C_D {size_factor(max(outers)):.4g}, "
            f"sigma_B {strength:.4g} N/mm2{origin}"
        )
        cone = "conical: W_p of the smaller end of every piece, C_D of the maximum diameter"
        made_of: tuple[Any, ...] = strength, max(outers), detail.c_k
        continuous, passing = partial(tau_c, *made_of), partial(tau_t, *made_of)
        pieces = (
            Piece(letters[0], FLAT_FROM, continuous),
            Piece(letters[0], LAST_CONTINUOUS, continuous),
        )
        seat = (SEAT.format(part.name),) if "shrink fit" in record.features else ()
        is_open = settings.conditions is None  # no document answers them
        yield ClassedShaft(
            number,
            part.name,
            LimitCurve(pieces, Piece(letters[1], BARRED_BELOW, passing)),
            detail.c_k_mark if stated is not None else "to be verified",
            (factors, cone) if min(outers) != max(outers) else (factors,),
            keyways=tuple(name for name, factors_of in details if factors_of.has_keyway),
            restrictions=tuple(open_conditions) if is_open else (),
            doubts=tuple(broken),
            near_limit=seat if is_open else (),
            role=role,
            strength=strength,
            stated=stated,
            governing=governing,
            k=max(factors_of.k for _, factors_of in details),
            ends=ends,
        )


def _conditions(
    shaft: ShaftRecord, name: str, ends: Ends, settings: M68Settings
) -> tuple[list[str], list[str]]:
    """Return conditions of a shaft's factors that the file does not answer, and those that it breaks, in words."""
    smallest, largest = sorted(outer for outer, _ in ends)
    below, above = 1 - ROUNDING, 1 + ROUNDING
    open_conditions, broken = list[str](), list[str]()
    # What the table has no factor for.
    if any(notch.form == "splines" for notch in shaft.notches):
        broken.append(f"splines of '{name}': the table has no C_K for them")
    flange = None if shaft.step is None else shaft.step.flange
    if flange is not None and "flange" in shaft.features:
        fillet = (flange.fillet or 0.0) * MM / smallest
        if fillet < LEAST_FLANGE_FILLET * below:
            share = f"{fillet:.3g} of the diameter, below {LEAST_FLANGE_FILLET:g}"
            broken.append(f"flange of '{name}': fillet {share}")
    if "radial hole" in shaft.features:
        open_conditions.append(f"radial hole of '{name}' at most 0.3 of the diameter")
    if "slot" not in shaft.features:
        return open_conditions, broken

    bore, slot = max(inner / outer for outer, inner in ends), settings.slots.get(name)
    if bore >= MOST_SLOT_BORE * below:
        share = f"{bore:.3g} of the diameter, not below {MOST_SLOT_BORE:g}"
        broken.append(f"slot of '{name}': bore {share}")
    length = width = radius = number = math.nan  # where it is not stated
    if slot is not None:
        length, width = slot.length * MM / smallest, slot.width * MM / largest
        radius = math.nan if slot.end_radius is None else slot.end_radius / slot.width
        number = slot.number or math.nan
    conditions = (  # value, whether it keeps the condition, what is required, what is broken
        (
            length,
            length < MOST_SLOT_LENGTH * below,
            f"length below {MOST_SLOT_LENGTH:g} of the diameter",
            f"length {length:.3g} of the diameter, not below {MOST_SLOT_LENGTH:g}",
        ),
        (
            width,
            width > LEAST_SLOT_WIDTH * above,
            f"width above {LEAST_SLOT_WIDTH:g} of the diameter",
            f"width {width:.3g} of the diameter, not above {LEAST_SLOT_WIDTH:g}",
        ),
        (
            radius,
            radius >= 0.5 * below,
            "radius of its ends at least half of the width",
            "radius of its ends below half of the width",
        ),
        (
            number,
            number in SLOT_NUMBERS,
            "1, 2 or 3 slots, evenly spaced",
            f"{number} slots in one section, more than 3",
        ),
    )
    for value, is_met, required_words, breach in conditions:
        if math.isnan(value):
            open_conditions.append(f"slot of '{name}': {required_words}")
        elif not is_met:
            broken.append(f"slot of '{name}': {breach}")
    return open_conditions, broken


def _details(
    shaft: ShaftRecord, role: Role, name: str, ends: Ends, settings: M68Settings
) -> list[tuple[str, Detail]]:
    """Return the shaft's features with their factors, and those of its role and notches that no feature states."""
    features, kinds = shaft.features, {notch.form for notch in shaft.notches}
    details = [(feature, DETAILS[feature]) for feature in features]
    if "hole" in kinds and "radial hole" not in features:
        details.insert(0, ("hole of `notches`", DETAILS["radial hole"]))
    if "keyway" in kinds and not any(detail.has_keyway for _, detail in details):
        details.insert(0, ("keyway of `notches`", DETAILS["cylinder keyway"]))
    if not set(features) & OF_ROLE[role]:
        details.insert(0, (f"{role} shaft" if features else "no feature given", ASSUMED[role]))
    if "slot" in features and name in settings.slots:
        slot = settings.slots[name].length * MM, settings.slots[name].width * MM
        concentration = max(slot_concentration(outer, bore, *slot) for outer, bore in ends)
        c_k = SLOT_FACTOR / concentration
        stated = replace(DETAILS["slot"], c_k=c_k, c_k_mark="to be verified")
        details = [(key, stated if key == "slot" else detail) for key, detail in details]
    return details
