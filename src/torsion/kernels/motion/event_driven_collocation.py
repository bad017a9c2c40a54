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
from torsion.kernels.motion.collocation import (
    SAME_TIME,
    Law,
    Marched,
    Report,
    Scheme,
    Turning,
    march,
)
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, March
from torsion.kernels.motion.generated_signals import POWERS
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
    carrier: Callable[[FloatArray], Turning]  # how they turn without any torque
    untwisted: FloatArray  # (modes,) positions from which their angles count


@dataclass
class RegimesTaken:
    """The train moved on step by step: a LinearTrain of `collocation`."""

    march: March
    interfaces: Interfaces
    z: FloatArray
    state: State
    kept: dict[tuple[State, float], tuple[Turning, Turning]] = field(default_factory=dict)
    parts: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.parts = np.zeros((self.number, 1))

    @property
    def train(self) -> PiecewiseTrain:
        """The train that the march moves."""
        return self.march.train

    @property
    def number(self) -> int:
        return len(self.interfaces.signal)

    @property
    def following(self) -> slice:
        """Where the states of the polynomials stand."""
        signal = self.train.layout[3]
        return slice(signal.start + self.train.signals.pieces_size, signal.stop)

    @cached_property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        """(interfaces, state) of angle and speed beside the carrier."""
        _, position, speed, _, turned = self.train.layout
        angle, turning = np.zeros((2, self.number, self.train.size))
        shape, rigid = self.interfaces.shape, self.train.rigid
        angle[:, turned] = shape[:, :rigid]
        angle[:, position] = shape[:, rigid:] / self.train.w
        angle[:, -1] = -shape[:, rigid:] @ self.interfaces.untwisted
        turning[:, speed] = shape
        return angle, turning

    def regime(self, length: float) -> Regime:
        """The present regime, with samples that stand as near as a step is short."""
        self.march.halvings = 0
        while self.march.regime(self.state).part > FINER * length:
            self.march.halvings += FINER.bit_length() - 1
        return self.march.regime(self.state)

    @property
    def at_once(self) -> FloatArray:
        """(interfaces, interfaces) 1/(kg m2): accelerations that torques make."""
        levels = self.following.start + POINTS * self.interfaces.signal
        return np.asarray(self.rows[1] @ self.march.regime(self.state).matrix[:, levels])

    def influence(self, length: float) -> Turning:
        return self._influence(length)[1]

    def _influence(self, length: float) -> tuple[Turning, Turning]:
        """Rows (interfaces, ENDS, state) of how a step goes on, and what torques at its nodes add; kept by length."""
        key = (self.state, length)
        if key not in self.kept:
            if len(self.kept) > MOST_KEPT:
                self.kept.clear()
            self.kept[key] = self._find_influence(length)
        return self.kept[key]

    def _find_influence(self, length: float) -> tuple[Turning, Turning]:
        (angle, speed), signals = self.rows, self.train.signals
        matrix = self.march.regime(self.state).matrix.copy()
        # Coefficients of powers of the share of the step.
        matrix[self.following, self.following] *= signals.scale / length
        decay, powers = expm(np.multiply.outer(length * ENDS, matrix)), POWERS @ SERIES
        turned, turning, gained = (
            np.moveaxis(row @ decay, 0, 1) for row in (angle, speed, speed @ matrix)
        )
        parts = (self.number, len(ENDS), signals.polynomials, POINTS)
        by_angle, by_speed, by_rate = (
            (row[..., self.following].reshape(parts) @ powers)[:, :, self.interfaces.signal]
            for row in (turned, turning, gained)
        )
        return (turned, turning, gained), (by_angle, by_speed, by_rate)

    def going_on(self, time: float, length: float) -> Turning:
        z = self.z.copy()
        z[self.following] = 0.0
        rows, carried = self._influence(length)[0], self.interfaces.carrier(time + length * ENDS)
        sizes = np.abs(self.rows[1]) @ np.abs(self.z)
        self.parts = np.abs(carried[1]).max(axis=1, keepdims=True) + sizes[:, None]
        return rows[0] @ z + carried[0], rows[1] @ z + carried[1], rows[2] @ z + carried[2]

    def at_begin(self, time: float) -> Turning:
        return self._with_carrier(np.array([time]), self.z[:, None], self.march.regime(self.state))

    def inside(self, time: float, length: float, torque: FloatArray, share: FloatArray) -> Turning:
        start, regime = self._under(torque, length), self.regime(length)
        z = np.stack([_move_on(regime, start, late) for late in (share * length).tolist()], axis=1)
        return self._with_carrier(time + share * length, z, regime)

    def _with_carrier(self, time: FloatArray, z: FloatArray, regime: Regime) -> Turning:
        (angle, speed), carried = self.rows, self.interfaces.carrier(time)
        return (
            carried[0] + angle @ z,
            carried[1] + speed @ z,
            carried[2] + speed @ (regime.matrix @ z),
        )

    def _under(self, torque: FloatArray, length: float) -> FloatArray:
        """The state at the begin of a step under torques (interfaces, nodes)."""
        signals = self.train.signals
        sums = np.zeros((signals.polynomials, POINTS))
        np.add.at(sums, self.interfaces.signal, torque)
        z = self.z.copy()
        z[self.following] = signals.polynomial(sums, length)
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


def _move_on(regime: Regime, z: FloatArray, time: float) -> FloatArray:
    """Return the state after a time that may exceed a block."""
    block = STEPS * regime.step
    while time > block:
        z, time = regime.after(z, block), time - block
    return regime.after(z, time)


def event_driven_under_laws(
    marching: March,
    state: State,
    z: FloatArray,
    interfaces: Interfaces,
    laws: Sequence[Law],
    scheme: Scheme,
    progress: Report = lambda share: None,
) -> tuple[EventDrivenMotion, Marched]:
    """The motion from regimes and a state at time 0 under the torques that laws require.

    The breaks of signals have to be among the cuts of the scheme. Raises what `march` and a March raise.
    """
    z, state = marching.rearm(0.0, z, state)
    taken = RegimesTaken(marching, interfaces, z, state)
    marched = march(taken, laws, scheme, progress)
    return marching.finished(taken.z, taken.state, marching.duration), marched
