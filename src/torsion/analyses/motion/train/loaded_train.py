"""A train in modes with everything that acts on it: what every motion over time begins with."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from torsion.analyses.motion.events.event_kind import Point
from torsion.analyses.motion.events.events import Stop
from torsion.analyses.motion.events.following_events import SpeedProgram
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.following_torques import (
    Follower,
    carried_by_joints,
    changes_speed,
    following,
    replaced_dampers,
)
from torsion.analyses.motion.train.joints import JointCut, joint_cuts, parts_of, standing_angles
from torsion.analyses.motion.train.modal_train import TrainInModes, all_modes, train_in_modes
from torsion.analyses.motion.train.nonlinear_couplings import Coupling, opened
from torsion.analyses.motion.train.state_before import State, points_of_events
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path
from torsion.kernels.motion.damped_modes import ModalTrain
from torsion.kernels.motion.loaded_modes import Turning
from torsion.kernels.motion.torque_history import Piece
from torsion.study import Study


class Load(NamedTuple):
    """A torque by time, N m, and where it acts."""

    pieces: tuple[Piece, ...]
    acting: FloatArray  # (stations,) for 1 N m
    carried: FloatArray | float = 0.0  # (spans,) that joints carry at once for 1 N m


@dataclass(frozen=True)
class Carrier:
    """How all stations turn without any torque: from where they stand, at their speeds, and as one is made to."""

    offset: FloatArray  # (stations,) rad, own shafts
    speed: FloatArray  # (stations,) rad/s at time 0
    ratio: FloatArray  # (stations,)
    # begin and end (s) and rate (rad/s2) of the reference
    rates: tuple[tuple[float, float, float], ...] = ()

    def at(self, time: FloatArray) -> Turning:
        """Angles, speeds and accelerations, (3, stations, times)."""
        as_one = np.zeros((3, len(time)))
        for begin, end, gain in self.rates:
            lasts = np.clip(time - begin, 0.0, end - begin)
            as_one[0] += gain * lasts * (lasts / 2.0 + np.maximum(time - end, 0.0))
            as_one[1] += gain * lasts
            as_one[2] += gain * ((time >= begin) & (time < end))
        turning = self.ratio[:, None] * as_one[:, None]
        turning[0] += self.offset[:, None] + np.multiply.outer(self.speed, time)
        turning[1] += self.speed[:, None]
        return np.asarray(turning)


@dataclass(frozen=True)
class LoadedTrain(TrainInModes):
    """The linear parts of a train in modes, and what acts on them by time and by how they move."""

    settings: TransientSettings
    path: Path  # of the settings in the file
    cuts: tuple[JointCut, ...]
    carrier: Carrier
    damping: ModalTrain
    slowed: FloatArray  # (spans, rigid motions + modes) N m s/rad: the damping part of the torques, of speeds
    follows: tuple[Follower, ...] | None
    loads: tuple[Load, ...]

    @cached_property
    def interfaces(self) -> IntArray:
        """(interfaces,) stations at which torques follow the motion."""
        stations = [station for follower in self.follows or () for station in follower.stations]
        return np.array(stations, dtype=np.int64)

    @property
    def acting(self) -> FloatArray:
        """(stations, loads + interfaces) for 1 N m."""
        columns = [load.acting for load in self.loads]
        unit = np.eye(len(self.shape))[:, self.interfaces]
        return np.column_stack([*columns, unit])

    @property
    def carried(self) -> FloatArray:
        """(spans, loads + interfaces) that joints carry at once for 1 N m."""
        none = np.zeros(len(self.system.spans))
        columns = [none + load.carried for load in self.loads]
        return np.column_stack([*columns, carried_by_joints(self.system, self.follows or ())[0]])

    def start(self) -> tuple[FloatArray, FloatArray]:
        """Positions and speeds of rigid motions and modes that deviate from the steady motion at time 0."""
        system, before = self.system, self.before
        flexibility = np.where(np.isfinite(system.flexibility), system.flexibility, 0.0)
        position = self.positions(flexibility * before.twist)
        if self.follows is None or self.cuts or before.angle is None:
            return position, np.zeros_like(position)

        # Torques that follow the motion begin amid the steady vibration.
        w, inertia = before.frequency[:, None], np.where(system.held, 0.0, system.lumped_inertia)
        loss = system.loss_factor + w * flexibility * system.viscous
        twist = flexibility * before.amplitude / (1.0 + 1j * loss)
        turned = before.angle @ (inertia[:, None] * self.shape[:, : self.rigid])
        speed = self.positions(np.real(1j * w * twist).sum(axis=0))
        position = position + self.positions(np.real(twist).sum(axis=0))
        position[: self.rigid] += np.real(turned).sum(axis=0)
        speed[: self.rigid] = np.real(1j * w * turned).sum(axis=0)
        return position, speed


def load_train(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    before: State,
    modes: Modes | None = None,
    *,
    nonlinear: tuple[Coupling, ...] = (),
    damping_ratio: float | None = None,
    is_settled: bool = False,
) -> LoadedTrain:
    """Return the linear parts of a train in modes, with what acts on them.

    modes: of the linear parts (default: all). nonlinear: couplings, of which those that can part or slip are taken out.
    damping_ratio: of every mode, in place of the damping of the train. is_settled: the train vibrates steadily at one
    speed, and no torque follows it. Raises InputError for an event that the train cannot have.
    """
    events, cuts = settings.events, joint_cuts(system, before.mean)
    is_driven = changes_speed(system, events)
    # Periodic torques by order follow the motion, and events by angle where a program changes the speed.
    has_orders = any(torque.order is not None for torque in study.train.torques)
    programs = [(event, event.body) for event in events if isinstance(event.body, SpeedProgram)]
    by_angle = bool(programs) and any(event.by_angle for event in events)
    has_laws = not is_settled and (is_driven or has_orders or by_angle)
    points = points_of_events(study, system, events, before, path, turns=has_laws)
    replaced = replaced_dampers(study, system, settings, path)
    parts = parts_of(system, cuts)
    dampers = tuple(damper for damper in parts.dampers if damper.station not in replaced)
    parts = replace(parts, dampers=dampers)
    parts = opened(parts, nonlinear) if nonlinear else parts
    modes = all_modes(parts, before, path) if modes is None else modes
    train = train_in_modes(parts, modes, before, is_driven=is_driven)
    damping = train.damped()
    if damping_ratio is not None:
        ratio = np.full(len(damping.w), damping_ratio)
        damping = ModalTrain(damping.w, ratio, np.zeros_like(damping.viscous))
    offset, speed = standing_angles(system, cuts, before.speed)
    follows = None
    if has_laws:
        follows = following(study, system, events, points, before, cuts, train.shape, speed)
    rates = list[tuple[float, float, float]]()
    for event, program in programs:
        own_ratio = abs(float(system.speed_ratio[study.train[event.at].stations[0]]))
        rates += [(begin, end, rate / own_ratio) for begin, end, rate in program.rates(event.time)]
    loads = _loads(study, system, settings, points)
    if rates:  # the inertia of a train whose speed is prescribed
        pieces = tuple(Piece(begin, end, -rate) for begin, end, rate in rates)
        inertia = np.where(system.held, 0.0, system.lumped_inertia)
        loads.append(Load(pieces, inertia * np.abs(system.speed_ratio)))
    if not (is_settled or (follows is None and before.frequency.size)):
        # No steady vibration stands for torques of a fixed frequency.
        speeds = np.array([before.speed or study.operation.speed or 0.0])
        for torque in system.train.torques:
            if torque.frequency is not None:
                mean = steady_if_known(study, system, speeds) if torque.of_mean else None
                size = complex(amplitude(system, torque, speeds, mean)[0])
                piece = Piece(0.0, math.inf, size, rate=2j * math.pi * torque.frequency)
                loads.append(Load((piece,), np.eye(len(system.stations))[torque.station]))
    return LoadedTrain(
        **vars(train),
        settings=settings,
        path=path,
        cuts=cuts,
        carrier=Carrier(offset, speed, np.abs(system.speed_ratio), tuple(rates)),
        damping=damping,
        slowed=train.slowed_torques(),
        follows=follows,
        loads=tuple(loads),
    )


def _loads(
    study: Study, system: System, settings: TransientSettings, points: Sequence[Point]
) -> list[Load]:
    """The torque of every event; behind them the mean torques that starts and loads replace."""
    events, unit, loads = settings.events, np.eye(len(system.stations)), list[Load]()
    replaced = dict[str, tuple[float, float]]()
    for event, point in zip(events, points, strict=True):
        column = unit[study.train[event.at].stations[0]]
        loads.append(Load(event.pieces(point), column))
        if event.body.drives and point.mean:
            begin, _ = replaced.get(event.at, (math.inf, 0.0))
            replaced[event.at] = min(begin, event.time), point.mean
    for name, (begin, mean_torque) in replaced.items():
        # What a stop has taken away before.
        stops = (event.body for event in events if event.at == name)
        stopped = sum(stop.share for stop in stops if isinstance(stop, Stop))
        pieces = (Piece(begin, math.inf, -mean_torque * (1.0 - stopped)),)
        loads.append(Load(pieces, unit[study.train[name].stations[0]]))
    return loads
