"""How figures of the file enter the numbers of a train, as trials show: by powers, in sums, as angles of phasors."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray
from torsion.errors import InputError, SolveError
from torsion.study import Study, Variation

TRIALS = (1.07, 0.96, 1.03, 0.93)  # factors at which a figure is tried
TURNED = 1e-9  # rad, from which a trial turns a phasor
POWER = 1e-11  # relative, within which the numbers are products of powers of the figures
OF_SUMS = (
    1.0,
    -1.0,
    4.0,
    -4.0,
    3.0,
    -3.0,
    2.0,
    -2.0,
    -0.2,
)  # powers of a figure in a sum; the last of a size factor
BESIDE = (0.0, -1.0, 1.0, -2.0, 2.0, -3.0, 3.0, -4.0, 4.0)  # powers beside the sum
Rows = NDArray[Any]  # (rows, samples) numbers of a train; the samples of a row vary as one


@dataclass(frozen=True)
class Products:
    """Rows of numbers, and how the figures enter them.

    A figure x of the value X in the file makes a row (x/X)**power times what it is there; a row that is a sum, such as
    the inertia of a shaft beside a disc, it makes (1 + share ((x/X)**term - 1))**root times that. A figure that turns
    some rows, as a phase does, changes no other row, and may have any sign.
    """

    power: FloatArray  # (rows, figures)
    share: (
        FloatArray  # (rows, figures) of the term of the sum that has the figure; 0: it is in none
    )
    term: FloatArray  # (rows, figures) power of the figure in the term
    root: FloatArray  # (rows,) 1, or -1: one over the sum
    turn: FloatArray  # (rows, figures) angle for each unit of the figure, rad
    nominal: FloatArray  # (figures,) values of the file
    component: tuple[
        int, ...
    ]  # (figures,) those of one component that have one share of a row are in one term of it

    def factors(self, values: FloatArray) -> Rows:
        """(rows, variants) of the rows over those of the file, at values (variants, figures), maybe complex."""
        turns = np.asarray(self.turn.any(axis=0))
        logs = np.log(np.where(turns, 1.0, values / self.nominal).T)
        found = np.exp(self.power @ logs)
        for row in np.flatnonzero(self.share.any(axis=1)).tolist():
            more = sum(share * np.expm1(term @ logs) for share, term in self._terms(row))
            found[row] *= (1.0 + more) ** self.root[row]
        if turns.any():
            return np.asarray(found * np.exp(1j * (self.turn @ (values - self.nominal).T)))
        return np.asarray(found)

    def slopes(self, values: FloatArray) -> Rows:
        """(rows, figures) of the logarithm of each row by that of each figure, at values (figures,), maybe complex."""
        logs = np.log(np.where(self.turn.any(axis=0), 1.0, values / self.nominal))
        found: Rows = self.power.copy()
        for row in np.flatnonzero(self.share.any(axis=1)).tolist():
            terms = [(share * np.exp(term @ logs), share, term) for share, term in self._terms(row)]
            whole = 1.0 + sum(now - share for now, share, _ in terms)
            found[row] += self.root[row] * sum(now * term for now, _, term in terms) / whole
        return found + 1j * self.turn * values if self.turn.any() else found

    def _terms(self, row: int) -> Iterator[tuple[float, FloatArray]]:
        """Share and powers (figures,) of the terms of a sum that have figures."""
        share, left = self.share[row], self.share[row] != 0.0
        while left.any():
            first = int(left.argmax())
            own = left & (np.array(self.component) == self.component[first])
            own &= np.isclose(share, share[first], rtol=1e-9, atol=0.0)
            yield float(share[first]), np.where(own, self.term[row], 0.0)
            left = left & ~own


NO_ROWS = np.empty((0, 0))
UNCHANGED = Products(NO_ROWS, NO_ROWS, NO_ROWS, np.empty(0), NO_ROWS, np.empty(0), ())  # no figure


def products(
    variation: Variation, values: FloatArray, read: Callable[[Study], Rows | None]
) -> Products | None:
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

    base, enters = tried(nominal), list[tuple[FloatArray, ...]]()
    for place in range(len(nominal)):
        each = [
            tried(np.where(np.arange(len(nominal)) == place, one, 1.0) * nominal) for one in TRIALS
        ]
        found = None if base is None else _entry(base, each, float(nominal[place]))
        if found is None:
            return None
        enters.append(found)
    power, share, term, root, turn = (np.stack(own, axis=1) for own in zip(*enters, strict=True))
    turns = turn.any(axis=0)
    if (
        power[:, turns].any()
        or share[:, turns].any()
        or not np.all((values / nominal > 0.0) | turns)
    ):
        return None
    if ((root < 0.0).any(axis=1) & ((share != 0.0) & (root > 0.0)).any(axis=1)).any():
        return None
    whole = Products(power, share, term, root.min(axis=1), turn, nominal, components(variation))
    for row in (*_corners(variation, values, nominal), values[-1]):
        rows = tried(row)
        if base is None or rows is None or not _same(base * whole.factors(row[None]), rows):
            return None
    return whole


def _corners(variation: Variation, values: FloatArray, nominal: FloatArray) -> Iterator[FloatArray]:
    """(figures,) values with one figure, or two of one component, at each end of theirs, all others as in the file."""
    component, ends = components(variation), (values.min(axis=0), values.max(axis=0))
    for one, end in product(range(len(nominal)), ends):
        yield np.where(np.arange(len(nominal)) == one, end, nominal)
    for one, other in combinations(range(len(nominal)), 2):
        for first, second in product(ends, ends) if component[one] == component[other] else ():
            row = nominal.copy()
            row[one], row[other] = first[one], second[other]
            yield row


def _same(one: Rows, other: Rows) -> bool:
    return one.shape == other.shape and bool(_alike(one, other).all())


def components(variation: Variation) -> tuple[int, ...]:
    """(figures,) a number for each component whose figures vary."""
    names = [one.name.rpartition(".")[0] for one in variation.figures]
    return tuple(names.index(name) for name in names)


def _entry(base: Rows, tried: list[Rows | None], nominal: float) -> tuple[FloatArray, ...] | None:
    """(rows,) power, share, power in the term, root, and turn of a figure; None where a row has it otherwise."""
    rows = [one for one in tried if one is not None and one.shape == base.shape]
    if len(rows) < len(TRIALS):
        return None
    each, largest = (
        np.arange(len(base)),
        np.where(np.isfinite(base), np.abs(base), -1.0).argmax(axis=1),
    )
    with np.errstate(all="ignore"):
        ratio = np.array([one[each, largest] / base[each, largest] for one in rows])
        ratio[:, (base[each, largest] == 0.0) | ~np.isfinite(base[each, largest])] = 1.0
        if not all(
            _alike(base * own[:, None], one).all() for own, one in zip(ratio, rows, strict=True)
        ):
            return None  # nothing is where nothing was, and the samples of a row vary as one
    factor, angle = np.array(TRIALS)[:, None], np.angle(ratio[0])
    turn = np.where(np.abs(angle) > TURNED, angle / ((TRIALS[0] - 1.0) * nominal), 0.0)
    power = np.where(turn == 0.0, np.round(np.log(np.abs(ratio[0])) / np.log(TRIALS[0]), 9), 0.0)
    share, term, root = np.zeros_like(power), np.zeros_like(power), np.ones_like(power)
    left = np.flatnonzero(
        ~_close(factor**power * np.exp(1j * turn * (factor - 1.0) * nominal), ratio)
    )
    for beside, one, over in product(BESIDE, OF_SUMS, (1.0, -1.0)) if left.size else ():
        plain, own = np.abs(ratio[:, left]) / factor**beside, factor**one - 1.0
        part = (plain[0] ** over - 1.0) / own[0]
        fits = _close((1.0 + part * own) ** over, plain) & (turn[left] == 0.0)
        power[left[fits]], share[left[fits]], term[left[fits]], root[left[fits]] = (
            beside,
            part[fits],
            one,
            over,
        )
        left = left[~fits]
    return None if left.size else (power, share, term, root, turn)


def _close(model: Rows, ratio: Rows) -> BoolArray:
    """(rows,) where a model of the trials (trials, rows) is what they are."""
    return np.asarray((np.abs(model - ratio) <= POWER * np.abs(ratio)).all(axis=0))


def _alike(one: Rows, other: Rows) -> BoolArray:
    """(rows,) which rows are the same."""
    return np.asarray(np.isclose(one, other, rtol=POWER, atol=0.0, equal_nan=True).all(axis=1))
