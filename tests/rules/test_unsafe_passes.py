"""Files that leave open, or break, what a rule demands never pass plainly."""

import math
from pathlib import Path

import pytest

import torsion
from torsion import commands
from torsion.errors import InputError
from torsion.rules.verdict_line import Check, Checks

LINE = """
name: n
operation: {speeds: {from: 20 rpm, to: 105 rpm, steps: 41}, rated: {speed: 100 rpm, power: 50 kW}}
materials: {steel: {density: 7850, shear_modulus: 79.3 GPa, tensile_strength: 500 MPa}}
train:
- DRIVE: {name: drive, inertia: 1000}
- shaft: {name: line, length: 0.5, diameter: 200 mm, role: intermediate, material: steel, SHAFT}
- shaft: {name: second, length: 0.5, diameter: 200 mm, role: intermediate, material: steel, features: flange}
- propeller: {inertia: 1000, pitch: fixed, blades: 4, excitation: [{blade_order: 1, torque: 1 %}]}
rules: [RULE]
"""


def rows(text: str) -> list[Check]:
    return list(torsion.run(torsion.parse(text)).need(Checks).lines)


def line(
    shaft: str = "features: flange", rule: str = "iacs-m68", drive: str = "motor"
) -> list[Check]:
    """Rows on the stress in continuous use of the shaft `line`."""
    text = LINE.replace("SHAFT", shaft).replace("RULE", rule).replace("DRIVE", drive)
    return [
        one
        for one in rows(text)
        if one.where == "line" and one.clause in ("tau_C", "tau_1") and one.has_limit
    ]


def test_splines_have_no_factor_in_the_table() -> None:
    splines = "features: flange, notches: {splines: {teeth: 10, root: 170 mm, width: 25 mm, fillet: 3 mm}}"
    (row,) = line(splines)
    assert (row.verdict, "splines" in row.note) == ("not judged", True)


@pytest.mark.parametrize(
    ("fillet", "verdict"),
    [(", fillet: 16 mm", "pass"), (", fillet: 15 mm", "not judged"), ("", "not judged")],
)
def test_the_fillet_of_an_integral_flange_is_at_least_eight_per_cent_of_the_diameter(
    fillet: str, verdict: str
) -> None:
    (row,) = line(
        f"features: flange, step: {{flange: {{diameter: 400 mm, thickness: 50 mm{fillet}}}}}"
    )
    assert row.verdict == verdict


@pytest.mark.parametrize(
    "setting",
    ["conditions: ' '", "verified: {edition: ' ', by: A}", "verified: {edition: '1', by: ' '}"],
)
def test_a_blank_document_answers_nothing(setting: str) -> None:
    with pytest.raises(InputError, match="blank"):
        line(rule=f"iacs-m68: {{{setting}}}")


@pytest.mark.parametrize(
    ("drive", "is_agreed"), [("motor", True), ("turbine", True), ("disc", False)]
)
def test_kr_has_no_limits_of_its_own_behind_a_motor_or_turbine(drive: str, is_agreed: bool) -> None:
    (row,) = line(rule="kr", drive=drive)
    assert any("by agreement with KR" in words for words in row.restrictions) == is_agreed


ENGINE = """
name: n
operation: {speeds: {from: 100 rpm, to: 630 rpm, steps: 16}, rated: {speed: 600 rpm, power: 50 kW}}
materials: {s: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850, tensile_strength: 600 MPa}}
train:
- engine: {name: diesel, cylinders: 4, strokes: 4, firing_order: [1, 3, 4, 2], crank_inertia: 1.5, stiffness: 6e6,
    loss_factor: 1.5 %, geometry: {bore: 180 mm, stroke: 220 mm, rod_length: 440 mm}, material: s,
    masses: {piston: 8 kg, rod: {mass: 15 kg, centre: 150 mm, inertia: 0.5}}, gas: {cycle: wiebe, compression_ratio: 14,
    charge: 2 bar, exhaust: 1.5 bar, imep: 8 bar, p_max: 100 bar, duration: 60 deg}, mechanical_efficiency: 90 %, MORE}
- coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, COUPLING}
- shaft: {name: line, length: 2 m, diameter: 150 mm, role: intermediate, material: s, features: flange}
- propeller: {name: wheel, inertia: 60, pitch: fixed}
rules: [RULE]
"""
JOURNAL = "journal: {diameter: 160 mm}, pin: {diameter: 160 mm}"


def driven(
    more: str = "misfire: 2", rule: str = "iacs-m68", coupling: str = "", cases: str = ""
) -> dict[str, Check]:
    """Rows of a train with an engine by their clauses, the last of each."""
    text = (
        ENGINE.replace("MORE", more).replace("RULE", rule).replace(", COUPLING", coupling) + cases
    )
    return {one.clause: one for one in rows(text)}


@pytest.mark.parametrize(
    ("more", "cases", "is_open"),
    [
        ("misfire: 2", "", False),
        ("cut_out: 2", "", True),
        ("orders: 12", "cases: {out: {set: {diesel.misfire: 2}}}\n", False),
        ("orders: 12", "cases: {out: {set: {diesel.cut_out: 2}}}\n", True),
    ],
)
def test_a_cylinder_with_open_valves_does_not_misfire(more: str, cases: str, is_open: bool) -> None:
    """KR 5-4-206.1(3): no injection, with compression."""
    assert ("misfire" in driven(more, cases=cases)) == is_open


@pytest.mark.parametrize("rule", ["iacs-m68", "engine-maker: {crank_stress: 40 MPa}", "bv"])
def test_orders_of_the_gas_that_do_not_excite_are_a_restriction(rule: str) -> None:
    assert "orders" not in driven(f"misfire: 2, {JOURNAL}", rule)
    row = driven(f"misfire: 2, orders: 9, {JOURNAL}", rule)["orders"]
    assert (row.verdict, row.restrictions) == (
        "restricted",
        ("orders 19/2, 10, 21/2, 11, 23/2, 12 of diesel do not excite",),
    )


@pytest.mark.parametrize(
    ("rule", "is_judged"), [("kr", False), ("ccs", False), ("nk", False), ("bv", True)]
)
def test_a_society_with_limits_of_crankshafts_does_not_pass_one_of_unknown_diameter(
    rule: str, is_judged: bool
) -> None:
    assert ("crankshaft" not in driven(rule=rule)) == is_judged
    assert "crankshaft" not in driven(f"misfire: 2, {JOURNAL}", rule)


def test_a_limit_of_heat_in_misfire_is_not_judged_where_every_cylinder_fires() -> None:
    limits = ", rated_torque: 9 kN*m, heat_limit_misfire: 100 W"
    assert driven("orders: 12", "coupling-maker", limits)["P_KW misfire"].verdict == "not judged"
    assert driven("misfire: 2", "coupling-maker", limits)["P_KW misfire"].verdict != "not judged"
    cases = "cases: {out: {set: {diesel.misfire: 2}}}\n"
    assert "P_KW misfire" not in driven("orders: 12", "coupling-maker", limits, cases)


GEARED = """
name: n
operation: {speeds: {from: 100 rpm, to: 630 rpm, steps: 16}, rated: {speed: 600 rpm}}
materials: {s: {shear_modulus: 79 GPa, density: 7850, tensile_strength: 600 MPa}}
train:
- motor: {inertia: 5, ripple: [{order: 1, torque: 1 N*m}]}
- shaft: {name: line, length: 2 m, diameter: 150 mm, role: intermediate, material: s, loss_factor: 1 %}
- gear: {name: box, ratio: 2, inertia: [1, 1]}
- disc: {inertia: 60}
rules: [RULE]
"""


@pytest.mark.parametrize("rule", ["mil-std-167", "lr"])
def test_gears_are_not_judged_without_the_rated_torque(rule: str) -> None:
    (row,) = [one for one in rows(GEARED.replace("RULE", rule)) if one.clause == "gears"]
    assert (row.where, row.verdict) == ("box", "not judged")


CARDAN = """
name: n
operation: {speeds: {from: 300 rpm, to: 1000 rpm}, rated: {speed: 1000 rpm}}
materials: {s: {shear_modulus: 79 GPa, density: 7850YOUNG}}
train:
- joint: {angle: 2 deg}
- shaft: {name: tube, length: 2.5 m, diameter: 60 mm, bore: 54 mm, material: s}
- joint: {angle: 2 deg}
analyses: {joints: }
rules: [universal-joints]
"""


@pytest.mark.parametrize(
    ("young", "verdict"), [(", youngs_modulus: 206 GPa", "pass"), ("", "not judged")]
)
def test_a_tube_of_unknown_critical_speed_is_not_judged(young: str, verdict: str) -> None:
    (row,) = [one for one in rows(CARDAN.replace("YOUNG", young)) if one.clause == "n_crit"]
    assert (row.where, row.verdict) == ("tube", verdict)


FIT = "{length: 100 mm, fit: shrink, diameter: 250 mm, end: last, pressure: 60 MPa, friction: 15 %}"


def test_a_shrink_fit_passes_without_axial_load_and_shock_alone() -> None:
    hubs = (
        f"[{FIT}, {FIT.replace('last', 'first').replace(', pressure: 60 MPa, friction: 15 %', '')}]"
    )
    text = (
        LINE.replace("DRIVE", "motor")
        .replace("SHAFT", f"hub: {hubs}")
        .replace("RULE", "shrink-fits")
    )
    found = {one.what: one for one in rows(text) if one.rule == "shrink-fits"}
    assert found["Maximum torque in the fit, last end"].restrictions == (
        "no axial load, no start or shock in the fit",
    )
    assert found["Maximum torque in the fit, first end"].verdict == "not judged"


MOTION = """
name: n
operation: {rated: {speed: 600 rpm, power: 50 kW}}
train:
- motor: {inertia: 5, ripple: [{order: 1, torque: 30 %}]}
- coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, max_torque: 2 kN*m}
- machine: {inertia: 60}
analyses: {transient: {duration: 0.2 s, initial: steady, events: [{at: motor-1, step: {torque: 1 N*m}}]TORQUES}}
"""


@pytest.mark.parametrize(("torques", "verdict"), [("", "pass"), (", torques: none", "restricted")])
def test_a_motion_without_the_periodic_torques_of_the_file_passes_with_restrictions(
    torques: str, verdict: str
) -> None:
    (row,) = [one for one in rows(MOTION.replace("TORQUES", torques)) if one.rule == "transient"]
    assert (row.verdict, any("motor-1" in words for words in row.restrictions)) == (
        verdict,
        verdict == "restricted",
    )


STEP = """
name: step
train:
- disc: {name: a, inertia: 2}
- coupling: {name: soft, stiffness: 20 kN*m/rad, max_torque: 20 kN*m}
- disc: {name: b, inertia: 2}
analyses: {transient: {duration: DURATION, events: [{at: a, time: 0.1 s, step: {torque: 15 kN*m}}]}}
"""


@pytest.mark.parametrize(("after", "verdict"), [(0.99, "restricted"), (1.01, "pass")])
def test_a_motion_that_ends_within_a_period_after_the_last_event_is_restricted(
    after: float, verdict: str
) -> None:
    """Period 2 pi sqrt(J/(2 k)) = 44.4 ms; the torque of the step peaks at half of it, at 15 kN m."""
    period = 2 * math.pi * math.sqrt(2 / (2 * 20e3))
    (row,) = [
        one
        for one in rows(STEP.replace("DURATION", f"{0.1 + after * period!r} s"))
        if one.rule == "transient"
    ]
    assert (row.verdict, bool(row.restrictions)) == (verdict, verdict == "restricted")
    assert row.value == pytest.approx(15e3, rel=1e-6)


RUNNING = """
name: running
operation: {speeds: {from: 300 rpm, to: 1500 rpm}, rated: {speed: 1500 rpm, power: 50 kW}}
train:
- motor: {name: a, inertia: 2}
- coupling: {name: soft, stiffness: 20 kN*m/rad, max_torque: 20 kN*m, max_torque_range: RANGE}
- machine: {name: b, inertia: 2}
analyses: {transient: {duration: DURATION, events: [{at: a, time: 0.1 s, EVENT}]}}
"""


@pytest.mark.parametrize(("duration", "verdict"), [("0.26 s", "restricted"), ("0.5 s", "fail")])
def test_a_torque_that_ends_moves_the_train_as_its_begin(duration: str, verdict: str) -> None:
    """After 3.5 periods of 44.4 ms the end of the step adds to what its begin left."""
    text = RUNNING.replace("EVENT", "step: {torque: 600 N*m, length: 0.1555 s}")
    text = text.replace("DURATION", duration).replace("RANGE", "900 N*m")
    (row,) = [row for row in rows(text) if row.clause == "dT_max"]
    assert row.verdict == verdict


@pytest.mark.parametrize(
    ("event", "last"),
    [
        ("step: {torque: 1, length: 0.2 s}", 0.2),
        ("sine: {torque: 1, frequency: 3, until: 0.2 s}", 0.2),
        ("pulse: {torque: 1, length: 0.2 s}", 0.2),
        ("table: {rows: [[0 s, 0], [0.2 s, 1], [0.3 s, -1]]}", 0.3),
        ("stop: {ramp: 0.1 s, length: 0.2 s}", 0.3),
        ("start: {torque: [[0 rpm, 1], [1500 rpm, 0]], off: 0.2 s}", 0.2),
        (
            "short-circuit: {coefficients: {line: 5}, decay: [1 s, 1 s], clear: 0.1 s, reclose: 0.2 s}",
            0.3,
        ),
    ],
)
def test_what_an_event_states_after_the_end_of_a_motion_restricts_it(
    event: str, last: float
) -> None:
    """The last change of the torque: not reached, reached within a period of 44.4 ms before the end, and earlier."""
    words = list[str]()
    for after in (-0.01, 0.01, 0.05):
        text = RUNNING.replace("EVENT", event).replace("DURATION", f"{0.1 + last + after!r} s")
        findings = torsion.run(torsion.parse(text.replace("RANGE", "20 kN*m")))
        words.append("; ".join(findings.checks[0].restrictions))
        (motion,) = findings["transient"].each
        assert any("after the end" in name for name in motion.not_acting) == (after < 0)
    unreached, early, whole = words
    assert f" at a at {0.1 + last:.6g} s" in unreached
    assert early.startswith("ends 0.01 s after the last change")
    assert not whole


CLUTCH = """
name: clutch
operation: {speeds: {from: 300 rpm, to: 1500 rpm, steps: 41}, rated: {speed: 1500 rpm, power: 100 kW}}
train:
- motor: {name: m, inertia: 1.2, ripple: [{order: 1, torque: 1 N*m}]}
- coupling: {name: c, stiffness: 20 kN*m/rad, capacity: CAPACITY, rated_torque: 1 kN*m, vibratory_torque: 300}
- generator: {name: g, inertia: 0.8}
rules: [coupling-maker]
"""


@pytest.mark.parametrize(("capacity", "slips"), [("400 N*m", True), ("700 N*m", False)])
def test_no_rule_passes_on_a_clutch_that_the_mean_torque_slips(capacity: str, slips: bool) -> None:
    """100 kW at 1500 rpm are 636.6 N m, which the response carries through the stuck clutch."""
    text = CLUTCH.replace("CAPACITY", capacity)
    found = rows(text)
    assert [row.verdict for row in found] == ["not judged" if slips else "pass"] * 2
    for row in found:
        assert any("clutch 'c' is taken as stuck" in words for words in row.restrictions) == slips


def test_vibration_beside_the_mean_torque_slips_a_clutch_too() -> None:
    """637 N m of mean and the vibration of order 1 below its resonance exceed 650 N m together."""
    text = CLUTCH.replace("CAPACITY", "650 N*m")
    shaken = text.replace("torque: 1 N*m", "torque: 30 N*m")
    assert [{row.verdict for row in rows(words)} for words in (text, shaken)] == [
        {"pass"},
        {"not judged"},
    ]


def test_the_plan_names_a_clutch_as_stuck(tmp_path: Path) -> None:
    file = tmp_path / "clutch.yaml"
    file.write_text(CLUTCH.replace("CAPACITY", "700 N*m"))
    assert any("clutch that is stuck" in why for _, why in commands.plan(file).left_out)


def test_a_motion_that_ends_soon_after_a_clutch_ceases_to_slip_is_restricted() -> None:
    """The safety clutch of the scene sticks at 1.219 s, and mode 1 has a period of 0.219 s."""
    text = (Path(__file__).parents[2] / "shafting_specs/pto_clutch_in.yaml").read_text(
        encoding="utf-8"
    )
    (row,) = rows(text.replace("duration: 1.5 s", "duration: 1.3 s"))
    assert row.restrictions[0].startswith("ends 0.0808 s after the last change")
