"""Torques that follow the motion beside play and friction, against Runge-Kutta steps from event to event."""

import math
from collections.abc import Sequence

import numpy as np
from tests.kernels.motion.piecewise_discs import Discs

from torsion.kernels.motion import torque_laws as laws
from torsion.kernels.motion.collocation import Marched, Scheme, march
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, energy_balance
from torsion.kernels.motion.loaded_modes import LoadedModes, ModalTrain, Piece
from torsion.kernels.motion.march import March
from torsion.kernels.motion.piecewise_elements import Clearance, Friction

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
) -> tuple[LoadedModes, EventDrivenMotion, Marched, np.ndarray]:
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
    modes = ModalTrain(w, np.zeros(len(w)), shape.T @ damping @ shape)
    loads = [piece for _, piece in pieces]
    train = LoadedModes(modes, loads, shape[given].T, shape[at], tuple(elements))
    v = shape.T @ (inertia * np.array(speed)) if len(speed) else np.zeros(size)
    none = np.zeros(len(elements)), np.zeros(size)
    taken = March(train, duration, *none, v, (0,) * len(elements), fineness)
    scheme = Scheme(
        duration,
        tolerance,
        duration / 1024.0,
        duration / 8.0 * fineness,
        np.ones(len(at)),
        tuple(train.history.begin),
    )
    how = march(taken, found, scheme)
    return train, taken.finished(duration), how, shape


def torques(
    discs: Discs,
    train: LoadedModes,
    motion: EventDrivenMotion,
    shape: np.ndarray,
    time: np.ndarray,
) -> np.ndarray:
    """(springs and elements, times) N m."""
    moved = motion.at(time)
    q, v = moved.position, moved.speed
    bent = [
        k * ((shape[a] - shape[b])[train.modes.rigid :] @ q[train.modes.rigid :])
        + c * ((shape[a] - shape[b]) @ v)
        for a, b, k, c in discs.springs
    ]
    return np.concatenate([np.array(bent).reshape(-1, len(time)), moved.torque])


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
