"""Dry friction that holds, lets go and catches again, against closed forms and an integration from event to event."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.analyses.motion.test_given_cases import chain, moved

import torsion
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.assembly import assemble
from torsion.kernels.motion.event_driven_motion import (
    EnergyBalance,
    EventDrivenMotion,
    energy_balance,
)
from torsion.kernels.motion.loaded_modes import ModalTrain


def integrated(
    inertia: Sequence[float],
    spring: tuple[float, float],
    friction: Sequence[float],
    torque: Callable[[float], Sequence[float]],
    duration: float,
    cuts: Sequence[float] = (),
    drive: Callable[[float], tuple[float, float]] | None = None,
) -> tuple[list[float], np.ndarray]:
    """Times at which discs let go or catch, and torques of the springs at 20 001 times, by Runge-Kutta from event to
    event: discs in a row with springs of one stiffness and damping, and one before the first to an angle and speed
    that are given."""
    number, (k, c) = len(inertia), spring
    j, most = np.array(inertia), np.array(friction)

    def springs(t: float, y: np.ndarray) -> np.ndarray:
        angle, speed = y[:number], y[number:]
        own = k * -np.diff(angle) - c * np.diff(speed)
        if drive is None:
            return np.concatenate([[0.0], own, [0.0]])
        return np.concatenate(
            [[k * (drive(t)[0] - angle[0]) + c * (drive(t)[1] - speed[0])], own, [0.0]]
        )

    def net(t: float, y: np.ndarray) -> np.ndarray:
        return np.array(torque(t)) - np.diff(springs(t, y))

    t, y, mode, when = 0.0, np.zeros(2 * number), np.zeros(number), list[float]()
    wanted, found = np.linspace(0.0, duration, 20_001), list[np.ndarray]()
    while t < duration:
        end = min(one for one in (*cuts, duration) if one > t)
        here = mode.copy()

        def rates(t: float, y: np.ndarray, here: np.ndarray = here) -> np.ndarray:
            gain = np.where((here == 0.0) & (most > 0.0), 0.0, (net(t, y) - here * most) / j)
            return np.concatenate([y[number:], gain])

        def event(
            disc: int, since: float = t, here: np.ndarray = here
        ) -> Callable[[float, np.ndarray], float]:
            def margin(at: float, place: np.ndarray) -> float:
                if here[disc] == 0.0:
                    return float(most[disc] - abs(net(at, place)[disc]))
                return float(here[disc] * place[number + disc]) if at > since + 1e-7 else 1.0

            margin.terminal, margin.direction = True, -1.0
            return margin

        events = [event(disc) for disc in np.flatnonzero(most).tolist()]
        longest = (end - t) / 20.0
        solved = solve_ivp(
            rates,
            (t, end),
            y,
            "DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=events,
            dense_output=True,
            max_step=longest,
        )
        inside = wanted[(wanted >= t) & (wanted < solved.t[-1])]
        states = solved.sol(inside).T if inside.size else ()
        found += [springs(float(one), state) for one, state in zip(inside, states, strict=True)]
        t, y = float(solved.t[-1]), solved.y[:, -1].copy()
        if solved.status == 1 or t in cuts:
            for disc in np.flatnonzero(most).tolist():
                if here[disc] != 0.0 and solved.status == 1 and abs(y[number + disc]) < 1e-9:
                    y[number + disc] = 0.0
                    mode[disc] = 0.0
            acting = net(t, y)
            for disc in np.flatnonzero((mode == 0.0) & (most > 0.0)).tolist():
                if abs(acting[disc]) >= most[disc] * (1.0 - 1e-12):
                    mode[disc] = np.sign(acting[disc])
            if (mode != here).any():
                when.append(t)
    return when, np.array(found)[:, 1 if drive is None else 0]


def pulse(t: float, begin: float = 0.5) -> float:
    """N m: half a sine of 40 ms."""
    return 3e3 * math.sin(math.pi * (t - begin) / 0.04) if begin < t < begin + 0.04 else 0.0


HELD = chain([6.0, 45.0], [4e4], ", viscous: 40")


def held_motor(duration: float, load: dict, first: dict) -> TransientMotion:
    """A motor that a brake holds, and a pulse at the other end of its spring."""
    events = [
        {"at": "d1", **first},
        {"at": "d1", "load": load},
        {"at": "d2", "time": 0.5, "pulse": {"torque": 3e3, "length": 0.04}},
    ]
    return moved(
        HELD,
        {
            "duration": duration,
            "initial": "rest",
            "events": events,
            "tolerance": 1e-9,
            "samples": 20_000,
        },
    )


@pytest.mark.parametrize("share", [2.0 / 3.0, 29.0 / 30.0])
def test_a_motor_that_a_brake_holds_breaks_away_and_is_caught(share: float) -> None:
    table = {"torque": [["0 rpm", 3e3 * share], ["1500 rpm", 3e3 * share]]}
    found = held_motor(
        1.0, {"law": "constant", "torque": 3e3, "speed": "1500 rpm"}, {"start": table}
    )
    when, torque = integrated(
        [6.0, 45.0],
        (4e4, 40.0),
        [3e3, 0.0],
        lambda t: [3e3 * share, pulse(t)],
        1.0,
        cuts=[0.5, 0.54],
    )
    assert [one.time for one in found.changes] == pytest.approx(when, abs=2e-9)
    assert np.abs(found.torque[0, : len(torque)] - torque).max() <= 1e-8 * np.abs(torque).max()
    assert found.peak[0] == pytest.approx(np.abs(torque).max(), rel=1e-6)
    assert found.steps < 200
    assert found.status == "ok"


def test_a_disc_that_is_held_waits_for_the_ramp_to_reach_its_friction() -> None:
    rows = [["0 s", 0.0], ["2 s", 100.0]]
    events = [
        {"at": "d", "table": {"rows": rows}},
        {"at": "d", "load": {"law": "constant", "torque": 30, "speed": "9 rad/s"}},
    ]
    found = moved(
        "disc: {name: d, inertia: 2}", {"duration": 2.0, "initial": "rest", "events": events}
    )
    assert found.changes[0].time == pytest.approx(0.6, rel=1e-13)
    late = np.maximum(found.time - 0.6, 0.0)
    assert found.speed[0] == pytest.approx(50.0 * late**2 / 4.0, rel=1e-12, abs=1e-13)


def test_an_oscillation_with_dry_friction_stops_after_the_half_cycles_that_coulomb_gives() -> None:
    # half a cycle loses 2 F/k: released at 0.0105 rad with F/k = 0.001 it turns at 0.0085, ..., and stops at 0.0005
    parts = "motor: {name: m, held: true}, coupling: {name: c, stiffness: 1e4}, disc: {name: d, inertia: 4}"
    load = {"law": "constant", "torque": 10, "speed": "1 rad/s"}
    half = math.pi / 50.0
    body = {
        "duration": 20 * half,
        "initial": {"torque": {"c": 105.0}},
        "events": [{"at": "d", "load": load}],
    }
    found = moved(parts, {**body, "tolerance": 1e-10, "samples": 2000})
    assert found.changes[-1].time == pytest.approx(5 * half, rel=1e-9)
    assert abs(found.torque[0, -1]) == pytest.approx(5.0, rel=1e-8)
    assert np.abs(found.torque[0, :600:100]) == pytest.approx(
        [105.0, 85.0, 65.0, 45.0, 25.0, 5.0], rel=1e-9
    )


def falling(speed: float) -> float:
    """N m over rad/s."""
    return 10.0 - 4.0 * min(abs(speed) / math.pi, 1.0)


@pytest.mark.parametrize(("inertia", "duration", "least"), [(0.01, 2.0, 40), (1e-4, 1.0, 45)])
def test_a_light_disc_sticks_and_slips_as_runge_kutta_has_it(
    inertia: float, duration: float, least: int
) -> None:
    parts = "motor: {name: m, held: true}, coupling: {name: c, stiffness: 100, viscous: 0.01}, "
    program = {"program": [["0 s", "0 rpm"], ["0.1 s", "20 rpm"]]}
    load = {"law": [["0 rpm", 10.0], ["30 rpm", 6.0], ["9000 rpm", 6.0]]}
    events = [{"at": "m", "speed": program}, {"at": "d", "load": load}]
    body = {"duration": duration, "initial": "rest", "events": events}
    found = moved(parts + f"disc: {{name: d, inertia: {inertia}}}", body)
    highest, slips = slipping(inertia, duration)
    assert found.peak[0] == pytest.approx(highest, rel=1e-6)
    assert len(slips) > least
    times = np.array([one.time for one in found.changes])
    assert max(float(np.abs(times - one).min()) for one in slips) < 1e-6
    assert found.steps < 1100


def slipping(inertia: float, duration: float) -> tuple[float, list[float]]:
    """The greatest torque of the spring and the times at which the disc lets go or catches."""
    rate = 20.0 * math.pi / 30.0 / 0.1

    def spring(t: float, y: np.ndarray) -> float:
        early = min(t, 0.1)
        angle = rate * (early**2 / 2.0 + 0.1 * max(t - 0.1, 0.0))
        return 100.0 * (angle - y[0]) + 0.01 * (rate * early - y[1])

    t, y, sticks, highest, when = 0.0, np.zeros(2), True, 0.0, list[float]()
    while t < duration:
        end, since = (0.1 if t < 0.1 else duration), t

        def rates(t: float, y: np.ndarray, sticks: bool = sticks) -> list[float]:
            return [0.0, 0.0] if sticks else [y[1], (spring(t, y) - falling(y[1])) / inertia]

        def margin(t: float, y: np.ndarray, sticks: bool = sticks, since: float = since) -> float:
            return 10.0 - spring(t, y) if sticks else y[1] if t > since + 1e-9 else 1.0

        margin.terminal, margin.direction = True, -1.0
        longest = 1e-3 if sticks else np.inf
        solved = solve_ivp(
            rates,
            (t, end),
            y,
            "DOP853",
            rtol=1e-12,
            atol=1e-14,
            events=margin,
            max_step=longest,
            dense_output=True,
        )
        within = np.linspace(t, solved.t[-1], 400)
        states = solved.sol(within).T
        highest = max(highest, *map(spring, within.tolist(), states))
        t, y = float(solved.t[-1]), solved.y[:, -1].copy()
        if solved.status == 1:
            when.append(t)
            y[1], sticks = 0.0, not sticks
    return highest, when


def test_a_sine_torque_breaks_a_disc_away_in_both_senses() -> None:
    events = [
        {"at": "d1", "sine": {"torque": 1500, "frequency": "5 Hz"}},
        {"at": "d1", "load": {"law": "constant", "torque": 300, "speed": "1500 rpm"}},
        {"at": "d2", "load": {"law": "constant", "torque": 800, "speed": "1500 rpm"}},
    ]
    body = {
        "duration": 1.0,
        "initial": "rest",
        "events": events,
        "tolerance": 1e-9,
        "samples": 20_000,
    }
    found = moved(HELD, body)
    when, torque = integrated(
        [6.0, 45.0],
        (4e4, 40.0),
        [300.0, 800.0],
        lambda t: [1500.0 * math.sin(10.0 * math.pi * t), 0.0],
        1.0,
    )
    times = np.array([one.time for one in found.changes])
    assert max(float(np.abs(times - one).min()) for one in when) < 1e-8
    assert np.abs(found.torque[0, : len(torque)] - torque).max() <= 1e-8 * np.abs(torque).max()


@pytest.mark.parametrize("ratio", [1, 3])
def test_two_frictions_that_turn_as_one_hold_together_and_share_the_torque(ratio: int) -> None:
    parts = f"motor: {{name: m, inertia: 2}}, gear: {{teeth: [20, {20 * ratio}]}}, disc: {{name: d, inertia: 9}}"
    load = {"law": "constant", "speed": "100 rad/s"}
    events = [
        {"at": "m", "table": {"rows": [["0 s", 0.0], ["2 s", 100.0]]}},
        {"at": "m", "load": {**load, "torque": 10}},
        {"at": "d", "load": {**load, "torque": 30}},
    ]
    found = moved(parts, {"duration": 2.0, "initial": "rest", "events": events})
    hold = 10.0 + 30.0 / ratio
    assert found.changes[0].time == pytest.approx(hold / 50.0, rel=1e-12)
    inertia = 2.0 + 9.0 / ratio**2
    assert found.speed[0, -1] == pytest.approx(25.0 / inertia * (2.0 - hold / 50.0) ** 2, rel=1e-11)
    before = found.time < 0.9 * hold / 50.0
    carried = 50.0 * found.time * (30.0 / ratio) / hold  # of each friction its share
    assert found.torque[0, before] == pytest.approx(carried[before], abs=1e-9)


def test_a_load_that_ends_lets_go_of_what_it_held() -> None:
    brake = {"law": "constant", "torque": 3e3, "speed": "1500 rpm", "off": 0.4}
    events = [{"at": "d", "step": {"torque": 100}}, {"at": "d", "load": brake}]
    found = moved(
        "disc: {name: d, inertia: 2}", {"duration": 1.0, "initial": "rest", "events": events}
    )
    assert found.speed[0] == pytest.approx(50.0 * np.maximum(found.time - 0.4, 0.0), abs=1e-12)


def test_three_frictions_on_two_modes_stay_solvable() -> None:
    events = [
        {"at": "d1", "step": {"torque": 100}},
        *(
            {"at": f"d{k}", "load": {"law": "constant", "torque": 50, "speed": "100 rad/s"}}
            for k in (1, 2, 3)
        ),
    ]
    parts = chain([1.0, 2.0, 3.0], [1e4, 1e4], ", viscous: 20")
    found = moved(parts, {"duration": 1.0, "initial": "rest", "events": events, "modes": 1})
    assert abs(found.speed[:, -1]).max() < 1e-6


PUMP = """
name: x
operation: {rated: {speed: 1480 rpm, power: 400 kW}, load: propeller}
train:
- motor: {name: m, inertia: 9}
- coupling: {name: c, stiffness: 180 kN*m/rad, loss_factor: 0.05, max_torque: 8 kN*m}
- propeller: {name: p, inertia: 3}
"""


@pytest.mark.parametrize("law", ["propeller", "constant"])
def test_a_steady_train_whose_load_follows_it_is_found_to_be_in_balance(law: str) -> None:
    found = pump({"duration": 3.0, "events": [{"at": "p", "load": {"law": law}}]})
    assert found.residual < 1e-12
    assert found.status == "ok"
    assert found.torque[0] == pytest.approx(
        np.full(len(found.time), 4e5 / (1480.0 * math.pi / 30.0)), rel=1e-12
    )


def pump(body: dict) -> TransientMotion:
    """Of the pump train."""
    study = torsion.parse(PUMP)
    return transient(
        study, assemble(study.train, model="lumped"), TransientSettings.model_validate(body)
    )


def test_a_motor_that_is_held_from_the_begin_leaves_no_torque_and_no_reversals() -> None:
    start = {
        "pull_out": 3200,
        "slip": 0.12,
        "synchronous": "1500 rpm",
        "pulsation": {"torque": 2600, "decay": 0.15},
    }
    events = [
        {"at": "d1", "start": start},
        {"at": "d1", "load": {"law": "constant", "torque": 2e4, "speed": "157 rad/s"}},
    ]
    found = moved(HELD, {"duration": 3.0, "initial": "rest", "events": events})
    assert found.status == "ok"
    assert found.peak[0] < 1e-6 * 2e4
    assert found.reversals.tolist() == [0]


def test_a_run_down_counts_the_reversals_that_its_accuracy_shows() -> None:
    events = [
        {"at": "m", "time": 0.5, "stop": {}},
        {"at": "p", "load": {"law": "propeller"}},
        {"at": "p", "time": 0.5, "load": {"law": "constant", "torque": 90}},
    ]
    found = pump({"duration": 30.0, "events": events})
    # at rest the motor swings against the pump, from 65 N m to 1e-6 of 2581 N m, at half the frequency of both free:
    # with what damps that, 0.025, its damping ratio is half of it
    assert found.status == "ok"
    assert found.reversals[0] == pytest.approx(
        math.log(65.0 / 2.58e-3) / (math.pi * 0.0125), rel=0.1
    )


def test_the_balance_of_a_steady_train_still_shows_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def planted(moved: EventDrivenMotion) -> EnergyBalance:
        modes = moved.train.modes
        softer = ModalTrain(modes.w * (1.0 + 1e-5), modes.ratio, modes.viscous)
        train = replace(moved.train, modes=softer)
        regimes = tuple(replace(regime, train=train) for regime in moved.regimes)
        return energy_balance(replace(moved, train=train, regimes=regimes))

    monkeypatch.setattr("torsion.analyses.motion.motion_from_events.energy_balance", planted)
    events = [
        {"at": "p", "load": {"law": "propeller"}},
        {"at": "p", "sine": {"torque": 30, "frequency": "40 Hz"}},
    ]
    found = pump({"duration": 3.0, "events": events})
    assert found.residual > 1e-8
    assert "report this train" in found.status
