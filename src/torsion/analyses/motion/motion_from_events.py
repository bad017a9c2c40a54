"""Motion over time of a train from its events, by the path that its couplings and torques need."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from torsion.analyses.motion.acting_torques import acting_torques, without_excluded_torques
from torsion.analyses.motion.direct_torques import direct_torques
from torsion.analyses.motion.energy_balance import residual
from torsion.analyses.motion.event_driven_curves import Switching, event_driven_curves
from torsion.analyses.motion.fatigue import damages
from torsion.analyses.motion.following_events import SpeedProgram
from torsion.analyses.motion.following_torques import (
    Following,
    carrier_of,
    changes_speed,
    following,
    refuse_beyond_tables,
    replaced_dampers,
    torques_follow,
    without_dampers,
)
from torsion.analyses.motion.joint_cuts import joint_cuts, parts_of
from torsion.analyses.motion.known_loads import known_loads, vibration_before
from torsion.analyses.motion.milling_ice import Ice, IceTorque
from torsion.analyses.motion.modal_train import (
    kept_modes,
    modal_train,
    shapes,
    slowed_torques,
    start,
)
from torsion.analyses.motion.order_tracking import order_tracking
from torsion.analyses.motion.orders_requested import orders_requested
from torsion.analyses.motion.resonances_passed import passages
from torsion.analyses.motion.state_before import State, point, points_of_events, state_before
from torsion.analyses.motion.times_looked_at import PER_PERIOD
from torsion.analyses.motion.torque_curves import Curves, Seen, looked_at_of, missed, sampled
from torsion.analyses.motion.transient_motion import (
    RESOLVED,
    TINY,
    Change,
    TransientMotion,
    Transients,
)
from torsion.analyses.motion.transient_settings import (
    DEFAULT_MOST,
    DEFAULT_PER_PERIOD,
    PATH,
    TransientSettings,
    cases,
)
from torsion.analyses.motion.worst_fault import FaultScan, faults_in_words
from torsion.analyses.motion.worst_phase import Phases, over_phases, share_of_limits
from torsion.analyses.steady import steady
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.findings import Progress, Work, silent
from torsion.kernels.motion.collocation import Marched
from torsion.kernels.motion.damped_motion import ModalTrain, motion
from torsion.study import Study

Peaks = tuple[FloatArray, FloatArray]  # (spans,) N m, and s


def transient(
    study: Study,
    system: System,
    settings: TransientSettings,
    *,
    place: Path = PATH,
    modes: tuple[Modes, Modes] | None = None,
    damping_ratio: float | None = None,
    progress: Progress = silent,
) -> TransientMotion:
    """The motion from the events of `settings`, exact at every sample, and its peaks between them.

    place: of the settings in the file. modes: those kept, and twice as many, where they are known. damping_ratio: of
    every mode, in place of the damping of the train. Raises InputError for an event that the train cannot have and for
    too few samples, SolveError where a mode is not certified or the train is of a kind that is not built.
    """
    torques = acting_torques(study, settings)
    study, system = without_excluded_torques(study, system, settings)
    scan = FaultScan(settings, np.empty(0), place)
    if modes is None and scan.scanned:
        modes = kept_modes(
            system, "all" if study.train.has_nonlinear_couplings else settings.modes, place
        )
    solve = partial(_of_phases, study, system, place, modes, damping_ratio, progress)
    limits = [
        part.ratings.max_torque if part.ratings is not None else None for part in study.train.parts
    ]
    limit = np.array([limits[part] or np.nan for part in system.span_part.tolist()], dtype=float)
    scan = scan if modes is None else replace(scan, frequency=modes[0].frequency)
    found = _read(study, system, settings, _worst_fault(scan, solve, limit))
    return replace(found, acting=torques.acting, not_acting=torques.not_acting)


def _worst_fault(
    scan: FaultScan, solve: Callable[[TransientSettings], TransientMotion], limit: FloatArray
) -> TransientMotion:
    """The motion of the worst fault, with the greatest of every span's torques of all faults.

    limit: (spans,) N m, nan where there is none.
    """
    variants = scan.variants()
    shown = _merged(over_phases(variants[0], solve, limit))
    if len(variants) == 1:
        return shown
    shown, share = (
        replace(shown, worst_fault=faults_in_words(variants[0])),
        share_of_limits(limit, shown.peak),
    )
    peaks = [(shown.peak * share).max(initial=0.0)]

    def compare(settings: TransientSettings) -> None:
        nonlocal shown
        motion = replace(
            _merged(over_phases(settings, solve, limit)), worst_fault=faults_in_words(settings)
        )
        peaks.append((motion.peak * share).max(initial=0.0))
        is_worse = peaks[-1] > (shown.peak * share).max(initial=0.0)
        shown = _greatest((motion, shown) if is_worse else (shown, motion))

    for settings in variants[1:]:
        compare(settings)
    worst_first = np.argsort(-np.array(peaks), kind="stable").tolist()
    for settings in scan.finer_variants([variants[place] for place in worst_first]):
        compare(settings)
    return replace(shown, faults_computed=len(peaks))


def _merged(motions: list[tuple[Phases, TransientMotion]]) -> TransientMotion:
    """The motion of the worst phases, the first, with the greatest of every span's torques of all."""
    if len(motions) == 1:
        return motions[0][1]
    phases = tuple(phase for _, phase in motions[0][0])
    greatest = _greatest([motion for _, motion in motions])
    return replace(greatest, slip_phase=phases, phases_computed=len(motions))


def _greatest(motions: Sequence[TransientMotion]) -> TransientMotion:
    """The first of the motions, with the greatest of every span's torques of all."""
    shown, spans = motions[0], np.arange(len(motions[0].greatest))
    high = np.argmax([motion.greatest for motion in motions], axis=0)
    low = np.argmin([motion.least for motion in motions], axis=0)
    most = np.argmax([motion.peak for motion in motions], axis=0)

    def of(name: str, chosen: IntArray) -> FloatArray:
        return np.asarray(np.array([getattr(motion, name) for motion in motions])[chosen, spans])

    return replace(
        shown,
        greatest=of("greatest", high),
        greatest_at=of("greatest_at", high),
        least=of("least", low),
        least_at=of("least_at", low),
        unresolved=np.max([motion.unresolved for motion in motions], axis=0),
        reversals=np.max([motion.reversals for motion in motions], axis=0),
        residual=max(motion.residual for motion in motions),
        change=None if shown.change is None else max(motion.change or 0.0 for motion in motions),
        left_in_series=max(motion.left_in_series for motion in motions),
        switching=_least_certain(
            [motion.switching for motion in motions if motion.switching is not None]
        ),
        turns=tuple(
            motions[place].turns[span]
            for span, place in enumerate(most.tolist())
            if motions[place].turns
        ),
    )


def _least_certain(every: list[Switching]) -> Switching | None:
    """The first of the switchings, as doubtful as the most doubtful of all; None without any."""
    if not every:
        return None
    scatters = [one.scatter for one in every if one.scatter is not None]
    sensitive = [one.sensitive_after for one in every if one.sensitive_after is not None]
    return replace(
        every[0],
        band_change=max(one.band_change for one in every),
        sensitive_after=min(sensitive, default=None),
        scatter=np.max(scatters, axis=0) if scatters else None,
    )


def _of_phases(
    study: Study,
    system: System,
    place: Path,
    modes: tuple[Modes, Modes] | None,
    damping_ratio: float | None,
    progress: Progress,
    settings: TransientSettings,
) -> TransientMotion:
    """The motion of settings that leave no phase open."""
    if study.train.has_nonlinear_couplings:
        return _event_driven(study, system, settings, place, damping_ratio, progress)
    before = state_before(study, system, settings, place)
    cuts = joint_cuts(system, before.mean)
    if modes is None or cuts:
        modes = kept_modes(parts_of(system, cuts) if cuts else system, settings.modes, place)
    kept, twice = modes
    needed = 8.0 * (len(system.spans) + len(system.stations)) * _samples(settings, kept)
    if needed > study.memory:
        message = f"all samples need {needed / 1e9:.2g} GB of memory, more than {study.memory / 1e9:.2g} GB"
        raise SolveError(message, "fewer `samples`, or run with more `memory`", (*place, "samples"))
    solved = partial(_solved, study, system, settings, place, before, damping_ratio, progress)
    found = solved(kept, is_band=system.bars is not None or kept is not twice)
    if kept is not twice and len(twice.frequency) > len(kept.frequency):
        more = solved(twice, is_band=True)
        ends = ((more.greatest, found.greatest), (more.least, found.least))
        moved = np.max([np.abs(one - other) for one, other in ends], axis=0)
        found = replace(found, change=float((moved / (more.peak + TINY)).max(initial=0.0)))
    if settings.samples is not None and (found.unresolved > RESOLVED * (found.peak + TINY)).any():
        least = int(PER_PERIOD * settings.duration * found.fastest / (2.0 * math.pi)) + 1
        message = (
            "torques or modes with fewer than 4 samples in a period may add more than 5 % to a peak"
        )
        raise InputError(
            [Fault((*place, "samples"), message, f"{least} resolve all; or keep fewer `modes`")]
        )
    return found


def _solved(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path,
    before: State,
    damping_ratio: float | None,
    progress: Progress,
    modes: Modes,
    *,
    is_band: bool,
) -> TransientMotion:
    """The motion of some modes."""
    events, cuts = settings.events, joint_cuts(system, before.mean)
    is_driven, has_laws = changes_speed(system, events), torques_follow(study, system, events)
    points = points_of_events(study, system, events, before, place, turns=has_laws)
    replaced = replaced_dampers(study, system, settings, place)
    parts = without_dampers(parts_of(system, cuts) if cuts else system, replaced)
    shape = shapes(parts, modes)
    train = modal_train(study, parts, modes, shape, before, turns=is_driven)
    if damping_ratio is not None:
        train = ModalTrain(
            train.w, np.full(len(train.w), damping_ratio), np.zeros_like(train.viscous)
        )
    follows = following(study, system, events, points, before, cuts, shape) if has_laws else None
    vibrates = follows is None and bool(before.frequency.size)
    loads, acting = known_loads(study, parts, events, points, follows, before, vibrates=vibrates)
    direct, added, noise = (
        direct_torques(parts, modes, acting, is_band=is_band),
        dict[str, Any](),
        0.0,
    )
    begin = start(parts, modes, before, shape)
    if follows is None:
        moved = motion(train, shape.T @ acting, loads, *begin)
    else:
        if not cuts:
            shaken = vibration_before(parts, modes, before, shape)
            begin = begin[0] + shaken[0], begin[1] + shaken[1]
        before = replace(before, frequency=before.frequency[:0], amplitude=before.amplitude[:0])
        given = motion(train, shape.T @ acting, loads, *begin)
        try:
            moved, solved = follows.solve(system, given, shape, settings, progress)
        except SolveError as error:
            raise SolveError(error.message, error.hint, place) from None
        refuse_beyond_tables(follows, events, solved, place)
        follows.carried(system, direct)
        added, noise = _of_steps(follows, solved), settings.tolerance * solved.largest
    time = np.linspace(0.0, settings.duration, _samples(settings, modes) + 1)
    slowed = slowed_torques(study, parts, modes, shape, before, turns=is_driven)
    patches = [partial(cut.patched, system) for cut in cuts if cut.massless]
    carrier = carrier_of(study, system, events, before, cuts)
    curves = Curves(system, modes, before, shape, moved, slowed, direct, carrier, patches)
    looked, finer = looked_at_of(curves, modes, time, counts=settings.fatigue is not None)
    seen = sampled(curves, looked, progress)
    torque, turning, (top, bottom) = seen.torque, seen.turning, seen.ends
    if follows is not None:
        straight = _straight(study, system, before) if cuts else train
        added["passages"] = passages(system, follows, straight, time, turning)
    lacking = missed(modes, moved, time, finer) + curves.unseen(looked.left)
    peak = np.maximum(np.abs(top[0]), np.abs(bottom[0]))
    requested = orders_requested(
        study, system, settings, place, peak=peak, turning=turning, follows=has_laws
    )
    if requested is not None:
        added["orders"] = order_tracking(curves, requested, time, max(shape.shape[1], len(torque)))
    return TransientMotion(
        time,
        torque,
        turning,
        *top,
        -bottom[0],
        bottom[1],
        before.torque,
        _reversals(seen, noise / np.abs(system.speed_ratio[system.driving])),
        lacking,
        residual(moved, time),
        before.speed,
        len(modes.frequency),
        system,
        settings.name,
        turns=seen.turns,
        fastest=max(curves.fastest, *(one.w for one in curves.waves)),
        **added,
    )


def _event_driven(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path,
    damping_ratio: float | None,
    progress: Progress,
) -> TransientMotion:
    """The motion of a train with nonlinear couplings; peaks are looked for between its events too."""
    curves, balance, switching, fine = event_driven_curves(
        study, system, settings, place, damping_ratio, progress
    )
    built, added = curves.built, dict[str, Any]()
    if built.following is not None and curves.marched is not None:
        added = _of_steps(built.following.follows, curves.marched)
    samples = _samples(settings, built.modes)
    time = np.linspace(0.0, settings.duration, samples + 1)
    looked, finer = looked_at_of(curves, built.modes, time, counts=settings.fatigue is not None)
    seen = sampled(curves, looked, progress)
    before, (top, bottom) = built.before, seen.ends
    if switching.sensitive_after is not None:
        other = sampled(fine, looked_at_of(fine, built.modes, time, counts=False)[0], progress).ends
        scatter = np.abs(np.maximum(top[0], bottom[0]) - np.maximum(other[0][0], other[1][0]))
        switching = replace(switching, scatter=scatter)
        top, bottom = (_larger(one, two) for one, two in zip((top, bottom), other, strict=True))
    lacking = missed(built.modes, curves, time, finer) + curves.unseen(looked.left)
    if any(wave.w >= looked.left for wave in curves.regimes):
        lacking += np.maximum(
            np.abs(top[0]), np.abs(bottom[0])
        )  # nothing bounds what a coupling does
    return TransientMotion(
        time,
        seen.torque,
        seen.turning,
        *top,
        -bottom[0],
        bottom[1],
        before.torque,
        _reversals(seen),
        lacking,
        balance.residual,
        before.speed,
        len(built.modes.frequency),
        system,
        settings.name,
        switching=switching,
        turns=seen.turns,
        **added,
    )


def _larger(one: Peaks, other: Peaks) -> Peaks:
    """The larger of the peaks of two motions, with its time."""
    return np.maximum(one[0], other[0]), np.where(one[0] >= other[0], one[1], other[1])


def _reversals(seen: Seen, noise: FloatArray | float = 0.0) -> IntArray:
    """(spans,) changes of sign; a torque of nothing, within a play, has none. noise: N m that do not count."""
    least = np.maximum([1e-9 * float(np.abs(one).max(initial=0.0)) for one in seen.turns], noise)
    there = [
        one[np.abs(one) > floor] for one, floor in zip(seen.turns, least.tolist(), strict=True)
    ]
    return np.array([np.count_nonzero(np.diff(np.sign(one))) for one in there], dtype=np.int64)


def _straight(study: Study, system: System, before: State) -> ModalTrain:
    """The modes of a train with its joints straight, whose resonances are passed."""
    found = modes_as_discretised(system, None)
    return modal_train(study, system, found, shapes(system, found), before, turns=True)


def _of_steps(follows: Following, solved: Marched) -> dict[str, Any]:
    """What the result says of torques that follow the motion."""
    changed = dict.fromkeys((time, follows.words[law]) for time, law, _ in solved.changes)
    return {
        "steps": solved.number,
        "following": tuple(dict.fromkeys(follows.words)),
        "left_in_series": solved.lack,
        "changes": tuple(Change(*one) for one in changed),
    }


def _samples(settings: TransientSettings, found: Modes) -> int:
    if settings.samples is not None:
        return settings.samples
    highest = float(found.frequency.max(initial=1.0 / settings.duration))
    return int(min(max(DEFAULT_PER_PERIOD * highest * settings.duration, 1000.0), DEFAULT_MOST))


def _read(
    study: Study, system: System, settings: TransientSettings, found: TransientMotion
) -> TransientMotion:
    """With rated torques, stresses and damage."""
    operation, rated = study.operation, None
    if operation.rated is not None and study.has_mean_torque:
        rated = steady(study.train, system, operation, np.array([operation.rated.speed])).torque[
            :, 0
        ]
    stress = np.full(len(system.spans), np.nan)
    for bar in study.train.bars:
        here = system.span_part == bar.part
        stress[here] = found.peak[here] / stress_modulus(bar)
    damage = None if settings.fatigue is None else damages(system, settings.fatigue, found.turns)
    return replace(
        found,
        rated=rated,
        stress=stress if study.train.bars else None,
        damage=damage,
        turns=(),
        is_rare=settings.is_rare,
        ice=tuple(_ice(study, system, settings, found)),
        slowed=_slowed(study, system, settings, found),
        undamped=tuple(replaced_dampers(study, system, settings, PATH).values()),
    )


def _slowed(
    study: Study, system: System, settings: TransientSettings, found: TransientMotion
) -> float | None:
    """Largest change of a propeller's mean speed over a revolution in ice, of that before.

    None without ice, where torques follow the speed, and where a program prescribes it.
    """
    bodies, time, changes = [event.body for event in settings.events], found.time, list[float]()
    if found.steps or any(isinstance(body, SpeedProgram) for body in bodies):
        return None
    for name in dict.fromkeys(event.at for event in settings.events if isinstance(event.body, Ice)):
        station = study.train.part(name).stations[0]
        speed = found.speed[station]
        before = found.speed_before * abs(float(system.speed_ratio[station])) or float(speed[0])
        angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
        revolution = min(2.0 * math.pi / before, settings.duration)
        begins = time[time <= settings.duration - revolution]
        turned = np.interp(begins + revolution, time, angle) - np.interp(begins, time, angle)
        change = turned / (revolution * before) - 1.0
        changes.append(float(change[np.abs(change).argmax()]))
    return max(changes, key=abs, default=None)


def _ice(
    study: Study, system: System, settings: TransientSettings, found: TransientMotion
) -> Iterator[IceTorque]:
    """The greatest ice torques of the classes that its events name."""
    for event in settings.events:
        if isinstance(event.body, Ice):
            torque = event.body.of_class(point(study, system, found.speed_before, event.at))
            if torque is not None:
                yield torque


def run(work: Work) -> None:
    """Every motion over time that the file names; one without an answer takes no other with it."""
    found, errors, known = (
        list[TransientMotion](),
        list[InputError | SolveError](),
        dict[Any, tuple[Modes, Modes]](),
    )
    for settings, place in cases(work.study):
        title = f"motion over time {settings.name}".rstrip()
        try:
            with work.log.step(title, "requested") as step:
                is_nonlinear = work.study.train.has_nonlinear_couplings
                if settings.modes not in known and not is_nonlinear:
                    known[settings.modes] = kept_modes(work.system, settings.modes, place)
                one = transient(
                    work.study,
                    work.system,
                    settings,
                    place=place,
                    modes=known.get(settings.modes),
                    progress=work.progress,
                )
                step.method = (
                    "exact, from event to event"
                    if is_nonlinear
                    else "exact propagation of the modes"
                )
                if one.steps:
                    step.method += ", exponential collocation"
                step.size = (
                    f"{one.modes} modes, {len(settings.events)} events, {len(one.time)} samples"
                )
                if one.speed_before and settings.initial is None:
                    step.size += f", begins steady at {one.speed_before * 30.0 / math.pi:.6g} rpm"
            found.append(one)
        except (InputError, SolveError) as error:
            errors.append(error)
            if len(errors) > 1:
                work.log.without(title, str(error))
    if found:
        work.put(transient=Transients(tuple(found)))
    if errors:
        raise errors[0]
