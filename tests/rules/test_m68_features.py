"""A shaft as M68 sees it: the factors of its features, its slot, its strength, its ends, and the words for them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.rules.conftest import STEEL_600

from torsion.assembly import assemble
from torsion.model.component import Material
from torsion.rules.class_rules import m68_shafts as m68
from torsion.rules.class_rules.shaft_limits import stress_modulus, with_role


def slotted(study, diameter, bore, **settings):
    """The shaft as the rule sees it: a cone with a slot and a radial hole."""
    body = {
        "name": "line",
        "length": 1.0,
        "diameter": diameter,
        "bore": bore,
        "role": "intermediate",
        "features": ["slot", "roller bearing"],
    }
    scene = study([("motor", {"inertia": 3.0}), ("shaft", body), ("disc", {"inertia": 1.0})])
    (shaft,) = m68.classed_shafts(scene, m68.M68Settings.model_validate(settings))
    return shaft


def concentration(diameter, bore, length, width):
    """Of a slot, as Appendix I of the rule prints it: alpha_t + 0.8 (l - e)/d / sqrt((1 - d_i/d) e/d)."""
    e, hollow = width / diameter, bore / diameter
    alpha = 2.3 - 3 * e + 15 * e**2 + 10 * e**2 * hollow**2
    return alpha + 0.8 * (length - width) / diameter / math.sqrt((1 - hollow) * e)


@pytest.mark.parametrize("turned", [1, -1])
@pytest.mark.parametrize(
    ("diameter", "bore"), [([0.1, 0.16], [0.05, 0.05]), ([0.12, 0.12], [0.0, 0.08])]
)
def test_the_slot_of_a_cone_is_judged_at_the_end_where_it_concentrates_more(
    study, diameter, bore, turned
) -> None:
    ends = diameter[::turned], bore[::turned]
    shaft = slotted(study, *ends, slots={"line": {"length": "70 mm", "width": "20 mm"}})
    both = [
        concentration(1e3 * outer, 1e3 * hole, 70, 20) for outer, hole in zip(*ends, strict=True)
    ]
    assert abs(both[0] / both[1] - 1) > 0.1
    assert shaft.governing[1].c_k == pytest.approx(min(1.45 / both[0], 1.45 / both[1]), rel=1e-12)
    assert shaft.governing[0] == "slot"
    assert shaft.k == 1.2
    assert f"C_K {1.45 / max(both):.4g} (slot, to be verified)" in shaft.notes[0]


@pytest.mark.parametrize("turned", [1, -1])
def test_the_slot_of_a_cone_keeps_its_length_at_the_thin_and_its_width_at_the_thick_end(
    study, turned
) -> None:
    """Of 100 mm it is 0.9 long and 0.2 wide, of 160 mm 0.56 and 0.125; the rule wants below 0.8 and above 0.15."""
    slot = {"length": "90 mm", "width": "20 mm", "end_radius": "10 mm", "number": 1}
    shaft = slotted(study, [0.1, 0.16][::turned], [0.0, 0.0], slots={"line": slot})
    assert shaft.doubts == (
        "slot of 'line': length 0.9 of the diameter, not below 0.8",
        "slot of 'line': width 0.125 of the diameter, not above 0.15",
    )


def test_the_table_s_factor_of_a_slot_holds_without_its_dimensions(study) -> None:
    for settings in ({}, {"slots": {"other": {"length": 0.07, "width": 0.02}}}):
        shaft = slotted(study, [0.1], [0.0], **settings)
        assert (shaft.governing[1].c_k, shaft.standing) == (0.3, "rule text")


def test_a_slot_never_adds_to_the_permissible_stress() -> None:
    """2.3 - 3 e + 15 e2 is least at e = 0.1, and every other term adds to it: C_K is at most 1.45/2.15."""
    least = min(m68.slot_concentration(1.0, 0.0, e, e) for e in np.linspace(0.001, 1.0, 1000))
    assert least == pytest.approx(2.15, rel=1e-12)


def test_a_shaft_is_seen_in_mm_with_both_of_its_ends(study) -> None:
    for diameter, bore in (([0.12, 0.2], [0.03, 0.07]), ([0.2, 0.12], [0.07, 0.03])):
        shaft = slotted(study, diameter, bore)
        assert max(outer for outer, _ in shaft.ends) == pytest.approx(200.0, rel=1e-12)
        wanted = [[1e3 * outer, 1e3 * hole] for outer, hole in zip(diameter, bore, strict=True)]
        np.testing.assert_allclose(shaft.ends, wanted, rtol=1e-12)


@pytest.mark.parametrize("turned", [1, -1])
def test_the_modulus_of_a_conical_piece_is_that_of_its_smaller_end(study, turned) -> None:
    """Diameters 100, 110, 120, 130 mm and bores 40, 50, 60, 70 mm at the ends of three pieces."""
    body = {
        "name": "line",
        "length": 1.0,
        "diameter": [0.1, 0.13][::turned],
        "bore": [0.04, 0.07][::turned],
        "role": "thrust",
        "segments": 3,
    }
    scene = study(
        [
            ("motor", {"inertia": 3.0}),
            ("coupling", {"stiffness": 1e4}),
            ("shaft", body),
            ("disc", {"inertia": 1.0}),
        ]
    )
    (shaft,) = m68.classed_shafts(scene, m68.M68Settings())
    spans, modulus = stress_modulus(assemble(scene.train), shaft.part)
    outer, bore = np.array([0.1, 0.11, 0.12]), np.array([0.04, 0.05, 0.06])
    assert spans.tolist() == [1, 2, 3]
    np.testing.assert_allclose(
        modulus[::turned], math.pi / 16 * (outer**4 - bore**4) / outer, rtol=1e-12
    )


NONE_STATED = Material(shear_modulus=79e9, density=7850.0)


def classed(study, material, role="intermediate", features=(), settings=None, **body):
    """A shaft of 120 mm as the rule sees it."""
    shaft = {
        "name": "line",
        "length": 1.0,
        "diameter": 0.12,
        "role": role,
        "features": features,
        "material": "m",
        **body,
    }
    scene = study(
        [("motor", {"inertia": 3.0}), ("shaft", shaft), ("disc", {"inertia": 1.0})],
        materials={"m": material},
    )
    (found,) = m68.classed_shafts(scene, settings or m68.M68Settings())
    return found


SIZE = f"C_D {0.35 + 0.93 * 120**-0.2:.4g}"
CONE = "conical: W_p of the smaller end of every piece, C_D of the maximum diameter"

HOLE = (
    f"C_K 0.5 (radial hole: hole at most 0.3 of the diameter), {SIZE}, sigma_B 400 N/mm2 "
    "(none stated: the least of shaft steel assumed, to be verified)"
)
MOUNTING = (
    "C_K 0.55 (no feature given: kind of propeller mounting not given, the least favourable taken), "
    f"{SIZE}, sigma_B 600 N/mm2 (of 700)"
)


@pytest.mark.parametrize(
    ("strength", "role", "features", "words"),
    [
        (
            500.0,
            "intermediate",
            (),
            f"C_K 1 (no feature given: integral flange assumed), {SIZE}, sigma_B 500 N/mm2",
        ),
        (
            600.0,
            "thrust",
            (),
            f"C_K 0.85 (no feature given: thrust collar assumed), {SIZE}, sigma_B 600 N/mm2",
        ),
        (None, "thrust", ("flange", "radial hole"), HOLE),
        (
            655.5,
            "propeller",
            ("propeller keyed", "shrink fit"),
            f"C_K 0.55 (propeller keyed), {SIZE}, sigma_B 600 N/mm2 (of 655.5)",
        ),
        (700.0, "propeller", (), MOUNTING),
    ],
)
def test_notes_say_the_factors_used_and_what_is_assumed(
    study, strength, role, features, words
) -> None:
    material = (
        NONE_STATED
        if strength is None
        else STEEL_600.model_copy(update={"tensile_strength": strength * 1e6})
    )
    assert classed(study, material, role, features).notes == (words,)
    tapered = classed(study, material, role, features, diameter=[0.1, 0.12])
    assert tapered.notes == (words, CONE)
    assert classed(study, material, role, features, diameter=[0.12, 0.1]).notes == (words, CONE)
    assert classed(study, material, role, features, bore=[0.01, 0.02]).notes == (words,)


def test_a_limit_stands_as_its_factor_and_its_strength_do(study) -> None:
    assert classed(study, STEEL_600).standing == "rule text"
    assert classed(study, NONE_STATED).standing == "to be verified"
    slot = m68.M68Settings.model_validate(
        {"slots": {"line": {"length": "70 mm", "width": "20 mm"}}}
    )
    assert classed(study, STEEL_600, features=("slot",), settings=slot).standing == "to be verified"
    assert classed(study, STEEL_600, features=("slot",)).standing == "rule text"


def test_keyways_and_the_greatest_k_of_several_features_are_those_of_the_table(study) -> None:
    shaft = classed(
        study, STEEL_600, features=("taper keyway", "slot", "flange", "cylinder keyway")
    )
    assert shaft.keyways == ("taper keyway", "cylinder keyway")
    assert (shaft.governing[1].c_k, shaft.k, shaft.governing[0]) == (0.3, 1.2, "slot")


def test_a_shaft_of_any_section_or_without_a_role_is_not_judged(study) -> None:
    plain = {"length": 1.0, "diameter": 0.1}
    scene = study(
        [
            ("shaft", {"name": "a", "role": "thrust", **plain}),
            ("shaft", {"name": "b", **plain}),
            ("shaft", {"name": "c", "role": "thrust", **plain}),
        ]
    )
    first, *others = scene.train.bars
    meshed = replace(scene.train, bars=(replace(first, section=object()), *others))
    assert [part.name for _, part, _ in with_role(scene.train, *m68.ROLES)] == ["a", "c"]
    assert [part.name for _, part, _ in with_role(meshed, *m68.ROLES)] == ["c"]
