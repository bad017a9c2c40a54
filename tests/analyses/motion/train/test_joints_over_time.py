"""Universal joints from rest through their resonances, against given numbers, Runge-Kutta and harmonic balance."""

import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.analyses.motion.test_given_cases import moved
from tests.analyses.motion.train.plain_cross import turn_cross

import torsion
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.train.joints import exact_map, turned
from torsion.assembly import assemble
from torsion.errors import SolveError
from torsion.kernels.joints import tripod

BEND = math.radians(20.0)
EVENTS = [
    {"at": "a", "step": {"torque": 40.0}},
    {"at": "b", "load": {"law": "propeller", "torque": 5, "speed": "10 rad/s"}},
]
FROM_REST = {
    "duration": 3.0,
    "initial": "rest",
    "events": EVENTS,
    "samples": 3000,
    "tolerance": 1e-9,
}
Map = Callable[[float], tuple[float, float]]


def cross(angle: float) -> tuple[float, float]:
    """Driven angle and speed ratio; the yoke stands in the joint's plane at 0."""
    error, ratio, _ = turn_cross(angle, BEND)
    return angle + error, ratio


def crossed_back(angle: float) -> tuple[float, float]:
    """Driving angle, and driving speed / driven speed."""
    error, ratio, _ = turn_cross(angle, BEND, driving_yoke_in_plane=False)
    return angle + error, ratio


def tripod_map(angle: float) -> tuple[float, float]:
    """The exact motion of a tripod of single bearings, an arm of it in the plane at 0, by its harmonics of 3."""
    order, error = tripod_harmonics()
    harmonics = error * np.exp(1j * order * angle)
    return angle + float(harmonics.real.sum()), 1.0 - float(order @ harmonics.imag)


@cache
def tripod_harmonics() -> tuple[np.ndarray, np.ndarray]:
    """Orders and complex amplitudes of the error, to rounding: the amplitudes fall by 1e-4 from one to the next."""
    samples = 32
    angle = np.arange(samples) * 2.0 * math.pi / 3.0 / samples + math.pi / 2.0
    error = np.fft.rfft(tripod.exact_motion(angle, BEND, 0.03, 0.6).error) / samples
    return 3.0 * np.arange(6), np.append(error[0], 2.0 * error[1:6])


def elastic(of: Map, forward: bool) -> tuple[float, float, float]:
    """Speeds of both discs and torque of the spring after 3 s; the joint in front of the spring, or behind it."""

    def torque(x: np.ndarray) -> tuple[float, float]:
        a, b, va, vb = x if forward else x[[1, 0, 3, 2]]
        turned, ratio = of(a)
        return 2000.0 * (turned - b) + (ratio * va - vb), ratio

    def rates(t: float, x: np.ndarray) -> list[float]:
        spring, ratio = torque(x)
        on = (-ratio * spring, spring) if forward else (spring, -ratio * spring)
        return [x[2], x[3], (on[0] + 40.0) / 0.5, (on[1] - 0.05 * x[3] * abs(x[3])) / 2.0]

    start = np.zeros(4)
    start[1 if forward else 0] = of(0.0)[0]
    end = solve_ivp(rates, (0.0, 3.0), start, "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return end[2], end[3], torque(end)[0] * (1.0 if forward else -1.0)


SPRING = "coupling: {name: s, stiffness: 2000, viscous: 1}"
ENDS = "disc: {{name: a, inertia: 0.5}}, {}, disc: {{name: b, inertia: 2}}"


def test_a_cross_joint_with_a_spring_behind_it_starts_as_given() -> None:
    found = moved(ENDS.format("joint: {name: j, angle: 20 deg}, " + SPRING), FROM_REST)
    assert found.speed[[0, -1], -1] == pytest.approx(
        [28.937275771656946, 25.73177957274372], rel=1e-12
    )
    spans = [span.name for span in found.system.spans]
    assert found.torque[:, -1] == pytest.approx([8.416981185473588] * 2, rel=1e-8)
    assert found.peak[spans.index("s")] == pytest.approx(
        115.02463588126373, rel=1e-6
    )  # the reference's is of samples
    assert found.residual < 1e-13


@pytest.mark.parametrize(
    ("joint", "of", "forward"),
    [
        ("joint: {name: j, angle: 20 deg}, " + SPRING, cross, True),
        (SPRING + ", joint: {name: j, angle: 20 deg}", crossed_back, False),
        (
            "joint: {name: j, kind: tripod, angle: 20 deg, radius: 30 mm, arm: 600 mm}, " + SPRING,
            tripod_map,
            True,
        ),
    ],
)
def test_a_joint_beside_a_spring_against_runge_kutta(joint: str, of: Map, forward: bool) -> None:
    found = moved(ENDS.format(joint), FROM_REST)
    first, last, spring = elastic(of, forward)
    assert found.speed[[0, -1], -1] == pytest.approx([first, last], rel=1e-10)
    at = [span.name for span in found.system.spans].index("s")
    assert found.torque[at, -1] == pytest.approx(spring, rel=1e-7)


def test_a_rigid_joint_carries_the_inertia_behind_it_along() -> None:
    def rates(t: float, x: np.ndarray) -> list[float]:
        _, f1, f2 = turn_cross(x[0], BEND)
        behind = f1 * x[1]
        force = 40.0 - f1 * (0.05 * behind * abs(behind) + 2.0 * f2 * x[1] ** 2)
        return [x[1], force / (0.5 + 2.0 * f1**2)]

    known = solve_ivp(rates, (0.0, 3.0), [0.0, 0.0], "DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    found = moved(ENDS.format("joint: {name: j, angle: 20 deg}"), FROM_REST)
    _, ratio, slope = turn_cross(known[0], BEND)
    assert found.speed[:, -1] == pytest.approx([known[1], known[1] * ratio], rel=1e-11)
    gain = rates(3.0, known)[1]
    behind = 2.0 * (ratio * gain + slope * known[1] ** 2)
    assert found.torque[0, -1] == pytest.approx(behind + 0.05 * (ratio * known[1]) ** 2, rel=1e-7)


def test_two_joints_of_one_angle_turn_both_ends_alike() -> None:
    middle = "joint: {angle: 20 deg, inertia: [0, 0.01]}, disc: {inertia: 0.02}, joint: {angle: 20 deg, plane: 0 deg}"
    found = moved(ENDS.format(middle), FROM_REST)
    assert found.speed[-1] == pytest.approx(found.speed[0], abs=1e-9)
    inside = found.speed[1]
    assert np.ptp(inside[-300:] / found.speed[0, -300:]) == pytest.approx(
        1 / math.cos(BEND) - math.cos(BEND), rel=1e-2
    )


@pytest.mark.parametrize("phase", [0.0, 30.0])
def test_a_train_that_runs_stands_untwisted_at_the_begin(phase: float) -> None:
    body = {**FROM_REST, "initial": {"speed": "20 rad/s"}, "duration": 0.01}
    joint = f"joint: {{name: j, angle: 20 deg, phase: {phase} deg}}"
    found = moved(ENDS.format(f"{joint}, {SPRING}"), body)
    ratio = turn_cross(math.radians(phase), BEND).ratio
    assert found.speed[[0, -1], 0] == pytest.approx([20.0, 20.0 * ratio], rel=1e-12)
    assert np.abs(found.torque[:, 0]).max() < 1e-8


def test_a_steady_train_begins_with_its_static_twist() -> None:
    mean, speed = 300.0, 40.0

    def rates(t: float, x: np.ndarray) -> list[float]:
        error, ratio, _ = turn_cross(x[1], BEND)
        front = 4000.0 * (x[0] - x[1])
        behind = 2000.0 * (x[1] + error - x[2]) + ratio * x[4] - x[5]
        return [
            *x[3:],
            (mean - front) / 0.5,
            (front - ratio * behind) / 0.1,
            (behind - mean) / 2.0,
        ]

    yoke = -mean / 4000.0
    there = turn_cross(yoke, BEND)
    start = [
        0.0,
        yoke,
        yoke + there.error - mean / 2000.0,
        speed,
        speed,
        speed * there.ratio,
    ]
    known = solve_ivp(rates, (0.0, 0.5), start, "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    parts = (
        "motor: {name: a, inertia: 0.5}, coupling: {name: r, stiffness: 4000}, "
        f"joint: {{name: j, angle: 20 deg, inertia: [0.1, 0]}}, {SPRING}, propeller: {{name: b, inertia: 2}}"
    )
    operation = (
        f"operation: {{rated: {{speed: {speed} rad/s, power: {mean * speed} W}}, load: constant}}\n"
    )
    body = {
        "duration": 0.5,
        "events": [{"at": "a", "step": {"torque": 0.0}}],
        "samples": 1000,
        "tolerance": 1e-9,
    }
    found = moved(parts, body, operation)
    assert found.torque[0, -1] == pytest.approx(4000.0 * (known[0] - known[1]), rel=1e-9)
    assert found.speed[[0, -1], -1] == pytest.approx(known[[3, 5]], rel=1e-10)
    assert found.before == pytest.approx([mean] * 3)


SCENE = """
name: x
operation:
  speeds: {{from: 899 rpm, to: 900 rpm, steps: 2}}
  rated: {{speed: 900 rpm, power: 30 kW}}
  load: constant
train:
- motor: {{name: m, inertia: 1}}
- coupling: {{name: s, stiffness: 2e4, viscous: 60}}
- joint: {{name: j, angle: 15 deg, phase: 30 deg, inertia: [0.1, {}]}}
- coupling: {{name: t, stiffness: 3e4, viscous: 40}}
- disc: {{name: d, inertia: 0.7, damping: 20}}
analyses: {{response: {{method: harmonic-balance}}}}
"""


@pytest.mark.parametrize("yoke", [0.12, 0])
def test_after_its_start_a_train_with_a_joint_moves_as_harmonic_balance_says(yoke: float) -> None:
    study = torsion.parse(SCENE.format(yoke))
    known = torsion.run(study).results["periodic"]
    speed, load = 30.0 * math.pi, 30e3 / (30.0 * math.pi)
    rows = [["0 rpm", 0.0], ["810 rpm", load - 2.0 * speed], ["1800 rpm", load + 20.0 * speed]]
    events = [
        {"at": "m", "step": {"torque": float(known.drive[-1])}},  # what keeps the mean speed
        {"at": "d", "load": {"law": rows}},  # constant at that speed, and the damper's slope
    ]
    settings = TransientSettings.model_validate(
        {
            "duration": 2.0,
            "initial": {"speed": "900 rpm"},
            "events": events,
            "samples": 6_000,
            "tolerance": 1e-9,
        }
    )
    found = transient(study, assemble(study.train, model="lumped"), settings)
    late = slice(-1201, -1)  # six revolutions of 200 samples
    time, torque = found.time[late], found.torque[:, late]
    first = (torque[0] * np.exp(-2j * speed * time)).mean() * 2.0
    row = list(known.orders).index(2)
    angle = (
        np.angle(first / known.torque[-1, row, 0]) / 2.0 + speed * time
    )  # of the reference, to half a revolution
    waves = np.exp(1j * np.multiply.outer([float(order) for order in known.orders], angle))
    exact = known.mean[-1][:, None] + np.einsum("os,ot->st", known.torque[-1], waves).real
    assert np.abs(torque - exact).max() <= 1e-8 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (
            f"{SPRING}, joint: {{angle: 20 deg}}, coupling: {{stiffness: 100}}",
            "inertia on neither side",
        ),
        (
            "joint: {name: j, angle: 20 deg}, coupling: {stiffness: 9}, coupling: {stiffness: 9}",
            "leads to no inertia",
        ),
        (
            f"{SPRING}, joint: {{kind: tripod, angle: 9 deg, radius: 3 cm, arm: 1 m}}",
            "driving yoke of the tripod",
        ),
    ],
)
def test_a_joint_without_inertia_asks_for_one(parts: str, words: str) -> None:
    with pytest.raises(SolveError, match=words) as refused:
        moved(ENDS.format(parts), FROM_REST)
    assert refused.value.path == ("train", 1 if parts.startswith("joint") else 2, "joint")


@pytest.mark.parametrize(("shaft", "model"), [("", "fem"), (", segments: 92", "lumped")])
def test_a_rigid_joint_beside_fast_modes_without_damping_is_given_up_soon(
    shaft: str, model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("torsion.kernels.motion.collocation.WATCHED", 200)
    monkeypatch.setattr("torsion.kernels.motion.collocation.MOST_STEPS", 150_000)
    joint = "joint: {name: j, angle: 20 deg, inertia: [0.01, 0.01]}"
    parts = ENDS.format(f"{joint}, shaft: {{length: 1.5 m, diameter: 60 mm{shaft}}}")
    study = torsion.parse(f"name: x\ntrain: [{parts}]\n")
    settings = TransientSettings.model_validate({**FROM_REST, "samples": 10_000})
    place = ("analyses", "transient", 1)
    with pytest.raises(
        SolveError, match=r"^\d00 steps reach only .* s of 3 s; .*`segments`"
    ) as refused:
        transient(study, assemble(study.train, model=model), settings, path=place)
    assert refused.value.path == place


def test_a_spindle_of_many_masses_between_rigid_joints_against_runge_kutta() -> None:
    """Modes of up to 13,000 rad/s that nothing damps stand at joints that carry their accelerations."""
    masses = 18
    parts = (
        "disc: {name: motor, inertia: 60000}, joint: {name: first, angle: 8 deg}, "
        f"shaft: {{name: spindle, length: 9 m, diameter: 800 mm, segments: {masses}}}, "
        "joint: {name: second, angle: 8 deg}, disc: {name: roll, inertia: 8000}"
    )
    hit = {"at": "roll", "time": "0.05 s", "step": {"torque": -1.5e6, "length": "20 ms"}}
    body = {"duration": 0.2, "initial": {"speed": "20 rad/s"}, "events": [hit], "samples": 100}
    found = moved(parts, body)
    maps = [exact_map(found.system, span) for span in found.system.spans[:2]]
    inertia = found.system.lumped_inertia[[0, 1, *range(4, 3 + masses), 2, 3]]
    stiffness = 1.0 / found.system.flexibility[2:]

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        """Coordinates: the motor, which turns the first mass of the spindle, and its other masses."""
        angle, speed = np.split(state, 2)
        (begin, f1, f2, _), (_, g1, g2, _) = map(turned, maps, angle[[0, -1]])
        torque = stiffness * np.diff(np.append(begin, angle[1:]))
        hit = -1.5e6 if 0.05 <= time < 0.07 else 0.0
        acting = np.append(torque[1:], g1 * (hit - g2 * inertia[-1] * speed[-1] ** 2)) - torque
        acting = np.append(f1 * (torque[0] - f2 * inertia[1] * speed[0] ** 2), acting)
        turning = np.append(inertia[0] + f1**2 * inertia[1], inertia[2:-1])
        turning[-1] += g1**2 * inertia[-1]
        return np.append(speed, acting / turning)

    begin, ratio, _, _ = turned(maps[0], np.zeros(1))
    state = np.repeat([0.0, *begin, 20.0, *(20.0 * ratio)], [1, masses, 1, masses])
    for begin, end in pairwise((0.0, 0.05, 0.07, 0.2)):
        inner = np.nextafter(end, 0.0)
        state = solve_ivp(rates, (begin, inner), state, "DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    speed = found.speed[[0, *range(4, 3 + masses), 2], -1]
    assert speed == pytest.approx(state[masses + 1 :], rel=1e-8)
    assert found.residual < 1e-12


def test_two_joints_that_are_nearly_straight_move_as_none_with_a_damper_to_ground() -> None:
    """Three parts turn freely and the damper holds one: two rigid motions of theirs have no damping at all."""
    text = """
name: mill
operation: {{speeds: {{from: 20 rpm, to: 80 rpm}}, rated: {{speed: 60 rpm, power: 5 MW}}, load: constant}}
train:
- motor: {{name: motor, inertia: 60000}}
- coupling: {{name: coupling, stiffness: 900 MN*m/rad, viscous: 100 kN*m*s/rad}}
{first}
- shaft: {{name: spindle, length: 9 m, diameter: 800 mm, segments: 2}}
{second}
- disc: {{name: roll, inertia: 8000, damping: 2 N*m*s/rad}}
analyses:
  transient:
    duration: 0.15 s
    initial: {{speed: 60 rpm}}
    events: [{{at: roll, time: 0.05 s, step: {{torque: -1.5 MN*m, length: 20 ms}}}}]
"""
    joints = ("- joint: {angle: 0.1 deg}", "- joint: {angle: 0.1 deg, phase: 90 deg}")
    greatest = []
    for first, second in (joints, ("", "")):
        findings = torsion.run(torsion.parse(text.format(first=first, second=second)))
        motion = findings.results["transient"].each[0]
        names = [span.name for span in findings.system.spans]
        greatest.append(motion.greatest[[names.index("coupling"), names.index("spindle [2]")]])
    np.testing.assert_allclose(greatest[0], greatest[1], rtol=1e-5)
