"""The torques that are known by time alone, and how the train is when they begin."""

import math
from collections.abc import Sequence

import numpy as np

from torsion.analyses.motion.event_kind import Point
from torsion.analyses.motion.events import Event, Stop
from torsion.analyses.motion.following_torques import Following, rates_of
from torsion.analyses.motion.state_before import State
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.motion.torque_history import Piece
from torsion.study import Study

Loads = list[tuple[Piece, ...]]


def known_loads(
    study: Study,
    system: System,
    events: Sequence[Event],
    points: Sequence[Point],
    follows: Following | None,
    before: State,
    *,
    vibrates: bool = False,
) -> tuple[Loads, FloatArray]:
    """The torque of every event, and where each acts, (stations, loads) per N m.

    Behind them stand the mean torques that starts and loads replace, the inertia of a train whose speed is prescribed,
    torques of a fixed frequency, and one load of nothing for every interface of what follows the motion. vibrates: a
    steady vibration stands for the torques of a fixed frequency.
    """
    loads, columns, here = (
        list[tuple[Piece, ...]](),
        list[FloatArray](),
        np.eye(len(system.stations)),
    )
    replaced = dict[str, tuple[float, float]]()
    for event, point in zip(events, points, strict=True):
        loads.append(event.pieces(point))
        columns.append(here[study.train.part(event.at).stations[0]])
        if event.body.drives and point.mean:
            first, _ = replaced.get(event.at, (math.inf, 0.0))
            replaced[event.at] = min(first, event.time), point.mean
    for name, (begin, mean_there) in replaced.items():
        gone = [
            one.body.share for one in events if one.at == name and isinstance(one.body, Stop)
        ]  # before it begins
        loads.append((Piece(begin, math.inf, -mean_there * (1.0 - sum(gone))),))
        columns.append(here[study.train.part(name).stations[0]])
    if rates := rates_of(study, system, events):
        loads.append(tuple(Piece(begin, end, -rate) for begin, end, rate in rates))
        columns.append(
            np.where(system.held, 0.0, system.lumped_inertia) * np.abs(system.speed_ratio)
        )
    if not vibrates:
        speed = np.array([before.speed or study.operation.speed or 0.0])
        for torque in system.train.torques:
            if torque.frequency is not None:
                mean = steady_if_known(study, system, speed) if torque.of_mean else None
                size = complex(amplitude(system, torque, speed, mean)[0])
                loads.append((Piece(0.0, math.inf, size, rate=2j * math.pi * torque.frequency),))
                columns.append(here[torque.station])
    if follows is not None:
        loads += [()] * len(follows.station)
        columns += list(here[follows.station])
    return loads, np.array(columns).reshape(-1, len(system.stations)).T


def vibration_before(
    system: System, found: Modes, before: State, shape: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Places and speeds of rigid motions and modes at time 0 that its steady vibration is."""
    rigid = shape.shape[1] - found.torque.shape[1]
    place, speed = np.zeros((2, shape.shape[1]))
    if before.angle is None:
        return place, speed
    flexibility, w = (
        np.where(np.isfinite(system.flexibility), system.flexibility, 0.0),
        before.frequency[:, None],
    )
    twist = (
        flexibility
        * before.amplitude
        / (1.0 + 1j * (system.loss_factor + w * flexibility * system.viscous))
    )
    inertia = np.where(system.held, 0.0, system.lumped_inertia)
    turned = before.angle @ (inertia[:, None] * shape[:, :rigid])
    square = (2.0 * math.pi * found.frequency) ** 2
    for one, factor in ((place, 1.0), (speed, 1j * w)):
        one[:rigid] = np.real(factor * turned).sum(axis=0)
        one[rigid:] = found.torque.T @ np.real(factor * twist).sum(axis=0) / square
    return place, speed
