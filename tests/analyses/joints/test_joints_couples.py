"""Secondary couples of the joints of a train, with the mean torque of their own shafts."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from torsion.analyses.joints.joint_analysis import JointsSettings, joints
from torsion.analyses.steady import steady
from torsion.assembly import assemble
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine import Motor, Propeller
from torsion.study import Operation
from torsion.train import train

ORACLES = json.loads(
    (Path(__file__).parents[2] / "kernels" / "joints" / "oracles.json").read_text(encoding="utf-8")
)
TRIPOD = {"kind": "tripod", "radius": 0.03, "arm": 0.6}


def one(joint, **requested):
    """The joint alone."""
    result = joints(train([joint]), Operation(), JointsSettings(**requested))
    return result.angle, result.joints[0]


def test_liu_2023_couples_at_8_degrees_and_800_newton_metres():
    """Yoke couples 30 degrees behind the plane's normal, signs of the paper's M1 taken on the driving shaft's part."""
    exact = {key: float(value) for key, value in ORACLES["liu2023_r8_alpha30_T800"].items()}
    _, joint = one(Joint(angle="8 deg"), torque=800.0)
    driving, driven = joint.couples
    assert -driving.yoke[300] == pytest.approx(exact["M1"], rel=1e-13)
    assert driven.yoke[300] == pytest.approx(exact["M2"], rel=1e-13)
    assert 800.0 * joint.torque_ratio[300] == pytest.approx(exact["T2"], rel=1e-13)
    assert (driving.largest, driven.largest) == pytest.approx(
        (exact["M1_max"], exact["M2_max"]), rel=1e-13
    )


@pytest.mark.parametrize("carrier", ["driving", "driven"])
@pytest.mark.parametrize("keys", [{}, TRIPOD])
def test_mean_and_harmonic_are_those_of_the_curve_over_the_carrier_s_angle(keys, carrier):
    """A cross joint has no other harmonic; a tripod's first is compared as a Fourier integral."""
    turned, joint = one(
        Joint(angle="30 deg", phase="25 deg", **keys), torque=70.0, carrier=carrier, steps=1440
    )
    own = turned if carrier == "driving" else turned + joint.error - joint.error[0]
    share = (np.ones_like(turned) if carrier == "driving" else joint.speed_ratio)[:-1]
    for couple in joint.couples:
        assert couple.order == joint.order
        for curve, mean, amplitude in zip(
            (couple.normal, couple.inplane), couple.mean, couple.amplitude, strict=True
        ):
            wave = np.exp(-1j * couple.order * own)
            assert mean == pytest.approx(np.mean(curve[:-1] * share), rel=1e-11, abs=1e-11)
            assert amplitude == pytest.approx(
                2.0 * np.mean(curve[:-1] * share * wave[:-1]), rel=1e-11, abs=1e-11
            )
            if not keys:
                assert curve == pytest.approx(mean + (amplitude / wave).real, abs=1e-11)


@pytest.mark.parametrize("carrier", ["driving", "driven"])
@pytest.mark.parametrize("angle", [8, 44, 50, 70])
@pytest.mark.parametrize("keys", [{}, {**TRIPOD, "radius": 0.003}])
def test_largest_couple_is_the_greatest_of_the_curve(keys, angle, carrier):
    _, joint = one(Joint(angle=f"{angle} deg", **keys), torque=70.0, carrier=carrier, steps=7200)
    for couple in joint.couples:
        assert couple.largest == pytest.approx(
            np.hypot(couple.normal, couple.inplane).max(), rel=1e-6
        )


@pytest.mark.parametrize(
    ("angle", "least", "most", "twin"),
    [
        (10, 17.3811593206, 17.6143296922, 17.4977327052),
        (20, 34.7695184780, 35.7621162435, 35.2653961417),
        (30, 52.3501360565, 54.8372731549, 53.5898384862),
        (40, 70.2214996492, 75.4098489999, 72.7940468532),
    ],
)
def test_tripod_couples_of_chang_and_li_at_200_newton_metres(angle, least, most, twin):
    """The published formulas are of first order in radius/arm 1/20: within 5e-4 of exact. The twin's is exact."""
    _, joint = one(Joint(angle=f"{angle} deg", **TRIPOD), torque=200.0)
    driving = joint.couples[0]
    size = np.hypot(driving.normal, driving.inplane)
    assert (size.min(), size.max(), driving.largest) == pytest.approx((least, most, most), rel=5e-4)
    _, still = one(Joint(angle=f"{angle} deg", **TRIPOD, bearing="twin"), torque=200.0)
    assert [couple.mean[1] for couple in still.couples] == pytest.approx([twin, twin], rel=1e-11)
    assert [couple.order for couple in still.couples] == [0, 0]


def test_single_tripod_pushes_across_its_driving_shaft_and_a_twin_does_not():
    """V1/L of Chang and Li: 29.2 N at 10 degrees, 121 N at 40."""
    for angle, force in ((10, 29.2), (40, 121.0)):
        assert one(Joint(angle=f"{angle} deg", **TRIPOD), torque=200.0)[1].force == pytest.approx(
            force, rel=0.05
        )
    assert one(Joint(angle="10 deg", **TRIPOD, bearing="twin"), torque=200.0)[1].force == 0.0


def test_bearings_share_the_largest_couple_over_their_distance():
    _, joint = one(Joint(angle="8 deg", name="a"), torque=800.0, bearings={"a": 0.25})
    assert [couple.bearing for couple in joint.couples] == [
        couple.largest / 0.25 for couple in joint.couples
    ]
    assert one(Joint(angle="8 deg"), torque=800.0)[1].couples[0].bearing is None


def test_couple_of_a_later_joint_is_read_at_its_own_yoke():
    line = [Joint(angle="15 deg"), Joint(angle="20 deg", phase="40 deg")]
    result = joints(train(line), Operation(), JointsSettings(torque=100.0))
    first, second = result.joints
    yoke = result.angle + first.error + second.yoke
    normal = -100.0 * math.tan(math.radians(20)) * np.cos(yoke) * np.sin(yoke)
    assert second.couples[1].normal == pytest.approx(normal, abs=1e-12)


def test_every_joint_carries_the_mean_torque_of_its_own_shaft():
    branch = Branch(
        train=(Joint(name="side", angle="4 deg"), Propeller(name="one", inertia=1.0, power=30e3))
    )
    line = [
        Motor(inertia=1.0),
        Joint(name="a", angle="6 deg"),
        Coupling(stiffness=1e4),
        Disc(inertia=1.0),
        branch,
        Gear(ratio=2),
        Joint(name="b", angle="5 deg"),
        Propeller(name="two", inertia=1.0, power=30e3),
    ]
    built, operation = train(line), Operation(rated={"speed": "100 rad/s", "power": "60 kW"})
    found = {joint.name: joint.torque for joint in joints(built, operation).joints}
    assert found == pytest.approx({"a": 600.0, "side": 300.0, "b": 600.0}, rel=1e-14)
    system = assemble(built, frequency=500.0)
    known = steady(built, system, operation, np.array([40.0, 100.0]))
    passed = joints(built, operation, steady=known).joints
    assert {joint.name: joint.torque for joint in passed} == pytest.approx(found, rel=1e-14)
    requested = joints(built, operation, JointsSettings(torque=7.0), known).joints
    assert [joint.torque for joint in requested] == [7.0, 7.0, 7.0]


@pytest.mark.parametrize("keys", [{}, TRIPOD, {"kind": "cv"}])
def test_what_a_joint_puts_on_its_two_shafts_adds_up_to_nothing(keys):
    """Torques and couples as vectors: n, and the two axes of the plane of the shafts as they are mounted."""
    _, joint = one(Joint(angle="30 deg", phase="10 deg", **keys), torque=70.0)
    driving, driven = joint.couples
    sine, cosine = math.sin(math.radians(30)), math.cos(math.radians(30))
    passed = 70.0 * joint.torque_ratio
    assert driving.normal + driven.normal == pytest.approx(np.zeros_like(passed), abs=1e-12)
    # d_driving = (0, 1), d_driven = (-sine, cosine) along (d_driving x n, d_driving); the joint holds back T, pushes on
    across = driving.inplane + cosine * driven.inplane - sine * passed
    along = -70.0 + sine * driven.inplane + cosine * passed
    assert across == pytest.approx(np.zeros_like(passed), abs=1e-10)
    assert along == pytest.approx(np.zeros_like(passed), abs=1e-10)
