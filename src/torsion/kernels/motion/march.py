"""A train moved on from event to event: exact between them, also under torques that are polynomials of a step.

Within a regime of its elements the train is linear. An event of an element ends a step there, and the next begins in
another regime: the motion is read at the ends of short parts of a step, and a part is looked at more closely where a
switching function is below zero at an end of it, or a tangent at one end is below zero at the other; there the functions
are Taylor polynomials, and the root is exact to rounding. Every element keeps a twist of its own, so that no twist is a
difference of large angles.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.motion.event_driven_motion import Event, EventDrivenMotion
from torsion.kernels.motion.first_root import first_root
from torsion.kernels.motion.linear_regime import Modes, Regime, regime_of
from torsion.kernels.motion.loaded_modes import (
    AT_END,
    ENDS,
    POINTS,
    POWERS,
    SAME_TIME,
    SERIES,
    LoadedModes,
    Start,
    Turning,
)

CHATTER = 50  # events of one element without progress
MOST_EVENTS = 200_000
NEWS = 100  # events and looks between two reports of progress
# events, after two times of which those of the whole motion are judged by their pace
WATCHED = 10_000
GAIN = 1.2  # of the pace: such a motion may come to its end yet
MOST_KEPT = 4_000_000  # numbers in matrices of samples
LONGEST = 64.0  # parts of a motion, at least
LOOKS = (0, 16, 64, 256)  # parts that are looked at together: most events come soon
BLOCK = LOOKS[-1]
RADIANS = 0.5  # of the fastest motion in a part: 0.5**16/16! = 7e-19
TERMS = 16  # of a Taylor polynomial
ORDERS = np.arange(float(TERMS))
FACTORIALS = np.cumprod([1.0, *range(1, TERMS)])
ROUNDING = 1e-13  # of the largest coefficient: a function below zero by less is at zero
EXACT = 2e-15  # of the terms of a function, whose sum it knows no better
# (ENDS, nodes) torques there, of those at the nodes
BY_NODES = np.concatenate([np.eye(POINTS), AT_END.T])


class Chatter(SolveError):
    """An element switches without end: its number is the path."""


class TooManyEvents(SolveError):
    """More events than are kept."""


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

    def __post_init__(self) -> None:
        self.position, self.speed, self.twist = (
            row.copy() for row in (self.position, self.speed, self.twist)
        )
        self.number = len(self.train.shape)  # of interfaces at which torques act
        self.begun, self.parts = np.zeros(self.train.modes.rigid), np.zeros((self.number, 1))
        self.steps, self.events = list[tuple[int, int, Start]](), list[Event]()
        self.idle, self.last = 0, -math.inf  # events without progress; s, when there was some
        self.done, self.size = 0, 0  # events and looks; numbers in matrices that are kept
        self.regimes = dict[Modes, Regime]()
        self.matrices = dict[tuple[object, ...], dict[tuple[object, ...], Any]]()
        self.rearm(0.0)

    @property
    def regime(self) -> Regime:
        """The present regime, built once."""
        if self.modes not in self.regimes:
            self.regimes[self.modes] = regime_of(self.train, self.modes)
        return self.regimes[self.modes]

    def values(self, time: float) -> FloatArray:
        """(rows,) positions, speeds, inputs and their rates at the present state."""
        since = np.array([time - self.train.history.begin[self.interval]])
        acting = self.train.loads_at(self.interval, since, 2)[:, 0].T
        offset, none = self._offset(), np.zeros(self.number)
        inputs = [[1.0], acting[0], none, offset, [0.0], acting[1], none, 0.0 * offset]
        return np.concatenate([self.position, self.speed, *inputs])

    def _offset(self) -> FloatArray:
        """(elements,) rad by which twists of the motions exceed those of the springs."""
        regime = self.regime
        turned = np.where(regime.moves | regime.sticks, self.train.ends @ self.position, 0.0)
        return turned - np.where(regime.moves, self.twist - regime.offset, 0.0)

    def begin(self, time: float) -> None:
        """A step in the present regime from a time on; rigid motions count anew, so that no twist has large angles."""
        regime, train, rigid = self.regime, self.train, self.train.modes.rigid
        if train.elements:
            own = np.where(regime.moves, self.twist - regime.offset, 0.0)[regime.tied]
            own -= train.ends[regime.tied, rigid:] @ self.position[rigid:]
            near = regime.untwisting @ own
            self.begun = self.begun + self.position[:rigid] - near
            self.position[:rigid] = near
        offset = self._offset()
        y, turned = regime.begin(self.position, self.speed, offset)
        self.start = Start(
            np.array([time]),
            y[:, None],
            turned[:, None],
            offset[:, None],
            np.zeros((POINTS, self.number, 1)),
            self.begun[:, None],
        )
        self.features: FloatArray | None = None
        # A cached matrix is of a regime, and of the loads, their rates, and which of them have slopes.
        kind = self.modes, train.history.acting[self.interval].kind
        self.kept = self.matrices.setdefault(kind, {})

    def rearm(self, time: float) -> None:
        """At a break: the torques that begin, and friction whose capacity ends or begins."""
        train = self.train
        if not self.modes and train.elements:
            self.modes = (0,) * len(train.elements)
        self.interval = int(np.searchsorted(train.history.begin, time, side="right")) - 1
        for number, element in enumerate(train.elements):
            if element.signal is not None:
                from torsion.kernels.motion.piecewise_elements import OPEN

                acts = bool((train.history.acting[self.interval].load == element.signal).any())
                if acts == (self.modes[number] != OPEN):
                    continue
                self.twist[number] = 0.0 if acts else self.twist[number]
                # Friction that gains a capacity slips, unless its ends turn together to rounding.
                row = train.ends[number]
                slipping = float(row @ self.speed)
                is_still = abs(slipping) <= 1e-12 * float(np.abs(row) @ np.abs(self.speed))
                closing = 0 if is_still else int(np.sign(slipping))
                self.enter(time, number, closing if acts else OPEN)
                self.twist[number] = 0.0
        self.begin(time)

    def enter(self, time: float, number: int, to: int) -> None:
        """An element in another regime, its own twist set to what it is exactly there."""
        element, old = self.train.elements[number], self.modes[number]
        law, old_law, slipping = element.law(to), element.law(old), 0.0
        if old_law.kind == "given":
            slipping = self.regime.torque[number] @ self.values(time)
        self.modes = (*self.modes[:number], to, *self.modes[number + 1 :])
        word, twist = element.switch(old, to)
        if word:
            self.events.append(Event(time, number, word))
        if twist is not None:
            self.twist[number] = twist
        elif old_law.kind == "given" and law.kind == "spring":
            row = self.regime.torque[number]
            offset = self.train.columns[2].start + self.train.following.stop + number
            self.twist[number] -= (slipping - row @ self.values(time)) / row[offset]
        elif law.kind == "stuck":
            # Its ends turn together, of which the root knows all digits but the last.
            ends = self.train.ends[number]
            self.speed -= ends * ((ends @ self.speed) / (ends @ ends))

    def on(self, time: float, end: float) -> float:
        """A step, or less where an event ends it: until when."""
        regime, start = self.regime, self.start
        numbers = {modes: number for number, modes in enumerate(self.regimes)}
        self.steps.append((numbers[self.modes], self.interval, start))
        event = self._first_event(time, end - time)
        if event is None:
            reached, function = end, None
            y, turned = self._coordinates(end - time)
        else:
            late, function, y, turned = event
            reached = time + late
        self.position = regime.positions(y, turned, start.offset)[:, 0]
        self.speed = regime.speeds(y)[:, 0]
        own = self.train.ends @ self.position - start.offset[:, 0]
        self.twist = np.where(regime.moves, own + regime.offset, self.twist)
        if function is not None:
            element, to = regime.switches[function]
            self.enter(reached, element, to)
            # Events without time between them: a coupling that comes back at once would do so for ever.
            near = max(1e-12 * self._part(regime, math.inf), 4.0 * math.ulp(reached))
            is_idle = reached - self.last <= near
            self.idle, self.last = (self.idle + 1, self.last) if is_idle else (0, reached)
            if self.idle > CHATTER * len(self.modes):
                message = (
                    f"from {reached:.6g} s on, a coupling changes between its regimes without end"
                )
                hint = "give its contact damping, or its friction a stiffness"
                raise Chatter(message, hint, (element,))
            self._refuse_too_many(reached)
            self._tell(reached)
        # A break of what acts is known beforehand and is no event; friction may gain or lose its capacity there.
        breaks = self.train.history.begin
        if (
            reached == end
            and (np.abs(breaks - end) <= SAME_TIME * end).any()
            and end < self.duration
        ):
            self.rearm(end)
        else:
            self.begin(reached)
        return reached

    def _refuse_too_many(self, time: float) -> None:
        """Raises TooManyEvents, as soon as the pace of the events lets no end be reached."""
        count, end = len(self.events), math.inf
        if count % WATCHED == 0 and count >= 2 * WATCHED:
            times = [*(self.events[-back * WATCHED].time for back in (2, 1)), time]
            pace = np.diff(times) / (WATCHED, WATCHED - 1)  # s an event
            if pace[1] <= GAIN * pace[0]:
                end = time + (MOST_EVENTS - count) * float(pace[1])
        if count > MOST_EVENTS or end < self.duration:
            end = time if count > MOST_EVENTS else end
            count = min(count, MOST_EVENTS)
            message = f"the motion has its {count} events at {time:.6g} s, and no more than {MOST_EVENTS} are followed"
            raise TooManyEvents(message, f"a `duration` below {end:.4g} s")

    def _part(self, regime: Regime, length: float) -> float:
        """s, of the parts in which events are looked for in a step of a length."""
        fastest = regime.fastest
        longest = min(self.duration / LONGEST, length)
        return self.fineness * min(longest, RADIANS / fastest if fastest else math.inf)

    def _first_event(
        self, time: float, length: float
    ) -> tuple[float, int, ComplexArray, FloatArray] | None:
        """When (s from a time on) the first event is within a length, of which function; coordinates there."""
        regime = self.regime
        if not len(regime.events):
            return None
        part = self._part(regime, length / 4.0 if self.number else math.inf)
        number = math.ceil(length / part)
        # By blocks of parts, short ones first: most steps end soon, and samples beyond the event are never needed.
        for first, last in pairwise([*LOOKS, *range(2 * BLOCK, number + BLOCK, BLOCK)]):
            if first >= number:
                break
            times = part * np.arange(first, min(last, number) + 1.0)
            values = self._samples("events", times)
            value, rise = values.reshape(2, -1, len(times))
            # An event may lie in a part when the tangent at either end of it reaches zero within.
            ahead = np.minimum(value, value + part * rise)[:, :-1] <= 0.0
            below = ahead | (np.minimum(value, value - part * rise)[:, 1:] <= 0.0)
            for number_of_part in np.flatnonzero(below.any(axis=0)).tolist():
                begin = float(times[number_of_part])
                functions = np.flatnonzero(below[:, number_of_part]).tolist()
                root = self._root(begin, part, functions)
                if root is not None and (late := begin + root[0] * part) <= length:
                    return late, *root[1:]
            if (looked := first + len(times) - 1) % BLOCK == 0:
                self._tell(time + looked * part)
        return None

    def _root(
        self, late: float, part: float, functions: list[int]
    ) -> tuple[float, int, ComplexArray, FloatArray] | None:
        """The first root of some of the functions within a part that begins so late, in shares of it; coordinates there."""
        regime, start = self.regime, self.start
        if ("watch",) not in self.kept:
            from torsion.kernels.motion.sampled_rows import rows_of

            rows = rows_of(regime, regime.events)
            self.kept["watch",] = rows, np.abs(regime.events), np.abs(rows.by_y)
        rows, sizes, sizes_by_y = self.kept["watch",]
        # Derivatives of the exact motion at the begin of the part, of as many orders as make a polynomial exact to
        # rounding.
        y, turned = self._coordinates(late)
        time = np.array([late])
        inputs = self.train.inputs_at(self.interval, start, time, TERMS + 1)[:, 0]
        pushed = (regime.force @ inputs[:, : TERMS - 1]).T
        derivatives = [y[:, 0]]
        for push in pushed:
            derivatives.append(regime.root * derivatives[-1] + push)
        all_y = np.array(derivatives).T
        all_turned = np.concatenate([turned, all_y[: len(turned), :-1].real], axis=1)
        terms = (rows.by_y @ all_y).real + rows.by_turned @ all_turned
        terms += rows.by_inputs[0] @ inputs[:, :TERMS] + rows.by_inputs[1] @ inputs[:, 1:]
        state = regime.positions(y, turned, start.offset), regime.speeds(y)
        values = np.concatenate([*state, inputs[:, :1], inputs[:, 1:2]])
        size = EXACT * (sizes @ np.abs(values) + sizes_by_y @ np.abs(y))[:, 0]
        weight = part**ORDERS / FACTORIALS
        terms *= weight
        best: tuple[float, int] | None = None
        for function in functions:
            polynomial = terms[function].tolist()
            rounding = ROUNDING * max(map(abs, polynomial)) + float(size[function])
            share = first_root(polynomial, rounding)
            if share is not None and (best is None or share < best[0]):
                best = share, function
        if best is None:
            return None
        weight = weight * best[0] ** ORDERS
        return *best, (all_y @ weight)[:, None], (all_turned @ weight)[:, None]

    def _coordinates(self, late: float) -> tuple[ComplexArray, FloatArray]:
        """Coordinates and positions of what nothing holds, at a time since the begin of a step (s)."""
        time, size = np.array([late]), len(self.start.y)
        if not (self.number or self.modes):  # no time is met again
            return self.regime.coordinates(self.interval, self.start, time)
        samples = self._samples("coordinates", time)
        return samples[:size] + 1j * samples[size : 2 * size], samples[2 * size :]

    def _samples(self, rows: str, times: FloatArray) -> FloatArray:
        """(rows, times) of the step that begins, at times since then (s)."""
        if self.features is None:
            from torsion.kernels.motion.sampled_rows import features

            self.features = features(self.train, self.interval, self.start)
        begin = np.concatenate([self.features, self.start.polynomial.ravel()])
        return np.asarray(self._sampled(rows, times) @ begin)

    def _sampled(self, rows: str, times: FloatArray) -> FloatArray:
        """(rows, times, features) of the present regime, built once."""
        key = rows, times[0], times[-1], len(times)
        if key not in self.kept:
            from torsion.kernels.motion.sampled_rows import ROWS, sample

            regime, acting = self.regime, self.train.history.acting[self.interval]
            self._keep(key, sample(regime, acting, ROWS[rows](regime), times))
        return np.asarray(self.kept[key])

    def _keep(self, key: tuple[object, ...], matrix: FloatArray) -> None:
        """Keep a matrix; all are given up where they are too many."""
        if self.size > MOST_KEPT:
            for matrices in self.matrices.values():
                matrices.clear()
            self.size = 0
        self.kept[key] = matrix
        self.size += matrix.size

    def _tell(self, time: float) -> None:
        self.done += 1
        if self.done % NEWS == 0:
            self.progress(time / self.duration)

    def until(self, ends: Sequence[float]) -> Iterator[EventDrivenMotion]:
        """From time 0 to each of some times (s), ascending; the last is the duration."""
        breaks = self.train.history.begin[self.train.history.begin < self.duration].tolist()
        for time, end in pairwise(sorted({*breaks, *ends})):
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

    def influence(self, length: float) -> FloatArray:
        """What torques of 1 at the nodes of a step (s) add to torques and a turning, (4, interfaces, ENDS, torques)."""
        if ("influence", length) not in self.kept:
            sampled = self._sampled("interfaces", length * ENDS)
            number, shape = self.number, (3, self.number, len(ENDS), POINTS, self.number)
            by_powers = sampled[:, :, -POINTS * number :].reshape(shape)
            matrix = np.empty((4, number, len(ENDS), number, POINTS))
            matrix[0] = np.einsum("gf,en->gefn", np.eye(number), BY_NODES)
            powers = POWERS / length ** np.arange(POINTS)[:, None]
            by_series = np.einsum("dgekf,kc->dgefc", by_powers, powers)
            matrix[1:] = by_series @ SERIES
            self._keep(("influence", length), matrix.reshape(*matrix.shape[:3], -1))
        return np.asarray(self.kept["influence", length])

    def _turning(self, time: FloatArray, turning: FloatArray) -> Turning:
        """Whole angles, speeds and accelerations of the interfaces at times, of those since the step began."""
        turning[0] += (self.train.shape[:, : len(self.begun)] @ self.begun)[:, None]
        return turning if self.carrier is None else turning + self.carrier(time)

    def going_on(self, time: float, length: float) -> Turning:
        """At the ENDS of a step, with no torques in it."""
        samples = self._samples("interfaces", length * ENDS)
        turning = self._turning(time + length * ENDS, samples.reshape(3, self.number, len(ENDS)))
        sizes = np.abs(self.train.shape) @ np.abs(self.speed)
        self.parts = np.abs(turning[1]).max(axis=1, keepdims=True) + sizes[:, None]
        return turning

    def at(self, time: float, start: Start, late: FloatArray) -> Turning:
        """At times since the begin of a step (s) that starts at a time."""
        reading = self.regime.read(self.interval, start, late)
        motions = np.stack([reading.position, reading.speed, reading.acceleration])
        return self._turning(time + late, self.train.shape @ motions)

    def under(self, torque: FloatArray, length: float) -> Start:
        """The step that begins, under torques (interfaces, nodes) over a length (s)."""
        powers = POWERS @ (SERIES @ torque.T) / length ** np.arange(POINTS)[:, None]
        return self.start._replace(polynomial=powers[:, :, None])
