"""Orders of torques while the speed changes: the spectrum over the angle of a shaft, window by window.

The torques are read at equal angles of the reference, on the exact motion, so that no vibration of the shaft smears
them. A window has TURNS revolutions, and so orders stand 1/TURNS apart; with fewer there are no orders.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.analyses.motion.curves.torque_curves import Curves, Seen
from torsion.analyses.motion.derived.resonances_passed import mean_speed
from torsion.analyses.motion.events.transient_settings import ABOVE, HIGHEST, TransientSettings
from torsion.analyses.motion.train.loaded_train import LoadedTrain
from torsion.analyses.motion.transient_motion import OrderTracking, TrackedTorque
from torsion.analyses.response.harmonic_components import excitations
from torsion.analyses.steady import reference_station
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.kernels.motion.order_spectrum import hann, phasors, phasors_of, times_at
from torsion.study import Study

TURNS = 8  # revolutions of a window
MOST_WINDOWS = 200
PER_TURN = 4  # windows that begin in a revolution, at most
PER_ORDER = 8  # samples to a revolution, of the highest order
ALIASED = 1e-4  # of the largest amplitude: what half of the samples may change
# of the largest amplitude: windows that half of the samples change by more are left out
DOUBTFUL = 0.01
MOST_POINTS = 2**18
BLOCK = 2**21  # values of one array at once
SWEPT = 0.05  # of the largest speed: by how much it changes where orders are tracked unrequested


@dataclass(frozen=True)
class Tracked:
    """What is to be tracked."""

    name: str  # of the reference
    station: int
    orders: FloatArray  # of the reference
    highest: float
    spans: tuple[tuple[str, int], ...]  # element, and the span of its largest torque


def orders_requested(
    study: Study, system: System, loaded: LoadedTrain, seen: Seen
) -> Tracked | None:
    """Whose orders are tracked, and over whose angle: as the file says, or what its speed sweeps; None for none.

    Raises InputError for a reference between a joint and its elastic neighbour, whose angle is no coordinate.
    """
    settings, train, given = loaded.settings, study.train, loaded.settings.orders
    peak = np.maximum(*(np.abs(end[0]) for end in seen.ends))
    name, station = (
        study.operation.at or train.parts[0].name,
        reference_station(train, study.operation),
    )
    if given and given.reference:
        name, station = given.reference, train[given.reference].stations[0]
    orders = np.array(given.track if given else (), dtype=float)
    if not orders.size:
        orders = _exciting_orders(study, system, settings)
        orders = orders / abs(float(system.speed_ratio[station]))
    speed = mean_speed(system, seen.turning)
    sweeps = loaded.follows is not None and np.ptp(speed) > SWEPT * np.abs(speed).max()
    if not peak.size or (given is None and not (orders.size and sweeps)):
        return None
    is_coordinate = system.lumped_inertia[station] or system.held[station]
    if given is not None and study.has_joints and not is_coordinate:
        message = (
            f"the angle of '{name}', a point without inertia, is not a coordinate of the motion"
        )
        hint = "name a point with an inertia"
        raise InputError([Fault((*loaded.path, "orders", "reference"), message, hint)])
    names = [train.parts[part].name for part in system.span_part.tolist()]
    spans = dict[str, int]()
    for part in map(train.__getitem__, (given.at if given else ()) or settings.plot):
        of_part = [k for k, name in enumerate(names) if name == part.name]
        if of_part and not part.is_point:
            spans[part.name] = max(of_part, key=peak.__getitem__)
    if not spans:
        largest = int((peak * system.span_ratio).argmax())
        spans[names[largest]] = largest
    most_tracked = float(np.ceil(orders.max(initial=0.0) + ABOVE))
    highest = (given.highest if given else None) or max(HIGHEST, most_tracked)
    return Tracked(name, station, orders, highest, tuple(spans.items()))


def _exciting_orders(study: Study, system: System, settings: TransientSettings) -> FloatArray:
    """(orders,) of the reference station of the train, ascending: of the file's torques, of joints and of events."""
    lines = (excitation.line.order for excitation in excitations(system))
    orders = {float(order) for order in lines if order is not None}
    for event in settings.events:
        if event.by_angle:
            part = study.train[event.at]
            blades = part.propeller.blades if part.propeller else None
            if order := getattr(event.body, "order", None) or blades:
                orders.add(float(order * abs(system.speed_ratio[part.stations[0]])))
    return np.array(sorted(orders))


def order_tracking(
    curves: Curves, tracked: Tracked, sampled: Sequence[FloatArray], size: int
) -> OrderTracking:
    """The orders of a motion; sampled: times, angle and speed of its reference; size: values of the motion at one time."""
    time, angle, speed = sampled
    piece, sense = one_sense(angle, speed)
    time, angle = time[piece], sense * angle[piece]
    turns = abs(float(angle[-1] - angle[0])) / (2.0 * np.pi)
    resolution, none = 1.0 / TURNS, np.empty(0)
    if turns < TURNS:
        return OrderTracking(
            tracked.name, turns, tracked.orders, resolution, none, none, 0.0, 0, ()
        )

    def turned(times: FloatArray) -> tuple[FloatArray, FloatArray]:
        rows = _blocks(lambda part: curves.turned(tracked.station, part), times, size)
        return sense * rows[0], sense * rows[1]

    spans, begin = np.array([span for _, span in tracked.spans]), float(angle[0])
    samples = 2 ** math.ceil(math.log2(PER_ORDER * tracked.highest))
    # Twice the samples, until leaving out every second one changes no amplitude: what is above the highest order is not
    # taken for a lower one then.
    while True:
        count, step = int(turns * samples), 2.0 * np.pi / samples
        times, speed = times_at(begin + np.arange(count) * step, time, angle, turned)
        (torque,) = _blocks(lambda part: (curves.torque(part)[0][spans],), times, size)
        first = windows(count, samples)
        within, start = first[:, None] + np.arange(TURNS * samples), begin + first * step
        waterfalls, change = list[FloatArray](), np.zeros(len(first))
        for values in torque:
            fine, coarse = (
                phasors(values[within[:, ::stride]], start, TURNS, int(tracked.highest * TURNS))
                for stride in (1, 2)
            )
            waterfalls.append(np.abs(fine))
            largest = max(float(waterfalls[-1].max()), np.finfo(float).tiny)
            change = np.maximum(change, np.abs(fine - coarse).max(axis=1) / largest)
        if change.max() <= ALIASED or 2 * count > MOST_POINTS:
            break
        samples *= 2
    # A window in which a blow or a switch has too fine a course is left out; the others do not suffer from it.
    good = np.flatnonzero(change <= DOUBTFUL)
    torques = tuple(
        TrackedTorque(
            name,
            phasors_of(values[within[good]], start[good], TURNS, tracked.orders),
            waterfall[good],
        )
        for (name, _), values, waterfall in zip(tracked.spans, torque, waterfalls, strict=True)
    )
    mean = speed[within] @ hann(TURNS * samples) / (TURNS * samples)
    return OrderTracking(
        tracked.name,
        turns,
        tracked.orders,
        resolution,
        times[first + TURNS * samples // 2][good],
        mean[good],
        float(change[good].max(initial=0.0)),
        len(change) - len(good),
        torques if len(good) else (),
    )


def one_sense(angle: FloatArray, speed: FloatArray) -> tuple[slice, float]:
    """The longest piece, by its angle, in which a shaft turns in one sense at all samples, and the sense."""
    sense = np.sign(np.diff(angle))
    # Between two samples with the same sense the shaft may have turned back and forth: its speed says so.
    sense[(sense * speed[:-1] < 0.0) | (sense * speed[1:] < 0.0)] = 0.0
    edges = np.flatnonzero(np.diff(sense, prepend=2.0, append=2.0))
    pieces = ((abs(float(angle[b] - angle[a])), a, b) for a, b in pairwise(edges) if sense[a])
    _, first, last = max(pieces, default=(0.0, 0, 1))
    return slice(int(first), int(last) + 1), float(sense[first] or 1.0)


def windows(count: int, samples: int) -> IntArray:
    """First samples of the windows within `count`, `samples` to a revolution."""
    last = count - TURNS * samples
    number = min(MOST_WINDOWS, PER_TURN * last // samples + 1)
    return np.unique(np.linspace(0, last, number).astype(np.int64))


def _blocks(
    read: Callable[[FloatArray], Sequence[FloatArray]], time: FloatArray, size: int
) -> list[FloatArray]:
    """What is read at times, block by block."""
    step = max(2, BLOCK // max(size, 1))
    blocks = [read(time[first : first + step]) for first in range(0, len(time), step)]
    return [np.concatenate(parts, axis=-1) for parts in zip(*blocks, strict=True)]
