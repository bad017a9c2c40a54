"""Quantities of a regime at fixed times since the begin of a step, as one matrix over all that the step begins with.

    quantity = Re(by_y y) + by_turned turned + by_inputs (U, U', U'')
A march meets the same times again and again; a step among them then costs one product.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.motion.regimes.exponential_answers import answers_and_turning
from torsion.kernels.motion.regimes.linear_regime import Regime
from torsion.kernels.motion.regimes.modal_loads import Acting, LoadedModes, Start
from torsion.kernels.motion.torques.polynomial_torques import (
    DERIVED,
    POINTS,
    TURNED,
    answers,
    cut_short,
)

ORDERS = np.arange(3)  # of derivatives of inputs
EYE = np.eye(POINTS)[:, :, None]


@dataclass(frozen=True)
class Rows:
    """Quantities over coordinates, positions of what nothing holds, and inputs."""

    by_y: ComplexArray  # (rows, coordinates)
    by_turned: FloatArray  # (rows, motions that nothing holds)
    by_inputs: FloatArray  # (orders, rows, inputs)


def rows_of(regime: Regime, values: FloatArray) -> Rows:
    """Quantities that are rows over positions, speeds, inputs and their rates."""
    n, m = regime.train.motions, regime.train.inputs
    position, speed, inputs, rates = np.split(values, [n, 2 * n, 2 * n + m], axis=1)
    by_inputs = np.stack([inputs + position @ regime.constraint, rates, 0.0 * rates])
    return Rows(regime.reading(position, speed), position @ regime.free, by_inputs)


def rates_of(regime: Regime, rows: Rows) -> Rows:
    """Rates of quantities that have no second derivatives of inputs."""
    by_y = rows.by_y * regime.root
    by_y[:, : rows.by_turned.shape[1]] += rows.by_turned
    forced = (rows.by_y @ regime.force).real
    by_inputs = np.concatenate([forced[None], rows.by_inputs[:2]])
    return Rows(by_y, 0.0 * rows.by_turned, by_inputs)


def together(*several: Rows) -> Rows:
    """Rows of all, one below the other."""
    return Rows(
        np.concatenate([rows.by_y for rows in several]),
        np.concatenate([rows.by_turned for rows in several]),
        np.concatenate([rows.by_inputs for rows in several], axis=1),
    )


def features(train: LoadedModes, start: Start) -> FloatArray:
    """All that a step begins with, in the order of the columns of `sample`, without torques that follow the motion."""
    acting = train.acting[start.interval]
    level, slope = acting.later(start.time - train.history.begin[start.interval])
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
        answers, turning = answers_and_turning(root, rate, time, count, decay)
        turned = rows.by_turned @ force[:number].real
        powers, growth = rate**ORDERS, np.exp(rate * time)[:, None]
        columns = []
        for power in range(count):
            # Derivatives of exp(rate t), or of t exp(rate t).
            value = powers if power == 0 else time[:, None] * powers
            value = value + power * ORDERS * np.append(0.0, powers[:-1])
            column = np.einsum("td,dri->rti", growth * value, rows.by_inputs[:, :, inputs])
            column = column + turned[:, None] * turning[power][:, None]
            forced = rows.by_y[:, None] * answers[power].T
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
        blocks.append(_by_series(regime, rows, time, length).reshape(*by_y.shape[:2], -1))
    return np.concatenate(blocks, axis=2)


def _by_series(regime: Regime, rows: Rows, time: FloatArray, length: float) -> FloatArray:
    """(rows, times, coefficients, interfaces)."""
    following, share = regime.train.following, time / length
    force, by_value = regime.force[:, following], rows.by_inputs[:, :, following]
    forced = (rows.by_y[:, :, None] * force).transpose(0, 2, 1)
    answer = time * answers(regime.root[:, None] * time)
    by_local = np.tensordot(forced, answer, (2, 1)).real  # (rows, interfaces, coefficients, times)
    turned = rows.by_turned @ force[: regime.free.shape[1]].real
    by_local[:, :, :2] += np.multiply.outer(turned, np.multiply.outer(TURNED, time**2))
    by_local += by_value[0][:, :, None, None]  # every local polynomial ends with 1
    by_series = np.einsum("rflt,lkt->rtkf", by_local, cut_short(EYE, share))
    basis = legendre.legvander(2.0 * share - 1.0, POINTS - 1)
    for order in (1, 2):
        derived = basis @ DERIVED[order] * (2.0 / length) ** order
        by_series += np.einsum("rf,tk->rtkf", by_value[order], derived)
    return np.asarray(by_series)
