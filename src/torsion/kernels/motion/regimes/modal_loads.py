"""A train in modes with the elements between them and all that acts on it: the inputs of its motion.

Inputs stand in the order 1, torques by time (loads), torques that follow the motion (interfaces), and offsets of the
elements' springs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.motion.regimes.damped_modes import ModalTrain
from torsion.kernels.motion.regimes.piecewise_elements import Element, Friction
from torsion.kernels.motion.torques.polynomial_torques import DERIVED, POINTS
from torsion.kernels.motion.torques.torque_history import History, Piece, history

ROUNDING = 1e-12  # of an element's largest relative angle
SAME_TIME = 4e-16  # relative: times that are one
# Angle, speed and acceleration of the interfaces' own stations, whole, each (interfaces, times).
Turning = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True)
class Acting:
    """Terms (level + slope t) exp(rate t) of loads that act together, t from the begin of an interval: each (terms,)."""

    load: IntArray
    level: ComplexArray  # N m
    slope: ComplexArray  # N m/s
    rate: ComplexArray  # 1/s

    @cached_property
    def kind(self) -> tuple[object, ...]:
        """Loads, rates, and which rates have slopes: the same for terms that differ in levels and slopes alone."""
        counts = (count for *_, count in self.by_rate)
        return *self.load.tolist(), *self.rate.tolist(), *counts

    @cached_property
    def by_rate(self) -> list[tuple[complex, IntArray, int]]:
        """Every rate with its terms, and 2 where one of them has a slope, else 1."""
        rates = dict.fromkeys(self.rate.tolist())
        chosen = [(rate, np.flatnonzero(self.rate == rate)) for rate in rates]
        return [(rate, terms, 1 + int(self.slope[terms].any())) for rate, terms in chosen]

    def later(self, since: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Levels and slopes (terms, times) as they are counted from times since the begin of the interval (s)."""
        growth = np.exp(np.multiply.outer(self.rate, since))
        slope = self.slope[:, None]
        return (self.level[:, None] + slope * since) * growth, slope * growth


@dataclass(frozen=True)
class LoadedModes:
    """Rigid motions and elastic modes of generalised inertia 1, the elements between them, and what acts on them."""

    modes: ModalTrain
    loads: Sequence[Sequence[Piece]]
    force: FloatArray  # (motions, loads)
    shape: FloatArray  # (interfaces, motions) rad
    elements: tuple[Element, ...] = ()
    # (elements, elements) rad/(N m) of modes that are left out, in series with the elements
    compliance: FloatArray | None = None
    # (elements, loads + interfaces) rad/(N m): their answer to what acts
    higher_answer: FloatArray | None = None

    @cached_property
    def motions(self) -> int:
        """How many rigid motions and modes there are."""
        return len(self.modes.viscous)

    @cached_property
    def following(self) -> slice:
        """Where the torques that follow the motion stand among the inputs."""
        first = 1 + len(self.loads)
        return slice(first, first + len(self.shape))

    @cached_property
    def inputs(self) -> int:
        """How many inputs there are."""
        return int(self.following.stop) + len(self.elements)

    @cached_property
    def push(self) -> FloatArray:
        """(motions, inputs) generalised forces of inputs of 1."""
        push = np.zeros((self.motions, self.inputs))
        push[:, 1 : self.following.start] = self.force
        push[:, self.following] = self.shape.T
        return push

    @cached_property
    def ends(self) -> FloatArray:
        """(elements, motions) rad, relative angles of their ends; 0 where a rigid motion twists them by rounding."""
        ends = np.array([element.ends for element in self.elements]).reshape(-1, self.motions)
        rounding = ROUNDING * np.abs(ends).max(axis=1, initial=0.0, keepdims=True)
        is_rounding = (np.abs(ends) <= rounding) & (self.modes.w_of_all == 0.0)
        return np.where(is_rounding, 0.0, ends)

    @cached_property
    def stiffness(self) -> FloatArray:
        """(elements,) N m/rad."""
        return np.array([element.stiffness for element in self.elements])

    @cached_property
    def viscous(self) -> FloatArray:
        """(elements,) N m s/rad."""
        return np.array([getattr(element, "viscous", 0.0) for element in self.elements])

    @cached_property
    def capacity(self) -> FloatArray:
        """(elements, inputs) N m."""
        rows = np.zeros((len(self.elements), self.inputs))
        for row, element in zip(rows, self.elements, strict=True):
            if isinstance(element, Friction) and element.signal is not None:
                row[1 + element.signal] = 1.0
            else:
                row[0] = getattr(element, "capacity", 0.0)
        return rows

    @cached_property
    def history(self) -> History:
        """The loads by intervals throughout which the same pieces act."""
        return history(self.loads)

    @cached_property
    def fastest(self) -> float:
        """The largest rate of a piece, in 1/s."""
        rates = (abs(complex(piece.rate)) for pieces in self.loads for piece in pieces)
        return max(rates, default=0.0)

    @cached_property
    def acting(self) -> list[Acting]:
        """What acts in each interval of the history."""
        intervals = list[Acting]()
        for terms in self.history.terms:
            sums = dict[tuple[int, complex], ComplexArray]()
            for term in terms:
                levels = sums.setdefault((term.load, term.rate), np.zeros(2, dtype=complex))
                levels += term.level, term.slope
            load, rate = (np.array([key[k] for key in sums]) for k in (0, 1))
            level, slope = np.array(list(sums.values())).reshape(-1, 2).T
            intervals.append(Acting(load.astype(np.int64), level, slope, rate.astype(complex)))
        return intervals

    def loads_at(self, interval: int, since: FloatArray, orders: int = 1) -> FloatArray:
        """(loads, times, orders) N m and derivatives of it, at times since the begin of an interval (s)."""
        acting, order = self.acting[interval], np.arange(orders)
        level, slope = acting.later(since)
        powers = acting.rate[:, None] ** order
        values = level[:, :, None] * powers[:, None]
        values[:, :, 1:] += slope[:, :, None] * (order[1:] * powers[:, :-1])[:, None]
        is_of_load = acting.load == np.arange(len(self.loads))[:, None]
        total = is_of_load @ values.real.reshape(len(values), len(since) * orders)
        return np.asarray(total.reshape(len(self.loads), len(since), orders))


@dataclass(frozen=True)
class Start:
    """The begin of a step, or of several in columns: one each or as many as times."""

    interval: int  # of the history
    time: FloatArray  # (columns,) s
    y: ComplexArray  # (coordinates, columns)
    turned: FloatArray  # (motions that nothing holds, columns) rad
    offset: FloatArray  # (elements, columns) rad
    # (coefficients, interfaces, columns) N m of the torques that follow the motion, over a length (columns,) s
    series: FloatArray
    length: FloatArray
    begun: FloatArray  # (rigid motions, columns) rad, from which positions of the step count

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """All that has columns, by name."""
        return {name: values for name, values in vars(self).items() if name != "interval"}

    def select(self, number: IntArray) -> "Start":
        """Some of the columns."""
        chosen = {name: values[..., number] for name, values in self.columns.items()}
        return Start(self.interval, **chosen)


def beside_each_other(starts: Sequence[Start]) -> Start:
    """Starts in one interval as columns."""
    names = starts[0].columns
    joined = {
        name: np.concatenate([getattr(start, name) for start in starts], axis=-1) for name in names
    }
    return Start(starts[0].interval, **joined)


def inputs_at(train: LoadedModes, start: Start, time: FloatArray, orders: int = 1) -> FloatArray:
    """(inputs, times, orders) and derivatives of them, at times since the start (s)."""
    inputs, offsets = np.zeros((train.inputs, len(time), orders)), train.following.stop
    since = start.time + time - train.history.begin[start.interval]
    inputs[1 : train.following.start] = train.loads_at(start.interval, since, orders)
    if len(train.shape):
        order = np.arange(min(orders, POINTS))[:, None, None, None]
        series = (
            np.tensordot(DERIVED[: len(order)], start.series, 1) * (2.0 / start.length) ** order
        )
        basis = legendre.legvander(2.0 * time / start.length - 1.0, POINTS - 1)
        inputs[train.following, :, : len(order)] = np.einsum("tk,okit->ito", basis, series)
    inputs[0, :, 0], inputs[offsets:, :, 0] = 1.0, start.offset
    return inputs
