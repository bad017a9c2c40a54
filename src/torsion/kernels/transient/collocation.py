"""Torques that follow the motion smoothly: collocation at Gauss points, the linear train between them exact.

The unknowns of a step are the torques at its interfaces at 8 Gauss points; a polynomial through them acts on the train,
and Newton's method makes them what their laws require there. A step is kept where the last coefficients of the Legendre
series of every torque are small. A law may have regimes, in each of which it is smooth; a step ends where one is left.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.transient.interface_motion import Influence, Interfaces, Place, Steps, going_on, influence, steps
from torsion.kernels.transient.polynomial_torques import ENDS, POINTS, SERIES

EACH = np.arange(POINTS)
NEWTON = 12
CONVERGED, STALLED = 1e-13, 1e-11  # relative change of the torques; the latter where rounding lets it fall no further
SHORTEST = 2.0**-44  # of the whole motion: a step below it is given up
EASY = 0.004  # of what is allowed: the next step is twice as long
BEFORE_LAST = 0.1  # weight of the last coefficient but one, for where the last happens to vanish
ROUNDED = 16.0 * np.finfo(float).eps  # of a speed: what it may lack in a last coefficient
AT_LIMIT = 1e-13  # of its scale: a margin that counts as none
SAME_TIME = 4e-16  # relative: times that are one
SAME_SHARE = 1e-14  # of a step
MOST_STEPS = 50_000
WATCHED = 1000  # steps, in three times of which the march must gain pace where it needs too many
GAIN = 1.2
BRACKETS = 8  # equal parts in which a change of regime is looked for at once
NEAR = np.concatenate([-(side := 0.1 ** np.arange(1.0, 11.0, 1.5)), [0.0], side])  # of them: points about its guess
WITHOUT_PROGRESS = 50  # changes of regime at one time


@dataclass(frozen=True)
class Points:
    """A motion at some times: each (own interfaces of a law, points)."""

    time: FloatArray  # (points,) s
    torque: FloatArray  # N m
    angle: FloatArray  # rad, whole, of the interface's own station
    speed: FloatArray
    acceleration: FloatArray

    def of(self, at: Sequence[int]) -> "Points":
        """Those of a law."""
        own = slice(at[0], at[-1] + 1)
        return Points(self.time, self.torque[own], self.angle[own], self.speed[own], self.acceleration[own])


@dataclass(frozen=True)
class Conditions:
    """What torques lack of their law, N m, and how that changes; derivatives (own, own, points), None for nothing."""

    lack: FloatArray  # (own, points)
    by_torque: FloatArray | None = None  # None: -1 of each its own
    by_angle: FloatArray | None = None
    by_speed: FloatArray | None = None
    by_acceleration: FloatArray | None = None


class Law(Protocol):
    """Torques at one or two interfaces, by time and by how these move."""

    @property
    def at(self) -> tuple[int, ...]:
        """Its interfaces, one after the other."""

    @property
    def cuts(self) -> tuple[float, ...]:
        """Times (s) at which it changes."""

    def first(self, points: Points) -> int:
        """The regime at one time."""

    def conditions(self, regime: int, points: Points) -> Conditions:
        """In that regime, also a little beyond it."""

    def limits(self, regime: int, points: Points) -> list[tuple[FloatArray, int]]:
        """Margins (points,) of order 1, negative where the regime has been left, and the regime that follows."""

    def still(self, regime: int) -> tuple[int, ...]:
        """Interfaces that do not turn in that regime: laws at these alone keep theirs."""


Known = tuple[FloatArray, FloatArray, FloatArray]  # angle, speed and acceleration, each (interfaces, times)
Given = Callable[[FloatArray], Known]


@dataclass(frozen=True)
class Scheme:
    """How finely a motion is found."""

    duration: float  # s
    tolerance: float  # of the largest torque: largest last coefficient of the Legendre series
    first: float  # s, length of the first step
    longest: float  # s
    weight: FloatArray  # (interfaces,) factor on torques that makes them comparable
    cuts: tuple[float, ...] = ()  # s, where the given motion has kinks


@dataclass(frozen=True)
class Collocated:
    """The motion that the laws make."""

    steps: Steps
    changes: tuple[tuple[float, int, int], ...]  # (s, law, regime that begins)
    lack: float  # the largest of the last coefficients, of the largest torque
    largest: float  # torque, N m times its weight


@dataclass
class _March:
    """A march under way."""

    train: Interfaces
    laws: Sequence[Law]
    given: Given
    scheme: Scheme
    influences: dict[float, Influence] = field(default_factory=dict)
    largest: float = 0.0  # torque so far, weighted
    lack: float = 0.0
    regimes: list[int] = field(default_factory=list)

    def influence(self, length: float) -> Influence:
        """Kept by length."""
        if length not in self.influences:
            if len(self.influences) > 64:
                self.influences.clear()
            self.influences[length] = influence(self.train, length)
        return self.influences[length]


@dataclass(frozen=True)
class _Trial:
    """A step that was tried."""

    torque: FloatArray  # (interfaces, nodes)
    points: Points  # at the nodes and at the end of the step
    after: Place
    last: float  # weighted coefficient
    rounding: float  # weighted torque by which rounding of the speeds may change it


def march(
    train: Interfaces, laws: Sequence[Law], given: Given, scheme: Scheme,
    progress: Callable[[float], None] = lambda share: None,
) -> Collocated:  # fmt: skip
    """The motion from nothing at time 0, beside the given one: angle, speed, acceleration (interfaces, times) at times.

    progress: called with the share of the time that is done.
    Raises SolveError where a step becomes too short, or laws change without end.
    """
    state = _March(train, laws, given, scheme)
    time, length, start, waits = 0.0, min(scheme.first, scheme.longest), Place.still(train), 0
    torque = np.zeros((train.number, POINTS))
    rows, changes = list[tuple[float, float, Place, FloatArray]](), list[tuple[float, int, int]]()
    here = _at_one_time(state, np.zeros(1), start, torque[:, -1:])
    state.regimes = [law.first(here.of(law.at)) for law in laws]
    every = {*scheme.cuts, *(cut for law in laws for cut in law.cuts)}
    cuts = sorted({cut for cut in every if 0.0 < cut < scheme.duration} | {scheme.duration})
    while time < scheme.duration:
        ahead = next(cut for cut in cuts if cut > time) - time
        tried, own = _kept(state, time, ahead if ahead <= length * (1.0 + 1e-9) else length, start, torque)
        left = _left(state, time, start, tried, own)
        if left is not None:
            share, law, regime = left
            whole, own = own, share * own
            if share > 0.0:
                tried, own = _kept(state, time, own, start, torque)
            if own == share * whole:  # else it ends before
                changes.append((time + own, law, regime))
                state.regimes[law] = regime
            waits = 0 if share > 0.0 else waits + 1
            if waits > WITHOUT_PROGRESS:
                raise SolveError(f"at {time:.6g} s the torques change their regime without end")
            if share == 0.0:
                continue
        _refuse_too_many([row[0] for row in rows[::WATCHED]], len(rows), time, scheme.duration)
        rows.append((time, own, start, tried.torque))
        state.largest = max(state.largest, float(np.abs(tried.torque * scheme.weight[:, None]).max(initial=0.0)))
        state.lack = max(state.lack, tried.last)
        time = next((cut for cut in cuts if abs(time + own - cut) <= SAME_TIME * cut), time + own)
        start, torque = tried.after, np.repeat(tried.torque[:, -1:], POINTS, axis=1)
        length = _next_length(state, tried, own, length)
        progress(time / scheme.duration)
        if time in cuts:
            here = _at_one_time(state, np.array([time]), start, torque[:, -1:])
            for number, one in enumerate(laws):
                if time in one.cuts:
                    state.regimes[number] = one.first(here.of(one.at))
    lack = state.lack / state.largest if state.largest else 0.0
    return Collocated(steps(train, rows), tuple(changes), lack, state.largest)


def _refuse_too_many(reached: list[float], number: int, time: float, duration: float) -> None:
    """Raises SolveError for steps that do not reach the end, as soon as that is seen; reached: after every WATCHED."""
    if number < MOST_STEPS and (number % WATCHED or number < 3 * WATCHED):
        return
    pace = np.diff([*reached[-3:], time])
    needed = number + WATCHED * (duration - time) / float(pace[-1])
    if number < MOST_STEPS and (needed <= MOST_STEPS or pace[-1] > GAIN * pace[0]):
        return
    message = f"{number} steps reach {time:.4g} s of {duration:.4g} s only: the torques that follow excite fast modes"
    hint = "damp these modes, give shafts fewer `segments` or `model: lumped`, keep fewer `modes`, shorten `duration`"
    raise SolveError(message, f"{hint}, or raise `tolerance`")


def _next_length(state: _March, tried: _Trial, own: float, length: float) -> float:
    """Of the next step; one that was cut short does not count unless it was hard."""
    is_easy = tried.last <= max(EASY * state.scheme.tolerance * state.largest, tried.rounding)
    if own < length / 2.0 * (1.0 - 1e-9) and not is_easy:
        length = 2.0 ** math.ceil(math.log2(own / state.scheme.longest)) * state.scheme.longest
    return min(2.0 * length, state.scheme.longest) if is_easy and own >= 0.5 * length else length


def _kept(state: _March, time: float, length: float, start: Place, guess: FloatArray) -> tuple[_Trial, float]:
    """A step that is accurate enough, of that length or of a shorter one."""
    while True:
        tried = _tried(state, time, length, start, guess)
        if tried is not None:
            scale = np.abs(tried.torque * state.scheme.weight[:, None]).max(initial=state.largest)
            if tried.last <= state.scheme.tolerance * scale:
                return tried, length
        if length < SHORTEST * state.scheme.duration:
            message = f"at {time:.6g} s no step is short enough for the torques that follow the motion"
            raise SolveError(message, "look there for a law that jumps, or raise `tolerance`")
        length /= 2.0


def _tried(state: _March, time: float, length: float, start: Place, guess: FloatArray) -> _Trial | None:
    """A step by Newton's method; None where that does not converge."""
    train, own = state.train, state.influence(length)
    times = time + length * ENDS
    known = state.given(times)
    free = [one + two for one, two in zip(going_on(train, start, own), known, strict=True)]
    size, torque, before = train.number * POINTS, guess, math.inf
    moved = (own.angle, own.speed, own.acceleration)
    flat = [one.reshape(size, size) for one in moved]
    for count in range(NEWTON):
        now = [
            one[:, :-1] + (matrix @ torque.ravel()).reshape(torque.shape)
            for one, matrix in zip(free, flat, strict=True)
        ]
        lack, slopes = _assembled(state, Points(times[:-1], torque, *now))
        jacobian = np.zeros((train.number, POINTS, train.number, POINTS))
        jacobian[:, EACH, :, EACH] = slopes[0].transpose(2, 0, 1)
        for slope, matrix in zip(slopes[1:], moved, strict=True):
            if slope.any():
                jacobian += np.einsum("egc,gcfl->ecfl", slope, matrix)
        change = _solution(jacobian.reshape(size, size), -lack.ravel(), slopes[3][..., 0] @ train.at_once)
        if change is None:
            return None
        change = change.reshape(torque.shape)
        torque = torque + change
        weight = state.scheme.weight[:, None]
        ratio = float(np.abs(change * weight).max(initial=0.0))
        ratio /= max(float(np.abs(torque * weight).max(initial=0.0)), state.largest, np.finfo(float).tiny)
        if not math.isfinite(ratio):
            return None
        quadratic = count > 0 and ratio**3 <= CONVERGED * before**2  # then the next change is below it
        if ratio <= CONVERGED or quadratic or (count > 1 and ratio < STALLED and ratio > 0.1 * before):
            break
        before = ratio
    else:
        return None
    after = own.after(train, start, torque)
    last = np.abs(SERIES[-2:] @ torque.T) * state.scheme.weight
    end = _at_one_time(state, times[-1:], after, torque[:, -1:], known)
    left = max(float(last[1].max(initial=0.0)), BEFORE_LAST * float(last[0].max(initial=0.0)))
    rounding = ROUNDED * float((np.abs(np.einsum("eec->ec", slopes[2]) * known[1][:, :-1]) * weight).max(initial=0.0))
    return _Trial(torque, _whole(times, free, own, torque, end), after, left, rounding)


def _solution(matrix: FloatArray, right: FloatArray, required: FloatArray) -> FloatArray | None:
    """Of linear equations; the least where more stations stand than can by themselves, None where there is none.

    required: (interfaces, interfaces) what torques change of accelerations that laws require.
    """
    rows = required[required.any(axis=1)]
    if len(rows) > 1 and np.linalg.matrix_rank(rows / np.abs(rows).max(axis=1)[:, None], 1e-9) < len(rows):
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-12)[0])
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return None


def _whole(times: FloatArray, free: list[FloatArray], own: Influence, torque: FloatArray, end: Points) -> Points:
    """At the nodes and at the end of a step; the torque at its last node stands for that at its end."""
    ends = np.concatenate([torque, torque[:, -1:]], axis=1)
    inside = [
        np.concatenate([one[:, :-1] + np.einsum("ecfl,fl->ec", matrix, torque), np.zeros((len(one), 1))], axis=1)
        for one, matrix in zip(free, (own.angle, own.speed, own.acceleration), strict=True)
    ]
    for part, last in zip(inside, (end.angle, end.speed, end.acceleration), strict=True):
        part[:, -1] = last[:, 0]
    return Points(times, ends, *inside)


def _at_one_time(state: _March, at: FloatArray, place: Place, torque: FloatArray, known: Known | None = None) -> Points:
    """(interfaces, 1), where the coordinates are known; known: the given motion, its last column at that time."""
    train, y = state.train, place.y[:, None]
    angle, speed, acceleration = (one[:, -1:] for one in known or state.given(at))
    return Points(
        at, torque, angle + train.rigid.T @ place.turned[:, None] + np.real(train.angle @ y),
        speed + train.rigid.T @ place.turning[:, None] + np.real(train.speed @ y), acceleration,
    )  # fmt: skip


def _assembled(state: _March, points: Points) -> tuple[FloatArray, list[FloatArray]]:
    """What all torques lack, (interfaces, points), and its derivatives (interfaces, interfaces, points)."""
    number = state.train.number
    lack, slopes = np.zeros_like(points.torque), [np.zeros((number, number, len(points.time))) for _ in range(4)]
    for law, regime in zip(state.laws, state.regimes, strict=True):
        found, own = law.conditions(regime, points.of(law.at)), slice(law.at[0], law.at[-1] + 1)
        lack[own] = found.lack
        slopes[0][law.at, law.at] = -1.0
        parts = (found.by_torque, found.by_angle, found.by_speed, found.by_acceleration)
        for slope, part in zip(slopes, parts, strict=True):
            if part is not None:
                slope[own, own] = part
    return lack, slopes


def _left(state: _March, time: float, start: Place, tried: _Trial, length: float) -> tuple[float, int, int] | None:
    """The first change of regime in a step: the share of it, the law, and the regime that follows."""
    found: tuple[float, int, int] | None = None
    own = steps(state.train, [(time, length, start, tried.torque)])
    pairs = list(zip(state.laws, state.regimes, strict=True))
    still = {at for law, regime in pairs for at in law.still(regime) if at not in law.at}
    for number, (law, regime) in enumerate(pairs):
        if still.issuperset(law.at):
            continue
        for which, (margin, follows) in enumerate(law.limits(regime, tried.points.of(law.at))):
            below = np.flatnonzero(margin < -AT_LIMIT)
            if not below.size:
                continue
            high = int(below[0])

            def rest(share: FloatArray, law: Law = law, regime: int = regime, which: int = which) -> FloatArray:
                there = _inside(state, own, time + share * length)
                return law.limits(regime, there.of(law.at))[which][0]

            share = _root(rest, 0.0 if high == 0 else float(ENDS[high - 1]), float(ENDS[high]))
            if found is None or share < found[0]:
                found = share, number, follows
    return found


def _inside(state: _March, own: Steps, time: FloatArray) -> Points:
    """At times in a step."""
    turned, turning, y = own.at(time)
    angle, speed, acceleration = state.given(time)
    train = state.train
    return Points(
        time, own.torque(time), angle + train.rigid.T @ turned + np.real(train.angle @ y),
        speed + train.rigid.T @ turning + np.real(train.speed @ y), acceleration,
    )  # fmt: skip


def _root(of: Callable[[FloatArray], FloatArray], low: float, high: float) -> float:
    """Where a function that is negative at `high` first becomes so: brackets, each looked at in many points at once.

    The points stand about the root of the line through the ends, closer and closer, and evenly. `low` where the
    function is about nothing there already.
    """
    at = np.linspace(low, high, BRACKETS + 1)
    value = of(at)
    if value[0] <= (AT_LIMIT if low == 0.0 else 0.0):
        return low
    while True:
        first = int(np.argmax(value <= 0.0)) if (value <= 0.0).any() else len(at) - 1
        low, high, above, below = float(at[first - 1]), float(at[first]), float(value[first - 1]), float(value[first])
        share = above / (above - below) if below < above else 0.5
        root = low + (high - low) * share
        if high - low <= SAME_SHARE or not low < (low + high) / 2.0 < high:
            return root if low < root < high else high
        near = root + (high - low) * NEAR
        at = np.unique(np.concatenate([np.linspace(low, high, BRACKETS + 1), near[(near > low) & (near < high)]]))
        value = of(at)
        value[[0, -1]] = above, below
