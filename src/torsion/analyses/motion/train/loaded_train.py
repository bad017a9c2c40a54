"""A train in modes with everything that acts on it: what every motion over time begins with."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.motion.events.event_kind import Point
from torsion.analyses.motion.events.events import Stop
from torsion.analyses.motion.events.following_events import SpeedProgram
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.following_torques import (
    Following,
    changes_speed,
    following,
    replaced_dampers,
)
from torsion.analyses.motion.train.joint_cuts import JointCut, joint_cuts, parts_of, standing
from torsion.analyses.motion.train.modal_train import TrainInModes, train_in_modes
from torsion.analyses.motion.train.state_before import State, points_of_events
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path
from torsion.kernels.motion.collocation import Scheme
from torsion.kernels.motion.damped_modes import ModalTrain
from torsion.kernels.motion.loaded_modes import Turning
from torsion.kernels.motion.torque_history import Piece
from torsion.study import Study

FIRST, LONGEST = 2.0**-10, 2.0**-3  # steps, of the duration
Loads = list[tuple[Piece, ...]]


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
        angle, speed, rate = np.zeros((3, len(time)))
        for begin, end, gain in self.rates:
            lasts = np.clip(time - begin, 0.0, end - begin)
            angle += gain * lasts * (lasts / 2.0 + np.maximum(time - end, 0.0))
            speed += gain * lasts
            rate += gain * ((time >= begin) & (time < end))
        turning = self.ratio[:, None] * np.stack([angle, speed, rate])[:, None]
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
    follows: Following | None
    loads: Loads  # torques by time, N m
    acting: FloatArray  # (stations, loads) for 1 N m
    carried: FloatArray  # (spans, loads + interfaces) that joints carry at once for 1 N m

    @property
    def interfaces(self) -> IntArray:
        """(interfaces,) stations at which torques follow the motion."""
        none = np.empty(0, dtype=np.int64)
        return none if self.follows is None else self.follows.station

    @property
    def interface_shape(self) -> FloatArray:
        """(interfaces, rigid motions + modes)."""
        return self.shape[self.interfaces]

    @property
    def acting_all(self) -> FloatArray:
        """(stations, loads + interfaces) for 1 N m."""
        unit = np.eye(len(self.shape))[:, self.interfaces]
        return np.concatenate([self.acting, unit], axis=1)

    def with_load(
        self, pieces: tuple[Piece, ...], acting: FloatArray, carried: FloatArray | float = 0.0
    ) -> "LoadedTrain":
        """With a torque by time besides, which acts at the stations and is carried by joints (spans,)."""
        number = len(self.loads)
        on_spans = np.insert(self.carried, number, carried, axis=1)
        columns = np.column_stack([self.acting, acting])
        return replace(self, loads=[*self.loads, pieces], acting=columns, carried=on_spans)

    def means(self, system: System) -> tuple[FloatArray, FloatArray]:
        """The mean torques before the events: what joints carry of them, (spans,), and what acts, (stations,) N m."""
        assert self.before.mean is not None
        applied = self.before.mean.applied[:, 0]
        if self.follows is None:
            return np.zeros(len(system.spans)), applied
        _, carried, mean = self.follows.carried(system)
        return carried, applied + mean

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

        def moved(factor: np.ndarray | float) -> FloatArray:
            bent = self.positions(np.real(factor * twist).sum(axis=0))
            bent[: self.rigid] = np.real(factor * turned).sum(axis=0)
            return bent

        return position + moved(1.0), moved(1j * w)

    def scheme(self, kinks: FloatArray) -> Scheme:
        """How finely torques that follow the motion are found; kinks: (times,) s, of the torques that are given."""
        cuts = (*kinks.tolist(), *(end for line in self.carrier.rates for end in line[:2]))
        duration, tolerance = self.settings.duration, self.settings.tolerance
        weight = np.abs(self.system.speed_ratio[self.interfaces])
        return Scheme(duration, tolerance, FIRST * duration, LONGEST * duration, weight, cuts)


def load_train(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    before: State,
    choose_modes: Callable[[System], Modes],
    *,
    opened: Callable[[System], System] = lambda system: system,
    damping_ratio: float | None = None,
    is_settled: bool = False,
) -> LoadedTrain:
    """Return the linear parts of a train in modes, with what acts on them.

    choose_modes: the modes of the linear parts. opened: takes out the couplings that can part or slip. damping_ratio: of
    every mode, in place of the damping of the train. is_settled: the train vibrates steadily at one speed, and no torque
    follows it. Raises InputError for an event that the train cannot have.
    """
    events, cuts = settings.events, joint_cuts(system, before.mean)
    is_driven = changes_speed(system, events)
    # Periodic torques by order follow the motion, and events by angle where a program changes the speed.
    has_orders = any(torque.order is not None for torque in study.train.torques)
    programs = [(event, event.body) for event in events if isinstance(event.body, SpeedProgram)]
    by_angle = bool(programs) and any(event.body.by_angle for event in events)
    has_laws = not is_settled and (is_driven or has_orders or by_angle)
    points = points_of_events(study, system, events, before, path, turns=has_laws)
    replaced = replaced_dampers(study, system, settings, path)
    parts = parts_of(system, cuts)
    dampers = tuple(damper for damper in parts.dampers if damper.station not in replaced)
    parts = opened(replace(parts, dampers=dampers))
    train = train_in_modes(parts, choose_modes(parts), before, is_driven=is_driven)
    damping = train.damped()
    if damping_ratio is not None:
        ratio = np.full(len(damping.w), damping_ratio)
        damping = ModalTrain(damping.w, ratio, np.zeros_like(damping.viscous))
    offset, speed = standing(system, cuts, before.speed)
    follows = None
    if has_laws:
        follows = following(study, system, events, points, before, cuts, train.shape, speed)
    vibrates = is_settled or (follows is None and bool(before.frequency.size))
    rates = list[tuple[float, float, float]]()
    for event, program in programs:
        own_ratio = abs(float(system.speed_ratio[study.train.part(event.at).stations[0]]))
        rates += [(begin, end, rate / own_ratio) for begin, end, rate in program.rates(event.time)]
    loads, acting = _loads(study, system, settings, points, before, rates, vibrates=vibrates)
    carried = np.zeros((len(system.spans), 0))
    if follows is not None:
        carried = follows.carried(system)[0]
    return LoadedTrain(
        **vars(train),
        settings=settings,
        path=path,
        cuts=cuts,
        carrier=Carrier(offset, speed, np.abs(system.speed_ratio), tuple(rates)),
        damping=damping,
        slowed=train.slowed_torques(),
        follows=follows,
        loads=loads,
        acting=acting,
        carried=np.concatenate([np.zeros((len(system.spans), len(loads))), carried], axis=1),
    )


def _loads(
    study: Study,
    system: System,
    settings: TransientSettings,
    points: Sequence[Point],
    before: State,
    rates: Sequence[tuple[float, float, float]],
    *,
    vibrates: bool,
) -> tuple[Loads, FloatArray]:
    """The torque of every event, and where each acts, (stations, loads) per N m.

    Behind them stand the mean torques that starts and loads replace, the inertia of a train whose speed is prescribed,
    and torques of a fixed frequency. rates: begin, end and rate of the programs of speed. vibrates: a steady vibration
    stands for the torques of a fixed frequency.
    """
    events, loads, columns = settings.events, Loads(), list[FloatArray]()
    unit = np.eye(len(system.stations))
    replaced = dict[str, tuple[float, float]]()
    for event, point in zip(events, points, strict=True):
        loads.append(event.pieces(point))
        columns.append(unit[study.train.part(event.at).stations[0]])
        if event.body.drives and point.mean:
            begin, _ = replaced.get(event.at, (math.inf, 0.0))
            replaced[event.at] = min(begin, event.time), point.mean
    for name, (begin, mean_torque) in replaced.items():
        # What a stop has taken away before.
        stops = (event.body for event in events if event.at == name)
        stopped = sum(stop.share for stop in stops if isinstance(stop, Stop))
        loads.append((Piece(begin, math.inf, -mean_torque * (1.0 - stopped)),))
        columns.append(unit[study.train.part(name).stations[0]])
    if rates:
        loads.append(tuple(Piece(begin, end, -rate) for begin, end, rate in rates))
        inertia = np.where(system.held, 0.0, system.lumped_inertia)
        columns.append(inertia * np.abs(system.speed_ratio))
    if not vibrates:
        speed = np.array([before.speed or study.operation.speed or 0.0])
        for torque in system.train.torques:
            if torque.frequency is not None:
                mean = steady_if_known(study, system, speed) if torque.of_mean else None
                size = complex(amplitude(system, torque, speed, mean)[0])
                loads.append((Piece(0.0, math.inf, size, rate=2j * math.pi * torque.frequency),))
                columns.append(unit[torque.station])
    return loads, np.array(columns).reshape(-1, len(system.stations)).T
