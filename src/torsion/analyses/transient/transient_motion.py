"""Motion over time of a train, exactly from its modes: torques, their peaks and reversals, and speeds."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from torsion.analyses.response.solver import ground_damping
from torsion.analyses.transient.following_events import Load
from torsion.analyses.transient.following_torques import Carrier, following
from torsion.analyses.transient.joint_cuts import JointCut, joint_cuts, parts_of
from torsion.analyses.transient.known_loads import known_loads, start
from torsion.analyses.transient.state_before import State, points_of_events, state_before
from torsion.analyses.transient.train_curves import TrainCurves, sampled
from torsion.analyses.transient.transient_settings import DEFAULT_MOST, PATH, PER_PERIOD, TransientSettings
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, Work, silent
from torsion.kernels.spanning_forest import connected
from torsion.kernels.transient.damped_motion import ModalTrain, Motion, motion
from torsion.kernels.transient.driven_motion import DrivenMotion
from torsion.results import reported, result
from torsion.study import Study

MOST_MODES = 3000
CHECKED = 64  # windows in which the balance of energy is verified
GAUSS = 8


@reported
class Change:
    """A change of the law of a torque."""

    time: float = result("s", (), "when")
    what: str = result("", (), "the torque")


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
    steps: int = result("", (), "steps for the torques that follow the motion; 0: there are none", default=0)
    following: tuple[str, ...] = result("", (), "torques that follow the motion", default=())
    left_in_series: float = result(
        "1", (), "largest last term of their series over a step, of the largest of them", default=0.0
    )
    changes: tuple[Change, ...] = result("", (), "when a torque that follows the motion changes its law", default=())
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
    before = state_before(study, system, settings)
    cuts = joint_cuts(system, before.mean)
    parts = parts_of(system) if cuts else system
    found = _all_modes(parts, len(cuts)) if modes is None or cuts else modes
    shape = _shapes(parts, found)
    points = points_of_events(study, system, settings, before)
    follows = following(study, system, settings.events, before, cuts, points, lambda cut: _inertia(shape, cut))
    train = _modal_train(parts, found, shape, before, _loaded(study, settings) if follows else None)
    if damping_ratio is not None:
        train = ModalTrain(train.w, np.full(len(train.w), damping_ratio), np.zeros_like(train.viscous))
    loads, force = known_loads(study, system, settings.events, points, shape, follows)
    place, speed = start(system, found, before, shape, vibrates=follows is not None and not cuts)
    added: dict[str, Any] = {}
    moved: Motion | DrivenMotion = motion(train, force, loads, place, speed)
    if follows is not None and isinstance(moved, Motion):
        moved, solved = follows.solve(system, moved, shape, settings.duration, settings.tolerance)
        changed = dict.fromkeys((time, follows.words[law]) for time, law, _ in solved.changes)
        changes = tuple(Change(*one) for one in changed)
        added = {
            "steps": len(solved.steps.begin),
            "following": tuple(dict.fromkeys(follows.words)),
            "left_in_series": solved.lack,
            "changes": changes,
        }
        before = replace(before, frequency=np.empty(0), amplitude=before.amplitude[:0])
    time = np.linspace(0.0, settings.duration, _samples(settings, found) + 1)
    carrier = standing_still(system, before) if follows is None else follows.carrier
    curves = TrainCurves(system, found, before, shape, moved, _slowed(parts, found, shape), carrier, follows)
    torque, turning, (top, bottom) = sampled(curves, time, progress)
    reversals = np.count_nonzero(np.diff(np.signbit(torque), axis=1), axis=1)
    missed = _missed(found, moved, time)
    checked = _residual(moved, time)
    return TransientMotion(
        time, torque, turning, *top, -bottom[0], bottom[1], before.torque, reversals, missed, checked, before.speed,
        len(found.frequency), **added, system=system,
    )  # fmt: skip


def standing_still(system: System, before: State) -> Carrier:
    """How a train turns whose speed no event changes by itself."""
    ratio = np.abs(system.speed_ratio)
    return Carrier(np.zeros(len(ratio)), before.speed * ratio, ratio)


def _inertia(shape: FloatArray, cut: JointCut) -> float:
    """kg m2 of both sides of a joint, as they take a sudden torque."""
    return 1.0 / float((shape[[cut.front, cut.behind]] ** 2).sum())


def _loaded(study: Study, settings: TransientSettings) -> frozenset[int]:
    """Stations that the law of a load brakes, in place of their dampers to ground."""
    return frozenset(
        study.train.part(event.at).stations[0] for event in settings.events if isinstance(event.body, Load)
    )


def _all_modes(system: System, joints: int) -> Modes:
    """Every elastic mode, certified, of a train cut at so many joints."""
    if system.bars is not None:
        message = f"motion over time is not built for the model {system.model}"
        raise SolveError(message, "model: lumped", PATH)
    if (size := system.condensed.tree.size) > MOST_MODES:
        message = f"motion over time takes all modes, and the train has {size} stations, more than {MOST_MODES}"
        raise SolveError(message, "give long shafts fewer `segments`", PATH)
    found = modes_as_discretised(system, None)
    if found.rigid > 1 + joints:
        message = "parts of the train turn freely against each other, and their motion over time is not built"
        raise SolveError(message, "join them by a stiffness", PATH)
    return found


def _shapes(system: System, found: Modes) -> FloatArray:
    """(stations, rigid motions + modes) rad at own speed, generalised inertia 1."""
    ratio, heavy = system.speed_ratio, np.where(system.held, 0.0, system.lumped_inertia) * system.speed_ratio**2
    elastic = np.isfinite(system.flexibility)
    part = connected(len(ratio), system.driving[elastic], system.driven[elastic])
    loose = [one for one in np.unique(part[heavy > 0.0]).tolist() if not system.held[part == one].any()]
    rigid = [np.where(part == one, ratio / math.sqrt(float(heavy[part == one].sum())), 0.0) for one in loose]
    return np.concatenate([np.array(rigid).reshape(-1, len(ratio)).T, found.shape], axis=1)


def _modal_train(
    system: System, found: Modes, shape: FloatArray, before: State, loaded: frozenset[int] | None
) -> ModalTrain:
    """The modes with what damps them: loss factors by their shares of the energy, viscous damping as it is.

    loaded: where the speed changes by itself, dampers to ground damp the deviation from the mean motion of the whole
    train, but for those of these stations, whose load follows their speed.
    """
    ratio = 0.5 * system.loss_factor @ found.elastic
    damping = np.zeros((shape.shape[1],) * 2)
    damped = np.flatnonzero(system.viscous > 0)
    if damped.size:
        twist = _twist(system, found, shape, damped)
        damping += (system.viscous[damped, None] * twist).T @ twist
    system = replace(system, dampers=tuple(one for one in system.dampers if one.station not in (loaded or ())))
    if system.dampers:
        ground = ground_damping(system, np.array([before.speed]), before.mean)[:, 0]
        deviation = shape if loaded is None or system.held.any() else shape - _mean_motion(system, shape)
        damping += (ground[:, None] * deviation).T @ deviation
    return ModalTrain(2.0 * math.pi * found.frequency, ratio, damping)


def _mean_motion(system: System, shape: FloatArray) -> FloatArray:
    """(stations, rigid motions + modes) of the shapes: what of them turns all stations alike."""
    weight = system.lumped_inertia * system.speed_ratio
    return np.asarray(np.outer(system.speed_ratio, weight @ shape) / float(weight @ system.speed_ratio))


def _twist(system: System, found: Modes, shape: FloatArray, spans: IntArray) -> FloatArray:
    """(spans, rigid motions + modes) rad at the driving station's speed: from torques, as angles would cancel."""
    rigid = shape.shape[1] - found.torque.shape[1]
    slips = np.isinf(system.flexibility[spans])
    twist = np.zeros((len(spans), shape.shape[1]))
    twist[:, rigid:] = np.where(slips, 0.0, system.flexibility[spans])[:, None] * found.torque[spans]
    ends = shape[system.driving[spans]] - shape[system.driven[spans]] / system.span_ratio[spans, None]
    return np.where(slips[:, None], ends, twist)


def _samples(settings: TransientSettings, found: Modes) -> int:
    if settings.samples is not None:
        return settings.samples
    highest = float(found.frequency.max(initial=1.0 / settings.duration))
    return int(min(max(PER_PERIOD * highest * settings.duration, 1000.0), DEFAULT_MOST))


def _slowed(system: System, found: Modes, shape: FloatArray) -> FloatArray:
    """(spans, rigid motions + modes) N m s/rad."""
    slowed, damped = np.zeros((len(system.spans), shape.shape[1])), np.flatnonzero(system.viscous > 0)
    slowed[damped] = system.viscous[damped, None] * _twist(system, found, shape, damped)
    return slowed


def _missed(found: Modes, moved: Motion | DrivenMotion, time: FloatArray) -> FloatArray:
    """(spans,) N m that modes with fewer than 4 samples in a period add at most, by their amplitudes at the samples."""
    step = float(time[1] - time[0])
    fast = np.flatnonzero(found.frequency * step > 0.25)
    if not fast.size:
        return np.zeros(len(found.torque))
    chosen = time[:: max(1, len(time) // 1000)]
    place, speed = (rows[rows.shape[0] - len(found.frequency) :][fast] for rows in moved.at(chosen))
    amplitude = np.hypot(place, speed / (2.0 * math.pi * found.frequency[fast])[:, None]).max(axis=1)
    return np.asarray(np.abs(found.torque[:, fast]) @ amplitude)


def _residual(moved: Motion | DrivenMotion, time: FloatArray) -> float:
    """Largest error of energy + losses - work over short windows, by Gauss quadrature, of the largest energy."""
    w, damping = moved.train.w_of_all, moved.train.damping
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    starts = np.linspace(0.0, float(time[-1]), CHECKED, endpoint=False)
    length = min(1.0 / float(w.max(initial=1.0 / time[-1])), float(time[-1]) / CHECKED)
    worst, largest = 0.0, 0.0
    cuts = moved.cuts
    for begin in starts.tolist():
        later = cuts[(cuts > begin)]
        end = min(begin + length, float(later[0]) if later.size else math.inf, float(time[-1]))
        at = np.concatenate([[begin], begin + (nodes + 1.0) / 2.0 * (end - begin), [end]])
        place, speed = moved.at(at)
        energy = 0.5 * (speed**2 + (w[:, None] * place) ** 2).sum(axis=0)
        power = ((moved.force_at(at) - damping @ speed) * speed).sum(axis=0)[1:-1]
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
