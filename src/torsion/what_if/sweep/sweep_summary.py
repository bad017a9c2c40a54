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
from torsion.what_if.variants.sampling import probability

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
    faults = {variant: why for variant, why in answers.faults.items() if variant < points.samples}
    names = [figure.name for figure in variation.figures]
    unsolved = np.zeros(len(factor), dtype=np.bool_)
    unsolved[list(faults)] = True
    checks = [
        _check(key, used, fails | unsolved, factor, names, points.method)
        for key, (used, fails) in lines.items()
    ]
    checks.sort(key=lambda one: (-one.probability, -(one.worst or 0.0)))
    any_check = None
    if lines:
        used = np.fmax.reduce([check.utilisation for check in checks])
        fails = np.any([check.fails for check in checks], axis=0)
        any_check = _check(("", "", "", "any check"), used, fails, factor, names, points.method)
    solved = frequency[:, np.isfinite(frequency).all(axis=0)] if frequency.size else frequency
    solved = solved if solved.size else np.full((len(nominal), 1), np.nan)
    low, high = np.quantile(solved, (0.025, 0.975), axis=1)
    return Sweep(
        tuple(map(_figure, variation.figures)),
        len(factor),
        points.method,
        settings.seed,
        len(faults),
        tuple(dict.fromkeys(faults.values()))[:MOST_FAULTS],
        nominal,
        solved.mean(axis=1),
        solved.std(axis=1),
        low,
        high,
        solved.min(axis=1),
        solved.max(axis=1),
        tuple(checks),
        any_check,
        indices,
        grid_of(variation, points, checks, frequency, faults),
        factor,
        frequency,
        settings.fail_at_most,
    )


def _figure(figure: Any) -> VariedFigure:
    unit = None if figure.law.is_relative else "row" if figure.rows else figure.law.unit
    return VariedFigure(figure.name, figure.law.words, figure.column + 1, unit)


def _check(
    key: Key,
    used: FloatArray,
    fails: BoolArray,
    factor: FloatArray,
    names: Sequence[str],
    method: str,
) -> SweptCheck:
    share, low, high = probability(fails, method)
    finite = used[np.isfinite(used)]
    decides, correlation = _decides(used, factor)
    middle, best, worst = (
        float(statistic(finite)) if finite.size else None
        for statistic in (np.median, np.min, np.max)
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
    is_finite = np.isfinite(used)
    values = used[is_finite]
    if values.size < 3 or np.ptp(values) <= LEAST_SPREAD * np.abs(values).max():
        return 0, None
    share = _ranks(values)
    ranks = np.column_stack([_ranks(column) for column in factor[is_finite].T])
    size = np.sqrt((ranks**2).sum(axis=0) * (share @ share))
    correlation = np.divide(
        share @ ranks, size, out=np.zeros(len(size)), where=size > 0.0
    )  # 0: it takes one value alone
    best = int(np.argmax(np.abs(correlation)))
    return best, float(correlation[best])


def _ranks(values: FloatArray) -> FloatArray:
    """(samples,) rank of each about the mean of all; of equal values the mean of their ranks.

    >>> _ranks(np.array([3.0, 1.0, 3.0, 2.0]))
    array([ 1. , -1.5,  1. , -0.5])
    """
    _, rank, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - count / 2.0 - len(values) / 2.0)[rank]
