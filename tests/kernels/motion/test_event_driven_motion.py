"""Event-driven motion against closed forms, and against Taylor series of extended precision in angles of stations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from tests.kernels.motion.extended_precision import ten_stations

from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, energy_balance
from torsion.kernels.motion.loaded_modes import LoadedModes, ModalTrain, Piece
from torsion.kernels.motion.march import Chatter, March, TooManyEvents
from torsion.kernels.motion.piecewise_elements import (
    OPEN,
    Clearance,
    DelayedFriction,
    Friction,
    Switch,
)


def loaded(w, damping, elements, loads=(), force=None) -> LoadedModes:
    """A train in its modes, without torques that follow its motion."""
    size = len(damping)
    modes = ModalTrain(w, np.zeros(len(w)), damping)
    force = np.zeros((size, len(loads))) if force is None else force
    return LoadedModes(modes, loads, force, np.zeros((0, size)), tuple(elements))


def alone(
    inertia: float, stiffness: float, elements, pieces=(), viscous: float = 0.0
) -> LoadedModes:
    """A disc on a spring to ground; elements to ground are given by their other figures than `ends`."""
    shape = 1.0 / math.sqrt(inertia)
    made = tuple(kind(np.array([shape]), *figures) for kind, *figures in elements)
    w = np.array([math.sqrt(stiffness) * shape])
    return loaded(w, np.array([[viscous / inertia]]), made, [pieces], np.array([[shape]]))


def pair(first: float, second: float, element) -> tuple[LoadedModes, np.ndarray]:
    """Two free discs joined by an element alone, and their shapes (discs, motions)."""
    apart = np.array([1.0 / first, -1.0 / second]) / math.sqrt(1.0 / first + 1.0 / second)
    shape = np.stack([np.ones(2) / math.sqrt(first + second), apart], axis=1)
    kind, *figures = element
    made = kind(np.array([0.0, apart[0] - apart[1]]), *figures)
    return loaded(np.empty(0), np.zeros((2, 2)), [made]), shape


def moved(train: LoadedModes, state, duration: float, fineness=1.0, **start) -> EventDrivenMotion:
    """From rest, but for what is given."""
    none = {
        "twist": np.zeros(len(train.elements)),
        "position": np.zeros(len(train.modes.w)),
        "speed": np.zeros(train.motions),
        **start,
    }
    none["position"] = np.concatenate([np.zeros(train.modes.rigid), none["position"]])
    march = March(train, duration, **none, modes=state, fineness=fineness)
    (motion,) = march.until([duration])
    return motion


def torques(motion: EventDrivenMotion, time: np.ndarray) -> np.ndarray:
    """(elements, times) N m."""
    return motion.at(time).torque


def named(motion: EventDrivenMotion, word: str) -> list[float]:
    return [event.time for event in motion.events if event.word == word]


def test_hits_of_a_free_pair_with_backlash() -> None:
    train, shape = pair(2.0, 3.0, (Clearance, 1e5, 0.01))
    motion = moved(train, (0,), 1.0, speed=np.linalg.solve(shape, [5.0, 0.0]))
    hits = named(motion, "contact")
    assert hits[0] == pytest.approx(0.002, rel=1e-15)
    assert named(motion, "separation")[0] == pytest.approx(0.012882796185405306, rel=1e-15)
    assert hits[59] == pytest.approx(0.880084974938913, rel=1e-14)
    peak = torques(motion, np.array([(0.002 + 0.012882796185405306) / 2.0]))
    assert abs(peak[0, 0]) == pytest.approx(1732.0508075688772, rel=1e-14)
    assert shape @ motion.at(np.array([0.0129])).speed[:, 0] == pytest.approx(
        [-1.0, 4.0], rel=1e-13
    )
    assert energy_balance(motion).residual < 1e-13


def test_coulomb_friction_stops_a_disc_after_its_half_cycles() -> None:
    train = alone(1.0, 1e4, [(Friction, math.inf, 19.0)])
    motion = moved(train, (0,), 1.0, position=np.array([0.05]))
    turns = motion.at(np.array([0.0, *named(motion, "stuck")])).position[0]
    assert turns == pytest.approx([(-1.0) ** k * (0.05 - 0.0038 * k) for k in range(14)], abs=1e-16)
    assert named(motion, "stuck")[-1] == pytest.approx(0.4084070449666731, rel=1e-14)
    energy = energy_balance(motion)
    assert energy.heat[0] == pytest.approx(12.4982, rel=1e-13)
    assert energy.residual < 1e-14


def test_a_clutch_of_constant_torque_engages() -> None:
    element = (Friction, math.inf, 0.0, 0)
    train, shape = pair(5.0, 20.0, element)
    capacity = [[Piece(0.0, math.inf, 400.0)]]
    train = loaded(np.empty(0), np.zeros((2, 2)), train.elements, capacity, np.zeros((2, 1)))
    motion = moved(train, (OPEN,), 3.0, speed=np.linalg.solve(shape, [150.0, 0.0]))
    assert named(motion, "stuck") == pytest.approx([1.5], rel=1e-14)
    assert shape @ motion.at(np.array([2.0])).speed[:, 0] == pytest.approx([30.0, 30.0], rel=1e-14)
    assert energy_balance(motion).heat[0] == pytest.approx(45e3, rel=1e-14)


def test_an_imposed_twist_goes_round_the_loop_of_friction() -> None:
    w, twist, heavy = 3.0, 1e-3, 1e18  # so heavy that the friction does not move it
    wave = Piece(0.0, math.inf, 1j * heavy * twist * w**2, rate=1j * w)
    train = alone(heavy, 0.0, [(Friction, 5e4, 5.0)], [wave])
    train = loaded(np.empty(0), np.zeros((1, 1)), train.elements, train.loads, train.force)
    cycle = 2.0 * math.pi / w
    heats = [
        energy_balance(
            moved(train, (0,), cycles * cycle, speed=np.array([twist * w * math.sqrt(heavy)]))
        ).heat[0]
        for cycles in (1.25, 4.25)
    ]
    # A spring that hardly holds so heavy a disc leaves its position fewer digits.
    assert heats[1] - heats[0] == pytest.approx(3 * 0.018, rel=1e-9)


@pytest.mark.parametrize(
    ("w", "known"),
    [(112.0, 0.007296411200063338), (115.0, 0.007333007978738383), (118.0, 0.006846684865707573)],
)
def test_a_disc_with_friction_beside_its_spring_vibrates_steadily(w: float, known: float) -> None:
    train = alone(
        1.0, 1e4, [(Friction, 4e3, 20.0)], [Piece(0.0, math.inf, 10.0, rate=1j * w)], viscous=2.0
    )
    period = 2.0 * math.pi / w
    motion = moved(train, (0,), 500.0 * period)
    time = (499.0 + np.arange(256) / 256.0) * period
    place = motion.at(time).position[0]
    assert 2.0 * abs(np.mean(place * np.exp(-1j * w * time))) == pytest.approx(known, rel=5e-8)
    assert energy_balance(motion).residual < 1e-9


def test_the_first_hundred_events_of_a_train_are_those_of_extended_precision() -> None:
    reference, train = ten_stations()
    times, values = reference.run(1e-4, 100)
    motion = moved(train, (0, 0), 1.05 * times[-1])
    assert len(motion.events) >= 100
    assert [event.time for event in motion.events[:100]] == pytest.approx(times, rel=1e-11)
    known = np.array(values).T
    found = torques(motion, np.array([event.time for event in motion.events[:100]]))
    assert np.abs(found - known).max() <= 1e-9 * np.abs(known).max()
    assert energy_balance(motion).residual < 1e-12


def test_halving_the_steps_changes_nothing_but_rounding() -> None:
    train, time = ten_stations()[1], np.linspace(0.0, 1.0, 501)
    coarse, fine = (torques(moved(train, (0, 0), 1.0, fineness=one), time) for one in (1.0, 0.5))
    assert np.abs(coarse - fine).max() <= 1e-10 * np.abs(fine).max()


# Switches that are hard to see.


@pytest.mark.parametrize("depth", [1e-6, 1e-7, 1e-9])
def test_a_stop_that_is_touched_between_two_samples_is_felt(depth: float) -> None:
    """A damped disc whose first swing alone reaches a stop, for much less than a quarter of a step."""
    w, ratio = 100.0, 0.05
    own = w * math.sqrt(1.0 - ratio**2)

    def place(time: float) -> float:
        return math.exp(-ratio * w * time) * math.sin(own * time)

    top = math.acos(ratio) / own
    speed = own * (0.01 + depth) / place(top)
    hit = brentq(lambda time: speed / own * place(time) - 0.01, 0.8 * top, top, xtol=1e-16)
    stop = (Clearance(np.ones(1), 1e4, 0.01),)
    damping = np.array([[2.0 * ratio * w]])
    train = loaded(np.array([w]), damping, stop)
    felt = named(moved(train, (0,), 2.0, speed=np.array([speed])), "contact")
    assert felt == pytest.approx([hit], rel=1e-9)


def test_contact_without_a_regime_of_leaving_is_reported_as_chatter() -> None:
    class Naive(Clearance):
        def law(self, regime: int):
            law = super().law(regime)
            ends = (Switch("torque", regime, 0),) if abs(regime) == 1 else law.switches
            return replace(law, switches=ends)

        def switch(self, old: int, new: int) -> tuple[str, None]:
            return super().switch(old, new)[0], None

    train = alone(1.0, 1.0, [(Naive, 1e4, 0.01, 50.0)], [Piece(0.0, math.inf, 3.0)])
    with pytest.raises(Chatter, match="without end") as refused:
        moved(train, (0,), 10.0)
    assert refused.value.path == (0,)


def test_friction_behind_a_play_drags_its_play_along() -> None:
    wave = Piece(0.0, math.inf, 1e18j * 9.0 * 0.01, rate=3j)
    one = alone(1e18, 0.0, [(DelayedFriction, 1e4, 5.0, 2e-3)], [wave])
    train = loaded(np.empty(0), np.zeros((1, 1)), one.elements, one.loads, one.force)
    cycle = 2.0 * math.pi / 3.0
    start = np.array([0.01 * 3.0 * 1e9])
    heats = [
        energy_balance(moved(train, (0,), n * cycle, speed=start)).heat[0] for n in (1.25, 3.25)
    ]
    # it slips 2 * (amplitude - play - capacity / stiffness) twice a cycle
    assert heats[1] - heats[0] == pytest.approx(2 * 2 * 5.0 * 2.0 * (0.01 - 2e-3 - 5e-4), rel=1e-10)


@st.composite
def trains(draw) -> tuple[LoadedModes, np.ndarray]:
    """Chains in parts, with elements between and beside them, and speeds."""
    number = draw(st.integers(1, 4))
    figures = st.floats(0.1, 10.0)
    w = np.array(draw(st.lists(st.floats(10.0, 1e3), min_size=number, max_size=number)))
    size = number + 1
    elements = []
    for _ in range(draw(st.integers(1, 3))):
        ends = (
            np.array(draw(st.lists(st.integers(-200, 200), min_size=size, max_size=size))) / 100.0
        )
        kind = draw(st.sampled_from(["clearance", "friction", "slider", "delayed"]))
        if kind == "clearance":
            viscous = draw(st.sampled_from([0.0, 5.0]))
            elements.append(Clearance(ends, 1e4 * draw(figures), 1e-3 * draw(figures), viscous))
        elif kind == "delayed":
            elements.append(
                DelayedFriction(
                    ends, 1e4 * draw(figures), 5.0 * draw(figures), 1e-3 * draw(figures)
                )
            )
        else:
            ends[0] = 1.0  # sliders of alike ends could not share their torque
            stiffness = 1e4 * draw(figures) if kind == "friction" or elements else math.inf
            elements.append(Friction(ends, stiffness, 5.0 * draw(figures)))
    speed = np.array(draw(st.lists(st.integers(-300, 300), min_size=size, max_size=size))) / 100.0
    damping = np.diag(np.concatenate([[0.0], 0.02 * w]))
    return loaded(w, damping, elements), speed


@settings(max_examples=25, deadline=None, derandomize=True)
@given(trains())
def test_no_train_gains_energy_by_itself(drawn: tuple[LoadedModes, np.ndarray]) -> None:
    train, speed = drawn
    state = tuple(
        int(np.sign(one.ends @ speed))
        if isinstance(one, Friction) and math.isinf(one.stiffness)
        else 0
        for one in train.elements
    )
    try:
        motion = moved(train, state, 0.5, speed=speed)
    except (Chatter, TooManyEvents):
        return  # elements that switch without end are refused in words
    energy = energy_balance(motion)
    assert energy.residual < 1e-8
    assert energy.stored <= 1e-9 * 0.5 * float(speed @ speed)
    assert (energy.heat >= -1e-9 * 0.5 * float(speed @ speed)).all()
