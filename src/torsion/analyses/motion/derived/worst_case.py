"""The worst of what a file leaves open: phases at which motors are switched on, senses and reclosing of short circuits.

A motion repeats itself over the phase of a pulsation: a Fourier series through equally spaced phases gives the torque at
every time for all others, and so the phases at which each span has its greatest torque. These are computed. A pulsation
that passes a resonance at another time for another phase has many harmonics: the phases are doubled until the series
gives the motions of its own worst phases. Of short circuits all senses and times of reclosing are computed.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from torsion.analyses.motion.events.event_kind import Kind
from torsion.analyses.motion.events.machine_events import FINER, WORST, ShortCircuit, Start
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import Fault, InputError, Path

FEWEST, MOST = 3, 24  # equally spaced phases
MOST_OF_SWITCHING = 6  # where laws switch: no number is enough there, and nothing passes
GRID = 180  # phases at which the series is evaluated
BETWEEN = 0.382  # of the distance of two phases: where no higher harmonic has the value of the one it is taken for
ALIKE = math.radians(4.0)  # phases nearer than that are one: a cosine there is 1 to 0.25 %
ADDS = 0.01  # of a peak: a span to which pulsation adds less has no worst phase
KNOWN = 0.01  # of a peak: a series that errs by less at its worst phases, at any time, is known
MOST_FAULTS = 500  # motions of one file's motion
WORST_TIMES = 3  # faults beside whose times of reclosing the scan is finer


Solve = Callable[[TransientSettings], TransientMotion]
Phases = tuple[tuple[int, float], ...]  # number of an event, and rad


def over_phases(
    settings: TransientSettings, solve: Solve, limit: FloatArray
) -> list[tuple[Phases, TransientMotion]]:
    """The motions of several phases, the worst first: nearest to or farthest above the limits (spans,) N m, or nan."""
    bodies = enumerate(event.body for event in settings.events)
    starts = [(k, body) for k, body in bodies if isinstance(body, Start)]
    left_open = [k for k, start in starts if start.slip_pulsation and start.phase == WORST]
    phases, motions = dict.fromkeys(left_open, 0.0), dict[Phases, TransientMotion]()

    def run(number: int, phase: float) -> TransientMotion:
        key: Phases = tuple({**phases, number: phase}.items())
        if key not in motions:
            bodies = {
                number: settings.events[number].body.model_copy(update={"phase": phase})
                for number, phase in key
            }
            motions[key] = solve(_with_bodies(settings, bodies))
        return motions[key]

    if not left_open:
        return [((), solve(settings))]
    doubt = np.zeros(1)
    for number in left_open:
        first, count, is_known = run(number, 0.0), FEWEST, False
        share = _share_of_limits(limit, first.peak)
        most = MOST if first.switching is None else MOST_OF_SWITCHING
        while not is_known:
            series = _Series.through([run(number, phase).torque for phase in even(count)])
            error, is_known = np.zeros(len(share)), True
            for phase in _worst_phases(series, share):
                torque = run(number, phase).torque
                error = np.maximum(error, np.abs(series.at(phase) - torque).max(axis=1))
                greatest = (np.abs(torque).max(axis=1) * share).max(initial=0.0)
                is_known = bool((error * share).max(initial=0.0) <= KNOWN * greatest)
                if not is_known and 2 * count <= most:
                    break
            if 2 * count > most:
                doubt = np.maximum(doubt, 0.0 if is_known else error)
                break
            count *= 2
        peaks = {
            key: float((motion.peak * share).max(initial=0.0)) for key, motion in motions.items()
        }
        largest = max(peaks.values())
        phases = dict(next(key for key, peak in peaks.items() if peak == largest))
    worst = tuple(phases.items())
    shown = motions.pop(worst)
    if doubt.any():
        shown = replace(shown, unresolved=shown.unresolved + doubt)
    return [(worst, shown), *motions.items()]


def _with_bodies(settings: TransientSettings, bodies: Mapping[int, Kind]) -> TransientSettings:
    """The settings with other bodies of some events, by their number."""
    events = list(settings.events)
    for number, body in bodies.items():
        events[number] = events[number].model_copy(update={body.field(): body})
    return settings.model_copy(update={"events": tuple(events)})


def _share_of_limits(limit: FloatArray, peak: FloatArray) -> FloatArray:
    """(spans,) by which peaks are compared: of their limits, or where there is none of what they are."""
    scale = np.where(np.isfinite(limit).any(), limit, peak)
    return np.nan_to_num(1.0 / np.where(scale > 0.0, scale, np.nan))


@dataclass(frozen=True)
class _Series:
    """A Fourier series over the phase, through torques at equally spaced phases."""

    count: int  # phases that it goes through, the first at 0
    waves: ComplexArray  # (harmonics, spans, samples) N m, from the mean

    @classmethod
    def through(cls, torque: Sequence[FloatArray]) -> "_Series":
        """Return the series through torques (spans, samples) N m."""
        waves = np.fft.rfft(np.array(torque), axis=0) / len(torque)
        waves[1 : (len(torque) + 1) // 2] *= 2.0
        return cls(len(torque), waves)

    def at(self, phase: float) -> FloatArray:
        """Return the torque (spans, samples) N m at a phase (rad)."""
        turned = np.exp(1j * phase * np.arange(len(self.waves)))
        return np.asarray(np.tensordot(turned, self.waves, 1).real)


def even(count: int) -> list[float]:
    """Return equally spaced phases (rad) from 0."""
    return [math.tau * k / count for k in range(count)]


def _worst_phases(series: _Series, share: FloatArray) -> Iterator[float]:
    """Phases (rad) of the greatest magnitudes of every span that are not near one that the series goes through.

    At least one, so that the series is compared with a motion: else one between two of its phases.
    """
    grid, computed = even(GRID), even(series.count)
    sizes = np.array([np.abs(series.at(phase)).max(axis=1) for phase in grid])
    phase, peak, least = np.array(grid)[sizes.argmax(axis=0)], sizes.max(axis=0), sizes.min(axis=0)
    for span in np.argsort(-peak * share, kind="stable").tolist():
        distances = [abs(math.remainder(phase[span] - near, math.tau)) for near in computed]
        if peak[span] - least[span] > ADDS * peak[span] and min(distances) > ALIKE:
            computed.append(float(phase[span]))
            yield computed[-1]
    if len(computed) == series.count:
        yield BETWEEN * math.tau / series.count


def faults_of(settings: TransientSettings, *, scanned: bool = False) -> dict[int, ShortCircuit]:
    """Every short circuit by the number of its event; scanned: those that close again at a time between two."""
    bodies = enumerate(event.body for event in settings.events)
    faults = {number: body for number, body in bodies if isinstance(body, ShortCircuit)}
    if scanned:
        times = {number: fault.reclose or (0.0, 0.0) for number, fault in faults.items()}
        faults = {number: faults[number] for number, (a, b) in times.items() if a < b}
    return faults


def _fault_variants(
    settings: TransientSettings, frequency: FloatArray, path: Path
) -> list[TransientSettings]:
    """Every combination of the senses and times of reclosing of all faults.

    Raises InputError where these and the finer ones may be more than MOST_FAULTS.
    """
    faults = faults_of(settings)
    variants = {number: fault.variants(frequency) for number, fault in faults.items()}
    count = math.prod(map(len, variants.values()))
    count += WORST_TIMES * 2 * (FINER - 1) * len(faults_of(settings, scanned=True))
    if count > MOST_FAULTS:
        message = (
            f"{count} short circuits would be computed, for all senses and times of reclosing: more than "
            f"{MOST_FAULTS}"
        )
        hint = "a narrower range `reclose`, or state `sense`"
        raise InputError([Fault((*path, "events"), message, hint)])
    combinations = product(*variants.values())
    return [
        _with_bodies(settings, dict(zip(variants, bodies, strict=True))) for bodies in combinations
    ]


def _finer_variants(
    settings: TransientSettings, worst: Sequence[TransientSettings], frequency: FloatArray
) -> list[TransientSettings]:
    """Between the times of reclosing of the worst variants and those before and after, each of them once."""
    finer = list[TransientSettings]()
    for variant in worst[:WORST_TIMES]:
        variant_faults = faults_of(variant)
        for number, fault in faults_of(settings, scanned=True).items():
            sense, times = variant_faults[number].sense, variant_faults[number].reclose
            for between in fault.variants_beside((times or (0.0,))[0], frequency):
                body = between.model_copy(update={"sense": sense})
                changed = _with_bodies(variant, {number: body})
                finer += [changed] * (changed not in finer)
    return finer


def worst_motion(
    settings: TransientSettings, solve: Solve, limit: FloatArray, frequency: FloatArray, path: Path
) -> TransientMotion:
    """The motion of the worst faults and phases, with the greatest of every span's torques of all.

    limit: (spans,) N m, nan where there is none. frequency: (modes,) Hz, the natural ones of the train. path: of the
    settings in the file.
    """

    def solve_phases(settings: TransientSettings) -> TransientMotion:
        motions = over_phases(settings, solve, limit)
        if len(motions) == 1:
            return motions[0][1]
        phases = tuple(phase for _, phase in motions[0][0])
        moved = _greatest([motion for _, motion in motions])
        return replace(moved, slip_phase=phases, phases_computed=len(motions))

    variants = _fault_variants(settings, frequency, path)
    worst = solve_phases(variants[0])
    if len(variants) == 1:
        return worst
    share = _share_of_limits(limit, worst.peak)
    worst = replace(worst, worst_fault=_faults_in_words(variants[0]))
    peaks = [(worst.peak * share).max(initial=0.0)]

    def compare(settings: TransientSettings, worst: TransientMotion) -> TransientMotion:
        motion = replace(solve_phases(settings), worst_fault=_faults_in_words(settings))
        peaks.append((motion.peak * share).max(initial=0.0))
        is_worse = peaks[-1] > (worst.peak * share).max(initial=0.0)
        return _greatest([motion, worst] if is_worse else [worst, motion])

    for variant in variants[1:]:
        worst = compare(variant, worst)
    # Then times of reclosing between those, beside the worst.
    worst_first = np.argsort(-np.array(peaks), kind="stable").tolist()
    for variant in _finer_variants(settings, [variants[k] for k in worst_first], frequency):
        worst = compare(variant, worst)
    return replace(worst, faults_computed=len(peaks))


def _greatest(motions: Sequence[TransientMotion]) -> TransientMotion:
    """The first of the motions, with the greatest of every span's torques of all, as doubtful as the most doubtful."""
    shown, spans = motions[0], np.arange(len(motions[0].greatest))

    def column(name: str) -> np.ndarray:
        return np.array([getattr(motion, name) for motion in motions])

    def chosen(which: IntArray, *names: str) -> dict[str, Any]:
        return {name: column(name)[which, spans] for name in names}

    highest = column("peak").argmax(axis=0).tolist()
    switchings = [motion.switching for motion in motions if motion.switching is not None]
    scatters = [item.scatter for item in switchings if item.scatter is not None]
    times = [item.sensitive_after for item in switchings if item.sensitive_after is not None]
    return replace(
        shown,
        **chosen(column("greatest").argmax(axis=0), "greatest", "greatest_at"),
        **chosen(column("least").argmin(axis=0), "least", "least_at"),
        unresolved=column("unresolved").max(axis=0),
        reversals=column("reversals").max(axis=0),
        residual=max(motion.residual for motion in motions),
        change=None if shown.change is None else max(motion.change or 0.0 for motion in motions),
        left_in_series=max(motion.left_in_series for motion in motions),
        switching=shown.switching
        and replace(
            shown.switching,
            band_change=max(item.band_change for item in switchings),
            sensitive_after=min(times, default=None),
            scatter=np.max(scatters, axis=0) if scatters else None,
        ),
        turns=tuple(
            motions[number].turns[span]
            for span, number in enumerate(highest)
            if motions[number].turns
        ),
    )


def _faults_in_words(settings: TransientSettings) -> str:
    """Their senses and times of reclosing, with their points where there are several."""
    faults, words = faults_of(settings), list[str]()
    for number, fault in faults.items():
        again = "" if fault.reclose is None else f", reclosed after {fault.reclose[0]:.6g} s"
        where = f" at {settings.events[number].at}" if len(faults) > 1 else ""
        words.append(f"it {fault.sense} first{again}{where}")
    return "; ".join(words)
