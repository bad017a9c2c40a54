"""Search of the choice with the best score: all of a list, a curve, a map, or differential evolution."""

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.sources import source
from torsion.what_if.design.trials import Trials

CURVE, MAP = 200, 200  # values of one figure, and of each of two
VALLEYS = 3  # of which the best is refined
REFINED = 1e-6  # of a range
STEPS, SIMPLEX = 40, 120  # most trials of one refinement: of one figure, of several
FEW = 5  # trials of a refinement at least
NEAR = 0.05  # of a range, beside the best of an evolution
CROWD = 15  # choices of a generation for each figure


def search(trials: Trials) -> str:
    """Try choices until the best is found, or the limit of trials is reached; in words how."""
    figures, limit = trials.variation.figures, trials.limit
    sizes = [one.places for one in figures]
    if all(sizes) and math.prod(sizes) <= limit:
        trials.scores(_grid([one.every() for one in figures]))
        return f"all {math.prod(sizes):,} combinations"
    if len(figures) <= 2:
        axes = _axes(figures, limit)
        if math.prod(map(len, axes)) <= limit:
            values = _grid(axes)
            scores = trials.scores(values).reshape([len(axis) for axis in axes])
            tops = _tops(scores)
            for top in tops:
                start = [float(axes[k][at]) for k, at in enumerate(top)]
                _refined(
                    trials,
                    start,
                    [_step(axis) for axis in axes],
                    (limit - len(values)) // len(tops),
                )
            return f"{' by '.join(str(len(axis)) for axis in axes)} values, the best {len(tops)} refined"
    return _evolution(trials)


def _axes(figures: Sequence[Any], limit: int) -> list[FloatArray]:
    """Values of one figure or two: all of a list, else as many of a range as the limit leaves."""
    listed = math.prod(one.places or 1 for one in figures)
    free = sum(not one.places for one in figures)
    most = CURVE if len(figures) == 1 else MAP
    side = max(min(most, int((0.8 * limit / listed) ** (1.0 / max(free, 1)))), 5)
    return [
        one.every() if one.places else np.linspace(one.law.ends[0], one.law.ends[1], side)
        for one in figures
    ]


def _grid(axes: Sequence[FloatArray]) -> FloatArray:
    return np.array(list(product(*(axis.tolist() for axis in axes))))


def _step(axis: FloatArray) -> float:
    return float(axis[1] - axis[0]) if len(axis) > 1 else 0.0


def _tops(scores: FloatArray) -> list[tuple[int, ...]]:
    """Places of the best maxima of a curve or a map, none beside another."""
    found = list[tuple[int, ...]]()
    for flat in np.argsort(-scores, axis=None, kind="stable").tolist():
        place = tuple(int(k) for k in np.unravel_index(flat, scores.shape))
        around = scores[tuple(slice(max(k - 1, 0), k + 2) for k in place)]
        if scores[place] >= around.max():
            found.append(place)
        if len(found) == VALLEYS:
            break
    return found


def _refined(trials: Trials, start: Sequence[float], step: Sequence[float], most: int) -> None:
    """Try `most` values, or a few, of the ranges around a choice until none is better, those of lists as they are."""
    from scipy.optimize import minimize, minimize_scalar

    figures = trials.variation.figures
    free = [k for k, one in enumerate(figures) if not one.places]
    if not free:
        return
    low, high = np.array([figures[k].law.ends for k in free]).T

    def cost(share: Any) -> float:
        row = np.array(start, dtype=float)
        row[free] = low + np.atleast_1d(share) * (high - low)
        return -float(trials.scores(row[None])[0])

    middle, around = (
        (np.array(start)[free] - low) / (high - low),
        np.array(step)[free] / (high - low),
    )
    lowest, highest = np.maximum(middle - around, 0.0), np.minimum(middle + around, 1.0)
    if len(free) == 1:
        minimize_scalar(
            cost,
            bounds=(lowest[0], highest[0]),
            method="bounded",
            options={"xatol": REFINED, "maxiter": max(min(STEPS, most), FEW)},
        )
        return
    corners = np.vstack(
        [
            middle,
            *(
                np.where(np.arange(len(free)) == k, _other(lowest, highest, middle), middle)
                for k in range(len(free))
            ),
        ]
    )
    minimize(
        cost,
        middle,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(free),
        options={
            "initial_simplex": corners,
            "xatol": REFINED,
            "fatol": 1e-9,
            "maxfev": max(min(SIMPLEX * len(free), most), FEW),
        },
    )


def _other(low: FloatArray, high: FloatArray, middle: FloatArray) -> FloatArray:
    """Of both ends the one that is farther from the middle."""
    return np.where(high - middle >= middle - low, high, low)


@source("StornPrice1997")
def _evolution(trials: Trials) -> str:
    """Differential evolution of all figures, lists as whole numbers; then the lists one by one, and the ranges."""
    from scipy.optimize import differential_evolution

    figures, limit = trials.variation.figures, trials.limit
    every = [one.every() if one.places else None for one in figures]
    bounds: Any = [(0.0, 1.0) if each is None else (0, len(each) - 1) for each in every]
    crowd = max(CROWD * len(figures), 20)

    def values(unit: FloatArray) -> FloatArray:
        """(variants, figures) of places in lists and shares of ranges (figures, variants)."""
        columns = [
            one.at(row)
            if each is None
            else each[np.clip(np.rint(row).astype(np.intp), 0, len(each) - 1)]
            for one, each, row in zip(figures, every, np.atleast_2d(unit.T).T, strict=True)
        ]
        return np.stack(columns, axis=-1)

    def cost(unit: FloatArray) -> Any:
        return -trials.scores(np.atleast_2d(values(unit)))

    def is_spent(*_: Any, **__: Any) -> Any:
        return len(trials.done) + crowd > 0.8 * limit

    differential_evolution(
        cost,
        bounds,
        integrality=[each is not None for each in every],
        vectorized=True,
        updating="deferred",
        polish=False,
        popsize=max(crowd // len(figures), 5),
        maxiter=limit,
        tol=1e-6,
        rng=trials.settings.seed,
        callback=is_spent,
    )
    _others(trials, every)
    tops = list(_different(trials, every))
    left = (limit - len(trials.done)) // len(tops)
    for top in tops:
        step = [0.0 if one.places else NEAR * one.law.width for one in figures]
        _refined(trials, top, step, left)
    return f"differential evolution, seed {trials.settings.seed}, then every list separately and the ranges refined"


def _others(trials: Trials, every: Sequence[FloatArray | None]) -> None:
    """Try all values of every list, all else as in the best choice."""
    best = trials.best[0].values
    for place, each in enumerate(every):
        if each is not None and len(each) <= max(trials.limit // 5, 10):
            rows = np.tile(best, (len(each), 1))
            rows[:, place] = each
            trials.scores(rows)


def _different(trials: Trials, every: Sequence[FloatArray | None]) -> Iterator[tuple[float, ...]]:
    """The best choices, no two of them with the same values of all lists."""
    seen = set[tuple[float, ...]]()
    for one in trials.best:
        own = tuple(
            value for value, each in zip(one.values, every, strict=True) if each is not None
        )
        if own not in seen:
            seen.add(own)
            yield one.values
        if len(seen) == VALLEYS:
            return
