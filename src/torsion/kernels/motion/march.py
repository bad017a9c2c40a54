"""A train moved on from event to event: exact between them, also under torques that are polynomials of a step.

Within a regime of its elements the train is linear. An event of an element ends a step there, and the next begins in
another regime. Every element keeps a twist of its own, so that no twist is a difference of large angles.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.endless_events import Chatter, refuse_too_many
from torsion.kernels.motion.event_driven_motion import Event, EventDrivenMotion
from torsion.kernels.motion.regimes.linear_regime import Layout, Modes, Moved, Regime, regime_of
from torsion.kernels.motion.regimes.modal_loads import (
    SAME_TIME,
    LoadedModes,
    Start,
    Turning,
    inputs_at,
)
from torsion.kernels.motion.regimes.piecewise_elements import OPEN, Friction
from torsion.kernels.motion.regimes.regime_events import BLOCK, RADIANS, Watch, looks
from torsion.kernels.motion.regimes.sampled_rows import (
    Rows,
    features,
    rates_of,
    rows_of,
    sample,
    together,
)
from torsion.kernels.motion.torques.polynomial_torques import ENDS, POINTS, SERIES

CHATTER = 50  # events of one element without progress
MOST_EVENTS = 200_000
NEWS = 100  # events and looks between two reports of progress
# events, after two times of which those of the whole motion are judged by their pace
WATCHED = 10_000
MOST_KEPT = 4_000_000  # numbers in matrices of samples
LONGEST = 64.0  # parts of a motion, at least


def _coordinate_rows(regime: Regime) -> Rows:
    """Real and imaginary parts of all coordinates, and positions of what nothing holds."""
    size, number = len(regime.root), regime.free.shape[1]
    by_y = np.concatenate([np.eye(size), -1j * np.eye(size), np.zeros((number, size))])
    by_turned = np.eye(2 * size + number, number, -2 * size)
    return Rows(by_y, by_turned, np.zeros((3, len(by_y), regime.train.inputs)))


def _interface_rows(regime: Regime) -> Rows:
    """Angles, speeds and accelerations of the interfaces."""
    layout, shape = Layout(regime.train), regime.train.shape
    values = np.zeros((2, len(shape), layout.size))
    values[0, :, layout.position] = values[1, :, layout.speed] = shape
    angle, speed = (rows_of(regime, row) for row in values)
    return together(angle, speed, rates_of(regime, speed))


def _event_rows(regime: Regime) -> Rows:
    """Switching functions and their rates."""
    functions = rows_of(regime, regime.events)
    return together(functions, rates_of(regime, functions))


@dataclass
class March:
    """The motion while it is computed, from event to event or under `collocation`.

    twist: (elements,) rad; position: of all motions; modes: regimes of the elements. fineness: of the parts that the
    fastest motion of a regime allows. progress: called with the share of the time that is done. carrier: how interfaces
    turn without any torque.
    """

    train: LoadedModes
    duration: float
    twist: FloatArray
    position: FloatArray
    speed: FloatArray
    modes: Modes = ()
    fineness: float = 1.0
    progress: Callable[[float], None] = lambda share: None
    carrier: Callable[[FloatArray], Turning] | None = None
    steps: list[tuple[int, Start]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    parts: FloatArray = field(init=False)
    idle: int = 0  # events without progress
    last: float = -math.inf  # s, when there was some
    done: int = 0  # events and looks
    regimes: dict[Modes, Regime] = field(default_factory=dict)
    watches: dict[Modes, Watch] = field(default_factory=dict)
    kept: dict[tuple[object, ...], FloatArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rigid = self.train.modes.rigid
        self.begun = np.zeros(rigid)
        self.position, self.speed = self.position.copy(), self.speed.copy()
        self.twist, self.parts = self.twist.copy(), np.zeros((self.number, 1))
        self.interval = 0
        self.rearm(0.0)

    @property
    def regime(self) -> Regime:
        """The present regime, built once."""
        if self.modes not in self.regimes:
            self.regimes[self.modes] = regime_of(self.train, self.modes)
        return self.regimes[self.modes]

    def values(self, time: float) -> FloatArray:
        """(rows,) positions, speeds, inputs and their rates at the present state."""
        train, layout = self.train, Layout(self.train)
        values, loads = np.zeros(layout.size), slice(1, train.following.start)
        since = np.array([time - train.history.begin[self.interval]])
        acting = train.loads_at(self.interval, since, 2)[:, 0]
        values[layout.position], values[layout.speed] = self.position, self.speed
        inputs = values[layout.inputs]  # a view
        inputs[0], inputs[loads], inputs[train.following.stop :] = (
            1.0,
            acting[:, 0],
            self._offsets(),
        )
        values[layout.input_rates][loads] = acting[:, 1]
        return values

    def _offsets(self) -> FloatArray:
        """(elements,) rad by which twists of the motions exceed those of the springs."""
        regime = self.regime
        turned = self.train.ends @ self.position
        own = np.where(regime.moves, self.twist - regime.offset, 0.0)
        return np.where(regime.moves | regime.sticks, turned, 0.0) - own

    def begin(self, time: float) -> None:
        """A step in the present regime from a time on; rigid motions count anew, so that no twist has large angles."""
        regime, train, rigid = self.regime, self.train, self.train.modes.rigid
        if train.elements:
            own = np.where(regime.moves, self.twist - regime.offset, 0.0)[regime.tied]
            own -= train.ends[regime.tied, rigid:] @ self.position[rigid:]
            near = regime.untwisting @ own
            self.begun = self.begun + self.position[:rigid] - near
            self.position[:rigid] = near
        inputs = np.zeros(train.inputs)
        offset = self._offsets()
        inputs[train.following.stop :] = offset
        y, turned = regime.begin(self.position, self.speed, inputs)
        self.start = Start(
            self.interval,
            np.array([time]),
            y[:, None],
            turned[:, None],
            offset[:, None],
            np.zeros((POINTS, self.number, 1)),
            np.ones(1),
            self.begun[:, None],
        )
        self.features = features(train, self.start)

    def rearm(self, time: float) -> None:
        """At a break: the torques that begin, and friction whose capacity ends or begins."""
        train = self.train
        if not self.modes and train.elements:
            self.modes = (0,) * len(train.elements)
        self.interval = int(np.searchsorted(train.history.begin, time, side="right")) - 1
        for number, element in enumerate(train.elements):
            if isinstance(element, Friction) and element.signal is not None:
                acting = train.acting[self.interval]
                acts = bool((acting.load == element.signal).any())
                if acts == (self.modes[number] != OPEN):
                    continue
                self.twist[number] = 0.0 if acts else self.twist[number]
                self.enter(time, number, self._closing(number) if acts else OPEN)
                self.twist[number] = 0.0
        self.begin(time)

    def _closing(self, number: int) -> int:
        """The regime of friction that gains a capacity: it slips, unless its ends turn together to rounding."""
        row = self.train.ends[number]
        slipping = float(row @ self.speed)
        is_still = abs(slipping) <= 1e-12 * float(np.abs(row) @ np.abs(self.speed))
        return 0 if is_still else int(np.sign(slipping))

    def enter(self, time: float, number: int, to: int) -> None:
        """An element in another regime, its own twist set to what it is exactly there."""
        element, old = self.train.elements[number], self.modes[number]
        law, old_law, slipping = element.law(to), element.law(old), 0.0
        if old_law.kind == "given":
            slipping = self.regime.torque[number] @ self.values(time)
        self.modes = (*self.modes[:number], to, *self.modes[number + 1 :])
        if word := element.word(old, to):
            self.events.append(Event(time, number, word))
        if (twist := element.settled(old, to)) is not None:
            self.twist[number] = twist
        elif old_law.kind == "given" and law.kind == "spring":
            row = self.regime.torque[number]
            offset = Layout(self.train).inputs.start + self.train.following.stop + number
            self.twist[number] -= (slipping - row @ self.values(time)) / row[offset]
        elif law.kind == "stuck":
            # Its ends turn together, of which the root knows all digits but the last.
            ends = self.train.ends[number]
            self.speed -= ends * ((ends @ self.speed) / (ends @ ends))

    def on(self, time: float, end: float) -> float:
        """A step, or less where an event ends it: until when."""
        regime, start = self.regime, self.start
        numbers = {modes: number for number, modes in enumerate(self.regimes)}
        self.steps.append((numbers[self.modes], start))
        event = self._first_event(time, end - time)
        if event is None:
            function, reached, moved = None, end, self._moved(end - time, end - time)
        else:
            late, function, moved = event
            reached = time + late
        position, speed = regime.positions(moved)[:, 0], regime.speeds(moved.y)[:, 0]
        own = self.train.ends @ position - start.offset[:, 0]
        self.twist = np.where(regime.moves, own + regime.offset, self.twist)
        self.position, self.speed = position, speed
        if function is not None:
            self.enter(reached, *regime.switches[function])
            part = self._part(regime, math.inf)
            near = max(1e-12 * part, 4.0 * math.ulp(reached))
            is_idle = reached - self.last <= near
            self.idle, self.last = (self.idle + 1, self.last) if is_idle else (0, reached)
            if self.idle > CHATTER * len(self.modes):
                raise Chatter(reached, regime.switches[function][0])
            count = len(self.events)
            if count > MOST_EVENTS or count % WATCHED == 0:
                backs = (back * WATCHED for back in (2, 1) if back * WATCHED <= count)
                times = [*(self.events[-back].time for back in backs), reached]
                refuse_too_many(count, MOST_EVENTS, times, WATCHED, self.duration)
            self._tell(reached)
        self.begin(reached)
        return reached

    def _part(self, regime: Regime, length: float) -> float:
        """s, of the parts in which events are looked for in a step of a length."""
        fastest = regime.fastest
        longest = min(self.duration / LONGEST, length)
        return self.fineness * min(longest, RADIANS / fastest if fastest else math.inf)

    def _first_event(self, time: float, length: float) -> tuple[float, int, Moved] | None:
        """When (s from a time on) the first event is within a length, of which function, and the motion then."""
        regime = self.regime
        if not len(regime.events):
            return None
        part = self._part(regime, length / 4.0 if self.number else math.inf)
        watch = self.watches.setdefault(self.modes, Watch(regime))
        for first, last in looks(math.ceil(length / part)):
            times = part * np.arange(first, last + 1.0)
            values = self._samples(_event_rows, times, length)
            event = watch.first_event(partial(self._moved, length), times, values, length)
            if event is not None:
                return event
            if last % BLOCK == 0:
                self._tell(time + last * part)
        return None

    def _moved(self, length: float, late: float, orders: int = 1) -> Moved:
        """The motion in a step of a length at a time since its begin (s), with some derivatives of its inputs."""
        size, time = len(self.start.y), np.array([late])
        samples = self._samples(_coordinate_rows, time, length)
        real, imaginary, turned = np.split(samples, [size, 2 * size])
        inputs = inputs_at(self.train, self.start, time, orders)
        return Moved(real + 1j * imaginary, turned, inputs[:, :, 0], inputs[:, :, 1:])

    def _samples(
        self, rows: Callable[[Regime], Rows], times: FloatArray, length: float
    ) -> FloatArray:
        """(rows, times) of the step that begins, at times since then (s)."""
        begin = np.concatenate([self.features, self.start.series.ravel()])
        return np.asarray(self._sampled(rows, times, length) @ begin)

    def _sampled(
        self, rows: Callable[[Regime], Rows], times: FloatArray, length: float
    ) -> FloatArray:
        """(rows, times, features)"""
        regime, acting = self.regime, self.train.acting[self.interval]
        span = float(times[0]), float(times[-1]), len(times)
        key = rows, *span, length if self.number else 0.0
        return self._kept(key, lambda: sample(regime, acting, rows(regime), times, length))

    def _kept(self, key: tuple[object, ...], build: Callable[[], FloatArray]) -> FloatArray:
        """A matrix of the present regime, built once."""
        key = self.modes, self.train.acting[self.interval].kind, *key
        if key not in self.kept:
            matrix = build()
            if sum(matrix.size for matrix in self.kept.values()) > MOST_KEPT:
                self.kept.clear()
            self.kept[key] = matrix
        return self.kept[key]

    def _tell(self, time: float) -> None:
        self.done += 1
        if self.done % NEWS == 0:
            self.progress(time / self.duration)

    def until(self, ends: Sequence[float]) -> Iterator[EventDrivenMotion]:
        """From time 0 to each of some times (s), ascending; the last is the duration."""
        breaks = self.train.history.begin[self.train.history.begin < self.duration].tolist()
        for time, end in pairwise(sorted({*breaks, *ends})):
            if time in breaks[1:]:
                self.rearm(time)
            reached = time
            while reached < end:
                reached = self.on(reached, end)
            if end in ends:
                yield self.finished(end)

    def finished(self, end: float) -> EventDrivenMotion:
        """The motion so far, which ends there."""
        regimes = tuple(self.regimes.values())
        return EventDrivenMotion(self.train, tuple(self.steps), regimes, tuple(self.events), end)

    # What `collocation` needs.

    @property
    def number(self) -> int:
        """How many interfaces torques act at."""
        return len(self.train.shape)

    @property
    def at_once(self) -> FloatArray:
        """(interfaces, interfaces) 1/(kg m2): accelerations that torques make."""
        force = self.regime.force[:, self.train.following]
        return np.asarray(self.train.shape @ self.regime.speeds(force))

    def influence(self, length: float) -> FloatArray:
        """What torques of 1 at the nodes of a step (s) add, (kinds of a turning, interfaces, ENDS, interfaces, nodes)."""

        def by_nodes() -> FloatArray:
            sampled = self._sampled(_interface_rows, length * ENDS, length)
            shape = 3, self.number, len(ENDS), POINTS, self.number
            by_series = sampled[:, :, -POINTS * self.number :].reshape(shape)
            return np.asarray(np.einsum("dgekf,kn->dgefn", by_series, SERIES))

        return self._kept(("influence", length), by_nodes)

    def _turning(self, time: FloatArray, samples: FloatArray) -> Turning:
        """Whole angles, speeds and accelerations of the interfaces at times, of their samples since the step began."""
        angle, speed, acceleration = samples.reshape(3, self.number, len(time))
        begun = (self.train.shape[:, : len(self.begun)] @ self.begun)[:, None]
        if self.carrier is None:
            return angle + begun, speed, acceleration
        carried = self.carrier(time)
        return angle + begun + carried[0], speed + carried[1], acceleration + carried[2]

    def going_on(self, time: float, length: float) -> Turning:
        """At the ENDS of a step, with no torques in it."""
        samples = self._samples(_interface_rows, length * ENDS, length)
        turning = self._turning(time + length * ENDS, samples)
        sizes = np.abs(self.train.shape) @ np.abs(self.speed)
        self.parts = np.abs(turning[1]).max(axis=1, keepdims=True) + sizes[:, None]
        return turning

    def at_begin(self, time: float) -> Turning:
        """At the begin of a step."""
        return self._turning_at(time, self.start, np.zeros(1))

    def _turning_at(self, time: float, start: Start, late: FloatArray) -> Turning:
        moved, shape, regime = self.regime.moved(start, late), self.train.shape, self.regime
        rates = regime.speeds(regime.rates_of(moved))
        motions = regime.positions(moved), regime.speeds(moved.y), rates
        return self._turning(time + late, np.stack([shape @ motion for motion in motions]))

    def inside(self, time: float, length: float, torque: FloatArray, share: FloatArray) -> Turning:
        """At shares of a step under torques (interfaces, nodes)."""
        return self._turning_at(time, self._under(torque, length), share * length)

    def _under(self, torque: FloatArray, length: float) -> Start:
        series = (SERIES @ torque.T)[:, :, None]
        return replace(self.start, series=series, length=np.array([length]))

    def advance(self, time: float, length: float, end: float, torque: FloatArray) -> float:
        """Go on to the end of such a step, or as far as the train stays the same: to a time (s)."""
        self.start = self._under(torque, length)
        reached = self.on(time, end)
        breaks = self.train.history.begin
        if reached == end and (np.abs(breaks - end) <= SAME_TIME * end).any():
            self.rearm(end)
        return reached
