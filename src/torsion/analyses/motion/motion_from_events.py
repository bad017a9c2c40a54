"""Motion over time of a train from its events, by the path that its couplings and torques need."""

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.motion.curves.peaks import PER_PERIOD
from torsion.analyses.motion.curves.torque_curves import Curves, Seen, look_at, sample_times
from torsion.analyses.motion.derived.fatigue import damages
from torsion.analyses.motion.events.machine_events import SpeedProgram
from torsion.analyses.motion.events.milling_ice import Ice
from torsion.analyses.motion.events.transient_settings import PATH, TransientSettings, cases
from torsion.analyses.motion.train.loaded_train import Built, LoadedTrain, in_modes, load_train
from torsion.analyses.motion.train.modal_train import kept_modes, train_in_modes
from torsion.analyses.motion.train.state_before import (
    acting_torques,
    point,
    state_before,
    without_excluded_torques,
)
from torsion.analyses.motion.transient_motion import (
    RESOLVED,
    TINY,
    Change,
    CouplingEvent,
    CouplingWork,
    Switching,
    TransientMotion,
    Transients,
)
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.findings import Progress, Work, silent
from torsion.kernels.motion.event_driven_motion import EnergyBalance, energy_balance
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.kernels.motion.collocation import Marched

TOLERANCE = 1e-6  # of the peak of a span: two runs that differ by more are not the same motion
COMPARED = 2000  # times at which they are compared


def transient(
    study: Study,
    system: System,
    settings: TransientSettings,
    *,
    path: Path = PATH,
    modes: tuple[Modes, Modes] | None = None,
    damping_ratio: float | None = None,
    progress: Progress = silent,
) -> TransientMotion:
    """The motion from the events of `settings`, exact at every sample, and its peaks between them.

    path: of the settings in the file. modes: those kept, and twice as many, where they are known. damping_ratio: of
    every mode, in place of the damping of the train. Raises InputError for an event that the train cannot have and for
    too few samples, SolveError where a mode is not certified or the train is of a kind that is not built.
    """
    torques = acting_torques(study, settings)
    study, system = without_excluded_torques(study, system, settings)

    def solve(settings: TransientSettings) -> TransientMotion:
        if study.train.has_nonlinear_couplings:
            return _event_driven(study, system, settings, path, damping_ratio, progress)
        return _linear(study, system, settings, path, modes, damping_ratio, progress)

    if any(event.body.leaves_open for event in settings.events):
        from torsion.analyses.motion.derived.worst_case import faults_of, worst_motion

        if modes is None and faults_of(settings, scanned=True):
            all_modes = study.train.has_nonlinear_couplings
            modes = kept_modes(system, "all" if all_modes else settings.modes, path)
        frequency = np.empty(0) if modes is None else modes[0].frequency
        parts = [study.train.parts[number] for number in system.span_part.tolist()]
        rated = [part.greatest_torque(is_rare=False) for part in parts]
        # A part with a limit on the range alone is looked at too.
        ranges = [part.ratings and part.ratings.max_torque_range for part in parts]
        limit = [
            stated[1] if stated else extent or np.nan
            for stated, extent in zip(rated, ranges, strict=True)
        ]
        worst = worst_motion(settings, solve, np.array(limit, dtype=float), frequency, path)
    else:
        worst = solve(settings)
    moved = _with_ratings(study, system, settings, worst)
    return replace(moved, acting=torques.acting, not_acting=torques.not_acting)


def _linear(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    modes: tuple[Modes, Modes] | None,
    damping_ratio: float | None,
    progress: Progress,
) -> TransientMotion:
    """The motion of a train whose couplings are linear; settings leave no phase open."""
    before = state_before(study, system, settings, path)
    if system.uneven_joints.size:
        from torsion.analyses.motion.train.joints import joint_cuts, parts_of

        cuts = joint_cuts(system, before.mean)
        modes = kept_modes(parts_of(system, cuts), settings.modes, path)
    elif modes is None:
        modes = kept_modes(system, settings.modes, path)
    kept, twice = modes
    needed = 8.0 * (len(system.spans) + 2 * len(system.stations))
    needed *= len(sample_times(settings, kept))
    if needed > study.memory:
        message = f"all samples need {needed / 1e9:.2g} GB of memory, more than {study.memory / 1e9:.2g} GB"
        raise SolveError(message, "fewer `samples`, or run with more `memory`", (*path, "samples"))

    is_band, motions = system.bars is not None or kept is not twice, list[TransientMotion]()
    has_more = kept is not twice and len(twice.frequency) > len(kept.frequency)
    for modes_chosen in (kept, twice) if has_more else (kept,):
        loaded = load_train(
            study, system, settings, path, before, modes_chosen, damping_ratio=damping_ratio
        )
        motions.append(_modal_motion(study, system, loaded, progress, is_band=is_band))
    moved, finer = motions[0], motions[-1]
    if has_more:
        ends = ((finer.greatest, moved.greatest), (finer.least, moved.least))
        change = np.max([np.abs(fine - coarse) for fine, coarse in ends], axis=0)
        moved = replace(moved, change=float((change / (finer.peak + TINY)).max(initial=0.0)))
    if settings.samples is not None and (moved.unresolved > RESOLVED * (moved.peak + TINY)).any():
        needed_samples = int(PER_PERIOD * settings.duration * moved.fastest / (2.0 * math.pi)) + 1
        message = (
            "torques or modes with fewer than 4 samples in a period may add more than 5 % to a peak"
        )
        hint = f"{needed_samples} resolve all; or keep fewer `modes`"
        raise InputError([Fault((*path, "samples"), message, hint)])
    return moved


def _modal_motion(
    study: Study, system: System, loaded: LoadedTrain, progress: Progress, *, is_band: bool
) -> TransientMotion:
    """Return the motion of a train without nonlinear couplings in the modes that are kept."""
    built, added = in_modes(loaded, *loaded.start(), is_band=is_band), dict[str, Any]()
    ((moved, marched),) = built.run(progress=progress)
    curves = Curves(built, moved)
    seen = look_at(curves, progress, counts=loaded.settings.fatigue is not None)
    if marched is not None and loaded.follows is not None:
        from torsion.analyses.motion.derived.resonances_passed import passages

        noise = loaded.settings.tolerance * marched.largest
        added["noise"] = noise / np.abs(system.speed_ratio[system.driving])
        straight = loaded.damping
        if loaded.cuts:  # resonances are those of the train with its joints straight
            modes = modes_as_discretised(system, None)
            straight = train_in_modes(system, modes, loaded.before, is_driven=True).damped()
        added["passages"] = passages(system, loaded.follows, straight, seen.time, seen.turning)
    if loaded.follows is not None or loaded.settings.orders is not None:
        from torsion.analyses.motion.derived.order_tracking import order_tracking, orders_requested

        if (requested := orders_requested(study, system, loaded, seen)) is not None:
            size = max(loaded.shape.shape[1], len(system.spans))
            sampled = seen.time, seen.angle[requested.station], seen.turning[requested.station]
            added["orders"] = order_tracking(curves, requested, sampled, size)
    highest = max(float(loaded.w.max(initial=0.0)), *(wave.w for wave in curves.waves))
    residual = energy_balance(moved).residual
    return _result(system, curves, seen, residual, marched, fastest=highest, **added)


def _event_driven(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    damping_ratio: float | None,
    progress: Progress,
) -> TransientMotion:
    """The motion of a train with nonlinear couplings; peaks are looked for between its events too."""
    from torsion.analyses.motion.train.nonlinear_couplings import build

    built = build(study, system, settings, path, damping_ratio=damping_ratio)
    ((motion, marched),) = built.run(progress=progress)
    curves, balance = Curves(built, motion), energy_balance(motion)
    ((finer_motion, _),) = built.run(fineness=0.5, progress=progress)
    fine = Curves(built, finer_motion)
    compared = np.linspace(0.0, settings.duration, COMPARED)
    late = np.flatnonzero(_changes(curves, fine, compared) > TOLERANCE)
    switching = _switching(built, curves, balance)
    if built.is_band:
        half = build(study, system, settings, path, damping_ratio=damping_ratio, halved=True)
        ((half_motion, _),) = half.run()
        change = _changes(curves, Curves(half, half_motion), compared)
        switching = replace(switching, band_change=float(change.max()))
    seen = look_at(curves, progress, counts=settings.fatigue is not None)
    if late.size:
        ends, fine_ends = seen.ends, look_at(fine, progress, counts=False).ends
        peak, fine_peak = (np.maximum(top[0], bottom[0]) for top, bottom in (ends, fine_ends))
        switching = replace(
            switching, sensitive_after=float(compared[late[0]]), scatter=np.abs(peak - fine_peak)
        )
        larger = tuple(
            (np.maximum(end[0], finer[0]), np.where(end[0] >= finer[0], end[1], finer[1]))
            for end, finer in zip(ends, fine_ends, strict=True)
        )
        seen = replace(seen, ends=larger)
    if any(wave.w >= seen.left for wave in curves.regimes):
        # Nothing bounds what a coupling does.
        unbounded = np.maximum(*(np.abs(end[0]) for end in seen.ends))
        seen = replace(seen, lacking=seen.lacking + unbounded)
    return _result(system, curves, seen, balance.residual, marched, switching=switching)


def _changes(curves: Curves, finer: Curves, time: FloatArray) -> FloatArray:
    """(times,) largest difference of a torque, of the peak of its span."""
    first, second = (motion.torque(time)[0] for motion in (curves, finer))
    peak = np.maximum(np.abs(first).max(axis=1), 1e-9 * np.abs(first).max())
    scale = np.where(peak > 0.0, peak, 1.0)[:, None]
    return np.asarray((np.abs(first - second) / scale).max(axis=0))


def _switching(built: Built, curves: Curves, balance: EnergyBalance) -> Switching:
    """What the couplings did in a motion; nothing yet of how sure that is."""
    couplings = [stand.coupling for stand in built.standing]
    names = [coupling.part.name for coupling in built.couplings]
    changes = [(event.time, couplings[event.element], event.word) for event in curves.motion.events]
    counts, heat = Counter(change[1:] for change in changes), np.zeros(len(names))
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
    events = tuple(CouplingEvent(time, names[number], word) for time, number, word in changes)
    return Switching(events, works, balance.work, balance.damped, None, 0.0)


def _result(
    system: System,
    curves: Curves,
    seen: Seen,
    residual: float,
    marched: "Marched | None",
    *,
    noise: FloatArray | float = 0.0,
    **added: Any,
) -> TransientMotion:
    """The declared result of what was seen; noise: N m, of torques whose changes of sign do not count."""
    loaded, (top, bottom) = curves.loaded, seen.ends
    if loaded.follows is not None and marched is not None:
        words = [follower.words for follower in loaded.follows]
        changed = dict.fromkeys((time, words[law]) for time, law, _ in marched.changes)
        added["steps"], added["left_in_series"] = marched.number, marched.lack
        added["following"] = tuple(dict.fromkeys(words))
        added["changes"] = tuple(Change(*change) for change in changed)
    # A torque of nothing, within a play, changes no sign.
    floors = np.maximum([1e-9 * np.abs(turns).max(initial=0.0) for turns in seen.turns], noise)
    felt = [turns[np.abs(turns) > floor] for turns, floor in zip(seen.turns, floors, strict=True)]
    reversals = [np.count_nonzero(np.diff(np.sign(turns))) for turns in felt]
    return TransientMotion(
        seen.time,
        seen.torque,
        seen.turning,
        *top,
        -bottom[0],
        bottom[1],
        loaded.before.torque,
        np.array(reversals, dtype=np.int64),
        seen.lacking,
        residual,
        loaded.before.speed,
        len(loaded.modes.frequency),
        system,
        loaded.settings.name,
        turns=seen.turns,
        **added,
    )


def _with_ratings(
    study: Study, system: System, settings: TransientSettings, moved: TransientMotion
) -> TransientMotion:
    """With rated torques, stresses and damage, ice torques, and what loads and ice do to the speed."""
    operation, rated = study.operation, None
    if operation.rated is not None and study.has_mean_torque:
        from torsion.analyses.steady import steady

        speed = np.array([operation.rated.speed])
        rated = steady(study.train, system, operation, speed).torque[:, 0]
    stress = np.full(len(system.spans), np.nan)
    for bar in study.train.bars:
        spans = system.span_part == bar.part
        stress[spans] = moved.peak[spans] / stress_modulus(bar)
    ice = (
        event.body.of_class(point(study, system, moved.speed_before, event.at))
        for event in settings.events
        if isinstance(event.body, Ice)
    )
    undamped: tuple[str, ...] = ()
    if settings.has_damping_loads:
        from torsion.analyses.motion.train.following_torques import replaced_dampers

        undamped = tuple(replaced_dampers(study, system, settings, PATH).values())
    damage = None if settings.fatigue is None else damages(system, settings.fatigue, moved.turns)
    return replace(
        moved,
        rated=rated,
        stress=stress if study.train.bars else None,
        damage=damage,
        turns=(),
        is_rare=settings.is_rare,
        ice=tuple(torque for torque in ice if torque is not None),
        slowed=_slowed(study, system, settings, moved),
        undamped=undamped,
    )


def _slowed(
    study: Study, system: System, settings: TransientSettings, moved: TransientMotion
) -> float | None:
    """Largest change of a propeller's mean speed over a revolution in ice, of that before.

    None without ice, where torques follow the speed, and where a program prescribes it.
    """
    bodies, time, changes = [event.body for event in settings.events], moved.time, list[float]()
    if moved.steps or any(isinstance(body, SpeedProgram) for body in bodies):
        return None
    for name in dict.fromkeys(event.at for event in settings.events if isinstance(event.body, Ice)):
        station = study.train[name].stations[0]
        speed = moved.speed[station]
        before = moved.speed_before * abs(float(system.speed_ratio[station])) or float(speed[0])
        angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
        revolution = min(2.0 * math.pi / before, settings.duration)
        begins = time[time <= settings.duration - revolution]
        turned = np.interp(begins + revolution, time, angle) - np.interp(begins, time, angle)
        change = turned / (revolution * before) - 1.0
        changes.append(float(change[np.abs(change).argmax()]))
    return max(changes, key=abs, default=None)


def run(work: Work) -> None:
    """Every motion over time that the file names; one without an answer takes no other with it."""
    motions, errors = list[TransientMotion](), list[InputError | SolveError]()
    modes = dict[Any, tuple[Modes, Modes]]()
    is_nonlinear = work.study.train.has_nonlinear_couplings
    for settings, path in cases(work.study):
        title = f"motion over time {settings.name}".rstrip()
        try:
            with work.log.step(title, "requested") as step:
                if settings.modes not in modes and not is_nonlinear:
                    modes[settings.modes] = kept_modes(work.system, settings.modes, path)
                moved = transient(
                    work.study,
                    work.system,
                    settings,
                    path=path,
                    modes=modes.get(settings.modes),
                    progress=work.progress,
                )
                exact = "from event to event" if is_nonlinear else "propagation of the modes"
                step.method = f"exact{',' * is_nonlinear} {exact}"
                if moved.steps:
                    step.method += ", exponential collocation"
                number, samples = len(settings.events), len(moved.time)
                step.size = f"{moved.modes} modes, {number} events, {samples} samples"
                if moved.speed_before and settings.initial is None:
                    step.size += f", begins steady at {moved.speed_before * 30.0 / math.pi:.6g} rpm"
            motions.append(moved)
        except (InputError, SolveError) as error:
            errors.append(error)
            if len(errors) > 1:
                work.log.without(title, str(error))
    if motions:
        work.put(transient=Transients(tuple(motions)))
    if errors:
        raise errors[0]
