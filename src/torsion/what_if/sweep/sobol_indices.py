"""Sobol's indices: which share of the spread of an answer is due to which figure, monotone or not."""

import numpy as np

from torsion.arrays import FloatArray
from torsion.sources import source
from torsion.what_if.sweep.sweep_points import Points
from torsion.what_if.sweep.sweep_results import SobolIndex
from torsion.what_if.variants.one_by_one import Answers
from torsion.what_if.variants.sampling import LEVEL, SCRAMBLES

LEAST_SPREAD = 1e-9  # relative: below it an answer does not vary


@source("Saltelli2010")
@source("Jansen1999")
def sobol_indices(points: Points, answers: Answers) -> tuple[SobolIndex, ...]:
    """Of every frequency and share of a limit that all variants have; nothing of one that does not vary."""
    columns = len(points.shape)
    names = [
        ", ".join(figure.name for figure in points.figures if figure.column == column)
        for column in range(columns)
    ]
    quantities = {f"mode {mode}": hertz for mode, hertz in enumerate(answers.frequency, start=1)}
    quantities |= {
        f"{key[1]}: {key[2]}, {key[3]}": used for key, (used, _) in answers.checks.items()
    }
    indices = []
    for words, values in quantities.items():
        if not np.isfinite(values).all() or np.ptp(values) <= LEAST_SPREAD * np.abs(values).max():
            continue
        value, error = estimated(values.reshape(points.sets, points.samples))
        indices += [
            SobolIndex(words, name, *np.column_stack([value[:, k], error[:, k]]).ravel().tolist())
            for k, name in enumerate(names)
        ]
    return tuple(indices)


def estimated(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First and total indices (2, figures), and half of their 95 % intervals.

    values: (2 + figures, samples) of the sets A, B, and A with each column of B; first indices after Saltelli et al.
    (2010), total ones after Jansen (1999). The interval is Student's t over the sequences left out one after another
    (jackknife).
    """
    from scipy.special import stdtrit

    sequences = values.reshape(len(values), SCRAMBLES, -1)
    left_out = np.stack([_indices(np.delete(sequences, k, axis=1)) for k in range(SCRAMBLES)])
    spread = np.sqrt((SCRAMBLES - 1) * left_out.var(axis=0))
    return _indices(sequences), float(stdtrit(SCRAMBLES - 1, 0.5 + LEVEL / 2.0)) * spread


def _indices(values: FloatArray) -> FloatArray:
    """(2, figures) from values (2 + figures, ...)."""
    first, second, *mixed = (answers.ravel() - values[:2].mean() for answers in values)
    variance = np.concatenate([first, second]).var()
    return np.array(
        [
            [np.mean(second * (answers - first)) / variance for answers in mixed],
            [np.mean((first - answers) ** 2) / (2.0 * variance) for answers in mixed],
        ]
    )
