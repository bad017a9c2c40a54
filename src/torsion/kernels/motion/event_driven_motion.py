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
# events, after two times of which those of the whole motion are judged by their pace
WATCHED = 10_000


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
        late, regime = time - self.begin[block], self.regime[block]
        states = np.empty((self.train.size, len(block)))
        for number in np.unique(regime).tolist():
            columns = np.flatnonzero(regime == number)
            start = self.state[block[columns]].T
            states[:, columns] = self.regimes[number].moved(start, late[columns])
        return states, regime


@dataclass
class March:
    """The motion while it is computed.

    fineness: of the steps, of those that the fastest motion of a regime allows. progress: called with the share of the
    time that is done.
    """

    train: PiecewiseTrain
    duration: float
    fineness: float = 1.0
    progress: Callable[[float], None] = lambda share: None
    released: FloatArray = field(init=False)
    halvings: int = 0  # of the steps
    idle: int = 0  # events without progress
    last: float = -math.inf  # s, when there was some
    kept: dict[tuple[State, int], Regime] = field(default_factory=dict)
    blocks: list[tuple[float, FloatArray, tuple[State, int], FloatArray]] = field(
        default_factory=list
    )
    events: list[Event] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.released = np.zeros(len(self.train.elements))

    def regime(self, state: State) -> Regime:
        """The regime of a state of the elements, built once."""
        key = (state, self.halvings)
        if key not in self.kept:
            fineness = self.fineness * 0.5**self.halvings
            longest = self.duration / 16.0
            self.kept[key] = regime(self.train, state, longest=longest, fineness=fineness)
        return self.kept[key]

    def switch(self, state: State, function: int) -> tuple[int, int]:
        """The element that a switching function is of, and the regime that it enters."""
        switches = [
            (number, switch.to)
            for number, (element, mode) in enumerate(zip(self.train.elements, state, strict=True))
            for switch in element.switches(mode)
        ]
        return switches[function]

    def enter(
        self, time: float, z: FloatArray, state: State, number: int, to: int
    ) -> tuple[FloatArray, State]:
        """An element in another regime, its own coordinate set to what it is exactly there."""
        element, old = self.train.elements[number], state[number]
        new = (*state[:number], to, *state[number + 1 :])
        law, old_law = element.law(to), element.law(old)
        if word := element.word(old, to):
            self.events.append(Event(time, number, word))
        z = z.copy()
        if (x := element.settled(old, to)) is not None:
            z[number] = x * self.train.root[number]
        elif old_law.kind == "given" and law.kind == "spring":
            row = self.regime(new).torque[number]
            slipping = old_law.sign * (self.train.capacity[number] @ z)
            z[number] += (slipping - row @ z) / row[number]
        elif law.kind == "stuck":
            # Its ends turn together, of which the root knows all digits but the last.
            speed, ends = self.train.layout[2], self.train.ends[number]
            z[speed] -= ends * ((ends @ z[speed]) / (ends @ ends))
        if isinstance(element, Friction) and element.signal is not None:
            before, after = (self.regime(mode).elastic[number] @ z for mode in (state, new))
            self.released = self.released.copy()
            self.released[number] += 0.5 * (before**2 - after**2)
        return z, new

    def rearm(self, time: float, z: FloatArray, state: State) -> tuple[FloatArray, State]:
        """At a break: the signals that begin, and friction whose capacity ends or begins."""
        train = self.train
        before, first = self.regime(state).elastic @ z, train.layout[3].start
        z, signals = z.copy(), slice(first, first + train.signals.pieces_size)
        z[signals] = train.signals.state(time)
        if time > 0.0:  # what slips gives up the energy that a lower capacity does not hold
            after = self.regime(state).elastic @ z
            self.released = self.released + 0.5 * (before**2 - after**2)
        for number, element in enumerate(train.elements):
            if isinstance(element, Friction) and element.signal is not None:
                acts = train.signals.acting(element.signal, z[signals])
                if acts == (state[number] != OPEN):
                    continue
                z[number] = 0.0 if acts else z[number]
                to = self._closing(number, z) if acts else OPEN
                z, state = self.enter(time, z, state, number, to)
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
        regime = self.regime(state)
        self.blocks.append((time, z, (state, self.halvings), self.released))
        length = min(STEPS * regime.step, end - time)
        event = regime.first_event(z, length)
        if event is None:
            reached = end if length == end - time else time + length
            return reached, regime.after(z, length), state, False
        late, function = event
        z, time = regime.after(z, late), time + late
        number, to = self.switch(state, function)
        z, state = self.enter(time, z, state, number, to)
        near = max(1e-12 * regime.step, 4.0 * math.ulp(time))
        self.idle, self.last = (self.idle + 1, self.last) if time - self.last <= near else (0, time)
        if self.idle > CHATTER * len(state):
            raise Chatter(time, number)
        count = len(self.events)
        if count > MOST_EVENTS or count % WATCHED == 0:
            backs = (back * WATCHED for back in (2, 1) if back * WATCHED <= count)
            times = [*(self.events[-back].time for back in backs), time]
            refuse_too_many(count, MOST_EVENTS, times, WATCHED, self.duration)
        return time, z, state, True

    def until(
        self, ends: Sequence[float], z: FloatArray, state: State
    ) -> Iterator[EventDrivenMotion]:
        """From regimes and a state at time 0 to each of some times (s), ascending; the last is the duration."""
        breaks = [
            0.0,
            *(time for time in self.train.signals.breaks.tolist() if time < self.duration),
        ]
        for time, end in pairwise(sorted({*breaks, *ends})):
            if time in breaks:
                z, state = self.rearm(time, z, state)
            reached = time
            while reached < end:
                reached, z, state, _ = self.on(reached, end, z, state)
                if len(self.blocks) % NEWS == 0:
                    self.progress(reached / self.duration)
            if end in ends:
                yield self.finished(z, state, end)

    def finished(self, z: FloatArray, state: State, end: float) -> EventDrivenMotion:
        """The motion so far, which ends there."""
        self.regime(state)
        blocks = [*self.blocks, (end, z, (state, self.halvings), self.released)]
        times, states, regimes, released = zip(*blocks, strict=True)
        numbers = {key: number for number, key in enumerate(self.kept)}
        return EventDrivenMotion(
            self.train,
            np.array(times),
            np.array(states),
            np.array([numbers[key] for key in regimes]),
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
    position: FloatArray,
    speed: FloatArray,
    duration: float,
    fineness: float = 1.0,
) -> EventDrivenMotion:
    """The motion from regimes and x (elements,) rad, positions (modes,) and speeds (rigid motions + modes,) at time 0.

    fineness: as of `March`. Raises Chatter where events follow each other without progress, and TooManyEvents.
    """
    march = March(train, duration, fineness)
    (motion,) = march.until([duration], train.at_first(twist, position, speed), state)
    return motion
