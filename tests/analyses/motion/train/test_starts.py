"""Starts, loads, run-downs and sweeps, from the file to the motion, against closed forms and given numbers."""

import math

import numpy as np
import pytest
from tests.analyses.motion.test_given_cases import chain, moved
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.derived.resonances_passed import share_of_steady
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.assembly import assemble
from torsion.errors import InputError, SolveError

KLOSS = {"pull_out": 900, "slip": 0.2, "synchronous": "1500 rpm"}
FAN = {"law": "propeller", "torque": 300, "speed": "1500 rpm"}


def alone(
    inertia: float,
    events: list[dict],
    duration: float,
    initial: object = "rest",
    operation: str = "",
) -> TransientMotion:
    """A disc that starts or runs down."""
    events = [{"at": "d", **one} for one in events]
    body = {"duration": duration, "initial": initial, "events": events, "tolerance": 1e-9}
    return moved(f"disc: {{name: d, inertia: {inertia}}}", body, operation)


def test_a_motor_starts_a_fan_in_the_given_time() -> None:
    found = alone(12.0, [{"start": KLOSS}, {"load": FAN}], 3.7088033717129676)
    assert found.speed[0, -1] == pytest.approx(0.95 * 50.0 * math.pi, rel=1e-14)
    assert found.following == ("start at d", "load at d")
    assert 0.0 < found.left_in_series <= 1e-9
    assert found.residual < 1e-14


def test_a_motor_settles_at_the_speed_where_both_torques_meet() -> None:
    assert alone(12.0, [{"start": KLOSS}, {"load": FAN}], 60.0).speed[0, -1] == pytest.approx(
        152.0478709769483, rel=1e-14
    )


def test_the_rated_point_gives_the_load_its_size() -> None:
    operation = f"operation: {{rated: {{speed: 1500 rpm, power: {300 * 50 * math.pi!r} W}}}}\n"
    events = [{"at": "m", "start": KLOSS}, {"at": "p", "load": {"law": "propeller"}}]
    body = {"duration": 3.7088033717129676, "initial": "rest", "events": events, "tolerance": 1e-9}
    found = moved("motor: {name: m, inertia: 5}, propeller: {name: p, inertia: 7}", body, operation)
    assert found.speed[:, -1] == pytest.approx(0.95 * 50.0 * math.pi, rel=1e-13)


def test_a_motor_by_table_starts_as_the_curve_that_it_is_of() -> None:
    rows = [[f"{n} rpm", 100.0 - n / 10.0] for n in (0, 300, 1000)]  # T = 100 - b w, straight
    found = alone(2.0, [{"start": {"torque": rows}}], 1.0)
    slope = 100.0 / (1000.0 * math.pi / 30.0)
    assert found.speed[0, -1] == pytest.approx(
        100.0 / slope * (1.0 - math.exp(-slope / 2.0)), rel=1e-12
    )


def test_a_motor_that_is_switched_off_leaves_the_disc_at_its_speed() -> None:
    found = alone(2.0, [{"start": {"torque": [["0 rpm", 10], ["9000 rpm", 10]], "off": 0.5}}], 1.0)
    assert found.speed[0, -1] == pytest.approx(2.5, rel=1e-12)


def test_a_disc_runs_down_to_rest() -> None:
    square = {"law": "propeller", "torque": 200.0, "speed": "100 rad/s"}
    events = [{"load": square}, {"load": {"law": "constant", "torque": 30, "speed": "150 rad/s"}}]
    assert alone(50.0, events[:1], 10.0, {"speed": "150 rad/s"}).speed[0, -1] == pytest.approx(
        93.75, rel=1e-13
    )
    found = alone(50.0, events, 100.0, {"speed": "150 rad/s"})
    assert found.changes[0].time == pytest.approx(85.08402656466177, rel=1e-12)
    assert abs(found.speed[0, -1]) < 1e-6


def test_a_table_of_a_load_brakes_from_both_sides_and_holds_what_it_holds_at_rest() -> None:
    table = {"law": [["0 rpm", 30.0], ["1500 rpm", 30.0]]}
    found = alone(50.0, [{"load": table}], 5.0, {"speed": "2 rad/s"})
    assert found.changes[0].time == pytest.approx(50.0 * 2.0 / 30.0, rel=1e-12)
    backward = alone(50.0, [{"step": {"torque": -90.0, "until": 1.0}}, {"load": table}], 4.0)
    assert backward.speed[0, -1] == pytest.approx(
        0.0, abs=1e-5
    )  # 60/50 rad/s after 1 s, at rest 2 s later
    assert backward.changes[-1].time == pytest.approx(3.0, rel=1e-6)


def test_a_load_that_trips_leaves_the_motor_to_its_own_speed() -> None:
    events = [{"start": KLOSS}, {"load": {**FAN, "off": 20.0}}]
    found = alone(12.0, events, 60.0)
    assert found.speed[0, -1] == pytest.approx(50.0 * math.pi, rel=1e-9)


def test_the_line_pulsates_as_a_decaying_sine() -> None:
    flat = {
        "torque": [["0 rpm", 0], ["1500 rpm", 0]],
        "pulsation": {"torque": 40, "decay": 0.1},
        "line": 60,
    }
    found = alone(2.0, [{"start": flat}], 0.3)
    w, t = 120.0 * math.pi, 0.3
    exact = (
        20.0
        * (w - math.exp(-10.0 * t) * (10.0 * math.sin(w * t) + w * math.cos(w * t)))
        / (100.0 + w * w)
    )
    assert found.speed[0, -1] == pytest.approx(exact, rel=1e-12)


def test_a_synchronous_motor_pulsates_at_twice_its_slip_frequency() -> None:
    motor = {
        "torque": [["0 rpm", 100.0], ["1500 rpm", 100.0]],
        "synchronous": "1500 rpm",
        "slip_pulsation": [["0 rpm", 1e-6], ["1500 rpm", 1e-6]],
    }
    with_it = alone(20.0, [{"start": motor}], 1.0)
    # the speed rises by 5 rad/s2: phase of the pulsation 2 w_L (t - 2.5 t**2 / n_s)
    t = np.linspace(0.0, 1.0, 200_001)
    wave = 1e-6 * np.cos(200.0 * math.pi * (t - 2.5 * t**2 / (50.0 * math.pi)))
    gained = float(((wave[:-1] + wave[1:]) / 2.0).sum() * (t[1] - t[0])) / 20.0
    assert with_it.speed[0, -1] - 5.0 == pytest.approx(gained, rel=1e-4)


def test_an_order_swept_through_a_resonance() -> None:
    events = [{"at": name, "step": {"torque": 80.0}} for name in ("d1", "d2")]  # 40 rad/s2
    events += [
        {"at": "d1", "sine": {"torque": 1e-5, "order": 1, "phase": "90 deg"}},
        {"at": "d1", "load": {"law": "constant", "torque": 1e-30, "speed": "1 rad/s"}},
    ]
    body = {
        "duration": 3.0,
        "initial": {"speed": "20 rad/s"},
        "events": events,
        "samples": 3000,
        "tolerance": 1e-10,
    }
    found = moved(chain([2.0, 2.0], [1e4]), body, ratio=0.01)
    assert found.peak[0] / 0.5e-5 == pytest.approx(17.51978264644492, rel=2e-9)
    at = found.greatest_at if found.greatest[0] > -found.least[0] else found.least_at
    assert at[0] == pytest.approx(2.316576342058346, rel=1e-6)
    assert found.torque[0, 2000] / 0.5e-5 == pytest.approx(8.920484233894479, rel=1e-8)


def test_a_slow_sweep_reaches_the_steady_peak_but_for_what_falls_with_the_acceleration() -> None:
    ratio, w, short = 0.2, 100.0, []
    for acceleration in (4.0, 1.0):  # rad/s2; zeta w / sqrt(acceleration) = 10 and 20
        events = [{"at": name, "step": {"torque": 2.0 * acceleration}} for name in ("d1", "d2")]
        events += [
            {"at": "d1", "sine": {"torque": 1e-5, "order": 1}},
            {"at": "d1", "load": {"law": "constant", "torque": 1e-30, "speed": "1 rad/s"}},
        ]
        body = {
            "duration": 5.0 / acceleration,
            "initial": {"speed": "94 rad/s"},
            "events": events,
            "tolerance": 1e-7,
        }
        found = moved(chain([2.0, 2.0], [w * w]), body, ratio=ratio)
        short.append(1.0 - found.peak[0] / (0.5e-5 / (2.0 * ratio * math.sqrt(1.0 - ratio**2))))
    assert 0.0 < short[1] < 3e-4
    assert short[0] / short[1] == pytest.approx(4.0, rel=0.05)


def test_ice_takes_the_work_of_its_torque_over_the_angle() -> None:
    ice = {"torque": 90.0, "angle": "60 deg", "factor": 0.5, "turns": 3, "ramp": "270 deg"}
    idle = {"torque": [["0 rpm", 0.0], ["9000 rpm", 0.0]]}
    events = [{"at": "p", "time": 0.25, "ice": ice}, {"at": "m", "start": idle}]
    body = {"duration": 2.0, "initial": {"speed": "20 rad/s"}, "events": events, "tolerance": 1e-9}
    found = moved("motor: {name: m, inertia: 1}, propeller: {name: p, inertia: 2, blades: 3}", body)
    angle = np.linspace(0.0, 6.0 * math.pi, 2_000_001)
    within = np.mod(angle, 2.0 * math.pi / 3.0)
    torque = np.where(within < math.pi / 3.0, 45.0 * np.sin(3.0 * within), 0.0)
    torque *= np.interp(
        angle, [0.0, 1.5 * math.pi, 4.5 * math.pi, 6.0 * math.pi], [0.0, 1.0, 1.0, 0.0]
    )
    work = float(((torque[:-1] + torque[1:]) / 2.0).sum() * (angle[1] - angle[0]))
    assert found.speed[0, -1] == pytest.approx(math.sqrt(400.0 - 2.0 * work / 3.0), rel=1e-10)
    assert len(found.changes) > 15


def test_a_steady_train_goes_on_as_it_was_when_its_load_follows_its_speed() -> None:
    study = torsion.parse("""
name: x
operation: {speeds: {from: 500 rpm, to: 1500 rpm}, rated: {speed: 1200 rpm, power: 20 kW}, load: constant}
train:
- motor: {name: m, inertia: 1, ripple: [{order: 2, torque: 0.001, phase: 20 deg}]}
- coupling: {stiffness: 2e4, viscous: 10}
- gear: {teeth: [20, 41], inertia: [0.1, 0.3]}
- coupling: {stiffness: 4e4, viscous: 5}
- propeller: {name: p, inertia: 2}
excitations: [{at: m, frequency: 31 Hz, torque: 0.002}]
""")
    system = assemble(study.train, model="lumped")
    events = [{"at": "p", "load": {"law": "constant"}}]
    settings = TransientSettings.model_validate(
        {"duration": 0.3, "events": events, "tolerance": 1e-12}
    )
    found = transient(study, system, settings)
    speed = 40.0 * math.pi
    known = torsion.response(study, system, speeds=np.array([speed]))
    row = int(np.flatnonzero(known.speed == speed)[0])
    waves = np.exp(2j * math.pi * np.multiply.outer(known.frequency[row], found.time))
    exact = np.einsum("cs,ct->st", known.torque[row], waves).real
    vibration = found.torque - known.mean[row][:, None]
    assert np.abs(vibration - exact).max() <= 1e-7 * np.abs(exact).max()
    assert found.steps > 0


RUNS = "operation: {rated: {speed: 1200 rpm, power: 20 kW}, load: constant}\n"
PAIR = "motor: {name: m, inertia: 1}, coupling: {stiffness: 2e4, viscous: 50}, propeller: {name: p, inertia: 3}"


def test_a_motor_that_trips_is_switched_on_again() -> None:
    mean = 20e3 / (40.0 * math.pi)
    again = {"torque": [["0 rpm", 2.0 * mean], ["9000 rpm", 2.0 * mean]]}
    events = [{"at": "m", "time": 0.5, "stop": {}}, {"at": "m", "time": 1.5, "start": again}]
    found = moved(PAIR, {"duration": 3.0, "events": events, "tolerance": 1e-9}, RUNS)
    assert found.speed[0, -1] == pytest.approx(40.0 * math.pi + mean / 4.0 * (-1.0 + 1.5), rel=1e-9)


@pytest.mark.parametrize(
    "stop", [{"time": 2.0, "stop": {}}, {"time": 0.5, "stop": {"length": 0.2}}]
)
def test_a_mean_torque_that_is_replaced_does_not_stop(stop: dict) -> None:
    events = [{"at": "p", "time": 1.0, "load": {"law": "constant"}}, {"at": "p", **stop}]
    with pytest.raises(
        InputError, match="from 1 s on a start or a load takes the place of the mean torque of 'p'"
    ):
        moved(PAIR, {"duration": 3.0, "events": events}, RUNS)


def test_a_ripple_follows_the_speed_of_a_start() -> None:
    rows = [["0 rpm", 10], ["9000 rpm", 10]]
    text = """
name: x
operation: {speeds: {from: 300 rpm, to: 3000 rpm}, rated: {speed: 3000 rpm, power: 10 kW}, load: LOAD}
train: [motor: {name: m, inertia: 2, ripple: [{order: 3, torque: RIPPLE}]}, propeller: {name: p, inertia: 1}]
"""
    rated = 10e3 / (100.0 * math.pi)
    events = [{"at": "m", "start": {"torque": rows}}]
    settings = TransientSettings.model_validate(
        {"duration": 4.0, "initial": "rest", "events": events, "tolerance": 1e-10}
    )
    for load, ripple, size in (
        ("propeller", "0.01 %", lambda w: 1e-4 * rated * (w / (100.0 * math.pi)) ** 2),
        ("constant", "0.01 %", lambda w: 1e-4 * rated),
        (
            "[[0 rpm, 0 N*m], [3000 rpm, 60 N*m], [6000 rpm, 60 N*m]]",
            "0.01 %",
            lambda w: 60e-4 * w / (100.0 * math.pi),
        ),
        ("constant", "0.003", lambda w: 0.003),
    ):
        study = torsion.parse(text.replace("LOAD", load).replace("RIPPLE", ripple))
        found = transient(study, assemble(study.train, model="lumped"), settings)
        w, angle = 10.0 / 3.0 * found.time, 5.0 / 3.0 * found.time**2  # without the ripple
        t = np.linspace(0.0, 4.0, 400_001)
        wave = size(10.0 / 3.0 * t) * np.cos(5.0 * t**2) * np.ones_like(t) / 3.0
        gained = float(((wave[1:] + wave[:-1]) / 2.0).sum() * (t[1] - t[0]))
        assert found.speed[0, -1] - w[-1] == pytest.approx(gained, rel=2e-3, abs=1e-9)
        assert angle[-1] > 20.0


def test_a_resonance_that_a_start_passes_is_said() -> None:
    rows = [["0 rpm", 40], ["9000 rpm", 40]]
    operation = "operation: {speeds: {from: 300 rpm, to: 1800 rpm}}\n"
    motor = "motor: {name: m, inertia: 2, ripple: [{order: 2, torque: 0.01}]}"
    parts = f"{motor}, coupling: {{stiffness: 1e4, loss_factor: 0.02}}, propeller: {{name: p, inertia: 2}}"
    events = [{"at": "m", "start": {"torque": rows}}]
    found = moved(parts, {"duration": 8.0, "initial": "rest", "events": events}, operation)
    (passage,) = found.passages
    w = 100.0
    assert (passage.mode, passage.what) == (1, "order 2 at m")
    assert passage.speed == pytest.approx(w / 2.0, rel=1e-3)
    assert passage.time == pytest.approx(5.0, rel=1e-2)  # 10 rad/s2
    assert passage.seconds == pytest.approx(2.0 * 0.01 * w / 20.0, rel=2e-2)
    assert passage.share == pytest.approx(share_of_steady(0.01 * w / math.sqrt(20.0)), rel=5e-3)


@pytest.mark.parametrize(
    ("behind", "what"),
    [
        ("machine: {name: p, inertia: 8, excitation: [{order: 2, torque: 0.01}]}", "order 2 at p"),
        (
            "joint: {angle: 10 deg, inertia: [0.1, 0.1]}, disc: {inertia: 7.8}",
            "order 2 of joint joint-1",
        ),
    ],
)
def test_a_resonance_behind_a_gear_is_passed_at_the_order_of_its_own_speed(
    behind: str, what: str
) -> None:
    """2 kg m2 on either side at the motor's speed: 100 rad/s, met by order 2 of half the motor's speed."""
    coupling = "coupling: {stiffness: 1e4, loss_factor: 0.02}"
    parts = f"motor: {{name: m, inertia: 2}}, {coupling}, gear: {{teeth: [20, 40]}}, {behind}"
    events = [{"at": "m", "start": {"torque": [["0 rpm", 4000], ["9000 rpm", 4000]]}}]
    operation = "operation: {speeds: {from: 300 rpm, to: 1800 rpm}}\n"
    body = {"duration": 0.12, "initial": "rest", "events": events}
    (passage,) = moved(parts, body, operation).passages
    assert passage.what == what
    assert passage.speed == pytest.approx(2.0 * math.pi * passage.frequency, rel=1e-9)
    assert passage.speed == pytest.approx(100.0, rel=1e-2)
    assert passage.time == pytest.approx(0.1, rel=2e-2)  # 1000 rad/s2


def test_dampers_to_ground_damp_the_vibration_of_a_start_and_do_not_brake_it() -> None:
    parts = "motor: {name: m, inertia: 1}, coupling: {stiffness: 1e3}, disc: {name: d, inertia: 3, damping: 40}"
    start = {"torque": [["0 rpm", 8], ["9000 rpm", 8]]}
    body = {
        "duration": 4.0,
        "initial": "rest",
        "events": [{"at": "m", "start": start}],
        "tolerance": 1e-9,
    }
    found = moved(parts, body)
    assert found.speed[:, -1] @ [1.0, 3.0] == pytest.approx(8.0 * 4.0, rel=1e-12)
    assert found.torque[0, -1] == pytest.approx(
        6.0, rel=1e-3
    )  # what the acceleration of the disc needs
    assert found.peak[0] > 10.0


def test_a_program_turns_a_fixed_point_and_its_train_with_it() -> None:
    parts = "motor: {name: m, held: true}, coupling: {stiffness: 200}, disc: {name: d, inertia: 2}"
    program = {"program": [["0 s", "0 rpm"], ["1 s", "60 rpm"], ["2 s", "60 rpm"]]}
    found = moved(
        parts, {"duration": 3.0, "initial": "rest", "events": [{"at": "m", "speed": program}]}
    )
    a, t = 2.0 * math.pi, found.time  # rad/s2 for 1 s; w = 10 rad/s
    exact = (
        2.0 * a * (1.0 - np.cos(10.0 * t) - np.where(t > 1.0, 1.0 - np.cos(10.0 * (t - 1.0)), 0.0))
    )
    assert found.torque[0] == pytest.approx(exact, abs=1e-11)
    assert found.speed[0] == pytest.approx(a * np.minimum(t, 1.0), abs=1e-12)
    assert found.steps == 0


def test_orders_follow_a_prescribed_speed() -> None:
    parts = "motor: {name: m, held: true}, coupling: {stiffness: 200, viscous: 20}, disc: {name: d, inertia: 2}"
    program = {"program": [["0 s", "60 rpm"], ["1 s", "60 rpm"]]}
    events = [{"at": "m", "speed": program}, {"at": "d", "sine": {"torque": 1e-4, "order": 3}}]
    body = {
        "duration": 7.0,
        "initial": {"speed": "60 rpm"},
        "events": events,
        "tolerance": 1e-9,
        "samples": 7000,
    }
    found = moved(parts, body)
    w = 6.0 * math.pi  # order 3 at 60 rpm
    answer = -1e-4 * (200.0 + 20j * w) / (200.0 - 2.0 * w * w + 20j * w)
    late = found.time > 6.0
    exact = (answer * np.exp(1j * w * found.time[late])).imag
    assert np.abs(found.torque[0, late] - exact).max() <= 1e-6 * abs(
        answer
    )  # the twist shifts the phase by as much
    assert found.steps > 0


@for_all(
    ("event", "words"),
    [
        ("{at: d, start: {}}", "a start needs its torque over speed"),
        ("{at: d, start: {pull_out: 900, slip: 20, synchronous: 1500 rpm}}", "less than 1"),
        ("{at: d, start: {torque: [[0 rpm, 1], [10 rpm, 0]], pull_out: 3}}", "exclude each other"),
        (
            "{at: d, start: {torque: [[0 rpm, 1], [10 rpm, 0]], slip_pulsation: [[0 rpm, 1], [10 rpm, 0]]}}",
            "needs `synchronous`",
        ),
        ("{at: d, start: {torque: [[100 rpm, 1], [200 rpm, 0]]}}", "begins at 0 rpm"),
        ("{at: d, start: {torque: [[0 rpm, 1], [0 rpm, 0]]}}", "the speeds rising"),
        ("{at: d, start: {torque: [[0, 1], [10, 0]]}}", "has no unit"),
        ("{at: d, start: {torque: [[0 rpm, .nan], [10 rpm, 0]]}}", "not a finite number"),
        ("{at: d, load: {law: quadratic}}", "unknown load law 'quadratic'"),
        (
            "{at: d, load: {law: [[0 rpm, 1], [10 rpm, 2]], torque: 3}}",
            "a table contains torque and speed",
        ),
        ("{at: d, speed: {program: [[1 s, 0 rpm], [1 s, 10 rpm]]}}", "rising times"),
        ("{at: d, speed: {program: 7}}", "a program of speed is a list"),
        ("{at: d, sine: {torque: 1, order: 2}, time: 9 s}", "begins after the end"),
    ],
)
def test_a_faulty_event_is_refused_at_its_place(event: str, words: str) -> None:
    train = "name: x\ntrain: [disc: {name: d, inertia: 1}]\n"
    text = f"{train}analyses: {{transient: {{duration: 1 s, events: [\n{event}]}}}}\n"
    with pytest.raises(InputError) as refused:
        torsion.parse(text)
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 4


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ({"at": "m", "step": {"torque": 1}}, "'m' is fixed, and no torque moves it"),
        ({"at": "d", "start": {"torque": [["0 rpm", 1], ["10 rpm", 0]]}}, "it is fixed at m"),
        (
            {"at": "d", "speed": {"program": [["0 s", "0 rpm"], ["1 s", "9 rpm"]]}},
            "prescribed, and it turns freely",
        ),
    ],
)
def test_a_fixed_point_cannot_be_turned(event: dict, words: str) -> None:
    parts = "motor: {name: m, held: true}, coupling: {stiffness: 10}, disc: {name: d, inertia: 1}"
    with pytest.raises(InputError, match=words):
        moved(parts, {"duration": 1.0, "initial": "rest", "events": [event]})


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ({"load": {"law": "propeller"}}, "the load has no size"),
        ({"load": {"law": "constant"}}, "the load has no size"),
        (
            {"sine": {"torque": 1, "order": 2}},
            "an order has no frequency in a train that stands still",
        ),
        (
            {"speed": {"program": [["0 s", "0 rpm"], ["1 s", "9 rpm"]]}},
            "the speed of 'd' is prescribed, and it turns fr",
        ),
    ],
)
def test_what_an_event_lacks_is_said(event: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        alone(1.0, [event], 1.0)


def test_a_program_begins_at_the_speed_that_the_point_has() -> None:
    parts = "motor: {name: m, held: true}, coupling: {stiffness: 200}, disc: {name: d, inertia: 2}"
    program = {"program": [["0 s", "10 rpm"], ["1 s", "60 rpm"]]}
    with pytest.raises(InputError, match="the program begins at 10 rpm, and 'm' runs at 0 rpm"):
        moved(
            parts, {"duration": 3.0, "initial": "rest", "events": [{"at": "m", "speed": program}]}
        )


def test_a_load_outruns_no_table() -> None:
    table = {"law": [["0 rpm", 0.0], ["10 rpm", 1.0]]}
    with pytest.raises(SolveError, match="its table ends at 10 rpm"):
        alone(1.0, [{"load": table}, {"step": {"torque": 100.0}}], 1.0)


def at_random(seed: int) -> TransientMotion:
    """A train of two to five discs that starts, or runs down, under a load."""
    random = np.random.default_rng(seed)
    number = int(random.integers(2, 6))
    inertia, stiffness = (
        10.0 ** random.uniform(-1.0, 1.5, number),
        10.0 ** random.uniform(3.0, 5.0, number - 1),
    )
    damping = [", loss_factor: 0.05", f", viscous: {10.0 ** random.uniform(0.0, 2.0):.3f}"][
        int(random.integers(0, 2))
    ]
    speed, torque = float(random.uniform(50.0, 200.0)), float(10.0 ** random.uniform(1.5, 3.0))
    at = [f"{share * speed} rad/s" for share in (0.0, 0.3, 0.9, 1.0, 3.0)]
    motor = [
        {"torque": [[at[0], torque], [at[2], 2.0 * torque], [at[3], 0.0]]},
        {"pull_out": 2.5 * torque, "slip": float(random.uniform(0.05, 0.3)), "synchronous": at[3]},
    ][int(random.integers(0, 2))]
    if random.random() < 0.4:
        motor["pulsation"] = {"torque": torque, "decay": float(random.uniform(0.02, 0.3))}
    starts = [{"at": "d1", "time": 0.1, "start": motor}] if random.random() < 0.5 else []
    load = [
        {"law": "propeller", "torque": torque, "speed": at[3]},
        {"law": "constant", "torque": torque * float(random.uniform(0.1, 0.9)), "speed": at[3]},
        {"law": [[at[0], 0.3 * torque], [at[1], 0.1 * torque], [at[4], 2.0 * torque]]},
    ][int(random.integers(0, 3))]
    events = [*starts, {"at": f"d{number}", "load": load}]
    body = {
        "duration": 1.0,
        "initial": "rest" if starts else {"speed": at[3]},
        "events": events,
        "samples": 2000,
    }
    return moved(chain(inertia.tolist(), stiffness.tolist(), damping), body)


@pytest.mark.parametrize("seed", range(30))
def test_starts_and_run_downs_at_random_keep_the_balance_of_energy(seed: int) -> None:
    found = at_random(seed)
    assert found.steps > 0
    assert found.residual < 1e-10
    assert found.status == "ok"


def test_a_load_that_holds_a_station_is_marched_past_the_rounding_of_its_speed() -> None:
    discs, springs = [1.0446, 1.1421, 0.1975, 0.0772, 0.0365], [15187.4, 13825.7, 1175.9, 5183.6]
    events = [
        {
            "at": "d5",
            "load": {"law": "constant", "torque": 559.0426257041796, "speed": "131.167 rad/s"},
        }
    ]
    body = {
        "duration": 0.6,
        "initial": {"speed": "131.167 rad/s"},
        "events": events,
        "samples": 2000,
    }
    found = moved(chain(discs, springs, ", loss_factor: 0.05"), body)
    assert found.residual < 1e-10
    assert found.steps < 100  # 2526 where rounding of the speed kept the steps from growing
