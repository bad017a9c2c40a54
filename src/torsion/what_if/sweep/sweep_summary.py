"""What all variants of a sweep say together: spreads, probabilities, and which figure decides."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.study import Variation
from torsion.what_if.sweep.grid_summary import grid_of
from torsion.what_if.sweep.sobol_indices import sobol_indices
from torsion.what_if.sweep.sweep_points import Points
from torsion.what_if.sweep.sweep_results import Sweep, SweptCheck, VariedFigure
from torsion.what_if.sweep.sweep_settings import SweepSettings
from torsion.what_if.variants.one_by_one import Answers, Key
from torsion.what_if.variants.sampling import probability, quantiles

LEAST_SPREAD = 1e-9  # of a share of a limit: below it nothing decides
MOST_FAULTS = 10


def summed(
    variation: Variation,
    settings: SweepSettings,
    points: Points,
    factor: FloatArray,
    nominal: FloatArray,
    answers: Answers,
) -> Sweep:
    """Statistics of what all variants (variants, figures) gave; nominal: frequencies of the file (modes,) Hz."""
    indices = () if points.sets == 1 else sobol_indices(points, answers)
    factor, frequency = factor[: points.samples], answers.frequency[:, : points.samples]
    lines = {
        key: (used[: points.samples], fails[: points.samples])
        for key, (used, fails) in answers.checks.items()
    }
    faults = {place: why for place, why in answers.faults.items() if place < points.samples}
    names = [one.name for one in variation.figures]
    unsolved = np.zeros(len(factor), dtype=np.bool_)
    unsolved[list(faults)] = True
    checks = [
        _check(key, used, fails | unsolved, factor, names, points.method)
        for key, (used, fails) in lines.items()
    ]
    checks.sort(key=lambda one: (-one.probability, -(one.worst or 0.0)))
    whole = None
    if lines:
        used = np.fmax.reduce([one.utilisation for one in checks])
        fails = np.any([one.fails for one in checks], axis=0)
        whole = _check(("", "", "", "any check"), used, fails, factor, names, points.method)
    known = frequency[:, np.isfinite(frequency).all(axis=0)] if frequency.size else frequency
    known = known if known.size else np.full((len(nominal), 1), np.nan)
    low, high = quantiles(known, (0.025, 0.975)).T.reshape(2, -1)
    return Sweep(
        tuple(map(_figure, variation.figures)),
        len(factor),
        points.method,
        settings.seed,
        len(faults),
        tuple(dict.fromkeys(faults.values()))[:MOST_FAULTS],
        nominal,
        known.mean(axis=1),
        known.std(axis=1),
        low,
        high,
        known.min(axis=1),
        known.max(axis=1),
        tuple(checks),
        whole,
        indices,
        grid_of(variation, points, checks, frequency, faults),
        factor,
        frequency,
        settings.fail_at_most,
    )


def _figure(one: Any) -> VariedFigure:
    unit = None if one.law.is_relative else "row" if one.rows else one.law.unit
    return VariedFigure(one.name, one.law.words, one.column + 1, unit)


def _check(
    key: Key,
    used: FloatArray,
    fails: BoolArray,
    factor: FloatArray,
    names: Sequence[str],
    method: str,
) -> SweptCheck:
    share, low, high = probability(fails, method)
    known = used[np.isfinite(used)]
    decides, correlation = _decides(used, factor)
    middle, best, worst = (
        float(of(known)) if known.size else None for of in (np.median, np.min, np.max)
    )
    return SweptCheck(
        *key,
        int(fails.sum()),
        share,
        None if method == "grid" else low,
        None if method == "grid" else high,
        middle,
        best,
        worst,
        names[decides] if correlation is not None else "",
        correlation,
        used,
        fails,
    )


def _decides(used: FloatArray, factor: FloatArray) -> tuple[int, float | None]:
    """The figure whose ranks go most with those of the share of a limit, and how much (Spearman 1904)."""
    known = np.isfinite(used)
    values = used[known]
    if values.size < 3 or np.ptp(values) <= LEAST_SPREAD * np.abs(values).max():
        return 0, None
    share = _ranks(values)
    ranks = np.column_stack([_ranks(own) for own in factor[known].T])
    size = np.sqrt((ranks**2).sum(axis=0) * (share @ share))
    found = np.divide(
        share @ ranks, size, out=np.zeros(len(size)), where=size > 0.0
    )  # 0: it takes one value alone
    best = int(np.argmax(np.abs(found)))
    return best, float(found[best])


def _ranks(values: FloatArray) -> FloatArray:
    """(samples,) rank of each about the mean of all; of equal values the mean of their ranks.

    >>> _ranks(np.array([3.0, 1.0, 3.0, 2.0]))
    array([ 1. , -1.5,  1. , -0.5])
    """
    _, place, count = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(count) - count / 2.0 - len(values) / 2.0)[place])
