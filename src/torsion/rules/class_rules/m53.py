"""Rule `iacs-m53`: acceptability of a crankshaft, IACS UR M53: fillets of pin and journal, outlet of the oil bore.

The torsional stress is the half range of the synthesis; nominal bending stresses, which no torsional calculation has,
are the engine maker's. Q = fatigue strength / equivalent alternating stress is at least 1.15 (to be verified).
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.harmonic_components import excited_orders
from torsion.arrays import FloatArray
from torsion.errors import Fault
from torsion.findings import Results
from torsion.kernels.round_sections import section_modulus
from torsion.rules.class_rules import m53_settings as factors
from torsion.rules.class_rules.m53_settings import (
    CAST,
    RANGES,
    SAME_SIZE,
    SIZES,
    M53Settings,
    contradictions,
)
from torsion.rules.class_rules.shaft_limits import (
    MM,
    PA,
    ROUNDING,
    diameters,
    no_crank,
    unknown_strengths,
    with_role,
)
from torsion.rules.demands import (
    START,
    engines_of,
    lacking_orders,
    misfire_row,
    unjudged,
)
from torsion.rules.rule_over_speed import Clause, RuleOverSpeed, spans_of
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, restricted
from torsion.study import Study

LEAST_Q = 1.15
ROOT_3 = math.sqrt(3.0)  # equivalent stress of a shear stress of 1 (von Mises)
LEAST_STRENGTH = 400.0  # N/mm2, ours: below it sigma_DW comes near the tensile strength itself
PIN, JOURNAL, BORE = "pin fillet", "journal fillet", "oil bore"  # clauses
OF_FILLETS = "s", "w", "b", "d of the bore of the pin", "d of the bore of the journal"
RATIOS = {  # that the factors of a place have
    PIN: (*OF_FILLETS, "r of the pin"),
    JOURNAL: (*OF_FILLETS, "r of the journal"),
    BORE: ("d of the oil bore",),
}
NOMINAL = {PIN: ("bending",), JOURNAL: ("bending", "shear"), BORE: ("bore_bending",)}
SMOOTH_FILLETS = "fillets smooth; surface treatment only with approval"
SMOOTH_BORE = "outlet and oil bore smooth down to 1.5 times its diameter; surface treatment only with approval"
LARGE_JOURNAL = "journal oil bores formed like the oil bore of the pin, or with separate evidence"
SMALL_JOURNAL = "journal oil bores with separate evidence: the journal is smaller than the pin"
STRESS = "Equivalent alternating stress, {}"
UNJUDGED_FITS = "section 8 of the rule: the program does not judge shrink fits of crankshafts"
EXAMPLE = (
    "iacs-m53: {pin: 200 mm, journal: 200 mm, pin_fillet: 12 mm, journal_fillet: 12 mm, web_thickness: 70 mm, "
    "web_width: 260 mm, radius: 140 mm, bending: 40 MPa, shear: 5 MPa, strokes: 4}"
)


class M53(RuleOverSpeed[M53Settings]):
    """The rule, as the study reads it."""

    name = "iacs-m53"
    edition = "IACS UR M53 as in KR Guidance 2025 Pt 5 Annex 5-3"
    settings_class = M53Settings
    begin = START

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        path = self.path(study)
        yield from self.vibration_faults(study)
        yield from no_crank(study, self)
        yield from unknown_strengths(study, self, "crank", assumed=None)
        missing = [key for key in SIZES if getattr(self.settings, key) is None]
        if self.settings.oil_bore and self.settings.bore_bending is None:
            missing.append("bore_bending")
        if missing:
            keys = ", ".join(f"`{key}`" for key in missing)
            message = f"{keys} of {self.name} {'is' if len(missing) == 1 else 'are'} missing"
            yield Fault(path, message, EXAMPLE)
        yield from contradictions(study, self.settings, (*path, self.name))

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield the equivalent stress of every crank span at both fillets and the oil bore, as far as there are factors."""
        response, train, settings = evidence.need(Response), evidence.study.train, self.settings
        for number, part, shaft in with_role(train, "crank"):
            spans = spans_of(evidence.system, number)
            torque = evidence.need(Synthesis).half_range[:, spans].max(axis=1)
            strength = (train.materials[shaft.material].tensile_strength or 0.0) * PA
            for location, stress, fatigue in _places(settings, torque, strength):
                if location not in _stated_places(settings):
                    continue
                if any(_doubts(settings, location, strength)):
                    continue
                # Nominal stresses that the file states as 0, and what else the stress counts in.
                remarks = [
                    f"`{key}` stated as 0 MPa"
                    for key in NOMINAL[location]
                    if getattr(settings, key) == 0.0
                ]
                if location != BORE:
                    added, source = settings.added_bending
                    remarks.append(f"additional bending {added:g} N/mm2 ({source})")
                    if settings.throw.ratios["s"] < factors.LEAST_OVERLAP:
                        remarks.append("overlap below -0.5: all factors at -0.5, shear included")
                yield self.compare(
                    response,
                    (location, part.name, STRESS.format(location)),
                    TO_BE_VERIFIED,
                    stress,
                    fatigue / LEAST_Q,
                    "N/mm2",
                    spans=spans,
                    notes=(f"sigma_DW {fatigue:.5g} N/mm2 / {LEAST_Q:g}",),
                    remarks=tuple(remarks),
                )

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Yield the checks, each with its acceptability factor and its restrictions."""
        train, settings, throw = evidence.study.train, self.settings, self.settings.throw
        cranks = {part.name: number for number, part, _ in with_role(train, "crank")}
        for check in super().judge(evidence):
            notes = [check.note]
            if check.value and math.isfinite(check.limit):
                notes.insert(0, f"Q = {LEAST_Q * check.limit / check.value:.4g}")
            check_with_factor = replace(check, note="; ".join(filter(None, notes)))

            # Conditions of a pass that the file does not answer.
            words = list[str]()
            if settings.built is None:
                words.append("crankshaft in one piece (`built` is not stated)")
            if settings.manufacture is None or abs(settings.factor - CAST) < ROUNDING:
                source = " (`manufacture` is not stated)" if settings.manufacture is None else ""
                words.append(f"crankshaft forged, or cast with approved cold rolling{source}")
            outer = diameters(train, cranks[check.where])[0][0] * MM
            if outer < min(throw.pin, throw.journal) * (1 - SAME_SIZE):
                lacks = f"the crank of the train has {outer:.4g} mm"
                words.append(f"pin and journals as large as the rule has them: {lacks}")
            words.append(SMOOTH_BORE if check.clause == BORE else SMOOTH_FILLETS)
            if check.clause == BORE and settings.drilling is None:
                words.append("oil bore drilled radially (`drilling` is not stated)")
            if check.clause == BORE:
                words.append(LARGE_JOURNAL if throw.journal >= throw.pin else SMALL_JOURNAL)
            yield restricted(check_with_factor, *words)

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Yield places without factors, shrink fits, orders that nothing excites, and a misfire that no case has."""
        settings = self.settings
        for number, part, shaft in with_role(study.train, "crank"):
            strength = (study.train.materials[shaft.material].tensile_strength or 0.0) * PA
            for location in _stated_places(settings):
                if doubts := "; ".join(_doubts(settings, location, strength)):
                    about = location, part.name, STRESS.format(location), doubts
                    yield unjudged(self.name, *about)
            if settings.built == "semi-built":
                what = "Shrink fits of the crankshaft"
                yield unjudged(self.name, "shrink fits", part.name, what, UNJUDGED_FITS)
            # Orders that the rule requires in the synthesis, and that nothing excites. Of an engine only its gas counts:
            # moving masses have nearly every order, and loads may have the missing ones.
            engine = next((record for record in engines_of(study) if number in record.cranks), None)
            if engine is None:
                excited = {order / abs(part.ratio) for order in excited_orders(study.train)}
            else:
                excited = set() if engine.gas is None else set(engine.gas_orders)
            strokes = settings.strokes
            if strokes is not None and (lacking := lacking_orders(strokes, excited)):
                what = "Orders of the synthesis"
                yield unjudged(self.name, "orders", part.name, what, lacking)
        yield from misfire_row(self.name, study, "KR A5-3 2(2)(A)(b)")


def _stated_places(settings: M53Settings) -> tuple[str, ...]:
    """Return the places that the crankshaft has: a semi-built one has no fillet of the journal."""
    journal = () if settings.built == "semi-built" else (JOURNAL,)
    return (PIN, *journal, *(() if settings.oil_bore == 0.0 else (BORE,)))


def _doubts(settings: M53Settings, location: str, strength: float) -> Iterator[str]:
    """Yield why the rule has no value for a place, in words; strength: N/mm2."""
    if settings.manufacture == "cast":
        yield "the rule has no factor K for a cast crankshaft without approved cold rolling"
    if strength < LEAST_STRENGTH * (1 - ROUNDING):
        yield f"tensile strength {strength:.4g} N/mm2, below {LEAST_STRENGTH:g} (ours)"
    if location == BORE and settings.oil_bore is None:
        yield "`oil_bore` is not stated: write its diameter, or `oil_bore: none`"
    if location == BORE and settings.drilling == "other":
        yield "the factors hold for a radial oil bore"
    if location == BORE and settings.built == "semi-built":
        yield "the factors hold for a solid crankshaft"
    for name in RATIOS[location]:
        ratio, (lowest, highest) = settings.throw.ratios[name], RANGES[name]
        if not lowest - ROUNDING <= ratio <= highest + ROUNDING:
            words = f"at most {highest:g}" if lowest == -math.inf else f"{lowest:g} to {highest:g}"
            yield f"outside the range of the factors: {name} {ratio:.4g}, {words}"


def _places(
    settings: M53Settings, torque: FloatArray, strength: float
) -> Iterator[tuple[str, FloatArray, float]]:
    """Yield both fillets and the oil bore: name, (speeds,) equivalent stress and the fatigue strength, N/mm2."""
    throw, (added, _) = settings.throw, settings.added_bending
    of_pin = torque / section_modulus(throw.pin / MM, throw.pin_bore / MM) * PA
    of_journal = torque / section_modulus(throw.journal / MM, throw.journal_bore / MM) * PA
    bending, shear = (settings.bending or 0.0) * PA, (settings.shear or 0.0) * PA

    local = factors.alpha_b(throw) * bending + added
    fatigue = factors.fatigue_strength(strength, throw.pin, throw.pin_fillet, settings.factor)
    yield PIN, np.hypot(local, ROOT_3 * factors.alpha_t(throw) * of_pin), fatigue

    local = factors.beta_b(throw) * bending + factors.beta_q(throw) * shear + added
    size = throw.journal, throw.journal_fillet
    fatigue = factors.fatigue_strength(strength, *size, settings.factor)
    torsion = factors.alpha_t(throw, journal=True) * of_journal
    yield JOURNAL, np.hypot(local, ROOT_3 * torsion), fatigue

    if throw.oil_bore:
        local = factors.gamma_b(throw) * (settings.bore_bending or 0.0) * PA
        manufacture = min(settings.factor, 1.0)  # grain flow does not help at the bore
        fatigue = factors.fatigue_strength(strength, throw.pin, throw.oil_bore / 2.0, manufacture)
        yield BORE, factors.of_bore(local, factors.gamma_t(throw) * of_pin), fatigue
