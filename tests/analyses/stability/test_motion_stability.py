"""Stability of trains with joints: boundaries known to many digits, both methods against each other, names of zones."""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from torsion.analyses.stability.equations_of_motion import equations, mean_angle, state
from torsion.analyses.stability.floquet_exponents import (
    Variation,
    by_hill,
    by_monodromy,
    growth_search,
    variation,
)
from torsion.analyses.stability.mechanism_loads import operating, scene
from torsion.analyses.stability.periodic_orbits import orbit
from torsion.analyses.stability.stability_over_speed import stability
from torsion.analyses.stability.straight_modes import Basis, basis
from torsion.analyses.stability.unstable_ranges import zone
from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.kernels.periodic.harmonic_balance import Motion, motion_of, points_in_time
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine import Motor
from torsion.study import Operation, Study
from torsion.train import train

CONSTANT = Operation(load=[["1 rad/s", 300.0], ["1000 rad/s", 300.0]])


def made(line: list, operation: Operation | None = None) -> tuple[Study, System]:
    built = train(line)
    return Study("test", built, operation=operation or Operation()), assemble(built)


def six_stations(angle: float, phase: float, damping: float) -> tuple[Study, System]:
    """Motor, two joints of one angle (deg) with yokes, propeller; 300 N m."""
    line = [
        Motor(inertia=2.0, damping=0.5),
        Coupling(stiffness=2e4, viscous=0.4),
        Joint(angle=f"{angle} deg", inertia=(0.02, 0.02)),
        Coupling(stiffness=1.5e4, viscous=0.3),
        Joint(angle=f"{angle} deg", phase=f"{phase} deg", inertia=(0.02, 0.02)),
        Coupling(stiffness=3e4, viscous=0.6),
        Disc(inertia=0.8, damping=damping),
    ]
    return made(line, CONSTANT)


def one_degree(angle: float) -> tuple[Study, System]:
    """Constant speed, a spring, a joint and an inertia behind it; natural frequency 1 rad/s."""
    return made(
        [Disc(held=True), Coupling(stiffness=1.0), Joint(angle=f"{angle} deg"), Disc(inertia=1.0)]
    )


def two_degrees(angle: float = 25.0) -> tuple[Study, System]:
    return made(
        [
            Disc(held=True),
            Coupling(stiffness=1e4),
            Joint(angle=f"{angle} deg"),
            Disc(inertia=0.1),
            Coupling(stiffness=2e4),
            Disc(inertia=1.0),
        ]
    )


def about_constant_speed(study: Study, system: System, speed: float) -> tuple[Variation, Basis]:
    """The equations linearised about a motion at constant speed.

    The published figures are of the train whose joints have no torque to bear on that motion: F'' R is left out.
    """
    at = scene(study, system)
    shapes = basis(at.layout)
    now = operating(at, speed)
    still = np.zeros((at.layout.free, 193))
    _, derivatives = equations(at.layout, now.loading, Motion(still, still, still), now.load, 1)
    mass, damping, stiffness = derivatives().entries.full(np.eye(at.layout.free))
    bent = state(
        at.layout, now.loading, Motion(still, still, still), now.load, mean_angle(now.loading, 193)
    )
    for body, own in enumerate(at.layout.coordinate):
        if own < at.layout.free:
            stiffness[:, own, own] -= bent.turning.second[body] * bent.residual[body]
    none = np.zeros((0, 2 * at.layout.free, 193))
    return Variation(mass, damping, stiffness, 2.0 * np.pi / now.loading.w0, none), shapes


def growth_about_constant_speed(train_of: tuple[Study, System], speed: float) -> float:
    around, shapes = about_constant_speed(*train_of, speed)
    return by_monodromy(around, float(shapes.frequency[-1])).growth


@pytest.mark.parametrize(
    ("angle", "lower", "upper"),
    [
        (10, 0.992506888281466933, 1.00781536484546653),
        (20, 0.971571683204113385, 1.03375047720876649),
        (30, 0.942475378319719905, 1.08603209482879454),
    ],
)
def test_one_degree_about_constant_speed_has_the_published_boundaries(angle, lower, upper):
    made_train = one_degree(angle)

    def half_trace(speed: float) -> float:
        around, shapes = about_constant_speed(*made_train, speed)
        value = by_monodromy(around, 4.0 * float(shapes.frequency[-1])).multiplier
        return float(value.sum().real) / 2.0

    for boundary in (lower, upper):
        near = 1e-3
        found = brentq(lambda w: half_trace(w) + 1.0, boundary - near, boundary + near, xtol=1e-15)
        assert found == pytest.approx(boundary, rel=1e-12)


@pytest.mark.parametrize("method", ["monodromy", "hill"])
@pytest.mark.parametrize(
    ("angle", "lower", "upper"),
    [(10, 0.992271422048, 1.007582071670), (20, 0.967624109955, 1.029949152988)],
)
def test_one_degree_about_its_orbit_has_the_published_boundaries(angle, lower, upper, method):
    found = stability(*one_degree(angle), np.linspace(0.9, 1.1, 5), method=method)
    (only,) = found.ranges
    assert (only.first, only.last) == (
        pytest.approx(lower, rel=1e-10),
        pytest.approx(upper, rel=1e-10),
    )
    assert only.name == "principal of mode 1 (2 w1)"
    assert only.is_open == (False, False)
    assert found.check < 1e-9


PRINCIPAL = (77.334541267, 82.769397402)
SUM = (315.880251578, 325.424472699)


def test_two_degrees_about_constant_speed_have_the_published_zones():
    for lower, upper in (PRINCIPAL, SUM):
        middle = (lower + upper) / 2.0
        assert growth_about_constant_speed(two_degrees(), middle) > 1.0
        for boundary, side in ((lower, -1.0), (upper, 1.0)):
            step = 1e-7 * boundary * side
            assert growth_about_constant_speed(two_degrees(), boundary - step) > 1e-4
            assert abs(growth_about_constant_speed(two_degrees(), boundary + step)) < 1e-7


def test_two_degrees_about_their_orbit_have_a_principal_and_a_sum_zone_and_no_difference_zone():
    found = [
        stability(*two_degrees(), np.linspace(*speeds))
        for speeds in ((74.0, 86.0, 4), (230.0, 330.0, 6))
    ]
    kinds = [(one.kind, one.modes, one.rank) for part in found for one in part.ranges]
    assert ("principal", (1,), 1) in kinds
    assert ("sum", (1, 2), 1) in kinds
    assert not any(kind == "difference" for kind, _, _ in kinds)
    assert not found[0].loses


@pytest.mark.parametrize("damping", [0.0, 1e-3])
def test_zone_of_a_tripod_lies_between_the_speeds_and_is_as_wide_as_its_error_makes_it(damping):
    line = [
        Disc(held=True),
        Coupling(stiffness=1.0, viscous=damping or None),
        Joint(kind="tripod", angle="30 deg", radius="60 mm", arm="200 mm"),
        Disc(inertia=1.0),
    ]
    study, system = made(line)
    (error,) = (abs(amplitude) for span in system.spans for _, amplitude in span.error)
    strength, zeta = (
        1.5 * error,
        damping / 2.0,
    )  # its ratio varies by 3 times the error, that of a cross joint by 2 q
    found = stability(study, system, np.array([0.5, 0.75]))
    (only,) = found.ranges
    assert only.name == "principal of mode 1 (2 w1)"
    assert (only.last - only.first) / (4.0 / 3.0) == pytest.approx(
        math.sqrt(strength**2 - zeta**2), rel=1e-3
    )
    assert only.growth == pytest.approx(strength - zeta, rel=1e-3)


def test_zone_of_a_joint_is_found_between_the_speeds_beside_a_joint_at_another_speed():
    line = [
        Disc(held=True),
        Coupling(stiffness=1e4),
        Joint(angle="10 deg"),
        Disc(inertia=0.1),
        Gear(teeth=(20, 30)),
        Coupling(stiffness=2e4),
        Joint(angle="1 deg"),
        Disc(inertia=1.0),
    ]
    ask = growth_search(*made(line))
    assert ask.mechanism.layout.orders == (Fraction(4, 3), Fraction(2))
    first = float(
        ask.shapes.frequency[0]
    )  # met by half of order 2, three times that of the common period
    found = stability(*made(line), np.array([0.97, 1.03]) * first)
    assert [(one.kind, one.modes, one.rank) for one in found.ranges] == [("principal", (1,), 3)]


@pytest.mark.parametrize(
    ("angle", "phase", "damping", "growth", "unit"),
    [
        (10, 0, 1.5, None, 0),
        (20, 0, 1.5, 0.67, 0.005),
        (30, 0, 1.5, 2.57, 0.005),
        (20, 0, 8.0, None, 0),
        (30, 90, 8.0, 0.45, 0.005),
    ],
)
def test_six_station_train_at_twice_its_first_mode_grows_as_published(
    angle, phase, damping, growth, unit
):
    study, system = six_stations(angle, phase, damping)
    ask = growth_search(study, system)
    found = ask.growth(107.14)
    if growth is None:
        assert found < -0.1
    else:
        assert found == pytest.approx(growth, abs=unit)


def test_growth_rate_is_that_of_the_motion_in_time(in_time):
    study, system = two_degrees()
    at = scene(study, system)
    shapes = basis(at.layout)
    there = orbit(at, 79.0)
    found = by_monodromy(variation(at, there), float(shapes.frequency[-1]))
    motion = motion_of(
        there.balance.harmonic, there.operation.loading.w0, points_in_time(there.balance.count)
    )
    start = np.concatenate([motion.deviation[:, 0], motion.speed[:, 0]])
    away = 1e-5 * np.concatenate([found.vector[:, 0], found.speed[:, 0]]).real
    slope = in_time(at.layout, there.operation.loading, there.balance.load)

    def after_a_period(state: np.ndarray) -> np.ndarray:
        return solve_ivp(
            slope, (0.0, found.period), state, method="DOP853", rtol=1e-12, atol=1e-14
        ).y[:, -1]

    grown = (after_a_period(start + away) - after_a_period(start - away)) / 2.0
    assert grown == pytest.approx(
        found.multiplier[0].real * away, rel=1e-6, abs=1e-7 * np.abs(away).max()
    )


def test_train_without_joints_is_neither_stable_nor_unstable_without_damping():
    study, system = made([Disc(inertia=1.0), Coupling(stiffness=1e4), Disc(inertia=2.0)])
    found = stability(study, system, np.array([50.0, 80.0, 122.0]))
    assert found.ranges == ()
    assert np.abs(found.growth).max() < 1e-9


def test_exponents_of_a_train_without_joints_are_its_damped_modes():
    line = [
        Motor(inertia=1.0, damping=0.4),
        Coupling(stiffness=1e4, viscous=3.0),
        Disc(inertia=0.5),
        Coupling(stiffness=2e4, viscous=1.0),
        Disc(inertia=2.0, damping=5.0),
    ]
    study, system = made(line)
    ask = growth_search(study, system)
    _, found = ask(50.0)
    size = 3
    mass = np.diag([1.0, 0.5, 2.0])
    c = np.array([[3.4, -3.0, 0.0], [-3.0, 4.0, -1.0], [0.0, -1.0, 6.0]])
    k = 1e4 * np.array([[1.0, -1.0, 0.0], [-1.0, 3.0, -2.0], [0.0, -2.0, 2.0]])
    first = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-np.linalg.solve(mass, k), -np.linalg.solve(mass, c)],
        ]
    )
    exact = np.exp(np.linalg.eigvals(first) * found.period)
    exact = exact[np.abs(exact - 1.0) > 1e-9]  # the free turning
    order = np.lexsort((exact.imag, np.abs(exact)))
    mine = np.append(found.multiplier, np.exp(found.drift * found.period))
    mine = mine[np.lexsort((mine.imag, np.abs(mine)))]
    assert mine == pytest.approx(exact[order], rel=1e-9)


def test_loss_factor_damps_each_mode_by_half_of_it():
    eta = 0.02
    study, system = made(
        [Disc(held=True), Coupling(stiffness=1e4, loss_factor=eta), Disc(inertia=1.0)]
    )
    assert growth_search(study, system).growth(30.0) == pytest.approx(-eta / 2.0 * 100.0, rel=1e-3)


def test_massless_joints_between_damped_shafts_give_the_exponents_of_small_inertias():
    def train_of(yoke: float | None) -> tuple[Study, System]:
        pair = None if yoke is None else (yoke, yoke)
        line = [
            Motor(inertia=2.0, damping=0.5),
            Coupling(stiffness=2e4, viscous=0.4),
            Joint(angle="20 deg", inertia=pair),
            Coupling(stiffness=3e4, viscous=0.6),
            Disc(inertia=0.8, damping=1.5),
        ]
        return made(line, CONSTANT)

    exact = growth_search(*train_of(None)).growth(96.0)
    errors = [abs(growth_search(*train_of(yoke)).growth(96.0) - exact) for yoke in (1e-3, 1e-4)]
    assert errors[1] < 0.2 * errors[0] < 0.02 * abs(exact)


def test_reduction_to_the_modes_that_matter_keeps_the_growth():
    study, system = six_stations(20, 0, 1.5)
    whole, reduced = growth_search(study, system), growth_search(study, system, modes=2)
    assert reduced.growth(107.14) == pytest.approx(whole.growth(107.14), abs=2e-3)


def test_hill_and_monodromy_agree_about_the_orbit():
    study, system = six_stations(20, 90, 1.5)
    at = scene(study, system)
    shapes = basis(at.layout)
    there = orbit(at, 100.0)
    around = variation(at, there)
    highest = float(shapes.frequency[-1])
    first, second = by_monodromy(around, highest), by_hill(around, highest, there.balance.count)
    assert second.growth == pytest.approx(first.growth, abs=1e-8)
    for one in first.multiplier:
        assert np.abs(second.multiplier - one).min() < 1e-9


def test_basis_has_the_modes_of_the_train():
    study, system = six_stations(10, 0, 8.0)
    shapes = basis(scene(study, system).layout)
    assert shapes.rigid == 1
    assert shapes.frequency[1:] == pytest.approx(
        2.0 * math.pi * modes(system, None).frequency, rel=1e-12
    )
    gram = shapes.shape.T @ (shapes.inertia[:, None] * shapes.shape)
    assert gram == pytest.approx(np.eye(4), abs=1e-12)


@pytest.mark.parametrize(
    ("energy", "w0", "name"),
    [
        ((0.0, 1.0, 0.001, 0.0), 20.2, "principal of mode 1 (2 w1)"),
        ((0.0, 1.0, 0.6, 0.0), 40.1, "sum of modes 1 and 2 (w1 + w2)"),
        ((0.0, 1.0, 0.6, 0.0), 19.9, "difference of modes 1 and 2 (w2 - w1)"),
        ((0.0, 0.3, 0.0, 1.0), 37.0, "sum of modes 1 and 3 ((w1 + w3)/2)"),
        ((0.0, 1.0, 0.0, 0.0), 10.1, "principal of mode 1 (2 w1/2)"),
        # 2 (w3 - w1)/54 is met, but mode 3 has less than a tenth of the energy: mode 1 explains it alone.
        ((0.0, 1.0, 0.0, 0.05), 27.0, "principal of mode 1 (2 w1)"),
        ((0.0, 1.0, 0.0, 0.5), 27.0, "difference of modes 1 and 3 ((w3 - w1)/2)"),
    ],
)
def test_zones_are_named_by_the_modes_that_take_part(energy, w0, name):
    shapes = Basis(np.array([0.0, 10.0, 30.0, 64.0]), np.eye(4), np.ones(4), np.zeros((4, 4)), 4)
    assert zone(np.array(energy), shapes, w0).name == name


def test_hill_with_more_harmonics_than_the_orbit_has_agrees_with_the_monodromy():
    ask = growth_search(*six_stations(20, 90, 1.5))
    orbit, expected = ask(56.0)
    around = variation(ask.mechanism, orbit)
    count = around.mass.shape[0] // 2 + 4
    assert by_hill(around, 0.0, count).growth == pytest.approx(expected.drift, abs=1e-9)
