"""Exact periodic response: against published values, closed forms, integration in time and the linear response."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsion.analyses.response.harmonic_components import excitations, sources
from torsion.analyses.response.over_speed import response
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.stability.mechanism_loads import scene
from torsion.analyses.stability.periodic_orbits import (
    Found,
    PeriodicResponse,
    continued,
    further_motions,
    orbit,
    response_of,
)
from torsion.analyses.steady import statics, steady
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.kernels.joints.line import line_of, resultant
from torsion.kernels.periodic.harmonic_balance import motion_of, points_in_time
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine import Motor
from torsion.model.machine_torques import Excitation
from torsion.study import Operation, Study
from torsion.train import train

CONSTANT = Operation(load=[["1 rad/s", 300.0], ["1000 rad/s", 300.0]])
FIRST_MODE = 107.103746  # rad/s of the six-station train


def six_stations(angle: float, phase: float, damping: float = 8.0) -> tuple[Study, System]:
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
    built = train(line)
    return Study("six stations", built, operation=CONSTANT), assemble(built)


def over(study: Study, system: System, speeds: np.ndarray) -> PeriodicResponse:
    """The periodic response at ascending speeds, each motion continued from the one before it."""
    at, found = scene(study, system), [(None, "")]
    for speed in speeds.tolist():
        found.append(continued(at, speed, filter(None, found[-1][:1])))
    return response_of(
        at, [there for there, _ in found[1:]], speeds, tuple(why for _, why in found[1:])
    )


def at_one(study: Study, system: System, speed: float) -> PeriodicResponse:
    """The periodic response at one speed."""
    found = over(study, system, np.array([speed]))
    assert found.status[0] == Found.OK, found.why
    return found


def shafts(system: System, found: PeriodicResponse, order: int) -> np.ndarray:
    """Complex torques of the elastic spans."""
    return found.torque[0, found.orders.index(Fraction(order))][system.flexibility > 0]


def departure(
    study: Study, system: System, found: PeriodicResponse, in_time: Callable, rtol: float = 1e-12
) -> float:
    """Largest difference (rad) over one period between the orbit and an integration in time that starts on it."""
    here, at = found.orbits[0], scene(study, system)
    times, period = points_in_time(here.balance.count), 2.0 * np.pi / here.operation.loading.w0
    motion = motion_of(here.balance.harmonic, here.operation.loading.w0, times)
    start = np.concatenate([motion.deviation[:, 0], motion.speed[:, 0]])

    slope = in_time(at.layout, here.operation.loading, here.balance.load)
    t = np.arange(times) * period / times
    run = solve_ivp(slope, (0.0, t[-1]), start, method="DOP853", rtol=rtol, atol=1e-13, t_eval=t)
    return float(np.abs(run.y[: at.layout.free] - motion.deviation).max())


TRAINS = [
    (
        10,
        0,
        50,
        (28.1573702516, 30.5347522996, 25.0471257435),
        (0.3043810289, 0.05876792978, 0.2249929484),
        300.008109078,
    ),
    (
        20,
        0,
        50,
        (115.908011946, 125.563788691, 103.109324886),
        (5.083490124, 0.9798571905, 3.757834528),
        300.1374715618,
    ),
    (
        20,
        0,
        80,
        (32.6899100665, 14.5556194383, 38.3684059712),
        (1.418590806, 0.4609776401, 2.339605435),
        300.004889001,
    ),
    (
        20,
        90,
        20,
        (80.9535775583, 73.0205381634, 67.7350522829),
        (13.29143169, 11.17370277, 9.093121267),
        300.8610878154,
    ),
    (
        30,
        90,
        80,
        (1747.96965329, 1722.59208262, 1646.20523637),
        (70.15310037, 69.40240531, 196.4070239),
        309.795942077,
    ),
]  # joint angle, phase, speed, torques of order 2 and 4, mean torque of the motor


@pytest.mark.parametrize(("angle", "phase", "speed", "second", "fourth", "motor"), TRAINS)
def test_six_station_train_has_the_published_torques(angle, phase, speed, second, fourth, motor):
    study, system = six_stations(angle, phase)
    found = at_one(study, system, speed)
    assert np.abs(shafts(system, found, 2)) == pytest.approx(second, rel=1e-11)
    assert np.abs(shafts(system, found, 4)) == pytest.approx(fourth, rel=1e-9)
    assert found.drive[0] == pytest.approx(motor, rel=1e-12)


@pytest.mark.parametrize(
    ("angle", "phase", "speed"), [(10, 0, 80.0), (20, 90, FIRST_MODE / 2), (30, 90, 80.0)]
)
def test_harmonic_balance_is_the_integration_in_time(angle, phase, speed, in_time):
    study, system = six_stations(angle, phase)
    assert departure(study, system, at_one(study, system, speed), in_time, 1e-11) < 1e-10


GOVERNED = 107.138345  # rad/s: first mode with a governor's spring of 50 N m/rad on the motor, as the table took it
ALONE = ((3,), (10,), (20,), (30,))  # deg: every orbit found on its own
RAISED = (
    (3,),
    (10,),
    (10, 12, 14, 16, 18, 20),
    (20, 22, 24, 26, 28, 30),
)  # from orbit to orbit: there are several
ERRORS = [
    (0, 20.0, 8.0, ALONE, (1.9e-6, 2.3e-4, 3.9e-3, 2.0e-2)),
    (0, 50.0, 8.0, ALONE, (6.8e-6, 8.5e-4, 1.4e-2, 7.4e-2)),
    (0, GOVERNED / 2, 8.0, ALONE, (1.2e-6, 1.5e-4, 3.3e-3, 3.7e-2)),
    (0, GOVERNED / 2, 1.5, ALONE, (1.4e-6, 4.3e-4, 5.0e-2, 2.6e-1)),
    (0, 80.0, 8.0, ALONE, (6.6e-7, 8.3e-5, 1.4e-3, 7.2e-3)),
    (90, 20.0, 8.0, ALONE, (1.2e-6, 1.5e-4, 2.5e-3, 1.3e-2)),
    (90, GOVERNED / 4, 8.0, ALONE, (1.0e-5, 1.3e-3, 2.5e-2, 1.6e-1)),
    (90, 50.0, 8.0, ALONE, (5.0e-5, 6.2e-3, 9.6e-2, 4.3e-1)),
    (90, GOVERNED / 2, 8.0, ALONE, (7.6e-5, 9.3e-3, 1.3e-1, 4.9e-1)),
    (90, GOVERNED / 2, 1.5, RAISED, (1.5e-3, 1.6e-1, 1.7, 2.9)),
    (90, 80.0, 8.0, ALONE, (1.4e-6, 1.8e-4, 3.0e-3, 1.6e-2)),
]  # phase, speed, damping, joint angles on the way to 3, 10, 20, 30 deg, errors of the magnitude there


def raised(
    angles: tuple[float, ...], phase: float, speed: float, damping: float
) -> PeriodicResponse:
    """The periodic response at the last of the joint angles (deg), each orbit started from the one before it."""
    found = None
    for angle in angles:
        at = scene(*six_stations(angle, phase, damping))
        found = orbit(at, speed, found)
    return response_of(at, [found], np.array([speed]), ("",))


def first_order(study: Study, system: System, speed: float, drive: float = 300.0) -> np.ndarray:
    """Complex torques (elastic spans,) of order 2 of the first-order model with the motor at its exact mean torque.

    The table shared what the motor gives beyond the load of 300 N m equally by the four free angles.
    """
    at, excess = np.array([speed]), Fraction(drive) - 300
    shares = [
        300 + excess * 3 / 4,
        -excess / 4,
        Fraction(0),
        -excess / 4,
        Fraction(0),
        -300 - excess / 4,
    ]
    torque, twist = statics(system, shares, 0)
    mean = replace(
        steady(study.train, system, CONSTANT, at), torque=torque[:, None], twist=twist[:, None]
    )
    (second,) = (one for one in excitations(system) if one.line.order == 2)
    found = answer(
        system, 2.0 * at, sources(system, second, at, mean), ground_damping(system, at, mean)
    )
    return found.torque[0, system.flexibility > 0]


def error(system: System, exact: PeriodicResponse, first: np.ndarray) -> float:
    """Largest relative error of the magnitude of order 2 in an elastic span."""
    return float(np.max(np.abs(np.abs(first) / np.abs(shafts(system, exact, 2)) - 1.0)))


@pytest.mark.parametrize(("phase", "speed", "damping", "ways", "errors"), ERRORS)
def test_first_order_model_errs_as_published(phase, speed, damping, ways, errors):
    """Every entry of the table of two digits; the finest (phase 0, resonance, 3 deg) moves by 10 % in 6e-6 of speed."""
    for way, published in zip(ways, errors, strict=True):
        study, system = six_stations(way[-1], phase, damping)
        exact = raised(way, phase, speed, damping)
        found = error(system, exact, first_order(study, system, speed, exact.drive[0]))
        assert published / 1.1 < found < published * 1.1


@pytest.mark.parametrize(("phase", "speed"), [(0, 50.0), (90, FIRST_MODE / 2)])
def test_first_order_model_of_the_table_is_the_linear_response_under_its_mean_torque(phase, speed):
    study, system = six_stations(20, phase)
    linear = response(study, system, speeds=np.array([speed]))
    line = [one.order for one in linear.lines].index(2)
    here = linear.torque[linear.speed == speed][0, line, system.flexibility > 0]
    assert first_order(study, system, speed) == pytest.approx(here, rel=1e-12)


MOTIONS = [
    ((20,), (13183.0, 13117.7, 12677.4)),
    ((10, 12, 14, 16, 18, 20), (10887.8, 10803.2, 10031.3)),
    ((30, 28, 26, 24, 22, 20), (10225.9, 10233.7, 10288.8)),
]  # joint angles on the way to 20 deg, torques (N m) also found by collocation and Newton from many starts


@pytest.mark.parametrize(("way", "torques"), MOTIONS)
def test_lightly_damped_train_has_several_motions_at_resonance(way, torques, in_time):
    study, system = six_stations(20, 90, 1.5)
    exact = raised(way, 90, GOVERNED / 2, 1.5)
    assert np.abs(shafts(system, exact, 2)) == pytest.approx(torques, rel=1e-5)
    assert (
        departure(study, system, exact, in_time, 1e-11) < 1e-6
    )  # one multiplies deviations by 2.4 each period


def test_shaft_behind_a_joint_at_constant_speed_follows_the_closed_form():
    k, c, inertia, ground, speed, q = 5000.0, 2.0, 0.5, 1.5, 40.0, math.tan(math.radians(7.5)) ** 2
    line = [
        Disc(held=True),
        Joint(angle="15 deg", phase="90 deg"),
        Coupling(stiffness=k, viscous=c),
        Disc(inertia=inertia, damping=ground),
    ]
    built = train(line)
    study, system = Study("prescribed", built, operation=Operation()), assemble(built)
    found = at_one(study, system, speed)
    for rank, published in (
        (1, 0.0475977131170726375),
        (2, 9.62349939248059396e-5),
        (3, 3.66073376434489012e-7),
    ):
        w = 2 * rank * speed
        order = found.orders.index(Fraction(2 * rank))
        path = (k + 1j * w * c) / (k - w * w * inertia + 1j * w * (c + ground))
        angle = -1j * (-q) ** rank / rank * path
        assert found.angle[0, order, -1] == pytest.approx(angle, rel=1e-9, abs=1e-16)
        assert abs(angle) == pytest.approx(published, rel=1e-12)
    torque = [abs(shafts(system, found, 2 * rank)[0]) for rank in (1, 2, 3)]
    published_torque = (152.419739205060852, 1.23202443194634541, 0.0105437368742383567)
    assert torque == pytest.approx(published_torque, rel=1e-9)


def free_rotor() -> tuple[Study, System]:
    """Two discs of 1 and 2 kg m2 with a joint of 25 deg between them."""
    built = train([Disc(inertia=1.0), Joint(angle="25 deg", phase="90 deg"), Disc(inertia=2.0)])
    return Study("free", built, operation=Operation()), assemble(built)


PERIOD = 0.133959191838859575  # s of a turn, with 50 rad/s where the driving yoke stands square to the plane


def test_free_rigid_rotor_has_the_period_of_the_closed_form():
    study, system = free_rotor()
    found = at_one(study, system, 2.0 * math.pi / PERIOD)
    here = found.orbits[0]
    motion = motion_of(here.balance.harmonic, here.operation.loading.w0, 4 * 256)
    speed = here.operation.loading.speed + motion.speed[0]
    assert motion.deviation[0, 0] == pytest.approx(0.0, abs=1e-13)
    assert speed[0] == pytest.approx(50.0, rel=1e-12)
    assert speed[512] == pytest.approx(43.8576131631566305, rel=1e-12)
    assert found.drive[0] == pytest.approx(0.0, abs=1e-9)


def test_equations_in_time_turn_the_free_rotor_once_in_its_period(in_time):
    study, system = free_rotor()
    at = scene(study, system)
    loading = at_one(study, system, 50.0).orbits[0].operation.loading
    slope = in_time(at.layout, loading, np.zeros(1))
    run = solve_ivp(slope, (0.0, PERIOD), [0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-14)
    assert 50.0 * PERIOD + run.y[0, -1] == pytest.approx(2.0 * math.pi, rel=1e-12)
    assert run.y[1, -1] == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("seed", [1, 3, 4])
def test_train_without_joints_answers_as_the_linear_model(seed, random_train):
    random = np.random.default_rng(seed)
    excite = [
        Excitation(
            at=f"disc-{k}", order=order, torque=float(random.uniform(1, 50)), phase=f"{40 * k} deg"
        )
        for k, order in ((1, "1"), (2, "3/2"), (3, "2"))
    ]
    built = train(
        [*random_train(random, 4), Coupling(stiffness=1e4), Disc(inertia=1.0, damping=1.0)],
        excitations=excite,
    )
    study, system = Study("linear", built, operation=Operation()), assemble(built)
    linear = response(study, system, speeds=np.array([31.0]))
    found = at_one(study, system, 31.0)
    for k, line in enumerate(linear.lines):
        order = found.orders.index(line.order)
        angle, torque = linear.angle[0, k], linear.torque[0, k]
        assert found.angle[0, order] == pytest.approx(angle, rel=1e-8, abs=1e-10 * abs(angle).max())
        assert found.torque[0, order] == pytest.approx(
            torque, rel=1e-8, abs=1e-9 * abs(torque).max()
        )


def joints_in_a_row(joints: list) -> tuple[Study, System]:
    line = [
        Motor(inertia=2.0, damping=0.5),
        Coupling(stiffness=2e4, viscous=0.4),
        *joints,
        Coupling(stiffness=3e4, loss_factor=0.05),
        Disc(inertia=0.8, damping=3.0),
    ]
    built = train(line)
    return Study("row", built, operation=CONSTANT), assemble(built)


def test_three_massless_joints_in_a_row_move_the_shafts_as_their_resultant_does():
    angle, plane, phase = (
        np.radians([12.0, 25.0, 8.0]),
        np.radians([0.0, 40.0, -70.0]),
        np.radians([20.0, 15.0, 65.0]),
    )
    row = [
        Joint(angle=f"{a} rad", phase=f"{p} rad", plane=f"{g} rad" if k else None)
        for k, (a, g, p) in enumerate(zip(angle, plane, phase, strict=True))
    ]
    one = resultant(line_of(angle, plane, phase))
    single = [Joint(angle=f"{float(one.angle)} rad", phase=f"{float(one.phase)} rad")]
    many, alone = (at_one(*joints_in_a_row(joints), 43.0) for joints in (row, single))
    for order in (2, 4, 6):
        a, b = many.orders.index(Fraction(order)), alone.orders.index(Fraction(order))
        for station in (0, -1):
            expected = alone.angle[0, b, station]
            assert many.angle[0, a, station] == pytest.approx(expected, rel=1e-7, abs=1e-13)
    assert many.drive[0] == pytest.approx(alone.drive[0], rel=1e-12)
    assert many.mean[0, :2] == pytest.approx(alone.mean[0, :2], rel=1e-11)


def geared(kind: str = "cross") -> tuple[Study, System]:
    """A joint on each side of a gear of 2:3, one of them with and a torque of order 1 behind it."""
    second = {"radius": "30 mm", "arm": "200 mm"} if kind == "tripod" else {}
    line = [
        Motor(inertia=1.0, damping=2.0),
        Coupling(stiffness=4e3, viscous=3.0),
        Joint(angle="15 deg", inertia=(0.05, 0.05)),
        Coupling(stiffness=6e3, viscous=2.0),
        Gear(teeth=(20, 30), inertia=(0.1, 0.2)),
        Coupling(stiffness=5e3, viscous=2.0),
        Joint(kind=kind, angle="20 deg", inertia=(0.05, 0.05), **second),
        Coupling(stiffness=8e3, viscous=2.0),
        Disc(name="load", inertia=0.7, damping=2.0),
    ]
    built = train(line, excitations=[Excitation(at="load", order=1, torque=20.0, phase="30 deg")])
    return Study("geared", built, operation=CONSTANT), assemble(built)


@pytest.mark.parametrize("kind", ["cross", "tripod"])
def test_joints_at_two_speeds_have_a_common_period_and_follow_the_integration_in_time(
    kind, in_time
):
    study, system = geared(kind)
    assert scene(study, system).order == Fraction(2, 3)  # the torque is of order 1 behind the gear
    assert departure(study, system, at_one(study, system, 25.0), in_time, 1e-11) < 1e-10


def test_torques_of_joints_and_rigid_spans_balance_the_inertias():
    study, system = geared()
    found = at_one(study, system, 25.0)
    order = found.orders.index(Fraction(2))
    w = 2.0 * 25.0
    force = np.zeros(len(system.stations), dtype=complex)
    for span, torque in zip(system.spans, found.torque[0, order], strict=True):
        if not span.error:
            force[span.driving] -= torque
        force[span.driven] += torque / float(span.ratio)
    free = [
        s
        for s in range(len(system.stations))
        if not any(span.error and span.driving == s for span in system.spans)
    ]
    ground = system.ground_damping(np.array([25.0]), np.zeros((len(system.stations), 1)))[:, 0]
    moved = (-(w**2) * system.inertia + 1j * w * ground) * found.angle[0, order]
    assert moved[free] == pytest.approx(force[free], abs=1e-9 * np.abs(force).max())


def test_small_joints_carry_the_torque_of_the_first_order_on_their_driven_side():
    errors = []
    for angle in (0.5, 1.0):
        study, system = six_stations(angle, 90)
        linear = response(study, system, speeds=np.array([40.0]))
        first = linear.torque[0, [one.order for one in linear.lines].index(2)]
        exact = at_one(study, system, 40.0)
        torque = exact.torque[0, exact.orders.index(Fraction(2))]
        errors.append(np.abs(torque / first - 1.0).max())
    assert errors[0] < 1e-8
    assert errors[1] == pytest.approx(16.0 * errors[0], rel=0.1)


def test_ring_damper_without_stiffness_slips_with_the_train():
    line = [
        Disc(inertia=1.0, damping=1.0),
        Coupling(stiffness=1e4),
        Joint(angle="20 deg", inertia=(0.1, 0.1)),
        RingDamper(housing=0.1, ring=0.3, damping=12.0),
        Coupling(stiffness=1e4),
        Disc(inertia=1.0),
    ]
    built = train(line)
    found = at_one(Study("ring", built, operation=Operation()), assemble(built), 30.0)
    names = [station.name for station in built.stations]
    ring = next(k for k, name in enumerate(names) if "ring" in name)
    housing = names.index(names[ring].split(" ring")[0])
    w = 60.0
    order = found.orders.index(Fraction(2))
    expected = 12.0 * 1j * w / (12.0 * 1j * w - w * w * 0.3)
    assert found.angle[0, order, ring] / found.angle[0, order, housing] == pytest.approx(
        expected, rel=1e-9
    )


def test_continuation_over_speed_passes_the_resonances():
    study, system = six_stations(20, 90)
    speeds = np.linspace(46.0, 60.0, 8)
    whole = over(study, system, speeds)
    assert (whole.status == Found.OK).all()
    alone = at_one(study, system, 54.0)  # the first mode meets order 2 at 53.6
    second = whole.orders.index(Fraction(2))
    assert whole.torque[4, second] == pytest.approx(
        alone.torque[0, alone.orders.index(Fraction(2))], rel=1e-8
    )


def test_no_periodic_solution_is_told_and_not_invented():
    built = train(
        [Disc(held=True), Joint(angle="10 deg"), Coupling(stiffness=1e4), Disc(inertia=1.0)]
    )
    study, system = Study("lossless", built, operation=Operation()), assemble(built)
    found = over(study, system, np.array([30.0, 50.0]))
    assert found.status.tolist() == [Found.OK, Found.NONE]
    assert "resonance" in found.why[1] or "no periodic solution" in found.why[1]
    assert np.isnan(found.torque[1]).all()


def test_other_motions_at_a_peak_are_found_and_told_in_the_same_orders():
    """All three motions of the lightly damped train, from whichever of them the search sets out."""
    for way, _ in MOTIONS:
        study, system = six_stations(20, 90, 1.5)
        exact = raised(way, 90, GOVERNED / 2, 1.5)
        further = further_motions(scene(study, system), exact, [0])
        rank = further.orders.index(Fraction(2))
        found = [np.abs(shafts(system, exact, 2))]
        found += [np.abs(torque[rank, system.flexibility > 0]) for torque in further.torque]
        assert further.orders == exact.orders
        assert sorted(one[0] for one in found) == pytest.approx(
            sorted(torques[0] for _, torques in MOTIONS), rel=1e-5
        )


def test_a_train_with_one_motion_has_no_other():
    study, system = six_stations(10, 0, 8.0)
    assert further_motions(scene(study, system), at_one(study, system, 50.0), [0]) is None
