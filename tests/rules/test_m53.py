"""Crank throws after IACS UR M53 against reference values of one throw, and verdicts about its edges."""

import math
from fractions import Fraction

import numpy as np
import pytest

from torsion.model.component import Material
from torsion.rules import lacking, settings, verdicts
from torsion.rules.class_rules import m53_settings
from torsion.rules.class_rules.m53_settings import Throw

THROW = Throw(200, 200, 12, 12, 70, 260, 140, 20)  # mm
W_P = math.pi / 16 * 0.2**3
PLACES = "pin fillet", "journal fillet", "oil bore"
GIVEN = {
    "pin": 0.2,
    "journal": 0.2,
    "pin_fillet": 0.012,
    "journal_fillet": 0.012,
    "web_thickness": 0.07,
    "web_width": 0.26,
    "radius": 0.14,
    "oil_bore": 0.02,
    "bending": 40e6,
    "shear": 5e6,
    "bore_bending": 20e6,
    "additional": 10e6,
    "manufacture": 1.05,
    "strokes": 4,
}
STEEL = {"m": Material(shear_modulus=79e9, density=7850.0, tensile_strength=800e6)}


def line(orders=tuple(Fraction(k, 2) for k in range(1, 25))):
    ripple = [{"order": order, "torque": 10.0} for order in orders]
    crank = {
        "name": "crank",
        "length": 0.3,
        "diameter": 0.2,
        "role": "crank",
        "segments": 1,
        "material": "m",
    }
    return [
        ("motor", {"inertia": 3.0, "ripple": ripple}),
        ("shaft", crank),
        ("disc", {"inertia": 2.0}),
    ]


@pytest.fixture
def judged(study, evidence):
    def run(tau, **given):
        scene = study(
            line(),
            [("iacs-m53", settings("iacs-m53").model_validate({**GIVEN, **given}))],
            materials=STEEL,
        )
        assert lacking(scene) == []
        return {
            one.clause: one
            for one in verdicts(evidence(scene, [900.0], half={"crank": tau * 1e6 * W_P}))
        }

    return run


def test_factors_of_the_throw_are_the_reference_values() -> None:
    found = [
        m53_settings.alpha_b(THROW),
        m53_settings.alpha_t(THROW),
        m53_settings.beta_b(THROW),
        m53_settings.beta_q(THROW),
        m53_settings.gamma_b(THROW),
        m53_settings.gamma_t(THROW),
    ]
    wanted = [1.7327070384, 2.2954436056, 1.8217204262, 2.4407162979, 2.758, 3.7]
    np.testing.assert_allclose(found, wanted, rtol=5e-11)
    assert m53_settings.alpha_t(THROW, journal=True) == m53_settings.alpha_t(THROW)
    assert m53_settings.fatigue_strength(800, 200, 12, 1.05) == pytest.approx(
        277.2390682499, rel=1e-12
    )
    assert m53_settings.fatigue_strength(800, 200, 10, 1.0) == pytest.approx(
        266.5706309874, rel=1e-12
    )


def test_equivalent_stresses_and_acceptability_are_the_reference_values(judged) -> None:
    """30 N/mm2 of torsion: Q 1.93555, 1.81761, 1.96994, the limits 277.239 and 266.571 over 1.15."""
    found = judged(30.0)
    clauses = ["pin fillet", "journal fillet", "oil bore"]
    values = [143.2350137233, 152.5294286355, 135.3194595198]
    np.testing.assert_allclose([found[clause].value for clause in clauses], values, rtol=5e-11)
    limits = np.array([277.2390682499, 277.2390682499, 266.5706309874]) / 1.15
    np.testing.assert_allclose([found[clause].limit for clause in clauses], limits, rtol=1e-11)
    for clause, quotient in zip(clauses, ("1.936", "1.818", "1.97"), strict=True):
        assert f"Q = {quotient};" in found[clause].note
        assert found[clause].verdict == "restricted"


def test_an_acceptability_below_1_15_is_not_kept(judged) -> None:
    """tau at which (alpha_B 40 + 10)^2 + 3 (alpha_T tau)^2 = (277.239/1.15)^2."""
    edge = (
        math.sqrt(((277.2390682499 / 1.15) ** 2 - (1.7327070384 * 40 + 10) ** 2) / 3) / 2.2954436056
    )
    assert judged(edge * (1 - 1e-9))["pin fillet"].verdict == "restricted"
    assert judged(edge * (1 + 1e-9))["pin fillet"].verdict == "not kept"


def test_the_oil_bore_of_pure_torsion_has_the_torsion() -> None:
    assert m53_settings.of_bore(0.0, 50.0) == pytest.approx(50.0, rel=1e-14)
    assert m53_settings.of_bore(60.0, 0.0) == pytest.approx(60.0, rel=1e-14)


def test_a_grain_flow_does_not_help_at_the_oil_bore(judged) -> None:
    assert judged(30.0)["oil bore"].limit == judged(30.0, manufacture=1.0)["oil bore"].limit
    assert judged(30.0, manufacture=0.93)["oil bore"].limit < judged(30.0)["oil bore"].limit


def test_orders_that_are_not_given_are_named(study, evidence) -> None:
    halves, whole = [Fraction(k, 2) for k in range(1, 25)], list(range(1, 16))
    for orders, strokes, missing in (
        (halves, 4, ""),
        (halves[:-1], 4, "12"),
        ([*halves[:5], *halves[6:]], 4, "3"),
        (halves, 2, "13, 14, 15"),
        (whole, 2, ""),
        (whole, 4, "1/2, 3/2, 5/2, 7/2, 9/2, 11/2 and 6 more"),
        ([3], 2, "1, 2, 4, 5, 6, 7 and 8 more"),
    ):
        given = settings("iacs-m53").model_validate({**GIVEN, "strokes": strokes})
        scene = study(line(orders), [("iacs-m53", given)], materials=STEEL)
        rows = [
            one for one in verdicts(evidence(scene, [900.0], half={})) if one.clause == "orders"
        ]
        assert [one.note for one in rows] == (
            [f"orders {missing} do not excite"] if missing else []
        )


def test_orders_of_a_crank_behind_a_gear_are_those_of_its_own_shaft(study, evidence) -> None:
    """At half of the reference speed the orders 1 to 15 of a two-stroke crank are 1/2 to 15/2 of the reference."""
    given = settings("iacs-m53").model_validate({**GIVEN, "strokes": 2})
    before = [("motor", {"name": "first", "inertia": 1.0}), ("gear", {"ratio": 2})]
    for orders, missing in ((range(1, 16), ""), (range(1, 15), "15"), (range(2, 31, 2), "1")):
        parts = [*before, *line(tuple(orders))]
        scene = study(parts, [("iacs-m53", given)], materials=STEEL)
        found = verdicts(evidence(scene, [900.0], half={}))
        (note,) = [one.note for one in found if one.clause == "orders"] or [""]
        assert note.startswith(f"orders {missing}" if missing else "")
        assert bool(note) == bool(missing)


def test_a_crank_without_the_orders_that_the_rule_demands_is_not_judged(study, evidence) -> None:
    for orders, verdict in (([Fraction(k, 2) for k in range(1, 25)], ""), ([1, 12], "not judged")):
        given = settings("iacs-m53").model_validate({**GIVEN, "additional": 0.0})
        scene = study(line(orders), [("iacs-m53", given)], materials=STEEL)
        found = verdicts(evidence(scene, [900.0], half={"crank": 30e6 * W_P}))
        assert {one.verdict for one in found if one.clause in PLACES} == {"restricted"}
        rows = [one for one in found if one.clause == "orders"]
        assert [(one.what, one.verdict, "do not excite" in one.note) for one in rows] == (
            [("Orders of the synthesis", verdict, True)] if verdict else []
        )
        worse = verdicts(evidence(scene, [900.0], half={"crank": 90e6 * W_P}))
        assert {one.verdict for one in worse if one.clause in PLACES} == {"not kept"}


def test_a_crank_without_any_stress_has_no_acceptability_factor(study, evidence) -> None:
    still = {"additional": 0.0, "bending": 0.0, "shear": 0.0, "bore_bending": 0.0}
    scene = study(
        line(),
        [("iacs-m53", settings("iacs-m53").model_validate({**GIVEN, **still}))],
        materials=STEEL,
    )
    found = verdicts(evidence(scene, [900.0], half={}))
    assert {one.value for one in found if one.clause in PLACES} == {0.0}


@pytest.mark.parametrize(
    ("key", "places"),
    [
        ("bending", {"pin fillet", "journal fillet"}),
        ("shear", {"journal fillet"}),
        ("bore_bending", {"oil bore"}),
    ],
)
def test_a_nominal_stress_of_0_is_named_where_it_counts(judged, key: str, places) -> None:
    named = {
        place
        for place, check in judged(30.0, **{key: 0.0}).items()
        if f"`{key}` stated as 0 MPa" in check.note
    }
    assert named == places
    assert not any("0 MPa" in check.note for check in judged(30.0).values())


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"pin": None}, "`pin`"),
        ({"oil_bore": 0.02, "bore_bending": None}, "`bore_bending`"),
    ],
)
def test_sizes_that_lack_are_told(study, change, word) -> None:
    given = {key: value for key, value in {**GIVEN, **change}.items() if value is not None}
    found = lacking(
        study(line(), [("iacs-m53", settings("iacs-m53").model_validate(given))], materials=STEEL)
    )
    assert len(found) == 1
    assert word in found[0].message


def test_a_train_without_crankshaft_or_strength_is_a_fault(study) -> None:
    given = settings("iacs-m53").model_validate(GIVEN)
    bare = {"m": Material(shear_modulus=79e9, density=7850.0)}
    assert any(
        "tensile_strength" in one.message
        for one in lacking(study(line(), [("iacs-m53", given)], materials=bare))
    )
    other = [line()[0], ("coupling", {"stiffness": 1e5}), line()[2]]
    assert any(
        "no crankshaft" in one.message for one in lacking(study(other, [("iacs-m53", given)]))
    )
