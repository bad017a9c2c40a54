"""Which combinations of figures measurements identify, and which they leave open, in words."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.fitting import Identified
from torsion.results import listed
from torsion.what_if.fit.fit_results import Direction

LEAST_PART = 0.05  # of the largest: smaller parts of a combination are not named
ALIKE = 0.02  # of each other: parts that are said as one
EXAMPLE = 1.0  # %, by which the first figure of a combination changes


def directions(
    identity: Identified, names: Sequence[str], deviation: FloatArray
) -> tuple[Direction, ...]:
    """Of every singular value its combination; deviation: (figures,) of the logarithms beforehand."""
    return tuple(
        Direction(float(singular), bool(unseen), combination(row * deviation, names))
        for singular, unseen, row in zip(
            identity.singular, identity.unseen, identity.directions, strict=True
        )
    )


def combination(change: FloatArray, names: Sequence[str]) -> str:
    """Changes (figures,) of logarithms in words.

    >>> combination(np.array([0.7, 0.7, 0.001]), ["shaft.stiffness", "disc.inertia", "disc.damping"])
    'shaft.stiffness, disc.inertia by a common factor'
    >>> combination(np.array([0.1, -0.2]), ["a.stiffness", "b.stiffness"])
    'b.stiffness by +1 % with a.stiffness by -0.5 %'
    """
    order = np.argsort(-np.abs(change), kind="stable")
    parts = change / change[order[0]]
    named = [int(k) for k in order if abs(parts[k]) >= LEAST_PART]
    if len(named) == 1:
        return f"{names[named[0]]} alone"
    if all(abs(parts[k] - 1.0) < ALIKE for k in named):
        return f"{listed([names[k] for k in sorted(named)])} by a common factor"
    first, *further = (f"{names[k]} by {EXAMPLE * parts[k]:+.2g} %" for k in named)
    return f"{first} with {listed(further)}"


def unidentified(combinations: Sequence[Direction], *, only_frequencies: bool) -> list[str]:
    """What cannot be known, as sentences."""
    sentences = []
    for direction in combinations:
        if direction.is_unidentified:
            words = f"No measurement identifies {direction.words}: changed so, every measured value stays as it is"
            if only_frequencies and "common factor" in direction.words:
                words += (
                    " (frequencies never identify the common scale of stiffnesses and inertias)"
                )
            sentences.append(f"{words}. Its values are the prior values of the file.")
    return sentences
