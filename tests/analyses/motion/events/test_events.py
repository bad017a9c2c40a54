"""What an event says in a file: its torque over time, and what is refused at its place."""

import math

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.events.event_kind import settings_in_words
from torsion.analyses.motion.events.events import Event, Point
from torsion.analyses.motion.transient_motion import Transients
from torsion.analyses.response.over_speed import response
from torsion.errors import InputError
from torsion.kernels.motion.loaded_modes import value

TIME = np.linspace(0.0, 2.0, 201)
SCENE = """name: x
operation: {{rated: {{speed: 600 rpm, power: 60 kW}}}}
train: [motor: {{inertia: 1}}, coupling: {{stiffness: 1e4}}, propeller: {{name: screw, inertia: 2}}]
analyses: {{transient: {{duration: 1 s, {}}}}}
"""


def torque(kind: str, body: dict, at: Point = Point(), time: float = 0.0) -> np.ndarray:  # noqa: B008
    """N m at TIME."""
    return value(Event.model_validate({"at": "x", "time": time, kind: body}).pieces(at), TIME)


def test_a_step_lasts_until_its_end() -> None:
    found = torque("step", {"torque": 7.0, "until": 0.5}, time=0.25)
    assert found == pytest.approx(np.where((TIME >= 0.25) & (TIME < 0.75), 7.0, 0.0))


def test_a_table_is_linear_between_its_rows_and_nothing_outside() -> None:
    rows = ((0.1, 0.0), (0.5, 8.0), (0.9, -4.0))
    inside = (TIME >= 0.1) & (TIME < 0.9)
    exact = np.where(inside, np.interp(TIME, [0.1, 0.5, 0.9], [0.0, 8.0, -4.0]), 0.0)
    assert torque("table", {"rows": rows}) == pytest.approx(exact, abs=1e-13)


@pytest.mark.parametrize(
    ("shape", "exact"),
    [
        ("rectangle", np.ones_like),
        ("triangle", lambda x: 1.0 - np.abs(2.0 * x - 1.0)),
        ("half-sine", lambda x: np.sin(math.pi * x)),
    ],
)
def test_pulses_have_their_shape(shape: str, exact) -> None:
    inside = TIME < 0.4
    expected = np.where(inside, 3.0 * exact(TIME / 0.4), 0.0)
    assert torque("pulse", {"torque": 3.0, "length": 0.4, "shape": shape}) == pytest.approx(
        expected, abs=1e-13
    )


def test_a_sine_of_an_order_has_the_frequency_of_its_shaft() -> None:
    found = torque(
        "sine", {"torque": 5.0, "order": "3/2", "phase": "90 deg", "decay": 0.8}, Point(speed=20.0)
    )
    assert found == pytest.approx(5.0 * np.exp(-TIME / 0.8) * np.cos(30.0 * TIME), abs=1e-12)


def test_a_short_circuit_that_is_cleared_and_closed_again() -> None:
    body = {
        "coefficients": {"line": 8, "double": 4, "mean": 0.3},
        "decay": (0.2, 0.03),
        "clear": 0.3,
        "reclose": 0.7,
    }

    def fault(t: np.ndarray) -> np.ndarray:
        w = 2.0 * math.pi * 50.0
        slow, fast = np.exp(-t / 0.2), np.exp(-t / 0.03)
        return np.where(
            (t >= 0) & (t < 0.3),
            8 * slow * np.sin(w * t) - 4 * fast * np.sin(2 * w * t) + 0.3 * fast,
            0.0,
        )

    exact = -1000.0 * (fault(TIME) + fault(TIME - 0.7))
    inside = (np.abs(TIME - 0.3) > 1e-9) & (np.abs(TIME - 1.0) > 1e-9)  # the ends themselves
    assert torque("short-circuit", body, Point(rated=1000.0))[inside] == pytest.approx(
        exact[inside], abs=1e-8
    )


def test_a_stop_takes_the_mean_torque_away_along_its_ramp() -> None:
    found = torque("stop", {"ramp": 0.5}, Point(mean=40.0), time=0.5)
    assert found == pytest.approx(-40.0 * np.clip((TIME - 0.5) / 0.5, 0.0, 1.0), abs=1e-12)


@for_all(
    ("body", "words"),
    [
        ("events: [{at: screw}]", "an event is of one kind, and none is given"),
        ("events: [{at: screw, step: {torque: 1}, stop: {}}]", "step and stop is given"),
        ("events: [{at: scrw, step: {torque: 1}}]", "no component is called 'scrw'"),
        (
            "events: [{at: coupling-1, step: {torque: 1}}]",
            "'coupling-1' is a coupling, not a point",
        ),
        ("events: [{at: screw, time: 1 s, step: {torque: 1}}]", "begins after the end"),
        ("events: [{at: screw, table: {rows: [[0 s, 1], [0 s, 2]]}}]", "rising times"),
        ("events: [{at: screw, sine: {torque: 1}}]", "a sine has a `frequency` or an `order`"),
        ("events: [{at: screw, table: {}}]", "`rows` or a `file`"),
        ("events: [{at: screw, table: {rows: [[0 s, 1], [.nan, 2]]}}]", "not a finite number"),
        ("events: [{at: screw, table: {file: nowhere.csv}}]", "cannot be read"),
        ("events: [{at: screw, misfire: {}}]", "`misfire` is part of the format but not built yet"),
        ("events: [{at: screw, ice: {torque: 1}}]", "ice has a `case`, or an `angle`"),
        ("events: [{at: screw, stop: {share: 120 %}}]", "must be at most"),
        (
            "events: [{at: screw, short-circuit: {coefficients: {line: 8}, decay: [1, 1], reclose: 2}}]",
            "after `clear`",
        ),
        (
            "events: [{at: screw, short-circuit: {phases: 2, coefficients: {line: 8}, decay: [1, 1]}}]",
            "of 2 phases",
        ),
        ("events: [{at: screw, step: {torque: 1}}], samples: 10", "at least 100"),
        ("events: [{at: screw, step: {torque: 1}}], modes: none", "`all` or the number"),
        (
            "events: [{at: screw, step: {torque: 1}}], plot: [nothing]",
            "no component is called 'nothing'",
        ),
        ("events: [{at: screw, step: {torque: 1}}], export: xls", "none of 'npz'"),
        (
            "events: [{at: screw, step: {torque: 1}}], fatigue: {amplitude: 1, cycles: 1, slope: 5, at: no}",
            "'no'",
        ),
        (
            "events: [{at: screw, step: {torque: 1}}], fatigue: {amplitude: 1, cycles: 1, slope: 5, mean: goodman}",
            "both",
        ),
        (
            "events: [{at: screw, time: 0.5, pulse: {torque: 1, length: 1e-17, shape: triangle}}]",
            "fall together",
        ),
        (
            "events: [{at: screw, time: 0.5, table: {rows: [[0 s, 1], [1e-17 s, 2], [1 s, 0]]}}]",
            "fall together",
        ),
        ("events: [{at: screw, time: 0.5, stop: {ramp: 1e-17}}]", "fall together"),
        (
            "events: [{at: screw, short-circuit: {coefficients: {line: .nan}, decay: [1, 1]}}]",
            "nan is not a finite",
        ),
        (
            "events: [{at: screw, short-circuit: {coefficients: {line: 1, mean: .inf}, decay: [1, 1]}}]",
            "inf is not",
        ),
        ("events: [{at: screw, ice: {torque: 1, angle: 0 deg}}]", "more than 0 deg"),
        ("events: [{at: screw, ice: {torque: 1, angle: -30 deg}}]", "more than 0 deg"),
        ("events: [{at: screw, ice: {torque: 1, angle: 361 deg}}]", "at most 360 deg"),
        ("events: [{at: screw, ice: {torque: 1, case: 1, ramp: -90 deg}}]", "at least 0 deg"),
        (
            "events: [{at: screw, ice: {torque: 1, case: 1, turns: 2, ramp: 361 deg}}]",
            "at most 360 deg for 2 turns",
        ),
        ("events: [{at: screw, ice: {torque: 1, case: 1, factor: 1}}]", "contains its factor"),
        (
            "events: [{at: motor-1, stop: {}}, {at: motor-1, stop: {share: 1 %}}]",
            "together end 101 %",
        ),
        (
            "events: [{at: screw, step: {torque: 1}}], fatigue: {amplitude: 1, cycles: 1, slope: 5, at: screw}",
            "through",
        ),
        ("initial: {torque: {}}", "nothing moves the train"),
        ("initial: {torque: {coupling-1: 0}}", "nothing moves the train"),
        ("initial: {torque: {coupling-1: lots}}", "does not begin with a number"),
        ("initial: rest", "nothing moves the train"),
        ("initial: {speed: 100}", "has no unit"),
    ],
)
def test_a_faulty_event_is_refused_at_its_place(body: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(SCENE.format(body))
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 4


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            "{at: screw, ice: {torque: 1 kN*m, case: 1}}",
            "ice needs a turning propeller with `blades`",
        ),
        ("{at: wheel, stop: {}}", "no mean torque acts at 'wheel'"),
        ("{at: wall, step: {torque: 1}}", "'wall' is fixed, and no torque moves it"),
    ],
)
def test_what_an_event_lacks_of_its_train_is_said_at_its_place(event: str, words: str) -> None:
    wheel = "screw, inertia: 2}, coupling: {stiffness: 1e4}, disc: {name: wheel, inertia: 1}"
    wall = ", coupling: {stiffness: 1}, disc: {name: wall, held: true}" if "wall" in event else ""
    text = SCENE.format(f"events: [{event}]").replace("screw, inertia: 2}", wheel + wall)
    (one,) = torsion.run(torsion.parse(text)).plan.unanswered
    assert words in one.why
    assert (one.line, one.is_input) == (4, True)


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ("{at: d1, sine: {torque: 1, order: 2}}", "a train that stands still"),
        (
            "{at: d1, short-circuit: {coefficients: {line: 8}, decay: [1, 1]}}",
            "needs the rated torque",
        ),
    ],
)
def test_what_needs_a_speed_or_a_power_is_refused_at_rest(event: str, words: str) -> None:
    text = f"""name: x
train: [motor: {{name: d1, inertia: 1}}, coupling: {{stiffness: 1e4}}, disc: {{inertia: 2}}]
analyses: {{transient: {{duration: 1 s, events: [{event}]}}}}
"""
    (one,) = torsion.run(torsion.parse(text)).plan.unanswered
    assert words in one.why


def test_ice_cases_are_of_three_to_six_blades() -> None:
    ice = Event.model_validate({"at": "x", "ice": {"torque": 1.0, "case": 1}}).body
    assert ice.lacks(Point(speed=10.0, blades=4)) is None
    assert "3 to 6 blades, not 7" in ice.lacks(Point(speed=10.0, blades=7))[0]


def test_a_table_from_a_file_is_that_of_its_rows_in_the_units_of_its_first_line(tmp_path) -> None:
    (tmp_path / "torque.csv").write_text(
        "time [ms]; torque [kN*m]\n100; 0\n500; 0.008\n\n900; -0.004\n"
    )
    rows = ((0.1, 0.0), (0.5, 8.0), (0.9, -4.0))
    found = torque("table", {"file": "torque.csv"}, Point(folder=tmp_path))
    assert found == pytest.approx(torque("table", {"rows": rows}), abs=1e-13)


@for_all(
    ("text", "words"),
    [
        ("time [s], torque [N*m], more\n0, 1\n1, 2\n", "3 columns in line 1, not 2"),
        ("time [s], torque [N*m]\n0, 1\n1, 2, 3\n", "line 3: 3 columns, not 2"),
        ("time, torque [N*m]\n0, 1\n1, 2\n", "line 1: 'time' has no unit of s"),
        ("time [s], torque [N]\n0, 1\n1, 2\n", "line 1: 'torque [N]' has no unit of N*m"),
        ("0, 1\n1, 2\n2, 3\n", "line 1: '0' has no unit of s"),
        ("s, N*m\n0, 1\n0, 2\n", "line 3: the time does not rise"),
        ("s, N*m\n0, 1\n1, nan\n", "line 3: a finite torque"),
        ("s, N*m\n0, 1\n1, inf\n", "line 3: a finite torque"),
        ("s, N*m\n-1, 1\n1, 2\n", "line 2: a finite torque at a finite time from 0 on"),
        ("s, N*m\n0, 1\n1, two\n", "line 3: '1, two' is no pair of numbers"),
        ("s, N*m\n0, 1\n", "has 1 rows"),
    ],
)
def test_a_faulty_file_of_torques_is_refused_with_its_line(text: str, words: str, tmp_path) -> None:
    (tmp_path / "torque.csv").write_text(text)
    (tmp_path / "train.yaml").write_text(
        SCENE.format("events: [{at: screw, table: {file: torque.csv}}]")
    )
    with pytest.raises(InputError) as refused:
        torsion.read(tmp_path / "train.yaml")
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 4


def test_a_share_of_the_mean_torque_ends_for_a_while() -> None:
    found = torque("stop", {"share": 0.25, "ramp": 0.2, "until": 0.5}, Point(mean=40.0), time=0.5)
    inside = np.where(TIME < 1.2 - 1e-9, -10.0 * np.clip((TIME - 0.5) / 0.2, 0.0, 1.0), 0.0)
    away = np.abs(TIME - 1.2) > 1e-6
    assert found[away] == pytest.approx(inside[away], abs=1e-12)


def test_settings_of_an_event_are_said_with_their_units() -> None:
    pulsation = {"torque": "2.6 kN*m", "decay": "0.15 s"}
    start = {
        "pull_out": "3.2 kN*m",
        "slip": "12 %",
        "synchronous": "1500 rpm",
        "pulsation": pulsation,
    }
    words = settings_in_words(Event.model_validate({"at": "motor", "start": start}).body)
    for text in (
        "pull out 3200 N m",
        "slip 0.12",
        "synchronous 1500 rpm",
        "pulsation (torque 2600 N m, decay 0.15 s)",
    ):
        assert text in words
    table = settings_in_words(
        Event.model_validate(
            {"at": "motor", "table": {"rows": [["0 s", "1 N*m"], ["1 s", "2 N*m"]]}}
        ).body
    )
    assert table == "rows 2 pairs"


@pytest.mark.parametrize(
    "events",
    [
        "{at: motor-1, stop: {until: 0.2 s}}, {at: motor-1, time: 0.2 s, stop: {}}",
        "{at: motor-1, time: 0.1 s, stop: {until: 0.2 s}}, {at: motor-1, time: 0.3 s, stop: {}}",
        "{at: motor-1, stop: {share: 60 %, ramp: 0.1 s}}, {at: motor-1, time: 0.05 s, stop: {share: 40 %}}",
        "{at: motor-1, stop: {}}, {at: screw, stop: {}}",
        "{at: screw, ice: {torque: 1 kN*m, angle: 360 deg, factor: 2, turns: 2, ramp: 360 deg}}",
    ],
)
def test_events_at_the_limits_of_what_is_allowed_are_read(events: str) -> None:
    torsion.parse(SCENE.format(f"events: [{events}]"))


def test_a_stop_that_begins_before_another_ends_along_its_ramp_is_judged_where_the_first_ends() -> (
    None
):
    events = "{at: motor-1, stop: {until: 0.2 s}}, {at: motor-1, time: 0.1 s, stop: {ramp: 0.2 s}}"
    with pytest.raises(InputError, match="together end 150 % of its mean torque"):
        torsion.parse(SCENE.format(f"events: [{events}]"))


SHAKEN = """name: x
operation: {{speeds: {{from: 300 rpm, to: 900 rpm}}, rated: {{speed: 600 rpm, power: 60 kW}}}}
train:
- motor: {{name: drive, inertia: 1}}
- coupling: {{name: rubber, stiffness: 1e4, viscous: 20}}
{joint}- propeller: {{name: screw, inertia: 2, blades: 3,
    excitation: [{{blade_order: 1, torque: 50 N*m, phase: 20 deg}}]}}
analyses: {{transient: {{duration: 0.2 s{initial}}}}}
"""
JOINT = "- joint: {angle: 10 deg, inertia: [0.1, 0.1]}\n- coupling: {stiffness: 1e4, viscous: 20}\n"


def test_without_events_a_steady_vibration_goes_on_as_it_is() -> None:
    blades = "excitation: [{blade_order: 1, torque: 50 N*m, phase: 20 deg}]"
    fixed = "excitations: [{at: screw, frequency: 30 Hz, torque: 50 N*m, phase: 20 deg}]\nanalyses"
    text = (
        SHAKEN.format(joint="", initial="")
        .replace(f",\n    {blades}", "")
        .replace("analyses", fixed)
    )
    found = torsion.run(torsion.parse(text))
    (one,) = found.need(Transients).each
    steady = response(found.study, found.system, speeds=np.array([20.0 * np.pi]), refine=False)
    w = 60.0 * np.pi
    wanted = 3000.0 / np.pi + (steady.torque[0, 0, 0] * np.exp(1j * w * one.time)).real
    assert np.abs(one.torque[0] - wanted).max() < 1e-12 * np.abs(wanted).max()


@for_all(
    ("joint", "initial", "moves"),
    [
        ("", ", initial: {speed: 600 rpm}", True),
        ("", ", initial: rest", True),
        ("", ", initial: {speed: 600 rpm}, torques: none", False),
        ("", ", initial: rest, torques: none", False),
        (JOINT, ", initial: {speed: 600 rpm}, torques: none", True),
        (JOINT, ", initial: rest, torques: none", False),
    ],
)
def test_without_events_a_train_that_nothing_moves_is_refused(
    joint: str, initial: str, moves: bool
) -> None:
    text = SHAKEN.format(joint=joint, initial=initial)
    if moves:
        assert torsion.parse(text).analyses
        return
    with pytest.raises(InputError, match="nothing moves the train"):
        torsion.parse(text)
