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
from torsion.fields import Declared, Quantity, given
from torsion.findings import Results
from torsion.kernels.round_sections import section_modulus
from torsion.results import listed
from torsion.rules import judgement, m53_factors
from torsion.rules.judgement import MOSTLY, Clause, Continuous, RuleOverSpeed, curve_of
from torsion.rules.m53_factors import RANGES, Throw
from torsion.rules.shaft_limits import MM, PA, with_role
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check
from torsion.study import Study

LEAST_Q = 1.15
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
Stress = Annotated[float, Quantity("Pa", at_least=0, usual="stress")]


class M53Settings(Declared):
    """Settings of `iacs-m53`: a throw with a solid pin and solid journals, without recess."""

    pin: fields.Across | None = given("diameter D of the crank pin")
    journal: fields.Across | None = given("diameter D_G of the journals")
    pin_fillet: fields.Across | None = given("radius R_H of the fillet of the pin")
    journal_fillet: fields.Across | None = given("radius R_G of the fillet of the journal")
    web_thickness: fields.Across | None = given("W, along the shaft")
    web_width: fields.Across | None = given("B")
    radius: fields.Across | None = given("E, of the crank: half the stroke")
    oil_bore: fields.Across | None = given("diameter D_O of the oil bore in the pin (default: no bore is judged)")
    bending: Stress | None = given("nominal alternating bending stress of the web, by the engine's maker")
    shear: Stress | None = given("nominal alternating shear stress of the web, by the engine's maker")
    bore_bending: Stress | None = given("nominal alternating bending stress at the oil bore, by the engine's maker")
    additional: Stress = given("additional bending stress (crosshead engine 19 MPa, trunk pistons 10 MPa)", 19e6)
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
        return Throw(*(size * MM for size in (*sizes, self.oil_bore or 0.0)))


class M53(RuleOverSpeed):
    """The rule, as the study reads it."""

    name = "iacs-m53"
    settings = M53Settings

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
        found = [(f"{self.name}: bored pins and journals, recesses", "the throw is taken as solid")]
        if settings.oil_bore is None:
            found.append((f"{self.name}: outlet of the oil bore", "`oil_bore` is not given"))
        if lacking := _lacking(study, settings):
            words = f"the rule wants orders up to {LAST_ORDER[settings.strokes or 4]}, and these do not excite"
            found.append((f"{self.name}: orders {listed(map(str, lacking), most=MOST_ORDERS)}", words))
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
                notes = f"sigma_DW {fatigue:.5g} N/mm2 / {LEAST_Q:g}", in_use, MOSTLY
                what = "equivalent alternating stress"
                yield Clause(place, part.name, what, TO_BE_VERIFIED, curve, use, "N/mm2", notes, spans)

    def check(self, evidence: Results, settings: M53Settings) -> tuple[Check, ...]:
        """With the acceptability factor of each, and a row NOT JUDGED of the orders that the synthesis lacks."""
        lacking, found = _lacking(evidence.study, settings), list[Check]()
        for one in super().check(evidence, settings):
            factor = f"Q = {LEAST_Q * one.limit / one.value:.4g}" if one.value and math.isfinite(one.limit) else ""
            found.append(replace(one, note="; ".join(filter(None, (factor, one.note)))))
        if lacking:
            for _, part, _ in with_role(evidence.study.train, "crank"):
                found.append(_orders(part.name, lacking))
        return tuple(found)


def _orders(where: str, lacking: list[Fraction]) -> Check:
    """Return the row about orders that the rule demands and nothing excites."""
    note = f"orders {listed(map(str, lacking), most=MOST_ORDERS)} do not excite"
    return Check(
        M53.name, "orders", where, "Orders of the synthesis", math.nan, math.nan, "", "not judged", "rule text",
        note=note,
    )  # fmt: skip


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
    throw, factors, add = settings.throw, m53_factors, settings.additional * PA
    of_pin, of_journal = (torque / section_modulus(size / MM) * PA for size in (throw.pin, throw.journal))
    bending, shear = (settings.bending or 0.0) * PA, (settings.shear or 0.0) * PA
    local = factors.alpha_b(throw) * bending + add
    fatigue = factors.fatigue_strength(strength, throw.pin, throw.pin_fillet, settings.manufacture)
    yield "Q, fillet of the pin", factors.of_fillet(local, factors.alpha_t(throw) * of_pin), fatigue
    local = factors.beta_b(throw) * bending + factors.beta_q(throw) * shear + add
    fatigue = factors.fatigue_strength(strength, throw.journal, throw.journal_fillet, settings.manufacture)
    torsion = factors.alpha_t(throw, journal=True) * of_journal
    yield "Q, fillet of the journal", factors.of_fillet(local, torsion), fatigue
    if throw.oil_bore:
        local = factors.gamma_b(throw) * (settings.bore_bending or 0.0) * PA
        manufacture = min(settings.manufacture, 1.0)  # grain flow does not help at the bore
        fatigue = factors.fatigue_strength(strength, throw.pin, throw.oil_bore / 2.0, manufacture)
        yield "Q, oil bore", factors.of_bore(local, factors.gamma_t(throw) * of_pin), fatigue
