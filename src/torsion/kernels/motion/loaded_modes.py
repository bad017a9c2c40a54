"""A train in modes with the elements between them and all that acts on it: the inputs of its motion.

Inputs stand in the order 1, torques by time (loads), torques that follow the motion (interfaces), and offsets of the
elements' springs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.closed_answers import POINTS, value
from torsion.kernels.motion.damped_modes import ModalTrain
from torsion.kernels.motion.piecewise_elements import Element
from torsion.kernels.motion.torque_history import Piece, history

ROUNDING = 1e-12  # of an element's largest relative angle
SAME_TIME = 4e-16  # relative: times that are one
# Angle, speed and acceleration of the interfaces' own stations, whole: (3, interfaces, times).
Turning = FloatArray


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
    elements: tuple[Element, ...] = ()
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
            polynomial = start.polynomial
            for order in range(min(orders, POINTS)):
                inputs[self.following, :, order] = value(polynomial, time / start.length)
                power = np.arange(1.0, len(polynomial))[:, None, None]
                polynomial = power * polynomial[1:] / start.length
        inputs[0, :, 0], inputs[offsets:, :, 0] = 1.0, start.offset
        return inputs


class Start(NamedTuple):
    """The begin of a step, or of several in columns: one each or as many as times."""

    time: FloatArray  # (columns,) s
    y: ComplexArray  # (coordinates, columns)
    turned: FloatArray  # (motions that nothing holds, columns) rad
    offset: FloatArray  # (elements, columns) rad
    # (powers, interfaces, columns) N m of the torques that follow the motion, by the share of a length (columns,) s
    polynomial: FloatArray
    length: FloatArray
    begun: FloatArray  # (rigid motions, columns) rad, from which positions of the step count
