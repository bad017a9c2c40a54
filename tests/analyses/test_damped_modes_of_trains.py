"""Damped modes of whole trains at an operating point."""

import math

import numpy as np
import pytest

from torsion.analyses.damped_modes import damped
from torsion.analyses.steady import steady_if_known
from torsion.errors import SolveError
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.machine import Motor, Propeller
from torsion.train import Link


@pytest.mark.parametrize("zeta", [1e-6, 0.1, 0.7])
def test_one_degree_of_freedom_has_its_damping_ratio(build, zeta):
    _, system = build(
        [Disc(held=True), Coupling(stiffness=400.0, viscous=2 * zeta * 40.0), Disc(inertia=4.0)]
    )
    found = damped(system, speed=0.0)
    assert found.damping_ratio == pytest.approx([zeta], rel=1e-13)
    assert found.frequency == pytest.approx(
        [10.0 * math.sqrt(1 - zeta**2) / (2 * math.pi)], rel=1e-13
    )


def test_eigenpairs_satisfy_the_equations_of_motion_in_own_angles(build):
    line = [
        RingDamper(housing=1.0, ring=0.4, damping=9.0),
        Coupling(stiffness=900.0, loss_factor=0.05),
        Gear(ratio=2),
        Disc(inertia=3.0, damping=2.0),
        Coupling(stiffness=5e3, viscous=4.0),
        Disc(inertia=2.0),
    ]
    _, system = build(line)
    found = damped(system, speed=1.0, count=None)
    assert len(found.frequency) == 2
    assert (np.diff(found.frequency) > 0).all()
    ground = system.ground_damping(np.array([1.0]), np.zeros((len(system.stations), 1)))[:, 0]
    for k, root in enumerate(found.eigenvalue):
        left = (root**2 * system.inertia + root * ground) * found.shape[:, k]
        for s, span in enumerate(system.spans):
            left[span.driving] += found.torque[s, k]
            left[span.driven] -= found.torque[s, k] / float(span.ratio)
            if system.flexibility[s] > 0:
                twist = found.shape[span.driving, k] - found.shape[span.driven, k] / float(
                    span.ratio
                )
                static = 1 / system.flexibility[s] * (1 + 1j * system.loss_factor[s])
                assert found.torque[s, k] == pytest.approx(
                    twist * (static + root * system.viscous[s]), rel=1e-10
                )
        assert np.abs(left).max() < 1e-11 * np.abs(found.torque[:, k]).max()


def test_overdamped_motion_is_no_frequency(build):
    _, system = build(
        [Disc(held=True), Coupling(stiffness=400.0, viscous=160.0), Disc(inertia=4.0)]
    )
    found = damped(system, speed=0.0)
    assert found.frequency.size == 0
    assert np.sort(found.overdamped) == pytest.approx(
        [-20 - math.sqrt(300), -20 + math.sqrt(300)], rel=1e-13
    )


def test_archer_damping_is_that_of_the_mean_torque_at_the_speed(build, operation):
    propeller = Propeller(inertia=1.0, damping={"model": "archer", "factor": 30})
    study, system = build(
        [Motor(held=True), Coupling(stiffness=1e5), propeller],
        operation=operation(50.0, 100.0, 2, rated=(100.0, 50e3)),
    )
    found = damped(system, speed=50.0, steady=steady_if_known(study, system, np.array([50.0])))
    damping = 30.0 * 125.0 / (50.0 * 30.0 / math.pi)
    assert found.damping_ratio[0] == pytest.approx(damping / (2 * math.sqrt(1e5)), rel=1e-12)
    assert found.speed == 50.0


def test_closed_loops_are_refused_with_advice(build):
    line = [
        Disc(name="a", inertia=1.0, damping=1.0),
        Coupling(stiffness=1.0),
        Disc(name="b", inertia=1.0),
    ]
    _, system = build(line, links=[Link(("a", "b"), Coupling(stiffness=1.0))])
    with pytest.raises(SolveError, match="closed loops"):
        damped(system, speed=1.0)
