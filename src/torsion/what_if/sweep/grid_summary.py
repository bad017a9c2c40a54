"""What all combinations of a grid answer, and where along a curve a check begins to fail."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.study import Variation
from torsion.what_if.sweep.sweep_points import Points
from torsion.what_if.sweep.sweep_results import Grid, GridAxis, SweptCheck, Turn

MOST_REPORTED = 100_000  # variants, each of which has its numbers among the results


def grid_of(
    variation: Variation,
    points: Points,
    checks: Sequence[SweptCheck],
    frequency: FloatArray,
    faults: Mapping[int, str],
) -> Grid | None:
    """The grid with its answers; None of samples, and of a very large one."""
    count = points.samples
    if points.method != "grid" or count > MOST_REPORTED:
        return None
    axes = tuple(
        _axis([figure for figure in variation.figures if figure.column == k])
        for k in range(len(points.shape))
    )
    used = np.stack([check.utilisation for check in checks]) if checks else np.empty((0, count))
    fails = (
        np.any([check.fails for check in checks], axis=0)
        if checks
        else np.zeros(count, dtype=np.bool_)
    )
    fails[list(faults)] = True
    greatest = np.fmax.reduce(used, axis=0) if checks else np.full(count, np.nan)
    decisive = np.where(
        np.isnan(greatest),
        -1,
        np.argmax(np.nan_to_num(used, nan=-np.inf), axis=0) if checks else -1,
    )
    turns = tuple(_turns(axes[0].number, checks)) if len(axes) == 1 and axes[0].is_numeric else ()
    return Grid(
        axes, frequency, used, greatest, decisive, fails, turns, tuple(sorted(faults.items()))
    )


def _axis(figures: Sequence[Any]) -> GridAxis:
    first = figures[0]
    number, unit = first.numbers
    columns = [figure.all_values().tolist() for figure in figures]
    words = tuple(
        ", ".join(figure.words(value) for figure, value in zip(figures, row, strict=True))
        for row in zip(*columns, strict=True)
    )
    in_file = None if np.isnan(first.in_file) else float(first.in_file)
    return GridAxis(tuple(figure.name for figure in figures), words, number, unit, in_file)


def _turns(numbers: FloatArray, checks: Sequence[SweptCheck]) -> Iterator[Turn]:
    """Between neighbours of which one keeps the limit and the other does not."""
    for position, check in enumerate(checks):
        for k in np.flatnonzero(np.diff(check.fails)).tolist():
            kept, failing = (k, k + 1) if check.fails[k + 1] else (k + 1, k)
            low, high = check.utilisation[kept], check.utilisation[failing]
            is_known = low <= 1.0 < high < np.inf
            between = (
                numbers[kept] + (1.0 - low) / (high - low) * (numbers[failing] - numbers[kept])
                if is_known
                else None
            )
            yield Turn(
                position,
                float(numbers[kept]),
                float(numbers[failing]),
                None if between is None else float(between),
            )
