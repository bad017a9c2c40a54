"""Peaks, turns and verdicts where a torque is faster than the modes of the train."""

import math

import numpy as np
import pytest

import torsion
from torsion.analyses.motion.curves.peaks import Wave, looked_at, turns_within
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.errors import InputError
from torsion.rules.verdict_line import Check, Checks

RIGID = """disc: {name: a, inertia: 10}, coupling: {name: rigid, flexibility: 0, max_torque: 1 kN*m},
  disc: {name: b, inertia: 1}, coupling: {name: soft, stiffness: 1000%s}, disc: {name: c, inertia: 10}"""
VISCOUS = """disc: {name: b, inertia: 0.01}, coupling: {name: rigid, stiffness: 10, viscous: 100, max_torque: 50 kN*m},
  disc: {name: c, inertia: 10}"""
PULSE = "time: 1.0003 s, pulse: {torque: 100 kN*m, length: 1 ms}"
SINE = "sine: {torque: 100 kN*m, frequency: 1000 Hz}"


def solved(train: str, body: str, operation: str = "") -> tuple[TransientMotion, tuple[Check, ...]]:
    """The motion, and its verdicts."""
    text = f"name: x\n{operation}train: [{train}]\nanalyses:\n  transient: {{{body}}}\n"
    found = torsion.run(torsion.parse(text))
    return found.need(Transients).each[0], found.need(Checks).lines


@pytest.mark.parametrize(
    ("train", "event", "peak"),
    [
        (RIGID % "", PULSE, 1e5 / 1.1),
        (RIGID % ", clearance: 1 deg", PULSE, 1e5 / 1.1),
        (RIGID % "", SINE, 1e5 / 1.1),
        (RIGID % ", clearance: 1 deg", SINE, 1e5 / 1.1),
        (VISCOUS, PULSE, 95389.8),
    ],
)
def test_a_torque_faster_than_the_modes_is_seen(train: str, event: str, peak: float) -> None:
    found, lines = solved(train, f"duration: 10 s, events: [{{at: b, {event}}}]")
    assert found.peak[0] == pytest.approx(peak, rel=1.5e-3)
    assert lines[0].verdict == "fail"


def test_a_steady_vibration_far_above_the_modes_is_seen() -> None:
    train = """motor: {name: m, inertia: 1, ripple: [{order: 60, torque: 100 N*m, phase: 90 deg}]},
      coupling: {name: rigid, flexibility: 0, max_torque: 150 N*m}, disc: {inertia: 10},
      coupling: {stiffness: 1000, viscous: 10}, propeller: {name: c, inertia: 10}"""
    operation = "operation: {rated: {speed: 1000 rpm, power: 10 kW}, load: constant}\n"
    found, lines = solved(
        train, "duration: 0.1 s, events: [{at: c, time: 0.09 s, step: {torque: -1 N*m}}]", operation
    )
    assert found.greatest[0] == pytest.approx(95.493 + 100.0 / 1.1, rel=1e-3)
    assert lines[0].verdict == "fail"


def test_what_too_many_times_would_need_is_not_passed_over() -> None:
    found, lines = solved(
        RIGID.replace("1 kN", "9 MN") % "",
        "duration: 1e5 s, events: [{at: b, sine: {torque: 1e5, frequency: 1 kHz}}]",
    )
    assert found.peak[0] > 1e5 / 1.1 * 0.99
    assert "too fast" in found.status
    assert lines[0].verdict == "fail"
    assert "never a pass" in lines[0].note


def test_waves_are_looked_at_while_they_last() -> None:
    looked = looked_at(
        np.linspace(0.0, 1.0, 11),
        1,
        np.array([0.5]),
        [Wave(0.5, 0.6, 2e3 * math.pi)],
        0.0,
        1e4,
        4.0,
    )
    assert np.diff(looked.time[(looked.time > 0.5) & (looked.time < 0.6)]).max() < 2.51e-4
    assert np.count_nonzero(looked.time < 0.5) < 30
    assert looked.time[looked.sample].tolist() == np.linspace(0.0, 1.0, 11).tolist()


def test_turns_are_those_of_the_curve() -> None:
    time = np.linspace(0.0, 2.0 * math.pi, 60)
    curve, value = turns_within(time, np.sin([time, time + 0.5]), np.cos([time, time + 0.5]))
    assert curve.tolist() == [0] * 4 + [1] * 4
    assert value == pytest.approx(
        [0.0, 1.0, -1.0, 0.0, math.sin(0.5), 1.0, -1.0, math.sin(0.5)], abs=1e-6
    )


def test_damage_does_not_depend_on_the_samples() -> None:
    train = "disc: {name: a, inertia: 1}, coupling: {stiffness: 1e6}, disc: {name: b, inertia: 1}"
    events = "events: [{at: b, sine: {torque: 300 N*m, frequency: 220 Hz}}]"
    body = "duration: 5 s, fatigue: {amplitude: 100 N*m, cycles: 1e6, slope: 5}, " + events
    (few, lines), (many, _) = (
        solved(train, body + f", samples: {samples}") for samples in (100, 300_000)
    )
    assert few.damage == pytest.approx(many.damage, rel=1e-3)
    assert few.reversals == many.reversals
    assert lines[0].clause == "D"
    assert lines[0].verdict == "fail"


def test_a_jump_is_one_half_cycle_without_overshoot() -> None:
    train = "disc: {name: a, inertia: 1}, coupling: {flexibility: 0}, disc: {name: b, inertia: 1}"
    table = "{at: b, time: 0.2505 s, table: {rows: [[0 s, 200 N*m], [0.5 s, 199 N*m]]}}"
    found, lines = solved(
        train,
        f"duration: 1 s, fatigue: {{amplitude: 100 N*m, cycles: 1, slope: 5}}, events: [{table}]",
    )
    assert found.damage[0] == pytest.approx(0.5**5, rel=1e-12)
    assert lines[0].verdict == "pass"


def test_damage_of_a_point_is_refused() -> None:
    train = "disc: {name: a, inertia: 1}, coupling: {name: k, stiffness: 1e6}, disc: {name: b, inertia: 1}"
    fatigue = "fatigue: {amplitude: 100 N*m, cycles: 1e6, slope: 5, at: b}"
    with pytest.raises(InputError, match="'b' is a disc, and no torque goes through it") as refused:
        solved(train, f"duration: 1 s, {fatigue}, events: [{{at: b, step: {{torque: 1}}}}]")
    assert refused.value.faults[0].path[-2:] == ("fatigue", "at")


def test_a_doubtful_motion_never_passes() -> None:
    train = """disc: {name: a, inertia: 1e-6}, coupling: {name: k, stiffness: 1e9, max_torque: 150 N*m},
      disc: {inertia: 1e6}, coupling: {stiffness: 0.1, hysteresis_torque: 1}, disc: {inertia: 1}"""
    found, lines = solved(train, "duration: 10 s, events: [{at: a, step: {torque: 100 N*m}}]")
    assert found.status != "ok"
    assert lines[0].value < lines[0].limit
    assert lines[0].verdict == "fail"
    assert "never a pass" in lines[0].note


def test_a_loss_factor_shares_in_the_torque_of_a_settled_resonance() -> None:
    train = """motor: {name: m, inertia: 1}, coupling: {stiffness: 5000, loss_factor: 0.6}, disc: {inertia: 1}"""
    sine = "sine: {torque: 100 N*m, frequency: %r Hz}" % (100.0 / (2.0 * math.pi))
    found, _ = solved(train, f"duration: 5 s, initial: rest, events: [{{at: m, {sine}}}]")
    settled = np.abs(found.torque[0, found.time > 3.0]).max()
    assert settled == pytest.approx(100.0 / 2.0 / 0.6 * math.hypot(1.0, 0.6), rel=2e-3)
