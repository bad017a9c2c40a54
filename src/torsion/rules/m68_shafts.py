"""A shaft as IACS UR M68 sees it: its role, strength, factors, and nominal stress for a torque."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Literal, Self, cast

import numpy as np
from pydantic import model_validator

from torsion import fields
from torsion.arrays import FloatArray, IntArray
from torsion.components.part_records import ShaftRecord
from torsion.fields import Declared, OneOrMany, given, refuse, required
from torsion.kernels.round_sections import section_modulus
from torsion.primitives import Bar
from torsion.rules import m68_formulas as formulas
from torsion.rules.judgement import spans_of
from torsion.rules.m68_formulas import ASSUMED, DETAILS, Detail, Mark, Role
from torsion.study import Study
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.assembly.system import System

PA = 1e-6  # N/mm2
MM = 1e3  # mm/m


class Slot(Declared):
    """Dimensions of a longitudinal slot."""

    length: fields.Across = required("length along the shaft")
    width: fields.Across = required("width")

    @model_validator(mode="after")
    def _is_longitudinal(self) -> Self:
        if self.length < self.width:
            raise refuse("the slot is shorter than it is wide", "the length runs along the shaft", "length")
        return self


class M68Settings(Declared):
    """Settings of `iacs-m68`."""

    alloy: Annotated[tuple[str, ...], OneOrMany] = given("shafts of alloy steel; others are carbon or C-Mn steel", ())
    drive: Literal["turbine", "electric", "slip coupling", "other"] = given("what drives, for F", "other")
    tachometer: fields.Tolerance = given("tolerance of the tachometer, added to both ends of a barred range", 0.0)
    slots: Mapping[str, Slot] = given("slots by name of the shaft: {length, width}; C_K 1.45/scf in place of 0.30", {})


@dataclass(frozen=True)
class ClassedShaft:
    """A shaft with a role, and what the rule takes for it."""

    part: int
    name: str
    role: Role  # as the rule sees it: a tube shaft is one of the propeller shafts
    strength: float  # N/mm2, as used
    details: tuple[tuple[str, Detail], ...]  # by feature; the smallest C_K and the greatest k govern
    diameter: float  # mm, greatest: for C_D
    ends: tuple[tuple[float, float], tuple[float, float]]  # mm, (outer, bore) of the driving and the driven end
    stated: float | None  # N/mm2: strength as the file gives it

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
            f"C_D {formulas.size_factor(self.diameter):.4g}",
            f"sigma_B {self.strength:.4g} N/mm2{doubt_of_strength}",
        )
        (first, _), (last, _) = self.ends
        cone = "conical: W_p of the smaller end of every piece, C_D of the greatest diameter"
        return (", ".join(factors), *([cone] if first != last else []))


def judged(train: Train) -> list[tuple[Bar, ShaftRecord]]:
    """The shafts that the rule judges: those with a role, and the diameters that the rule's formulas are about."""
    every = [(bar, train.shaft(bar)) for bar in train.bars]
    return [(bar, shaft) for bar, shaft in every if shaft.role is not None and bar.section is None]


def classed_shafts(study: Study, settings: M68Settings) -> Iterator[ClassedShaft]:
    """Every round shaft of the train that has a role."""
    return (_classed(study, settings, bar, shaft) for bar, shaft in judged(study.train))


def stress_modulus(system: "System", shaft: ClassedShaft) -> tuple[IntArray, FloatArray]:
    """Spans of the shaft (spans,) and the W_p of each (spans,) m3: the smaller end's of a conical piece."""
    spans = spans_of(system, shaft.part)
    bar = next(bar for bar in system.train.bars if bar.part == shaft.part)
    at = np.linspace(0.0, 1.0, len(spans) + 1)  # between two of them the modulus is never below the smaller
    outer, bore = (ends[0] + (ends[1] - ends[0]) * at for ends in (bar.outer, bar.bore))
    at_edge = section_modulus(outer, bore)
    return spans, np.minimum(at_edge[:-1], at_edge[1:])


def _classed(study: Study, settings: M68Settings, bar: Bar, record: ShaftRecord) -> ClassedShaft:
    # a tube shaft is ruled with the propeller shafts (cap of sigma_B, F)
    role: Role = "propeller" if "tube shaft" in record.features else cast(Role, record.role)
    given_strength = study.train.materials[record.material].tensile_strength
    stated = None if given_strength is None else given_strength * PA
    steel = formulas.LEAST_STRENGTH if stated is None else stated
    strength = formulas.used_strength(steel, role, alloy=bar.name in settings.alloy)
    ends = ((bar.outer[0] * MM, bar.bore[0] * MM), (bar.outer[1] * MM, bar.bore[1] * MM))
    details = _details(record, role, bar.name, ends, settings)
    return ClassedShaft(bar.part, bar.name, role, strength, details, max(bar.outer) * MM, ends, stated)


def _details(
    shaft: ShaftRecord, role: Role, name: str, ends: tuple[tuple[float, float], ...], settings: M68Settings
) -> tuple[tuple[str, Detail], ...]:
    """The shaft's features with their factors; the role's usual one where none is given."""
    if not shaft.features:
        return (("no feature given", ASSUMED[role]),)
    found: list[tuple[str, Detail]] = []
    for feature in shaft.features:
        detail = DETAILS[feature]
        if feature == "slot" and name in settings.slots:
            slot = settings.slots[name].length * MM, settings.slots[name].width * MM
            worst = max(formulas.slot_concentration(diameter, bore, *slot) for diameter, bore in ends)
            detail = replace(detail, c_k=min(1.0, formulas.slot_c_k(worst)), c_k_mark="to be verified")
        found.append((feature, detail))
    return tuple(found)
