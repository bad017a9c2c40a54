"""How figures of the file enter the numbers of a train: as products of their powers or in a sum, which trials show."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray
from torsion.errors import InputError, SolveError
from torsion.study import Study, Variation

TRIALS = (1.07, 0.96)  # factors at which a figure is tried
POWER = 1e-11  # relative, within which the numbers are products of powers of the figures
Rows = NDArray[Any]  # (rows, samples) numbers of a train; the samples of a row vary as one


@dataclass(frozen=True)
class Products:
    """Rows of numbers with the powers in which the figures enter them, or the share of each in a row that is a sum."""

    power: FloatArray  # (rows, figures); NaN in some place of a row that is no product
    share: FloatArray  # (rows, figures), of the value in the file
    nominal: FloatArray  # (figures,) values of the file

    def factors(self, values: FloatArray) -> FloatArray:
        """(rows, variants) of the rows over those of the file, at values (variants, figures)."""
        factor, is_sum = (values / self.nominal).T, np.asarray(np.isnan(self.power).any(axis=1))
        found = np.exp(np.where(is_sum[:, None], 0.0, self.power) @ np.log(factor))
        found[is_sum] = 1.0 + self.share[is_sum] @ (factor - 1.0)
        return np.asarray(found)


def products(variation: Variation, values: FloatArray, read: Callable[[Study], Rows | None]) -> Products | None:
    """How the values (variants, figures) enter the rows that are read of a study; None where otherwise than known.

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

    base, enters = tried(nominal), []
    for place in range(len(nominal)):
        each = [tried(np.where(np.arange(len(nominal)) == place, one, 1.0) * nominal) for one in TRIALS]
        found = None if base is None else _power_and_share(base, each)
        if found is None:
            return None
        enters.append(found)
    power, share = (np.stack(own, axis=1) for own in zip(*enters, strict=True))
    whole = Products(power, share, nominal)
    if np.isnan(whole.factors(nominal[None])).any():
        return None
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
    return one.shape == other.shape and bool(_alike(one, other).all())


def _power_and_share(base: Rows, tried: list[Rows | None]) -> tuple[FloatArray, FloatArray] | None:
    """(rows,) power of a figure in every row, and its share of it; NaN where it enters otherwise.

    None where there is no trial.
    """
    rows = [one for one in tried if one is not None and one.shape == base.shape]
    if len(rows) < len(TRIALS):
        return None
    used = (base != 0.0) & np.isfinite(base)
    with np.errstate(all="ignore"):
        first = np.where(used, np.real(rows[0] / base), -np.inf).max(axis=1)
        power = np.where(used.any(axis=1), np.round(np.log(first) / np.log(TRIALS[0]), 9), 0.0)
        share = np.where(used.any(axis=1), (first - 1.0) / (TRIALS[0] - 1.0), 0.0)
        for factor, one in zip(TRIALS, rows, strict=True):
            power[~_alike(base * (factor**power)[:, None], one)] = np.nan
            share[~_alike(base * (1.0 + share * (factor - 1.0))[:, None], one)] = np.nan
    return power, share


def _alike(one: Rows, other: Rows) -> BoolArray:
    """(rows,) which rows are the same."""
    return np.asarray(np.isclose(one, other, rtol=POWER, atol=0.0, equal_nan=True).all(axis=1))
