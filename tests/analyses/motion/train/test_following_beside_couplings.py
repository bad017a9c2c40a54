"""Starts, loads and joints beside couplings with play, friction and a capacity: Runge-Kutta steps, and limits."""

import math

import numpy as np
import pytest
from tests.analyses.motion.train.plain_cross import turn_cross
from tests.kernels.motion.piecewise_discs import Discs

import torsion
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.assembly import assemble
from torsion.errors import SolveError
from torsion.kernels.motion import collocation

SYNCHRONOUS = 50.0 * math.pi
MOTOR = {"pull_out": 900, "slip": 0.2, "synchronous": "1500 rpm"}
PUMP = {"law": "propeller", "torque": 300, "speed": "1500 rpm"}
START = [{"at": "motor", "start": MOTOR}, {"at": "pump", "load": PUMP}]
THREE = """name: x
operation: {{speeds: {{from: 500 rpm, to: 1600 rpm}}, rated: {{speed: 1500 rpm, power: 40 kW}}}}
train:
- motor: {{name: motor, inertia: 1.2}}
- coupling: {{name: c1, stiffness: 4e4, viscous: 3}}
- disc: {{name: half, inertia: 0.3}}
- coupling: {{name: c2, {}}}
- propeller: {{name: pump, inertia: 2, blades: 4}}
"""


def moved(text: str, **body) -> TransientMotion:
    study = torsion.parse(text)
    settings = TransientSettings.model_validate(
        {"initial": "rest", "samples": 1000, "tolerance": 1e-9, **body}
    )
    return transient(study, assemble(study.train, model="lumped"), settings)


def agrees(
    found: TransientMotion, discs: Discs, start: np.ndarray, spans: list[int], within: float, **more
) -> None:
    """Torques of spans, of the largest peak, with as many events that are named."""
    known, events = discs.run(start, found.time, **more)
    error = np.abs(found.torque[spans] - known).max() / np.abs(known).max()
    assert len(events) > 2
    assert found.switching is not None
    at = np.array([0.0, *events, *discs.kinks])
    assert all(np.abs(at - one.time).min() <= 1e-8 * one.time for one in found.switching.events)
    assert error <= within
    assert found.residual < 1e-11
    assert found.status == "ok"


def kloss(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
    s = 1.0 - speed[0] / SYNCHRONOUS
    return 360.0 * s / (s * s + 0.04)


def pump(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
    return -300.0 * speed[-1] * abs(speed[-1]) / SYNCHRONOUS**2


def test_a_motor_starts_a_pump_through_a_coupling_with_play() -> None:
    play = "stiffness: 6e4, clearance: {angle: 0.02 rad, viscous: 20}"
    found = moved(THREE.format(play), duration=0.6, events=START)
    discs = Discs(
        [1.2, 0.3, 2.0],
        [(0, 1, 4e4, 3.0)],
        [("play", 1, 2, 6e4, 0.01, 20.0)],
        [(0, kloss), (2, pump)],
    )
    agrees(found, discs, np.zeros(6), [0, 1], 1e-9)
    assert found.following == ("start at motor", "load at pump")


def test_a_clutch_takes_a_drum_along_that_a_load_brakes() -> None:
    rows = [[0.0, 400.0], [150.0, 300.0]]

    def motor(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
        return float(120.0 - 60.0 / 150.0 * speed[0])

    def load(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
        return float(-40.0 - 0.4 * speed[2] - (700.0 if t >= 0.3 else 0.0))

    def capacity(t: float) -> float:
        return float(np.clip((t - 0.05) / 0.4, 0.0, 1.0)) * 500.0

    rows = [[f"{n} rad/s", torque] for n, torque in ((0, 120.0), (150, 60.0))]
    load_rows = [[f"{n} rad/s", 40.0 + 0.4 * n] for n in (0, 200)]
    events = [
        {"at": "motor", "start": {"torque": rows}},
        {"at": "pump", "load": {"law": load_rows}},
        {"at": "c2", "time": 0.05, "clutch": {"close": 0.4}},
        {"at": "pump", "time": 0.3, "step": {"torque": -700}},
    ]
    slip = ("friction", 1, 2, 6e4, capacity, lambda t: 1250.0 if 0.05 < t < 0.45 else 0.0)
    discs = Discs(
        [1.2, 0.3, 2.0], [(0, 1, 4e4, 3.0)], [slip], [(0, motor), (2, load)], (0.05, 0.3, 0.45)
    )
    initial = {"speed": {"motor": "100 rad/s", "pump": "96 rad/s"}}
    found = moved(
        THREE.format("stiffness: 6e4, capacity: 500"), duration=0.6, initial=initial, events=events
    )
    agrees(found, discs, np.array([0.0, 0.0, 0.0, 100.0, 100.0, 96.0]), [0, 1], 1e-9, state=[1])
    changed = {one.what for one in found.switching.events} if found.switching is not None else set()
    assert {"stuck", "slip"} <= changed


def test_a_load_holds_a_drum_until_the_closing_clutch_carries_more() -> None:
    events = [
        {"at": "pump", "load": {"law": "constant", "torque": 80, "speed": "100 rad/s"}},
        {"at": "c2", "clutch": {"torque": [["0 s", 0], ["1 s", 400]]}},
    ]
    text = THREE.format("stiffness: 6e4, capacity: 500")
    found = moved(text, duration=0.5, initial={"speed": {"motor": "100 rad/s"}}, events=events)
    assert found.changes[0].time == pytest.approx(0.2, rel=1e-6)
    own = found.time < 0.2
    assert np.abs(found.speed[-1, own]).max() < 1e-6
    late = found.time[~own] - 0.2
    assert found.speed[-1, ~own] == pytest.approx(
        200.0 * late**2 / 2.0, abs=1e-5
    )  # 400 N m/s on 2 kg m2
    assert found.residual < 1e-10


BEND = math.radians(20.0)


def test_a_cross_joint_with_an_elastic_span_drives_a_coupling_with_dry_friction() -> None:
    text = THREE.format(
        "stiffness: 2e4, viscous: 1, hysteresis_torque: {torque: 20, stiffness: 5e4}"
    ).replace("- coupling: {name: c1", "- joint: {name: j, angle: 20 deg}\n- coupling: {name: c1")
    events = [{"at": "motor", "step": {"torque": 250}}, START[1]]
    found = moved(text, duration=0.3, events=events)

    def spring(angle: np.ndarray, speed: np.ndarray) -> tuple[float, float]:
        error, ratio, _ = turn_cross(float(angle[0]), BEND)
        twist, rate = angle[0] + error - angle[1], ratio * speed[0] - speed[1]
        return 4e4 * twist + 3.0 * rate, ratio

    acting = [
        (0, lambda t, angle, speed: 250.0 - math.prod(spring(angle, speed))),
        (1, lambda t, angle, speed: spring(angle, speed)[0]),
        (2, pump),
    ]
    friction = ("friction", 1, 2, 5e4, lambda t: 20.0, lambda t: 0.0)
    discs = Discs([1.2, 0.3, 2.0], [(1, 2, 2e4, 1.0)], [friction], acting)
    assert found.system is not None
    at = [span.name for span in found.system.spans].index("c2")
    known, events_known = discs.run(np.zeros(6), found.time)
    error = np.abs(found.torque[at] - known.sum(axis=0)).max() / np.abs(known).max()
    assert len(events_known) > 10
    assert error <= 1e-8
    assert found.residual < 1e-11


def test_a_small_play_is_none() -> None:
    linear = moved(THREE.format("stiffness: 6e4"), duration=0.1, events=START)
    errors = []
    for play in (1e-6, 1e-8):
        text = THREE.format(f"stiffness: 6e4, clearance: {play} rad")
        errors.append(np.abs(moved(text, duration=0.1, events=START).torque - linear.torque).max())
    assert errors[1] < 0.03 * errors[0]
    assert errors[1] < 1e-4 * linear.peak.max()


def test_a_motion_of_too_many_steps_says_how_far_it_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collocation, "MOST_STEPS", 120)  # of two interfaces
    text = THREE.format("stiffness: 6e4, clearance: {angle: 0.02 rad, viscous: 20}")
    with pytest.raises(
        SolveError, match=r"60 steps reach only 0\.\d+ s of 1 s;.*shorten `duration`"
    ) as refused:
        moved(text, duration=1.0, events=START)
    assert refused.value.path == ("analyses", "transient")


LINEAR = "stiffness: 6e4, viscous: 0"
NEVER = "stiffness: 6e4, capacity: 1e7"
JOINT = "joint: {{name: j, angle: 20 deg}}\n- "
SPRING = "coupling: {{name: c0, stiffness: 3e4, viscous: 2}}\n- "
BEFORE = "coupling: {{name: c1"
DISC = "disc: {{inertia: 0.1}}\n- "
ELASTIC = THREE.replace(BEFORE, f"{JOINT}{SPRING}{DISC}{BEFORE}")
HELD = THREE.replace("motor: {{name: motor, inertia: 1.2", "disc: {{name: motor, held: true")
PROGRAM = {"at": "motor", "speed": {"program": [["0 s", "0 rpm"], ["0.3 s", "600 rpm"]]}}
SINE = {"at": "pump", "sine": {"torque": 50, "frequency": 20}}
PULSATION = {"at": "motor", "start": {**MOTOR, "pulsation": {"torque": 300, "decay": 0.1}}}
CASES = {
    "start": (THREE, {"events": START}),
    "pulsation": (THREE, {"events": [PULSATION, START[1]]}),
    "program": (HELD, {"events": [PROGRAM, START[1]]}),
    "ice": (
        THREE,
        {"events": [*START, {"at": "pump", "time": 0.05, "ice": {"torque": 200, "case": 1}}]},
    ),
    "orders": (
        THREE.replace("blades: 4", "blades: 4, excitation: [{{blade_order: 1, torque: 20 %}}]"),
        {"events": START},
    ),
    "elastic joint": (ELASTIC, {"events": START}),
    "joint behind a span": (
        THREE.replace(BEFORE, f"{SPRING}{JOINT}{DISC}{BEFORE}"),
        {"events": START},
    ),
    "rigid joint": (THREE.replace(BEFORE, f"{JOINT}{DISC}{BEFORE}"), {"events": START}),
    "steady joint": (ELASTIC, {"events": [SINE], "initial": "steady"}),
}


@pytest.mark.parametrize("name", CASES)
def test_a_clutch_that_never_slips_is_a_linear_coupling(name: str) -> None:
    text, body = CASES[name]
    linear, found = (moved(text.format(one), duration=0.06, **body) for one in (LINEAR, NEVER))
    assert found.steps > 0
    assert np.abs(found.torque - linear.torque).max() <= 1e-8 * linear.peak.max()
    assert np.abs(found.speed - linear.speed).max() <= 1e-9 * np.abs(linear.speed).max()
    assert found.peak == pytest.approx(linear.peak, rel=1e-8)
    assert found.before == pytest.approx(linear.before)
    assert found.residual < 1e-10


def test_parts_with_speeds_of_their_own_beside_a_joint_are_refused() -> None:
    text = THREE.replace(BEFORE, f"{JOINT}{DISC}{BEFORE}").format(NEVER)
    with pytest.raises(SolveError, match="parts at different speeds together with uneven joints"):
        moved(
            text,
            duration=0.1,
            events=START,
            initial={"speed": {"motor": "10 rad/s", "pump": "0 rad/s"}},
        )


SHAFTS = """name: x
train:
- disc: {{name: a, inertia: 2}}
- shaft: {{name: s1, length: 1.5 m, diameter: 60 mm{0}}}
- disc: {{name: b, inertia: 0.2}}
- coupling: {{name: c, stiffness: 6e4, {1}}}
- disc: {{name: d, inertia: 0.3}}
- shaft: {{name: s2, length: 1 m, diameter: 50 mm{0}}}
- disc: {{name: e, inertia: 3}}
"""
SHAKEN = [
    {"at": "a", "step": {"torque": 500}},
    {"at": "e", "sine": {"torque": 200, "frequency": 15}},
]
PLAY = "clearance: {angle: 0.01 rad, viscous: 20}"


def with_shafts(
    segments: str, coupling: str, model: str, events: list[dict], **body
) -> TransientMotion:
    study = torsion.parse(SHAFTS.format(segments, coupling))
    settings = TransientSettings.model_validate(
        {"initial": "rest", "samples": 1000, "events": events, **body}
    )
    return transient(study, assemble(study.train, model=model), settings)


def test_lumped_shafts_beside_a_play_converge_to_finite_elements_with_the_square_of_their_length() -> (
    None
):
    fem = with_shafts("", PLAY, "fem", SHAKEN, duration=0.05)
    assert fem.switching is not None
    assert fem.residual < 1e-12
    errors = []
    for segments in (3, 6, 12):
        lumped = with_shafts(f", segments: {segments}", PLAY, "lumped", SHAKEN, duration=0.05)
        assert lumped.switching is not None
        pairs = zip(lumped.switching.events, fem.switching.events, strict=True)
        errors.append(max(abs(one.time - other.time) / other.time for one, other in pairs))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)
    assert errors[2] < 1.5e-5


def test_a_coupling_that_never_slips_is_linear_beside_finite_elements() -> None:
    events = [
        {"at": "a", "start": {"torque": [["0 rpm", 300], ["600 rpm", 0]]}},
        {"at": "e", "load": {"law": "propeller", "torque": 100, "speed": "500 rpm"}},
    ]
    linear, found = (
        with_shafts("", one, "fem", events, duration=0.02, tolerance=1e-8, modes=80)
        for one in ("viscous: 0", "capacity: 1e6")
    )
    assert linear.modes == found.modes + 1  # all of both: the clutch parts the train
    span = [one.name for one in found.system.spans].index("c") if found.system is not None else 0
    assert np.abs(found.torque - linear.torque)[span].max() <= 1e-8 * linear.peak[span]
    assert np.abs(found.torque - linear.torque).max() <= 1e-8 * linear.peak.max()
