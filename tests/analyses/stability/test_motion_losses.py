"""Loss factors in the stability of trains with joints: dampers in their place, and the free turning beside them."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsion.analyses.stability.floquet_exponents import Search, damped, growth_search, variation
from torsion.analyses.stability.mechanism_loads import scene
from torsion.analyses.stability.periodic_orbits import orbit, response_of
from torsion.analyses.stability.periodic_speeds import growths
from torsion.analyses.stability.stability_over_speed import stability, stability_map
from torsion.analyses.stability.straight_modes import basis
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.kernels.periodic.harmonic_balance import motion_of, points_in_time
from torsion.kernels.periodic.monodromy import monodromy, steps_for
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.joint import Joint
from torsion.model.machine import Motor
from torsion.model.machine_torques import Excitation
from torsion.study import Operation, Study
from torsion.train import train

CONSTANT = Operation(load=[["1 rad/s", 300.0], ["1000 rad/s", 300.0]])


def made(line: list, operation: Operation | None = None) -> tuple[Study, System]:
    built = train(line)
    return Study("lossy", built, operation=operation or CONSTANT), assemble(built)


def seven_parts(loss: float = 0.05, *, damping: float = 5.0) -> tuple[Study, System]:
    """Two joints of 25 deg whose effects add up, the last coupling with a loss factor."""
    return made(
        [
            Motor(inertia=2.0),
            Coupling(stiffness=2e4, viscous=0.4),
            Joint(angle="25 deg", inertia=(0.02, 0.02)),
            Coupling(stiffness=1.5e4, viscous=0.3),
            Disc(inertia=0.05),
            Joint(angle="25 deg", phase="90 deg", inertia=(0.0, 0.03)),
            Coupling(stiffness=3e4, loss_factor=loss),
            Disc(inertia=0.8, damping=damping),
        ]
    )


def ringed(damping: float = 12.0) -> tuple[Study, System]:
    """The same with a ring that hangs by damping alone."""
    return made(
        [
            Motor(inertia=2.0),
            Coupling(stiffness=2e4, loss_factor=0.05),
            Joint(angle="25 deg", inertia=(0.02, 0.02)),
            Coupling(stiffness=1.5e4),
            RingDamper(housing=0.3, ring=0.3, damping=damping),
            Coupling(stiffness=3e4, loss_factor=0.05),
            Disc(inertia=0.8, damping=2.0),
        ]
    )


def massless() -> tuple[Study, System]:
    """The first with joints that have no inertia."""
    return made(
        [
            Motor(inertia=2.0),
            Coupling(stiffness=2e4, viscous=0.4),
            Joint(angle="25 deg"),
            Coupling(stiffness=1.5e4, viscous=0.3),
            Disc(inertia=0.05),
            Joint(angle="25 deg", phase="90 deg"),
            Coupling(stiffness=3e4, loss_factor=0.05),
            Disc(inertia=0.8, damping=5.0),
        ]
    )


def long_train(number: int) -> tuple[Study, System]:
    """A train in so many pieces, all with the same loss factor, damped to ground at its end."""
    line: list = [Motor(inertia=2.0)]
    for k in range(number):
        if k in (3, 7):
            line.append(Joint(angle="20 deg", inertia=(0.05, 0.05)))
        line += [Coupling(stiffness=4e3 * number, loss_factor=0.02), Disc(inertia=0.8 / number)]
    return made([*line, Coupling(stiffness=5e4, loss_factor=0.02), Disc(inertia=0.8, damping=0.6)])


def growth_there(study: Study, system: System, speed: float) -> float:
    """That of the exact response at one speed."""
    at = scene(study, system)
    return float(growths(at, response_of(at, [orbit(at, speed)], np.array([speed]), ("",)))[0])


def raw_monodromy(ask: Search, speed: float) -> np.ndarray:
    around = variation(ask.mechanism, ask(speed)[0])
    steps = steps_for(around.period, ask.shapes.highest)
    return monodromy(around.mass, around.damping, around.stiffness, around.period, steps)


@pytest.mark.parametrize("speed", [70.0, 100.0])
def test_free_turning_of_a_train_with_loss_factors_neither_grows_nor_dies_out(speed):
    value = np.linalg.eigvals(raw_monodromy(growth_search(*seven_parts()), speed))
    assert np.abs(value - 1.0).min() < 1e-9


@pytest.mark.parametrize("loss", [0.005, 0.05, 0.3])
def test_both_methods_agree_on_a_free_train_with_loss_factors(loss):
    line = seven_parts(loss)
    first, second = growth_search(*line), growth_search(*line, method="hill")
    for speed in (70.0, 100.0):
        assert second.growth(speed) == pytest.approx(first.growth(speed), abs=1e-8)


def test_free_train_that_its_loss_factor_damps_is_stable():
    found = stability(*seven_parts(), np.linspace(90.0, 120.0, 4))
    assert found.ranges == ()
    assert found.growth.max() < -1e-4
    assert found.check < 1e-8


@pytest.mark.parametrize("line", [seven_parts, massless])
def test_growth_of_the_exact_response_leaves_the_free_turning_out(line):
    found = growth_there(*line(), 100.0)
    assert found < -1.0
    assert found == pytest.approx(growth_search(*line()).growth(100.0), rel=1e-5)


@pytest.mark.parametrize("phase", [0, 90, 180, 270])
def test_vibratory_torque_of_the_joints_order_does_not_hold_the_free_turning_to_a_phase(phase):
    def growth(torque: float) -> float:
        line = [
            Motor(inertia=2.0),
            Coupling(stiffness=2e4, viscous=0.4),
            Joint(angle="25 deg", inertia=(0.02, 0.02)),
            Coupling(stiffness=1.5e4, viscous=0.3),
            Disc(name="load", inertia=0.8, damping=5.0),
        ]
        built = train(
            line, excitations=[Excitation(at="load", order=2, torque=torque, phase=f"{phase} deg")]
        )
        study, system = Study("shaken", built, operation=CONSTANT), assemble(built)
        return growth_there(study, system, 70.0)

    alone = growth(0.0)
    assert alone < -1.0
    assert growth(1.0) == pytest.approx(alone, rel=1e-2)
    assert growth(50.0) < -1.0


@pytest.mark.parametrize("method", ["monodromy", "hill"])
def test_train_on_few_modes_turns_as_freely_as_the_whole(method):
    whole = growth_search(*long_train(12)).growth(90.0)
    assert growth_search(*long_train(12), modes=4, method=method).growth(90.0) == pytest.approx(
        whole, rel=1e-4
    )


def test_slow_motion_of_a_free_train_goes_by_what_the_drive_must_give_at_other_speeds():
    """Its speed u follows J u' = -(c + dD/dW) u, with the torque D of the motion with the loss factors themselves."""
    line, speed, step = long_train(10), 60.0, 0.05
    at = scene(*line)
    faster, slower = (orbit(at, speed + by).balance.load[0] for by in (step, -step))
    inertia = 2.0 + 0.8 + 0.8 + 0.2
    expected = -(0.6 + (faster - slower) / (2.0 * step)) / inertia
    assert growth_search(*line).drift(speed) == pytest.approx(expected, rel=1e-2)


def test_growth_with_dampers_for_loss_factors_is_that_of_the_motion_in_time(in_time):
    ask = growth_search(*seven_parts(0.3), method="monodromy")
    here, _ = ask(104.0)
    whole, loading, free = (
        raw_monodromy(ask, 104.0),
        here.operation.loading,
        ask.mechanism.layout.free,
    )
    motion = motion_of(here.balance.harmonic, loading.w0, points_in_time(here.balance.count))
    start = np.concatenate([motion.deviation[:, 0], motion.speed[:, 0]])
    away = (
        1e-5
        * np.random.default_rng(3).standard_normal(2 * free)
        * np.repeat([1.0, loading.w0], free)
    )

    def after_a_period(state: np.ndarray) -> np.ndarray:
        slope = in_time(ask.mechanism.layout, loading, here.balance.load)
        return solve_ivp(
            slope, (0.0, 2.0 * np.pi / loading.w0), state, method="DOP853", rtol=1e-11, atol=1e-13
        ).y[:, -1]

    assert after_a_period(start) == pytest.approx(start, abs=1e-9 * np.abs(motion.speed).max())
    grown = (after_a_period(start + away) - after_a_period(start - away)) / 2.0
    assert grown == pytest.approx(whole @ away, rel=1e-5, abs=1e-6 * np.abs(away).max())


def test_dampers_lose_in_a_straight_train_what_the_loss_factors_lose_between_any_two_modes():
    random = np.random.default_rng(5)
    line: list = [Motor(inertia=1.0)]
    for _ in range(4):
        stiffness, loss = random.uniform(1e4, 5e4), random.uniform(0.01, 0.1)
        line += [
            Coupling(stiffness=stiffness, loss_factor=loss),
            Disc(inertia=float(random.uniform(0.1, 1.0))),
        ]
    study, system = made(line)
    at = scene(study, system)
    shapes = basis(at.layout)
    dampers = damped(at, shapes).layout.dampers
    twist = (shapes.shape[at.layout.driving] - shapes.shape[at.layout.driven])[:, 1:]
    w = shapes.frequency[1:]
    lost = twist.T @ (at.layout.hysteretic[:, None] * twist) / np.sqrt(np.outer(w, w))
    onto = dampers.onto.T @ twist
    assert onto.T @ (dampers.size[:, None] * onto) == pytest.approx(
        lost, rel=1e-9, abs=1e-10 * lost.max()
    )


def test_train_that_turns_rigidly_through_its_joints_loses_nothing_by_loss_factors():
    stiff = 1e9
    line = [
        Motor(inertia=1.0),
        Coupling(stiffness=stiff, loss_factor=0.2),
        Joint(angle="20 deg", inertia=(0.1, 0.1)),
        Coupling(stiffness=stiff, loss_factor=0.2),
        Disc(inertia=1.0),
    ]
    ask = growth_search(*made(line, Operation()))
    assert abs(ask(50.0)[0].balance.load[0]) < 1e-6 * 50.0**2


@pytest.mark.parametrize("method", ["monodromy", "hill"])
def test_ring_that_hangs_by_damping_alone_has_no_angle_of_its_own(method):
    ask = growth_search(*ringed(), method=method)
    _, found = ask(100.0)
    assert len(found.exponent) + np.isfinite(found.drift) == 2 * ask.mechanism.layout.free - 2
    assert max(found.growth, found.drift) < -1e-3
    assert found.growth == pytest.approx(growth_search(*ringed()).growth(100.0), rel=1e-6)


@pytest.mark.parametrize("line", [seven_parts, ringed, massless])
def test_map_over_damping_with_loss_factors_is_that_of_the_whole_trains(line):
    speeds, factors = np.array([96.0, 104.0]), np.array([0.5, 1.0])
    found = stability_map(*line(), speeds, "damping", factors)
    assert found.error < 1e-3
    expected = [growth_search(*line()).growth(float(speed)) for speed in speeds]
    assert found.growth[:, 1] == pytest.approx(expected, abs=1e-3)
