"""Normal firing, misfire, zero pitch, another stiffness: rows NOT JUDGED where neither file nor a case has them."""

import pytest

import torsion
from torsion.rules.verdict_line import Checks

SCENE = """
name: n
operation: {speeds: {from: 300 rpm, to: 600 rpm, steps: 4}, rated: {speed: 600 rpm, power: 50 kW}}
materials: {s: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850, tensile_strength: 600 MPa}}
train:
  - engine: {name: diesel, ENGINE}
  - coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, vibratory_torque: 9 kN*m}
  - shaft: {name: line, length: 2 m, diameter: 150 mm, role: intermediate, material: s, segments: 1}
  - propeller: {name: wheel, inertia: 60, PITCH}
rules: [RULE]
"""
STATES = ("misfire", "zero pitch", "other stiffness", "normal firing", "P_KW misfire")
MISFIRE, PITCH = (
    "{set: {diesel.misfire: 2}}",
    "{set: {operation.load: [[300 rpm, 75 N*m], [600 rpm, 250 N*m]]}}",
)
SOFT = "{scale: {rubber.stiffness: 80 %}}"
ENGINE = (
    "cylinders: 4, strokes: 4, firing_order: [1, 3, 4, 2], crank_inertia: 1.5, stiffness: 6 MN*m/rad, "
    "loss_factor: 1.5 %, geometry: {bore: 180 mm, stroke: 220 mm, rod_length: 440 mm}, "
    "masses: {piston: 8 kg, rod: {mass: 15 kg, centre: 150 mm, inertia: 0.5}}, "
    "gas: {cycle: wiebe, compression_ratio: 14, charge: 2 bar, exhaust: 1.5 bar, imep: 8 bar, p_max: 100 bar, "
    "duration: 60 deg}, mechanical_efficiency: 90 %"
)


def open_rows(
    rule: str,
    cases: str = "",
    pitch: str = "pitch: controllable",
    engine: str = "",
    role: str = "intermediate",
    coupling: str = "",
) -> dict[str, str]:
    text = SCENE.replace("intermediate", role).replace("ENGINE", ENGINE + engine)
    text = (
        text.replace("PITCH", pitch).replace("RULE", rule).replace("9 kN*m}", f"9 kN*m{coupling}}}")
    )
    found = torsion.run(torsion.parse(text + cases)).need(Checks).lines
    return {f"{row.clause} {row.where}": row.verdict for row in found if row.clause in STATES}


@pytest.mark.parametrize("rule", ["dnv", "kr", "iacs-m68"])
def test_states_that_no_case_has_are_not_judged(rule: str) -> None:
    demanded = STATES[:2] if rule == "iacs-m68" else STATES[:3]
    rows = open_rows(rule)
    assert {key.rpartition(" ")[0]: verdict for key, verdict in rows.items()} == dict.fromkeys(
        demanded, "not judged"
    )


@pytest.mark.parametrize(
    ("cases", "left"),
    [
        (f"cases: {{a: {MISFIRE}, b: {PITCH}, c: {SOFT}}}\n", ()),
        (f"cases: {{a: {MISFIRE}, b: {PITCH}}}\n", ("other stiffness rubber",)),
        (
            f"cases: {{a: {MISFIRE[:-1]}, judged: false}}, b: {PITCH}, c: {SOFT}}}\n",
            ("misfire diesel",),
        ),
        (
            f"cases: {{a: {MISFIRE[:-1]}, rules: [coupling-maker]}}, b: {PITCH}, c: {SOFT}}}\n",
            ("misfire diesel",),
        ),
    ],
)
def test_states_that_a_judged_case_has_are_no_row(cases: str, left: tuple[str, ...]) -> None:
    assert open_rows("dnv", cases) == dict.fromkeys(left, "not judged")


NORMAL = "cases: {n: {set: {diesel.misfire: []}}}\n"


@pytest.mark.parametrize("engine", [", misfire: 2", ", misfire: worst"])
@pytest.mark.parametrize("rule", ["iacs-m68", "coupling-maker", "bv"])
def test_a_file_whose_only_state_is_a_misfire_has_a_row_about_the_normal_one(
    engine: str, rule: str
) -> None:
    """Its mean torque, load and heat are lower than those of all cylinders firing."""
    given = {"pitch": "pitch: fixed", "engine": engine}
    stiff = {} if rule != "bv" else {"other stiffness rubber": "not judged"}
    row = {"normal firing diesel": "not judged"}
    assert open_rows(rule, **given) == row | stiff
    assert open_rows(rule, NORMAL, **given) == stiff
    assert open_rows(rule, NORMAL.replace("[]}", "[]}, judged: false"), **given) == row | stiff
    assert open_rows(rule, NORMAL.replace("[]}", "[]}, rules: [api-610]"), **given) == row | stiff


def test_a_pitch_that_a_ship_does_not_state_is_a_restriction() -> None:
    given = {"engine": ", misfire: 2", "cases": NORMAL, "pitch": "blades: 4"}
    assert open_rows("iacs-m68", **given) == {}
    assert open_rows("iacs-m68", **given, role="propeller") == {"zero pitch wheel": "restricted"}


@pytest.mark.parametrize(
    ("load", "is_open"),
    [
        ("[[300 rpm, 75 N*m], [600 rpm, 250 N*m]]", False),
        ("[[300 rpm, 90 N*m], [600 rpm, 250 N*m]]", True),  # 0.45 of the normal load at 300 rpm
        ("[[300 rpm, 700 N*m], [600 rpm, 900 N*m]]", True),  # bollard pull
        ("constant", True),
    ],
)
def test_a_case_at_zero_pitch_has_a_small_share_of_the_normal_load_at_every_speed(
    load: str, is_open: bool
) -> None:
    """796 N m at 600 rpm, 199 N m at 300 rpm by the propeller law; at most 0.4 of it."""
    rows = open_rows("iacs-m68", f"cases: {{z: {{set: {{operation.load: {load}}}}}}}\n")
    assert ("zero pitch wheel" in rows) == is_open


@pytest.mark.parametrize(
    ("tolerance", "cases", "is_open"),
    [
        ("", "a: {scale: {rubber.stiffness: 80 %}}", False),
        ("", "a: {set: {rubber.psi: 0.8}}", True),
        ("", "a: {set: {rubber.stiffness: 30 MN*mm/rad}}", False),
        (", tolerance: 15 %", "a: {scale: {rubber.stiffness: 80 %}}", True),
        (
            ", tolerance: 15 %",
            "a: {scale: {rubber.stiffness: 86 %}}, b: {scale: {rubber.stiffness: 2}}",
            True,
        ),
        (
            ", tolerance: 15 %",
            "a: {scale: {rubber.stiffness: 85 %}}, b: {set: {rubber.stiffness: 46000}}",
            False,
        ),
        (", tolerance: 15 %", "from: tolerances", False),
    ],
)
def test_another_stiffness_is_that_of_every_limited_coupling_to_the_ends_of_its_tolerance(
    tolerance: str, cases: str, is_open: bool
) -> None:
    rows = open_rows("bv", f"cases: {{{cases}}}\n", coupling=tolerance)
    assert ("other stiffness rubber" in rows) == is_open


OTHER = (
    ", power: 25 kW}\n  - coupling: {name: link, stiffness: 9 MN*m/rad}\n  - engine: {name: other, "
    + ENGINE
    + ", phase: 60 deg, power: 25 kW"
)


@pytest.mark.parametrize(
    ("cases", "left"),
    [
        ("", ["diesel", "other"]),
        ("cases: {a: {set: {diesel.misfire: 2}}}\n", ["other"]),
        ("cases: {a: {set: {other.misfire: worst}}}\n", ["diesel"]),
        ("cases: {a: {set: {diesel.misfire: 2}}, b: {set: {other.misfire: 2}}}\n", []),
        (
            "cases: {a: {set: {diesel.misfire: 2}}, b: {based_on: a, set: {other.misfire: 2}}}\n",
            [],
        ),
    ],
)
def test_the_misfire_of_an_engine_is_none_of_another(cases: str, left: list[str]) -> None:
    rows = open_rows("iacs-m68", cases, pitch="pitch: fixed", engine=OTHER)
    assert rows == {f"misfire {name}": "not judged" for name in left}
    limits = ", heat_limit: 1 W, heat_limit_misfire: 2 W"
    rows = open_rows("coupling-maker", cases, engine=OTHER, coupling=limits)
    assert ("P_KW misfire rubber" in rows) == bool(left)
