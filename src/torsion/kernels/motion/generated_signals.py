"""Torques over time as states of a linear system of their own: y' = G y between the times at which a piece begins or
ends, so that they and the train they act on have one matrix.

A piece (level + slope t) exp(rate t) is the state y' = rate y + s, s' = rate s; its real and imaginary parts are two.
A torque that follows the motion is a polynomial of a step: its Taylor coefficients are states a_k' = (k + 1) a_(k + 1).

>>> ramp = Signals(((Piece(0.0, 2.0, 1.0, 3.0),),))
>>> ramp.matrix.tolist(), ramp.state(1.0).tolist(), ramp.breaks.tolist()
([[0.0, 1.0], [0.0, 0.0]], [4.0, 3.0], [2.0])
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.polynomial_torques import POINTS, SERIES
from torsion.kernels.motion.torque_history import Piece

ROUNDED = 4.0 * np.finfo(float).eps  # of the largest coefficient of a series: nothing
# (powers of the share, coefficients) of the Legendre series of a step
POWERS: FloatArray = np.array(
    [
        [(-1.0) ** (k + n) * math.comb(n, k) * math.comb(n + k, k) for n in range(POINTS)]
        for k in range(POINTS)
    ]
)


@dataclass(frozen=True)
class _Group:
    """The pieces of one signal and one rate, and where their states stand."""

    signal: int
    pieces: tuple[Piece, ...]
    rate: complex
    first: int

    @cached_property
    def parts(self) -> int:
        """1 of real pieces, 2 of such with an imaginary part."""
        numbers = [part for piece in self.pieces for part in (piece.rate, piece.level, piece.slope)]
        return 2 if any(complex(number).imag for number in numbers) else 1

    @property
    def slopes(self) -> bool:
        """Whether a piece rises or falls."""
        return any(piece.slope for piece in self.pieces)

    @cached_property
    def states(self) -> slice:
        """The rows of its own states among all."""
        return slice(self.first, self.first + self.parts * (1 + self.slopes))

    def matrix(self) -> FloatArray:
        """Matrix G of the states, (states, states) 1/s."""
        p, unit = self.rate, np.eye(self.parts)
        turn = p.real * unit
        if self.parts == 2:
            turn = turn + np.array([[0.0, -p.imag], [p.imag, 0.0]])
        return np.block([[turn, unit], [0.0 * turn, turn]]) if self.slopes else turn


@dataclass(frozen=True)
class Signals:
    """Several torques, each the sum of its pieces; its complex value, of which a reader takes the real part."""

    pieces: tuple[tuple[Piece, ...], ...]
    polynomials: int = 0  # signals behind them that follow the motion
    scale: float = 1.0  # s, near that of the fastest motion

    @property
    def number(self) -> int:
        """How many signals there are, those that follow the motion included."""
        return len(self.pieces) + self.polynomials

    @cached_property
    def groups(self) -> tuple[_Group, ...]:
        """One of every signal and rate."""
        groups, first = list[_Group](), 0
        for signal, pieces in enumerate(self.pieces):
            for rate in dict.fromkeys(complex(piece.rate) for piece in pieces):
                alike = tuple(piece for piece in pieces if piece.rate == rate)
                groups.append(_Group(signal, alike, rate, first))
                first = groups[-1].states.stop
        return tuple(groups)

    @property
    def pieces_size(self) -> int:
        """Number of states of the pieces, which stand first."""
        return int(self.groups[-1].states.stop) if self.groups else 0

    @property
    def size(self) -> int:
        """How many states all signals have."""
        return self.pieces_size + self.polynomials * POINTS

    @cached_property
    def fastest(self) -> float:
        """The largest rate of a piece, in 1/s."""
        return max((abs(group.rate) for group in self.groups), default=0.0)

    @cached_property
    def matrix(self) -> FloatArray:
        """Matrix G of the states, (states, states) 1/s."""
        matrix = np.zeros((self.size, self.size))
        for group in self.groups:
            matrix[group.states, group.states] = group.matrix()
        chain = np.diag(np.arange(1.0, POINTS), 1) / self.scale
        polynomials = slice(self.pieces_size, self.size)
        matrix[polynomials, polynomials] = np.kron(np.eye(self.polynomials), chain)
        return matrix

    @cached_property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        """(signals, states) that read the real and the imaginary part of every value."""
        real, imaginary = np.zeros((2, self.number, self.size))
        for group in self.groups:
            real[group.signal, group.first] = 1.0
            if group.parts == 2:
                imaginary[group.signal, group.first + 1] = 1.0
        numbers = np.arange(self.polynomials)
        real[len(self.pieces) + numbers, self.pieces_size + numbers * POINTS] = 1.0
        return real, imaginary

    @cached_property
    def breaks(self) -> FloatArray:
        """(breaks,) s, times after 0 at which a piece begins or ends."""
        ends = {
            end for pieces in self.pieces for piece in pieces for end in (piece.begin, piece.end)
        }
        return np.array(sorted(end for end in ends if 0.0 < end < math.inf))

    def state(self, time: float) -> FloatArray:
        """(states of the pieces,) of those that act from a time on."""
        state = np.zeros(self.pieces_size)
        for group in self.groups:
            for piece in group.pieces:
                if piece.begin <= time < piece.end:
                    moved = piece.moved(time)
                    numbers = np.array([moved.level, moved.slope], dtype=complex)
                    parts = np.column_stack([numbers.real, numbers.imag])
                    state[group.states] += parts[: 1 + group.slopes, : group.parts].ravel()
        return state

    def polynomial(self, torque: FloatArray, length: float) -> FloatArray:
        """(polynomials * POINTS,) states at the begin of a step (s), from torques (polynomials, nodes) in it."""
        series = SERIES @ torque.T
        series[np.abs(series) <= ROUNDED * np.abs(series).max(axis=0, initial=0.0)] = 0.0
        powers = POWERS @ series * ((self.scale / length) ** np.arange(POINTS))[:, None]
        return np.asarray(powers.T.ravel())

    def acting(self, signal: int, state: FloatArray) -> bool:
        """A signal is not zero until the next break."""
        return any(state[group.states].any() for group in self.groups if group.signal == signal)
