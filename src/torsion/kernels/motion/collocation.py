"""Torques that follow the motion smoothly: collocation at Gauss points, the linear train between them exact.

The unknowns of a step are the torques at its interfaces at 8 Gauss points; a polynomial through them acts on the train,
and Newton's method makes them what their laws require there. A step is kept where the last coefficients of the Legendre
series of every torque are small. A law may have regimes, in each of which it is smooth; a step ends where one is left.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.motion.bracketed_root import bracketed_root
from torsion.kernels.motion.endless_events import refuse_too_many_steps
from torsion.kernels.motion.interface_motion import Interfaces, Known, Steps, StepsTaken
from torsion.kernels.motion.polynomial_torques import ENDS, POINTS, SERIES, value

EACH = np.arange(POINTS)
AT_END = SERIES.sum(axis=0)[:, None]  # (nodes, 1): the torque there, of those at the nodes
NEWTON = 12
CONVERGED, STALLED = (
    1e-13,
    1e-11,
)  # relative change of the torques; the latter where rounding lets it fall no further
SHORTEST = 2.0**-44  # of the whole motion: a step below it is given up
EASY = 0.004  # of what is allowed: the next step is twice as long
BEFORE_LAST = 0.1  # weight of the last coefficient but one, for where the last happens to vanish
ROUNDED = 16.0 * np.finfo(float).eps  # of a speed: what it may lack in a last coefficient
AT_LIMIT = 1e-13  # of its scale: a margin that counts as none
SAME_TIME = 4e-16  # relative: times that are one
MOST_STEPS = 1_000_000  # of one torque; as many fewer of several: some ten minutes
WATCHED = 1000  # steps, in three times of which the march must gain pace where it needs too many
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
        return Points(
            self.time, self.torque[own], self.angle[own], self.speed[own], self.acceleration[own]
        )

    def first(self, number: int) -> "Points":
        """The first times."""
        parts = (self.torque, self.angle, self.speed, self.acceleration)
        return Points(self.time[:number], *(one[:, :number] for one in parts))


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


class LinearTrain(Protocol):
    """What answers polynomial torques at its interfaces linearly, at the time and place that it has reached.

    A motion is the angle, speed and acceleration of the interfaces' own stations, each (interfaces, times), whole.
    """

    @property
    def number(self) -> int:
        """Of interfaces."""

    @property
    def parts(self) -> FloatArray:
        """(interfaces, 1) rad/s, size of the speeds whose sum a speed of the present step is."""

    @property
    def at_once(self) -> FloatArray:
        """(interfaces, interfaces) 1/(kg m2): accelerations that torques make."""

    def influence(self, length: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What torques of 1 at the nodes of a step (s) add, each (interfaces, ENDS, interfaces, nodes)."""

    def going_on(self, time: float, length: float) -> Known:
        """At the ENDS of a step, with no torques in it."""

    def now(self, time: float) -> Known:
        """At its begin."""

    def inside(self, time: float, length: float, torque: FloatArray, share: FloatArray) -> Known:
        """At shares of a step under torques (interfaces, nodes)."""

    def advance(self, time: float, length: float, end: float, torque: FloatArray) -> float:
        """Go on to the end of such a step, or as far as the train stays the same: to a time (s)."""


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
class Marched:
    """How a march went."""

    number: int  # of steps
    changes: tuple[tuple[float, int, int], ...]  # (s, law, regime that begins)
    lack: float  # the largest of the last coefficients, of the largest torque
    largest: float  # torque, N m times its weight
    begun: tuple[
        tuple[float, int, int], ...
    ]  # regimes at time 0, and at the times at which their laws change


@dataclass(frozen=True)
class Collocated(Marched):
    """The motion that the laws make."""

    steps: Steps


@dataclass
class _March:
    """A march under way."""

    train: LinearTrain
    laws: Sequence[Law]
    scheme: Scheme
    largest: float = 0.0  # torque so far, weighted
    lack: float = 0.0
    regimes: list[int] = field(default_factory=list)

    def at_one_time(self, time: float, torque: FloatArray) -> Points:
        """(interfaces, 1) at the begin of a step, with torques (interfaces, 1)."""
        return Points(np.array([time]), torque, *self.train.now(time))


@dataclass(frozen=True)
class _Trial:
    """A step that was tried."""

    torque: FloatArray  # (interfaces, nodes)
    points: Points  # at the nodes and at the end of the step
    last: float  # weighted coefficient
    rounding: float  # weighted torque by which rounding of the speeds may change it


def march(
    train: Interfaces,
    laws: Sequence[Law],
    given: Callable[[FloatArray], Known],
    scheme: Scheme,
    progress: Callable[[float], None] = lambda share: None,
) -> Collocated:
    """The motion from nothing at time 0, beside the given one: angle, speed, acceleration (interfaces, times) at times.

    progress: called with the share of the time that is done.
    Raises SolveError where a step becomes too short, or laws change without end.
    """
    taken = StepsTaken(train, given)
    how = marched(taken, laws, scheme, progress)
    return Collocated(how.number, how.changes, how.lack, how.largest, how.begun, taken.whole)


def marched(
    train: LinearTrain,
    laws: Sequence[Law],
    scheme: Scheme,
    progress: Callable[[float], None] = lambda share: None,
) -> Marched:
    """A train moved from time 0 on under the torques that laws require at its interfaces; as `march`."""
    state = _March(train, laws, scheme)
    time, length, waits = 0.0, min(scheme.first, scheme.longest), 0
    torque = np.zeros((train.number, POINTS))
    begins, changes = list[float](), list[tuple[float, int, int]]()
    here = state.at_one_time(time, torque[:, -1:])
    state.regimes = [law.first(here.of(law.at)) for law in laws]
    begun = [(time, number, regime) for number, regime in enumerate(state.regimes)]
    every = {*scheme.cuts, *(cut for law in laws for cut in law.cuts)}
    cuts = sorted({cut for cut in every if 0.0 < cut < scheme.duration} | {scheme.duration})
    while time < scheme.duration:
        ahead = next(cut for cut in cuts if cut > time) - time
        tried, own = _kept(state, time, ahead if ahead <= length * (1.0 + 1e-9) else length, torque)
        left = _left(state, time, tried, own)
        change: tuple[int, int] | None = None
        if left is not None:
            share, law, regime = left
            whole, own = own, share * own
            if share > 0.0:
                tried, own = _kept(state, time, own, torque)
            if own == share * whole:  # else it ends before
                change = law, regime
            waits = 0 if share > 0.0 else waits + 1
            if waits > WITHOUT_PROGRESS:
                raise SolveError(f"at {time:.6g} s the torques change their regime without end")
        end = next((cut for cut in cuts if abs(time + own - cut) <= SAME_TIME * cut), time + own)
        if own > 0.0:
            most = MOST_STEPS // max(train.number, 1)
            refuse_too_many_steps(
                [*begins[::WATCHED], time], len(begins), most, WATCHED, scheme.duration
            )
            begins.append(time)
            reached = train.advance(time, own, end, tried.torque)
            state.largest = max(
                state.largest, float(np.abs(tried.torque * scheme.weight[:, None]).max(initial=0.0))
            )
            state.lack = max(state.lack, tried.last)
            change, own, end = change if reached == end else None, reached - time, reached
            torque = np.repeat(tried.torque[:, -1:], POINTS, axis=1)
            length = _next_length(state, tried, own, length)
        if change is not None:
            changes.append((end, *change))
            state.regimes[change[0]] = change[1]
        if own > 0.0 and end in cuts:
            here = state.at_one_time(end, torque[:, -1:])
            for number, one in enumerate(laws):
                if end in one.cuts:
                    state.regimes[number] = one.first(here.of(one.at))
                    begun.append((end, number, state.regimes[number]))
        time = end
        progress(time / scheme.duration)
    lack = state.lack / state.largest if state.largest else 0.0
    return Marched(len(begins), tuple(changes), lack, state.largest, tuple(begun))


def _next_length(state: _March, tried: _Trial, own: float, length: float) -> float:
    """Of the next step; one that was cut short does not count unless it was hard."""
    if not own:
        return length
    is_easy = tried.last <= max(EASY * state.scheme.tolerance * state.largest, tried.rounding)
    if own < length / 2.0 * (1.0 - 1e-9) and not is_easy:
        length = 2.0 ** math.ceil(math.log2(own / state.scheme.longest)) * state.scheme.longest
    return min(2.0 * length, state.scheme.longest) if is_easy and own >= 0.5 * length else length


def _kept(state: _March, time: float, length: float, guess: FloatArray) -> tuple[_Trial, float]:
    """A step that is accurate enough, of that length or of a shorter one."""
    while True:
        tried = _tried(state, time, length, guess)
        if tried is not None:
            scale = np.abs(tried.torque * state.scheme.weight[:, None]).max(initial=state.largest)
            if tried.last <= state.scheme.tolerance * scale:
                return tried, length
        if length < SHORTEST * state.scheme.duration:
            message = (
                f"at {time:.6g} s no step is short enough for the torques that follow the motion"
            )
            raise SolveError(message, "look there for a law that jumps, or raise `tolerance`")
        length /= 2.0


def _tried(state: _March, time: float, length: float, guess: FloatArray) -> _Trial | None:
    """A step by Newton's method; None where that does not converge."""
    train, times = state.train, time + length * ENDS
    free, moved, at_once = train.going_on(time, length), train.influence(length), train.at_once
    size, torque, before = train.number * POINTS, guess, math.inf
    for count in range(NEWTON):
        points = _under(times, free, moved, torque)
        lack, slopes = _assembled(state, points.first(POINTS))
        jacobian = np.zeros((train.number, POINTS, train.number, POINTS))
        jacobian[:, EACH, :, EACH] = slopes[0].transpose(2, 0, 1)
        for slope, matrix in zip(slopes[1:], moved, strict=True):
            if slope.any():
                jacobian += np.einsum("egc,gcfl->ecfl", slope, matrix[:, :-1])
        change = _solution(jacobian.reshape(size, size), -lack.ravel(), slopes[3][..., 0] @ at_once)
        if change is None:
            return None
        change = change.reshape(torque.shape)
        torque = torque + change
        weight = state.scheme.weight[:, None]
        ratio = float(np.abs(change * weight).max(initial=0.0))
        ratio /= max(
            float(np.abs(torque * weight).max(initial=0.0)), state.largest, np.finfo(float).tiny
        )
        if not math.isfinite(ratio):
            return None
        quadratic = (
            count > 0 and ratio**3 <= CONVERGED * before**2
        )  # then the next change is below it
        if (
            ratio <= CONVERGED
            or quadratic
            or (count > 1 and ratio < STALLED and ratio > 0.1 * before)
        ):
            break
        before = ratio
    else:
        return None
    last = np.abs(SERIES[-2:] @ torque.T) * state.scheme.weight
    points = _under(times, free, moved, torque)
    left = max(float(last[1].max(initial=0.0)), BEFORE_LAST * float(last[0].max(initial=0.0)))
    rounding = ROUNDED * float(
        (np.abs(np.einsum("eec->ec", slopes[2])) * train.parts * weight).max(initial=0.0)
    )
    is_felt = bool(
        (np.abs(points.speed - free[1]) > ROUNDED * train.parts).any()
    )  # not so where all begins from nothing
    return _Trial(torque, points, left if is_felt else 0.0, rounding)


def _under(times: FloatArray, free: Known, moved: Known, torque: FloatArray) -> Points:
    """At the ENDS of a step, from how it goes on without torques and what torques (interfaces, nodes) add."""
    size = torque.size
    angle, speed, acceleration = (
        one + (matrix.reshape(-1, size) @ torque.ravel()).reshape(one.shape)
        for one, matrix in zip(free, moved, strict=True)
    )
    return Points(
        times, np.concatenate([torque, torque @ AT_END], axis=1), angle, speed, acceleration
    )


def _solution(matrix: FloatArray, right: FloatArray, required: FloatArray) -> FloatArray | None:
    """Of linear equations; the least where more stations stand than can by themselves, None where there is none.

    required: (interfaces, interfaces) what torques change of accelerations that laws require.
    """
    rows = required[required.any(axis=1)]
    if len(rows) > 1 and np.linalg.matrix_rank(
        rows / np.abs(rows).max(axis=1)[:, None], 1e-9
    ) < len(rows):
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-12)[0])
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return None


def _assembled(state: _March, points: Points) -> tuple[FloatArray, list[FloatArray]]:
    """What all torques lack, (interfaces, points), and its derivatives (interfaces, interfaces, points)."""
    number = state.train.number
    lack, slopes = (
        np.zeros_like(points.torque),
        [np.zeros((number, number, len(points.time))) for _ in range(4)],
    )
    for law, regime in zip(state.laws, state.regimes, strict=True):
        found, own = law.conditions(regime, points.of(law.at)), slice(law.at[0], law.at[-1] + 1)
        lack[own] = found.lack
        slopes[0][law.at, law.at] = -1.0
        parts = (found.by_torque, found.by_angle, found.by_speed, found.by_acceleration)
        for slope, part in zip(slopes, parts, strict=True):
            if part is not None:
                slope[own, own] = part
    return lack, slopes


def _left(
    state: _March, time: float, tried: _Trial, length: float
) -> tuple[float, int, int] | None:
    """The first change of regime in a step: the share of it, the law, and the regime that follows."""
    found: tuple[float, int, int] | None = None
    at_found: Points | None = None
    for low, high, number, which, follows in sorted(
        _crossings(state, tried), key=lambda crossing: crossing[:2]
    ):
        law, regime = state.laws[number], state.regimes[number]
        if at_found is not None and law.limits(regime, at_found.of(law.at))[which][0][0] > 0.0:
            continue  # it is left later

        def rest(
            share: FloatArray, law: Law = law, regime: int = regime, which: int = which
        ) -> FloatArray:
            there = _inside(state, time, length, tried.torque, share)
            return law.limits(regime, there.of(law.at))[which][0]

        share = bracketed_root(rest, low, high, nothing=0.0 if low else AT_LIMIT)
        if found is None or share < found[0]:
            found = share, number, follows
            at_found = _inside(state, time, length, tried.torque, np.array([share]))
    return found


def _crossings(state: _March, tried: _Trial) -> Iterator[tuple[float, float, int, int, int]]:
    """Shares of a step between which a law leaves its regime, the law, which of its limits, and the regime beyond."""
    pairs = list(zip(state.laws, state.regimes, strict=True))
    still = {at for law, regime in pairs for at in law.still(regime) if at not in law.at}
    for number, (law, regime) in enumerate(pairs):
        if still.issuperset(law.at):
            continue
        for which, (margin, follows) in enumerate(law.limits(regime, tried.points.of(law.at))):
            below = np.flatnonzero(margin < -AT_LIMIT)
            if below.size:
                high = int(below[0])
                yield (
                    0.0 if high == 0 else float(ENDS[high - 1]),
                    float(ENDS[high]),
                    number,
                    which,
                    follows,
                )


def _inside(
    state: _March, time: float, length: float, torque: FloatArray, share: FloatArray
) -> Points:
    """At shares of a step."""
    there = state.train.inside(time, length, torque, share)
    return Points(time + share * length, value((SERIES @ torque.T)[:, :, None], share), *there)
