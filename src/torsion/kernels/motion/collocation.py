"""Torques that follow the motion smoothly: collocation at Gauss points, the linear train between them exact.

The unknowns of a step are the torques at its interfaces at 8 Gauss points; a polynomial through them acts on the train,
and Newton's method makes them what their laws require there. A step is kept where the last coefficients of the Legendre
series of every torque are small. A law may have regimes, in each of which it is smooth; a step ends where one is left.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.motion.first_root import first_root
from torsion.kernels.motion.loaded_modes import (
    ENDS,
    POINTS,
    POWERS,
    SAME_TIME,
    SERIES,
    polynomial_value,
)
from torsion.kernels.motion.march import GAIN, March

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
TINY = float(np.finfo(float).tiny)
BOUNDS = np.append(0.0, ENDS)  # of the parts of a step in which limits of regimes are looked for

Limits = list[tuple[FloatArray, int]]
Report = Callable[[float], None]  # called with the share of the time that is done


class Points(NamedTuple):
    """A motion at some times: each (interfaces of a law, points)."""

    time: FloatArray  # (points,) s
    torque: FloatArray  # N m
    angle: FloatArray  # rad, whole, of the interface's own station
    speed: FloatArray
    acceleration: FloatArray


class Conditions(NamedTuple):
    """What torques lack of their law, N m, and how that changes; derivatives (own, own, points), None for nothing."""

    lack: FloatArray  # (own, points)
    by_torque: FloatArray | None = None  # None: -1 of each its own
    by_angle: FloatArray | None = None
    by_speed: FloatArray | None = None
    by_acceleration: FloatArray | None = None


class Law:
    """Torques at one or two interfaces, by time and by how these move; without regimes, unless a subclass has some."""

    interface: int  # the first
    count: int = 1  # of its interfaces, one after the other
    cuts: tuple[float, ...] = ()  # times (s) at which it changes

    @property
    def interfaces(self) -> slice:
        """The rows of its own interfaces among all."""
        return slice(self.interface, self.interface + self.count)

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


class _Trial(NamedTuple):
    """A step that was tried."""

    torque: FloatArray  # (interfaces, nodes)
    motion: FloatArray  # (torque and turning, interfaces, ENDS)
    last: float  # weighted coefficient
    rounding: float  # weighted torque by which rounding of the speeds may change it


def march(
    train: March, laws: Sequence[Law], scheme: Scheme, progress: Report = lambda share: None
) -> Marched:
    """Move a train from time 0 on under the torques that laws require at its interfaces.

    Raises SolveError where a step becomes too short, or laws change without end.
    """
    state = _Collocation(train, laws, scheme)
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
        trial, step = state.accept_step(time, step, torque)
        departure, change = state.first_departure(time, trial, step), None
        if departure is not None:
            share, law_number, regime = departure
            shortened = share * step
            if share > 0.0:
                trial, step = state.accept_step(time, shortened, torque)
            else:
                step = 0.0
            if step == shortened:  # else it ends before
                change = law_number, regime
            waits = 0 if share > 0.0 else waits + 1
            if waits > WITHOUT_PROGRESS:
                raise SolveError(f"at {time:.6g} s the torques change their regime without end")

        end = next((cut for cut in cuts if abs(time + step - cut) <= SAME_TIME * cut), time + step)
        if step > 0.0:
            state.refuse_too_many_steps([*begins[::WATCHED], time], len(begins))
            begins.append(time)
            train.start = train.under(trial.torque, step)
            reached = train.on(time, end)  # the end, or as far as the train stays the same
            state.largest = state.scale(trial.torque)
            state.lack = max(state.lack, trial.last)
            change, step, end = change if reached == end else None, reached - time, reached
            torque = np.repeat(trial.torque[:, -1:], POINTS, axis=1)
            length = state.next_length(trial, step, length)
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
    lack = state.lack / state.largest if state.largest else 0.0
    return Marched(len(begins), tuple(changes), lack, state.largest, tuple(begun))


@dataclass
class _Collocation:
    """A march under way."""

    train: March
    laws: Sequence[Law]
    scheme: Scheme
    largest: float = 0.0  # torque so far, weighted
    lack: float = 0.0
    regimes: list[int] = field(default_factory=list)

    def scale(self, torque: FloatArray) -> float:
        """The largest weighted torque so far, or of torques (interfaces, points)."""
        weight = self.scheme.weight[:, None]
        return float(np.abs(torque * weight).max(initial=self.largest))

    def first_regime(self, law: Law, time: float, torque: FloatArray) -> int:
        """Regime of a law at the begin of a step, with torques (interfaces, 1)."""
        turning = self.train.at(time, self.train.start, np.zeros(1))
        return law.first(_points(law, np.array([time]), np.stack([torque, *turning])))

    def next_length(self, trial: _Trial, step: float, length: float) -> float:
        """Length of the next step; one that was cut short does not count unless it was hard."""
        longest, easy = self.scheme.longest, EASY * self.scheme.tolerance * self.largest
        is_easy = trial.last <= max(easy, trial.rounding)
        if step < length / 2.0 * (1.0 - 1e-9) and not is_easy:
            length = 2.0 ** math.ceil(math.log2(max(step, SHORTEST * longest) / longest)) * longest
        return min(2.0 * length, longest) if is_easy and step >= 0.5 * length else length

    def refuse_too_many_steps(self, reached: list[float], number: int) -> None:
        """Raises SolveError for steps that do not reach the end, as soon as that is seen.

        reached: s, after every WATCHED steps, and now.
        """
        most, duration = MOST_STEPS // max(self.train.number, 1), self.scheme.duration
        if number < most and (number % WATCHED or number < 3 * WATCHED):
            return
        time, pace = reached[-1], np.diff(reached[-4:])
        needed = number + WATCHED * (duration - time) / float(pace[-1])
        if number < most and (needed <= most or pace[-1] > GAIN * pace[0]):
            return
        message = (
            f"{number} steps reach only {time:.4g} s of {duration:.4g} s; {most} steps (about ten minutes) are the "
            "limit. The torques that follow the motion, or modes that they excite, are too fast"
        )
        hint = (
            "shorten `duration`, leave torques out with `torques`, or damp fast modes (also fewer `segments` of "
            "shafts, `model: lumped`, fewer `modes`)"
        )
        raise SolveError(message, hint)

    def accept_step(self, time: float, length: float, guess: FloatArray) -> tuple[_Trial, float]:
        """A step that is accurate enough, of that length or of a shorter one."""
        while True:
            trial = self.try_step(time, length, guess)
            if trial and trial.last <= self.scheme.tolerance * self.scale(trial.torque):
                return trial, length
            if length < SHORTEST * self.scheme.duration:
                message = f"at {time:.6g} s no step is short enough for the torques that follow the motion"
                hint = "look there for a law that jumps, or raise `tolerance`"
                raise SolveError(message, hint)
            length /= 2.0

    def try_step(self, time: float, length: float, guess: FloatArray) -> _Trial | None:
        """A step by Newton's method; None where that does not converge."""
        train, times, weight = self.train, time + length * ENDS, self.scheme.weight
        going_on, influence = train.going_on(time, length), train.influence(length)
        free = np.concatenate([np.zeros((1, *going_on.shape[1:])), going_on])
        flat, at_nodes = influence.reshape(free.size, guess.size), influence[:, :, :-1]
        torque, before = guess, math.inf
        motion = free + (flat @ torque.ravel()).reshape(free.shape)
        for count in range(NEWTON):
            lack, slopes = self._assemble(times[:-1], motion[:, :, :-1])
            jacobian = np.einsum("kegc,kgcl->ecl", slopes, at_nodes).reshape(guess.size, guess.size)
            required = slopes[3, ..., 0]
            change = _solve_linear(jacobian, -lack.ravel(), required, train)
            if change is None:
                return None
            change = change.reshape(torque.shape)
            torque = torque + change
            motion = free + (flat @ torque.ravel()).reshape(free.shape)
            ratio = float(np.abs(change * weight[:, None]).max(initial=0.0))
            ratio /= max(self.scale(torque), TINY)
            if not math.isfinite(ratio):
                return None
            # Newton's method converges quadratically: then the next change is below the limit.
            quadratic = count > 0 and ratio**3 <= CONVERGED * before**2
            has_stalled = count > 1 and ratio < STALLED and ratio > 0.1 * before
            if ratio <= CONVERGED or quadratic or has_stalled:
                break
            before = ratio
        else:
            return None

        last = (np.abs(SERIES[-2:] @ torque.T) * weight).max(axis=1, initial=0.0)
        coefficient = max(float(last[1]), BEFORE_LAST * float(last[0]))
        damping = np.abs(np.einsum("eec->ec", slopes[2])) * train.parts * weight[:, None]
        # Where all begins from nothing the speeds are rounding, and so are the coefficients.
        is_felt = bool((np.abs(motion[2] - free[2]) > ROUNDED * train.parts).any())
        rounding = ROUNDED * float(damping.max(initial=0.0))
        return _Trial(torque, motion, coefficient if is_felt else 0.0, rounding)

    def _assemble(self, times: FloatArray, motion: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What all torques lack, (interfaces, points), and its derivatives (4, interfaces, interfaces, points).

        motion: (torque and turning, interfaces, points).
        """
        number, count = motion.shape[1:]
        lack, slopes = np.zeros((number, count)), np.zeros((4, number, number, count))
        slopes[0, range(number), range(number)] = -1.0
        for law, regime in zip(self.laws, self.regimes, strict=True):
            rows = law.interfaces
            lack[rows], *derivatives = law.conditions(regime, _points(law, times, motion))
            for slope, derivative in zip(slopes, derivatives, strict=True):
                if derivative is not None:
                    slope[rows, rows] = derivative
        return lack, slopes

    def first_departure(
        self, time: float, trial: _Trial, length: float
    ) -> tuple[float, int, int] | None:
        """The first change of regime in a step: the share of it, the law, and the regime that follows."""
        crossings = list(self._crossings(time, trial, length))
        if not crossings:
            return None
        start, part = self.train.under(trial.torque, length), min(crossings)[0]
        crossings = [crossing for crossing in crossings if crossing[0] == part]
        low, high = BOUNDS[part : part + 2].tolist()
        while True:
            # Shorter parts, until polynomials through their nodes are the margins themselves.
            shares = low + (high - low) * BOUNDS
            turning = self.train.at(time, start, shares * length)
            motion = np.stack([polynomial_value(start.polynomial, shares * length), *turning])
            margins = np.empty((len(crossings), len(shares)))
            for row, (_, number, which, _) in enumerate(crossings):
                law, regime = self.laws[number], self.regimes[number]
                points = _points(law, time + shares * length, motion)
                margins[row] = law.limits(regime, points)[which][0]
            series = SERIES @ margins[:, 1:-1].T
            if np.abs(series[-1]).max() <= AT_LIMIT or high - low <= SHORTEST:
                break
            part = int(np.append((margins[:, 1:-1] <= 0.0).any(axis=0), True).argmax())
            low, high = shares[part : part + 2].tolist()

        barely = 0.0 if low else AT_LIMIT
        passed = [
            0.0 if margin[0] <= barely else first_root(polynomial, 0.0)
            for margin, polynomial in zip(margins, (POWERS @ series).T.tolist(), strict=True)
        ]
        # A margin that is negative at the end of the part by rounding alone is passed there.
        return min(
            (low + (high - low) * (1.0 if share is None else share), number, follows)
            for share, (_, number, _, follows) in zip(passed, crossings, strict=True)
        )

    def _crossings(
        self, time: float, trial: _Trial, length: float
    ) -> Iterator[tuple[int, int, int, int]]:
        """Parts of a step between two of the BOUNDS in which a law passes a limit, the law, which limit, and what follows."""
        pairs, times = list(zip(self.laws, self.regimes, strict=True)), time + length * ENDS
        still = {interface for law, regime in pairs for interface in law.still(regime)}
        for number, (law, regime) in enumerate(pairs):
            if still.issuperset(range(law.interfaces.start, law.interfaces.stop)):
                continue
            limits = law.limits(regime, _points(law, times, trial.motion))
            for which, (margin, follows) in enumerate(limits):
                below = np.flatnonzero(margin < -AT_LIMIT)
                if below.size:
                    yield int(below[0]), number, which, follows


def _points(law: Law, times: FloatArray, motion: FloatArray) -> Points:
    """What a law sees of a motion (torque and turning, interfaces, points)."""
    return Points(times, *motion[:, law.interfaces])


def _solve_linear(
    matrix: FloatArray, right: FloatArray, required: FloatArray, train: March
) -> FloatArray | None:
    """Solve equations; the least where more stations stand than can by themselves, None where there is none.

    required: (interfaces, interfaces) by accelerations that laws require.
    """
    try:
        if np.count_nonzero(required.any(axis=1)) > 1:
            # Accelerations that torques make, and what they change of those required.
            force = train.regime.force[:, train.train.following]
            rows = required @ train.train.shape @ train.regime.speeds(force)
            rows = rows[rows.any(axis=1)]
            scaled = rows / np.abs(rows).max(axis=1, initial=0.0)[:, None]
            if np.linalg.matrix_rank(scaled, 1e-9) < len(rows):
                return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-12)[0])
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return None
