"""A train in modes with everything that acts on it, ready to be moved: what every motion over time begins with."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from torsion.analyses.motion.events.event_kind import Point
from torsion.analyses.motion.events.events import Stop
from torsion.analyses.motion.events.machine_events import SpeedProgram
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.modal_train import (
    TrainInModes,
    all_modes,
    direct_torques,
    lowest_modes,
    train_in_modes,
)
from torsion.analyses.motion.train.state_before import State, points_of_events
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.findings import Progress, silent
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion
from torsion.kernels.motion.loaded_modes import LoadedModes, ModalTrain, Piece, Turning
from torsion.kernels.motion.march import Chatter, March, TooManyEvents
from torsion.model.parts import NonlinearRecord, Part
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.motion.train.following_torques import Follower
    from torsion.analyses.motion.train.joints import JointCut
    from torsion.kernels.motion.collocation import Marched
    from torsion.kernels.motion.piecewise_elements import Element

FIRST, LONGEST = 2.0**-10, 2.0**-3  # steps, of the duration
# of the tolerance: events end steps inside, where collocation is not as accurate as at their ends
CUT_SHORT = 0.1


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
    cuts: "tuple[JointCut, ...]"
    carrier: Carrier
    damping: ModalTrain
    slowed: FloatArray  # (spans, rigid motions + modes) N m s/rad: the damping part of the torques, of speeds
    follows: "tuple[Follower, ...] | None"
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
        if self.follows:
            from torsion.analyses.motion.train.following_torques import carried_by_joints

            columns.append(carried_by_joints(self.system, self.follows)[0])
        return np.column_stack([none[:, None][:, :0], *columns])

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
    opened: Callable[[System], System] = lambda system: system,
    damping_ratio: float | None = None,
    is_settled: bool = False,
) -> LoadedTrain:
    """Return the linear parts of a train in modes, with what acts on them.

    modes: of the linear parts (default: all). opened: takes out the couplings that can part or slip.
    damping_ratio: of every mode, in place of the damping of the train. is_settled: the train vibrates steadily at one
    speed, and no torque follows it. Raises InputError for an event that the train cannot have.
    """
    events, parts, ratio = settings.events, system, system.speed_ratio
    cuts: tuple[JointCut, ...] = ()
    offset, speed = 0.0 * ratio, before.speed * ratio
    if system.uneven_joints.size:
        from torsion.analyses.motion.train.joints import joint_cuts, parts_of, standing_angles

        cuts = joint_cuts(system, before.mean)
        parts = parts_of(system, cuts)
        offset, speed = standing_angles(system, cuts, before.speed)
    # Periodic torques by order follow the motion, and events by angle where a program changes the speed.
    has_orders = any(torque.order is not None for torque in study.train.torques)
    programs = [(event, event.body) for event in events if isinstance(event.body, SpeedProgram)]
    by_angle = bool(programs) and any(event.by_angle for event in events)
    is_driven = settings.changes_speed or bool(cuts)
    has_laws = not is_settled and (is_driven or has_orders or by_angle)
    points = points_of_events(study, system, events, before, path, turns=has_laws)
    replaced = dict[int, str]()
    if settings.has_damping_loads:
        from torsion.analyses.motion.train.following_torques import replaced_dampers

        replaced = replaced_dampers(study, system, settings, path)
    dampers = tuple(damper for damper in parts.dampers if damper.station not in replaced)
    parts = replace(parts, dampers=dampers)
    parts = opened(parts)
    modes = all_modes(parts, before, path) if modes is None else modes
    train = train_in_modes(parts, modes, before, is_driven=is_driven)
    damping = train.damped()
    if damping_ratio is not None:
        of_modes = np.full(len(damping.w), damping_ratio)
        damping = ModalTrain(damping.w, of_modes, np.zeros_like(damping.viscous))
    follows = None
    if has_laws:
        from torsion.analyses.motion.train.following_torques import following

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
    fixed = [torque for torque in system.train.torques if torque.frequency is not None]
    if fixed and not (is_settled or (follows is None and before.frequency.size)):
        # No steady vibration stands for torques of a fixed frequency.
        from torsion.analyses.response.harmonic_components import amplitude
        from torsion.analyses.steady import steady_if_known

        speeds = np.array([before.speed or study.operation.speed or 0.0])
        for torque in fixed:
            mean = steady_if_known(study, system, speeds) if torque.of_mean else None
            size = complex(amplitude(system, torque, speeds, mean)[0])
            piece = Piece(0.0, math.inf, size, rate=2j * math.pi * float(torque.frequency or 0))
            loads.append(Load((piece,), np.eye(len(system.stations))[torque.station]))
    return LoadedTrain(
        **vars(train),
        settings=settings,
        path=path,
        cuts=cuts,
        carrier=Carrier(offset, speed, np.abs(ratio), tuple(rates)),
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


@dataclass(frozen=True)
class Coupling:
    """A nonlinear coupling: its part, its span, its record."""

    part: Part
    span: int
    record: NonlinearRecord


@dataclass(frozen=True)
class Standing:
    """An element with how it stands at time 0."""

    element: "Element"
    coupling: int
    twist: float  # rad
    regime: int


@dataclass(frozen=True)
class Built:
    """The train in modes of its linear parts, with its elements, and how it stands at time 0."""

    loaded: LoadedTrain  # without the couplings that can part or slip, in the modes that are kept
    train: LoadedModes
    direct: FloatArray  # (spans, loads + interfaces) carried at once
    position: FloatArray  # (rigid motions + modes,)
    speed: FloatArray  # (rigid motions + modes,)
    # (rigid motions + modes,) positions from which angles of the torques that follow count
    untwisted: FloatArray
    # (spans, elements) of the torques of elements, carried at once and by themselves
    of_elements: FloatArray
    couplings: tuple[Coupling, ...] = ()
    standing: tuple[Standing, ...] = ()
    is_band: bool = False  # modes were left out

    def run(
        self, ends: Sequence[float] = (), fineness: float = 1.0, progress: Progress = silent
    ) -> "Iterator[tuple[EventDrivenMotion, Marched | None]]":
        """The motion up to each of some times (s), ascending, or to the end of the whole.

        Where torques follow it there is that alone, and how it was marched. Raises SolveError where a coupling changes
        its regime without end, or steps become too short.
        """
        loaded, settings, follows = self.loaded, self.loaded.settings, self.loaded.follows
        ends = ends or [settings.duration]
        twist = np.array([element.twist for element in self.standing])
        regimes = tuple(element.regime for element in self.standing)
        shown = partial(progress, "from event to event")
        with self._located():
            state = twist, self.position, self.speed, regimes
            marching = March(self.train, ends[-1], *state, fineness, shown, self._turning)
            if follows is None:
                yield from ((motion, None) for motion in marching.until(ends))
                return
            from torsion.analyses.motion.train.following_torques import refuse_beyond_tables
            from torsion.kernels.motion.collocation import Scheme, march

            # Steps end where a torque that is given, or the speed of a program, has a kink.
            kinks = (end for line in loaded.carrier.rates for end in line[:2])
            finer = (fineness, CUT_SHORT * fineness**4) if self.train.elements else (1.0, 1.0)
            scheme = Scheme(
                settings.duration,
                finer[1] * settings.tolerance,
                FIRST * settings.duration,
                finer[0] * LONGEST * settings.duration,
                np.abs(loaded.system.speed_ratio[loaded.interfaces]),
                (*self.train.history.begin.tolist(), *kinks),
            )
            laws = [follower.law for follower in follows]
            marched = march(marching, laws, scheme, partial(progress, "torques that follow"))
        refuse_beyond_tables(follows, settings.events, marched, loaded.path)
        yield marching.finished(settings.duration), marched

    def _turning(self, time: FloatArray) -> Turning:
        """How the interfaces of what follows the motion turn without any torque."""
        turning = self.loaded.carrier.at(time)[:, self.loaded.interfaces]
        turning[0] -= (self.train.shape @ self.untwisted)[:, None]
        return turning

    @contextmanager
    def _located(self) -> Iterator[None]:
        """Errors of a motion with the names and the path that they have in the file."""
        path = self.loaded.path
        try:
            yield
        except Chatter as error:
            name = self.couplings[self.standing[int(error.path[0])].coupling].part.name
            message = error.message.replace("a coupling", f"'{name}'")
            raise SolveError(message, error.hint, path) from None
        except TooManyEvents as error:
            raise SolveError(error.message, error.hint, (*path, "duration")) from None
        except SolveError as error:
            raise SolveError(error.message, error.hint, path) from None


def in_modes(
    loaded: LoadedTrain,
    position: FloatArray,
    speed: FloatArray,
    nonlinear: tuple[Coupling, ...] = (),
    stands: tuple[Standing, ...] = (),
    *,
    kept: int | None = None,
    is_band: bool,
) -> Built:
    """With as many modes kept, and the compliance of the others in series with the elements.

    Without nonlinear couplings all modes of `loaded` are kept, and positions and speeds deviate from the steady motion.
    is_band: higher modes than those of `loaded` are left out, and stand at once for what they carry.
    """
    bare, modes, rigid, w = loaded.system, loaded.modes, loaded.rigid, loaded.w
    kept = len(w) if kept is None else kept
    low, high, is_cut = slice(0, rigid + kept), slice(rigid + kept, None), kept < len(w)
    spans = np.array([nonlinear[stand.coupling].span for stand in stands], dtype=np.int64)
    acting, damping, shape = loaded.acting, loaded.damping, loaded.shape[:, low]
    force = loaded.shape.T @ acting
    ends = np.array([stand.element.ends for stand in stands]).reshape(len(stands), len(force))
    soft, answer = ends[:, high] / w[kept:] ** 2, force[high] / w[kept:, None] ** 2
    higher = modes.torque[:, kept:]

    # What an element applies to its ends for 1 N m in it, (stations, elements) at own speeds.
    column, ratio = np.arange(len(spans)), bare.speed_ratio
    driving, driven = bare.driving[spans], bare.driven[spans]
    reactions = np.zeros((len(bare.stations), len(spans)))
    np.add.at(reactions, (driving, column), -1.0)
    np.add.at(reactions, (driven, column), ratio[driving] / ratio[driven])
    direct = direct_torques(bare, modes, acting, is_band=is_band)
    of_elements = direct_torques(bare, modes, reactions, is_band=is_band) - higher @ soft.T
    of_elements[spans, column] += 1.0

    pieces = [load.pieces for load in loaded.loads]
    train = LoadedModes(
        ModalTrain(damping.w[:kept], damping.ratio[:kept], damping.viscous[low, low]),
        pieces,
        force[low, : len(pieces)],
        shape[loaded.interfaces],
        tuple(
            replace(stand.element, ends=row[low]) for stand, row in zip(stands, ends, strict=True)
        ),
        soft @ ends[:, high].T if is_cut else None,
        soft @ force[high] if is_cut else None,
    )
    before = loaded.before
    is_whole = bool(nonlinear) and before.mean is not None
    if loaded.follows is not None:  # what follows the motion stands for the steady vibration
        none = {name: getattr(before, name)[:0] for name in ("frequency", "amplitude")}
        before = replace(before, **none)
    return Built(
        replace(
            loaded,
            before=before,
            modes=lowest_modes(modes, kept),
            shape=shape,
            slowed=loaded.slowed[:, low],
        ),
        train,
        direct + loaded.carried + higher @ answer,
        position[low],
        speed[low],
        is_whole * position[low],
        of_elements,
        nonlinear,
        stands,
        is_cut,
    )
