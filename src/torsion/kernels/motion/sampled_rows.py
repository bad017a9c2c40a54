"""Quantities of a regime at fixed times since the begin of a step, as one matrix over all that the step begins with.

    quantity = Re(by_y y) + by_turned turned + by_inputs (U, U', U'')
A march meets the same times again and again; a step among them then costs one product.
"""

import math
from typing import NamedTuple

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.motion.linear_regime import Regime
from torsion.kernels.motion.loaded_modes import POINTS, Acting, LoadedModes, Start, answers, turning


class Rows(NamedTuple):
    """Quantities over coordinates, positions of what nothing holds, and inputs."""

    by_y: ComplexArray  # (rows, coordinates)
    by_turned: FloatArray  # (rows, motions that nothing holds)
    by_inputs: FloatArray  # (orders of derivatives, rows, inputs)


def rows_of(regime: Regime, values: FloatArray, rated: slice = slice(0)) -> Rows:
    """Quantities that are rows over positions, speeds, inputs and their rates; below them the rates of some of these."""
    position, speed, inputs, rates = (values[:, columns] for columns in regime.train.columns)
    by_turned = position @ regime.free
    by_y = regime.reading(position, speed)
    by_inputs = np.stack([inputs, rates, 0.0 * rates])
    by_inputs[0, :, regime.train.following.stop :] += position @ regime.constraint
    # A rate has y' and U' in place of y and U.
    rate_by_y = by_y[rated] * regime.root
    rate_by_y[:, : by_turned.shape[1]] += by_turned[rated]
    forced = (by_y[rated] @ regime.force).real
    rate_by_inputs = np.concatenate([forced[None], by_inputs[:2, rated]])
    return Rows(
        np.concatenate([by_y, rate_by_y]),
        np.concatenate([by_turned, 0.0 * by_turned[rated]]),
        np.concatenate([by_inputs, rate_by_inputs], axis=1),
    )


def coordinate_rows(regime: Regime) -> Rows:
    """Real and imaginary parts of all coordinates, and positions of what nothing holds."""
    size, number = len(regime.root), regime.free.shape[1]
    by_y = np.concatenate([np.eye(size), -1j * np.eye(size), np.zeros((number, size))])
    by_turned = np.eye(len(by_y), number, -2 * size)
    return Rows(by_y, by_turned, np.zeros((3, len(by_y), regime.train.inputs)))


def event_rows(regime: Regime) -> Rows:
    """Switching functions and their rates."""
    return rows_of(regime, regime.events, slice(None))


def interface_rows(regime: Regime) -> Rows:
    """Angles, speeds and accelerations of the interfaces."""
    position, speed, _, rates = regime.train.columns
    values = np.zeros((2, len(regime.train.shape), rates.stop))
    values[0, :, position] = values[1, :, speed] = regime.train.shape
    return rows_of(regime, np.concatenate(values), slice(len(values[0]), None))


ROWS = {"events": event_rows, "interfaces": interface_rows, "coordinates": coordinate_rows}


def features(train: LoadedModes, interval: int, start: Start) -> FloatArray:
    """All that a step begins with, in the order of the columns of `sample`, without torques that follow the motion."""
    history = train.history
    level, slope = history.acting[interval].later(start.time - history.begin[interval])
    terms = (level.real, level.imag, slope.real, slope.imag)
    first = (start.y.real, start.y.imag, start.turned, np.ones((1, 1)), start.offset)
    return np.concatenate([*first, *terms])[:, 0]


def sample(regime: Regime, acting: Acting, rows: Rows, time: FloatArray) -> FloatArray:
    """(rows, times, features) at times (s) of a step."""
    train, root, number = regime.train, regime.root, regime.free.shape[1]
    decay = np.exp(np.multiply.outer(root, time))
    by_y = rows.by_y[:, None] * decay.T
    by_y[:, :, :number] += rows.by_turned[:, None] * time[:, None]
    by_turned = np.broadcast_to(rows.by_turned[:, None], (*by_y.shape[:2], number))

    def by_inputs(rate: complex, inputs: IntArray, count: int) -> ComplexArray:
        """(rows, times, powers, inputs) by t**power exp(rate t) of inputs."""
        force, power = regime.force[:, inputs], np.arange(count)[:, None]
        answered = answers(root, rate, time, count, decay).transpose(2, 0, 1)
        answered *= (time ** (power + 1)).T[:, :, None]
        by_power = np.tensordot(rows.by_y[:, None, None] * answered, force, 1)
        once = (time ** (power + 2) * turning(rate, time, count)).T[:, :, None]
        by_power += once * (rows.by_turned @ force[:number].real)[:, None, None]
        # With what the inputs give at once, and their derivatives.
        late, once, twice = [time ** np.maximum(power - order, 0) for order in range(3)]
        once, twice = power * once, power * (power - 1) * twice
        inputs_by_order = [late, once + rate * late, twice + 2.0 * rate * once + rate**2 * late]
        given = np.exp(rate * time) * inputs_by_order
        by_power += np.einsum("dkt,dri->rtki", given, rows.by_inputs[:, :, inputs])
        return by_power

    # Without a rate, to as many powers of time as torques that follow the motion have.
    count, every = POINTS if len(train.shape) else 2, np.arange(train.inputs)
    resting = by_inputs(0.0, every, count)
    by_terms = np.zeros((*by_y.shape[:2], 4, len(acting.load)))
    for rate, terms, count in acting.by_rate:
        loads = 1 + acting.load[terms]
        columns = by_inputs(rate, loads, count) if rate else resting[:, :, :count, loads]
        by_terms[:, :, 0 : 2 * count : 2, terms] = columns.real
        by_terms[:, :, 1 : 2 * count : 2, terms] = -columns.imag
    by_steady = resting[:, :, 0, np.append(0, every[train.following.stop :])].real
    blocks = [by_y.real, -by_y.imag, by_turned, by_steady, by_terms]
    if len(train.shape):
        blocks.append(resting[..., train.following].real)
    blocks = [block.reshape(*by_y.shape[:2], math.prod(block.shape[2:])) for block in blocks]
    return np.concatenate(blocks, axis=2)
