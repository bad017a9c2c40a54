"""Frequencies of variants side by side where lists vary too: one row of the lists after another."""

from dataclasses import replace

import numpy as np

from torsion.analyses.variants.one_by_one import Answers, why
from torsion.analyses.variants.side_by_side import side_by_side
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.study import Variation


def row_by_row(system: System, variation: Variation, values: FloatArray, count: int) -> Answers | None:
    """Frequencies of variants (variants, figures), of every combination of rows side by side; None where not so.

    A combination is lowered once, whatever else varies; one that is at fault leaves its variants without an answer.
    Where lists alone vary nothing is side by side.
    """
    listed = [place for place, one in enumerate(variation.figures) if one.rows]
    others = [place for place in range(len(variation.figures)) if place not in listed]
    if not listed:
        frequency = side_by_side(system, variation, values, count)
        return None if frequency is None else Answers(frequency)
    if not others or not count:
        return None
    from torsion.assembly import rediscretised

    answers = Answers(np.full((count, len(values)), np.nan))
    rows, place = np.unique(values[:, listed], axis=0, return_inverse=True)
    order = np.argsort(place, kind="stable")
    for row, here in zip(
        rows.tolist(), np.split(order, np.searchsorted(place[order], range(1, len(rows)))), strict=True
    ):
        try:
            one = variation.fixed(dict(zip(listed, row, strict=True)))
            own = rediscretised(replace(system, train=one.base.train), system.requested.frequency)
        except (InputError, SolveError) as error:
            answers.faults.update(dict.fromkeys(here.tolist(), why(error)))
            continue
        found = side_by_side(own, one, values[here][:, others], count)
        if found is None:
            return None
        answers.frequency[:, here] = found
    return answers
