"""Exact motion of a train whose few nonlinear elements are linear between events.

A regime is one state of every element; its matrix, exponentials and rows are kept.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.endless_events import Chatter, refuse_too_many
from torsion.kernels.motion.linear_regime import STEPS, Regime
from torsion.kernels.motion.piecewise_elements import OPEN, Friction
from torsion.kernels.motion.piecewise_train import PiecewiseTrain, State, regime

CHATTER = 50  # events of one element without progress
MOST_EVENTS = 200_000
NEWS = 100  # blocks between two reports of progress
WATCHED = (
    10_000  # events, after two times of which those of the whole motion are judged by their pace
)


@dataclass(frozen=True)
class Event:
    """A change of the regime of an element."""

    time: float  # s
    element: int
    word: str  # contact, separation, slip, stuck, open


@dataclass(frozen=True)
class EventDrivenMotion:
    """The motion: states at the begin of every block and after every event."""

    train: PiecewiseTrain
    begin: FloatArray  # (blocks,) s
    state: FloatArray  # (blocks, states)
    regime: IntArray  # (blocks,) which of `regimes`
    regimes: tuple[Regime, ...]
    events: tuple[Event, ...]
    released: FloatArray  # (blocks, elements) J until then, elastic energy of friction that lost its capacity
    end: float  # s

    def at(self, time: FloatArray) -> tuple[FloatArray, IntArray]:
        """States (states, times) at times (s) that ascend, and the regime of each."""
        block = np.maximum(np.searchsorted(self.begin, time, side="right") - 1, 0)
        return self.from_blocks(block, time - self.begin[block]), self.regime[block]

    def from_blocks(self, block: IntArray, late: FloatArray) -> FloatArray:
        """States (states, columns), each a time (s) after the begin of a block."""
        found, regime = np.empty((self.train.size, len(block))), self.regime[block]
        for number in np.unique(regime).tolist():
            here = np.flatnonzero(regime == number)
            found[:, here] = self.regimes[number].moved(self.state[block[here]].T, late[here])
        return found


@dataclass
class March:
    """The motion while it is computed."""

    train: PiecewiseTrain
    duration: float
    fineness: float
    dips: bool = True
    progress: Callable[[float], None] = lambda share: None
    released: FloatArray = field(init=False)
    halvings: int = 0  # of the steps
    idle: int = 0  # events without progress
    last: float = -math.inf  # s, when there was some
    kept: dict[tuple[State, int], Regime] = field(default_factory=dict)
    pairs: dict[State, list[tuple[int, int]]] = field(default_factory=dict)
    blocks: list[tuple[float, FloatArray, tuple[State, int], FloatArray]] = field(
        default_factory=list
    )
    events: list[Event] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.released = np.zeros(len(self.train.elements))

    def regime(self, state: State) -> Regime:
        """Of a state of the elements, built once."""
        if (state, self.halvings) not in self.kept:
            longest, fineness = self.duration / 16.0, self.fineness * 0.5**self.halvings
            one = regime(self.train, state, longest=longest, fineness=fineness, dips=self.dips)
            self.kept[state, self.halvings] = one
        return self.kept[state, self.halvings]

    def pair(self, state: State, function: int) -> tuple[int, int]:
        """The element that a switching function is of, and the regime that it enters."""
        if state not in self.pairs:
            self.pairs[state] = [
                (number, switch.to)
                for number, (element, own) in enumerate(
                    zip(self.train.elements, state, strict=True)
                )
                for switch in element.switches(own)
            ]
        return self.pairs[state][function]

    def enter(
        self, time: float, z: FloatArray, state: State, number: int, to: int
    ) -> tuple[FloatArray, State]:
        """An element in another regime, its own coordinate set to what it is exactly there."""
        element, old = self.train.elements[number], state[number]
        new = (*state[:number], to, *state[number + 1 :])
        if word := element.word(old, to):
            self.events.append(Event(time, number, word))
        z = z.copy()
        if (x := element.settled(old, to)) is not None:
            z[number] = x * self.train.root[number]
        elif element.law(old).kind == "given" and element.law(to).kind == "spring":
            row = self.regime(new).torque[number]
            z[number] += (
                element.law(old).sign * (self.train.capacity[number] @ z) - row @ z
            ) / row[number]
        elif (
            element.law(to).kind == "stuck"
        ):  # its ends turn together, of which the root knows all digits but the last
            speed, ends = self.train.layout[2], self.train.ends[number]
            z[speed] -= ends * ((ends @ z[speed]) / (ends @ ends))
        if isinstance(element, Friction) and element.signal is not None:
            before, after = (float(self.regime(one).elastic[number] @ z) for one in (state, new))
            self.released = self.released.copy()
            self.released[number] += 0.5 * (before**2 - after**2)
        return z, new

    def rearm(self, time: float, z: FloatArray, state: State) -> tuple[FloatArray, State]:
        """At a break: the signals that begin, and friction whose capacity ends or begins."""
        before, first = self.regime(state).elastic @ z, self.train.layout[3].start
        z, signals = z.copy(), slice(first, first + self.train.signals.known)
        z[signals] = self.train.signals.state(time)
        if time > 0.0:  # what slips gives up the energy that a lower capacity does not hold
            self.released = self.released + 0.5 * (
                before**2 - (self.regime(state).elastic @ z) ** 2
            )
        for number, element in enumerate(self.train.elements):
            if isinstance(element, Friction) and element.signal is not None:
                acts = self.train.signals.acting(element.signal, z[signals])
                if acts == (state[number] != OPEN):
                    continue
                z[number] = 0.0 if acts else z[number]
                z, state = self.enter(
                    time, z, state, number, self._closing(number, z) if acts else OPEN
                )
                z[number] = 0.0
        return z, state

    def _closing(self, number: int, z: FloatArray) -> int:
        """The regime of friction that gains a capacity: it slips, unless its ends turn together to rounding."""
        row = self.train.relative_speed[number]
        slipping = float(row @ z)
        return (
            0 if abs(slipping) <= 1e-12 * float(np.abs(row) @ np.abs(z)) else int(np.sign(slipping))
        )

    def on(
        self, time: float, end: float, z: FloatArray, state: State
    ) -> tuple[float, FloatArray, State, bool]:
        """A block, or less where an event ends it: until when, and whether one did."""
        one = self.regime(state)
        self.blocks.append((time, z, (state, self.halvings), self.released))
        length = min(STEPS * one.step, end - time)
        found = one.first_event(z, length)
        if found is None:
            return (
                end if length == end - time else time + length,
                one.after(z, length),
                state,
                False,
            )
        late, function = found
        z, time = one.after(z, late), time + late
        number, to = self.pair(state, function)
        z, state = self.enter(time, z, state, number, to)
        near = max(1e-12 * one.step, 4.0 * math.ulp(time))
        self.idle, self.last = (self.idle + 1, self.last) if time - self.last <= near else (0, time)
        if self.idle > CHATTER * len(state):
            raise Chatter(time, number)
        if len(self.events) > MOST_EVENTS or len(self.events) % WATCHED == 0:
            times = [
                self.events[-k * WATCHED].time for k in (2, 1) if k * WATCHED <= len(self.events)
            ]
            refuse_too_many(len(self.events), MOST_EVENTS, [*times, time], WATCHED, self.duration)
        return time, z, state, True

    def to(self, time: float, end: float, z: FloatArray, state: State) -> tuple[FloatArray, State]:
        """From one break to the next."""
        while time < end:
            time, z, state, _ = self.on(time, end, z, state)
            if len(self.blocks) % NEWS == 0:
                self.progress(time / self.duration)
        return z, state

    def whole(self, z: FloatArray, state: State) -> EventDrivenMotion:
        """From regimes and a state at time 0 to the end."""
        (found,) = self.until([self.duration], z, state)
        return found

    def until(
        self, ends: Sequence[float], z: FloatArray, state: State
    ) -> Iterator[EventDrivenMotion]:
        """From regimes and a state at time 0 to each of some times (s), ascending; the last is the duration."""
        breaks = [0.0, *(float(one) for one in self.train.signals.breaks if one < self.duration)]
        for begin, end in pairwise(sorted({*breaks, *ends})):
            if begin in breaks:
                z, state = self.rearm(begin, z, state)
            z, state = self.to(begin, end, z, state)
            if end in ends:
                yield self.finished(z, state, end)

    def finished(self, z: FloatArray, state: State, end: float) -> EventDrivenMotion:
        """The motion so far, which ends there."""
        self.regime(state)
        blocks = [*self.blocks, (end, z, (state, self.halvings), self.released)]
        times, states, regimes, released = zip(*blocks, strict=True)
        numbers = {one: number for number, one in enumerate(self.kept)}
        return EventDrivenMotion(
            self.train,
            np.array(times),
            np.array(states),
            np.array([numbers[one] for one in regimes]),
            tuple(self.kept.values()),
            tuple(self.events),
            np.array(released),
            end,
        )


def event_driven(
    train: PiecewiseTrain,
    state: State,
    *,
    twist: FloatArray,
    place: FloatArray,
    speed: FloatArray,
    duration: float,
    fineness: float = 1.0,
    dips: bool = True,
    progress: Callable[[float], None] = lambda share: None,
) -> EventDrivenMotion:
    """The motion from regimes and x (elements,) rad, places (modes,) and speeds (rigid motions + modes,) at time 0.

    fineness: of the steps, of those that the fastest motion of a regime allows. dips: look for functions that fall
    below zero and rise again between two samples. progress: called with the share of the time that is done. Raises
    Chatter where events follow each other without progress, and TooManyEvents.
    """
    return March(train, duration, fineness, dips, progress).whole(
        train.at_first(twist, place, speed), state
    )
