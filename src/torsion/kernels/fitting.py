"""Values of a model from measurements with their deviations and a prior: Gauss-Newton, and what the data can say."""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.errors import SolveError

TOLERANCE = 1e-12  # relative, of values and of the sum of squares
COARSE = 1e-3  # the same of a search from another start, until it shows a minimum of its own
NULL = 1e-6  # singular value over the largest below which a direction leaves every measured value as it is
MOST_STEPS = 60
MOST_SEARCHES = 100
FARTHEST = 3.7  # deviations beforehand that a value may move: 1 of 4600 by chance
START = 1.5  # deviations beforehand at which further searches begin
DISTINCT = 0.05  # deviations beforehand by which one value at least differs between two minima
SAME = 1e-6  # of the sum of squares: by as much rounding moves a minimum
# Of the sum of squares, by which data and prior make a minimum 1/20 as likely as the best.
AS_WELL = 6.0


@dataclass(frozen=True)
class Identified:
    """What measurements say of values, from the Jacobian of both in their own deviations.

    A direction with singular value s has, from the data alone, 1/s of its deviation beforehand.
    """

    singular: FloatArray  # (values,) descending; 0 where there are fewer measurements
    directions: FloatArray  # (values, values) a row for each, in prior deviations
    unseen: BoolArray  # (values,) directions that leave every measured value as it is
    # (values, values) of the values in prior deviations, data and prior together.
    covariance: FloatArray

    @property
    def rank(self) -> int:
        """Directions of which the data say anything."""
        return int((~self.unseen).sum())

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
    covariance = directions.T / (1.0 + np.square(padded)) @ directions
    return Identified(padded, directions, padded <= NULL * padded.max(initial=0.0), covariance)


@dataclass(frozen=True)
class Fitted:
    """The values with the least sum of squares, and others that go nearly as well with data and prior."""

    values: FloatArray  # (values,) in prior deviations
    residual: FloatArray  # (measurements,) in their deviations
    jacobian: FloatArray  # (measurements, values) there
    steps: int  # of all searches together
    converged: bool
    searches: int = 1
    others: tuple["Fitted", ...] = ()  # the best first

    @property
    def squares(self) -> float:
        """Sum of the squares of residuals and values, of data and prior together."""
        return float(np.square(self.residual).sum() + np.square(self.values).sum())

    @property
    def minima(self) -> "tuple[Fitted, ...]":
        """This minimum and all others, the best first."""
        return self, *self.others

    @property
    def identity(self) -> Identified:
        """What all minima agree on: the covariance is that of their normal distributions as one, each as likely."""
        identities = [identified(minimum.jacobian) for minimum in self.minima]
        if len(identities) == 1:
            return identities[0]
        values = np.array([minimum.values for minimum in self.minima])
        offset = values - values.mean(axis=0)
        covariance = np.mean([identity.covariance for identity in identities], axis=0)
        covariance += offset.T @ offset / len(identities)
        variance, directions = np.linalg.eigh(covariance)
        changes = np.array(
            [np.linalg.norm(minimum.jacobian @ directions, axis=0) for minimum in self.minima]
        )
        null = NULL * np.array([[identity.singular.max(initial=0.0)] for identity in identities])
        unseen = np.asarray((changes <= null).all(axis=0))
        singular = np.sqrt(np.maximum(1.0 / variance - 1.0, 0.0))
        return Identified(np.where(unseen, 0.0, singular), directions.T, unseen, covariance)

    def interval(self, half: float) -> tuple[FloatArray, FloatArray]:
        """Ends (values,) so many deviations below and above, over this minimum and all others."""
        covariances = [identified(minimum.jacobian).covariance for minimum in self.minima]
        width = half * np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
        middle = np.array([minimum.values for minimum in self.minima])
        return (middle - width).min(axis=0), (middle + width).max(axis=0)


class _KnownMinimum(Exception):
    """A search came to a minimum that another one found."""


def fitted(
    residual: Callable[[FloatArray], FloatArray],
    jacobian: Callable[[FloatArray], FloatArray],
    count: int,
    beyond: Callable[[FloatArray], Iterable[FloatArray]] = lambda _: (),
) -> Fitted:
    """The best of searches from 0, the values beforehand, and from each of them moved by `START` deviations of 1.

    Where a measurement passes from one value to another, as a frequency does where modes cross, each side has a least
    sum of its own, and one search finds the nearer. residual: of values (values,), (measurements,) in their deviations;
    jacobian: (measurements, values); beyond: of a minimum (values,), starts on the other sides of what is near. Nothing
    farther than `FARTHEST` is tried; a start without an answer, other than the first, is left out.

    >>> line = np.array([[1000.0, 0.0], [0.0, 500.0], [300.0, 300.0]])
    >>> found = fitted(lambda p: line @ p - line @ [0.5, -0.25], lambda p: line, 2)
    >>> found.values.round(4), found.searches, found.others
    (array([ 0.5 , -0.25]), 5, ())
    """
    steps, searches = 0, 1

    def slopes(values: FloatArray) -> FloatArray:
        nonlocal steps
        if any(np.abs(values - minimum.values).max() <= DISTINCT for minimum in minima):
            raise _KnownMinimum
        steps += 1
        return jacobian(values)

    minima = list[Fitted]()
    minima.append(_searched(residual, slopes, np.zeros(count), TOLERANCE))
    starts = deque([*START * np.eye(count), *-START * np.eye(count), *beyond(minima[0].values)])
    while starts and searches < MOST_SEARCHES:
        start = starts.popleft()
        searches += 1
        try:
            minimum = _searched(residual, slopes, start, COARSE)
            if (
                minimum.squares
                < min(known_minimum.squares for known_minimum in minima) + 2.0 * AS_WELL
            ):
                minima.append(_searched(residual, slopes, minimum.values, TOLERANCE))
                starts += beyond(minima[-1].values)
        except (SolveError, _KnownMinimum):
            continue
    ranked = sorted(minima, key=lambda minimum: minimum.squares)
    lowest = ranked[0].squares
    # The first minimum is the best if it is as good.
    best = next(minimum for minimum in minima if minimum.squares <= lowest + SAME)
    near_minima = tuple(
        minimum
        for minimum in ranked
        if minimum is not best and minimum.converged and minimum.squares < lowest + AS_WELL
    )
    return replace(best, steps=steps, searches=searches, others=near_minima)


def _searched(
    residual: Callable[[FloatArray], FloatArray],
    jacobian: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    tolerance: float,
) -> Fitted:
    from scipy.optimize import least_squares

    # What is known beforehand are further measurements: each value in its deviations.
    def both(values: FloatArray) -> FloatArray:
        return np.concatenate([residual(values), values])

    def slopes(values: FloatArray) -> FloatArray:
        return np.vstack([jacobian(values), np.eye(len(start))])

    solution: Any = least_squares(
        both,
        start,
        jac=slopes,
        bounds=(-FARTHEST, FARTHEST),
        method="trf",
        xtol=tolerance,
        ftol=tolerance,
        gtol=tolerance,
        max_nfev=MOST_STEPS,
    )
    data = slice(None, -len(start))
    return Fitted(
        solution.x,
        solution.fun[data],
        solution.jac[data],
        int(solution.njev),
        bool(solution.status > 0),
    )
