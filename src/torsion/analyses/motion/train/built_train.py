"""A train in the modes of its linear parts, with what acts on it and its nonlinear couplings, ready to be moved."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from torsion.analyses.motion.events.acting_torques import without_excluded_torques
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.following_torques import (
    carried_by_joints,
    changes_speed,
    refuse_beyond_tables,
)
from torsion.analyses.motion.train.loaded_train import Load, LoadedTrain, load_train
from torsion.analyses.motion.train.modal_train import direct_torques, lowest_modes
from torsion.analyses.motion.train.nonlinear_couplings import (
    Coupling,
    Standing,
    capacity_pieces,
    couplings,
    standing,
)
from torsion.analyses.motion.train.state_before import state_before
from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.findings import Progress, silent
from torsion.kernels.motion.collocation import Marched, Scheme, march
from torsion.kernels.motion.damped_modes import ModalTrain
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion
from torsion.kernels.motion.loaded_modes import LoadedModes, Turning
from torsion.kernels.motion.march import Chatter, March, TooManyEvents
from torsion.kernels.motion.torque_history import Piece
from torsion.kernels.trees.tree import connected
from torsion.study import Study

FIRST, LONGEST = 2.0**-10, 2.0**-3  # steps, of the duration
LARGEST_ANGLE = 2e7  # rad of the fastest mode within the duration, up to which all modes are kept
# of the tolerance: events end steps inside, where collocation is not as accurate as at their ends
CUT_SHORT = 0.1


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
    ) -> Iterator[tuple[EventDrivenMotion, Marched | None]]:
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


def build(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    *,
    damping_ratio: float | None = None,
    halved: bool = False,
    speed: float | None = None,
) -> Built:
    """The train with its nonlinear couplings in modes of its linear parts.

    halved: with half the band of modes that would be kept. speed: of a steady state (rad/s of the reference station),
    in place of the operation's.
    """
    study, system = without_excluded_torques(study, system, settings)
    nonlinear = couplings(study.train, system)
    if speed is not None and changes_speed(system, settings.events):
        message = "the joints of the train turn unevenly, and a settled vibration with them is not supported yet"
        raise SolveError(message)
    before = state_before(study, system, settings, path, vibrates=False, speed=speed)
    loaded = load_train(
        study,
        system,
        settings,
        path,
        before,
        nonlinear=nonlinear,
        damping_ratio=damping_ratio,
        is_settled=speed is not None,
    )
    if loaded.cuts and before.speeds:
        message = "parts at different speeds together with uneven joints are not supported yet"
        hint = "begin with `initial: rest` or `{speed: ...}`"
        raise SolveError(message, hint, (*path, "initial"))
    loads = [*loaded.loads, *_steady_torques(system, loaded, has_orders=speed is not None)]
    nothing, capacities = np.zeros(len(system.stations)), dict[int, tuple[int, bool]]()
    for number, coupling in enumerate(nonlinear):
        capacity = capacity_pieces(settings, coupling)
        if capacity is not None:
            begins_at_zero = not any(piece.begin == 0.0 for piece in capacity)
            capacities[number] = len(loads), begins_at_zero
            loads.append(Load(capacity, nothing))
    loaded = replace(loaded, loads=tuple(loads))

    turning = _speeds_of_parts(study, loaded)
    twists = loaded.twists(np.array([coupling.span for coupling in nonlinear]))
    torques, elements = before.torque + before.twist, list[Standing]()
    for number, coupling in enumerate(nonlinear):
        torque = float(torques[coupling.span])
        torques[coupling.span], stands = standing(
            number, coupling, twists[number], torque, turning, capacities.get(number)
        )
        elements += stands
    flexibility = loaded.system.flexibility
    start = loaded.positions(np.where(np.isfinite(flexibility), flexibility, 0.0) * torques)
    # As many modes as requested, and as the duration allows.
    highest = np.array([1.0, 0.5]) * LARGEST_ANGLE / settings.duration
    kept, half = np.searchsorted(loaded.w, highest).tolist()
    if settings.modes != "all":
        kept, half = min(kept, settings.modes), min(half, settings.modes // 2)
    kept = max(min(half, kept - 1), 0) if halved else kept
    # Inside finite elements the torque is not that of the modes alone.
    is_fem = loaded.system.bars is not None
    return in_modes(loaded, start, turning, nonlinear, tuple(elements), kept=kept, is_band=is_fem)


def _steady_torques(system: System, loaded: LoadedTrain, *, has_orders: bool) -> Iterator[Load]:
    """The mean torques before the events, and of a train that vibrates steadily its periodic ones.

    has_orders: it turns at one speed, at which orders have frequencies.
    """
    before = loaded.before
    if before.mean is not None:
        _, carried, of_joints = carried_by_joints(system, loaded.follows or ())
        acting = before.mean.applied[:, 0] + of_joints
        yield Load((Piece(0.0, math.inf, 1.0),), acting, carried)
    speed = np.array([before.speed])
    for excitation in excitations(system) if has_orders else ():
        vibrating = np.zeros(len(system.stations), dtype=complex)
        for torque in excitation.torques:
            vibrating[torque.station] += amplitude(system, torque, speed, before.mean)[0]
        rate = 1j * float(excitation.line.circular_frequency(speed)[0])
        for factor, column in ((1.0, vibrating.real), (1j, vibrating.imag)):
            yield Load((Piece(0.0, math.inf, factor, rate=rate),), column)


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


def _speeds_of_parts(study: Study, loaded: LoadedTrain) -> FloatArray:
    """(rigid motions + modes,) of parts that turn at speeds of their own, those of their named points."""
    bare, turning = loaded.system, np.zeros(len(loaded.shape))
    finite = np.isfinite(bare.flexibility)
    part = connected(len(turning), bare.driving[finite], bare.driven[finite])
    for name, speed in loaded.before.speeds.items():
        station = study.train[name].stations[0]
        members = part == part[station]
        turning[members] = speed * bare.speed_ratio[members] / bare.speed_ratio[station]
    inertia = np.where(bare.held, 0.0, bare.lumped_inertia)
    return np.asarray(loaded.shape.T @ (inertia * turning))
