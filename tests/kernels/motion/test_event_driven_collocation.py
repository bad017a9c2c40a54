"""Torques that follow the motion beside play and friction, against Runge-Kutta steps from event to event."""

import math
from collections.abc import Sequence

import numpy as np
from tests.kernels.motion.piecewise_discs import Discs

from torsion.kernels.motion import torque_laws as laws
from torsion.kernels.motion.collocation import Marched, Scheme
from torsion.kernels.motion.energy_balance import energy_balance
from torsion.kernels.motion.event_driven_collocation import Interfaces, event_driven_under_laws
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, March
from torsion.kernels.motion.generated_signals import Signals
from torsion.kernels.motion.piecewise_elements import Clearance, Friction
from torsion.kernels.motion.piecewise_train import PiecewiseTrain
from torsion.kernels.motion.torque_history import Piece

SYNCHRONOUS = 50.0 * math.pi


def solved(
    discs: Discs,
    found: Sequence[laws.BySpeed],
    duration: float,
    *,
    speed: Sequence[float] = (),
    tolerance: float = 1e-9,
    fineness: float = 1.0,
    pieces: tuple[tuple[int, tuple[Piece, ...]], ...] = (),
) -> tuple[PiecewiseTrain, EventDrivenMotion, Marched, np.ndarray]:
    """The same train in its modes: laws act at the discs of `acting`, and pieces at others."""
    inertia, size = np.array(discs.inertia), len(discs.inertia)
    stiffness, damping = np.zeros((2, size, size))
    for a, b, k, c in discs.springs:
        row = np.eye(size)[a] - np.eye(size)[b]
        stiffness += k * np.outer(row, row)
        damping += c * np.outer(row, row)
    root = 1.0 / np.sqrt(inertia)
    square, vectors = np.linalg.eigh(root[:, None] * stiffness * root)
    rigid = int(np.count_nonzero(square < 1e-9 * square.max(initial=1.0)))
    shape, w = root[:, None] * vectors, np.sqrt(np.maximum(square[rigid:], 0.0))
    elements = []
    for kind, a, b, k, level, *viscous in discs.elements:
        ends = shape[a] - shape[b]
        elements.append(
            Clearance(ends, k, level, *viscous) if kind == "play" else Friction(ends, k, level(0.0))
        )
    at = [disc for disc, _ in discs.acting]
    given = [one for one, _ in pieces]
    signals = Signals(tuple(one for _, one in pieces), len(at), 1.0 / max([*w.tolist(), 100.0]))
    force = shape[[*given, *at]].T.astype(complex)
    train = PiecewiseTrain(w, shape.T @ damping @ shape, tuple(elements), signals, force)
    march = March(train, duration, fineness)
    v = shape.T @ (inertia * np.array(speed)) if len(speed) else np.zeros(size)
    z = train.at_first(np.zeros(len(elements)), np.zeros(len(w)), v)

    def carrier(time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        none = np.zeros((len(at), len(time)))
        return none, none, none

    interfaces = Interfaces(shape[at], np.arange(len(at)), carrier, np.zeros(len(w)))
    scheme = Scheme(
        duration,
        tolerance,
        duration / 1024.0,
        duration / 8.0 * fineness,
        np.ones(len(at)),
        tuple(signals.breaks),
    )
    motion, how = event_driven_under_laws(march, (0,) * len(elements), z, interfaces, found, scheme)
    return train, motion, how, shape


def torques(
    discs: Discs,
    train: PiecewiseTrain,
    motion: EventDrivenMotion,
    shape: np.ndarray,
    time: np.ndarray,
) -> np.ndarray:
    """(springs and elements, times) N m."""
    z, regime = motion.at(time)
    _, place, speed, _, _ = train.layout
    q, v = z[place] / train.w[:, None], z[speed]
    bent = [
        k * ((shape[a] - shape[b])[train.rigid :] @ q) + c * ((shape[a] - shape[b]) @ v)
        for a, b, k, c in discs.springs
    ]
    own = np.stack([motion.regimes[r].torque @ z[:, k] for k, r in enumerate(regime)], axis=1)
    return np.concatenate([np.array(bent).reshape(-1, len(time)), own])


def kloss(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
    s = 1.0 - speed[0] / SYNCHRONOUS
    return 360.0 * s / (s * s + 0.04)


def pump(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
    return -300.0 * speed[-1] * abs(speed[-1]) / SYNCHRONOUS**2


MOTOR_AND_PUMP = [
    laws.InductionMotor(0, 900.0, 0.2, SYNCHRONOUS),
    laws.BySpeed(1, laws.quadratic(-300.0, SYNCHRONOUS)),
]


def agrees(
    discs: Discs, found: Sequence[laws.BySpeed], duration: float, within: float = 1e-8, **more
) -> float:
    """The largest error of a torque, of the peak, over a motion whose events are the same."""
    time = np.linspace(0.0, duration, 401)
    start = np.concatenate(
        [np.zeros(len(discs.inertia)), more.get("speed", np.zeros(len(discs.inertia)))]
    )
    known, events = discs.run(start, time)
    train, motion, _, shape = solved(discs, found, duration, **more)
    error = float(
        np.abs(torques(discs, train, motion, shape, time) - known).max() / np.abs(known).max()
    )
    residual = energy_balance(motion).residual
    assert events
    assert all(
        np.abs(np.array(events) - one.time).min() <= 1e-8 * one.time for one in motion.events
    )
    assert error <= within
    assert residual < 1e-10
    return error


def test_a_motor_starts_a_pump_through_play() -> None:
    discs = Discs(
        [1.2, 0.3, 2.0],
        [(0, 1, 4e4, 3.0)],
        [("play", 1, 2, 6e4, 0.01, 20.0)],
        [(0, kloss), (2, pump)],
    )
    agrees(discs, MOTOR_AND_PUMP, 1.0)


def test_a_motor_starts_a_pump_through_play_without_damping() -> None:
    discs = Discs(
        [1.2, 0.3, 2.0], [(0, 1, 4e4, 0.0)], [("play", 1, 2, 6e4, 0.01)], [(0, kloss), (2, pump)]
    )
    agrees(discs, MOTOR_AND_PUMP, 0.5)


def test_a_motor_starts_through_friction_beside_a_spring() -> None:
    discs = Discs(
        [1.2, 0.3, 2.0],
        [(0, 1, 4e4, 1.0), (1, 2, 2e4, 1.0)],
        [("friction", 1, 2, 5e4, lambda t: 200.0, lambda t: 0.0)],
        [(0, kloss), (2, pump)],
    )
    agrees(discs, MOTOR_AND_PUMP, 1.0)


def test_a_wave_by_angle_rattles_a_gear_with_play() -> None:
    def wave(t: float, angle: np.ndarray, speed: np.ndarray) -> float:
        return 60.0 * math.cos(4.0 * angle[0] + 0.3)

    discs = Discs(
        [1.2, 0.3, 2.0],
        [(0, 1, 4e4, 3.0)],
        [("play", 1, 2, 6e4, 0.004, 2.0)],
        [(0, wave), (2, pump)],
    )
    found = [
        laws.Wave(0, laws.constant(60.0), 4.0, 0.3),
        laws.BySpeed(1, laws.quadratic(-300.0, SYNCHRONOUS)),
    ]
    agrees(discs, found, 0.3, speed=[60.0] * 3)
