"""The bending side of trains: which shafts bend, what holds them, and the couples of their joints."""

import math

import numpy as np
import pytest
from pydantic import ValidationError
from tests.for_all import for_all

from torsion.analyses.joints.joint_lines import placed
from torsion.analyses.lateral.bending_shafts import bending_shafts
from torsion.analyses.lateral.couple_response import couples_at
from torsion.analyses.lateral.shaft_bending import LateralSettings, lateral
from torsion.errors import InputError
from torsion.kernels.joints.cross import couple_harmonics
from torsion.kernels.trees.tree_response import Status
from torsion.model.component import Material
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.shafts.shaft import Shaft
from torsion.model.shafts.shaft_details import Support, both_ends
from torsion.schema.scene_reader import parse
from torsion.study import Operation, Rated, SpeedRange
from torsion.train import train

SPEEDS = Operation(speeds=SpeedRange(**{"from": "600 rpm", "to": "6000 rpm", "steps": 31}))
JOINT = Joint(angle="6 deg")


def _tube(**keys: object) -> Shaft:
    return Shaft(name="tube", length=1.5, diameter=0.12, bore=0.108, **keys)


def _cardan(first: Joint, second: Joint):
    return train([Disc(inertia=1.0), first, _tube(), second, Disc(inertia=2.0)])


def test_a_tube_between_two_joints_has_the_critical_speeds_of_rayleigh() -> None:
    found = lateral(
        _cardan(Joint(angle="5 deg"), Joint(angle="5 deg")), SPEEDS, LateralSettings(torque=500.0)
    )
    (shaft,) = found.shafts
    square, k = (0.12**2 + 0.108**2) / 16, math.pi / 1.5
    euler = k**2 * math.sqrt(206e9 * square / 7850)
    order_one = [crossing for crossing in shaft.critical if crossing.order == 1]
    assert order_one[0].speed == pytest.approx(euler / math.sqrt(1 + 3 * square * k**2), rel=1e-10)
    assert order_one[1].speed == pytest.approx(euler / math.sqrt(1 - square * k**2), rel=1e-10)
    assert len(order_one) == 8
    assert [answer.order for answer in shaft.answers] == [0, 2]
    second = shaft.answers[1]
    assert (second.status == Status.SINGULAR).sum() == 2  # forward and backward, without damping
    assert shaft.at_rest.y == pytest.approx(shaft.at_rest.z)


def test_shear_lowers_the_critical_speeds() -> None:
    built = _cardan(Joint(angle="5 deg"), Joint(angle="5 deg"))
    plain, soft = (
        lateral(built, SPEEDS, LateralSettings(modes=2, shear=shear)).shafts[0]
        for shear in (False, True)
    )
    drop = 1 - soft.critical[0].speed / plain.critical[0].speed
    # first order of Timoshenko: E/(kappa G) times that of rotary inertia, half of r2 k2
    assert drop == pytest.approx(
        0.5 * (0.12**2 + 0.108**2) / 16 * (math.pi / 1.5) ** 2 * 206 / 79.3 / 0.534, rel=0.1
    )


def _ends(built, torque: float = 100.0, shaft: int = 0) -> dict[int, np.ndarray]:
    every, shafts = placed(built), bending_shafts(built)[0]
    return {
        order: c[0]
        for order, c in couples_at(every, shafts[shaft], np.full((len(every), 1), torque)).items()
    }


@pytest.mark.parametrize("angle", [5, 30])
def test_couples_of_a_joint_are_its_mean_and_twice_a_turn(angle: int) -> None:
    phase = 0.3
    joint = Joint(angle=f"{angle} deg", phase="0.3 rad")
    built = train(
        [
            Disc(inertia=1.0),
            joint,
            Shaft(length=1.0, diameter=0.05, support={"at": 0.8, "stiffness": 1e7}),
        ]
    )
    found, exact = _ends(built), couple_harmonics(math.radians(angle), 100.0)[1]
    turn = np.exp(2j * phase)
    np.testing.assert_allclose(found[0][0], [0.0, exact.mean], atol=1e-12)
    np.testing.assert_allclose(found[2][0], [exact.normal * turn, exact.inplane * turn], atol=1e-12)
    np.testing.assert_array_equal(found[2][1], 0.0)  # none at the support


def test_couples_of_parallel_shafts_cancel_on_the_tube_as_a_whole() -> None:
    found = _ends(
        _cardan(Joint(angle="20 deg"), Joint(angle="20 deg", plane="180 deg", phase="180 deg"))
    )
    for order in (0, 2):
        np.testing.assert_allclose(found[order].sum(axis=0), 0.0, atol=1e-11)
        assert np.abs(found[order][0]).max() > 1.0


def test_couples_of_a_double_cardan_that_bends_one_way_add_up() -> None:
    found = _ends(_cardan(Joint(angle="20 deg"), Joint(angle="20 deg")))
    slope, tilt = 100.0 * math.tan(math.radians(20)), 100.0 * math.sin(math.radians(20))
    np.testing.assert_allclose(found[0].sum(axis=0), [0.0, tilt], atol=1e-11)
    np.testing.assert_allclose(found[2].sum(axis=0), [1j * slope, tilt], atol=1e-11)


def test_the_constant_torque_may_be_that_of_the_last_shaft() -> None:
    built = train(
        [
            Shaft(length=1.0, diameter=0.05, support={"at": 0.8, "stiffness": 1e7}),
            Joint(angle="30 deg"),
        ]
    )
    (shaft,) = bending_shafts(built)[0]
    found = couples_at(placed(built), shaft, np.full((1, 1), 100.0), "driven")
    c, x = math.cos(math.radians(30)), 2 * np.pi * np.arange(512) / 512
    curve = (
        100.0 * math.tan(math.radians(30)) * np.sin(x) ** 2 * c / (1 - (1 - c * c) * np.cos(x) ** 2)
    )
    assert found[0][0, 0, 1] == pytest.approx(curve.mean(), rel=1e-12)
    assert found[2][0, 0, 1] == pytest.approx(2 * np.mean(curve * np.exp(-2j * x)), rel=1e-12)


def test_joints_behind_that_cancel_leave_the_couple_of_the_first_as_it_is() -> None:
    """The last shaft of the line, whose torque is constant, then turns as the shaft behind the first joint."""
    held = Shaft(length=1.0, diameter=0.05, support={"at": 0.8, "stiffness": 1e7})
    opposite = Joint(angle="25 deg", plane="180 deg", phase="180 deg")
    first, second = (Shaft(length=0.5, diameter=0.05) for _ in range(2))
    pair = [first, Joint(angle="25 deg"), second, opposite, Disc(inertia=1.0)]
    alone, line = (train([held, Joint(angle="30 deg"), *behind]) for behind in ([], pair))
    one, other = (
        couples_at(placed(built), bending_shafts(built)[0][0], np.full((count, 1), 90.0), "driven")
        for built, count in ((alone, 1), (line, 3))
    )
    for order in (0, 2):
        np.testing.assert_allclose(other[order], one[order], rtol=0, atol=1e-12 * 90.0)
    assert np.abs(one[2]).max() > 10.0


def test_a_support_counts_from_the_end_that_faces_the_joint() -> None:
    held = Shaft(
        length=1.0,
        diameter=0.05,
        support={"at": 0.3, "stiffness": [2e7, 1e7], "damping": 50.0, "mass": 4.0},
    )
    for line, place in (([held, JOINT, Disc(inertia=1)], 0.7), ([JOINT, held], 0.3)):
        (shaft,) = bending_shafts(train([Disc(inertia=1.0), Coupling(stiffness=1e4), *line]))[0]
        point = shaft.beam.points[1]
        assert point.at == pytest.approx(place)
        assert (point.stiffness, point.damping, point.mass) == ((2e7, 1e7), (50.0, 50.0), 4.0)
        assert shaft.lacks == ""


def test_shafts_in_a_row_bend_as_one_and_elastic_couplings_part_them() -> None:
    built = train(
        [
            Shaft(length=0.5, diameter=0.05),
            Disc(name="flange", inertia=0.1),
            Shaft(length=0.7, diameter=0.06),
            JOINT,
            Shaft(length=0.4, diameter=0.05),
            Coupling(stiffness=1e4),
            Shaft(length=0.3, diameter=0.05),
        ]
    )
    shafts, faults = bending_shafts(built)
    assert [len(shaft.parts) for shaft in shafts] == [2, 1, 1]
    assert shafts[0].loads == ("flange",)
    assert shafts[0].beam.points[0].at == pytest.approx(1.2)
    assert all("not supported" in shaft.lacks for shaft in shafts)
    assert not faults


BENT = """
name: x
train:
  - disc: {inertia: 1}
  - joint: {angle: 8 deg}
  - shaft: {length: 1 m, diameter: 60 mm, material: z, KEYS}
materials: {z: {density: 7850, shear_modulus: 80 GPa, youngs_modulus: 206 GPa}}
analyses: {lateral: }
"""


@for_all(
    ("keys", "at", "words"),
    [
        ("support: {at: 0.8, stiffness: [1e6, 0]}", "[1e6, 0]", "not supported in the plane z"),
        ("support: {at: 0.8, stiffness: [0, 1e6]}", "[0, 1e6]", "not supported in the plane y"),
        (
            "support: {at: 0, stiffness: 1e6}",
            "0, stiff",
            "one place only, because its support lies on the joint itself",
        ),
        ("support: {at: 0.8, stiffness: 1e-9}", "1e-9", "too soft to compute"),
        ("support: {at: 0.8, stiffness: [1e6, 1e-9]}", "[1e6, 1e-9]", "too soft to compute"),
        (
            "note: a",
            "lateral",
            "shaft-1: it is not supported: it needs a joint at either end, a joint and a `support`",
        ),
    ],
)
def test_why_a_shaft_cannot_bend_is_told_at_the_key_that_would_mend_it(
    keys: str, at: str, words: str
) -> None:
    text = BENT.replace("KEYS", keys)
    with pytest.raises(InputError) as caught:
        parse(text)
    (fault,) = caught.value.faults
    assert words in fault.message
    assert text.splitlines()[fault.line - 1][fault.column - 1 :].startswith(at)


def test_a_shaft_that_is_held_but_weighs_nothing_is_told_at_its_material() -> None:
    text = BENT.replace("KEYS", "support: {at: 0.8, stiffness: 1e6}").replace(
        "density: 7850", "density: 0"
    )
    with pytest.raises(InputError) as caught:
        parse(text)
    (fault,) = caught.value.faults
    assert "it has no mass" in fault.message
    assert (fault.line, fault.path[-1]) == (6, "material")


@pytest.mark.parametrize("share", [1e-2, 1e-4, 1e-6])
def test_a_soft_support_lets_the_shaft_swing_as_a_rigid_pendulum(share: float) -> None:
    """w2 = k a2/(m L2/3 + m d2/16), less a share of k/(E I/L3); what is softer yet is refused."""
    bending = 206e9 * math.pi * 0.06**4 / 64
    stiffness = share * bending / 0.8**2  # so that it holds the tilt with this share
    tail = Shaft(length=1.0, diameter=0.06, support={"at": 0.8, "stiffness": stiffness})
    (shaft,) = lateral(
        train([Disc(inertia=1.0), JOINT, tail]), SPEEDS, LateralSettings(modes=1)
    ).shafts
    mass = 7850 * math.pi / 4 * 0.06**2
    rigid = math.sqrt(stiffness * 0.64 / (mass * (1 / 3 + 0.06**2 / 16))) / (2 * math.pi)
    assert shaft.at_rest.y[0] == pytest.approx(rigid, rel=1e-3 * share + 1e-6)


def test_a_shaft_between_joints_needs_no_support_however_soft() -> None:
    built = train([JOINT, _tube(support={"at": 0.7, "stiffness": 1e-9}), JOINT, Disc(inertia=1.0)])
    (shaft,) = bending_shafts(built)[0]
    assert shaft.lacks == ""


def test_a_shaft_behind_a_gear_turns_at_its_own_speed() -> None:
    tail = [JOINT, Shaft(length=1.0, diameter=0.05), Joint(angle="6 deg"), Disc(inertia=1.0)]
    built = train([Disc(inertia=1.0), Gear(ratio=2, inertia=(0.1, 0.1)), *tail])
    (shaft,) = lateral(built, SPEEDS, LateralSettings(torque=100.0, modes=1)).shafts
    assert float(shaft.ratio) == 0.5
    assert shaft.answers[0].speed[-1] == pytest.approx(SPEEDS.speeds.last, rel=1e-15)
    assert shaft.whirl.speed[-1] == pytest.approx(SPEEDS.speeds.last, rel=1e-15)
    for one in shaft.critical:
        assert one.order * one.speed / 2 == pytest.approx(2 * math.pi * one.frequency, rel=1e-15)


def test_the_answer_grows_with_the_mean_torque() -> None:
    built = _cardan(JOINT, JOINT)
    rated = Operation(
        speeds=SPEEDS.speeds, rated=Rated(speed="6000 rpm", power="100 kW"), load="constant"
    )
    torque = 100e3 / (200 * math.pi)
    one, other = (
        lateral(built, *given).shafts[0].answers
        for given in ((rated,), (SPEEDS, LateralSettings(torque=torque)))
    )
    np.testing.assert_allclose(one[1].displacement, other[1].displacement, rtol=1e-9)


def test_what_is_left_out_is_told() -> None:
    built = _cardan(JOINT, JOINT)
    assert "no torque is known" in lateral(built, SPEEDS).remarks[-1]
    found = lateral(built, Operation())
    assert "no speeds are given" in found.remarks[-1]
    assert found.shafts[0].whirl is None
    assert found.shafts[0].critical


def test_a_train_without_a_held_shaft_is_refused() -> None:
    with pytest.raises(
        InputError, match="no shaft of the train can bend: shaft-1: it is not supported"
    ):
        lateral(
            train([Disc(inertia=1.0), Shaft(length=1.0, diameter=0.05), Disc(inertia=1.0)]), SPEEDS
        )


def test_a_support_beside_its_shaft_and_a_material_without_a_modulus_are_faults() -> None:
    rubber = Material(shear_modulus=79e9, density=7850.0)
    held = Shaft(length=1.0, diameter=0.05, support={"at": 1.1, "stiffness": 1e7})
    built = train(
        [JOINT, held, Joint(angle="1 deg"), _tube(material="rubber"), JOINT],
        materials={"rubber": rubber},
    )
    with pytest.raises(InputError) as caught:
        lateral(built, SPEEDS)
    assert [fault.path for fault in caught.value.faults] == [
        ("train", 1, "shaft", "support", "at"),
        ("train", 3, "shaft", "material"),
    ]


@pytest.mark.parametrize("shear_modulus", [150e9, 60e9])  # Poisson's ratio -0.31 and 0.72
def test_shear_needs_moduli_that_belong_together(shear_modulus: float) -> None:
    odd = Material(shear_modulus=shear_modulus, youngs_modulus=206e9, density=7850.0)
    built = train([JOINT, _tube(material="odd"), Joint(angle="1 deg")], materials={"odd": odd})
    with pytest.raises(InputError, match="Poisson"):
        lateral(built, SPEEDS, LateralSettings(shear=True))


@for_all(
    ("keys", "words"),
    [
        ({"at": 0.1, "stiffness": [1e6, 2e6, 3e6]}, "one value or"),
        ({"at": 0.1, "stiffness": 0.0}, "holds nothing"),
        ({"at": -0.1, "stiffness": 1e6}, "out of range"),
        ({"at": 0.1, "stiffness": "5 kN*m/rad"}, "lateral stiffness"),
        ({"at": 0.1}, "required"),
        ({"at": 0.1, "stiffness": 1e6, "springs": 2}, "Extra"),
    ],
)
def test_a_faulty_support_is_refused(keys: dict, words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        Support(**keys)


def test_a_support_reads_the_units_of_the_trade() -> None:
    support = Support(
        at="120 mm", stiffness=["50 MN/m", "40 kN/mm"], damping="2 kN*s/m", mass="3 kg"
    )
    assert both_ends(support.stiffness) == (50e6, 40e6)
    assert both_ends(support.damping) == (2e3, 2e3)
    assert (support.at, support.mass) == (0.12, 3.0)
