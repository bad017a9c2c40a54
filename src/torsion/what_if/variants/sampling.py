"""Samples of laws, the same for the same seed, and what they say of a probability."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.what_if.variants.laws import Law

SCRAMBLES = 8  # of Sobol's sequence, whose spread is the error of their mean
LEVEL = 0.95
FEW = 10  # failing, or keeping: with fewer the spread of sequences covers 89 % of counts of Poisson (measured)


@lru_cache(maxsize=2)
def units(count: int, figures: int, method: str, seed: int) -> FloatArray:
    """(count, figures) evenly distributed within 0 and 1; of sobol the scrambled sequences one after another."""
    if method == "random":
        return np.random.default_rng(seed).random((count, figures))
    from scipy.stats import qmc

    if method == "latin":
        return qmc.LatinHypercube(figures, rng=seed).random(count)
    return np.concatenate(
        [
            qmc.Sobol(figures, rng=np.random.default_rng([seed, k])).random(count // SCRAMBLES)
            for k in range(SCRAMBLES)
        ]
    )


def drawn(figures: Sequence[Any], unit: FloatArray) -> FloatArray:
    """Values (count, figures) of figures at samples (count, columns) evenly distributed within 0 and 1."""
    return np.stack([figure.at(unit[:, figure.column]) for figure in figures], axis=1)


def factors(law: Law, unit: FloatArray) -> FloatArray:
    """The figure over that of the file, by the inverse of the law's distribution at `unit` (0 to 1)."""
    from scipy.special import ndtr, ndtri

    if law.uniform is not None:
        return 1.0 + law.uniform * (2.0 * unit - 1.0)
    if law.triangular is not None:
        low, middle, high = law.corners
        wide = high - low
        rising = low + np.sqrt(unit * wide * (middle - low))
        return np.where(
            unit * wide < middle - low,
            rising,
            high - np.sqrt((1.0 - unit) * wide * (high - middle)),
        )
    if law.normal is not None:
        cut = ndtr(-(3.0 if law.within is None else law.within / law.normal))
        return 1.0 + law.normal * ndtri(cut + unit * (1.0 - 2.0 * cut))
    inside = np.clip(unit, 1e-15, 1.0 - 1e-15)
    return np.exp((law.lognormal or 0.0) * ndtri(inside))


def probability(happens: BoolArray, method: str) -> tuple[float, float, float]:
    """Share of the samples (count,) in which something happens, and the ends of its 95 % interval.

    Of sobol by Student's t over its sequences, else by Wilson, and so where fewer than ten samples, or all but as few,
    say so: a probability is never 0 or 1 with certainty.
    """
    share = float(happens.mean())
    low, high = _wilson(int(happens.sum()), happens.size)
    if method == "sobol" and FEW <= happens.sum() <= happens.size - FEW:
        from scipy.special import stdtrit

        shares = happens.reshape(SCRAMBLES, -1).mean(axis=1)
        half = float(
            stdtrit(SCRAMBLES - 1, 0.5 + LEVEL / 2.0) * shares.std(ddof=1) / np.sqrt(SCRAMBLES)
        )
        if half > 0.0:
            low, high = max(share - half, 0.0), min(share + half, 1.0)
    return share, low, high


def _wilson(count: int, size: int) -> tuple[float, float]:
    """The 95 % interval of `count` of `size` independent samples.

    >>> [round(end, 4) for end in _wilson(5, 100)]
    [0.0215, 0.1118]
    """
    from scipy.special import ndtri

    z = float(ndtri(0.5 + LEVEL / 2.0))
    share, extra = count / size, z * z / size
    middle = (share + extra / 2.0) / (1.0 + extra)
    half = z / (1.0 + extra) * float(np.sqrt(share * (1.0 - share) / size + extra / size / 4.0))
    return (0.0 if count == 0 else middle - half), (1.0 if count == size else middle + half)
