"""Rule `iacs-m53`: acceptability of a crankshaft, IACS UR M53: fillets of pin and journal, outlet of the oil bore.

The torsional stress is the half range of the synthesis; nominal bending stresses, which no torsional calculation has,
are the engine maker's. Q = fatigue strength / equivalent alternating stress is at least 1.15 (to be verified).
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Literal

import numpy as np

from torsion import fields
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.harmonic_components import excited_orders
from torsion.arrays import FloatArray
from torsion.errors import Fault
from torsion.fields import Quantity, given, refuse
from torsion.findings import Results
from torsion.kernels.round_sections import section_modulus
from torsion.results import listed
from torsion.rules import judgement, m53_factors
from torsion.rules.demanded_states import misfire_row, unjudged
from torsion.rules.judgement import MOSTLY, Clause, Continuous, RuleOverSpeed, curve_of
from torsion.rules.m53_factors import RANGES, Throw
from torsion.rules.reached_speeds import START
from torsion.rules.shaft_limits import MM, PA, with_role
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, RuleSettings
from torsion.study import Study

LEAST_Q = 1.15
AXIAL, MISALIGNMENT = 20.0, 10.0  # N/mm2 of additional bending, of crosshead engines; misalignment of trunk pistons too
PIN, JOURNAL, BORE = "pin fillet", "journal fillet", "oil bore"  # clauses
MOST_ORDERS = 6  # stated one by one
LAST_ORDER = {4: 12, 2: 15}  # of the crankshaft, up to which the rule wants the synthesis
SIZES = (
    "pin", "journal", "pin_fillet", "journal_fillet", "web_thickness", "web_width", "radius", "bending", "shear",
    "strokes",
)  # fmt: skip
EXAMPLE = (
    "iacs-m53: {pin: 200 mm, journal: 200 mm, pin_fillet: 12 mm, journal_fillet: 12 mm, web_thickness: 70 mm, "
    "web_width: 260 mm, radius: 140 mm, bending: 40 MPa, shear: 5 MPa, strokes: 4}"
)
MANUFACTURE, SAME = (1.05, 1.0, 0.93), 1e-9  # factors K of UR M53; rounding of one
Stress = Annotated[float, Quantity("Pa", at_least=0, usual="stress")]


class M53Settings(RuleSettings):
    """Settings of `iacs-m53`: a throw, solid or with bores and recesses."""

    pin: fields.Across | None = given("diameter D of the crank pin")
    journal: fields.Across | None = given("diameter D_G of the journals")
    pin_fillet: fields.Across | None = given("radius R_H of the fillet of the pin")
    journal_fillet: fields.Across | None = given("radius R_G of the fillet of the journal")
    web_thickness: fields.Across | None = given("W, along the shaft")
    web_width: fields.Across | None = given("B")
    radius: fields.Across | None = given("E, of the crank: half the stroke")
    oil_bore: fields.Across | None = given("diameter D_O of the oil bore in the pin (default: no bore is judged)")
    pin_bore: fields.Bore = given("diameter D_BH of the bore of the pin (default: solid)", 0.0)
    journal_bore: fields.Bore = given("diameter D_BG of the bore of the journals (default: solid)", 0.0)
    pin_recess: fields.Bore = given("depth T_H of the recess of the pin's fillet (default: none)", 0.0)
    journal_recess: fields.Bore = given("depth T_G of the recess of the journal's fillet (default: none)", 0.0)
    bending: Stress | None = given("nominal alternating bending stress of the web, by the engine's maker")
    shear: Stress | None = given("nominal alternating shear stress of the web, by the engine's maker")
    bore_bending: Stress | None = given("nominal alternating bending stress at the oil bore, by the engine's maker")
    engine: Literal["crosshead", "trunk piston"] = given(
        "kind of the engine, for the additional bending stress: crosshead 30 MPa (axial vibration 20, "
        "misalignment 10), trunk piston 10 MPa", "crosshead",
    )  # fmt: skip
    axial: Stress | None = given(
        "calculated bending stress by axial vibration of the whole system, in place of the 20 MPa of a crosshead engine"
    )
    additional: Stress | None = given("additional bending stress in place of that of `engine` and `axial`")
    manufacture: Annotated[float, Quantity("1", above=0, at_most=1.2)] = given(
        "factor K: 1.05 continuous grain flow, 1.0 free-form forged, 0.93 cast", 0.93
    )
    strokes: Literal[2, 4] | None = given("strokes of a cycle, for the orders that the synthesis must have")
    continuous: Continuous | None = given("speeds without the barred ranges: {from, to} (default: all)")

    @property
    def throw(self) -> Throw:
        """In mm; raises ValueError where a size is missing."""
        sizes = [getattr(self, key) for key in SIZES[:7]]
        if None in sizes:
            raise ValueError("a size of the throw is missing")
        bores = self.oil_bore or 0.0, self.pin_bore, self.journal_bore, self.pin_recess, self.journal_recess
        return Throw(*(size * MM for size in (*sizes, *bores)))

    @property
    def added_bending(self) -> tuple[float, str]:
        """Additional bending stress, N/mm2, and where it is from, in words (KR A5-3 4)."""
        if self.additional is not None:
            return self.additional * PA, "stated by user"
        if self.engine == "trunk piston":
            return MISALIGNMENT, "trunk piston engine"
        if self.axial is not None:
            return self.axial * PA + MISALIGNMENT, "crosshead engine, axial vibration stated by user"
        return AXIAL + MISALIGNMENT, "crosshead engine"

    def refuse_clashes(self) -> None:
        if self.axial is not None and (self.engine != "crosshead" or self.additional is not None):
            message = "`axial` stands for the 20 MPa of a crosshead engine alone"
            raise refuse(message, "leave out `axial`, or `additional`", "axial")
        if min(abs(self.manufacture - factor) for factor in MANUFACTURE) > SAME:
            hint = "1.05 continuous grain flow, 1.0 free-form forged, 0.93 cast with cold rolling"
            raise refuse(f"the text has no factor K of {self.manufacture:g}", hint, "manufacture")


class M53(RuleOverSpeed):
    """The rule, as the study reads it."""

    name = "iacs-m53"
    edition = "IACS UR M53 as in KR Guidance 2025 Pt 5 Annex 5-3"
    settings = M53Settings
    begin = START

    def faults(self, study: Study, settings: M53Settings) -> list[Fault]:
        """What the file lacks for this rule."""
        where = self.path(study, settings)
        found = judgement.vibration_faults(self, study, settings) + self.continuous_faults(study, settings)
        cranks = list(with_role(study.train, "crank"))
        if not cranks:
            found.append(Fault(where, f"{self.name} finds no crankshaft", "role: crank, on a round shaft"))
        for _, part, shaft in cranks:
            if study.train.materials[shaft.material].tensile_strength is None:
                message = f"`tensile_strength` of '{shaft.material}' is not given, and {self.name} needs it"
                hint = f"materials: {{{shaft.material}: {{..., tensile_strength: 800 MPa}}}}"
                found.append(Fault((*part.path, "material"), message, hint))
        missing = [key for key in SIZES if getattr(settings, key) is None]
        if settings.oil_bore is not None and settings.bore_bending is None:
            missing.append("bore_bending")
        if missing:
            words = ", ".join(f"`{key}`" for key in missing)
            return [
                *found,
                Fault(where, f"{words} of {self.name} {'is' if len(missing) == 1 else 'are'} missing", EXAMPLE),
            ]
        for name, ratio in settings.throw.ratios.items():
            least, most = RANGES[name]
            if not least <= ratio <= most:
                words = f"at most {most:g}" if least == -np.inf else f"{least:g} to {most:g}"
                message = f"{name} of the crank throw is {ratio:.4g}, for which the factors of M53 do not hold"
                found.append(Fault(where, message, f"{words} (over the diameter of the pin)"))
        return found

    def left_out(self, study: Study, settings: M53Settings) -> tuple[tuple[str, str], ...]:
        """What it does not judge, and why."""
        found = [(f"{self.name}: shrink fits of semi-built cranks", "the rule is not offered for them")]
        if settings.oil_bore is None:
            found.append((f"{self.name}: outlet of the oil bore", "`oil_bore` is not given"))
        return tuple(found)

    def clauses(self, evidence: Results, settings: M53Settings) -> Iterator[Clause]:
        """Equivalent stress against fatigue strength / 1.15, of every crank span at both fillets and the oil bore."""
        response, train = evidence.need(Response), evidence.study.train
        use, in_use = judgement.within(settings.continuous, response.speed), judgement.in_use(settings.continuous)
        for number, part, shaft in with_role(train, "crank"):
            spans = judgement.spans_of(evidence.system, number)
            torque = evidence.need(Synthesis).half_range[:, spans].max(axis=1)
            strength = (train.materials[shaft.material].tensile_strength or 0.0) * PA
            for place, stress, fatigue in _places(settings, torque, strength):
                curve = curve_of(response, stress, fatigue / LEAST_Q)
                notes = f"sigma_DW {fatigue:.5g} N/mm2 / {LEAST_Q:g}", in_use, MOSTLY, *_notes(settings, place)
                what = f"Equivalent alternating stress, {place}"
                yield Clause(place, part.name, what, TO_BE_VERIFIED, curve, use, "N/mm2", notes, spans)

    def check(self, evidence: Results, settings: M53Settings) -> tuple[Check, ...]:
        """With the acceptability factor of each, and a row NOT JUDGED of the orders that the synthesis lacks."""
        found = list[Check]()
        for one in super().check(evidence, settings):
            factor = f"Q = {LEAST_Q * one.limit / one.value:.4g}" if one.value and math.isfinite(one.limit) else ""
            found.append(replace(one, note="; ".join(filter(None, (factor, one.note)))))
        return (*found, *self.demanded_rows(evidence.study, settings))

    def demanded_rows(self, study: Study, settings: M53Settings) -> tuple[Check, ...]:
        """Orders that nothing excites, and a misfire that neither the file nor a case of it has."""
        rows = list[Check]()
        if lacking := _lacking(study, settings):
            note = f"orders {listed(map(str, lacking), most=MOST_ORDERS)} do not excite"
            for _, part, _ in with_role(study.train, "crank"):
                rows.append(unjudged(self.name, "orders", part.name, "Orders of the synthesis", note))
        return (*rows, *misfire_row(self.name, study, "KR A5-3 2(2)(A)(b)"))


def _notes(settings: M53Settings, place: str) -> Iterator[str]:
    """What the stress of a place counts in, in words."""
    if place != BORE:
        stress, source = settings.added_bending
        yield f"additional bending {stress:g} N/mm2 ({source})"
        if settings.throw.ratios["s"] < m53_factors.LEAST_OVERLAP:
            yield "overlap below -0.5: factors at -0.5, that of shear too"


def _lacking(study: Study, settings: M53Settings) -> list[Fraction]:
    """Orders of the crankshaft that the rule wants in the synthesis, and that nothing excites."""
    cranks = list(with_role(study.train, "crank"))
    if not cranks or settings.strokes is None:
        return []
    step = Fraction(2, settings.strokes)  # an order a cycle of the engine
    excited = {order / abs(cranks[0][1].ratio) for order in excited_orders(study.train)}
    wanted = [step * k for k in range(1, int(LAST_ORDER[settings.strokes] / step) + 1)]
    return [order for order in wanted if order not in excited]


def _places(settings: M53Settings, torque: FloatArray, strength: float) -> Iterator[tuple[str, FloatArray, float]]:
    """Both fillets and the oil bore: name, (speeds,) equivalent stress and the fatigue strength, N/mm2."""
    throw, factors, (add, _) = settings.throw, m53_factors, settings.added_bending
    sections = (throw.pin, throw.pin_bore), (throw.journal, throw.journal_bore)
    of_pin, of_journal = (torque / section_modulus(outer / MM, bore / MM) * PA for outer, bore in sections)
    bending, shear = (settings.bending or 0.0) * PA, (settings.shear or 0.0) * PA
    local = factors.alpha_b(throw) * bending + add
    fatigue = factors.fatigue_strength(strength, throw.pin, throw.pin_fillet, settings.manufacture)
    yield PIN, factors.of_fillet(local, factors.alpha_t(throw) * of_pin), fatigue
    local = factors.beta_b(throw) * bending + factors.beta_q(throw) * shear + add
    fatigue = factors.fatigue_strength(strength, throw.journal, throw.journal_fillet, settings.manufacture)
    torsion = factors.alpha_t(throw, journal=True) * of_journal
    yield JOURNAL, factors.of_fillet(local, torsion), fatigue
    if throw.oil_bore:
        local = factors.gamma_b(throw) * (settings.bore_bending or 0.0) * PA
        manufacture = min(settings.manufacture, 1.0)  # grain flow does not help at the bore
        fatigue = factors.fatigue_strength(strength, throw.pin, throw.oil_bore / 2.0, manufacture)
        yield BORE, factors.of_bore(local, factors.gamma_t(throw) * of_pin), fatigue
