"""Values of a model from measurements with their deviations and a prior: Gauss-Newton, and what the data can say."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.arrays import FloatArray

TOLERANCE = 1e-12  # relative, of values and of the sum of squares
NULL = 1e-6  # singular value over the largest below which a direction leaves every measured value as it is
MOST_STEPS = 60
FARTHEST = 3.7  # deviations beforehand that a value may move: 1 of 4600 by chance


@dataclass(frozen=True)
class Identified:
    """What measurements say of values, from the Jacobian of both in their own deviations.

    A direction with singular value s has, from the data alone, 1/s of its deviation beforehand.
    """

    singular: FloatArray  # (values,) descending; 0 where there are fewer measurements
    directions: FloatArray  # (values, values) a row for each, in prior deviations

    @property
    def rank(self) -> int:
        """Directions of which the data say anything."""
        return int((self.singular > NULL * self.singular.max(initial=0.0)).sum())

    @property
    def covariance(self) -> FloatArray:
        """(values, values) of the values in prior deviations, data and prior together."""
        return np.asarray(self.directions.T / (1.0 + np.square(self.singular)) @ self.directions)

    @property
    def used(self) -> float:
        """Values that the data determine: each direction by its share against the prior."""
        square = np.square(self.singular)
        return float((square / (1.0 + square)).sum())


def identified(jacobian: FloatArray) -> Identified:
    """Of a Jacobian (measurements, values), both in their own deviations.

    >>> identified(np.array([[3.0, 3.0]])).rank
    1
    """
    _, singular, directions = np.linalg.svd(jacobian, full_matrices=True)
    padded = np.zeros(jacobian.shape[1])
    padded[: len(singular)] = singular
    return Identified(padded, directions)


@dataclass(frozen=True)
class Fitted:
    """The values with the least sum of squares."""

    values: FloatArray  # (values,) in prior deviations
    residual: FloatArray  # (measurements,) in their deviations
    jacobian: FloatArray  # (measurements, values) there
    steps: int
    converged: bool


def fitted(
    residual: Callable[[FloatArray], FloatArray], jacobian: Callable[[FloatArray], FloatArray], count: int
) -> Fitted:  # fmt: skip
    """From 0, the values beforehand, each with a deviation of 1.

    residual: of values (values,), (measurements,) in their deviations; jacobian: (measurements, values).
    Nothing farther than `FARTHEST` is tried.

    >>> line = np.array([[1000.0, 0.0], [0.0, 500.0], [300.0, 300.0]])
    >>> found = fitted(lambda p: line @ p - line @ [0.5, -0.25], lambda p: line, 2)
    >>> found.values.round(4)
    array([ 0.5 , -0.25])
    """
    from scipy.optimize import least_squares

    def both(values: FloatArray) -> FloatArray:
        return np.concatenate([residual(values), values])

    def slopes(values: FloatArray) -> FloatArray:
        return np.vstack([jacobian(values), np.eye(count)])

    found: Any = least_squares(
        both, np.zeros(count), jac=slopes, bounds=(-FARTHEST, FARTHEST), method="trf",
        xtol=TOLERANCE, ftol=TOLERANCE, gtol=TOLERANCE, max_nfev=MOST_STEPS,
    )  # fmt: skip
    return Fitted(found.x, found.fun[:-count], found.jac[:-count], int(found.njev), bool(found.status > 0))
