"""Torques and speeds of a train with nonlinear couplings over time, and what its couplings did."""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.analyses.motion.event_driven_train import Built, build
from torsion.analyses.motion.times_looked_at import Wave, waves_of
from torsion.analyses.motion.torque_curves import Curves, Vibrations
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path
from torsion.findings import Progress, silent
from torsion.kernels.motion.collocation import Marched
from torsion.kernels.motion.energy_balance import EnergyBalance, energy_balance
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion
from torsion.kernels.motion.linear_regime import RADIANS
from torsion.results import reported, result
from torsion.study import Study

TOLERANCE = 1e-6  # of the peak of a span: two runs that differ by more are not the same motion
COMPARED = 2000  # times at which they are compared


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

    events: tuple[CouplingEvent, ...] = result(
        "", (), "every change of a regime, in the order of time"
    )
    couplings: tuple[CouplingWork, ...] = result("", (), "what every nonlinear coupling did")
    work: float = result("J", (), "work of all torques on the motion")
    damped: float = result("J", (), "energy that the damping of the linear train took")
    sensitive_after: float | None = result(
        "s",
        (),
        "time from which halved steps change a torque by more than 1e-6 of its peak: read statistics "
        "there, not single values; null if this never happens",
    )
    band_change: float = result(
        "1",
        (),
        "change of the torques, relative to their peak, with twice the band of modes; 0: all modes are included",
    )
    scatter: FloatArray | None = result(
        "N*m",
        ("span",),
        "difference of the maximum torque with halved steps, if the motion is sensitive. Maximum "
        "and minimum torques are over both step sizes, and verdicts add the difference",
        default=None,
    )


@dataclass(frozen=True)
class EventDrivenCurves(Curves):
    """Torques and speeds at any time of an event-driven motion."""

    built: Built
    motion: EventDrivenMotion

    @cached_property
    def rows(self) -> tuple[FloatArray, ...]:
        """(spans, state) N m of every regime."""
        loaded, train = self.loaded, self.built.train
        _, position, speed, _, _ = train.layout
        linear = np.zeros((len(loaded.slowed), train.size))
        linear[:, position] = loaded.modes.torque / train.w
        linear[:, speed] = loaded.slowed
        linear += train.rows(self.direct)
        regimes = self.motion.regimes
        return tuple(linear + self.built.of_elements @ regime.torque for regime in regimes)

    @cached_property
    def regimes(self) -> tuple[Wave, ...]:
        """Every regime while it lasts, with its fastest vibration."""
        motion, inner = self.motion, self.built.train.layout[3].start
        roots = [np.linalg.eigvals(regime.matrix[:inner, :inner]) for regime in motion.regimes]
        w = [float(np.abs(root.imag).max(initial=0.0)) for root in roots]
        first = np.flatnonzero(np.diff(motion.regime, prepend=-1))
        begins = motion.begin[first].tolist()
        lasting = zip(begins, [*begins[1:], motion.end], motion.regime[first].tolist(), strict=True)
        return tuple(Wave(begin, end, w[regime]) for begin, end, regime in lasting)

    def vibrations(self) -> Vibrations:
        motion = self.motion
        times = [event.time for event in motion.events]
        steps = [] if self.loaded.follows is None else motion.begin.tolist()
        cuts = np.unique([*times, *self.built.train.signals.breaks, *steps])
        fastest = max(RADIANS / regime.step for regime in motion.regimes)
        return Vibrations(cuts, fastest, fastest, (*waves_of(self.pieces), *self.regimes))

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self._read(self.motion.at(time)[0])

    def _read(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places of the modes, behind angles of rigid motions where these are known, and speeds of all motions."""
        _, position, speed, _, turned = self.built.train.layout
        return np.concatenate([z[turned], z[position] / self.built.train.w[:, None]]), z[speed]

    def acceleration(self, time: FloatArray, position: FloatArray, speed: FloatArray) -> FloatArray:
        (z, regime), rows = self.motion.at(time), self.built.train.layout[2]
        regimes = self.motion.regimes
        columns = [regimes[r].matrix[rows] @ z[:, k] for k, r in enumerate(regime.tolist())]
        return np.stack(columns, axis=1)

    def torque(
        self, time: FloatArray, span: IntArray | None = None
    ) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        z, regime = self.motion.at(time)
        torque, rate = np.empty((2, *(() if span is not None else (len(self.direct),)), len(time)))
        for number in np.unique(regime).tolist():
            columns = np.flatnonzero(regime == number)
            rows, state = self.rows[number], z[:, columns]
            change = self.motion.regimes[number].matrix @ state
            if span is None:
                torque[:, columns], rate[:, columns] = rows @ state, rows @ change
            else:
                rows = rows[span[columns]]
                torque[columns] = np.einsum("ks,sk->k", rows, state)
                rate[columns] = np.einsum("ks,sk->k", rows, change)
        return torque, rate, self._read(z)


def curves_of(built: Built, motion: EventDrivenMotion) -> EventDrivenCurves:
    """Return the torques and speeds of a motion."""
    train = built.train
    return EventDrivenCurves(
        built.loaded, train.signals.pieces, train.force, built.direct, built, motion
    )


def event_driven_curves(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    damping_ratio: float | None = None,
    progress: Progress = silent,
) -> tuple[EventDrivenCurves, EventDrivenCurves, EnergyBalance, Switching, Marched | None]:
    """The motion of a train with nonlinear couplings, that with halved steps, its balance of energy and its events.

    Last stands how it was marched, where torques follow it.
    """
    built = build(study, system, settings, path, damping_ratio=damping_ratio)
    motion, marched = built.run(settings.duration, 1.0, progress)
    curves = curves_of(built, motion)
    balance = energy_balance(motion)
    time = np.linspace(0.0, settings.duration, COMPARED)
    fine = curves_of(built, built.run(settings.duration, 0.5, progress)[0])
    late = np.flatnonzero(_changes(curves, fine, time) > TOLERANCE)
    change = 0.0
    if built.is_band:
        half = build(study, system, settings, path, damping_ratio=damping_ratio, halved=True)
        half_curves = curves_of(half, half.run(settings.duration)[0])
        change = float(_changes(curves, half_curves, time).max())

    couplings = [stand.coupling for stand in built.standing]
    names = [coupling.part.name for coupling in built.couplings]
    counts = Counter((couplings[event.element], event.word) for event in motion.events)
    heat = np.zeros(len(names))
    np.add.at(heat, couplings, balance.heat)
    works = tuple(
        CouplingWork(
            name,
            counts[number, "contact"],
            counts[number, "separation"],
            counts[number, "slip"],
            float(heat[number]),
        )
        for number, name in enumerate(names)
    )
    events = tuple(
        CouplingEvent(event.time, names[couplings[event.element]], event.word)
        for event in motion.events
    )
    sensitive = float(time[late[0]]) if late.size else None
    switching = Switching(events, works, balance.work, balance.damped, sensitive, change)
    return curves, fine, balance, switching, marched


def _changes(curves: EventDrivenCurves, finer: EventDrivenCurves, time: FloatArray) -> FloatArray:
    """(times,) largest difference of a torque, of the peak of its span."""
    first, second = (motion.torque(time)[0] for motion in (curves, finer))
    peak = np.maximum(np.abs(first).max(axis=1), 1e-9 * np.abs(first).max())
    scale = np.where(peak > 0.0, peak, 1.0)[:, None]
    return np.asarray((np.abs(first - second) / scale).max(axis=0))
