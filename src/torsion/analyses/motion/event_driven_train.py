"""A train with nonlinear couplings in the modes of its linear parts, ready to be moved from event to event."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from torsion.analyses.motion.acting_torques import without_excluded_torques
from torsion.analyses.motion.carrier import Carrier
from torsion.analyses.motion.direct_torques import direct_torques
from torsion.analyses.motion.event_kind import Point
from torsion.analyses.motion.following_signals import FollowingSignals, quickest
from torsion.analyses.motion.following_torques import (
    carrier_of,
    changes_speed,
    following,
    refuse_beyond_tables,
    replaced_dampers,
    torques_follow,
    without_dampers,
)
from torsion.analyses.motion.joint_cuts import JointCut, joint_cuts, parts_of
from torsion.analyses.motion.known_loads import known_loads
from torsion.analyses.motion.modal_train import (
    kept_modes,
    lowest,
    modal_train,
    shapes,
    slowed_torques,
    start,
    twists,
)
from torsion.analyses.motion.nonlinear_couplings import (
    Coupling,
    Standing,
    capacity_pieces,
    couplings,
    opened,
    standing,
)
from torsion.analyses.motion.state_before import State, points_of_events, state_before
from torsion.analyses.motion.transient_settings import PATH, TransientSettings
from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.findings import Progress, silent
from torsion.kernels.motion.collocation import Marched
from torsion.kernels.motion.damped_motion import ModalTrain
from torsion.kernels.motion.endless_events import Chatter, TooManyEvents
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, March
from torsion.kernels.motion.generated_signals import Signals
from torsion.kernels.motion.piecewise_train import PiecewiseTrain
from torsion.kernels.motion.torque_history import Piece
from torsion.kernels.spanning_forest import connected
from torsion.study import Study

MOST_OF_ELEMENTS = 200  # modes of a train with finite elements
LARGEST_ANGLE = 2e7  # rad of the fastest mode within the duration, up to which all modes are kept


@dataclass(frozen=True)
class Built:
    """The train in modes of its linear parts, with its elements."""

    system: System  # without the couplings that can part or slip
    modes: Modes  # that are kept
    before: State
    shape: FloatArray  # (stations, rigid motions + modes)
    slowed: FloatArray  # (spans, rigid motions + modes) N m s/rad
    direct: ComplexArray  # (spans, signals) carried at once
    of_elements: FloatArray  # (spans, elements) of the torques of elements, carried at once and by themselves
    couplings: tuple[Coupling, ...]
    standing: tuple[Standing, ...]
    train: PiecewiseTrain
    carrier: Carrier
    following: FollowingSignals | None
    is_band: bool  # modes were left out
    place: FloatArray
    speed: FloatArray
    where: Path = PATH  # of the settings in the file

    @property
    def cuts(self) -> tuple[JointCut, ...]:
        """At joints."""
        return () if self.following is None else self.following.follows.cuts

    def run(
        self, duration: float, fineness: float = 1.0, progress: Progress = silent
    ) -> tuple[EventDrivenMotion, Marched | None]:
        """The motion, and how it was marched where torques follow it.

        Raises SolveError where a coupling changes its regime without end, or steps become too short.
        """
        if self.following is None:
            (found,) = self.until([duration], fineness, progress)
            return found, None
        march, z, regimes = self._begun(duration, fineness, progress)
        untwisted = self.place if self.before.mean is not None else np.zeros_like(self.place)
        with self._placed():
            found, how = self.following.march(march, regimes, z, self.shape, untwisted, progress)
        refuse_beyond_tables(
            self.following.follows, self.following.settings.events, how, self.where
        )
        return found, how

    def until(
        self, ends: Sequence[float], fineness: float = 1.0, progress: Progress = silent
    ) -> Iterator[EventDrivenMotion]:
        """The motion up to each of some times (s), ascending, where no torque follows it; raises as `run` does."""
        march, z, regimes = self._begun(ends[-1], fineness, progress)
        with self._placed():
            yield from march.until(ends, z, regimes)

    def _begun(
        self, duration: float, fineness: float, progress: Progress
    ) -> tuple[March, FloatArray, tuple[int, ...]]:
        march, regimes = (
            March(self.train, duration, fineness),
            tuple(one.regime for one in self.standing),
        )
        march.progress = partial(progress, "from event to event")
        return (
            march,
            self.train.at_first(
                np.array([one.twist for one in self.standing]), self.place, self.speed
            ),
            regimes,
        )

    @contextmanager
    def _placed(self) -> Iterator[None]:
        """Faults of a motion with the names and the place that they have in the file."""
        try:
            yield
        except Chatter as chatter:
            name = self.couplings[self.standing[chatter.element].coupling].part.name
            message = (
                f"from {chatter.time:.6g} s on, '{name}' changes between its regimes without end"
            )
            raise SolveError(
                message, "give its contact damping, or its friction a stiffness", self.where
            ) from None
        except TooManyEvents as end:
            raise SolveError(
                end.message, f"a `duration` below {end.time:.4g} s", (*self.where, "duration")
            ) from None
        except SolveError as error:
            raise SolveError(error.message, error.hint, self.where) from None


@dataclass(frozen=True)
class Acting:
    """The torques over time, and the capacities of clutches."""

    pieces: tuple[tuple[Piece, ...], ...]
    where: ComplexArray  # (stations, signals)
    direct: FloatArray  # (spans, signals) that joints carry of them
    capacities: Mapping[int, tuple[int, bool]] = field(
        default_factory=dict
    )  # of a coupling: its signal; zero at first

    def with_capacities(self, settings: TransientSettings, found: tuple[Coupling, ...]) -> "Acting":
        """With those that events change, behind the others."""
        pieces, signals = list(self.pieces), dict[int, tuple[int, bool]]()
        for number, one in enumerate(found):
            capacity = capacity_pieces(settings, one)
            if capacity is not None:
                signals[number] = len(pieces), not any(piece.begin == 0.0 for piece in capacity)
                pieces.append(capacity)
        behind = (0, 0), (0, len(signals))
        return Acting(
            tuple(pieces), np.pad(self.where, behind), np.pad(self.direct, behind), signals
        )


def build(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path,
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
    found, events = couplings(study.train, system), settings.events
    is_driven = changes_speed(system, events)
    has_laws = speed is None and torques_follow(study, system, events)
    if is_driven and speed is not None:
        raise SolveError(
            "the joints of the train turn unevenly, and a settled vibration with them is not supported yet"
        )
    before = state_before(study, system, settings, place, vibrates=False, speed=speed)
    cuts = joint_cuts(system, before.mean)
    if cuts and before.speeds:
        message = "parts at different speeds together with uneven joints are not supported yet"
        raise SolveError(
            message, "begin with `initial: rest` or `{speed: ...}`", (*place, "initial")
        )
    replaced = replaced_dampers(study, system, settings, place)
    bare = opened(without_dampers(parts_of(system, cuts), replaced), found)
    modes = _modes(bare, before, place)
    shape = shapes(bare, modes)
    train = modal_train(study, bare, modes, shape, before, turns=is_driven)
    if damping_ratio is not None:
        train = ModalTrain(
            train.w, np.full(len(train.w), damping_ratio), np.zeros_like(train.viscous)
        )
    turning = _speeds(study, bare, before, shape)
    points = points_of_events(study, system, events, before, place, turns=has_laws)
    follows: FollowingSignals | None = None
    if has_laws:
        follows = FollowingSignals(
            following(study, system, events, points, before, cuts, shape), system, settings
        )
    is_settled = speed is not None
    acting = _signals(study, system, settings, before, points, follows, is_settled=is_settled)
    acting = acting.with_capacities(settings, found)
    ends = twists(bare, modes, shape, np.array([one.span for one in found]))
    torque = before.torque + before.twist
    carried, all_standing = torque.copy(), list[Standing]()
    for number, one in enumerate(found):
        signal = acting.capacities.get(number)
        linear, elements = standing(
            number, one, ends[number], float(torque[one.span]), turning, signal
        )
        carried[one.span] = linear
        all_standing += elements
    place_of, _ = start(bare, modes, replace(before, twist=carried), shape)
    slowed = slowed_torques(study, bare, modes, shape, before, turns=is_driven)
    carrier = carrier_of(study, system, events, before, cuts)
    parts = _Parts(bare, modes, before, shape, train, slowed, place_of, turning, carrier, follows)
    kept = _kept(train.w, settings, halved=halved)
    built = _in_modes(parts, found, tuple(all_standing), acting, kept, settings.duration)
    return replace(built, where=place)


def _modes(bare: System, before: State, place: Path) -> Modes:
    """All modes of the linear parts."""
    if bare.bars is None:
        return kept_modes(bare, "all", place)[0]
    if before.torque.any() or before.twist.any():
        message = "backlash and friction together with finite elements start without torque"
        raise SolveError(
            message, "begin with `initial: rest` or `{speed: ...}`, or take `model: lumped`", place
        )
    found = modes_as_discretised(bare, MOST_OF_ELEMENTS + 1)
    if len(found.frequency) > MOST_OF_ELEMENTS:
        message = f"backlash and friction need all modes, and the finite elements have more than {MOST_OF_ELEMENTS}"
        raise SolveError(message, "take `model: lumped`, or a lower highest frequency", place)
    return found


@dataclass(frozen=True)
class _Parts:
    """The linear parts of a train in all of their modes."""

    bare: System
    modes: Modes
    before: State
    shape: FloatArray
    train: ModalTrain
    slowed: FloatArray
    place: FloatArray
    speed: FloatArray
    carrier: Carrier
    follows: FollowingSignals | None


def _in_modes(
    parts: _Parts,
    found: tuple[Coupling, ...],
    all_standing: tuple[Standing, ...],
    acting: Acting,
    kept: int,
    duration: float,
) -> Built:
    """With as many modes kept, and the compliance of the others in series with the elements."""
    bare, modes, rigid, w = parts.bare, parts.modes, parts.train.rigid, parts.train.w
    own, others, is_band = slice(0, rigid + kept), slice(rigid + kept, None), kept < len(w)
    spans = np.array([found[one.coupling].span for one in all_standing])
    where, carried, follows = acting.where, acting.direct, parts.follows
    if follows is not None:
        where = np.concatenate([where, follows.where.astype(complex)], axis=1)
        carried = np.concatenate([carried, follows.carried], axis=1)
    force, ends = parts.shape.T @ where, np.array([one.element.ends for one in all_standing])
    soft, answer = ends[:, others] / w[kept:] ** 2, force[others] / w[kept:, None] ** 2
    higher = modes.torque[:, kept:]
    of_elements = _direct(bare, modes, _pushed(bare, spans).astype(complex)).real - higher @ soft.T
    of_elements[spans, np.arange(len(spans))] += 1.0
    elements = tuple(
        replace(one.element, ends=row[own]) for one, row in zip(all_standing, ends, strict=True)
    )
    compliance, rest = (soft @ ends[:, others].T, soft @ force[others]) if is_band else (None, None)
    following_too = 0 if follows is None else follows.number
    signals = Signals(acting.pieces, following_too, quickest(w[:kept], elements, duration))
    train = PiecewiseTrain(
        w[:kept], parts.train.damping[own, own], elements, signals, force[own], compliance, rest
    )
    return Built(
        bare,
        lowest(modes, kept),
        parts.before,
        parts.shape[:, own],
        parts.slowed[:, own],
        _direct(bare, modes, where) + carried + higher @ answer,
        of_elements,
        found,
        all_standing,
        train,
        parts.carrier,
        follows,
        is_band,
        parts.place[rigid : rigid + kept],
        parts.speed[own],
    )


def _kept(w: FloatArray, settings: TransientSettings, *, halved: bool) -> int:
    """How many modes are kept: as requested, and as the duration allows."""
    kept, half = np.searchsorted(
        w, np.array([1.0, 0.5]) * LARGEST_ANGLE / settings.duration
    ).tolist()
    if settings.modes != "all":
        kept, half = min(kept, settings.modes), min(half, settings.modes // 2)
    return max(min(half, kept - 1), 0) if halved else int(kept)


def _signals(
    study: Study,
    system: System,
    settings: TransientSettings,
    before: State,
    points: list[Point],
    follows: FollowingSignals | None,
    *,
    is_settled: bool,
) -> Acting:
    """The torques of events, mean torques and periodic ones, without those that follow the motion.

    is_settled: the train vibrates steadily at one speed, and orders have the frequencies of that.
    """
    laws = None if follows is None else follows.follows
    loads, acting = known_loads(
        study, system, settings.events, points, laws, before, vibrates=is_settled
    )
    number = len(loads) - (0 if follows is None else len(follows.signal))
    pieces, columns = (
        [tuple(one) for one in loads[:number]],
        list(acting.T[:number].astype(complex)),
    )
    direct = np.zeros(len(system.spans))
    if before.mean is not None:
        pieces.append((Piece(0.0, math.inf, 1.0),))
        of_joints, direct = (np.zeros(len(acting)), direct) if follows is None else follows.means
        columns.append(before.mean.applied[:, 0] + of_joints + 0j)
    behind = len(pieces)
    if is_settled:
        at = np.array([before.speed])
        for excitation in excitations(system):
            column = np.zeros(len(acting), dtype=complex)
            for torque in excitation.torques:
                column[torque.station] += amplitude(system, torque, at, before.mean)[0]
            pieces.append(
                (
                    Piece(
                        0.0,
                        math.inf,
                        1.0,
                        rate=1j * float(excitation.line.circular_frequency(at)[0]),
                    ),
                )
            )
            columns.append(column)
    carried = np.zeros((len(system.spans), len(pieces)))
    carried[:, behind - 1 : behind] = direct[:, None]
    return Acting(tuple(pieces), np.array(columns).reshape(-1, len(acting)).T, carried)


def _speeds(study: Study, bare: System, before: State, shape: FloatArray) -> FloatArray:
    """(rigid motions + modes,) of parts that turn at speeds of their own, those of their named points."""
    turning = np.zeros(len(shape))
    finite = np.isfinite(bare.flexibility)
    part = connected(len(turning), bare.driving[finite], bare.driven[finite])
    for name, speed in before.speeds.items():
        station = study.train.part(name).stations[0]
        own = part == part[station]
        turning[own] = speed * bare.speed_ratio[own] / bare.speed_ratio[station]
    inertia = np.where(bare.held, 0.0, bare.lumped_inertia)
    return np.asarray(shape.T @ (inertia * turning))


def _pushed(bare: System, spans: IntArray) -> FloatArray:
    """(stations, elements) N m at own speeds that an element in each span applies to its ends, for 1 N m in it."""
    found, at, ratio = (
        np.zeros((len(bare.stations), len(spans))),
        np.arange(len(spans)),
        bare.speed_ratio,
    )
    np.add.at(found, (bare.driving[spans], at), -1.0)
    np.add.at(
        found, (bare.driven[spans], at), ratio[bare.driving[spans]] / ratio[bare.driven[spans]]
    )
    return found


def _direct(bare: System, modes: Modes, acting: ComplexArray) -> ComplexArray:
    """(spans, signals)."""
    is_band = bare.bars is not None  # inside its elements the torque is not that of the modes alone
    real, imaginary = (
        direct_torques(bare, modes, part, is_band=is_band) for part in (acting.real, acting.imag)
    )
    return np.asarray(real + 1j * imaginary)
