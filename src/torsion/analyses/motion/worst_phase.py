"""Phases at which a motor that pulsates with its slip is switched on: the worst, where the file names none.

Torques are nearly linear in the cosine and the sine of that phase: three phases give the torque without pulsation and
what both add at every time, and so the phases at which each span has its greatest torque. These are computed.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Protocol, TypeVar

import numpy as np

from torsion.analyses.motion.following_events import Start
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.arrays import FloatArray

THREE = (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)
ALIKE = math.radians(4.0)  # phases nearer than that are one: a cosine there is 1 to 0.25 %
ADDS = 0.01  # of a peak: a span to which pulsation adds less has no worst phase


class Peaks(Protocol):
    """A motion."""

    @property
    def torque(self) -> FloatArray:
        """(spans, samples) N m."""

    @property
    def peak(self) -> FloatArray:
        """(spans,) N m."""


Found = TypeVar("Found", bound=Peaks)
Phases = tuple[tuple[int, float], ...]  # number of an event, and rad


def over_phases(
    settings: TransientSettings, solve: Callable[[TransientSettings], Found], limit: FloatArray
) -> list[tuple[Phases, Found]]:
    """The motions of several phases, the worst first: nearest to or farthest above the limits (spans,) N m, or nan."""
    left_open = [
        k
        for k, one in enumerate(settings.events)
        if isinstance(one.body, Start) and one.body.has_worst_phase
    ]
    phases, found = dict[int, float](dict.fromkeys(left_open, 0.0)), dict[Phases, Found]()

    def run(number: int, phase: float) -> Found:
        key: Phases = tuple({**phases, number: phase}.items())
        if key not in found:
            found[key] = solve(switched_on(settings, dict(key)))
        return found[key]

    if not left_open:
        return [((), solve(settings))]
    for number in left_open:
        three = [run(number, phase) for phase in THREE]
        share = share_of_limits(limit, three[0].peak)
        for phase in _worst([one.torque for one in three], share):
            run(number, phase)
        worst = {key: float((one.peak * share).max(initial=0.0)) for key, one in found.items()}
        top = max(worst.values())
        phases = dict(next(key for key, one in worst.items() if one == top))
    best = tuple(phases.items())
    return [(best, found.pop(best)), *found.items()]


def switched_on(settings: TransientSettings, phases: Mapping[int, float]) -> TransientSettings:
    """The settings with the phases of some starts."""
    events = list(settings.events)
    for number, phase in phases.items():
        body = events[number].body.model_copy(update={"phase": phase})
        events[number] = events[number].model_copy(update={"start": body})
    return settings.model_copy(update={"events": tuple(events)})


def share_of_limits(limit: FloatArray, peak: FloatArray) -> FloatArray:
    """(spans,) by which peaks are compared: of their limits, or where there is none of what they are."""
    own = np.where(np.isfinite(limit).any(), limit, peak)
    return np.nan_to_num(1.0 / np.where(own > 0.0, own, np.nan))


def _worst(torque: Sequence[FloatArray], share: FloatArray) -> Iterator[float]:
    """Phases (rad) of the greatest magnitudes of every span, from its torques (spans, samples) at THREE phases."""
    whole = np.sum(np.array(torque), axis=0) / 3.0
    wave = np.tensordot(2.0 / 3.0 * np.exp(1j * np.array(THREE)), np.array(torque), 1)
    most = np.abs(whole) + np.abs(wave)
    place = most.argmax(axis=1)
    rows = np.arange(len(place))
    peak, added, sense = most[rows, place], wave[rows, place], np.sign(whole[rows, place])
    phase, known = np.mod(np.angle(sense * added), 2.0 * math.pi), list(THREE)
    for span in np.argsort(-peak * share, kind="stable").tolist():
        apart = [abs(math.remainder(phase[span] - one, 2.0 * math.pi)) for one in known]
        if abs(added[span]) > ADDS * peak[span] and min(apart) > ALIKE:
            known.append(float(phase[span]))
            yield known[-1]
