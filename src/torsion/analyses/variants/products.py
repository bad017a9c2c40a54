"""How figures of the file enter the numbers of a train: as products of their powers, which trials show."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import FloatArray
from torsion.errors import InputError, SolveError
from torsion.study import Study, Variation

TRIALS = (1.07, 0.96)  # factors at which a figure is tried
POWER = 1e-11  # relative, within which the numbers are products of powers of the figures
Rows = NDArray[Any]  # (rows, samples) numbers of a train; the samples of a row vary as one


@dataclass(frozen=True)
class Products:
    """Rows of numbers with the powers in which the figures enter them."""

    power: FloatArray  # (rows, figures)
    nominal: FloatArray  # (figures,) values of the file

    def factors(self, values: FloatArray) -> FloatArray:
        """(rows, variants) of the rows over those of the file, at values (variants, figures)."""
        return np.asarray(np.exp(self.power @ np.log(values / self.nominal).T))


def products(variation: Variation, values: FloatArray, read: Callable[[Study], Rows | None]) -> Products | None:
    """How the values (variants, figures) enter the rows that are read of a study; None where otherwise.

    read: None where the study differs in more than its rows. Figures of one component are read at the ends of their
    values together as well, and so is the last variant: each may be sound by itself, and not beside another.
    """
    nominal = np.array([np.nan if one.rows else one.nominal for one in variation.figures])
    if not np.all(np.isfinite(nominal) & (nominal != 0.0)) or not np.all(values / nominal > 0.0):
        return None

    def tried(row: FloatArray) -> Rows | None:
        try:
            return read(variation.study(row.tolist()))
        except (InputError, SolveError):
            return None

    base, power = tried(nominal), []
    for place in range(len(nominal)):
        each = [tried(np.where(np.arange(len(nominal)) == place, one, 1.0) * nominal) for one in TRIALS]
        found = None if base is None else _power(base, each)
        if found is None:
            return None
        power.append(found)
    whole = Products(np.stack(power, axis=1), nominal)
    for row in (*_corners(variation, values, nominal), values[-1]):
        rows = tried(row)
        if base is None or rows is None or not _same(base * whole.factors(row[None]), rows):
            return None
    return whole


def _corners(variation: Variation, values: FloatArray, nominal: FloatArray) -> Iterator[FloatArray]:
    """(figures,) values with two figures of one component at each end of theirs, all others as in the file."""
    component = [one.name.rpartition(".")[0] for one in variation.figures]
    ends = values.min(axis=0), values.max(axis=0)
    for one, other in combinations(range(len(nominal)), 2):
        for first, second in product(ends, ends) if component[one] == component[other] else ():
            row = nominal.copy()
            row[one], row[other] = first[one], second[other]
            yield row


def _same(one: Rows, other: Rows) -> bool:
    return one.shape == other.shape and bool(np.allclose(one, other, rtol=POWER, atol=0.0, equal_nan=True))


def _power(base: Rows, tried: list[Rows | None]) -> FloatArray | None:
    """(rows,) power of a figure in every row; None where it enters otherwise."""
    first, used = tried[0], (base != 0.0) & np.isfinite(base)
    if first is None or first.shape != base.shape:
        return None
    with np.errstate(all="ignore"):
        each = np.where(used, np.log(np.abs(first / base)) / np.log(TRIALS[0]), -np.inf).max(axis=1)
    power = np.where(used.any(axis=1), np.round(each, 9), 0.0)
    for factor, rows in zip(TRIALS, tried, strict=True):
        if rows is None or not np.isfinite(power).all() or not _same(base * (factor**power)[:, None], rows):
            return None
    return power
