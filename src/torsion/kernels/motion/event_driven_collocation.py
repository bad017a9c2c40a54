"""A train with elements that are linear between events, under torques that follow its motion smoothly.

Within a regime of the elements the train is linear, z' = A z, and the torques at the interfaces are polynomials of a
step: inputs of A with states of their own. Collocation finds them as on any linear train; an event of an element ends
the step there, and the next begins in another regime.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.collocation import SAME_TIME, Law, Marched, Scheme, marched
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, March
from torsion.kernels.motion.generated_signals import POWERS
from torsion.kernels.motion.interface_motion import Known
from torsion.kernels.motion.linear_regime import STEPS, Regime
from torsion.kernels.motion.piecewise_train import PiecewiseTrain, State
from torsion.kernels.motion.polynomial_torques import ENDS, POINTS, SERIES

MOST_KEPT = 256  # influences
FINER = 4  # times: regimes for steps shorter than what the fastest motion needs are kept by powers of it


@dataclass(frozen=True)
class Interfaces:
    """Where torques follow the motion."""

    shape: FloatArray  # (interfaces, rigid motions + modes)
    signal: IntArray  # (interfaces,) which of the polynomials of the train each is a part of
    carrier: Callable[[FloatArray], Known]  # how they turn without any torque
    untwisted: FloatArray  # (modes,) places from which their angles count


@dataclass
class RegimesTaken:
    """The train moved on step by step: a LinearTrain of `collocation`."""

    march: March
    at: Interfaces
    z: FloatArray
    state: State
    kept: dict[tuple[State, float], tuple[Known, Known]] = field(default_factory=dict)
    parts: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.parts = np.zeros((self.number, 1))

    @property
    def train(self) -> PiecewiseTrain:
        """What is moved."""
        return self.march.train

    @property
    def number(self) -> int:
        return len(self.at.signal)

    @property
    def following(self) -> slice:
        """Where the states of the polynomials stand."""
        signal = self.train.layout[3]
        return slice(signal.start + self.train.signals.known, signal.stop)

    @cached_property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        """(interfaces, state) of angle and speed beside the carrier."""
        _, place, speed, _, turned = self.train.layout
        angle, turning = np.zeros((2, self.number, self.train.size))
        rigid = self.train.rigid
        angle[:, turned] = self.at.shape[:, :rigid]
        angle[:, place] = self.at.shape[:, rigid:] / self.train.w
        angle[:, -1] = -self.at.shape[:, rigid:] @ self.at.untwisted
        turning[:, speed] = self.at.shape
        return angle, turning

    def regime(self, length: float) -> Regime:
        """Of now, with samples that stand as near as a step is short."""
        self.march.halvings = 0
        while self.march.regime(self.state).part > FINER * length:
            self.march.halvings += FINER.bit_length() - 1
        return self.march.regime(self.state)

    @property
    def at_once(self) -> FloatArray:
        """(interfaces, interfaces) 1/(kg m2): accelerations that torques make."""
        matrix = self.march.regime(self.state).matrix
        return np.asarray(self.rows[1] @ matrix[:, self.following.start + POINTS * self.at.signal])

    def influence(self, length: float) -> Known:
        return self._of(length)[1]

    def _of(self, length: float) -> tuple[Known, Known]:
        """Rows (interfaces, ENDS, state) of how a step goes on, and what torques at its nodes add; kept by length."""
        if (self.state, length) not in self.kept:
            if len(self.kept) > MOST_KEPT:
                self.kept.clear()
            self.kept[self.state, length] = self._influence(
                self.march.regime(self.state).matrix, length
            )
        return self.kept[self.state, length]

    def _influence(self, matrix: FloatArray, length: float) -> tuple[Known, Known]:
        angle, speed = self.rows
        own, signals = matrix.copy(), self.train.signals
        own[self.following, self.following] *= (
            signals.scale / length
        )  # coefficients of powers of the share of the step
        moved, powers = expm(np.multiply.outer(length * ENDS, own)), POWERS @ SERIES
        parts = (self.number, len(ENDS), signals.polynomials, POINTS)
        turned, turning, gained = (
            np.moveaxis(one @ moved, 0, 1) for one in (angle, speed, speed @ own)
        )
        rows = turned, turning, gained
        inputs = (one[..., self.following].reshape(parts) for one in rows)
        by_angle, by_speed, by_rate = ((one @ powers)[:, :, self.at.signal] for one in inputs)
        return rows, (by_angle, by_speed, by_rate)

    def going_on(self, time: float, length: float) -> Known:
        z = self.z.copy()
        z[self.following] = 0.0
        rows, carried = self._of(length)[0], self.at.carrier(time + length * ENDS)
        own = np.abs(self.rows[1]) @ np.abs(self.z)
        self.parts = np.abs(carried[1]).max(axis=1, keepdims=True) + own[:, None]
        angle, speed, acceleration = (one @ z + two for one, two in zip(rows, carried, strict=True))
        return angle, speed, acceleration

    def now(self, time: float) -> Known:
        return self._beside(np.array([time]), self.z[:, None], self.march.regime(self.state))

    def inside(self, time: float, length: float, torque: FloatArray, share: FloatArray) -> Known:
        start, one = self._under(torque, length), self.regime(length)
        there = np.stack([_after(one, start, late) for late in (share * length).tolist()], axis=1)
        return self._beside(time + share * length, there, one)

    def _beside(self, time: FloatArray, z: FloatArray, one: Regime) -> Known:
        angle, speed = self.rows
        turned, turning, gained = self.at.carrier(time)
        return turned + angle @ z, turning + speed @ z, gained + speed @ (one.matrix @ z)

    def _under(self, torque: FloatArray, length: float) -> FloatArray:
        """The state at the begin of a step under torques (interfaces, nodes)."""
        whole = np.zeros((self.train.signals.polynomials, POINTS))
        np.add.at(whole, self.at.signal, torque)
        z = self.z.copy()
        z[self.following] = self.train.signals.polynomial(whole, length)
        return z

    def advance(self, time: float, length: float, end: float, torque: FloatArray) -> float:
        z, state, is_cut = self._under(torque, length), self.state, False
        self.regime(length)
        while time < end and not is_cut:
            time, z, state, is_cut = self.march.on(time, end, z, state)
        breaks = self.train.signals.breaks
        if time == end and (np.abs(breaks - end) <= SAME_TIME * end).any():
            z, state = self.march.rearm(end, z, state)
        self.z, self.state = z, state
        return time


def _after(one: Regime, z: FloatArray, time: float) -> FloatArray:
    """The state after any time."""
    block = STEPS * one.step
    while time > block:
        z, time = one.after(z, block), time - block
    return one.after(z, time)


def event_driven_under_laws(
    march: March,
    state: State,
    z: FloatArray,
    at: Interfaces,
    laws: Sequence[Law],
    scheme: Scheme,
    progress: Callable[[float], None] = lambda share: None,
) -> tuple[EventDrivenMotion, Marched]:
    """The motion from regimes and a state at time 0 under the torques that laws require.

    The breaks of signals have to be among the cuts of the scheme. Raises what `marched` and a March raise.
    """
    z, state = march.rearm(0.0, z, state)
    taken = RegimesTaken(march, at, z, state)
    how = marched(taken, laws, scheme, progress)
    return march.finished(taken.z, taken.state, march.duration), how
