"""What UR M53 does not judge, and what a pass stands on: rows NOT JUDGED, restrictions, and located contradictions."""

import math
from fractions import Fraction
from pathlib import Path

import pytest
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.model.component import Material
from torsion.rules import lacking, settings, verdicts
from torsion.rules.class_rules.m53 import M53Settings
from torsion.rules.verdict_line import Check, Checks

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
    "built": "solid",
    "drilling": "radial",
}
PLACES = "pin fillet", "journal fillet", "oil bore"
ORDERS = [{"order": Fraction(k, 2), "torque": 10.0} for k in range(1, 25)]
ENGINE = Path(__file__).parents[2] / "shafting_specs" / "diesel_misfire.yaml"


@pytest.fixture
def rows(study, evidence):
    def run(
        *without: str, strength: float = 800e6, diameter: float = 0.2, **changed
    ) -> dict[str, Check]:
        crank = {
            "name": "crank",
            "length": 0.3,
            "diameter": diameter,
            "role": "crank",
            "segments": 1,
            "material": "m",
        }
        train = [
            ("motor", {"inertia": 3.0, "ripple": ORDERS}),
            ("shaft", crank),
            ("disc", {"inertia": 2.0}),
        ]
        given = {key: value for key, value in {**GIVEN, **changed}.items() if key not in without}
        steel = {"m": Material(shear_modulus=79e9, density=7850.0, tensile_strength=strength)}
        scene = study(
            train, [("iacs-m53", settings("iacs-m53").model_validate(given))], materials=steel
        )
        assert lacking(scene) == []
        found = verdicts(
            evidence(scene, [900.0], half={"crank": 10e6 * math.pi / 16 * 0.2**3})
        )  # 10 N/mm2
        return {one.clause: one for one in found if one.clause != "misfire"}

    return run


def words_of(rows: dict[str, Check]) -> dict[str, str]:
    return {clause: row.verdict for clause, row in rows.items()}


@pytest.mark.parametrize(
    ("changed", "places", "ratio"),
    [
        ({"pin_fillet": 0.002}, ["pin fillet"], "r of the pin 0.01, 0.03 to 0.13"),
        ({"journal_fillet": 0.03}, ["journal fillet"], "r of the journal 0.15"),
        ({"web_width": 0.6}, ["pin fillet", "journal fillet"], "b 3, 1.1 to 2.2"),
        ({"web_thickness": 0.03}, ["pin fillet", "journal fillet"], "w 0.15, 0.2 to 0.8"),
        ({"radius": 0.05}, ["pin fillet", "journal fillet"], "s 0.75, at most 0.5"),
        ({"pin_bore": 0.17}, ["pin fillet", "journal fillet"], "d of the bore of the pin 0.85"),
        ({"oil_bore": 0.05}, ["oil bore"], "d of the oil bore 0.25, 0 to 0.2"),
    ],
)
def test_a_throw_outside_the_range_of_the_factors_is_not_judged_there(
    rows, changed, places, ratio
) -> None:
    found = rows(**changed)
    assert words_of(found) == dict.fromkeys(PLACES, "restricted") | dict.fromkeys(
        places, "not judged"
    )
    for place in places:
        assert found[place].note.startswith(f"outside the range of the factors: {ratio}")


def test_a_ratio_at_the_end_of_its_range_is_judged(rows) -> None:
    """0.026/0.2 is 0.13 but for rounding; so are 0.44/0.2 and 0.04/0.2."""
    ends = rows(
        pin_fillet=0.026, journal_fillet=0.006, web_width=0.44, web_thickness=0.16, oil_bore=0.04
    )
    assert "not judged" not in words_of(ends).values()


def test_an_oil_bore_that_the_file_does_not_state_is_not_judged(rows) -> None:
    assert words_of(rows("oil_bore")) == {
        **dict.fromkeys(PLACES, "restricted"),
        "oil bore": "not judged",
    }
    assert words_of(rows("oil_bore", "bore_bending", oil_bore="none")) == dict.fromkeys(
        PLACES, "restricted"
    ) | {"oil bore": "not judged"}
    without = words_of(rows(oil_bore="none"))
    assert without == {"pin fillet": "restricted", "journal fillet": "restricted"}


def test_an_oil_bore_that_is_not_radial_is_not_judged(rows) -> None:
    assert words_of(rows(drilling="other")) == {
        **dict.fromkeys(PLACES, "restricted"),
        "oil bore": "not judged",
    }


def test_a_cast_crankshaft_without_cold_rolling_is_not_judged(rows) -> None:
    assert words_of(rows(manufacture="cast")) == dict.fromkeys(PLACES, "not judged")


def test_a_steel_too_weak_for_the_formula_is_not_judged(rows) -> None:
    """At 10 N/mm2 the formula gives a fatigue strength above the tensile strength."""
    assert words_of(rows(strength=10e6)) == dict.fromkeys(PLACES, "not judged")
    assert words_of(rows(strength=400e6, bending=0.0))["pin fillet"] != "not judged"


def test_shrink_fits_of_a_semi_built_crankshaft_are_not_judged(rows) -> None:
    """Its journal has no fillet, and the factors are those of the fillet of the pin."""
    assert words_of(rows(built="semi-built")) == {
        "pin fillet": "restricted",
        "oil bore": "not judged",
        "shrink fits": "not judged",
    }


def test_a_recess_below_the_fillet_thins_the_web_of_a_semi_built_two_stroke_crankshaft() -> None:
    given = {**GIVEN, "pin_recess": 0.02, "additional": 0.0}
    for change, web in (
        ({}, 70.0),
        ({"built": "semi-built"}, 70.0),
        ({"built": "semi-built", "strokes": 2}, 62.0),
    ):
        assert M53Settings.model_validate({**given, **change}).throw.web_thickness == pytest.approx(
            web, rel=1e-12
        )


@pytest.mark.parametrize(
    ("without", "changed", "words", "places"),
    [
        ("built", {}, "in one piece", PLACES),
        ("manufacture", {}, "cast with approved cold rolling", PLACES),
        ("", {"manufacture": 0.93}, "cast with approved cold rolling", PLACES),
        ("", {"diameter": 0.15}, "the crank of the train has 150 mm", PLACES),
        ("", {}, "fillets smooth", PLACES[:2]),
        ("", {}, "smooth down to 1.5 times its diameter", PLACES[2:]),
        ("drilling", {}, "drilled radially", PLACES[2:]),
        ("", {}, "journal oil bores formed like the oil bore of the pin", PLACES[2:]),
        ("", {"journal": 0.19}, "journal oil bores with separate evidence", PLACES[2:]),
    ],
)
def test_a_pass_states_the_conditions_that_the_file_does_not_answer(
    rows, without, changed, words, places
) -> None:
    found = rows(without, **changed)
    assert {
        clause for clause, row in found.items() if any(words in one for one in row.restrictions)
    } == set(places)


@pytest.mark.parametrize("journal", [0.2, 0.22])  # the crank of the train has the smaller of both
def test_conditions_that_the_file_answers_are_no_restriction(rows, journal: float) -> None:
    text = "; ".join(words for row in rows(journal=journal).values() for words in row.restrictions)
    assert not [
        word for word in ("one piece", "cold rolling", "radially", "of the train") if word in text
    ]


@pytest.mark.parametrize("change", [{"engine": "crosshead"}, {"axial": 12e6}])
def test_a_crosshead_engine_with_four_strokes_is_refused(change: dict) -> None:
    given = {key: value for key, value in GIVEN.items() if key != "additional"}
    with pytest.raises(ValueError, match="a crosshead engine has two strokes"):
        M53Settings.model_validate({**given, **change})
    M53Settings.model_validate({**given, **change, "strokes": 2})


def test_a_bore_as_large_as_its_journal_is_refused() -> None:
    for key in ("pin", "journal"):
        with pytest.raises(ValueError, match=f"`{key}_bore` is not smaller than `{key}`"):
            M53Settings.model_validate({**GIVEN, f"{key}_bore": 0.2})


STEEL = """materials:
  crank steel: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850, tensile_strength: 900 MPa}
"""
RULE = """rules:
  - iacs-m53: {pin: 250 mm, journal: 260 mm, pin_fillet: 14 mm, journal_fillet: 14 mm, web_thickness: 95 mm,
               web_width: 440 mm, radius: 200 mm, bending: 10 MPa, shear: 2 MPa, strokes: 4, manufacture: 1.05,
               engine: trunk piston, oil_bore: none}
"""


def engine_file(*changes: tuple[str, str]) -> str:
    text = ENGINE.read_text(encoding="utf-8").replace(
        "rules: [coupling-maker, gear-hammer]", STEEL + RULE
    )
    text = text.replace("      strokes: 4\n", "      strokes: 4\n      material: crank steel\n")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


@for_all(
    ("old", "new", "message"),
    [
        (
            "pin: 250 mm",
            "pin: 300 mm",
            "`pin` of iacs-m53 is 300 mm, and the engine 'main engine' has 250 mm",
        ),
        (
            "journal: 260 mm",
            "journal: 300 mm",
            "`journal` of iacs-m53 is 300 mm, and the engine 'main engine' has 260",
        ),
        (
            "radius: 200 mm",
            "radius: 160 mm",
            "`radius` of iacs-m53 is 160 mm, and the engine 'main engine' has 200 mm",
        ),
        (
            "strokes: 4, manufacture",
            "strokes: 2, manufacture",
            "`strokes` of iacs-m53 is 2, and the engine",
        ),
        (
            "oil_bore: none",
            "oil_bore: none, pin_bore: 50 mm",
            "`pin_bore` of iacs-m53 is 50 mm, and the engine",
        ),
    ],
)
def test_a_size_that_the_engine_has_otherwise_is_refused_where_both_stand(
    old: str, new: str, message: str
) -> None:
    text = engine_file((old, new))
    with pytest.raises(InputError) as caught:
        torsion.parse(text, str(ENGINE))
    (fault,) = caught.value.faults
    assert fault.message.startswith(message)
    assert " in line " in fault.message
    line = text.splitlines()[fault.line - 1]
    assert line[fault.column - 1 :].startswith(new.rsplit(" ", 2)[-2] if "mm" in new else "2")


def engine_rows(*changes: tuple[str, str]) -> dict[str, list[Check]]:
    found = dict[str, list[Check]]()
    for row in torsion.run(torsion.parse(engine_file(*changes), str(ENGINE))).need(Checks).lines:
        found.setdefault(row.clause, []).append(row)
    return found


def test_an_engine_whose_sizes_agree_is_judged_with_restrictions_only() -> None:
    """Seven crank spans; the file has a misfire and its gas every order from 1/2 to 12."""
    rows = engine_rows()
    assert [row.verdict for row in rows.pop("normal firing")] == ["not judged"]
    assert set(rows) == {"pin fillet", "journal fillet"}
    assert {row.verdict for row in rows["pin fillet"]} <= {"restricted", "not kept"}
    assert [len(spans) for spans in rows.values()] == [7, 7]


def test_moving_masses_are_no_gas_torque() -> None:
    """Half orders are those of the gas; of an engine without gas, and of a table with one row, the others lack."""
    text = ENGINE.read_text(encoding="utf-8")
    gas = text[text.index("      gas:\n") : text.index("      mechanical_efficiency")]
    for table, orders in (
        ("", "1/2, 1, 3/2, 2, 5/2, 3 and 18 more"),
        ("[1, 900 N*m, 0 deg]", "1/2, 3/2, 2, 5/2"),
    ):
        new = f"      gas: {{table: [{table}]}}\n" if table else ""
        rows = engine_rows((gas, new), ("      misfire: 6\n", ""))
        assert len(rows["orders"]) == 7
        assert {row.verdict for row in rows["orders"]} == {"not judged"}
        assert all(row.note.startswith(f"orders {orders}") for row in rows["orders"])
