"""Data of gears and propellers, and the forces on teeth, against the file and the rated power."""

import math

import pytest
from docs.site.results_manual import documented
from tests.for_all import for_all

import torsion
from torsion.analyses.tooth_forces import ToothForces
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.output.blocks import Table
from torsion.output.chapters.modes.mass_elastic import chapter
from torsion.output.numbers import number
from torsion.output.stored.results_json import results

TEXT = """
name: all that has a data sheet
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}, rated: {speed: 900 rpm, power: 60 kW}}
train:
- motor: {name: m, inertia: 1.25, power: 60 kW, ripple: [{order: 2, torque: 3}, {order: 4, torque: 1}], source: maker}
- coupling:
    {name: soft, stiffness: 20 kN*m/rad, psi: 0.8, tolerance: 15 %, rated_torque: 1 kN*m, vibratory_torque: 300,
     max_torque: 3 kN*m, heat_limit: 400 W, source: catalogue}
- gear:
    {name: g, teeth: [21, 63], mesh_stiffness: 5 MN*m/rad, application_factor: 1.4,
     branches: [{teeth: 42, inertia: 0.2}]}
- coupling: {name: stiff, flexibility: 0}
- propeller:
    {name: screw, inertia: 4, entrained: 25 %, blades: 4, diameter: 1.2 m, pitch_ratio: 0.9, area_ratio: 0.6,
     damping: {model: frahm, factor: 3}}
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def sheets(findings: Findings) -> dict[str, Table]:
    return {
        block.caption.split(":")[0]: block
        for block in chapter(findings)
        if isinstance(block, Table)
    }


def test_gears_and_propellers_stand_as_the_file_has_them(found: Findings) -> None:
    made = sheets(found)
    assert made["Gears"].rows == (
        ("g", "21", "63", "3", "1.4"),
        ("g wheel 2", "21", "42", "2", "1.4"),
    )
    assert made["Propellers, pumps and fans"].rows == (
        ("screw", "4", "1.2", "0.9", "0.6", "4", "1", "5"),
    )


HELICAL = "name: g, teeth: [21, 63], module: 8 mm, helix_angle: 12 deg, pressure_angle: 22.5 deg"


def test_forces_on_teeth_are_those_of_one_force_normal_to_the_flank() -> None:
    """F_n on a flank inclined by alpha_n and beta: F_n (cos a cos b, sin a, cos a sin b), its moment the torque."""
    found = torsion.run(torsion.parse(TEXT.replace("name: g, teeth: [21, 63]", HELICAL)))
    mean, a, b = 60e3 / (900 * math.pi / 30), math.radians(22.5), math.radians(12.0)
    diameter = 8e-3 * 21 / math.cos(b)
    normal = mean / (diameter / 2) / (math.cos(a) * math.cos(b))
    main, wheel = found.need(ToothForces).meshes
    assert (main.tangential, main.radial, main.axial) == pytest.approx(
        (
            normal * math.cos(a) * math.cos(b),
            normal * math.sin(a),
            normal * math.cos(a) * math.sin(b),
        ),
        rel=1e-14,
    )
    assert main.driven_diameter == pytest.approx(8e-3 * 63 / math.cos(b), rel=1e-15)
    assert (wheel.diameter, wheel.driven_diameter) == pytest.approx(
        (diameter, 2 * diameter), rel=1e-15
    )
    assert (wheel.tangential, wheel.torque) == (0.0, 0.0)
    (row, _) = sheets(found)["Tooth forces at the rated torque, without K_{A}"].rows
    assert row == (
        "g",
        "8",
        "12",
        "22.5",
        number(1e3 * diameter),
        number(3e3 * diameter),
        *(number(1e-3 * force) for force in (main.tangential, main.radial, main.axial)),
    )
    stated = results(found)["tooth_forces"][0]
    assert {f"tooth_forces[].{key}" for key in stated} == {
        key.path for key in documented() if key.path.startswith("tooth_forces")
    }
    assert stated["radial_N"] == main.radial


@pytest.mark.parametrize(
    ("keys", "diameter"),
    [
        ("ratio: 3, pitch_diameter: [100 mm, 300 mm]", 0.1),
        ("teeth: [20, 60], module: 5 mm", 0.1),
        ("teeth: [20, 60], module: 5 mm, pitch_diameter: [100.05 mm, 300 mm]", 0.10005),
    ],
)
def test_spur_teeth_push_at_the_pitch_diameter(keys: str, diameter: float) -> None:
    text = TEXT.replace("name: g, teeth: [21, 63]", f"name: g, {keys}").replace(
        "teeth: 42", "ratio: 2"
    )
    force = torsion.run(torsion.parse(text)).need(ToothForces).meshes[0]
    mean = 60e3 / (900 * math.pi / 30)
    assert force.tangential == pytest.approx(2 * mean / diameter, rel=1e-14)
    assert (force.radial, force.axial) == (
        pytest.approx(force.tangential * math.tan(math.pi / 9), rel=1e-14),
        0.0,
    )


def test_forces_on_teeth_are_left_out_without_a_rated_torque() -> None:
    text = "name: x\ntrain: [motor: {inertia: 1}, gear: {teeth: [20, 50], module: 4 mm}, disc: {inertia: 2}]\n"
    found = torsion.run(torsion.parse(text))
    assert found.get(ToothForces) is None
    assert (
        "tooth forces",
        "the mean torque at the rated point is not known",
    ) in found.plan.left_out


@for_all(
    ("keys", "expected"),
    [
        ("ratio: 3, module: 5 mm", "`module` needs `teeth`"),
        ("teeth: [20, 60], helix_angle: 12 deg", "`helix_angle` says nothing alone"),
        (
            "teeth: [20, 60], pitch_diameter: [100 mm, 310 mm]",
            "the pitch diameters are as 1 to 3.1, the speeds as 3",
        ),
        ("ratio: 3, pitch_diameter: [300 mm, 100 mm]", "the pitch diameters are as 1 to 0.333333"),
        (
            "teeth: [20, 60], module: 5 mm, helix_angle: 12 deg, pitch_diameter: [100 mm, 300 mm]",
            r"m_n z/cos\(beta\) is 102.234 mm for 20 teeth, the pitch diameter 100 mm",
        ),
        ("teeth: [20, 60], module: 5", "5 m is outside the usual range .* mm"),
        ("teeth: [20, 60], module: 5 mm, helix_angle: 90 deg", "out of range"),
    ],
)
def test_sizes_of_teeth_that_do_not_fit_are_refused(keys: str, expected: str) -> None:
    text = f"name: x\ntrain: [motor: {{inertia: 1}}, gear: {{{keys}}}, disc: {{inertia: 2}}]\n"
    with pytest.raises(InputError, match=expected):
        torsion.parse(text)
