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
POWERS: FloatArray = (
    np.array(  # (powers of the share, coefficients) of the Legendre series of a step
        [
            [(-1.0) ** (k + n) * math.comb(n, k) * math.comb(n + k, k) for n in range(POINTS)]
            for k in range(POINTS)
        ]
    )
)


@dataclass(frozen=True)
class _Group:
    """The pieces of one signal and one rate: where their states stand."""

    signal: int
    rate: complex
    first: int
    parts: int  # 1 real, 2 real and imaginary
    slopes: bool

    @property
    def size(self) -> int:
        """Number of states."""
        return self.parts * (1 + self.slopes)

    def matrix(self) -> FloatArray:
        """(size, size) 1/s."""
        p = self.rate
        turn = (
            np.array([[p.real]])
            if self.parts == 1
            else np.array([[p.real, -p.imag], [p.imag, p.real]])
        )
        if not self.slopes:
            return turn
        return np.block([[turn, np.eye(self.parts)], [np.zeros_like(turn), turn]])


@dataclass(frozen=True)
class Signals:
    """Several torques, each the sum of its pieces; its complex value, of which a reader takes the real part."""

    pieces: tuple[tuple[Piece, ...], ...]
    polynomials: int = 0  # signals behind them that follow the motion
    scale: float = 1.0  # s, near that of the fastest motion

    @property
    def number(self) -> int:
        """Of signals."""
        return len(self.pieces) + self.polynomials

    @cached_property
    def groups(self) -> tuple[_Group, ...]:
        """One of every signal and rate."""
        found, first = [], 0
        for signal, pieces in enumerate(self.pieces):
            for rate in dict.fromkeys(complex(piece.rate) for piece in pieces):
                alike = [piece for piece in pieces if piece.rate == rate]
                turns = any(
                    complex(number).imag
                    for piece in alike
                    for number in (rate, piece.level, piece.slope)
                )
                group = _Group(signal, rate, first, 1 + turns, any(piece.slope for piece in alike))
                found.append(group)
                first += group.size
        return tuple(found)

    @property
    def known(self) -> int:
        """Number of states of the pieces, which stand first."""
        return sum(group.size for group in self.groups)

    @property
    def size(self) -> int:
        """Number of states."""
        return self.known + self.polynomials * POINTS

    @cached_property
    def fastest(self) -> float:
        """1/s, the largest rate."""
        return max((abs(group.rate) for group in self.groups), default=0.0)

    @cached_property
    def matrix(self) -> FloatArray:
        """(states, states) 1/s."""
        whole = np.zeros((self.size, self.size))
        for group in self.groups:
            here = slice(group.first, group.first + group.size)
            whole[here, here] = group.matrix()
        here = slice(self.known, self.size)
        whole[here, here] = (
            np.kron(np.eye(self.polynomials), np.diag(np.arange(1.0, POINTS), 1)) / self.scale
        )
        return whole

    @cached_property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        """(signals, states) that read the real and the imaginary part of every value."""
        real, imaginary = np.zeros((2, self.number, self.size))
        for group in self.groups:
            real[group.signal, group.first] = 1.0
            if group.parts == 2:
                imaginary[group.signal, group.first + 1] = 1.0
        behind = np.arange(self.polynomials)
        real[len(self.pieces) + behind, self.known + behind * POINTS] = 1.0
        return real, imaginary

    @cached_property
    def breaks(self) -> FloatArray:
        """(breaks,) s, times after 0 at which a piece begins or ends."""
        ends = {
            end for pieces in self.pieces for piece in pieces for end in (piece.begin, piece.end)
        }
        return np.array(sorted(end for end in ends if 0.0 < end < math.inf))

    def state(self, time: float) -> FloatArray:
        """(known,) of the pieces that act from a time on."""
        found = np.zeros(self.known)
        for group in self.groups:
            for piece in self.pieces[group.signal]:
                if piece.rate == group.rate and piece.begin <= time < piece.end:
                    moved = piece.moved(time)
                    numbers = [complex(moved.level), complex(moved.slope)][: 1 + group.slopes]
                    parts = [
                        part for one in numbers for part in (one.real, one.imag)[: group.parts]
                    ]
                    found[group.first : group.first + group.size] += parts
        return found

    def polynomial(self, torque: FloatArray, length: float) -> FloatArray:
        """(polynomials * POINTS,) states at the begin of a step (s), from torques (polynomials, nodes) in it."""
        series = SERIES @ torque.T
        series[np.abs(series) <= ROUNDED * np.abs(series).max(axis=0, initial=0.0)] = 0.0
        powers = POWERS @ series * ((self.scale / length) ** np.arange(POINTS))[:, None]
        return np.asarray(powers.T.ravel())

    def acting(self, signal: int, state: FloatArray) -> bool:
        """A signal is not zero until the next break."""
        own = [state[g.first : g.first + g.size] for g in self.groups if g.signal == signal]
        return any(bool(part.any()) for part in own)
