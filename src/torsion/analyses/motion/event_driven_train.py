"""A train with nonlinear couplings in the modes of its linear parts, ready to be moved from event to event."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from torsion.analyses.motion.acting_torques import without_excluded_torques
from torsion.analyses.motion.following_torques import changes_speed, refuse_beyond_tables
from torsion.analyses.motion.loaded_train import LoadedTrain, load_train
from torsion.analyses.motion.modal_train import direct_torques, kept_modes, lowest_modes
from torsion.analyses.motion.nonlinear_couplings import (
    Coupling,
    Standing,
    capacity_pieces,
    couplings,
    opened,
    standing,
)
from torsion.analyses.motion.state_before import State, state_before
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.findings import Progress, silent
from torsion.kernels.motion.collocation import Marched
from torsion.kernels.motion.endless_events import Chatter, TooManyEvents
from torsion.kernels.motion.event_driven_collocation import Interfaces, event_driven_under_laws
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, March
from torsion.kernels.motion.generated_signals import Signals
from torsion.kernels.motion.piecewise_elements import Element
from torsion.kernels.motion.piecewise_train import PiecewiseTrain
from torsion.kernels.motion.torque_history import Piece
from torsion.kernels.spanning_forest import connected
from torsion.study import Study

MOST_OF_ELEMENTS = 200  # modes of a train with finite elements
LARGEST_ANGLE = 2e7  # rad of the fastest mode within the duration, up to which all modes are kept
# of the tolerance: events end steps inside, where collocation is not as accurate as at their ends
CUT_SHORT = 0.1


@dataclass(frozen=True)
class Built:
    """The train in modes of its linear parts, with its elements."""

    loaded: LoadedTrain  # without the couplings that can part or slip, in the modes that are kept
    direct: ComplexArray  # (spans, signals) carried at once
    of_elements: FloatArray  # (spans, elements) of the torques of elements, carried at once and by themselves
    couplings: tuple[Coupling, ...]
    standing: tuple[Standing, ...]
    train: PiecewiseTrain
    is_band: bool  # modes were left out
    position: FloatArray  # (modes,)
    speed: FloatArray  # (rigid motions + modes,)

    def run(
        self, duration: float, fineness: float = 1.0, progress: Progress = silent
    ) -> tuple[EventDrivenMotion, Marched | None]:
        """The motion, and how it was marched where torques follow it.

        Raises SolveError where a coupling changes its regime without end, or steps become too short.
        """
        loaded = self.loaded
        follows = loaded.follows
        if follows is None:
            (motion,) = self.until([duration], fineness, progress)
            return motion, None
        march, z, regimes = self._begin(duration, fineness, progress)
        untwisted = (
            self.position if loaded.before.mean is not None else np.zeros_like(self.position)
        )
        shape = loaded.shape[follows.station]
        interfaces = Interfaces(shape, follows.signal, loaded.turning, untwisted)
        scheme = loaded.scheme(self.train.signals.breaks)
        scheme = replace(
            scheme,
            longest=fineness * scheme.longest,
            tolerance=CUT_SHORT * fineness**4 * scheme.tolerance,
        )
        shown = partial(progress, "torques that follow")
        with self._located():
            motion, marched = event_driven_under_laws(
                march, regimes, z, interfaces, follows.laws, scheme, shown
            )
        refuse_beyond_tables(follows, loaded.settings.events, marched, loaded.path)
        return motion, marched

    def until(
        self, ends: Sequence[float], fineness: float = 1.0, progress: Progress = silent
    ) -> Iterator[EventDrivenMotion]:
        """The motion up to each of some times (s), ascending, where no torque follows it; raises as `run` does."""
        march, z, regimes = self._begin(ends[-1], fineness, progress)
        with self._located():
            yield from march.until(ends, z, regimes)

    def _begin(
        self, duration: float, fineness: float, progress: Progress
    ) -> tuple[March, FloatArray, tuple[int, ...]]:
        shown = partial(progress, "from event to event")
        march = March(self.train, duration, fineness, progress=shown)
        twist = np.array([element.twist for element in self.standing])
        z = self.train.at_first(twist, self.position, self.speed)
        return march, z, tuple(element.regime for element in self.standing)

    @contextmanager
    def _located(self) -> Iterator[None]:
        """Errors of a motion with the names and the path that they have in the file."""
        path = self.loaded.path
        try:
            yield
        except Chatter as chatter:
            name = self.couplings[self.standing[chatter.element].coupling].part.name
            message = (
                f"from {chatter.time:.6g} s on, '{name}' changes between its regimes without end"
            )
            hint = "give its contact damping, or its friction a stiffness"
            raise SolveError(message, hint, path) from None
        except TooManyEvents as end:
            hint = f"a `duration` below {end.time:.4g} s"
            raise SolveError(end.message, hint, (*path, "duration")) from None
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
    """The train in modes of its linear parts.

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
        partial(_all_modes, before=before, path=path),
        opened=partial(opened, nonlinear=nonlinear),
        damping_ratio=damping_ratio,
        is_settled=speed is not None,
    )
    if loaded.cuts and before.speeds:
        message = "parts at different speeds together with uneven joints are not supported yet"
        hint = "begin with `initial: rest` or `{speed: ...}`"
        raise SolveError(message, hint, (*path, "initial"))

    turning = _speeds_of_parts(study, loaded)
    signals = _signals(system, loaded, nonlinear, is_settled=speed is not None)
    twists = loaded.twists(np.array([coupling.span for coupling in nonlinear]))
    carried = before.torque + before.twist
    elements = list[Standing]()
    for number, coupling in enumerate(nonlinear):
        capacity = signals.capacities.get(number)
        torque = float(carried[coupling.span])
        linear, stands = standing(number, coupling, twists[number], torque, turning, capacity)
        carried[coupling.span] = linear
        elements += stands
    flexibility = loaded.system.flexibility
    compliance = np.where(np.isfinite(flexibility), flexibility, 0.0)
    start = loaded.positions(compliance * carried)
    kept = _kept(loaded.w, settings, halved=halved)
    return _in_modes(loaded, nonlinear, tuple(elements), signals, kept, start, turning)


def _all_modes(bare: System, before: State, path: Path) -> Modes:
    """All modes of the linear parts."""
    if bare.bars is None:
        return kept_modes(bare, "all", path)[0]
    if before.torque.any() or before.twist.any():
        message = "backlash and friction together with finite elements start without torque"
        hint = "begin with `initial: rest` or `{speed: ...}`, or take `model: lumped`"
        raise SolveError(message, hint, path)
    modes = modes_as_discretised(bare, MOST_OF_ELEMENTS + 1)
    if len(modes.frequency) > MOST_OF_ELEMENTS:
        message = f"backlash and friction need all modes, and the finite elements have more than {MOST_OF_ELEMENTS}"
        raise SolveError(message, "take `model: lumped`, or a lower highest frequency", path)
    return modes


@dataclass(frozen=True)
class _Signals:
    """The torques over time, and the capacities of clutches; those that follow the motion stand behind the pieces."""

    pieces: tuple[tuple[Piece, ...], ...]
    following: int  # number of those that follow the motion
    acting: ComplexArray  # (stations, signals)
    carried: FloatArray  # (spans, signals) that joints carry of them
    # of a coupling: its signal, and whether that is zero at first
    capacities: dict[int, tuple[int, bool]]


def _signals(
    system: System, loaded: LoadedTrain, nonlinear: tuple[Coupling, ...], *, is_settled: bool
) -> _Signals:
    """Torques of events, mean and periodic torques, capacities, and those that follow the motion.

    is_settled: the train vibrates steadily at one speed, and orders have the frequencies of that.
    """
    before, follows, stations = loaded.before, loaded.follows, len(system.stations)
    number = len(loaded.loads) - (0 if follows is None else len(follows.station))
    pieces = loaded.loads[:number]
    columns = list(loaded.acting.T[:number].astype(complex))
    carried = list(np.zeros((number, len(system.spans))))

    def add(of_pieces: tuple[Piece, ...], acting: np.ndarray, on_spans: FloatArray) -> None:
        pieces.append(of_pieces)
        columns.append(acting)
        carried.append(on_spans)

    none, idle = np.zeros(len(system.spans)), np.zeros(stations, dtype=complex)
    by_interface, mean_carried, mean = np.zeros((len(none), 0)), none, np.zeros(stations)
    if follows is not None:
        by_interface, mean_carried, mean = follows.carried(system)
    if before.mean is not None:
        acting = before.mean.applied[:, 0] + mean
        add((Piece(0.0, math.inf, 1.0),), acting, mean_carried)
    if is_settled:
        speed = np.array([before.speed])
        for excitation in excitations(system):
            column = idle.copy()
            for torque in excitation.torques:
                column[torque.station] += amplitude(system, torque, speed, before.mean)[0]
            rate = 1j * float(excitation.line.circular_frequency(speed)[0])
            add((Piece(0.0, math.inf, 1.0, rate=rate),), column, none)
    capacities = dict[int, tuple[int, bool]]()
    for coupling_number, coupling in enumerate(nonlinear):
        capacity = capacity_pieces(loaded.settings, coupling)
        if capacity is not None:
            begins_at_zero = not any(piece.begin == 0.0 for piece in capacity)
            capacities[coupling_number] = len(pieces), begins_at_zero
            add(capacity, idle, none)

    following = 0 if follows is None else int(follows.signal.max(initial=-1)) + 1
    acting, on_spans = (
        np.zeros((following, stations), dtype=complex),
        np.zeros((following, len(none))),
    )
    if follows is not None:
        acting[follows.signal, follows.station] = 1.0
        np.add.at(on_spans, follows.signal, by_interface.T)
    return _Signals(
        tuple(pieces),
        following,
        np.array([*columns, *acting]).reshape(-1, stations).T,
        np.array([*carried, *on_spans]).reshape(-1, len(none)).T,
        capacities,
    )


def _in_modes(
    loaded: LoadedTrain,
    nonlinear: tuple[Coupling, ...],
    stands: tuple[Standing, ...],
    signals: _Signals,
    kept: int,
    position: FloatArray,
    speed: FloatArray,
) -> Built:
    """With as many modes kept, and the compliance of the others in series with the elements."""
    bare, modes, rigid, w = loaded.system, loaded.modes, loaded.rigid, loaded.w
    low, high, is_band = slice(0, rigid + kept), slice(rigid + kept, None), kept < len(w)
    spans = np.array([nonlinear[stand.coupling].span for stand in stands])
    force = loaded.shape.T @ signals.acting
    ends = np.array([stand.element.ends for stand in stands])
    soft, answer = ends[:, high] / w[kept:] ** 2, force[high] / w[kept:, None] ** 2
    higher = modes.torque[:, kept:]
    is_fem = bare.bars is not None  # inside its elements the torque is not that of the modes alone
    direct = direct_torques(bare, modes, signals.acting, is_band=is_fem)
    of_elements = direct_torques(bare, modes, _reactions(bare, spans), is_band=is_fem)
    of_elements = of_elements - higher @ soft.T
    of_elements[spans, np.arange(len(spans))] += 1.0
    elements = tuple(
        replace(stand.element, ends=row[low]) for stand, row in zip(stands, ends, strict=True)
    )
    compliance = soft @ ends[:, high].T if is_band else None
    higher_answer = soft @ force[high] if is_band else None
    scale = _quickest(w[:kept], elements, loaded.settings.duration)
    train = PiecewiseTrain(
        w[:kept],
        loaded.damping.damping[low, low],
        elements,
        Signals(signals.pieces, signals.following, scale),
        force[low],
        compliance,
        higher_answer,
    )
    kept_train = replace(
        loaded,
        modes=lowest_modes(modes, kept),
        shape=loaded.shape[:, low],
        slowed=loaded.slowed[:, low],
    )
    return Built(
        kept_train,
        direct + signals.carried + higher @ answer,
        of_elements,
        nonlinear,
        stands,
        train,
        is_band,
        position[rigid : rigid + kept],
        speed[low],
    )


def _kept(w: FloatArray, settings: TransientSettings, *, halved: bool) -> int:
    """How many modes are kept: as requested, and as the duration allows."""
    highest = np.array([1.0, 0.5]) * LARGEST_ANGLE / settings.duration
    kept, half = np.searchsorted(w, highest).tolist()
    if settings.modes != "all":
        kept, half = min(kept, settings.modes), min(half, settings.modes // 2)
    return max(min(half, kept - 1), 0) if halved else int(kept)


def _quickest(w: FloatArray, elements: tuple[Element, ...], duration: float) -> float:
    """s, about the time of a radian of the fastest motion of the modes and elements."""
    squares = [
        element.stiffness * float(element.ends @ element.ends)
        for element in elements
        if math.isfinite(element.stiffness)
    ]
    element_w = math.sqrt(max(squares, default=0.0))
    return 1.0 / max(float(w.max(initial=0.0)), element_w, 1.0 / duration)


def _speeds_of_parts(study: Study, loaded: LoadedTrain) -> FloatArray:
    """(rigid motions + modes,) of parts that turn at speeds of their own, those of their named points."""
    bare, turning = loaded.system, np.zeros(len(loaded.shape))
    finite = np.isfinite(bare.flexibility)
    part = connected(len(turning), bare.driving[finite], bare.driven[finite])
    for name, speed in loaded.before.speeds.items():
        station = study.train.part(name).stations[0]
        members = part == part[station]
        turning[members] = speed * bare.speed_ratio[members] / bare.speed_ratio[station]
    inertia = np.where(bare.held, 0.0, bare.lumped_inertia)
    return np.asarray(loaded.shape.T @ (inertia * turning))


def _reactions(bare: System, spans: IntArray) -> FloatArray:
    """(stations, elements) N m at own speeds that an element in each span applies to its ends, for 1 N m in it."""
    column, ratio = np.arange(len(spans)), bare.speed_ratio
    driving, driven = bare.driving[spans], bare.driven[spans]
    reactions = np.zeros((len(bare.stations), len(spans)))
    np.add.at(reactions, (driving, column), -1.0)
    np.add.at(reactions, (driven, column), ratio[driving] / ratio[driven])
    return reactions
