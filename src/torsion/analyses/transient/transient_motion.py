"""Motion over time of a linear train, exactly from its modes: torques, their peaks and reversals, and speeds."""

import numpy as np

from torsion.analyses.transient.direct_torques import direct_torques
from torsion.analyses.transient.energy_balance import residual
from torsion.analyses.transient.event_driven_train import Switching, event_driven_curves
from torsion.analyses.transient.modal_train import all_modes, modal_train, shapes, slowed_torques, start
from torsion.analyses.transient.state_before import loads_of_events, state_before
from torsion.analyses.transient.torque_curves import Curves, missed, sampled
from torsion.analyses.transient.transient_settings import DEFAULT_MOST, PER_PERIOD, TransientSettings
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress, Work, silent
from torsion.kernels.transient.damped_motion import ModalTrain, motion
from torsion.results import reported, result
from torsion.study import Study


@reported
class TransientMotion:
    """The motion of the train from its events."""

    time: FloatArray = result("s", ("time",), "samples")
    torque: FloatArray = result(
        "N*m", ("span", "time"), "torque, positive when the driving side pushes", printed=("time", "end span")
    )
    speed: FloatArray = result(
        "rad/s", ("station", "time"), "speed of its own shaft", printed=("time", "named station")
    )
    greatest: FloatArray = result("N*m", ("span",), "greatest torque, also between samples")
    greatest_at: FloatArray = result("s", ("span",), "when")
    least: FloatArray = result("N*m", ("span",), "least torque")
    least_at: FloatArray = result("s", ("span",), "when")
    before: FloatArray = result("N*m", ("span",), "mean torque before the events")
    reversals: IntArray = result("", ("span",), "how often the torque changes its sign")
    unresolved: FloatArray = result(
        "N*m", ("span",), "at most so much do modes add that have fewer than 4 samples in a period: not in the peaks"
    )
    residual: float = result("1", (), "largest error of the balance of energy, of the largest energy of the motion")
    speed_before: float = result("rad/s", (), "reference speed before the events")
    modes: int = result("", (), "elastic modes that were kept: all, but in a stiff train with nonlinear couplings")
    system: System | None = None
    switching: Switching | None = result(
        "", (), "events of couplings with play, friction, stages or a capacity; null without them", default=None
    )

    @property
    def peak(self) -> FloatArray:
        """(spans,) N m, the greatest magnitude, with what modes without samples may add."""
        return np.maximum(np.abs(self.greatest), np.abs(self.least)) + self.unresolved


def transient(
    study: Study, system: System, settings: TransientSettings, *, modes: Modes | None = None,
    damping_ratio: float | None = None, progress: Progress = silent,
) -> TransientMotion:  # fmt: skip
    """The motion from the events of `settings`, exact at every sample, and its peaks between them.

    modes: all of the system, where they are known. damping_ratio: of every mode, in place of the damping of the train.
    Raises InputError for an event that the train cannot have, and SolveError where a mode is not certified or the train
    is of a kind that is not built.
    """
    if study.train.has_nonlinear_couplings:
        return _event_driven(study, system, settings, damping_ratio, progress)
    found = all_modes(system) if modes is None else modes
    before = state_before(study, system, settings)
    shape = shapes(system, found)
    train = modal_train(study, system, found, shape, before)
    if damping_ratio is not None:
        train = ModalTrain(train.w, np.full(len(train.w), damping_ratio), np.zeros_like(train.viscous))
    loads, acting = loads_of_events(study, system, settings, before)
    place, speed = start(system, found, before, shape)
    moved = motion(train, shape.T @ acting, loads, place, speed)
    time = np.linspace(0.0, settings.duration, _samples(settings, found) + 1)
    torque, turning, (top, bottom) = sampled(
        Curves(
            system, found, before, shape, moved, slowed_torques(study, system, found, shape, before),
            direct_torques(system, found, acting),
        ),
        time, progress,
    )  # fmt: skip
    reversals = np.count_nonzero(np.diff(np.signbit(torque), axis=1), axis=1)
    lacking = missed(found, moved, time)
    checked = residual(moved, time)
    return TransientMotion(
        time, torque, turning, *top, -bottom[0], bottom[1], before.torque, reversals, lacking, checked, before.speed,
        len(found.frequency), system,
    )  # fmt: skip


def _event_driven(
    study: Study, system: System, settings: TransientSettings, damping_ratio: float | None, progress: Progress
) -> TransientMotion:
    """The motion of a train with nonlinear couplings; peaks are looked for between events too."""
    curves, balance, switching = event_driven_curves(study, system, settings, damping_ratio)
    found = curves.built.modes
    time = np.linspace(0.0, settings.duration, _samples(settings, found) + 1)
    every = np.union1d(time, curves.cuts[(curves.cuts > 0.0) & (curves.cuts < settings.duration)])
    torque, turning, (top, bottom) = sampled(curves, every, progress)
    at = np.searchsorted(every, time)
    lacking = missed(found, curves, every) if curves.built.kept == len(found.frequency) else np.zeros(len(torque))
    before = curves.built.before
    reversals = np.array([_reversals(row) for row in torque], dtype=np.int64)
    return TransientMotion(
        time, torque[:, at], turning[:, at], *top, -bottom[0], bottom[1], before.torque, reversals, lacking,
        balance.residual, before.speed, curves.built.kept, system, switching,
    )  # fmt: skip


def _reversals(torque: FloatArray) -> int:
    """Changes of sign; a torque of nothing, within a play, has none."""
    return int(np.count_nonzero(np.diff(np.sign(torque[np.abs(torque) > 1e-9 * np.abs(torque).max(initial=0.0)]))))


def _samples(settings: TransientSettings, found: Modes) -> int:
    if settings.samples is not None:
        return settings.samples
    highest = float(found.frequency.max(initial=1.0 / settings.duration))
    return int(min(max(PER_PERIOD * highest * settings.duration, 1000.0), DEFAULT_MOST))


def run(work: Work) -> None:
    """The motion over time that the file names."""
    settings = work.settings("transient", TransientSettings)
    with work.log.step("motion over time", "requested") as step:
        found = transient(work.study, work.system, settings, progress=work.progress)
        step.method = "exact propagation of all modes" if found.switching is None else "exact from event to event"
        step.size = f"{found.modes} modes, {len(settings.events)} events, {len(found.time)} samples"
    work.put(transient=found)
