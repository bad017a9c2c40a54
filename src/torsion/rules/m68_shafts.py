"""A shaft as IACS UR M68 (Rev. 3, 2021) sees it: factors of its features, formulas, and what they take for it.

Diameters in mm, stresses in N/mm2. "rule text" was compared with a class society's printed rules (KR 2025, Part 5,
Ch. 4); "to be verified" is to be compared with the edition in force before it is relied on.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Literal, Self, cast, get_args

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from torsion import fields
from torsion.arrays import FloatArray
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.model.lowering import Part, ShaftRecord
from torsion.rules.reached_speeds import BARRED_BELOW
from torsion.rules.shaft_limits import MM, PA, ROUNDING, Mark, diameters, with_role
from torsion.rules.verdict_line import RuleSettings, refuse_blank
from torsion.study import Study
from torsion.train import Train

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
    k_mark: Mark = "to be verified"


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
MOST_SLOT_LENGTH, MOST_SLOT_BORE, LEAST_SLOT_WIDTH = (
    0.8,
    0.7,
    0.15,
)  # of the diameter (rule text, note 4)
SLOT_NUMBERS = 1, 2, 3  # at 360, 180 and 120 degrees
LEAST_FLANGE_FILLET = 0.08  # of the diameter, of an integral flange (to be verified)
LEAST_STRENGTH = 400.0  # N/mm2 of shaft steel; taken for the built-in steel, of which none is stated (to be verified)
SEAT = "shrink fit of '{}': seat 1 to 2 % thicker, with a blending radius of about that change"  # (rule text, note 1)
SMOOTH_DRIVE_FACTOR = (
    95.0  # F of intermediate shafts behind a turbine, motor or slip coupling (to be verified)
)
DRIVE_FACTOR = 100.0  # F of any other drive and any other shaft (to be verified)


def used_strength(strength: float, role: Role, *, alloy: bool) -> float:
    """The tensile strength that may be used (rule text)."""
    return min(strength, ALLOY_STRENGTH_CAP if alloy and role != "propeller" else STRENGTH_CAP)


def size_factor(diameter: float) -> float:
    """C_D = 0.35 + 0.93 d^-0.2 (rule text)."""
    return float(0.35 + 0.93 * diameter**-0.2)


def tau_c(strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike) -> FloatArray:
    """Stress amplitude permissible in continuous use (rule text); NaN above 1.05 of the rated speed."""
    ratio = np.asarray(speed_ratio, dtype=float)
    shape = np.where(ratio < FLAT_FROM, 3.0 - 2.0 * ratio**2, 1.38)
    limit = (strength + 160.0) / 18.0 * c_k * size_factor(diameter) * shape
    return np.asarray(np.where(ratio <= LAST_CONTINUOUS * (1 + ROUNDING), limit, np.nan))


def tau_t(strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike) -> FloatArray:
    """Stress amplitude permissible while a barred range is passed, 1.7 tau_C/sqrt(C_K) (rule text); NaN above 0.8."""
    ratio = np.asarray(speed_ratio, dtype=float)
    limit = 1.7 * tau_c(strength, diameter, c_k, ratio) / np.sqrt(c_k)
    return np.asarray(np.where(ratio <= BARRED_BELOW * (1 + ROUNDING), limit, np.nan))


def slot_concentration(diameter: float, bore: float, length: float, width: float) -> float:
    """Stress concentration factor of a longitudinal slot (to be verified)."""
    e, hollow = width / diameter, bore / diameter
    a = 2.3 - 3.0 * e + 15.0 * e**2 + 10.0 * e**2 * hollow**2
    return float(a + 0.8 * (length - width) / diameter / np.sqrt((1.0 - hollow) * e))


def slot_c_k(concentration: float) -> float:
    """C_K = 1.45/scf of a longitudinal slot (to be verified); at most 1.45/2.15 by the formula above."""
    return 1.45 / concentration


def drive_factor(role: Role, *, smooth: bool) -> float:
    """F of the least diameter (to be verified)."""
    return SMOOTH_DRIVE_FACTOR if smooth and role == "intermediate" else DRIVE_FACTOR


def least_diameter(
    power_per_speed: float, strength: float, factor: float, k: float, bore_share: float = 0.0
) -> float:
    """Least diameter, mm (to be verified), from kW per rpm, F and k; a bore up to 0.4 of it does not count."""
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

    @model_validator(mode="after")
    def _is_longitudinal(self) -> Self:
        if self.length < self.width:
            raise refuse(
                "the slot is shorter than it is wide", "the length runs along the shaft", "length"
            )
        return self


class M68Settings(RuleSettings):
    """Settings of `iacs-m68`."""

    alloy: Annotated[tuple[str, ...], OneOrMany] = given(
        "shafts of alloy steel; others are carbon or C-Mn steel", ()
    )
    drive: Literal["turbine", "electric", "slip coupling", "other"] = given(
        "what drives, for F", "other"
    )
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


@dataclass(frozen=True)
class ClassedShaft:
    """A shaft with a role, and what the rule takes for it."""

    part: int
    name: str
    role: Role  # as the rule sees it: a tube shaft is one of the propeller shafts
    strength: float  # N/mm2, as used
    details: tuple[
        tuple[str, Detail], ...
    ]  # by feature; the smallest C_K and the greatest k govern
    diameter: float  # mm, greatest: for C_D
    ends: Ends  # mm, (outer, bore) of the driving and the driven end
    stated: float | None  # N/mm2: strength as the file gives it
    restrictions: tuple[str, ...] = ()  # conditions of the factors that the file does not answer
    broken: tuple[str, ...] = ()  # conditions that it breaks
    near_limit: tuple[
        str, ...
    ] = ()  # conditions near the limit of continuous use that the file does not answer

    @property
    def governing(self) -> tuple[str, Detail]:
        """The feature with the smallest C_K."""
        return min(self.details, key=lambda entry: entry[1].c_k)

    @property
    def c_k(self) -> float:
        """The smallest C_K of the shaft's features."""
        return self.governing[1].c_k

    @property
    def standing(self) -> Mark:
        """Of tau_C: that of C_K, and of the least strength of shaft steel where none is stated."""
        return self.governing[1].c_k_mark if self.stated is not None else "to be verified"

    @property
    def k(self) -> float:
        """The greatest k of the shaft's features, for the least diameter."""
        return max(detail.k for _, detail in self.details)

    @property
    def keyways(self) -> tuple[str, ...]:
        """Features that do not go with a barred range."""
        return tuple(name for name, detail in self.details if detail.has_keyway)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Why the limits do not hold for it."""
        if self.stated is None or self.stated >= LEAST_STRENGTH * (1 - ROUNDING):
            return self.broken
        return (
            f"tensile strength {self.stated:.4g} N/mm2, below {LEAST_STRENGTH:g}: no limit holds",
            *self.broken,
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What was used, in words."""
        feature, detail = self.governing
        doubt = "" if detail.c_k_mark == "rule text" else ", to be verified"
        condition = f": {detail.condition}" if detail.condition else ""
        doubt_of_strength = " (none stated: the least of shaft steel assumed, to be verified)"
        if self.stated is not None:
            doubt_of_strength = f" (of {self.stated:.4g})" if self.strength < self.stated else ""
        factors = (
            f"C_K {self.c_k:.4g} ({feature}{condition}{doubt})",
            f"C_D {size_factor(self.diameter):.4g}",
            f"sigma_B {self.strength:.4g} N/mm2{doubt_of_strength}",
        )
        (first, _), (last, _) = self.ends
        cone = "conical: W_p of the smaller end of every piece, C_D of the maximum diameter"
        return (", ".join(factors), *([cone] if first != last else []))


def judged(train: Train, roles: tuple[str, ...] = ROLES) -> list[tuple[Part, ShaftRecord]]:
    """The shafts with a role whose stress and diameters are known."""
    return [(part, shaft) for _, part, shaft in with_role(train, *roles)]


def classed_shafts(study: Study, settings: M68Settings) -> Iterator[ClassedShaft]:
    """Every round shaft of the train that has a role."""
    every = with_role(study.train, *ROLES)
    return (_classed(study, settings, number, shaft) for number, _, shaft in every)


def _classed(study: Study, settings: M68Settings, part: int, record: ShaftRecord) -> ClassedShaft:
    name, whole = study.train.parts[part].name, study.train.parts[part].whole
    # a tube shaft is ruled with the propeller shafts (cap of sigma_B, F)
    role: Role = "propeller" if "tube shaft" in record.features else cast(Role, record.role)
    given_strength = study.train.materials[record.material].tensile_strength
    stated = None if given_strength is None else given_strength * PA
    steel = LEAST_STRENGTH if stated is None else stated
    is_alloy = not {name, whole}.isdisjoint(settings.alloy)
    strength = used_strength(steel, role, alloy=is_alloy)
    ends = cast(
        Ends, tuple((outer * MM, bore * MM) for outer, bore in diameters(study.train, part))
    )
    details = _details(record, role, name, ends, settings)
    unknown, broken = _conditions(record, name, ends, settings)
    most = ALLOY_STRENGTH_CAP if is_alloy else MOST_CARBON_STRENGTH
    if stated is not None and stated > most * (1 + ROUNDING):
        kind = "alloy" if is_alloy else "carbon"
        unknown.append(
            f"special approval of '{name}': {kind} steel of {stated:.4g} N/mm2, above {most:g}"
        )
    answered = settings.conditions is not None
    return ClassedShaft(
        part,
        name,
        role,
        strength,
        details,
        max(outer for outer, _ in ends),
        ends,
        stated,
        () if answered else tuple(unknown),
        tuple(broken),
        (SEAT.format(name),) if "shrink fit" in record.features and not answered else (),
    )


def _conditions(
    shaft: ShaftRecord, name: str, ends: tuple[tuple[float, float], ...], settings: M68Settings
) -> tuple[list[str], list[str]]:
    """Conditions of the factors of a shaft that the file does not answer, and those that it breaks, in words."""
    unknown, broken = (
        list[str](),
        list(_without_factor(shaft, name, min(outer for outer, _ in ends))),
    )
    if "radial hole" in shaft.features:
        unknown.append(f"radial hole of '{name}' at most 0.3 of the diameter")
    if "slot" not in shaft.features:
        return unknown, broken
    slot, diameter = settings.slots.get(name), min(outer for outer, _ in ends)
    of = f"slot of '{name}': "
    bore = max(inner / outer for outer, inner in ends)
    if bore >= MOST_SLOT_BORE * (1 - ROUNDING):
        broken.append(f"{of}bore {bore:.3g} of the diameter, not below {MOST_SLOT_BORE:g}")
    if slot is None:
        unknown += [f"{of}length below {MOST_SLOT_LENGTH:g} of the diameter"]
        unknown += [f"{of}width above {LEAST_SLOT_WIDTH:g} of the diameter"]
    else:
        length, width = (
            slot.length * MM / diameter,
            slot.width * MM / max(outer for outer, _ in ends),
        )
        if length >= MOST_SLOT_LENGTH * (1 - ROUNDING):
            broken.append(
                f"{of}length {length:.3g} of the diameter, not below {MOST_SLOT_LENGTH:g}"
            )
        if width <= LEAST_SLOT_WIDTH * (1 + ROUNDING):
            broken.append(f"{of}width {width:.3g} of the diameter, not above {LEAST_SLOT_WIDTH:g}")
    if slot is None or slot.end_radius is None:
        unknown.append(f"{of}radius of its ends at least half of the width")
    elif slot.end_radius < 0.5 * slot.width * (1 - ROUNDING):
        broken.append(f"{of}radius of its ends below half of the width")
    if slot is None or slot.number is None:
        unknown.append(f"{of}1, 2 or 3 slots, evenly spaced")
    elif slot.number not in SLOT_NUMBERS:
        broken.append(f"{of}{slot.number} slots in one section, more than 3")
    return unknown, broken


def _without_factor(shaft: ShaftRecord, name: str, diameter: float) -> Iterator[str]:
    """Yield in words what the table has no factor for: splines, and a flange with a small fillet; diameter: mm."""
    if any(notch.form == "splines" for notch in shaft.notches):
        yield f"splines of '{name}': the table has no C_K for them"
    flange = None if shaft.step is None else shaft.step.flange
    if flange is None or "flange" not in shaft.features:
        return
    fillet = (flange.fillet or 0.0) * MM / diameter
    if fillet < LEAST_FLANGE_FILLET * (1 - ROUNDING):
        yield f"flange of '{name}': fillet {fillet:.3g} of the diameter, below {LEAST_FLANGE_FILLET:g}"


def _details(
    shaft: ShaftRecord,
    role: Role,
    name: str,
    ends: tuple[tuple[float, float], ...],
    settings: M68Settings,
) -> tuple[tuple[str, Detail], ...]:
    """The shaft's features with their factors, and those of its role and its notches that no feature states."""
    found: list[tuple[str, Detail]] = []
    if not shaft.features:
        found.append(("no feature given", ASSUMED[role]))
    elif not set(shaft.features) & OF_ROLE[role] and role != "intermediate":
        found.append((f"{role} shaft", ASSUMED[role]))
    kinds = {notch.form for notch in shaft.notches}
    if "keyway" in kinds and not any(DETAILS[feature].has_keyway for feature in shaft.features):
        found.append(("keyway of `notches`", DETAILS["cylinder keyway"]))
    if "hole" in kinds and "radial hole" not in shaft.features:
        found.append(("hole of `notches`", DETAILS["radial hole"]))
    for feature in shaft.features:
        detail = DETAILS[feature]
        if feature == "slot" and name in settings.slots:
            slot = settings.slots[name].length * MM, settings.slots[name].width * MM
            worst = max(slot_concentration(diameter, bore, *slot) for diameter, bore in ends)
            detail = replace(detail, c_k=slot_c_k(worst), c_k_mark="to be verified")
        found.append((feature, detail))
    return tuple(found)
