"""Tilting of a driven shaft on bearings, from the file: inertia, Zhu and Wang's own example, and what is left out."""

import math

import numpy as np
import pytest

import torsion
from torsion.analyses.lateral.misaligned_shaft import MisalignedShaft
from torsion.analyses.lateral.shaft_bending import Lateral, ShaftFound
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

LENGTH, INERTIA, POLAR = 0.46, 4.597e-3, 3.96e-5
RADIUS = math.sqrt(
    POLAR * LENGTH**2 / 3.0 / (0.5 - POLAR / 4.0)
)  # of a rod with that polar / transverse inertia
DENSITY = INERTIA / (math.pi * RADIUS**2 * LENGTH * (LENGTH**2 / 3.0 + RADIUS**2 / 4.0))
ROD = """
name: Zhu and Wang
materials: {{stiff: {{unusual: true, shear_modulus: 80 GPa, youngs_modulus: 1e18, density: {density!r}}}}}
operation: {{speeds: {{from: {first} rad/s, to: {last} rad/s, steps: 11}}}}
train:
  - motor: {{inertia: 1}}
  - joint: {{name: cross, angle: 5 deg}}
  - shaft: {{name: rod, length: 0.46, diameter: {diameter!r}, material: stiff,
      support: {{at: 0.46, stiffness: [7.74, 23.22], damping: {damping}}}}}
  - disc: {{inertia: 1}}
analyses: {{lateral: {{torque: 0.3, modes: 1}}}}
"""
BAR = """
name: bar
operation: {{speeds: {{from: 100 rpm, to: 900 rpm, steps: 5}}, rated: {{speed: 900 rpm, power: 5 kW}}}}
train:
  - motor: {{inertia: 1}}
  - {joint}
  - shaft: {shaft}
  - disc: {{inertia: 1}}
analyses: {{lateral: }}
"""


def rod(first: float, last: float, damping: float = 1e-3) -> Findings:
    text = ROD.format(
        density=DENSITY, diameter=2.0 * RADIUS, first=first, last=last, damping=damping
    )
    return torsion.run(torsion.parse(text))


def bar(shaft: str, joint: str = "joint: {name: cross, angle: 5 deg}") -> ShaftFound:
    found = torsion.run(torsion.parse(BAR.format(shaft=shaft, joint=joint))).need(Lateral)
    assert found is not None
    return found.shafts[0]


@pytest.mark.parametrize(
    ("damping", "rates"), [(1e-3, (0.28903193, 0.01699056)), (0.0, (0.31205048, 0.04000852))]
)
def test_file_gives_the_growth_of_zhu_and_wang(damping: float, rates: tuple[float, float]) -> None:
    for speed, rate in zip((25.9, 26.2), rates, strict=True):
        tilting = rod(25.0, speed, damping).need(Lateral).shafts[0].tilting
        assert tilting.growth[-1] == pytest.approx(rate, abs=6e-9)


def test_file_gives_the_zone_of_zhu_and_wang_and_fails_the_verdict() -> None:
    found = rod(24.0, 28.0, damping=1e-3)
    tilting = found.need(Lateral).shafts[0].tilting
    (zone,) = tilting.zones
    assert zone.kind == "sum of 1 and 2"
    inside = (tilting.speed >= zone.first) & (tilting.speed <= zone.last)
    assert (tilting.growth[inside] > -1e-9).all()
    assert (tilting.growth[~inside] < 1e-9).all()
    (check,) = [one for one in found.need(Checks).lines if one.clause == "tilting"]
    assert (check.verdict, check.where) == ("fail", "rod")
    assert check.value == pytest.approx(zone.growth, rel=1e-6)
    assert found.failed


def test_file_gives_every_published_boundary_of_zhu_and_wang() -> None:
    found = rod(4.0, 36.0).need(Lateral).shafts[0].tilting.zones
    assert [zone.kind for zone in found] == [
        "difference of 2 and 1",
        "principal of 1",
        "sum of 1 and 2",
        "principal of 2",
    ]
    expected = [
        (6.6247381078, 7.1833181926),
        (18.4726571828, 19.3380958794),
        (25.2412094394, 26.3253892466),
        (32.4240786602, 32.9273342758),
    ]
    np.testing.assert_allclose(
        [(zone.first, zone.last) for zone in found], expected, rtol=0.0, atol=1e-9
    )


def test_inertia_about_the_joint_is_that_of_a_hollow_bar_with_a_mass() -> None:
    tilting = bar(
        "{length: 0.5 m, diameter: 60 mm, bore: 40 mm, "
        "support: {at: 0.4 m, stiffness: 1 kN/m, damping: [20, 60], mass: 3 kg}}"
    ).tilting
    mass = 7850.0 * np.pi / 4.0 * (0.06**2 - 0.04**2) * 0.5
    across = mass * (0.5**2 / 3.0 + (0.06**2 + 0.04**2) / 16.0) + 3.0 * 0.4**2
    assert tilting.shaft.inertia == pytest.approx(across, rel=1e-14)
    assert tilting.shaft.polar * across == pytest.approx(
        mass * (0.06**2 + 0.04**2) / 8.0, rel=1e-14
    )
    assert tilting.frequency["y"] == pytest.approx(
        0.4 * math.sqrt(1e3 / across) / (2.0 * np.pi), rel=1e-14
    )
    decay = [c * 0.4**2 / across / 2.0 for c in (20.0, 60.0)]  # half of c a2 / J, of y and of z
    assert tilting.decay_rate == pytest.approx(decay, rel=1e-14)
    assert tilting.frequency["z"] == tilting.frequency["y"]


def test_inertia_of_a_cone_is_its_integral() -> None:
    tilting = bar(
        "{length: 0.5 m, diameter: [80 mm, 40 mm], support: {at: 0.5 m, stiffness: 1 kN/m}}"
    ).tilting
    polynomial = np.polynomial.Polynomial
    across, place = polynomial([0.08, -0.08]), polynomial([0.0, 1.0])
    area, second = np.pi / 4.0 * across**2, np.pi / 64.0 * across**4
    whole = (area * place**2 + second).integ()
    assert tilting.shaft.inertia == pytest.approx(7850.0 * whole(0.5), rel=1e-13)


def test_supports_of_both_planes_keep_their_axes() -> None:
    tilting = bar(
        "{length: 0.5 m, diameter: 60 mm, support: {at: 0.4 m, stiffness: [1 kN/m, 4 kN/m], damping: [1, 2]}}"
    ).tilting
    assert tilting.frequency["z"] == pytest.approx(2.0 * tilting.frequency["y"], rel=1e-14)
    assert tilting.shaft.frequency[1] == pytest.approx(
        2.0 * np.pi * tilting.frequency["z"], rel=1e-4
    )
    assert tilting.shaft.decay[::-1] == pytest.approx(
        0.16 * np.array([1.0, 2.0]) / tilting.shaft.inertia, rel=1e-6
    )


def test_torque_follows_the_load_at_every_speed() -> None:
    shaft = bar(
        "{length: 0.5 m, diameter: 60 mm, support: {at: 0.4 m, stiffness: 1 kN/m}}"
    ).tilting.shaft
    speeds = np.array([3.0, 30.0 * np.pi])
    rated = 5000.0 / (30.0 * np.pi)
    np.testing.assert_allclose(
        shaft.pull_at(speeds) * shaft.inertia, rated * (speeds / speeds[1]) ** 2, rtol=1e-13
    )


def test_isotropic_undamped_shaft_grows_by_the_mean_couple_alone() -> None:
    """Equal frequencies w: the circulatory couple T/2 lets every motion grow by T/(4 J w)."""
    found = rod_of_one_frequency()
    tilting = found.need(Lateral).shafts[0].tilting
    assert [zone.kind for zone in tilting.zones] == ["mean couple"]
    w = float(np.sqrt(tilting.shaft.square[0]))
    assert tilting.growth[-1] == pytest.approx(0.3 / (4.0 * tilting.shaft.inertia * w), rel=1e-2)
    (check,) = [one for one in found.need(Checks).lines if one.clause == "tilting"]
    assert check.note == "its supports do not damp it in both directions"


def rod_of_one_frequency() -> Findings:
    text = ROD.format(density=DENSITY, diameter=2.0 * RADIUS, first=300.0, last=400.0, damping=0.0)
    return torsion.run(torsion.parse(text.replace("[7.74, 23.22]", "20000")))


@pytest.mark.parametrize(
    ("shaft", "joint", "words"),
    [
        (
            "{length: 2 m, diameter: 20 mm, support: {at: 2 m, stiffness: 1 MN/m}}",
            None,
            "bends too easily",
        ),
        (
            "{length: 0.5 m, diameter: 60 mm, support: {at: 0.4 m, stiffness: 1 kN/m}}",
            "joint: {kind: tripod, angle: 5 deg, radius: 30 mm, arm: 0.6 m, bearing: single}",
            "for cross joints",
        ),
    ],
)
def test_what_is_left_out_is_said(shaft: str, joint: str | None, words: str) -> None:
    found = bar(shaft, joint) if joint else bar(shaft)
    assert found.tilting is None
    assert words in found.remark


def test_shaft_between_two_joints_has_no_tilt_to_speak_of() -> None:
    line = "{length: 0.5 m, diameter: 60 mm, support: {at: 0.2 m, stiffness: 1 kN/m}}\n  - joint: {angle: 5 deg}"
    found = bar(line)
    assert (found.tilting, found.remark) == (None, "")


def test_conversion_keeps_a_rigid_shaft_rigid() -> None:
    shaft = rod(24.0, 28.0).need(Lateral).shafts[0].tilting.shaft
    assert isinstance(shaft, MisalignedShaft)
    assert shaft.inertia == pytest.approx(INERTIA, rel=1e-13)
    assert shaft.polar == pytest.approx(POLAR, rel=1e-12)


def test_whirl_that_its_own_material_drives_fails_the_verdict() -> None:
    """Above its critical speed of 8.7 thousand rpm a tube with a loss factor and no damper whirls by itself."""
    text = """
name: tube
operation: {{speeds: {{from: {first} rpm, to: 12000 rpm, steps: 21}}}}
train:
  - motor: {{inertia: 1}}
  - joint: {{angle: 1 deg}}
  - shaft: {{name: tube, length: 1.5 m, diameter: 120 mm, bore: 108 mm, loss_factor: 0.01}}
  - joint: {{angle: 1 deg}}
  - disc: {{inertia: 1}}
analyses: {{lateral: {{modes: 1, speeds: {{from: 1000 rpm, to: {last} rpm, steps: 21}}}}}}
"""
    verdict, failed = {}, {}
    for last in (8000, 12000):
        found = torsion.run(torsion.parse(text.format(first=1000, last=last)))
        (check,) = [one for one in found.need(Checks).lines if one.clause == "whirl"]
        verdict[last], failed[last] = (check.verdict, check.note), found.failed
        assert check.at_least
    assert failed == {8000: True, 12000: True}
    assert verdict[12000] == ("fail", "")
    assert verdict[8000] == ("fail", "only a part of the operation's speeds was looked at")
