"""Values of a model from measurements with their deviations and a prior: Gauss-Newton, and what the data can say."""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
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
AS_WELL = 6.0  # of the sum of squares, by which data and prior make a minimum 1/20 as likely as the best


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
        """Of data and prior together."""
        return float(np.square(self.residual).sum() + np.square(self.values).sum())

    def interval(self, half: float) -> tuple[FloatArray, FloatArray]:
        """Ends (values,) so many deviations below and above, over this minimum and all others."""
        minima = (self, *self.others)
        each = half * np.array([np.sqrt(np.diag(identified(one.jacobian).covariance)) for one in minima])
        middle = np.array([one.values for one in minima])
        return (middle - each).min(axis=0), (middle + each).max(axis=0)


class _KnownMinimum(Exception):
    """A search came to a minimum that another one found."""


def fitted(
    residual: Callable[[FloatArray], FloatArray], jacobian: Callable[[FloatArray], FloatArray], count: int,
    beyond: Callable[[FloatArray], Iterable[FloatArray]] = lambda _: (),
) -> Fitted:  # fmt: skip
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
        steps += 1
        return jacobian(values)

    def new(values: FloatArray) -> FloatArray:
        if any(float(np.abs(values - one.values).max()) <= DISTINCT for one in found):
            raise _KnownMinimum
        return slopes(values)

    found = [_searched(residual, slopes, np.zeros(count), TOLERANCE)]
    starts = deque([*START * np.eye(count), *-START * np.eye(count), *beyond(found[0].values)])
    while starts and searches < MOST_SEARCHES:
        start = starts.popleft()
        searches += 1
        try:
            one = _searched(residual, new, start, COARSE)
            if one.squares < min(known.squares for known in found) + 2.0 * AS_WELL:
                found.append(_searched(residual, new, one.values, TOLERANCE))
                starts += beyond(found[-1].values)
        except (SolveError, _KnownMinimum):
            continue
    least = min(one.squares for one in found)
    best = next(one for one in found if one.squares <= least + SAME)  # the first, where it is as good
    rest = sorted((one for one in found if one is not best), key=lambda one: one.squares)
    others = (one for one in rest if one.converged and one.squares < least + AS_WELL)
    return replace(best, steps=steps, searches=searches, others=tuple(others))


def _searched(
    residual: Callable[[FloatArray], FloatArray], jacobian: Callable[[FloatArray], FloatArray], start: FloatArray,
    tolerance: float,
) -> Fitted:  # fmt: skip
    from scipy.optimize import least_squares

    def both(values: FloatArray) -> FloatArray:
        return np.concatenate([residual(values), values])

    def slopes(values: FloatArray) -> FloatArray:
        return np.vstack([jacobian(values), np.eye(len(start))])

    found: Any = least_squares(
        both, start, jac=slopes, bounds=(-FARTHEST, FARTHEST), method="trf",
        xtol=tolerance, ftol=tolerance, gtol=tolerance, max_nfev=MOST_STEPS,
    )  # fmt: skip
    data = slice(None, -len(start))
    return Fitted(found.x, found.fun[data], found.jac[data], int(found.njev), bool(found.status > 0))
