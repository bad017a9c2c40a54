"""Torques that follow the motion, against independent integrations and closed forms."""

import math
from collections.abc import Sequence

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.kernels.motion.test_damped_motion import chain

from torsion.errors import SolveError
from torsion.kernels.motion import torque_laws as laws
from torsion.kernels.motion.collocation import Conditions, Law, Marched, Points, Scheme, march
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion
from torsion.kernels.motion.loaded_modes import (
    NODES,
    POINTS,
    POWERS,
    SERIES,
    LoadedModes,
    ModalTrain,
    Piece,
    answers,
    history,
    polynomial_value,
    turning,
)
from torsion.kernels.motion.march import March
from torsion.kernels.motion.torque_laws import FORWARD, STANDS, DryFriction

SYNCHRONOUS = 50.0 * math.pi


def solved(
    train: ModalTrain,
    shape: np.ndarray,
    found: Sequence[Law],
    scheme: Scheme,
    speed: float = 0.0,
    pieces: tuple[Piece, ...] = (),
) -> tuple[EventDrivenMotion, Marched]:
    """The motion under laws at interfaces of shapes (interfaces, rigid motions + modes), and pieces at the first."""
    none = np.zeros(shape.shape[1])

    def carrier(time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        turned = np.zeros((len(shape), len(time)))
        return turned + speed * time, turned + speed, turned

    loaded = LoadedModes(train, [pieces], shape[:1].T, shape)
    taken = March(loaded, scheme.duration, np.empty(0), none, none, carrier=carrier)
    answer = march(taken, found, scheme)
    return taken.finished(scheme.duration), answer


def one_disc(
    inertia: float, found: Sequence[Law], duration: float, speed: float = 0.0
) -> tuple[Marched, object]:
    """A disc alone, and its speed over time."""
    shape = np.full((len(found), 1), 1.0 / math.sqrt(inertia))
    scheme = Scheme(duration, 1e-9, duration / 1000.0, duration / 8.0, np.ones(len(found)))
    train = ModalTrain(np.empty(0), np.empty(0), np.zeros((1, 1)))
    moved, answer = solved(train, shape, found, scheme, speed)
    return answer, lambda time: speed + moved.at(np.array([time])).speed[0, 0] * shape[0, 0]


@pytest.mark.parametrize(
    "root",
    [
        0.001j,
        0.999j,
        -0.999 + 0j,
        -1 + 3j,
        3.99j,
        -3.99 + 0j,
        15.9j,
        -15.9 + 0j,
        16.1j,
        -20 + 0j,
        -10 + 1e4j,
        -1e6 + 1e8j,
    ],
)
@pytest.mark.parametrize("share", [0.01, 0.3, 1.0])
def test_the_answer_to_a_polynomial_is_the_convolution(root: complex, share: float) -> None:
    torque = POWERS @ (SERIES @ (np.exp(-0.3 * NODES) * np.cos(2.0 * NODES)))
    late = np.array([share])
    answered = answers(np.array([root]), 0.0, late, POINTS, np.exp(root * late[None]))
    found = complex((torque * share ** np.arange(POINTS)) @ answered[:, 0, 0])
    with mpmath.workdps(60):
        powers = [mpmath.mpf(float(one)) * mpmath.mpf(share) ** k for k, one in enumerate(torque)]
        z = mpmath.mpc(root * share)
        each = [(mpmath.e**z - 1) / z]
        for power in range(1, 8):
            each.append((power * each[-1] - 1) / z)
        exact = complex(sum(a * b for a, b in zip(powers, each, strict=True)))
    assert abs(found - exact) <= 5e-14 * abs(exact)


def test_slow_and_fast_modes_answer_together_as_each_alone() -> None:
    root, time = np.array([-1 + 3j, -0.5 + 40j, -10 + 1e4j]), np.array([0.05, 0.3, 0.9])
    decay = np.exp(np.multiply.outer(root, time))
    together = answers(root, 0.0, time, POINTS, decay)
    for mode, late in np.ndindex(3, 3):
        alone = answers(root[[mode]], 0.0, time[[late]], POINTS, decay[[mode]][:, [late]])
        assert together[:, mode, late] == pytest.approx(alone[:, 0, 0], rel=1e-13, abs=1e-16)


def test_a_polynomial_goes_through_its_values_at_the_nodes() -> None:
    values = np.sin(np.arange(POINTS * 2.0)).reshape(POINTS, 2)
    polynomial = (POWERS @ (SERIES @ values))[:, :, None]
    assert polynomial_value(polynomial, NODES) == pytest.approx(values.T, abs=1e-11)


def test_a_motion_without_root_turns_by_the_second_integral_of_its_torque() -> None:
    cubic = POWERS @ (SERIES @ NODES**3) * 0.5 ** np.arange(POINTS)
    turned = 0.5**2 * (cubic @ turning(0.0, np.array([0.5]), POINTS)[:, 0])
    assert turned == pytest.approx(0.5**5 / 20.0, rel=1e-14)


class MotorWithPulsation(laws.InductionMotor):
    """The motor of the trains of ten discs, with the pulsation of a direct start as a law, too."""

    def conditions(self, regime: int, points: Points) -> Conditions:
        found = super().conditions(regime, points)
        pulsation = 600.0 * np.exp(-points.time / 0.15) * np.sin(100.0 * math.pi * points.time)
        return Conditions(found.lack + pulsation, by_speed=found.by_speed)


def torque_and_slope(speed: float) -> tuple[float, float]:
    """Of the motor, N m."""
    s = 1.0 - speed / SYNCHRONOUS
    return 360.0 * s / (s * s + 0.04), -360.0 * (0.04 - s * s) / (s * s + 0.04) ** 2 / SYNCHRONOUS


def started(
    inertia: list[float], stiffness: list[float], tolerance: float
) -> tuple[np.ndarray, float]:
    """Torques of the springs and speed of the motor after 2 s."""
    w, shape, torque = chain(inertia, stiffness)
    train = ModalTrain(w, np.full(len(w), 0.01), np.zeros((len(inertia),) * 2))
    found = [
        MotorWithPulsation(0, 900.0, 0.2, SYNCHRONOUS),
        laws.BySpeed(1, laws.quadratic(-300.0, SYNCHRONOUS)),
    ]
    ends = shape[[0, -1]]
    moved = solved(train, ends, found, Scheme(2.0, tolerance, 1e-3, 0.25, np.ones(2)))[0].at(
        np.array([2.0])
    )
    return torque @ moved.position[1:, 0], float(ends[0] @ moved.speed[:, 0])


def rest(x: np.ndarray, t: float, w: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Rates of w times places of the modes, and of speeds of rigid motion and modes."""
    modes = len(w)
    bent, v = x[:modes], x[modes:]
    motor, pump = ends @ v
    acting = torque_and_slope(motor)[0] + 600.0 * math.exp(-t / 0.15) * math.sin(
        100.0 * math.pi * t
    )
    force = ends[0] * acting - ends[1] * 300.0 * pump * abs(pump) / SYNCHRONOUS**2
    all_w = np.concatenate([[0.0], w])
    return np.concatenate([w * v[1:], force - 0.02 * all_w * v - np.concatenate([[0.0], w * bent])])


def test_a_motor_start_of_ten_discs_against_runge_kutta_of_eighth_order() -> None:
    choose = np.random.default_rng(5)
    inertia, stiffness = choose.uniform(0.5, 2.0, 10).tolist(), choose.uniform(2e4, 1e5, 9).tolist()
    w, shape, torque = chain(inertia, stiffness)
    ends, start = shape[[0, -1]], np.zeros(2 * len(w) + 1)
    known = solve_ivp(
        lambda t, x: rest(x, t, w, ends), (0.0, 2.0), start, "DOP853", rtol=1e-12, atol=1e-12
    ).y[:, -1]
    exact, speed = torque @ (known[:9] / w), ends[0] @ known[9:]
    for tolerance, error in (
        (1e-4, 2e-6),
        (1e-6, 1e-9),
        (1e-8, 2e-11),
    ):  # the last is that of the reference
        found, turning = started(inertia, stiffness, tolerance)
        assert np.abs(found - exact).max() <= error * np.abs(exact).max()
        assert turning == pytest.approx(speed, rel=error)


def test_a_motor_start_of_a_stiff_train_of_ten_discs_against_radau() -> None:
    # w from 90 to 5.5e8 rad/s; the reference is Radau IIA at 1e-11 on speeds and w times places, with its Jacobian
    choose = np.random.default_rng(5)
    inertia = [5.0, *(10.0 ** choose.uniform(-6.0, 0.0, 8)).tolist(), 7.0]
    stiffness = (10.0 ** choose.uniform(4.0, 12.0, 9)).tolist()
    exact = [
        381.1059417506356,
        378.06077588256943,
        374.88946986881996,
        374.83380927275823,
        374.831460932837,
        374.8313655224866,
        374.8223243539732,
        374.8095349435833,
        374.8094502866591,
    ]
    for tolerance, error in ((1e-6, 1e-9), (1e-8, 3e-11)):
        found, speed = started(inertia, stiffness, tolerance)
        assert found == pytest.approx(exact, rel=error)
        assert speed == pytest.approx(68.70077707121678, rel=error)


def test_a_brake_that_grows_with_the_square_of_the_speed() -> None:
    square = laws.BySpeed(0, laws.quadratic(-0.02 * 100.0**2, 100.0))
    _, speed = one_disc(50.0, [square], 10.0, 150.0)
    assert speed(10.0) == pytest.approx(93.75, rel=1e-14)


def test_dry_friction_stops_a_disc_and_holds_it() -> None:
    square = laws.BySpeed(0, laws.quadratic(-0.02 * 100.0**2, 100.0))
    answer, speed = one_disc(
        50.0, [square, DryFriction(1, (30.0,), 150.0, inertia=50.0)], 100.0, 150.0
    )
    when = next(time for time, law, regime in answer.changes if (law, regime) == (1, STANDS))
    assert when == pytest.approx(85.08402656466177, rel=1e-13)
    assert abs(speed(100.0)) < 1e-13 * 150.0


def test_dry_friction_holds_until_the_torque_exceeds_it() -> None:
    friction = DryFriction(0, (30.0,), 100.0, inertia=2.0)
    ramp = laws.Wave(
        1, laws.constant(40.0), 0.0, -math.pi / 2.0, 1j
    )  # 40 sin t exceeds 30 from arcsin(3/4) on
    answer, speed = one_disc(2.0, [friction, ramp], 1.5)
    begin = math.asin(0.75)
    assert [regime for _, law, regime in answer.changes if law == 0] == [FORWARD]
    assert answer.changes[0][0] == pytest.approx(begin, rel=1e-13)
    exact = (40.0 * (math.cos(begin) - math.cos(1.5)) - 30.0 * (1.5 - begin)) / 2.0
    assert speed(1.5) == pytest.approx(exact, rel=1e-12)


def test_a_table_over_speed_is_crossed_at_its_kinks() -> None:
    rows = [(0.0, 10.0), (1.0, 10.0), (2.0, 4.0), (5.0, 4.0)]
    answer, speed = one_disc(2.0, [laws.BySpeed(0, laws.table(rows))], 1.0)
    first, second = 0.2, 0.2 + math.log(10.0 / 4.0) / 3.0  # v' = (16 - 6 v)/2 between 1 and 2 rad/s
    assert [time for time, _, _ in answer.changes] == pytest.approx([first, second], rel=1e-12)
    assert speed(1.0) == pytest.approx(2.0 + 2.0 * (1.0 - second), rel=1e-12)


def test_a_law_acts_between_its_begin_and_its_end() -> None:
    law = laws.BySpeed(0, laws.constant(3.0), laws.Window(0.25, 0.625))
    _, speed = one_disc(2.0, [law], 1.0)
    assert [speed(0.25), speed(0.5), speed(1.0)] == pytest.approx([0.0, 0.375, 0.5625], rel=1e-13)


def test_a_torque_over_the_angle_does_the_work_that_its_area_is() -> None:
    pieces = [
        Piece(0.5, 1.0, -3.0, 2.0),
        Piece(2.0, 3.0, -2j, rate=1j * math.pi),
    ]  # a ramp, then 2 sin
    law = laws.ByAngle(0, history([pieces]))
    answer, speed = one_disc(2.0, [law], 2.0, 2.0)
    work = -3.0 * 0.5 + 0.25 + 2.0 * 2.0 / math.pi
    assert speed(2.0) == pytest.approx(math.sqrt(4.0 + work), rel=1e-11)
    assert len(answer.changes) == 4


def test_a_given_torque_and_one_that_follows_add_exactly() -> None:
    law = laws.BySpeed(0, laws.table([(0.0, 0.0), (1.0, -2.0)]))
    scheme = Scheme(1.0, 1e-10, 1e-3, 0.125, np.ones(1), (0.5,))
    train = ModalTrain(np.empty(0), np.empty(0), np.zeros((1, 1)))
    moved, _ = solved(
        train, np.array([[math.sqrt(0.5)]]), [law], scheme, 0.0, (Piece(0.0, 0.5, 6.0),)
    )
    speed = moved.at(np.array([0.5, 1.0])).speed[0] * math.sqrt(0.5)
    exact = [3.0 * (1.0 - math.exp(-0.5)), 3.0 * (1.0 - math.exp(-0.5)) * math.exp(-0.5)]
    assert speed == pytest.approx(exact, rel=1e-12)
    assert moved.at(np.array([0.25])).inputs[1:, 0] == pytest.approx(
        [6.0, -6.0 * (1.0 - math.exp(-0.25))], rel=1e-9
    )
    rates = np.diff(moved.at(np.array([0.24999, 0.25001])).inputs[2]) / 2e-5
    assert moved.at(np.array([0.25])).input_rates[2] == pytest.approx(float(rates[0]), rel=1e-6)


class Jumps(laws.InductionMotor):
    """A torque that jumps with the speed, without a regime that says so."""

    def conditions(self, regime: int, points: Points) -> Conditions:
        return Conditions(np.where(points.speed < 0.1, 1.0, -1.0) - points.torque)


def test_a_law_that_jumps_unsaid_has_no_answer() -> None:
    with pytest.raises(SolveError, match="no step is short enough"):
        one_disc(1.0, [Jumps(0, 1.0, 1.0, 1.0)], 1.0)


class Chatters(laws.InductionMotor):
    """Both regimes are left at once."""

    def limits(self, regime: int, points: Points) -> list[tuple[np.ndarray, int]]:
        return [(0.5 - points.time, 1 - regime)]


def test_regimes_that_change_without_end_are_said() -> None:
    with pytest.raises(SolveError, match="change their regime without end"):
        one_disc(1.0, [Chatters(0, 1.0, 1.0, 1.0)], 1.0)


def test_a_motion_of_too_many_steps_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("torsion.kernels.motion.collocation.MOST_STEPS", 5)
    with pytest.raises(SolveError, match="5 steps reach"):
        one_disc(50.0, [laws.BySpeed(0, laws.quadratic(-200.0, 100.0))], 10.0, 150.0)
