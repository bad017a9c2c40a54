"""Natural frequencies of one train by every division of its shafts: error against run time."""

from functools import partial

import numpy as np

from torsion.analyses.modes import Modes, modes_as_discretised
from torsion.analyses.study.division import divisions, reference
from torsion.analyses.study.rows import TimedQuantity
from torsion.analyses.study.timing import Effort, Method, timed
from torsion.findings import Progress
from torsion.study import Study

EPS = float(np.finfo(np.float64).eps)


def timed_frequencies(
    study: Study, highest: float, count: int | None, effort: Effort, progress: Progress
) -> TimedQuantity:
    """study: in the exact model. highest: Hz, of the response; count: of modes, None for those up to `highest`.

    Raises SolveError where the exact model cannot take the train.
    """
    exact = reference(study, highest, count)
    wanted = exact.finer_found.frequency
    top = max(highest, float(wanted[-1]))
    half = (exact.finer_found.upper - exact.finer_found.lower) / (2.0 * wanted)
    bound = max(float(half.max()), float(np.abs(exact.found.frequency / wanted - 1.0).max()), EPS)
    solve = partial(modes_as_discretised, count=len(wanted))
    curves = [
        [Method(curve, words, size, assemble, solve, partial(_errors, wanted)) for curve, words, size, assemble in one]
        for one in divisions(study.train, top, effort, effort.degrees)
    ]
    rows, remarks = timed(curves, effort, "natural frequencies", progress)
    number = len(wanted)
    whole = "the first elastic mode" if number == 1 else f"the first {number} elastic modes"
    return TimedQuantity(
        "frequencies",
        "Natural frequencies",
        f"The error is the largest relative error of {whole}, shapes and torques included in the time. Where a "
        "division has fewer modes it has no error and is not drawn.",
        "Reference: the exact model in twice as many pieces. Its bound is the larger of half its certified enclosure, "
        "of the difference to the exact model in half as many pieces, and of the rounding unit.",
        bound,
        highest if count is None and highest > 0.0 else float(wanted[-1]),
        tuple(f"mode {k + 1}, {f:.6g} Hz" for k, f in enumerate(wanted.tolist())),
        rows,
        remarks,
    )


def _errors(wanted: np.ndarray, found: Modes) -> tuple[float, ...]:
    """Relative error of each frequency; infinite where the division has fewer modes."""
    errors = np.full(len(wanted), np.inf)
    known = min(len(wanted), len(found.frequency))
    errors[:known] = np.abs(found.frequency[:known] / wanted[:known] - 1.0)
    return tuple(errors.tolist())
