"""The sense of a torque: loads in both senses of rotation, and a worst phase beside a mean torque of either sign."""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from tests.analyses.motion.test_given_cases import moved

from torsion.analyses.motion.derived.worst_case import over_phases, worst_motion
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.arrays import FloatArray

LOADS = {
    "from nothing": [["0 rpm", 0.0], ["100 rpm", 60.0], ["200 rpm", 300.0]],
    "falling": [["0 rpm", 20.0], ["50 rpm", 5.0], ["200 rpm", 40.0]],
}


@pytest.mark.parametrize("law", [*LOADS.values(), "propeller"], ids=[*LOADS, "propeller"])
def test_a_load_brakes_alike_in_both_senses_of_rotation(law: object) -> None:
    """The mirrored torque makes the mirrored motion."""

    def speed(torque: float) -> FloatArray:
        load = (
            {"law": law, "torque": 80.0, "speed": "100 rpm"} if law == "propeller" else {"law": law}
        )
        events = [{"at": "d", "step": {"torque": torque, "until": 0.6}}, {"at": "d", "load": load}]
        body = {"duration": 1.5, "initial": "rest", "events": events, "tolerance": 1e-9}
        return moved("disc: {name: d, inertia: 5}", body).speed[0]

    forward, backward = speed(90.0), speed(-90.0)
    assert forward.max() > 5.0
    np.testing.assert_allclose(backward, -forward, atol=1e-6)


def test_a_load_in_proportion_to_the_speed_ends_a_run_up_on_either_side() -> None:
    """Linear between its rows: J v' = T - c v, from rest to either side."""
    for sign in (1.0, -1.0):
        load = {"law": [["0 rpm", 0.0], ["3000 rpm", 100.0 * math.pi * 4.0]]}  # 4 N m s/rad
        events = [{"at": "d", "step": {"torque": sign * 90.0}}, {"at": "d", "load": load}]
        body = {"duration": 1.0, "initial": "rest", "events": events, "tolerance": 1e-9}
        found = moved("disc: {name: d, inertia: 5}", body).speed[0, -1]
        assert found == pytest.approx(sign * 90.0 / 4.0 * (1.0 - math.exp(-4.0 / 5.0)), rel=1e-9)


OPEN = {  # a start whose phase is open
    "duration": 1.0,
    "events": [
        {
            "at": "d",
            "start": {
                "torque": [["0 rpm", 1.0], ["100 rpm", 1.0]],
                "synchronous": "1500 rpm",
                "slip_pulsation": [["0 rpm", 1.0], ["100 rpm", 1.0]],
            },
        }
    ],
}


@dataclass(frozen=True)
class Superposed:
    """A motion whose torques (spans, samples) are a mean torque and a wave of the phase."""

    torque: FloatArray
    switching: None = None
    unresolved: float = 0.0

    @property
    def peak(self) -> FloatArray:
        """(spans,) N m."""
        return np.abs(self.torque).max(axis=1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_worst_phase_adds_to_a_mean_torque_of_either_sense(sign: float) -> None:
    """Of mean + Re(wave exp(-i phase)) no phase gives more than |mean| + |wave|, and the worst one gives that."""
    time = np.linspace(0.0, 1.0, 200)
    mean = sign * np.array([300.0 * time, -500.0 * (1.0 - time)])
    wave = np.array([80.0 * time * np.exp(9j * time), (50.0 + 20.0j) * np.exp(-4j * time)])
    settings = TransientSettings.model_validate(OPEN)

    def solve(given: TransientSettings) -> Superposed:
        return Superposed(mean + np.real(wave * np.exp(-1j * given.events[0].body.phase)))

    for span in range(2):
        limit = np.where(np.arange(2) == span, 100.0, np.nan)
        phases, worst = over_phases(settings, solve, limit)[0]
        assert worst.peak[span] == pytest.approx(
            (np.abs(mean) + np.abs(wave))[span].max(), rel=2e-4
        )  # phases are 2 deg apart, and cos 1 deg is 1 - 1.5e-4
        assert len(phases) == 1


@pytest.mark.parametrize(("harmonic", "doubt"), [(2, 0.0), (17, 80.0)])
def test_what_no_number_of_phases_says_is_added_to_the_peak(harmonic: int, doubt: float) -> None:
    settings = TransientSettings.model_validate(OPEN)

    def solve(given: TransientSettings) -> Superposed:
        wave = np.cos(harmonic * given.events[0].body.phase)
        return Superposed(np.array([[300.0 + 100.0 * wave]]))

    _, worst = over_phases(settings, solve, np.full(1, np.nan))[0]
    assert worst.peak == pytest.approx([400.0], rel=2e-4)
    assert np.max(worst.unresolved) >= doubt
    assert (np.max(worst.unresolved) > 0.0) == (doubt > 0.0)


def test_the_motion_of_several_phases_has_the_ends_and_the_doubts_of_the_worst_of_them() -> None:
    parts = "disc: {name: d, inertia: 2}, coupling: {stiffness: 1e4, clearance: 0.02 rad}, disc: {inertia: 3}"
    found = moved(parts, {"duration": 0.2, "initial": {"speed": {"d": "5 rad/s"}}})
    assert found.switching is not None
    several = [(0.9, 1e-5, None), (0.4, 3e-5, 7.0), (None, 2e-5, None), (0.7, 0.0, 4.0)]
    doubts = itertools.cycle(several)
    # greatest and when, least and when, left in the series
    ends = itertools.cycle(
        [(50.0, 0.1, -30.0, 0.2, 0.1), (20.0, 0.3, -90.0, 0.4, 0.3), (70.0, 0.5, -10.0, 0.6, 0.2)]
    )

    def solve(given: TransientSettings) -> TransientMotion:
        late, change, scatter = next(doubts)
        torque = found.torque + 10.0 * np.cos(given.events[0].body.phase)
        switching = replace(
            found.switching,
            sensitive_after=late,
            band_change=change,
            scatter=None if scatter is None else np.full(1, scatter),
        )
        *turns, left = next(ends)
        names = "greatest", "greatest_at", "least", "least_at"
        extremes = {name: np.full(1, value) for name, value in zip(names, turns, strict=True)}
        return replace(
            found,
            torque=torque,
            unresolved=np.full(1, change),
            switching=switching,
            left_in_series=left,
            **extremes,
        )

    settings = TransientSettings.model_validate(OPEN)
    worst = worst_motion(settings, solve, np.full(1, np.nan), np.ones(1), ())
    assert worst.switching is not None
    count = worst.phases_computed
    assert count >= 3
    assert (worst.greatest, worst.greatest_at) == (70.0, 0.5)
    assert (worst.least, worst.least_at) == (-90.0, 0.4)
    assert worst.left_in_series == 0.3
    assert worst.switching.sensitive_after == 0.4
    assert worst.switching.band_change == 3e-5
    assert worst.switching.scatter == pytest.approx([7.0])
    assert worst.unresolved == pytest.approx([3e-5])


def test_finer_times_of_reclosing_are_those_of_the_worst_senses() -> None:
    """The torque grows toward 0.22 s, and is the greater where the fault brakes first."""
    found = moved(
        "disc: {name: d, inertia: 2}, coupling: {stiffness: 1e4}, disc: {inertia: 3}",
        {"duration": 0.1},
    )
    fault = {
        "coefficients": {"line": 1.0},
        "decay": [0.1, 0.1],
        "clear": 0.15,
        "reclose": [0.2, 0.24],
    }
    settings = TransientSettings.model_validate(
        {"duration": 1.0, "events": [{"at": "d", "short-circuit": fault}]}
    )
    computed = list[tuple[str, float]]()

    def solve(given: TransientSettings) -> TransientMotion:
        body = given.events[0].body
        computed.append((body.sense, body.reclose[0]))
        torque = 9.0 - 100.0 * abs(body.reclose[0] - 0.22) + (body.sense == "brakes")
        return replace(found, greatest=np.full(1, torque))

    worst = worst_motion(settings, solve, np.full(1, np.nan), np.full(1, 5.0), ())
    assert {sense for sense, _ in computed} == {"drives", "brakes"}
    assert len(set(computed)) == len(computed) == worst.faults_computed
    sense, time = max(
        computed, key=lambda pair: (pair[0] == "brakes") - 100.0 * abs(pair[1] - 0.22)
    )
    assert worst.worst_fault == f"it {sense} first, reclosed after {time:.6g} s"
