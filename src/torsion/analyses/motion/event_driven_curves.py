"""Torques and speeds of a train with nonlinear couplings over time, and what its couplings did."""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.analyses.motion.event_driven_train import Built, build
from torsion.analyses.motion.times_looked_at import Wave, waves_of
from torsion.analyses.motion.torque_curves import forced
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
class EventDrivenCurves:
    """Torques and speeds at any time of an event-driven motion."""

    built: Built
    motion: EventDrivenMotion
    marched: Marched | None

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
        steps = [] if self.built.following is None else self.motion.begin.tolist()
        return np.unique([*events, *self.built.train.signals.breaks, *steps])

    @cached_property
    def rows(self) -> tuple[FloatArray, ...]:
        """(spans, state) N m of every regime."""
        built, (_, place, speed, _, _) = self.built, self.built.train.layout
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
    def waves(self) -> tuple[Wave, ...]:
        """What vibrates: torques, and every regime while it lasts."""
        return (*waves_of(self.built.train.signals.pieces), *self.regimes)

    @cached_property
    def regimes(self) -> tuple[Wave, ...]:
        """Every regime while it lasts, with its fastest vibration."""
        motion, inner = self.motion, self.built.train.layout[3].start
        w = [
            float(np.abs(np.linalg.eigvals(one.matrix[:inner, :inner]).imag).max(initial=0.0))
            for one in motion.regimes
        ]
        first = np.flatnonzero(np.diff(motion.regime, prepend=-1))
        ends = [*motion.begin[first[1:]].tolist(), motion.end]
        lasting = zip(
            motion.begin[first].tolist(), ends, motion.regime[first].tolist(), strict=True
        )
        return tuple(Wave(begin, end, w[number]) for begin, end, number in lasting)

    @property
    def quickest(self) -> float:
        """1/s of the fastest that dies away."""
        return self.fastest

    def unseen(self, w: float) -> FloatArray:
        """(spans,) N m that torques as fast as w (rad/s) and faster shake at most."""
        train, rows = self.built.train, (self.built.modes.torque, self.slowed, self.built.direct)
        return forced(rows, train.w, train.force, train.signals.pieces, w)

    @property
    def rigid_motions(self) -> int:
        """Number of rigid motions."""
        return self.built.train.rigid

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places of the modes, behind angles of rigid motions where these are known, and speeds of all motions."""
        return self._read(self.motion.at(time)[0])

    def _read(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        _, place, speed, _, turned = self.built.train.layout
        return np.concatenate([z[turned], z[place] / self.built.train.w[:, None]]), z[speed]

    def acceleration(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(rigid motions + modes, times)."""
        (z, regime), here = self.motion.at(time), self.built.train.layout[2]
        return np.stack(
            [self.motion.regimes[r].matrix[here] @ z[:, k] for k, r in enumerate(regime.tolist())],
            axis=1,
        )

    def turning(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """Speeds (stations, times) of the stations."""
        angle, turning, _ = self.built.carrier.at(time)
        turning += self.shape @ speed
        for cut in self.built.cuts:
            if cut.massless:
                cut.patched(self.built.system, angle + self.shape @ place, turning)
        return turning

    def torque(
        self, time: FloatArray
    ) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        """Torques (spans, times), their rates, and places and speeds of the modes (each, times)."""
        z, regime = self.motion.at(time)
        torque, rate = np.empty((2, len(self.slowed), len(time)))
        for number in np.unique(regime).tolist():
            here, rows = regime == number, self.rows[number]
            torque[:, here] = rows @ z[:, here]
            rate[:, here] = rows @ (self.motion.regimes[number].matrix @ z[:, here])
        return torque, rate, self._read(z)

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""
        order = np.argsort(at, kind="stable")
        z, regime = self.motion.at(at[order])
        torque, rate = np.empty((2, len(at)))
        for number in np.unique(regime).tolist():
            here = np.flatnonzero(regime == number)
            rows = self.rows[number][span[order[here]]]
            torque[order[here]] = np.einsum("ks,sk->k", rows, z[:, here])
            rate[order[here]] = np.einsum(
                "ks,sk->k", rows, self.motion.regimes[number].matrix @ z[:, here]
            )
        return torque, rate


def event_driven_curves(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path,
    damping_ratio: float | None = None,
    progress: Progress = silent,
) -> tuple[EventDrivenCurves, EnergyBalance, Switching, EventDrivenCurves]:
    """The motion of a train with nonlinear couplings, its balance of energy and its events; last with halved steps."""
    built = build(study, system, settings, place, damping_ratio=damping_ratio)
    curves = EventDrivenCurves(built, *built.run(settings.duration, 1.0, progress))
    balance = energy_balance(curves.motion)
    time = np.linspace(0.0, settings.duration, COMPARED)
    fine = EventDrivenCurves(built, *built.run(settings.duration, 0.5, progress))
    changes = _changes(curves, fine, time)
    late = np.flatnonzero(changes > TOLERANCE)
    change = 0.0
    if built.is_band:
        half = build(study, system, settings, place, damping_ratio=damping_ratio, halved=True)
        change = float(
            _changes(curves, EventDrivenCurves(half, *half.run(settings.duration)), time).max()
        )
    words = Counter(
        (built.standing[event.element].coupling, event.word) for event in curves.motion.events
    )
    heat = np.zeros(len(built.couplings))
    np.add.at(heat, [one.coupling for one in built.standing], balance.heat)
    works = tuple(
        CouplingWork(
            one.part.name,
            words[number, "contact"],
            words[number, "separation"],
            words[number, "slip"],
            float(joule),
        )
        for number, (one, joule) in enumerate(zip(built.couplings, heat, strict=True))
    )
    names = [built.couplings[one.coupling].part.name for one in built.standing]
    events = tuple(
        CouplingEvent(event.time, names[event.element], event.word)
        for event in curves.motion.events
    )
    sensitive = float(time[late[0]]) if late.size else None
    return (
        curves,
        balance,
        Switching(events, works, balance.work, balance.damped, sensitive, change),
        fine,
    )


def _changes(curves: EventDrivenCurves, other: EventDrivenCurves, time: FloatArray) -> FloatArray:
    """(times,) largest difference of a torque, of the peak of its span."""
    first, second = (one.torque(time)[0] for one in (curves, other))
    peak = np.maximum(np.abs(first).max(axis=1), 1e-9 * np.abs(first).max())
    return np.asarray(
        (np.abs(first - second) / np.where(peak > 0.0, peak, 1.0)[:, None]).max(axis=0)
    )
