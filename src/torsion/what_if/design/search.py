"""Search of the candidate with the best score: all of a list, a curve, a map, or differential evolution."""

import math
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.sources import source
from torsion.what_if.design.candidates import Candidates

AXIS = 200  # values of one figure, and of each of two
VALLEYS = 3  # of which the best is refined
REFINED = 1e-6  # of a range
STEPS, SIMPLEX = 40, 120  # most candidates of one refinement: of one figure, of several
FEW = 5  # candidates of a refinement at least
NEAR = 0.05  # of a range, beside the best of an evolution
CROWD = 15  # candidates of a generation for each figure


def search(candidates: Candidates) -> str:
    """Try candidates until the best is found, or the limit is reached; return in words how."""
    figures, limit = candidates.variation.figures, candidates.limit
    combinations = math.prod(figure.places for figure in figures)
    if 0 < combinations <= limit:
        candidates.scores(np.array(list(product(*(figure.all_values() for figure in figures)))))
        return f"all {combinations:,} combinations"

    # Of one figure or two all values of a list, else as many of a range as the limit leaves.
    listed = math.prod(figure.places or 1 for figure in figures)
    ranges = sum(not figure.places for figure in figures)
    side = max(min(AXIS, int((0.8 * limit / listed) ** (1.0 / max(ranges, 1)))), 5)
    if len(figures) > 2 or listed * side**ranges > limit:
        return _evolve(candidates)
    axes = [
        figure.all_values()
        if figure.places
        else np.linspace(figure.law.ends[0], figure.law.ends[1], side)
        for figure in figures
    ]
    values = np.array(list(product(*axes)))
    scores = candidates.scores(values).reshape([len(axis) for axis in axes])

    # The best maxima of the curve or the map, none beside another, are refined.
    tops = list[tuple[int, ...]]()
    for flat in np.argsort(-scores, axis=None, kind="stable").tolist():
        position = tuple(int(k) for k in np.unravel_index(flat, scores.shape))
        around = scores[tuple(slice(max(k - 1, 0), k + 2) for k in position)]
        if len(tops) < VALLEYS and scores[position] >= around.max():
            tops.append(position)
    steps = [float(axis[1] - axis[0]) if len(axis) > 1 else 0.0 for axis in axes]
    for top in tops:
        start = [float(axis[position]) for axis, position in zip(axes, top, strict=True)]
        _refine(candidates, start, steps, (limit - len(values)) // len(tops))
    sizes = " by ".join(str(len(axis)) for axis in axes)
    return f"{sizes} values, the best {len(tops)} refined"


def _refine(
    candidates: Candidates, start: Sequence[float], steps: Sequence[float], evaluations: int
) -> None:
    """Try `most` values, or a few, of the ranges around a candidate until none is better, those of lists as they are."""
    from scipy.optimize import minimize, minimize_scalar

    figures = candidates.variation.figures
    ranges = [k for k, figure in enumerate(figures) if not figure.places]
    if not ranges:
        return
    low, high = np.array([figures[k].law.ends for k in ranges]).T

    def cost(share: Any) -> float:
        row = np.array(start, dtype=float)
        row[ranges] = low + np.atleast_1d(share) * (high - low)
        return -float(candidates.scores(row[None])[0])

    middle = (np.array(start)[ranges] - low) / (high - low)
    around = np.array(steps)[ranges] / (high - low)
    lowest, highest = np.maximum(middle - around, 0.0), np.minimum(middle + around, 1.0)
    if len(ranges) == 1:
        options: Any = {"xatol": REFINED, "maxiter": max(min(STEPS, evaluations), FEW)}
        minimize_scalar(cost, bounds=(lowest[0], highest[0]), method="bounded", options=options)
        return
    # Each corner of the simplex moves one range to its farther end.
    farther = np.where(highest - middle >= middle - lowest, highest, lowest)
    simplex = np.vstack([middle, np.where(np.eye(len(ranges), dtype=bool), farther, middle)])
    options = {
        "initial_simplex": simplex,
        "xatol": REFINED,
        "fatol": 1e-9,
        "maxfev": max(min(SIMPLEX * len(ranges), evaluations), FEW),
    }
    minimize(cost, middle, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(ranges), options=options)


@source("StornPrice1997")
def _evolve(candidates: Candidates) -> str:
    """Differential evolution of all figures, lists as whole numbers; then the lists one by one, and the ranges."""
    from scipy.optimize import differential_evolution

    figures, limit = candidates.variation.figures, candidates.limit
    lists = [figure.all_values() if figure.places else None for figure in figures]
    bounds: Any = [(0.0, 1.0) if values is None else (0, len(values) - 1) for values in lists]
    # A first generation and one more at least stay below the limit.
    crowd = min(max(CROWD * len(figures), 20), 2 * limit // 5)
    is_spent: Any = lambda *_, **__: len(candidates.tried) + crowd > 0.8 * limit  # noqa: E731

    def cost(unit: FloatArray) -> Any:
        """Of places in lists and shares of ranges (figures, variants)."""
        columns = [
            figure.at(row)
            if values is None
            else values[np.clip(np.rint(row).astype(np.intp), 0, len(values) - 1)]
            for figure, values, row in zip(figures, lists, np.atleast_2d(unit.T).T, strict=True)
        ]
        return -candidates.scores(np.atleast_2d(np.stack(columns, axis=-1)))

    differential_evolution(
        cost,
        bounds,
        integrality=[values is not None for values in lists],
        vectorized=True,
        updating="deferred",
        polish=False,
        popsize=max(crowd // len(figures), 1),
        maxiter=limit,
        tol=1e-6,
        rng=candidates.settings.seed,
        callback=is_spent,
    )

    # All values of every list that is not too long, all else as in the best candidate.
    best = candidates.best[0].values
    for position, values in enumerate(lists):
        if values is not None and len(values) <= max(limit // 5, 10):
            rows = np.tile(best, (len(values), 1))
            rows[:, position] = values
            candidates.scores(rows)

    # The best candidates with different values of the lists.
    tops: dict[tuple[float, ...], tuple[float, ...]] = {}
    for candidate in candidates.best:
        pairs = zip(candidate.values, lists, strict=True)
        chosen = tuple(value for value, values in pairs if values is not None)
        if len(tops) < VALLEYS:
            tops.setdefault(chosen, candidate.values)
    left = (limit - len(candidates.tried)) // len(tops)
    steps = [0.0 if figure.places else NEAR * np.ptp(figure.law.ends) for figure in figures]
    for top in tops.values():
        _refine(candidates, top, steps, left)
    seed = candidates.settings.seed
    return f"differential evolution, seed {seed}, then every list separately and the ranges refined"
