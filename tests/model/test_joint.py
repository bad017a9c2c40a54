"""The joint component: yokes along a line, orders, and what stands on a first joint."""

import math

import numpy as np
import pytest

from torsion.analyses.joints.joint_lines import placed, turning
from torsion.errors import InputError
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.train import train

TRIPOD = {"kind": "tripod", "radius": "30 mm", "arm": "600 mm"}


def joints_of(*components):
    return [mesh for mesh in train(components).constraints if mesh.name.startswith("joint")]


@pytest.mark.parametrize(
    ("keys", "order"),
    [
        ({}, 2),
        (TRIPOD, 3),
        ({**TRIPOD, "bearing": "twin"}, 0),
        ({**TRIPOD, "bearing": "single"}, 3),
        ({"kind": "cv"}, 0),
    ],
)
def test_cross_excites_at_order_2_tripod_at_3_and_constant_velocity_at_none(keys, order):
    joint = Joint(angle="10 deg", **keys)
    (mesh,) = joints_of(joint)
    assert joint.order == order
    assert [line for line, _ in mesh.error] == ([order] if order else [])


@pytest.mark.parametrize("keys", [{}, TRIPOD])
@pytest.mark.parametrize("phase", ["0 deg", "25 deg", "-70 deg"])
def test_amplitude_is_that_of_the_exact_motion_from_the_plane(keys, phase):
    """The Fourier coefficient of the exact error, complex: exact of a cross, to (radius/arm)^2 of a tripod."""
    built = train([Joint(angle="12 deg", phase=phase, **keys)])
    (mesh,), joint = built.constraints, built.parts[0].joint
    turned = 2.0 * np.pi * np.arange(720) / 720
    error = turning(joint, turned + joint.phase).error
    coefficient = 2.0 * np.mean(error * np.exp(-1j * joint.order * turned))
    assert mesh.error[0][1] == pytest.approx(coefficient, rel=1e-13 if joint.order == 2 else 1e-3)


def test_first_arm_of_a_tripod_counts_from_the_plane_as_a_yoke_does():
    """Arm 0 on the normal of the plane: error E cos 3x; in the plane, a quarter turn before: E sin 3(x + phase)."""
    size = 0.03 / 1.2 * math.tan(math.radians(5)) ** 2 * math.tan(math.radians(10))
    (plain,) = joints_of(Joint(angle="10 deg", **TRIPOD))
    (normal,) = joints_of(Joint(angle="10 deg", phase="-90 deg", **TRIPOD))
    assert plain.error[0][1] == pytest.approx(-1j * size, rel=1e-12)
    assert normal.error[0][1] == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize(("keys", "added"), [({}, 90.0), (TRIPOD, 0.0), ({"kind": "cv"}, 0.0)])
def test_next_yoke_stands_90_degrees_on_behind_a_cross_alone(keys, added):
    first = Joint(angle="10 deg", phase="20 deg", **keys)
    second = Joint(angle="5 deg", phase="30 deg", plane="7 deg")
    _, behind = placed(train([first, Coupling(flexibility=0), second]))
    assert math.degrees(behind.record.yoke) == pytest.approx(20.0 + added + 30.0 - 7.0, rel=1e-14)


def test_a_joint_knows_the_one_before_it_through_points_and_branches_but_not_through_a_gear():
    on_branch = Joint(angle="1 deg", phase="4 deg")
    components = [
        Joint(angle="1 deg", phase="3 deg"),
        Disc(inertia=1.0),
        Branch(train=(on_branch, Disc(inertia=1.0, name="d"))),
        Joint(angle="1 deg"),
        Gear(ratio=2),
        Joint(angle="1 deg", phase="5 deg"),
        Joint(angle="1 deg"),
    ]
    found = joints_of(*components)
    parts = [mesh.part for mesh in found]
    assert [mesh.after for mesh in found] == [None, parts[0], parts[0], None, parts[3]]


@pytest.mark.parametrize("key", ["phase", "plane"])
def test_first_joint_of_a_branch_has_neither_phase_nor_plane(key):
    branch = Branch(train=(Joint(angle="1 deg", **{key: "4 deg"}), Disc(inertia=1.0, name="d")))
    with pytest.raises(InputError) as caught:
        train([Disc(inertia=1.0), branch])
    (fault,) = caught.value.faults
    assert fault.path == ("train", 1, "branch", "train", 0, "joint", key)
    assert f"`{key}`" in fault.message


def test_first_joint_of_the_wheel_of_a_gear_has_no_phase():
    gear = Gear(ratio=2, branches=({"ratio": 3, "train": (Joint(angle="1 deg", phase="4 deg"),)},))
    with pytest.raises(InputError, match="first joint of a branch"):
        train([Joint(angle="1 deg"), gear])


def test_joint_with_a_phase_of_nothing_is_the_joint_without_one():
    plain, given = (
        joints_of(Joint(angle="9 deg"), Joint(angle="9 deg", **more))
        for more in ({}, {"phase": "0 deg"})
    )
    assert [mesh.error for mesh in plain] == [mesh.error for mesh in given]
