"""Motion over time of a train with nonlinear couplings: built from its linear parts, run from event to event, read."""

import math
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.analyses.transient.direct_torques import direct_torques
from torsion.analyses.transient.modal_train import (
    kept_modes,
    lowest,
    modal_train,
    shapes,
    slowed_torques,
    start,
    twists,
)
from torsion.analyses.transient.nonlinear_couplings import (
    Coupling,
    Standing,
    capacity_pieces,
    couplings,
    opened,
    standing,
)
from torsion.analyses.transient.state_before import State, loads_of_events, state_before
from torsion.analyses.transient.transient_settings import PATH, TransientSettings
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.kernels.spanning_forest import connected
from torsion.kernels.transient.energy_balance import EnergyBalance, energy_balance
from torsion.kernels.transient.event_driven_motion import Chatter, EventDrivenMotion, PiecewiseTrain, event_driven
from torsion.kernels.transient.generated_signals import Signals
from torsion.kernels.transient.linear_regime import RADIANS
from torsion.kernels.transient.torque_history import Piece
from torsion.results import reported, result
from torsion.study import Study

TOLERANCE = 1e-6  # of the peak of a span: two runs that differ by more are not the same motion
COMPARED = 2000  # times at which they are compared
LARGEST_ANGLE = 2e7  # rad of the fastest mode within the duration, up to which all modes are kept


@reported
class CouplingEvent:
    """A coupling passed from one regime to another."""

    time: float = result("s", (), "when")
    coupling: str = result("", (), "which")
    what: str = result("", (), "contact, separation, slip, stuck or open")


@reported
class CouplingWork:
    """What a nonlinear coupling did in the whole motion."""

    coupling: str = result("", (), "which")
    contacts: int = result("", (), "how often its faces met")
    separations: int = result("", (), "how often they parted")
    slips: int = result("", (), "how often it began to slip")
    heat: float = result("J", (), "heat of its friction and of the damping of its contact")


@reported
class Switching:
    """The events of a motion between the regimes of nonlinear couplings."""

    events: tuple[CouplingEvent, ...] = result("", (), "every change of a regime, in the order of time")
    couplings: tuple[CouplingWork, ...] = result("", (), "what every nonlinear coupling did")
    work: float = result("J", (), "work of all torques on the motion")
    damped: float = result("J", (), "energy that the damping of the linear train took")
    sensitive_after: float | None = result(
        "s", (), "from when on halved steps change a torque by more than 1e-6 of its peak: read statistics there, "
        "not single values; null where they never do"
    )  # fmt: skip
    band_change: float = result(
        "1", (), "change of the torques, of their peak, on doubling the band of modes that is kept; 0: all are"
    )


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
    is_band: bool  # modes were left out
    place: FloatArray
    speed: FloatArray

    def run(self, duration: float, fineness: float = 1.0) -> EventDrivenMotion:
        """The motion; raises SolveError where a coupling changes its regime without end."""
        try:
            return event_driven(
                self.train, tuple(one.regime for one in self.standing), duration=duration, fineness=fineness,
                twist=np.array([one.twist for one in self.standing]), place=self.place, speed=self.speed,
            )  # fmt: skip
        except Chatter as chatter:
            name = self.couplings[self.standing[chatter.element].coupling].part.name
            message = f"from {chatter.time:.6g} s on, '{name}' changes between its regimes without end"
            raise SolveError(message, "give its contact damping, or its friction a stiffness", PATH) from None


@dataclass(frozen=True)
class EventDrivenCurves:
    """Torques and speeds at any time of an event-driven motion."""

    built: Built
    motion: EventDrivenMotion

    @property
    def shape(self) -> FloatArray:
        """(stations, rigid motions + modes)."""
        return self.built.shape

    @property
    def slowed(self) -> FloatArray:
        """(spans, rigid motions + modes)."""
        return self.built.slowed

    @property
    def cuts(self) -> FloatArray:
        """Times of all events, and at which a torque begins or ends."""
        events = [event.time for event in self.motion.events]
        return np.unique([*events, *self.built.train.signals.breaks])

    @cached_property
    def rows(self) -> tuple[FloatArray, ...]:
        """(spans, state) N m of every regime."""
        built, (_, place, speed, _) = self.built, self.built.train.layout
        linear = np.zeros((len(built.slowed), built.train.size))
        linear[:, place] = built.modes.torque / built.train.w
        linear[:, speed] = built.slowed
        linear += built.train.rows(built.direct)
        return tuple(linear + built.of_elements @ one.torque for one in self.motion.regimes)

    @property
    def fastest(self) -> float:
        """rad/s of the fastest motion of a regime."""
        return max(RADIANS / one.step for one in self.motion.regimes)

    @property
    def rigid_motions(self) -> int:
        """Number of rigid motions."""
        return self.built.train.rigid

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places of the modes and speeds of all motions, (each, times)."""
        z = self.motion.at(time)[0]
        _, place, speed, _ = self.built.train.layout
        return z[place] / self.built.train.w[:, None], z[speed]

    def acceleration(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(rigid motions + modes, times)."""
        (z, regime), here = self.motion.at(time), self.built.train.layout[2]
        return np.stack([self.motion.regimes[r].matrix[here] @ z[:, k] for k, r in enumerate(regime.tolist())], axis=1)

    def turning(self, speed: FloatArray) -> FloatArray:
        """Speeds (stations, times) of the stations."""
        before = self.built.before.speed * np.abs(self.built.system.speed_ratio)
        return np.asarray(before[:, None] + self.shape @ speed)

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Torques (spans, times), their rates, and speeds (rigid motions + modes, times)."""
        z, regime = self.motion.at(time)
        torque, rate = np.empty((2, len(self.slowed), len(time)))
        for number in np.unique(regime).tolist():
            here, rows = regime == number, self.rows[number]
            torque[:, here] = rows @ z[:, here]
            rate[:, here] = rows @ (self.motion.regimes[number].matrix @ z[:, here])
        return torque, rate, z[self.built.train.layout[2]]

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""
        order = np.argsort(at, kind="stable")
        z, regime = self.motion.at(at[order])
        torque, rate = np.empty((2, len(at)))
        for number in np.unique(regime).tolist():
            here = np.flatnonzero(regime == number)
            rows = self.rows[number][span[order[here]]]
            torque[order[here]] = np.einsum("ks,sk->k", rows, z[:, here])
            rate[order[here]] = np.einsum("ks,sk->k", rows, self.motion.regimes[number].matrix @ z[:, here])
        return torque, rate


def event_driven_curves(
    study: Study, system: System, settings: TransientSettings, place: Path, damping_ratio: float | None = None
) -> tuple[EventDrivenCurves, EnergyBalance, Switching]:
    """The motion of a train with nonlinear couplings, its balance of energy and its events."""
    built = build(study, system, settings, place, damping_ratio=damping_ratio)
    curves = EventDrivenCurves(built, built.run(settings.duration))
    balance = energy_balance(curves.motion)
    time = np.linspace(0.0, settings.duration, COMPARED)
    fine = EventDrivenCurves(built, built.run(settings.duration, 0.5))
    changes = _changes(curves, fine, time)
    late = np.flatnonzero(changes > TOLERANCE)
    change = 0.0
    if built.is_band:
        half = build(study, system, settings, place, damping_ratio=damping_ratio, halved=True)
        change = float(_changes(curves, EventDrivenCurves(half, half.run(settings.duration)), time).max())
    words = Counter((built.standing[event.element].coupling, event.word) for event in curves.motion.events)
    heat = np.zeros(len(built.couplings))
    np.add.at(heat, [one.coupling for one in built.standing], balance.heat)
    works = tuple(
        CouplingWork(
            one.part.name, words[number, "contact"], words[number, "separation"], words[number, "slip"], float(joule)
        )
        for number, (one, joule) in enumerate(zip(built.couplings, heat, strict=True))
    )
    names = [built.couplings[one.coupling].part.name for one in built.standing]
    events = tuple(CouplingEvent(event.time, names[event.element], event.word) for event in curves.motion.events)
    sensitive = float(time[late[0]]) if late.size else None
    return curves, balance, Switching(events, works, balance.work, balance.damped, sensitive, change)


def _changes(curves: EventDrivenCurves, other: EventDrivenCurves, time: FloatArray) -> FloatArray:
    """(times,) largest difference of a torque, of the peak of its span."""
    first, second = (one.torque(time)[0] for one in (curves, other))
    peak = np.maximum(np.abs(first).max(axis=1), 1e-9 * np.abs(first).max())
    return np.asarray((np.abs(first - second) / np.where(peak > 0.0, peak, 1.0)[:, None]).max(axis=0))


def build(
    study: Study, system: System, settings: TransientSettings, place: Path, *, damping_ratio: float | None = None,
    halved: bool = False, speed: float | None = None,
) -> Built:  # fmt: skip
    """The train in modes of its linear parts.

    halved: with half the band of modes that would be kept. speed: of a steady state (rad/s of the reference station),
    in place of the operation's.
    """
    found = couplings(study.train, system)
    bare = opened(system, found)
    if bare.bars is not None:
        message = f"play and friction in motion over time take shafts as lumped masses, not the model {bare.model}"
        raise SolveError(message, "model: lumped", place)
    modes = kept_modes(bare, "all", place)[0]
    before = state_before(study, system, settings, place, vibrates=False, speed=speed)
    shape = shapes(bare, modes)
    train = modal_train(study, bare, modes, shape, before)
    rigid, w = train.rigid, train.w
    damping = train.damping if damping_ratio is None else np.diag(2.0 * damping_ratio * train.w_of_all)
    pieces, acting = _signals(study, system, settings, before, place)
    turning = _speeds(study, bare, before, shape)
    ends = twists(bare, modes, shape, np.array([one.span for one in found]))
    torque = before.torque + before.twist
    carried, all_standing = torque.copy(), list[Standing]()
    for number, one in enumerate(found):
        capacity = capacity_pieces(settings, one)
        signal = None
        if capacity is not None:
            signal = len(pieces), not any(piece.begin == 0.0 for piece in capacity)
            pieces, acting = [*pieces, capacity], np.concatenate([acting, np.zeros((len(acting), 1))], axis=1)
        linear, its_elements = standing(number, one, ends[number], float(torque[one.span]), turning, signal)
        carried[one.span] = linear
        all_standing += its_elements
    twisted, _ = start(bare, modes, replace(before, twist=carried), shape)
    spans = np.array([found[one.coupling].span for one in all_standing])
    pushed = _pushed(bare, spans)
    kept = _kept(w, settings, halved=halved)
    own, others, is_band = slice(0, rigid + kept), slice(rigid + kept, None), kept < len(w)
    force, ends_of = shape.T @ acting, np.array([one.element.ends for one in all_standing])
    soft, answer = ends_of[:, others] / w[kept:] ** 2, force[others] / w[kept:, None] ** 2
    higher = modes.torque[:, kept:]
    of_elements = direct_torques(bare, modes, pushed) - higher @ soft.T
    of_elements[spans, np.arange(len(spans))] += 1.0
    elements = tuple(replace(one.element, ends=row[own]) for one, row in zip(all_standing, ends_of, strict=True))
    compliance, rest = (soft @ ends_of[:, others].T, soft @ force[others]) if is_band else (None, None)
    return Built(
        bare, lowest(modes, kept), before, shape[:, own],
        slowed_torques(study, bare, modes, shape, before)[:, own], _direct(bare, modes, acting) + higher @ answer,
        of_elements, found, tuple(all_standing),
        PiecewiseTrain(
            w[:kept], damping[own, own], elements, Signals(tuple(map(tuple, pieces))), force[own], compliance, rest
        ),
        is_band, twisted[rigid : rigid + kept], turning[own],
    )  # fmt: skip


def _kept(w: FloatArray, settings: TransientSettings, *, halved: bool) -> int:
    """How many modes are kept: as requested, and as the duration allows."""
    kept, half = np.searchsorted(w, np.array([1.0, 0.5]) * LARGEST_ANGLE / settings.duration).tolist()
    if settings.modes != "all":
        kept, half = min(kept, settings.modes), min(half, settings.modes // 2)
    return max(min(half, kept - 1), 0) if halved else int(kept)


def _signals(
    study: Study, system: System, settings: TransientSettings, before: State, place: Path
) -> tuple[list[tuple[Piece, ...]], ComplexArray]:
    """The torques of events, mean torques and periodic ones over time, and where they act, (stations, signals)."""
    loads, acting = loads_of_events(study, system, settings, before, place)
    pieces, columns = [tuple(one) for one in loads], list(acting.T.astype(complex))
    if before.mean is not None:
        pieces.append((Piece(0.0, math.inf, 1.0),))
        columns.append(before.mean.applied[:, 0].astype(complex))
    if settings.initial in (None, "steady") and before.speed:
        at = np.array([before.speed])
        for excitation in excitations(system):
            if excitation.errors:
                name = excitation.errors[0].name
                message = f"the transmission error of '{name}' beside a nonlinear coupling is not built"
                raise SolveError(message, "begin with `initial: {speed: ...}`", (*place, "initial"))
            column = np.zeros(len(acting), dtype=complex)
            for torque in excitation.torques:
                column[torque.station] += amplitude(system, torque, at, before.mean)[0]
            pieces.append((Piece(0.0, math.inf, 1.0, rate=1j * float(excitation.line.circular_frequency(at)[0])),))
            columns.append(column)
    return pieces, np.array(columns).reshape(-1, len(acting)).T


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
    found, at, ratio = np.zeros((len(bare.stations), len(spans))), np.arange(len(spans)), bare.speed_ratio
    np.add.at(found, (bare.driving[spans], at), -1.0)
    np.add.at(found, (bare.driven[spans], at), ratio[bare.driving[spans]] / ratio[bare.driven[spans]])
    return found


def _direct(bare: System, modes: Modes, acting: ComplexArray) -> ComplexArray:
    """(spans, signals)."""
    real, imaginary = (direct_torques(bare, modes, part) for part in (acting.real, acting.imag))
    return np.asarray(real + 1j * imaginary)
