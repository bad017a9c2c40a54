"""Quantities of a regime at fixed times since the begin of a step, as one matrix over all that the step begins with.

    quantity = Re(by_y y) + by_turned turned + by_inputs (U, U', U'')
A march meets the same times again and again; a step among them then costs one product.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.motion.closed_answers import (
    DERIVED,
    POINTS,
    TURNED,
    answers,
    answers_and_turning,
    cut_short,
)
from torsion.kernels.motion.linear_regime import Regime
from torsion.kernels.motion.loaded_modes import LoadedModes, Start
from torsion.kernels.motion.torque_history import Acting

EYE = np.eye(POINTS)[:, :, None]
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
        answered, turning = answers_and_turning(root, rate, time, count, decay)
        turned = rows.by_turned @ force[:number].real
        powers, growth = rate**ORDERS, np.exp(rate * time)[:, None]
        columns = []
        for power in range(count):
            # Derivatives of exp(rate t), or of t exp(rate t).
            value = powers if power == 0 else time[:, None] * powers
            value = value + power * ORDERS * np.append(0.0, powers[:-1])
            column = np.einsum("td,dri->rti", growth * value, rows.by_inputs[:, :, inputs])
            column = column + turned[:, None] * turning[power][:, None]
            forced = rows.by_y[:, None] * answered[power].T
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

    if len(
        train.shape
    ):  # (rows, times, coefficients, interfaces) by the torques that follow the motion
        share = time / length
        force, by_value = (
            matrix[..., train.following] for matrix in (regime.force, rows.by_inputs)
        )
        forced = (rows.by_y[:, :, None] * force).transpose(0, 2, 1)
        answer = time * answers(root[:, None] * time)
        # (rows, interfaces, coefficients, times) of what has acted so far
        by_local = np.tensordot(forced, answer, (2, 1)).real
        turned = rows.by_turned @ force[:number].real
        by_local[:, :, :2] += np.multiply.outer(turned, np.multiply.outer(TURNED, time**2))
        by_local += by_value[0][:, :, None, None]  # every local polynomial ends with 1
        by_series = np.einsum("rflt,lkt->rtkf", by_local, cut_short(EYE, share))
        basis = legendre.legvander(2.0 * share - 1.0, POINTS - 1)
        for order in (1, 2):
            derived = basis @ DERIVED[order] * (2.0 / length) ** order
            by_series += np.einsum("rf,tk->rtkf", by_value[order], derived)
        blocks.append(by_series.reshape(*by_y.shape[:2], -1))
    return np.concatenate(blocks, axis=2)
