"""Quantities of a regime at fixed times since the begin of a step, as one matrix over all that the step begins with.

    quantity = Re(by_y y) + by_turned turned + by_inputs (U, U', U'')
A march meets the same times again and again; a step among them then costs one product.
"""

from typing import NamedTuple

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.motion.closed_answers import POINTS, answers, turning
from torsion.kernels.motion.linear_regime import Regime
from torsion.kernels.motion.loaded_modes import LoadedModes, Start
from torsion.kernels.motion.torque_history import Acting

ORDERS = np.arange(3)  # of derivatives of inputs


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


def features(train: LoadedModes, interval: int, start: Start) -> FloatArray:
    """All that a step begins with, in the order of the columns of `sample`, without torques that follow the motion."""
    history = train.history
    level, slope = history.acting[interval].later(start.time - history.begin[interval])
    terms = (level.real, level.imag, slope.real, slope.imag)
    first = (start.y.real, start.y.imag, start.turned, np.ones((1, 1)), start.offset)
    return np.concatenate([*first, *terms])[:, 0]


def sample(
    regime: Regime, acting: Acting, rows: Rows, time: FloatArray, length: float
) -> FloatArray:
    """(rows, times, features) at times (s) of a step of a length."""
    train, root, number = regime.train, regime.root, regime.free.shape[1]
    decay = np.exp(np.multiply.outer(root, time))
    by_y = rows.by_y[:, None] * decay.T
    by_y[:, :, :number] += rows.by_turned[:, None] * time[:, None]
    by_turned = np.broadcast_to(rows.by_turned[:, None], (*by_y.shape[:2], number))

    def by_inputs(rate: complex, inputs: IntArray, count: int) -> list[ComplexArray]:
        """(rows, times, inputs) by levels, and by slopes where `count` is 2."""
        force = regime.force[:, inputs]
        answered, once = answers(root, rate, time, count, decay), turning(rate, time, count)
        turned = rows.by_turned @ force[:number].real
        powers, growth = rate**ORDERS, np.exp(rate * time)[:, None]
        columns = []
        for power in range(count):
            # Derivatives of exp(rate t), or of t exp(rate t).
            value = powers if power == 0 else time[:, None] * powers
            value = value + power * ORDERS * np.append(0.0, powers[:-1])
            column = np.einsum("td,dri->rti", growth * value, rows.by_inputs[:, :, inputs])
            column = column + turned[:, None] * (time ** (power + 2) * once[power])[:, None]
            forced = rows.by_y[:, None] * (time ** (power + 1) * answered[power]).T
            columns.append(column + forced @ force)
        return columns

    steady = np.append(0, np.arange(train.following.stop, train.inputs))
    (by_steady,) = by_inputs(0.0, steady, 1)
    by_terms = np.zeros((*by_y.shape[:2], 4 * len(acting.load)))
    for rate, terms, count in acting.by_rate:
        for power, column in enumerate(by_inputs(rate, 1 + acting.load[terms], count)):
            by_terms[:, :, terms + 2 * power * len(acting.load)] = column.real
            by_terms[:, :, terms + (2 * power + 1) * len(acting.load)] = -column.imag
    blocks = [by_y.real, -by_y.imag, by_turned, by_steady.real, by_terms]

    if len(train.shape):
        # (rows, times, powers, interfaces) by the torques that follow the motion
        power, share, following = np.arange(POINTS), time[:, None] / length, train.following
        force = regime.force[:, following]
        answered = answers(root, 0.0, time, POINTS, decay) * time
        by_powers = np.einsum("rc,kct,cf->rtkf", rows.by_y, answered, force, optimize=True).real
        turned = rows.by_turned @ force[:number].real
        by_powers += (time[:, None] ** 2 * turning(0.0, time, POINTS).T)[:, :, None] * turned[
            :, None, None
        ]
        by_powers *= (share**power)[:, :, None]
        factor, lower = np.ones(POINTS), power
        for by_value in rows.by_inputs[:, :, following]:
            by_powers += (factor * share**lower)[:, :, None] * by_value[:, None, None]
            factor, lower = factor * lower / length, np.maximum(lower - 1, 0)
        blocks.append(by_powers.reshape(*by_y.shape[:2], -1))
    return np.concatenate(blocks, axis=2)
