"""Trains at random with play, friction, stages and clutches: they come to an end, and gain no energy by themselves."""

from dataclasses import dataclass

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import torsion
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.assembly import assemble

MOST_EVENTS = 20_000  # in 0.3 s
COUPLINGS = (
    "clearance: {angle: %(twist)g rad, viscous: %(damping)g}",
    "clearance: %(twist)g rad",
    "hysteresis_torque: {torque: %(friction)g, stiffness: %(stick)g}",
    "hysteresis_torque: [{torque: %(friction)g, stiffness: %(stick)g}, {torque: %(more)g, stiffness: %(stick)g}]",
    "stages: [{from: %(twist)g rad, stiffness: %(stick)g, hysteresis_torque: %(friction)g}]",
    "capacity: %(friction)g",
    "viscous: %(damping)g",
)


@dataclass(frozen=True)
class Drawn:
    """A train, and what happens to it."""

    text: str
    inertia: list[float]
    is_free: bool  # something in it parts or slips, so that its first disc may turn alone
    torque: float
    frequency: float
    wound: float  # J in the spring of a clutch that slips from the begin, beside the first disc


@st.composite
def trains(draw: st.DrawFn) -> Drawn:
    """Two to five discs; at least one coupling parts or slips."""
    number = draw(st.integers(2, 5))
    inertia = [10.0 ** (draw(st.integers(-10, 10)) / 10.0) for _ in range(number)]
    kinds = draw(st.lists(st.sampled_from(COUPLINGS), min_size=number - 1, max_size=number - 1))
    kinds[draw(st.integers(0, number - 2))] = draw(st.sampled_from(COUPLINGS[:-1]))
    rows, wound = [f"disc: {{name: d0, inertia: {inertia[0]!r}}}"], 0.0
    for place, kind in enumerate(kinds, start=1):
        figures = {
            "twist": 1e-3 * draw(st.integers(1, 30)),
            "damping": draw(st.sampled_from([0.5, 5.0, 50.0])),
            "friction": draw(st.integers(1, 200)),
            "more": draw(st.integers(1, 200)),
            "stick": 10.0 ** draw(st.integers(3, 6)),
        }
        stiffness = 10.0 ** (draw(st.integers(30, 55)) / 10.0)
        if place == 1 and kind.startswith("capacity"):
            wound = 0.5 * figures["friction"] ** 2 / stiffness
        rows.append(f"coupling: {{name: c{place}, stiffness: {stiffness!r}, {kind % figures}}}")
        rows.append(f"disc: {{name: d{place}, inertia: {inertia[place]!r}}}")
    is_free = any(kind.startswith(("clearance", "capacity")) for kind in kinds)
    torque, frequency = 10.0 * draw(st.integers(1, 50)), float(draw(st.integers(2, 60)))
    text = f"name: x\ntrain: [{', '.join(rows)}]\n"
    return Drawn(text, inertia, is_free, torque, frequency, wound)


def moved(drawn: Drawn, **body: object) -> TransientMotion:
    study = torsion.parse(drawn.text)
    chosen = TransientSettings.model_validate({"duration": 0.2, "samples": 1000, **body})
    found = transient(study, assemble(study.train, model="lumped"), chosen)
    assert found.switching is not None
    assert len(found.switching.events) < MOST_EVENTS
    assert found.residual < 1e-8
    assert all(
        one.heat >= -1e-9 * max(1e-9, energy(drawn, found).max())
        for one in found.switching.couplings
    )
    return found


def energy(drawn: Drawn, found: TransientMotion) -> np.ndarray:
    """(samples,) J of motion."""
    return np.asarray(0.5 * np.array(drawn.inertia) @ found.speed**2)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(trains().filter(lambda one: one.is_free))
def test_a_train_that_is_left_alone_gains_no_energy(drawn: Drawn) -> None:
    found = moved(drawn, initial={"speed": {"d0": "10 rad/s"}}, events=[])
    assert found.switching is not None
    assert found.switching.work == 0.0
    of_motion = energy(drawn, found)
    assert of_motion.max() <= (of_motion[0] + drawn.wound) * (1.0 + 1e-9)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(trains())
def test_a_train_that_is_shaken_has_no_more_energy_than_it_was_given(drawn: Drawn) -> None:
    shaken = {"torque": drawn.torque, "frequency": drawn.frequency, "until": 0.1}
    pulse = {"torque": 2.0 * drawn.torque, "length": 0.02}
    events = [
        {"at": "d0", "sine": shaken},
        {"at": f"d{len(drawn.inertia) - 1}", "time": 0.05, "pulse": pulse},
    ]
    found = moved(drawn, initial="rest", events=events)
    assert found.switching is not None
    given_energy = found.switching.work
    left = (
        given_energy - found.switching.damped - sum(one.heat for one in found.switching.couplings)
    )
    assert left >= -1e-8 * given_energy
    assert energy(drawn, found)[found.time > 0.1].max() <= given_energy * (1.0 + 1e-8)
