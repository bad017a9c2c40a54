"""How figures of the file enter the numbers of a train, as trials show: by powers, in a sum, as angles of phasors."""

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
TURNED = 1e-9  # rad, from which a trial turns a phasor
POWER = 1e-11  # relative, within which the numbers are products of powers of the figures
Rows = NDArray[Any]  # (rows, samples) numbers of a train; the samples of a row vary as one


@dataclass(frozen=True)
class Products:
    """Rows of numbers with the powers in which the figures enter them, or the share of each in a row that is a sum.

    A figure that turns some rows, as a phase does, changes no other row, and may have any sign.
    """

    power: FloatArray  # (rows, figures); NaN in some place of a row that is no product
    share: FloatArray  # (rows, figures), of the value in the file
    nominal: FloatArray  # (figures,) values of the file
    turn: FloatArray  # (rows, figures) angle for each unit of the figure, rad

    def factors(self, values: FloatArray) -> Rows:
        """(rows, variants) of the rows over those of the file, at values (variants, figures), maybe complex."""
        turns = np.asarray(self.turn.any(axis=0))
        factor, is_sum = np.where(turns, 1.0, values / self.nominal).T, np.asarray(np.isnan(self.power).any(axis=1))
        found = np.exp(np.where(is_sum[:, None], 0.0, self.power) @ np.log(factor))
        found[is_sum] = 1.0 + self.share[is_sum] @ (factor - 1.0)
        if turns.any():
            return np.asarray(found * np.exp(1j * (self.turn @ (values - self.nominal).T)))
        return np.asarray(found)

    def slopes(self, values: FloatArray) -> Rows:
        """(rows, figures) of the logarithm of each row by that of each figure, at values (figures,), maybe complex."""
        factor, is_sum = values / self.nominal, np.asarray(np.isnan(self.power).any(axis=1))
        found: Rows = np.where(is_sum[:, None], 0.0, self.power)
        part = self.share[is_sum] * factor
        found[is_sum] = part / (1.0 + self.share[is_sum] @ (factor - 1.0))[:, None]
        return found + 1j * self.turn * values if self.turn.any() else found


def products(variation: Variation, values: FloatArray, read: Callable[[Study], Rows | None]) -> Products | None:
    """How the values (variants, figures) enter the rows that are read of a study; None where otherwise than known.

    read: None where the study differs in more than its rows. Every figure is read at the ends of its values as well, as
    a limit may be capped there; those of one component together, and so is the last variant: each may be sound by
    itself, and not beside another.
    """
    nominal = np.array([np.nan if one.rows else one.nominal for one in variation.figures])
    if not np.all(np.isfinite(nominal) & (nominal != 0.0)):
        return None

    def tried(row: FloatArray) -> Rows | None:
        try:
            return read(variation.study(row.tolist()))
        except (InputError, SolveError):
            return None

    base, enters = tried(nominal), []
    for place in range(len(nominal)):
        each = [tried(np.where(np.arange(len(nominal)) == place, one, 1.0) * nominal) for one in TRIALS]
        found = None if base is None else _power_and_share(base, each, float(nominal[place]))
        if found is None:
            return None
        enters.append(found)
    power, share, turn = (np.stack(own, axis=1) for own in zip(*enters, strict=True))
    whole, turns = Products(power, share, nominal, turn), turn.any(axis=0)
    if np.nan_to_num(power[:, turns], nan=1.0).any() or not np.all((values / nominal > 0.0) | turns):
        return None
    if np.isnan(whole.factors(nominal[None])).any():
        return None
    for row in (*_corners(variation, values, nominal), values[-1]):
        rows = tried(row)
        if base is None or rows is None or not _same(base * whole.factors(row[None]), rows):
            return None
    return whole


def _corners(variation: Variation, values: FloatArray, nominal: FloatArray) -> Iterator[FloatArray]:
    """(figures,) values with one figure, or two of one component, at each end of theirs, all others as in the file."""
    component = [one.name.rpartition(".")[0] for one in variation.figures]
    ends = values.min(axis=0), values.max(axis=0)
    for one, end in product(range(len(nominal)), ends):
        yield np.where(np.arange(len(nominal)) == one, end, nominal)
    for one, other in combinations(range(len(nominal)), 2):
        for first, second in product(ends, ends) if component[one] == component[other] else ():
            row = nominal.copy()
            row[one], row[other] = first[one], second[other]
            yield row


def _same(one: Rows, other: Rows) -> bool:
    return one.shape == other.shape and bool(_alike(one, other).all())


def _power_and_share(
    base: Rows, tried: list[Rows | None], nominal: float
) -> tuple[FloatArray, FloatArray, FloatArray] | None:  # fmt: skip
    """(rows,) power of a figure in every row, its share of it, and the angle for each unit; NaN where otherwise.

    None where there is no trial.
    """
    rows = [one for one in tried if one is not None and one.shape == base.shape]
    if len(rows) < len(TRIALS):
        return None
    used = (base != 0.0) & np.isfinite(base)
    with np.errstate(all="ignore"):
        angle = np.where(used, np.angle(rows[0] / base), 0.0)
        turn = np.where(np.abs(angle) > TURNED, angle, 0.0)[np.arange(len(base)), np.abs(angle).argmax(axis=1)]
        turn /= (TRIALS[0] - 1.0) * nominal
        first = np.where(used, np.real(rows[0] / base), -np.inf).max(axis=1)
        power = np.where(used.any(axis=1), np.round(np.log(first) / np.log(TRIALS[0]), 9), 0.0)
        share = np.where(used.any(axis=1), (first - 1.0) / (TRIALS[0] - 1.0), 0.0)
        for factor, one in zip(TRIALS, rows, strict=True):
            power[~_alike(base * (factor**power)[:, None], one)] = np.nan
            share[~_alike(base * (1.0 + share * (factor - 1.0))[:, None], one)] = np.nan
            turned = base * np.exp(1j * turn * (factor - 1.0) * nominal)[:, None]
            turn[~_alike(turned, one) & (turn != 0.0)] = np.nan
    power[turn != 0.0] = np.where(np.isnan(turn[turn != 0.0]), np.nan, 0.0)
    return power, share, np.nan_to_num(turn)


def _alike(one: Rows, other: Rows) -> BoolArray:
    """(rows,) which rows are the same."""
    return np.asarray(np.isclose(one, other, rtol=POWER, atol=0.0, equal_nan=True).all(axis=1))
