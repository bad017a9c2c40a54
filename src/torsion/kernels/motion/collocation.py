"""Torques that follow the motion smoothly: collocation at Gauss points, the linear train between them exact.

The unknowns of a step are the torques at its interfaces at 8 Gauss points; a polynomial through them acts on the train,
and Newton's method makes them what their laws require there. A step is kept where the last coefficients of the Legendre
series of every torque are small. A law may have regimes, in each of which it is smooth; a step ends where one is left.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.bracketed_search import find_root
from torsion.kernels.motion.endless_events import refuse_too_many_steps
from torsion.kernels.motion.march import March
from torsion.kernels.motion.regimes.modal_loads import SAME_TIME, Turning
from torsion.kernels.motion.torques.polynomial_torques import ENDS, POINTS, SERIES, value

EACH = np.arange(POINTS)
AT_END = SERIES.sum(axis=0)[:, None]  # (nodes, 1): the torque there, of those at the nodes
NEWTON = 12
# Relative changes of the torques: the latter where rounding lets it fall no further.
CONVERGED, STALLED = 1e-13, 1e-11
SHORTEST = 2.0**-44  # of the whole motion: a step below it is given up
EASY = 0.004  # of what is allowed: the next step is twice as long
BEFORE_LAST = 0.1  # weight of the last coefficient but one, for where the last happens to vanish
ROUNDED = 16.0 * np.finfo(float).eps  # of a speed: what it may lack in a last coefficient
AT_LIMIT = 1e-13  # of its scale: a margin that counts as none
MOST_STEPS = 1_000_000  # of one torque; as many fewer of several: some ten minutes
WATCHED = 1000  # steps, in three times of which the march must gain pace where it needs too many
WITHOUT_PROGRESS = 50  # changes of regime at one time

Limits = list[tuple[FloatArray, int]]
Report = Callable[[float], None]  # called with the share of the time that is done


@dataclass(frozen=True)
class Points:
    """A motion at some times: each (interfaces of a law, points)."""

    time: FloatArray  # (points,) s
    torque: FloatArray  # N m
    angle: FloatArray  # rad, whole, of the interface's own station
    speed: FloatArray
    acceleration: FloatArray

    def select(self, interfaces: slice, number: int | None = None) -> "Points":
        """Some interfaces at the first `number` times, or at all."""
        rows = (self.torque, self.angle, self.speed, self.acceleration)
        return Points(self.time[:number], *(row[interfaces, :number] for row in rows))


@dataclass(frozen=True)
class Conditions:
    """What torques lack of their law, N m, and how that changes; derivatives (own, own, points), None for nothing."""

    lack: FloatArray  # (own, points)
    by_torque: FloatArray | None = None  # None: -1 of each its own
    by_angle: FloatArray | None = None
    by_speed: FloatArray | None = None
    by_acceleration: FloatArray | None = None


class Law:
    """Torques at one or two interfaces, by time and by how these move; without regimes, unless a subclass has some."""

    interface: int  # the first

    @property
    def count(self) -> int:
        """Number of its interfaces, one after the other."""
        return 1

    @property
    def interfaces(self) -> slice:
        """The rows of its own interfaces among all."""
        return slice(self.interface, self.interface + self.count)

    @property
    def cuts(self) -> tuple[float, ...]:
        """Times (s) at which it changes."""
        return ()

    def first(self, points: Points) -> int:
        """Return the regime that holds at the one time of the points."""
        return 0

    def conditions(self, regime: int, points: Points) -> Conditions:
        """What the torques lack in a regime, also a little beyond it."""
        raise NotImplementedError

    def limits(self, regime: int, points: Points) -> Limits:
        """Margins (points,) of order 1, negative where the regime has been left, and the regime that follows."""
        return []

    def still(self, regime: int) -> tuple[int, ...]:
        """Interfaces that do not turn in that regime: laws that act only there keep their own."""
        return ()


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
    # regimes at time 0, and at the times at which their laws change
    begun: tuple[tuple[float, int, int], ...]


@dataclass
class _March:
    """A march under way."""

    train: March
    laws: Sequence[Law]
    scheme: Scheme
    largest: float = 0.0  # torque so far, weighted
    lack: float = 0.0
    regimes: list[int] = field(default_factory=list)

    @property
    def weight(self) -> FloatArray:
        """Factors on torques that make them comparable, (interfaces, 1)."""
        return self.scheme.weight[:, None]

    def first_regime(self, law: Law, time: float, torque: FloatArray) -> int:
        """Regime of a law at the begin of a step, with torques (interfaces, 1)."""
        points = Points(np.array([time]), torque, *self.train.at_begin(time))
        return law.first(points.select(law.interfaces))


@dataclass(frozen=True)
class _Trial:
    """A step that was tried."""

    torque: FloatArray  # (interfaces, nodes)
    points: Points  # at the nodes and at the end of the step
    last: float  # weighted coefficient
    rounding: float  # weighted torque by which rounding of the speeds may change it


def march(
    train: March,
    laws: Sequence[Law],
    scheme: Scheme,
    progress: Report = lambda share: None,
) -> Marched:
    """Move a train from time 0 on under the torques that laws require at its interfaces.

    Raises SolveError where a step becomes too short, or laws change without end.
    """
    state = _March(train, laws, scheme)
    time, length, waits = 0.0, min(scheme.first, scheme.longest), 0
    torque = np.zeros((train.number, POINTS))
    begins, changes = list[float](), list[tuple[float, int, int]]()
    state.regimes = [state.first_regime(law, time, torque[:, -1:]) for law in laws]
    begun = [(time, number, regime) for number, regime in enumerate(state.regimes)]
    times = {*scheme.cuts, *(cut for law in laws for cut in law.cuts)}
    cuts = sorted({cut for cut in times if 0.0 < cut < scheme.duration} | {scheme.duration})
    while time < scheme.duration:
        ahead = next(cut for cut in cuts if cut > time) - time
        step = ahead if ahead <= length * (1.0 + 1e-9) else length
        trial, step = _accept_step(state, time, step, torque)
        departure = _first_departure(state, time, trial, step)
        change: tuple[int, int] | None = None
        if departure is not None:
            share, law_number, regime = departure
            shortened = share * step
            if share > 0.0:
                trial, step = _accept_step(state, time, shortened, torque)
            else:
                step = 0.0
            if step == shortened:  # else it ends before
                change = law_number, regime
            waits = 0 if share > 0.0 else waits + 1
            if waits > WITHOUT_PROGRESS:
                raise SolveError(f"at {time:.6g} s the torques change their regime without end")

        end = next((cut for cut in cuts if abs(time + step - cut) <= SAME_TIME * cut), time + step)
        if step > 0.0:
            most = MOST_STEPS // max(train.number, 1)
            reports = [*begins[::WATCHED], time]
            refuse_too_many_steps(reports, len(begins), most, WATCHED, scheme.duration)
            begins.append(time)
            reached = train.advance(time, step, end, trial.torque)
            state.largest = np.abs(trial.torque * state.weight).max(initial=state.largest)
            state.lack = max(state.lack, trial.last)
            change, step, end = change if reached == end else None, reached - time, reached
            torque = np.repeat(trial.torque[:, -1:], POINTS, axis=1)
            length = _next_length(state, trial, step, length)
        if change is not None:
            changes.append((end, *change))
            state.regimes[change[0]] = change[1]
        if step > 0.0 and end in cuts:
            for number, law in enumerate(laws):
                if end in law.cuts:
                    state.regimes[number] = state.first_regime(law, end, torque[:, -1:])
                    begun.append((end, number, state.regimes[number]))
        time = end
        progress(time / scheme.duration)
    largest = float(state.largest)
    lack = state.lack / largest if largest else 0.0
    return Marched(len(begins), tuple(changes), lack, largest, tuple(begun))


def _next_length(state: _March, trial: _Trial, step: float, length: float) -> float:
    """Length of the next step; one that was cut short does not count unless it was hard."""
    longest = state.scheme.longest
    is_easy = trial.last <= max(EASY * state.scheme.tolerance * state.largest, trial.rounding)
    if step < length / 2.0 * (1.0 - 1e-9) and not is_easy:
        length = 2.0 ** math.ceil(math.log2(step / longest)) * longest
    return min(2.0 * length, longest) if is_easy and step >= 0.5 * length else length


def _accept_step(
    state: _March, time: float, length: float, guess: FloatArray
) -> tuple[_Trial, float]:
    """A step that is accurate enough, of that length or of a shorter one."""
    while True:
        trial = _try_step(state, time, length, guess)
        if trial is not None:
            scale = np.abs(trial.torque * state.weight).max(initial=state.largest)
            if trial.last <= state.scheme.tolerance * scale:
                return trial, length
        if length < SHORTEST * state.scheme.duration:
            message = (
                f"at {time:.6g} s no step is short enough for the torques that follow the motion"
            )
            raise SolveError(message, "look there for a law that jumps, or raise `tolerance`")
        length /= 2.0


def _try_step(state: _March, time: float, length: float, guess: FloatArray) -> _Trial | None:
    """A step by Newton's method; None where that does not converge."""
    train, times = state.train, time + length * ENDS
    free, influence = train.going_on(time, length), train.influence(length)
    size, torque, before = train.number * POINTS, guess, math.inf
    for count in range(NEWTON):
        points = _points_under(times, free, influence, torque)
        lack, slopes = _assemble(state, points.select(slice(None), POINTS))
        jacobian = np.zeros((train.number, POINTS, train.number, POINTS))
        jacobian[:, EACH, :, EACH] = slopes[0].transpose(2, 0, 1)
        for slope, matrix in zip(slopes[1:], influence, strict=True):
            if slope.any():
                jacobian += np.einsum("egc,gcfl->ecfl", slope, matrix[:, :-1])
        required = slopes[3][..., 0] @ train.at_once
        change = _solve_linear(jacobian.reshape(size, size), -lack.ravel(), required)
        if change is None:
            return None
        change = change.reshape(torque.shape)
        torque = torque + change
        scale = np.abs(torque * state.weight).max(initial=state.largest)
        ratio = float(np.abs(change * state.weight).max(initial=0.0))
        ratio /= max(float(scale), np.finfo(float).tiny)
        if not math.isfinite(ratio):
            return None
        # Newton's method converges quadratically: then the next change is below the limit.
        quadratic = count > 0 and ratio**3 <= CONVERGED * before**2
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
    points = _points_under(times, free, influence, torque)
    coefficient = max(
        float(last[1].max(initial=0.0)), BEFORE_LAST * float(last[0].max(initial=0.0))
    )
    damping = np.abs(np.einsum("eec->ec", slopes[2])) * train.parts * state.weight
    rounding = ROUNDED * float(damping.max(initial=0.0))
    # Where all begins from nothing the speeds are rounding, and so are the coefficients.
    is_felt = bool((np.abs(points.speed - free[1]) > ROUNDED * train.parts).any())
    return _Trial(torque, points, coefficient if is_felt else 0.0, rounding)


def _points_under(
    times: FloatArray, free: Turning, influence: FloatArray, torque: FloatArray
) -> Points:
    """At the ENDS of a step, from how it goes on without torques and what torques (interfaces, nodes) add."""
    angle, speed, acceleration = (
        row + (matrix.reshape(-1, torque.size) @ torque.ravel()).reshape(row.shape)
        for row, matrix in zip(free, influence, strict=True)
    )
    torques = np.concatenate([torque, torque @ AT_END], axis=1)
    return Points(times, torques, angle, speed, acceleration)


def _solve_linear(matrix: FloatArray, right: FloatArray, required: FloatArray) -> FloatArray | None:
    """Solve equations; the least where more stations stand than can by themselves, None where there is none.

    required: (interfaces, interfaces) what torques change of accelerations that laws require.
    """
    if not np.isfinite(matrix).all():
        return None
    rows = required[required.any(axis=1)]
    scaled = rows / np.abs(rows).max(axis=1, initial=0.0)[:, None]
    if len(rows) > 1 and np.linalg.matrix_rank(scaled, 1e-9) < len(rows):
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-12)[0])
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return None


def _assemble(state: _March, points: Points) -> tuple[FloatArray, list[FloatArray]]:
    """What all torques lack, (interfaces, points), and its derivatives (interfaces, interfaces, points)."""
    lack = np.zeros_like(points.torque)
    number, count = lack.shape
    slopes = [np.zeros((number, number, count)) for _ in range(4)]
    for law, regime in zip(state.laws, state.regimes, strict=True):
        rows = law.interfaces
        lacking = law.conditions(regime, points.select(rows))
        lack[rows] = lacking.lack
        slopes[0][rows, rows] = -np.eye(law.count)[:, :, None]
        derivatives = (
            lacking.by_torque,
            lacking.by_angle,
            lacking.by_speed,
            lacking.by_acceleration,
        )
        for slope, derivative in zip(slopes, derivatives, strict=True):
            if derivative is not None:
                slope[rows, rows] = derivative
    return lack, slopes


def _first_departure(
    state: _March, time: float, trial: _Trial, length: float
) -> tuple[float, int, int] | None:
    """The first change of regime in a step: the share of it, the law, and the regime that follows."""
    departure: tuple[float, int, int] | None = None
    points: Points | None = None

    def points_inside(share: FloatArray) -> Points:
        torque = value((SERIES @ trial.torque.T)[:, :, None], share)
        turning = state.train.inside(time, length, trial.torque, share)
        return Points(time + share * length, torque, *turning)

    def margin(number: int, which: int, points: Points) -> FloatArray:
        law = state.laws[number]
        return law.limits(state.regimes[number], points.select(law.interfaces))[which][0]

    crossings = sorted(_crossings(state, trial), key=lambda crossing: crossing[:2])
    for low, high, number, which, follows in crossings:
        if points is not None and margin(number, which, points)[0] > 0.0:
            continue  # it is left later

        def margin_inside(share: float, number: int = number, which: int = which) -> float:
            return float(margin(number, which, points_inside(np.array([share])))[0])

        is_left = margin_inside(low) <= (0.0 if low else AT_LIMIT)
        share = low if is_left else float(find_root(margin_inside, low, high))
        if departure is None or share < departure[0]:
            departure, points = (share, number, follows), points_inside(np.array([share]))
    return departure


def _crossings(state: _March, trial: _Trial) -> Iterator[tuple[float, float, int, int, int]]:
    """Shares of a step between which a law leaves its regime, the law, which of its limits, and the regime beyond."""
    pairs = list(zip(state.laws, state.regimes, strict=True))
    still = {interface for law, regime in pairs for interface in law.still(regime)}
    for number, (law, regime) in enumerate(pairs):
        if still.issuperset(range(law.interfaces.start, law.interfaces.stop)):
            continue
        points = trial.points.select(law.interfaces)
        for which, (margin, follows) in enumerate(law.limits(regime, points)):
            below = np.flatnonzero(margin < -AT_LIMIT)
            if below.size:
                high = int(below[0])
                low = 0.0 if high == 0 else float(ENDS[high - 1])
                yield low, float(ENDS[high]), number, which, follows
