"""Motion over time of a linear train, exactly from its modes: torques, their peaks and reversals, and speeds."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.solver import ground_damping
from torsion.analyses.transient.peaks import Extremes
from torsion.analyses.transient.state_before import State, loads_of_events, state_before
from torsion.analyses.transient.transient_settings import DEFAULT_MOST, PATH, PER_PERIOD, TransientSettings
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, Work, silent
from torsion.kernels.transient.damped_motion import ModalTrain, Motion, motion
from torsion.kernels.transient.torque_history import value
from torsion.results import reported, result
from torsion.study import Study

MOST_MODES = 3000
BLOCK = 2**21  # values of one array at once
CHECKED = 64  # windows in which the balance of energy is verified
GAUSS = 8


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
    modes: int = result("", (), "elastic modes that were kept: all")
    system: System | None = None

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
    found = _all_modes(system) if modes is None else modes
    before = state_before(study, system, settings)
    shape = _shapes(system, found)
    train = _modal_train(study, system, found, shape, before)
    if damping_ratio is not None:
        train = ModalTrain(train.w, np.full(len(train.w), damping_ratio), np.zeros_like(train.viscous))
    loads, force = loads_of_events(study, system, settings, before, shape)
    place, speed = _start(system, found, before, shape)
    moved = motion(train, force, loads, place, speed)
    time = np.linspace(0.0, settings.duration, _samples(settings, found) + 1)
    torque, turning, (top, bottom) = _sampled(
        _Curves(system, found, before, shape, moved, _slowed(system, found, shape)), time, progress
    )
    reversals = np.count_nonzero(np.diff(np.signbit(torque), axis=1), axis=1)
    missed = _missed(found, moved, time)
    checked = _residual(moved, time)
    return TransientMotion(
        time, torque, turning, *top, -bottom[0], bottom[1], before.torque, reversals, missed, checked, before.speed,
        len(found.frequency), system,
    )  # fmt: skip


def _all_modes(system: System) -> Modes:
    """Every elastic mode, certified."""
    if system.bars is not None:
        message = f"motion over time is not built for the model {system.model}"
        raise SolveError(message, "model: lumped", PATH)
    if (size := system.condensed.tree.size) > MOST_MODES:
        message = f"motion over time takes all modes, and the train has {size} stations, more than {MOST_MODES}"
        raise SolveError(message, "give long shafts fewer `segments`", PATH)
    found = modes_as_discretised(system, None)
    if found.rigid > 1:
        message = "parts of the train turn freely against each other, and their motion over time is not built"
        raise SolveError(message, "join them by a stiffness", PATH)
    return found


def _shapes(system: System, found: Modes) -> FloatArray:
    """(stations, rigid motions + modes) rad at own speed, generalised inertia 1."""
    ratio = system.speed_ratio
    total = float((np.where(system.held, 0.0, system.lumped_inertia) * ratio**2).sum())
    rigid = (ratio / math.sqrt(total))[:, None] if found.rigid else np.empty((len(ratio), 0))
    return np.concatenate([rigid, found.shape], axis=1)


def _modal_train(study: Study, system: System, found: Modes, shape: FloatArray, before: State) -> ModalTrain:
    """The modes with what damps them: loss factors by their shares of the energy, viscous damping as it is."""
    ratio = 0.5 * system.loss_factor @ found.elastic
    damping = np.zeros((shape.shape[1],) * 2)
    damped = np.flatnonzero(system.viscous > 0)
    if damped.size:
        twist = _twist(system, found, shape, damped)
        damping += (system.viscous[damped, None] * twist).T @ twist
    if system.dampers:
        ground = ground_damping(system, np.array([before.speed]), before.mean)[:, 0]
        damping += (ground[:, None] * shape).T @ shape
    return ModalTrain(2.0 * math.pi * found.frequency, ratio, damping)


def _twist(system: System, found: Modes, shape: FloatArray, spans: IntArray) -> FloatArray:
    """(spans, rigid motions + modes) rad at the driving station's speed: from torques, as angles would cancel."""
    rigid = shape.shape[1] - found.torque.shape[1]
    slips = np.isinf(system.flexibility[spans])
    twist = np.zeros((len(spans), shape.shape[1]))
    twist[:, rigid:] = np.where(slips, 0.0, system.flexibility[spans])[:, None] * found.torque[spans]
    ends = shape[system.driving[spans]] - shape[system.driven[spans]] / system.span_ratio[spans, None]
    return np.where(slips[:, None], ends, twist)


def _start(system: System, found: Modes, before: State, shape: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places and speeds of rigid motions and modes that deviate from the steady motion at time 0."""
    rigid = shape.shape[1] - found.torque.shape[1]
    place, speed = np.zeros(shape.shape[1]), np.zeros(shape.shape[1])
    if before.twist.any():
        flexibility = np.where(np.isfinite(system.flexibility), system.flexibility, 0.0)
        place[rigid:] = found.torque.T @ (flexibility * before.twist) / (2.0 * math.pi * found.frequency) ** 2
    return place, speed


def _samples(settings: TransientSettings, found: Modes) -> int:
    if settings.samples is not None:
        return settings.samples
    highest = float(found.frequency.max(initial=1.0 / settings.duration))
    return int(min(max(PER_PERIOD * highest * settings.duration, 1000.0), DEFAULT_MOST))


@dataclass(frozen=True)
class _Curves:
    """Torques and speeds at any time."""

    system: System
    found: Modes
    before: State
    shape: FloatArray  # (stations, rigid motions + modes)
    motion: Motion
    slowed: FloatArray  # (spans, rigid motions + modes) N m s/rad: the damping part of the torques, of speeds

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Torques (spans, times) with the damping part, their rates, and speeds (stations, times) of the stations."""
        place, speed = self.motion.at(time)
        vibration, its_rate = _vibration(self.before, time)
        elastic = self.found.torque @ place[self.motion.train.rigid :]
        torque = self.before.torque[:, None] + elastic + self.slowed @ speed + vibration
        rate = self.found.torque @ speed[self.motion.train.rigid :] + its_rate
        if self.slowed.any():
            rate += self.slowed @ self.motion.acceleration(time, place, speed)
        return torque, rate, self.before.speed * np.abs(self.system.speed_ratio)[:, None] + self.shape @ speed

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""
        order = np.argsort(at, kind="stable")
        place, speed, gained = np.empty((3, self.shape.shape[1], len(at)))
        place[:, order], speed[:, order] = self.motion.at(at[order])
        vibration, its_rate = _vibration(self.before, at, span)
        elastic, slowed = self.found.torque[span], self.slowed[span]
        rigid = self.motion.train.rigid
        torque = self.before.torque[span] + _paired(elastic, place[rigid:]) + _paired(slowed, speed) + vibration
        rate = _paired(elastic, speed[rigid:]) + its_rate
        if slowed.any():
            gained[:, order] = self.motion.acceleration(at[order], place[:, order], speed[:, order])
            rate = rate + _paired(slowed, gained)
        return torque, rate


def _paired(rows: FloatArray, columns: FloatArray) -> FloatArray:
    """Of row k and column k."""
    return np.asarray(np.einsum("km,mk->k", rows, columns))


def _slowed(system: System, found: Modes, shape: FloatArray) -> FloatArray:
    """(spans, rigid motions + modes) N m s/rad."""
    slowed, damped = np.zeros((len(system.spans), shape.shape[1])), np.flatnonzero(system.viscous > 0)
    slowed[damped] = system.viscous[damped, None] * _twist(system, found, shape, damped)
    return slowed


def _sampled(
    curves: _Curves, time: FloatArray, progress: Progress
) -> tuple[FloatArray, FloatArray, tuple[tuple[FloatArray, FloatArray], ...]]:
    """Torques (spans, times), speeds (stations, times); values and times of the greatest torque and its negative."""
    spans, stations = len(curves.slowed), len(curves.shape)
    torque, turning = np.empty((spans, len(time))), np.empty((stations, len(time)))
    high, low = Extremes.none(spans), Extremes.none(spans)
    size = max(2, BLOCK // max(curves.shape.shape[1], spans, stations))
    for first in range(0, len(time) - 1, size):
        part = slice(first, min(first + size, len(time) - 1) + 1)  # a block begins with the last sample before it
        torque[:, part], rate, turning[:, part] = curves.torque(time[part])
        high.add(time[part], torque[:, part], rate)
        low.add(time[part], -torque[:, part], -rate)
        progress("motion over time", part.stop / len(time))

    def negative(span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, rate = curves.torque_of(span, at)
        return -value, -rate

    ends = []
    for sampled, extremes, function in ((torque, high, curves.torque_of), (-torque, low, negative)):
        top, when = extremes.exact(function)
        best = sampled.argmax(axis=1)
        of_samples = sampled[np.arange(spans), best]
        ends.append((np.maximum(top, of_samples), np.where(top >= of_samples, when, time[best])))
    return torque, turning, tuple(ends)


def _vibration(before: State, time: FloatArray, span: IntArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Torque of the steady vibration and its rate of change, (spans, times); with `span` of its pairs with times."""
    turned = np.exp(1j * np.multiply.outer(before.frequency, time))
    growing = 1j * before.frequency[:, None] * turned
    if span is None:
        torque, rate = (before.amplitude.T @ wave for wave in (turned, growing))
    else:
        torque, rate = ((before.amplitude[:, span] * wave).sum(axis=0) for wave in (turned, growing))
    return torque.real, rate.real


def _missed(found: Modes, moved: Motion, time: FloatArray) -> FloatArray:
    """(spans,) N m that modes with fewer than 4 samples in a period add at most, by their amplitudes at the samples."""
    step = float(time[1] - time[0])
    fast = np.flatnonzero(found.frequency * step > 0.25)
    if not fast.size:
        return np.zeros(len(found.torque))
    chosen = time[:: max(1, len(time) // 1000)]
    place, speed = (rows[rows.shape[0] - len(found.frequency) :][fast] for rows in moved.at(chosen))
    amplitude = np.hypot(place, speed / (2.0 * math.pi * found.frequency[fast])[:, None]).max(axis=1)
    return np.asarray(np.abs(found.torque[:, fast]) @ amplitude)


def _residual(moved: Motion, time: FloatArray) -> float:
    """Largest error of energy + losses - work over short windows, by Gauss quadrature, of the largest energy."""
    w, damping = moved.train.w_of_all, moved.train.damping
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    starts = np.linspace(0.0, float(time[-1]), CHECKED, endpoint=False)
    length = min(1.0 / float(w.max(initial=1.0 / time[-1])), float(time[-1]) / CHECKED)
    worst, largest = 0.0, 0.0
    cuts = moved.coordinates.history.begin
    for begin in starts.tolist():
        later = cuts[(cuts > begin)]
        end = min(begin + length, float(later[0]) if later.size else math.inf, float(time[-1]))
        at = np.concatenate([[begin], begin + (nodes + 1.0) / 2.0 * (end - begin), [end]])
        place, speed = moved.at(at)
        energy = 0.5 * (speed**2 + (w[:, None] * place) ** 2).sum(axis=0)
        acting = np.array([value(pieces, at) for pieces in moved.loads]).reshape(-1, len(at))
        power = ((moved.force @ acting - damping @ speed) * speed).sum(axis=0)[1:-1]
        worst = max(worst, abs(energy[-1] - energy[0] - (end - begin) / 2.0 * float(weights @ power)))
        largest = max(largest, float(energy.max()))
    return worst / largest if largest else 0.0


def run(work: Work) -> None:
    """The motion over time that the file names."""
    settings = work.settings("transient", TransientSettings)
    with work.log.step("motion over time", "requested") as step:
        found = transient(work.study, work.system, settings, progress=work.progress)
        step.method = "exact propagation of all modes"
        step.size = f"{found.modes} modes, {len(settings.events)} events, {len(found.time)} samples"
    work.put(transient=found)
