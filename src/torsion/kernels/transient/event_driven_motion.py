"""Exact motion of a train whose few nonlinear elements are linear between events.

The state is z = (x of the elements, w q of the elastic modes, speeds of all motions, states of the torques, angles of
the rigid motions where torques follow them, 1). x of an element is a state of its own, so that no twist is a difference
of large angles; it is scaled by the root of the element's stiffness, as the modes are by their frequencies, so that A
is balanced. A regime is one state of every element; its matrix, exponentials and rows are kept.

Modes above a band may be left out: their `compliance` F is then in series with the elements, u = x + rest - F T.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.transient.endless_events import Chatter, refuse_too_many
from torsion.kernels.transient.generated_signals import Signals
from torsion.kernels.transient.linear_regime import RADIANS, STEPS, Regime, fastest
from torsion.kernels.transient.piecewise_elements import OPEN, Clearance, Element, Friction, Law, Switch

CHATTER = 50  # events of one element without progress
MOST_EVENTS = 200_000
NEWS = 100  # blocks between two reports of progress
WATCHED = 10_000  # events, after two times of which those of the whole motion are judged by their pace
State = tuple[int, ...]  # the regime of every element


@dataclass(frozen=True)
class PiecewiseTrain:
    """Rigid motions and elastic modes of generalised inertia 1, the elements between them, and what acts on them."""

    w: FloatArray  # (modes,) rad/s
    damping: FloatArray  # (rigid motions + modes, the same) 1/s
    elements: tuple[Element, ...]
    signals: Signals
    force: ComplexArray  # (rigid motions + modes, signals); the torque is Re(force * signal)
    compliance: FloatArray | None = None  # (elements, elements) rad/(N m) of the modes that are left out
    rest: ComplexArray | None = None  # (elements, signals) rad/(N m): their answer to the signals

    @property
    def rigid(self) -> int:
        """Number of rigid motions."""
        return len(self.damping) - len(self.w)

    @cached_property
    def layout(self) -> tuple[slice, slice, slice, slice, slice]:
        """Where x, w q, the speeds, the signals and the angles stand in a state; 1 stands last."""
        angles = self.rigid if self.signals.polynomials else 0
        ends = np.cumsum([0, len(self.elements), len(self.w), len(self.damping), self.signals.size, angles]).tolist()
        x, place, speed, signal, turned = (slice(*pair) for pair in pairwise(ends))
        return x, place, speed, signal, turned

    @property
    def size(self) -> int:
        """Of a state."""
        return int(self.layout[4].stop) + 1

    def at_first(self, twist: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(state,) from x (elements,) rad, places (modes,), speeds (rigid motions + modes,), without signals."""
        z = np.zeros(self.size)
        for part, values in zip(self.layout, (self.root * twist, self.w * place, speed), strict=False):
            z[part] = values
        z[-1] = 1.0
        return z

    @cached_property
    def root(self) -> FloatArray:
        """(elements,) sqrt(N m/rad), by which x is scaled."""
        return np.array([math.sqrt(one.stiffness) if math.isfinite(one.stiffness) else 1.0 for one in self.elements])

    @cached_property
    def ends(self) -> FloatArray:
        """(elements, rigid motions + modes) scaled."""
        rows = np.array([one.ends for one in self.elements]).reshape(-1, len(self.damping))
        return np.asarray(self.root[:, None] * rows)

    def rows(self, factor: ComplexArray | FloatArray) -> FloatArray:
        """(rows, state) of Re(factor (rows, signals) * signals)."""
        found = np.zeros((len(factor), self.size))
        real, imaginary = self.signals.rows
        found[:, self.layout[3]] = factor.real @ real - factor.imag @ imaginary
        return found

    @cached_property
    def unforced(self) -> FloatArray:
        """(state, state) A without elements."""
        matrix, (_, place, speed, signal, turned) = np.zeros((self.size, self.size)), self.layout
        elastic = slice(speed.start + self.rigid, speed.stop)
        matrix[place, elastic] = np.diag(self.w)
        matrix[elastic, place] = -np.diag(self.w)
        matrix[speed, speed] = -self.damping
        matrix[speed] += self.rows(self.force)
        matrix[signal, signal] = self.signals.matrix
        matrix[turned, speed.start : speed.start + turned.stop - turned.start] = np.eye(turned.stop - turned.start)
        return matrix

    @cached_property
    def relative_speed(self) -> FloatArray:
        """(elements, state) scaled."""
        return np.pad(self.ends, ((0, 0), (self.layout[2].start, self.size - self.layout[2].stop)))

    @cached_property
    def resting(self) -> FloatArray:
        """(elements, state) scaled twists that the modes left out add by themselves."""
        if self.rest is None:
            return np.zeros((len(self.elements), self.size))
        return np.asarray(self.root[:, None] * self.rows(self.rest))

    @cached_property
    def series(self) -> FloatArray:
        """(elements, elements) scaled compliance of the modes that are left out."""
        size = len(self.elements)
        return np.zeros((size, size)) if self.compliance is None else self.root[:, None] * self.compliance * self.root

    @cached_property
    def capacity(self) -> FloatArray:
        """(elements, state) N m."""
        constant, chosen = np.zeros(len(self.elements)), np.zeros((len(self.elements), self.signals.number))
        for number, element in enumerate(self.elements):
            if isinstance(element, Friction) and element.signal is not None:
                chosen[number, element.signal] = 1.0
            elif not isinstance(element, Clearance):
                constant[number] = element.capacity
        rows = self.rows(chosen)
        rows[:, -1] = constant
        return rows


def regime(train: PiecewiseTrain, state: State, *, longest: float, fineness: float, dips: bool) -> Regime:
    """The linear motion while every element stays in its regime; longest: s of a step at most."""
    laws = [one.law(own) for one, own in zip(train.elements, state, strict=True)]
    torque, elastic = _torques(train, laws)
    matrix = train.unforced.copy()
    matrix[train.layout[2]] -= train.ends.T @ torque
    for number, law in enumerate(laws):
        if law.moves:
            matrix[number] = train.relative_speed[number]
    twist = elastic + _offsets(train, laws)
    events = [
        _function(train, number, switch, twist, torque)
        for number, (element, own) in enumerate(zip(train.elements, state, strict=True))
        for switch in element.switches(own)
    ]
    inner = train.layout[3].start
    w = max(fastest(matrix[:inner, :inner]), train.signals.fastest)
    step = fineness * min(longest, RADIANS / w if w else math.inf)
    for number, (law, element) in enumerate(zip(laws, train.elements, strict=True)):
        if law.kind in ("free", "stuck") or math.isinf(element.stiffness):
            elastic[number] = 0.0
        elif law.kind == "given":
            elastic[number] = torque[number]
    rows = np.array(events).reshape(-1, train.size)
    return Regime(matrix, rows, torque * train.root[:, None], elastic, step, dips)


def _offsets(train: PiecewiseTrain, laws: list[Law]) -> FloatArray:
    rows = np.zeros((len(laws), train.size))
    rows[:, -1] = [law.offset for law in laws] * train.root
    return rows


def _torques(train: PiecewiseTrain, laws: list[Law]) -> tuple[FloatArray, FloatArray]:
    """Rows (elements, state) of the scaled torques, and of the scaled twists without offset (free and spring)."""
    left, right = np.eye(len(laws)), np.zeros((len(laws), train.size))
    elastic = train.resting - _offsets(train, laws)
    elastic[:, train.layout[0]] += np.eye(len(laws))
    for number, law in enumerate(laws):
        if law.kind == "spring":
            left[number] += train.series[number]
            right[number] = elastic[number] + _lag(train, number) * train.relative_speed[number]
        elif law.kind == "given":
            right[number] = law.sign * train.capacity[number] / train.root[number]
        elif law.kind == "stuck":
            left[number] = train.ends @ train.ends[number]
            right[number] = train.ends[number] @ train.unforced[train.layout[2]]
    try:
        torque = np.asarray(np.linalg.solve(left, right)) if len(laws) else right
    except np.linalg.LinAlgError:
        message, hint = (
            "rigid clutches stand beside each other, and nothing divides their torque",
            "give one a stiffness",
        )
        raise SolveError(message, hint) from None
    return torque, elastic - train.series @ torque


def _lag(train: PiecewiseTrain, number: int) -> float:
    """s, viscous damping of an element over its stiffness."""
    element = train.elements[number]
    return float(getattr(element, "viscous", 0.0)) / element.stiffness


def _function(train: PiecewiseTrain, number: int, switch: Switch, twist: FloatArray, torque: FloatArray) -> FloatArray:
    """(state,) a switching function; its size is of no account."""
    root = train.root[number]
    if switch.of == "speed":  # of the slider: that of the ends less what a changing capacity takes up in the spring
        changing = train.capacity[number] @ train.unforced
        row, unit = (
            train.relative_speed[number] - switch.factor * changing * root / train.elements[number].stiffness,
            root,
        )
    elif switch.of == "torque":
        row, unit = torque[number], 1.0 / root
    elif switch.of == "twist":
        row, unit = twist[number], root
    else:  # the torque that contact would have
        row = twist[number] + _lag(train, number) * train.relative_speed[number]
        offset = float(getattr(train.elements[number], "half", 0.0)) * root
        row, unit = row - np.sign(-switch.factor) * offset * np.eye(train.size)[-1], 1.0 / root
    function = switch.factor * row + switch.share * train.capacity[number] * unit
    function[-1] += switch.level * unit
    return np.asarray(function)


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
    blocks: list[tuple[float, FloatArray, tuple[State, int], FloatArray]] = field(default_factory=list)
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
                for number, (element, own) in enumerate(zip(self.train.elements, state, strict=True))
                for switch in element.switches(own)
            ]
        return self.pairs[state][function]

    def enter(self, time: float, z: FloatArray, state: State, number: int, to: int) -> tuple[FloatArray, State]:
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
            z[number] += (element.law(old).sign * (self.train.capacity[number] @ z) - row @ z) / row[number]
        elif element.law(to).kind == "stuck":  # its ends turn together, of which the root knows all digits but the last
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
            self.released = self.released + 0.5 * (before**2 - (self.regime(state).elastic @ z) ** 2)
        for number, element in enumerate(self.train.elements):
            if isinstance(element, Friction) and element.signal is not None:
                acts = self.train.signals.acting(element.signal, z[signals])
                if acts == (state[number] != OPEN):
                    continue
                z[number] = 0.0 if acts else z[number]
                z, state = self.enter(time, z, state, number, self._closing(number, z) if acts else OPEN)
                z[number] = 0.0
        return z, state

    def _closing(self, number: int, z: FloatArray) -> int:
        """The regime of friction that gains a capacity: it slips, unless its ends turn together to rounding."""
        row = self.train.relative_speed[number]
        slipping = float(row @ z)
        return 0 if abs(slipping) <= 1e-12 * float(np.abs(row) @ np.abs(z)) else int(np.sign(slipping))

    def on(self, time: float, end: float, z: FloatArray, state: State) -> tuple[float, FloatArray, State, bool]:
        """A block, or less where an event ends it: until when, and whether one did."""
        one = self.regime(state)
        self.blocks.append((time, z, (state, self.halvings), self.released))
        length = min(STEPS * one.step, end - time)
        found = one.first_event(z, length)
        if found is None:
            return end if length == end - time else time + length, one.after(z, length), state, False
        late, function = found
        z, time = one.after(z, late), time + late
        number, to = self.pair(state, function)
        z, state = self.enter(time, z, state, number, to)
        near = max(1e-12 * one.step, 4.0 * math.ulp(time))
        self.idle, self.last = (self.idle + 1, self.last) if time - self.last <= near else (0, time)
        if self.idle > CHATTER * len(state):
            raise Chatter(time, number)
        if len(self.events) > MOST_EVENTS or len(self.events) % WATCHED == 0:
            times = [self.events[-k * WATCHED].time for k in (2, 1) if k * WATCHED <= len(self.events)]
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
        breaks = [float(one) for one in self.train.signals.breaks if one < self.duration]
        for begin, end in zip([0.0, *breaks], [*breaks, self.duration], strict=True):
            z, state = self.rearm(begin, z, state)
            z, state = self.to(begin, end, z, state)
        return self.finished(z, state)

    def finished(self, z: FloatArray, state: State) -> EventDrivenMotion:
        """The whole motion, which ends there."""
        self.regime(state)
        self.blocks.append((self.duration, z, (state, self.halvings), self.released))
        times, states, regimes, released = zip(*self.blocks, strict=True)
        numbers = {one: number for number, one in enumerate(self.kept)}
        return EventDrivenMotion(
            self.train, np.array(times), np.array(states), np.array([numbers[one] for one in regimes]),
            tuple(self.kept.values()), tuple(self.events), np.array(released), self.duration,
        )  # fmt: skip


def event_driven(
    train: PiecewiseTrain, state: State, *, twist: FloatArray, place: FloatArray, speed: FloatArray, duration: float,
    fineness: float = 1.0, dips: bool = True, progress: Callable[[float], None] = lambda share: None,
) -> EventDrivenMotion:  # fmt: skip
    """The motion from regimes and x (elements,) rad, places (modes,) and speeds (rigid motions + modes,) at time 0.

    fineness: of the steps, of those that the fastest motion of a regime allows. dips: look for functions that fall
    below zero and rise again between two samples. progress: called with the share of the time that is done. Raises
    Chatter where events follow each other without progress, and TooManyEvents.
    """
    return March(train, duration, fineness, dips, progress).whole(train.at_first(twist, place, speed), state)
