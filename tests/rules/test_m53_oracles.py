"""Crank throws of IACS UR M53 against numbers computed from its formulas, and files that the rule does not pass."""

import json
import math
from pathlib import Path

import pytest
from typer.testing import CliRunner

from torsion.cli import app
from torsion.rules.class_rules import m53_settings as factors
from torsion.rules.class_rules.m53 import M53Settings, _places
from torsion.rules.class_rules.m53_settings import Throw

VECTORS = json.loads((Path(__file__).parent / "rules_oracles.json").read_text(encoding="utf-8"))[
    "vectors"
]
THROWS = {vector["id"]: vector for vector in VECTORS if vector["rule"] == "iacs-m53"}
SIZES = {
    "D": "pin",
    "DG": "journal",
    "RH": "pin_fillet",
    "RG": "journal_fillet",
    "Wt": "web_thickness",
    "B": "web_width",
    "E": "radius",
    "DO": "oil_bore",
    "DBH": "pin_bore",
    "DBG": "journal_bore",
    "TH": "pin_recess",
    "TG": "journal_recess",
}


def throw_of(given: dict) -> Throw:
    return Throw(**{name: float(given[key]) for key, name in SIZES.items() if key in given})


@pytest.mark.parametrize("vector", THROWS.values(), ids=THROWS)
def test_factors_of_a_throw(vector: dict) -> None:
    throw, expected = throw_of(vector["input"]), vector["expected"]
    assert throw.ratios["s"] == pytest.approx(expected["s"], rel=1e-6)
    assert throw.overlap == pytest.approx(expected["s used"], rel=1e-6)
    found = {
        "alpha_B": factors.alpha_b(throw),
        "alpha_T": factors.alpha_t(throw),
        "beta_B": factors.beta_b(throw),
        "beta_Q (s used)": factors.beta_q(throw),
        "beta_T": factors.alpha_t(throw, journal=True),
    }
    assert found == {name: pytest.approx(expected[name], rel=1e-6) for name in found}
    if "gamma_B" in expected:
        assert factors.gamma_b(throw) == pytest.approx(expected["gamma_B"], rel=1e-6)
        assert factors.gamma_t(throw) == pytest.approx(expected["gamma_T"], rel=1e-6)


@pytest.mark.parametrize("vector", THROWS.values(), ids=THROWS)
def test_stresses_and_acceptability_of_a_throw(vector: dict) -> None:
    given, expected = vector["input"], vector["expected"]
    sizes = {name: given[key] / 1e3 for key, name in SIZES.items() if key in given}
    stresses = {
        "bending": given["bend"] * 1e6,
        "shear": given["shear"] * 1e6,
        "additional": given["add"] * 1e6,
    }
    more = {"bore_bending": given["bore_bend"] * 1e6} if "bore_bend" in given else {}
    settings = M53Settings.model_validate(
        {**sizes, **stresses, **more, "manufacture": given["K"], "strokes": 2}
    )
    places = {
        place: (float(stress), fatigue)
        for place, stress, fatigue in _places(settings, given["T"], given["sB"])
    }
    for place, name in (
        ("pin fillet", "pin"),
        ("journal fillet", "journal"),
        ("oil bore", "oil bore"),
    ):
        if name in expected:
            stress, fatigue = places[place]
            assert stress == pytest.approx(expected[name]["sigma_v"], rel=1e-6)
            assert fatigue == pytest.approx(expected[name]["sigma_DW"], rel=1e-6)
            assert fatigue / stress == pytest.approx(expected[name]["Q"], rel=1e-6)
            assert (1.15 * stress / fatigue <= 1.0) == (expected[name]["verdict"] == "PASS")


@pytest.mark.parametrize(
    ("given", "stress"),
    [
        ({}, 30.0),
        ({"engine": "crosshead"}, 30.0),
        ({"engine": "trunk piston"}, 10.0),
        ({"axial": 12e6}, 22.0),
        ({"additional": 19e6}, 19.0),
    ],
)
def test_additional_bending_of_the_kind_of_engine(given: dict, stress: float) -> None:
    added, words = M53Settings.model_validate(given).added_bending
    assert added == pytest.approx(stress, rel=1e-12)
    assert ("stated by user" in words) == bool({"axial", "additional"} & given.keys())


SCENE = """
name: A crank of one throw
operation: {speeds: {from: 60 rpm, to: 106 rpm, steps: 47}, rated: {speed: 100 rpm, power: 1 kW}, load: constant}
materials: {crank steel: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 0, tensile_strength: STRENGTH MPa}}
train:
  - motor: {name: front, inertia: 1e-3, ripple: [RIPPLE], power: 1 kW}
  - shaft: {name: throw, length: 10 mm, diameter: PIN mm, role: crank, material: crank steel}
  - propeller: {name: wheel, inertia: 1e6}
rules:
  - iacs-m53:
      pin: PIN mm
      journal: JOURNAL mm
      pin_fillet: RH mm
      journal_fillet: RG mm
      web_thickness: WEB mm
      web_width: WIDTH mm
      radius: CRANK mm
      bending: BEND MPa
      shear: SHEAR MPa
      strokes: 2
      ENGINE
"""
ENGINES = {
    "m53-d1": "engine: crosshead",
    "m53-d2": "engine: trunk piston",
    "m53-d3": "engine: trunk piston",
    "m53-d4": "manufacture: 0.93",
}


@pytest.mark.parametrize("name", ENGINES)
def test_a_file_whose_crank_the_rule_refuses_does_not_pass(name: str, tmp_path: Path) -> None:
    given, expected = THROWS[name]["input"], THROWS[name]["expected"]
    orders = [
        f"{{order: {order}, torque: {given['T'] if order == 1 else 1e-6} N*m}}"
        for order in range(1, 16)
    ]
    words = {
        "STRENGTH": given["sB"],
        "RIPPLE": ", ".join(orders),
        "PIN": given["D"],
        "JOURNAL": given["DG"],
        "RH": given["RH"],
        "RG": given["RG"],
        "WEB": given["Wt"],
        "WIDTH": given["B"],
        "CRANK": given["E"],
        "BEND": given["bend"],
        "SHEAR": given["shear"],
        "ENGINE": ENGINES[name],
    }
    text = SCENE
    for word, value in words.items():
        text = text.replace(word, str(value))
    (tmp_path / "crank.yaml").write_text(text)
    done = CliRunner().invoke(
        app, ["solve", str(tmp_path / "crank.yaml"), "-o", str(tmp_path / "out")]
    )
    assert done.exit_code == 1, done.output
    assert "✗ FAIL: " in done.output
    checks = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["checks"]
    for place in ("pin", "journal"):
        row = next(check for check in checks if check["clause"] == f"{place} fillet")
        assert row["value"] == pytest.approx(expected[place]["sigma_v"], rel=1e-4)
        assert row["verdict"] == (
            "restricted" if expected[place]["verdict"] == "PASS" else "not kept"
        )
    assert [check["verdict"] for check in checks if check["clause"] == "misfire"] == ["not judged"]
    assert not [check for check in checks if check["clause"] == "orders"]


def test_radii_below_2_mm_count_as_2_mm_in_the_fatigue_strength_alone() -> None:
    assert factors.fatigue_strength(800.0, 45.0, 1.5, 1.0) == factors.fatigue_strength(
        800.0, 45.0, 2.0, 1.0
    )
    fine, plain = (Throw(45, 45, radius, radius, 14, 60, 35) for radius in (1.5, 2.0))
    assert factors.alpha_t(fine) > factors.alpha_t(plain)
    assert math.isfinite(factors.beta_q(fine))
