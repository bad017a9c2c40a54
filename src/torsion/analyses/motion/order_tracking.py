"""Orders of torques while the speed changes: the spectrum over the angle of a shaft, window by window.

The torques are read at equal angles of the reference, on the exact motion, so that no vibration of the shaft smears
them. A window has TURNS revolutions, and so orders stand 1/TURNS apart; with fewer there are no orders.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Protocol

import numpy as np

from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.fields import Declared, OneOrMany, Quantity, given
from torsion.kernels.motion.order_spectrum import hann, phasors, phasors_of, times_at
from torsion.results import derived, reported, result

TURNS = 8  # revolutions of a window
MOST_WINDOWS = 200
PER_TURN = 4  # windows that begin in a revolution, at most
HIGHEST = 12.0  # order of a waterfall, where no higher one is tracked
ABOVE = 2.0  # orders beyond the highest that is tracked
PER_ORDER = 8  # samples to a revolution, of the highest order
ALIASED = 1e-4  # of the largest amplitude: what half of the samples may change
DOUBTFUL = (
    0.01  # of the largest amplitude: windows that half of the samples change by more are left out
)
MOST_POINTS = 2**18
BLOCK = 2**21  # values of one array at once

Order = Annotated[float, Quantity("1", above=0, at_most=200)]


class OrderSettings(Declared):
    """Settings of `orders`."""

    at: Annotated[tuple[str, ...], OneOrMany] = given(
        "couplings, shafts or gears whose torque is tracked (default: the components of `plot`, else the largest "
        "torque)",
        (),
    )
    reference: str | None = given(
        "point whose angle is the reference (default: the point of `operation.at`, else the first)"
    )
    track: Annotated[tuple[Order, ...], OneOrMany] = given(
        "orders of the reference that are tracked (default: those that excite the train)", ()
    )
    highest: Order | None = given(
        f"highest order of the waterfall (default: {HIGHEST:g}, or {ABOVE:g} above the highest that is tracked)"
    )


@reported
class TrackedTorque:
    """A torque by orders."""

    element: str = result("", (), "whose torque")
    torque: ComplexArray = result(
        "N*m",
        ("window", "order"),
        "its phasor of every order that is tracked: amplitude, and phase over the angle",
    )
    waterfall: FloatArray = result(
        "N*m", ("window", "multiple"), "amplitude of the multiples of the resolution, from 0"
    )

    @derived("N*m", ("order",), "largest amplitude of every order that is tracked")
    def largest(self) -> FloatArray:
        """(orders,) N m."""
        return np.asarray(np.abs(self.torque).max(axis=0, initial=0.0))

    @property
    def window(self) -> IntArray:
        """(orders,) the window of the largest amplitude; there is one."""
        return np.asarray(np.abs(self.torque).argmax(axis=0))


@reported
class OrderTracking:
    """Torques by orders of the reference."""

    reference: str = result("", (), "the point over whose angle")
    turns: float = result("", (), "revolutions that it makes in one sense; orders need 8")
    order: FloatArray = result("1", ("order",), "orders of the reference that are tracked")
    resolution: float = result("1", (), "step between the orders of a waterfall")
    time: FloatArray = result("s", ("window",), "middle of each window")
    speed: FloatArray = result("rad/s", ("window",), "of the reference, mean of each window")
    aliased: float = result(
        "1", (), "largest change of an amplitude with half of the samples, of the largest"
    )
    left_out: int = result(
        "", (), "windows omitted, because the torque changes too fast for their samples"
    )
    each: tuple[TrackedTorque, ...] = result("", (), "every torque that is tracked")


class Turning(Protocol):
    """A motion that can be read at any time."""

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, object]:
        """Torques (spans, times), their rates, and more."""

    def turned(self, station: int, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Angle (rad) and speed (times,) of a station."""


@dataclass(frozen=True)
class Tracked:
    """What is to be tracked."""

    name: str  # of the reference
    station: int
    orders: FloatArray  # of the reference
    highest: float
    spans: tuple[tuple[str, int], ...]  # element, and the span of its largest torque


def order_tracking(curves: Turning, tracked: Tracked, time: FloatArray, size: int) -> OrderTracking:
    """The orders of a motion with samples at some times; size: values of the motion at one time."""
    angle, speed = _blocks(lambda at: curves.turned(tracked.station, at), time, size)
    here, sense = one_sense(angle, speed)
    turns = abs(float(angle[here][-1] - angle[here][0])) / (2.0 * np.pi)
    if turns < TURNS:
        none = np.empty(0)
        return OrderTracking(
            tracked.name, turns, tracked.orders, 1.0 / TURNS, none, none, 0.0, 0, ()
        )

    def turned(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        there = _blocks(lambda part: curves.turned(tracked.station, part), at, size)
        return sense * there[0], sense * there[1]

    rows, begin = np.array([span for _, span in tracked.spans]), sense * float(angle[here][0])
    samples, number = (
        2 ** math.ceil(math.log2(PER_ORDER * tracked.highest)),
        int(tracked.highest * TURNS),
    )
    while True:
        count = int(turns * samples)
        at = times_at(
            begin + np.arange(count) * (2.0 * np.pi / samples),
            time[here],
            sense * angle[here],
            turned,
        )
        (value,) = _blocks(lambda part: (curves.torque(part)[0][rows],), at, size)
        first = windows(count, samples)
        within, start = (
            first[:, None] + np.arange(TURNS * samples),
            begin + first * (2.0 * np.pi / samples),
        )
        spectrum, change = list[FloatArray](), np.zeros(len(first))
        for one in value:
            fine, coarse = (
                phasors(one[within[:, ::step]], start, TURNS, number) for step in (1, 2)
            )
            spectrum.append(np.abs(fine))
            largest = max(float(spectrum[-1].max()), np.finfo(float).tiny)
            change = np.maximum(change, np.abs(fine - coarse).max(axis=1) / largest)
        if change.max() <= ALIASED or 2 * count > MOST_POINTS:
            break
        samples *= 2
    good: BoolArray = change <= DOUBTFUL
    each = tuple(
        TrackedTorque(
            name, phasors_of(one[within[good]], start[good], TURNS, tracked.orders), of_orders[good]
        )
        for (name, _), one, of_orders in zip(tracked.spans, value, spectrum, strict=True)
    )
    mean_speed = turned(at)[1][within] @ hann(TURNS * samples) / (TURNS * samples)
    return OrderTracking(
        tracked.name,
        turns,
        tracked.orders,
        1.0 / TURNS,
        at[first + TURNS * samples // 2][good],
        mean_speed[good],
        float(change[good].max(initial=0.0)),
        int(np.count_nonzero(~good)),
        each if good.any() else (),
    )


def one_sense(angle: FloatArray, speed: FloatArray) -> tuple[slice, float]:
    """The longest piece, by its angle, in which a shaft turns in one sense at all samples, and the sense."""
    sense = np.where(np.diff(angle) > 0.0, 1.0, np.where(np.diff(angle) < 0.0, -1.0, 0.0))
    against = (sense * speed[:-1] < 0.0) | (sense * speed[1:] < 0.0)
    sense[against] = 0.0
    edges = np.flatnonzero(np.diff(sense, prepend=2.0, append=2.0))
    longest = max(
        ((abs(float(angle[b] - angle[a])), a, b) for a, b in pairwise(edges) if sense[a]),
        default=(0.0, 0, 1),
    )
    return slice(int(longest[1]), int(longest[2]) + 1), float(sense[longest[1]] or 1.0)


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
    found = [read(time[first : first + step]) for first in range(0, len(time), step)]
    return [np.concatenate(parts, axis=-1) for parts in zip(*found, strict=True)]
