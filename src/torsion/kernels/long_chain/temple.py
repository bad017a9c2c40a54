"""Narrow enclosures of the frequencies of a long chain, from one step of inverse iteration.

A count of a chain of n stations carries roundings that move a frequency by up to 4 n units in the worst case. That
suffices to separate a mode from its neighbours, and the inequality of Temple and Kato does the rest: if a vector v has
the quotient q = (v, Tv)/(v, v) and the residual e = |Tv - q v|/|v|, and no other eigenvalue of T lies in (low, high),
then the one in it lies in [q - e^2/(high - q), q + e^2/(q - low)] (Kato 1949). T is the static response to the torques
J v; its eigenvalues are 1/w^2. It takes two running sums, one of torques and one of twists, and no difference of
angles: (v, Tv) = sum of h t^2, whatever the stiffness ratios. Every rounding of the sums is bounded and counted in.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import FloatArray

_UNIT = 2.0**-53
_UNIT_OF_WIDEST = (
    float(np.finfo(np.longdouble).eps) / 2.0
)  # where there is nothing wider: that of a double
_ROUNDINGS_OF_SUM = 64  # of numpy's pairwise sums of up to 1e9 terms, with those of each term
_ROUNDINGS_OF_TERM = 4
_OUTER_MARGIN = 2.0**-50  # relative; outweighs the roundings of the bounds themselves


@dataclass(frozen=True)
class Chain:
    """Stations in a row, joined by flexible spans, the first one free.

    As many flexibilities as inertias: the last span ties the last station to a fixed point; one less: it is free too.
    """

    inertia: FloatArray  # (n,) positive
    flexibility: FloatArray  # (n - 1,) or (n,) positive

    @property
    def is_free(self) -> bool:
        """Nothing holds the chain, which then has a rigid motion."""
        return len(self.flexibility) < len(self.inertia)

    @cached_property
    def root(self) -> FloatArray:
        """(n,) square roots of the inertias."""
        return np.sqrt(self.inertia)

    @cached_property
    def total_inertia(self) -> float:
        """Sum of the inertias."""
        return float(self.inertia.sum())

    @cached_property
    def total_flexibility(self) -> float:
        """Sum of the flexibilities."""
        return float(self.flexibility.sum())

    @property
    def slack(self) -> float:
        """Relative error of a frequency that is certain to outweigh all roundings of one count.

        What is counted is exact for a chain whose D are wrong by 3 units of rounding and L L D by 5, data included;
        each entry moves a frequency by half its own change at most (Demmel and Kahan 1990), and the errors may add.
        """
        return (4.0 * len(self.inertia) + 16.0) * 2.0**-53

    def lumped(self, number: int) -> "Chain":
        """A chain that is like this one at low frequencies, `number` stations becoming one, the last one fewer."""
        starts = np.arange(0, len(self.inertia), number)
        middle = np.minimum(starts + number // 2, len(self.inertia) - 1)
        inertia = np.add.reduceat(self.inertia, starts)
        end = len(self.flexibility) if not self.is_free else int(middle[-1])
        spans = middle if not self.is_free else middle[:-1]
        return Chain(inertia, np.add.reduceat(self.flexibility[:end], spans))


@dataclass(frozen=True)
class Quotient:
    """Temple's data of one vector: the square's inverse is 1/w^2."""

    inverse: float  # quotient q, s2
    error: float  # relative, of its evaluation, proven
    residual: float  # bound of e, s2

    @property
    def frequency(self) -> float:
        """rad/s."""
        return 1.0 / math.sqrt(self.inverse)

    def enclosure(self, below: float, above: float) -> tuple[float, float] | None:
        """Bounds, rad/s, of the only frequency between `below` and `above`, rad/s; None where that is not proven.

        `below` may be 0: then there is no lower frequency at all.
        """
        least, most = self.inverse * (1.0 - self.error), self.inverse * (1.0 + self.error)
        high = math.inf if below == 0.0 else below**-2.0 * (1.0 - 4.0 * _OUTER_MARGIN)
        low = above**-2.0 * (1.0 + 4.0 * _OUTER_MARGIN)
        if not (low < least and most < high and self.residual**2 < (least - low) * (high - most)):
            return None
        least -= self.residual**2 / (high - most)
        most += self.residual**2 / (least - low)
        if not 0.0 < least <= most < math.inf:
            return None
        return most**-0.5 * (1.0 - _OUTER_MARGIN), least**-0.5 * (1.0 + _OUTER_MARGIN)


def quotient(chain: Chain, angle: FloatArray) -> Quotient:
    """Quotient and residual of the vector `angle` (n,), less its rigid part where the chain is free."""
    inertia, flexibility = chain.inertia, chain.flexibility
    total, softness = chain.total_inertia, chain.total_flexibility
    vector = angle - float(np.dot(inertia, angle)) / total if chain.is_free else angle
    load = inertia * vector
    torque, lost_torque = _torques(chain, load)
    twist = flexibility * torque
    turned, norm = float(np.abs(twist).sum()), float((load * vector).sum())
    energy = float((twist * torque).sum())
    inverse = energy / norm
    error = (2.0 * turned + lost_torque * softness) * lost_torque / energy + lost_torque**2 / (
        total * norm
    )
    error += 2.0 * _ROUNDINGS_OF_SUM * _UNIT
    rest, roundings = _response(chain, twist)
    rest -= inverse * vector
    square = float((inertia * rest * rest).sum()) / norm
    lost_angle = lost_torque * softness + (roundings + _ROUNDINGS_OF_SUM) * _UNIT * turned
    residual = math.sqrt(square) + 4.0 * lost_angle * math.sqrt(total / norm) + error * inverse
    return Quotient(inverse, error, residual * (1.0 + _OUTER_MARGIN))


def _torques(chain: Chain, load: FloatArray) -> tuple[FloatArray, float]:
    """Torque in every span under `load` (n,), and the most that rounding may have changed any of them by."""
    running, roundings = running_sum(load, np.longdouble)
    torque: FloatArray = running[: len(chain.flexibility)].astype(np.float64)
    lost = (roundings * _UNIT_OF_WIDEST + _ROUNDINGS_OF_TERM * _UNIT) * float(np.abs(load).sum())
    return torque, lost + 2.0 * (abs(float(running[-1])) + lost) if chain.is_free else lost


def _response(chain: Chain, twist: FloatArray) -> tuple[FloatArray, int]:
    """Angles (n,) that go with the `twist` of every span, without rigid part, and the roundings in one of them."""
    if not chain.is_free:
        angle, roundings = running_sum(twist[::-1], np.float64)
        return angle[::-1].copy(), roundings
    angle = np.zeros(len(chain.inertia))
    turned, roundings = running_sum(twist, np.float64)
    np.negative(turned, out=angle[1:])
    angle -= float(np.dot(chain.inertia, angle)) / chain.total_inertia
    return angle, roundings


def running_sum(terms: FloatArray, kind: type[np.floating[Any]]) -> tuple[NDArray[Any], int]:
    """Running sums (n,) of `terms` (n,) in numbers of a `kind`, and how many roundings at most enter one of them.

    Rows of sqrt(n) terms first, then the sums of the rows: about 2 sqrt(n) roundings instead of n.
    """
    size = len(terms)
    width = math.isqrt(max(size - 1, 0)) + 1
    rows = -(-size // width)
    table = np.zeros((rows, width), dtype=kind)
    table.reshape(-1)[:size] = terms
    np.cumsum(table, axis=1, out=table)
    table[1:] += np.cumsum(table[:-1, -1])[:, None]
    return table.reshape(-1)[:size], rows + width
