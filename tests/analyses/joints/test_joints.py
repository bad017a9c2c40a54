"""Universal joints in a train: order 2 from the imposed twist and from the mean torque, to first order."""

import math
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.response.harmonic_components import excitations, sources
from torsion.analyses.response.over_speed import response
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.kernels.joints.cross import error_amplitude
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine import Motor, Propeller
from torsion.model.machine_torques import Excitation
from torsion.study import Operation
from torsion.train import Link


def _rows(found, speeds):
    return [int(np.flatnonzero(found.speed == speed)[0]) for speed in speeds]


def test_inertia_behind_a_joint_of_10_degrees_driven_at_constant_speed(build):
    """J 2.5, k 1e5, damping 5 to ground; resonance at 2 * 100 rad/s."""
    line = [
        Disc(held=True),
        Joint(angle="10 deg"),
        Coupling(stiffness=1e5),
        Disc(inertia=2.5, damping=5.0),
    ]
    study, system = build(line)
    speeds = np.array([50.0, 95.0, 100.0, 150.0])
    found = response(study, system, speeds=speeds)
    end = found.angle[_rows(found, speeds), 0, -1]
    assert np.abs(end) == pytest.approx(
        [0.0102054615, 0.0781352725, 0.7654266246, 0.0061229722], rel=1e-8
    )
    w = 2.0 * speeds
    exact = error_amplitude(math.radians(10), 0.0) * 1e5 / (1e5 - 2.5 * w**2 + 5j * w)
    assert end == pytest.approx(exact, rel=1e-12)
    assert [line.order for line in found.lines] == [Fraction(2)]


def test_order_2_of_a_prescribed_joint_shaft_and_inertia_is_exact(build):
    """15 degrees, K 5000, C 2, J 0.5, d 1.5 at 40 rad/s: the joint's torque acts on what does not move."""
    line = [
        Disc(held=True),
        Joint(angle="15 deg"),
        Coupling(name="shaft", stiffness=5000.0, viscous=2.0),
        Disc(inertia=0.5, damping=1.5),
    ]
    study, system = build(line)
    found = response(study, system, speeds=np.array([40.0]))
    assert abs(found.angle[0, 0, -1]) == pytest.approx(0.0475977131170726, rel=1e-13)
    shaft = [span.name for span in system.spans].index("shaft")
    assert abs(found.torque[0, 0, shaft]) == pytest.approx(152.419739205061, rel=1e-13)


def _line(*joints: Joint) -> list:
    """The first joint, a rigid shaft, the second joint."""
    between = Coupling(flexibility=0)
    return [
        Disc(inertia=2.0),
        Coupling(stiffness=2e4),
        joints[0],
        between,
        joints[1],
        Coupling(stiffness=3e4),
        Disc(inertia=0.8, damping=2.0),
    ]


def test_two_equal_joints_with_yokes_in_line_cancel(build, operation):
    pair = build(
        _line(Joint(angle="8 deg"), Joint(angle="8 deg")), operation=operation(20.0, 90.0, 5)
    )
    single = build(
        _line(Joint(angle="8 deg"), Joint(angle="0 deg")), operation=operation(20.0, 90.0, 5)
    )
    cancelled, alone = response(*pair), response(*single)
    assert np.abs(cancelled.torque).max() <= 1e-14 * np.abs(alone.torque).max()


def test_two_equal_joints_at_90_degrees_of_phase_double(build):
    speeds = np.array([20.0, 45.0, 90.0])
    pair = build(_line(Joint(angle="8 deg"), Joint(angle="8 deg", phase="90 deg")))
    single = build(_line(Joint(angle="8 deg"), Joint(angle="0 deg")))
    doubled, alone = response(*pair, speeds=speeds), response(*single, speeds=speeds)
    twice = doubled.torque[_rows(doubled, speeds)]
    assert twice == pytest.approx(2.0 * alone.torque[_rows(alone, speeds)], rel=1e-12)


def test_two_joints_add_as_phasors_of_their_yokes(build):
    """A phase of p turns the second joint's order 2 by 2 p against the first."""
    speeds = np.array([30.0])
    phase = math.radians(25)
    both = response(
        *build(_line(Joint(angle="8 deg"), Joint(angle="8 deg", phase="25 deg"))), speeds=speeds
    )
    single = response(*build(_line(Joint(angle="8 deg"), Joint(angle="0 deg"))), speeds=speeds)
    at, alone = _rows(both, speeds)[0], _rows(single, speeds)[0]
    exact = single.torque[alone, 0, 0] * (1.0 - np.exp(2j * phase))
    assert both.torque[at, 0, 0] == pytest.approx(exact, rel=1e-12)


def test_joint_behind_a_gear_excites_at_twice_its_own_speed(build, operation):
    line = [
        Disc(inertia=2.0),
        Gear(teeth=(20, 50)),
        Joint(angle="8 deg"),
        Coupling(stiffness=1e4),
        Disc(inertia=1.0),
    ]
    study, system = build(line, operation=operation(20.0, 90.0, 5))
    assert [line.order for line in response(study, system).lines] == [Fraction(4, 5)]


def test_joint_in_a_closed_loop_twists_its_span(build, dense):
    line = [
        Disc(name="a", inertia=1.0, damping=3.0),
        Coupling(stiffness=500.0),
        Disc(name="b", inertia=2.0),
    ]
    line += [
        Coupling(stiffness=50.0),
        Joint(name="bent", angle="8 deg"),
        Coupling(stiffness=70.0),
        Disc(name="c", inertia=1.5),
    ]
    _, system = build(line, links=[Link(("a", "c"), Coupling(stiffness=90.0))])
    one = excitations(system)[0]
    speed = np.array([4.0, 11.0])
    found = answer(
        system, 2.0 * speed, sources(system, one, speed, None), ground_damping(system, speed, None)
    )
    ground = ground_damping(system, speed, None)
    bent = one.errors[0]
    for k in range(2):
        angle, torque = dense(
            system,
            2.0 * speed[k],
            np.zeros(len(system.stations)),
            ground[:, k],
            {bent.span: bent.amplitude},
        )
        assert found.angle[k] == pytest.approx(angle, rel=1e-11)
        assert found.torque[k] == pytest.approx(torque, rel=1e-11)


@pytest.mark.parametrize("ahead", [0, 1])
def test_mean_torque_alternates_at_the_driving_side_of_a_joint(build, dense, operation, ahead):
    """T_driving = T_driven (1 + e'): dense solution with the torque jump, the error at the twisted yoke's angle."""
    joint = Joint(angle="12 deg", phase="20 deg")
    line = [Motor(inertia=2.0), Coupling(stiffness=2e4, viscous=2.0)]
    line += [Gear(ratio=2), joint] if ahead else [joint, Gear(ratio=2)]
    line += [Coupling(stiffness=5e4), Propeller(inertia=0.8, damping=3.0)]
    study, system = build(line, operation=operation(20.0, 90.0, 5, rated=(60.0, 30e3)))
    speed = np.array([60.0])
    known = steady_if_known(study, system, speed)
    one = excitations(system)[0]
    ground = ground_damping(system, speed, known)
    order = float(one.line.order)
    found = answer(system, order * speed, sources(system, one, speed, known), ground)
    bent = one.errors[0]
    driving = system.spans[bent.span].driving
    mean = 500.0 * (2.0 if ahead else 1.0)
    twist = -500.0 / 2e4 / (2.0 if ahead else 1.0)
    error = error_amplitude(math.radians(12), math.radians(20)) * np.exp(2j * twist)
    force = np.zeros(len(system.stations), dtype=complex)
    force[driving] = -mean * 2j * error
    angle, torque = dense(system, order * 60.0, force, ground[:, 0], {bent.span: error})
    assert order == (1.0 if ahead else 2.0)
    assert found.angle[0] == pytest.approx(angle, rel=1e-11)
    assert found.torque[0] == pytest.approx(torque, rel=1e-10)


def test_joint_turns_the_other_way_round_the_same(build, dense):
    """The far end held: the joint's driven side is then the inner one of the tree."""
    line = [
        Disc(inertia=1.0, damping=1.0),
        Coupling(stiffness=700.0),
        Joint(angle="10 deg"),
        Coupling(stiffness=900.0),
        Disc(held=True),
    ]
    _, system = build(line)
    one, speed = excitations(system)[0], np.array([7.0])
    ground = ground_damping(system, speed, None)
    found = answer(system, 2.0 * speed, sources(system, one, speed, None), ground)
    assert system.condensed.sign[one.errors[0].span] == -1.0
    angle, torque = dense(
        system,
        14.0,
        np.zeros(len(system.stations)),
        ground[:, 0],
        {one.errors[0].span: one.errors[0].amplitude},
    )
    assert found.angle[0] == pytest.approx(angle, rel=1e-12, abs=1e-18)
    assert found.torque[0] == pytest.approx(torque, rel=1e-12)


def test_joint_and_ripple_of_one_order_meet_in_one_line(build, operation):
    line = [Motor(inertia=1.0), Joint(angle="5 deg"), Coupling(stiffness=1e3), Disc(inertia=1.0)]
    study, system = build(
        line,
        excitations=[Excitation(at="motor-1", order=2, torque=1.0)],
        operation=operation(5.0, 9.0),
    )
    found = response(study, system)
    assert found.lines[0].sources == ("motor-1", "joint-1")
    assert (found.joint_error > 0).all()


def test_error_estimate_of_the_model_grows_with_the_square_of_q(build):
    """Off resonance the yokes swing by some q, so 2 q + 2 swing is proportional to q."""
    estimates = []
    for angle in ("3 deg", "6 deg"):
        line = [
            Disc(held=True),
            Joint(angle=angle),
            Coupling(stiffness=1e5),
            Disc(inertia=2.5, damping=5.0),
        ]
        estimates.append(response(*build(line), speeds=np.array([50.0])).joint_error[0, 0])
    ratio = (math.tan(math.radians(3)) / math.tan(math.radians(1.5))) ** 4
    assert estimates[1] / estimates[0] == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize(
    ("phase", "speed", "damping", "true_errors"),
    [
        ("0 deg", 0.37, 8.0, (1.9e-6, 2.3e-4, 3.9e-3, 2.0e-2)),
        ("0 deg", 0.93, 8.0, (6.8e-6, 8.5e-4, 1.4e-2, 7.4e-2)),
        ("0 deg", 1.00, 8.0, (1.2e-6, 1.5e-4, 3.3e-3, 3.7e-2)),
        ("0 deg", 1.00, 1.5, (1.4e-6, 4.3e-4, 5.0e-2, 2.6e-1)),
        ("90 deg", 0.37, 8.0, (1.2e-6, 1.5e-4, 2.5e-3, 1.3e-2)),
        ("90 deg", 0.93, 8.0, (5.0e-5, 6.2e-3, 9.6e-2, 4.3e-1)),
        ("90 deg", 1.00, 8.0, (7.6e-5, 9.3e-3, 1.3e-1, 4.9e-1)),
        ("90 deg", 1.00, 1.5, (1.5e-3, 1.6e-1, 1.7, 2.9)),
    ],
)
def test_error_estimate_covers_the_error_against_harmonic_balance(
    build, phase, speed, damping, true_errors
):
    """Order-2 shaft torque of a double-Cardan train at 3, 10, 20, 30 degrees against the full non-linear solution."""
    turns = speed * 107.103746 / 2.0
    for angle, true_error in zip((3, 10, 20, 30), true_errors, strict=True):
        yokes = {"angle": f"{angle} deg", "inertia": (0.02, 0.02)}
        line = [
            Motor(inertia=2.0, damping=0.5),
            Coupling(stiffness=2e4, viscous=0.4),
            Joint(**yokes),
            Coupling(stiffness=1.5e4, viscous=0.3),
            Joint(phase=phase, **yokes),
            Coupling(stiffness=3e4, viscous=0.6),
            Propeller(inertia=0.8, damping=damping),
        ]
        rated = {"speed": f"{turns} rad/s", "power": 300.0 * turns}
        study, system = build(line, operation=Operation(rated=rated, load="constant"))
        estimate = response(study, system, speeds=np.array([turns])).joint_error[0, 0]
        assert true_error < estimate < 40.0 * true_error


def _tripod_amplitude(angle: float, radius: float, arm: float, phase: float) -> complex:
    """E sin 3(x + phase) with E of Chang and Li, eq. 1, the first arm in the plane of the shafts at angle zero."""
    bend = math.radians(angle)
    size = radius / (2.0 * arm) * math.tan(bend / 2.0) ** 2 * math.tan(bend)
    return -1j * size * np.exp(3j * math.radians(phase))


def test_order_3_of_a_prescribed_tripod_shaft_and_inertia_is_exact(build):
    """K 5000, C 2, J 0.5, d 1.5 behind a tripod of 20 degrees: E (K + i w C)/(K - w^2 J + i w (C + d)), w = 3 speed."""
    line = [
        Disc(held=True),
        Joint(kind="tripod", angle="20 deg", phase="17 deg", radius=0.03, arm=0.6),
        Coupling(name="shaft", stiffness=5000.0, viscous=2.0),
        Disc(inertia=0.5, damping=1.5),
    ]
    study, system = build(line)
    speeds = np.array([20.0, 33.3, 40.0])
    found = response(study, system, speeds=speeds)
    rows, w = _rows(found, speeds), 3.0 * speeds
    error = _tripod_amplitude(20.0, 0.03, 0.6, 17.0)
    angle = error * (5000.0 + 2j * w) / (5000.0 - 0.5 * w**2 + 3.5j * w)
    assert [line.order for line in found.lines] == [Fraction(3)]
    assert found.angle[rows, 0, -1] == pytest.approx(angle, rel=1e-12)
    shaft = [span.name for span in system.spans].index("shaft")
    assert found.torque[rows, 0, shaft] == pytest.approx(
        (5000.0 + 2j * w) * (error - angle), rel=1e-12
    )


@pytest.mark.parametrize("ahead", [0, 1])
def test_mean_torque_alternates_three_times_a_turn_at_a_tripod(build, dense, operation, ahead):
    """T_driving = T_driven (1 + e'), e' = 3i e: dense solution with the torque jump of order 3."""
    joint = Joint(kind="tripod", angle="25 deg", phase="20 deg", radius=0.03, arm=0.6)
    line = [Motor(inertia=2.0), Coupling(stiffness=2e4, viscous=2.0)]
    line += [Gear(ratio=2), joint] if ahead else [joint, Gear(ratio=2)]
    line += [Coupling(stiffness=5e4), Propeller(inertia=0.8, damping=3.0)]
    study, system = build(line, operation=operation(20.0, 90.0, 5, rated=(60.0, 30e3)))
    speed = np.array([60.0])
    known = steady_if_known(study, system, speed)
    (one,) = excitations(system)
    (bent,) = one.errors
    ground = ground_damping(system, speed, known)
    found = answer(
        system, float(one.line.order) * speed, sources(system, one, speed, known), ground
    )
    ratio = 2.0 if ahead else 1.0
    error = _tripod_amplitude(25.0, 0.03, 0.6, 20.0) * np.exp(3j * -500.0 / 2e4 / ratio)
    force = np.zeros(len(system.stations), dtype=complex)
    force[system.spans[bent.span].driving] = -500.0 * ratio * 3j * error
    angle, torque = dense(system, 180.0 / ratio, force, ground[:, 0], {bent.span: error})
    assert one.line.order == Fraction(3) / int(ratio)
    assert found.angle[0] == pytest.approx(angle, rel=1e-11)
    assert found.torque[0] == pytest.approx(torque, rel=1e-10)


def test_tripod_and_cross_are_two_lines_and_a_twin_none(build, operation):
    line = [
        Disc(inertia=2.0),
        Joint(kind="tripod", angle="9 deg", radius=0.03, arm=0.6),
        Coupling(stiffness=1e4),
        Joint(angle="4 deg"),
        Joint(kind="tripod", bearing="twin", angle="9 deg", radius=0.03, arm=0.6),
        Coupling(stiffness=1e4),
        Disc(inertia=1.0, damping=1.0),
    ]
    study, system = build(line, operation=operation(20.0, 90.0, 5))
    assert [(line.order, line.sources) for line in response(study, system).lines] == [
        (Fraction(2), ("joint-2",)),
        (Fraction(3), ("joint-1",)),
    ]
