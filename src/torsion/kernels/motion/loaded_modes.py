"""A train in modes with the elements between them and all that acts on it: the inputs of its motion.

Inputs stand in the order 1, torques by time (loads), torques that follow the motion (interfaces), and offsets of the
elements' springs. Torques by time are sums of pieces, each a ramp times an exponential, cut where one begins or ends.

>>> ramp = Piece(0.0, 2.0, 1.0, 3.0)  # 1 N m at 0 s, 7 N m at 2 s, nothing afterwards
>>> value([ramp], np.array([0.0, 1.0, 2.5])).tolist()
[1.0, 4.0, 0.0]

Answers of first-order coordinates to polynomials of time and exponentials are exact at any time, without steps.
A coordinate y' = r y + s**k exp(p s) from rest answers after a time t with t**(k + 1) exp(p t) A_k(z), z = (r - p) t,
    A_k(z) = integral over 0 <= x <= 1 of exp(z (1 - x)) x**k,
    A_0 = (exp(z) - 1) / z,   A_k = (k A_(k - 1) - 1) / z,
and where |z| is small the last of these is a series, from which A_(k - 1) = (1 + z A_k) / k follow, so that a resonance
(z = 0) loses no digit. Torques that are polynomials over a step are given by their values at Gauss points, whose Legendre
coefficients fall where the step is accurate; the powers of the share of the step then lose nothing either.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import comb, perm
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.polynomial.polynomial import polyval

from torsion.arrays import ComplexArray, FloatArray, IntArray

if TYPE_CHECKING:
    from torsion.kernels.motion.piecewise_elements import Element

ROUNDING = 1e-12  # of an element's largest relative angle
SAME_TIME = 4e-16  # relative: times that are one
# Angle, speed and acceleration of the interfaces' own stations, whole: (3, interfaces, times).
Turning = FloatArray
POINTS = 8  # of a step: the order is twice as high; 4 points need six times as many steps and more
_x, _w = legendre.leggauss(POINTS)
NODES: FloatArray = (_x + 1.0) / 2.0  # shares of the step
ENDS: FloatArray = np.append(NODES, 1.0)
# (coefficients, nodes): Legendre series over the step of values at the nodes
SERIES: FloatArray = (np.arange(POINTS)[:, None] + 0.5) * _w * legendre.legvander(_x, POINTS - 1).T
AT_END = SERIES.sum(axis=0)[
    :, None
]  # (nodes, 1): a torque at the end of a step, of those at the nodes
# (powers, coefficients): the same by powers of the share s of the step, of P_n(2 s - 1). A product with the series
# comes first: high coefficients are small, and so are what their large factors leave of rounding.
POWERS: FloatArray = np.array(
    [
        [(-1.0) ** (n + k) * comb(n, k) * comb(n + k, k) for n in range(POINTS)]
        for k in range(POINTS)
    ]
)
# (orders, powers) factors that a derivative of an order brings to the powers
FALLING: FloatArray = np.array(
    [[float(perm(power, order)) for power in range(POINTS)] for order in range(POINTS)]
)
# of the number of answers: |z| below which the series is taken; TERMS of it are exact to rounding there
NEAR = 0.5
TERMS = 26


@dataclass(frozen=True, slots=True)
class Piece:
    """Re (level + slope * t) exp(rate * t) for begin <= time < end, t = time - begin."""

    begin: float  # s
    end: float  # s, may be infinite
    level: complex  # N m at its begin
    slope: complex = 0.0  # N m/s
    rate: complex = 0.0  # 1/s


@dataclass(eq=False)
class Acting:
    """Terms (level + slope t) exp(rate t) of loads that act together, t from the begin of an interval: each (terms,).

    by_rate: every rate with its terms, and 2 where one of them has a slope, else 1. kind: the same for terms that differ
    in levels and slopes alone.
    """

    load: IntArray
    level: ComplexArray  # N m
    slope: ComplexArray  # N m/s
    rate: ComplexArray  # 1/s

    def __post_init__(self) -> None:
        self.by_rate = list[tuple[complex, IntArray, int]]()
        for rate in dict.fromkeys(self.rate.tolist()):
            terms = np.flatnonzero(self.rate == rate)
            self.by_rate.append((rate, terms, 1 + int(self.slope[terms].any())))
        counts = (count for *_, count in self.by_rate)
        self.kind = (*self.load.tolist(), *self.rate.tolist(), *counts)

    def later(self, since: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Levels and slopes (terms, times) as they are counted from times since the begin of the interval (s)."""
        growth = np.exp(np.multiply.outer(self.rate, since))
        slope = self.slope[:, None]
        return (self.level[:, None] + slope * since) * growth, slope * growth


@dataclass(frozen=True)
class History:
    """The torques of loads over time, by intervals throughout which the same pieces act."""

    begin: FloatArray  # (intervals,) s, ascending from 0
    acting: tuple[Acting, ...]  # in each interval


def value(pieces: Iterable[Piece], time: FloatArray) -> FloatArray:
    """(times,) N m, the sum of the pieces."""
    total = np.zeros(len(time))
    for piece in pieces:
        inside = (time >= piece.begin) & (time < piece.end)
        late = time[inside] - piece.begin
        total[inside] += np.real((piece.level + piece.slope * late) * np.exp(piece.rate * late))
    return total


def history(loads: Sequence[Sequence[Piece]]) -> History:
    """The pieces of every load, cut where any of them begins or ends."""
    ends = {end for pieces in loads for piece in pieces for end in (piece.begin, piece.end)}
    begin = np.unique([0.0, *(end for end in ends if 0.0 < end < math.inf)])
    intervals = [dict[tuple[int, complex], ComplexArray]() for _ in begin]
    for load, pieces in enumerate(loads):
        for piece in pieces:
            first, last = np.searchsorted(begin, (max(piece.begin, 0.0), piece.end)).tolist()
            for start, sums in zip(begin[first:last].tolist(), intervals[first:last], strict=True):
                late, rate = start - piece.begin, complex(piece.rate)
                both = np.array([piece.level + piece.slope * late, piece.slope], dtype=complex)
                both *= np.exp(rate * late)
                terms = [(rate, both)]
                if both.imag.any() or rate.imag:  # its real part: half of it and its conjugate
                    terms = [(rate, both / 2.0), (rate.conjugate(), both.conj() / 2.0)]
                for term_rate, term in terms:
                    sums.setdefault((load, term_rate), np.zeros(2, dtype=complex))
                    sums[load, term_rate] += term
    acting = []
    for sums in intervals:
        load_of, rate_of = (np.array([key[k] for key in sums]) for k in (0, 1))
        level, slope = np.array(list(sums.values())).reshape(-1, 2).T
        acting.append(Acting(load_of.astype(np.int64), level, slope, rate_of.astype(complex)))
    return History(begin, tuple(acting))


@dataclass(frozen=True)
class ModalTrain:
    """Rigid motions and elastic modes of generalised inertia 1, and what damps them."""

    w: FloatArray  # (modes,) rad/s
    ratio: FloatArray  # (modes,) damping ratio of what damps every mode by itself
    viscous: FloatArray  # (rigid motions + modes, the same) 1/s, of speeds: what may couple them

    @property
    def rigid(self) -> int:
        """How many rigid motions stand before the modes."""
        return len(self.viscous) - len(self.w)

    @cached_property
    def w_of_all(self) -> FloatArray:
        """Natural frequencies, 0 for rigid motions: (rigid motions + modes,) rad/s."""
        return np.concatenate([np.zeros(self.rigid), self.w])

    @cached_property
    def damping(self) -> FloatArray:
        """(rigid motions + modes, the same) 1/s, all of it."""
        ratio = np.concatenate([np.zeros(self.rigid), self.ratio])
        return self.viscous + np.diag(2.0 * ratio * self.w_of_all)


@dataclass(eq=False)
class LoadedModes:
    """Rigid motions and elastic modes of generalised inertia 1, the elements between them, and what acts on them.

    motions: how many rigid motions and modes there are. inputs: how many inputs. following: where the torques that
    follow the motion stand among these. columns: where positions, speeds, inputs and their rates stand in rows over
    these four. history: the loads by intervals throughout which the same pieces act.
    """

    modes: ModalTrain
    loads: Sequence[Sequence[Piece]]
    force: FloatArray  # (motions, loads)
    shape: FloatArray  # (interfaces, motions) rad
    elements: "tuple[Element, ...]" = ()
    # (elements, elements) rad/(N m) of modes that are left out, in series with the elements
    compliance: FloatArray | None = None
    # (elements, loads + interfaces) rad/(N m): their answer to what acts
    higher_answer: FloatArray | None = None

    def __post_init__(self) -> None:
        self.motions = n = len(self.modes.viscous)
        first, number = 1 + len(self.loads), len(self.elements)
        self.following = slice(first, first + len(self.shape))
        self.inputs = m = first + len(self.shape) + number
        self.columns = tuple(
            slice(*ends) for ends in pairwise((0, n, 2 * n, 2 * n + m, 2 * (n + m)))
        )
        # (motions, inputs) generalised forces of inputs of 1
        none = np.zeros((n, 1)), np.zeros((n, number))
        self.push = np.concatenate([none[0], self.force, self.shape.T, none[1]], axis=1)

        # (elements, motions) rad, relative angles of their ends; 0 where a rigid motion twists them by rounding
        ends = np.array([element.ends for element in self.elements]).reshape(-1, n)
        rounding = ROUNDING * np.abs(ends).max(axis=1, initial=0.0, keepdims=True)
        is_rounding = (np.abs(ends) <= rounding) & (self.modes.w_of_all == 0.0)
        self.ends = np.where(is_rounding, 0.0, ends)
        # (elements, elements) rad/(N m), the compliance; 0 where all modes are kept
        self.soft = np.zeros((number, number)) if self.compliance is None else self.compliance
        self.capacity = np.zeros((number, m))  # (elements, inputs) N m
        for row, element in zip(self.capacity, self.elements, strict=True):
            if element.signal is None:
                row[0] = element.capacity
            else:
                row[1 + element.signal] = 1.0

        self.history = history(self.loads)
        rates = (abs(complex(piece.rate)) for pieces in self.loads for piece in pieces)
        self.fastest = max(rates, default=0.0)  # 1/s, the largest rate of a piece

    def loads_at(self, interval: int, since: FloatArray, orders: int = 1) -> FloatArray:
        """(loads, times, orders) N m and derivatives of it, at times since the begin of an interval (s)."""
        acting, order = self.history.acting[interval], np.arange(orders)
        level, slope = acting.later(since)
        powers = acting.rate[:, None] ** order
        values = level[:, :, None] * powers[:, None]
        values[:, :, 1:] += slope[:, :, None] * (order[1:] * powers[:, :-1])[:, None]
        is_of_load = acting.load == np.arange(len(self.loads))[:, None]
        total = is_of_load @ values.real.reshape(len(values), len(since) * orders)
        return np.asarray(total.reshape(len(self.loads), len(since), orders))

    def inputs_at(self, interval: int, start: "Start", time: FloatArray, orders: int) -> FloatArray:
        """(inputs, times, orders) and derivatives of them, at times since the start of a step (s)."""
        inputs, offsets = np.zeros((self.inputs, len(time), orders)), self.following.stop
        since = start.time + time - self.history.begin[interval]
        inputs[1 : self.following.start] = self.loads_at(interval, since, orders)
        if len(self.shape):
            powers = np.vander(time, POINTS, increasing=True).T
            for order in range(min(orders, POINTS)):
                factors = FALLING[order, order:, None] * powers[: POINTS - order]
                polynomial = start.polynomial[order:]
                inputs[self.following, :, order] = np.einsum("kt,kit->it", factors, polynomial)
        inputs[0, :, 0], inputs[offsets:, :, 0] = 1.0, start.offset
        return inputs


class Start(NamedTuple):
    """The begin of a step, or of several in columns: one each or as many as times."""

    time: FloatArray  # (columns,) s
    y: ComplexArray  # (coordinates, columns)
    turned: FloatArray  # (motions that nothing holds, columns) rad
    offset: FloatArray  # (elements, columns) rad
    # (powers, interfaces, columns) N m, N m/s ... of the torques that follow the motion
    polynomial: FloatArray
    begun: FloatArray  # (rigid motions, columns) rad, from which positions of the step count


def polynomial_value(polynomial: np.ndarray, point: FloatArray) -> np.ndarray:
    """(..., points) of polynomials (powers, ..., points or 1) at points (points,)."""
    return np.asarray(polyval(point, polynomial, tensor=False))


def answers(
    root: ComplexArray, rate: complex, time: FloatArray, count: int, decay: ComplexArray
) -> ComplexArray:
    """exp(rate time) A_k, (count, coordinates, times), to `count` powers of the share of a time; decay: exp(root time).

    >>> answers(np.zeros(1), 0.0, np.array([2.0]), 3, np.ones((1, 1))).real.ravel().round(12)
    array([1.        , 0.5       , 0.33333333])
    """
    z = np.multiply.outer(root - rate, time)
    growth = np.broadcast_to(np.exp(rate * time), z.shape).ravel()
    answer, flat, is_near = (
        np.empty((count, z.size), dtype=complex),
        z.ravel(),
        np.abs(z) < NEAR * count,
    )
    if (near := np.flatnonzero(is_near)).size:
        small, grown = flat[near], growth[near]
        last, square = (
            np.zeros((2, near.size), dtype=complex),
            small * small,
        )  # even terms, odd ones
        for pair in np.cumprod(1.0 / np.arange(count, count + TERMS)).reshape(-1, 2, 1)[::-1]:
            last *= square
            last += pair
        last = grown * (last[0] + small * last[1])
        answer[-1][near] = last
        for power in range(count - 1, 0, -1):
            last = (grown + small * last) / power
            answer[power - 1][near] = last
    if (far := np.flatnonzero(~is_near)).size:
        grown, inverse = growth[far], 1.0 / flat[far]
        last = (decay.ravel()[far] - grown) * inverse
        answer[0][far] = last
        for power in range(1, count):
            last = (power * last - grown) * inverse
            answer[power][far] = last
    return answer.reshape(count, *z.shape)


def turning(rate: complex, time: FloatArray, count: int) -> np.ndarray:
    """(count, times or 1) share of time**(k + 2) by which a motion without root, whose speed answers, turns."""
    power = np.arange(count)[:, None]
    if rate == 0.0:
        return np.asarray(1.0 / ((power + 1.0) * (power + 2.0)))
    none, alone = np.zeros(1, dtype=complex), np.ones((1, len(time)), dtype=complex)
    speed = answers(none, rate, time, count + 1, alone)[:, 0]
    return np.asarray(speed[:-1] - speed[1:])
