"""The first root of a function that is evaluated at many points at once."""

from collections.abc import Callable

import numpy as np

from torsion.arrays import FloatArray

SAME = 1e-14  # brackets as narrow are a root
BRACKETS = 8  # equal parts of a bracket
NEAR = np.concatenate(
    [-(side := 0.1 ** np.arange(1.0, 11.0, 1.5)), [0.0], side]
)  # of it: points about its guess


def bracketed_root(
    of: Callable[[FloatArray], FloatArray], low: float, high: float, *, nothing: float
) -> float:
    """Where a function that is negative at `high` first becomes so: brackets, each looked at in many points at once.

    The points stand about the root of the line through the ends, closer and closer, and evenly. `low` where the
    function is `nothing` or less there already.
    """
    at = np.linspace(low, high, BRACKETS + 1)
    value = of(at)
    if value[0] <= nothing:
        return low
    while True:
        first = int(np.argmax(value <= 0.0)) if (value <= 0.0).any() else len(at) - 1
        low, high, above, below = (
            float(at[first - 1]),
            float(at[first]),
            float(value[first - 1]),
            float(value[first]),
        )
        share = above / (above - below) if below < above else 0.5
        root = low + (high - low) * share
        if high - low <= SAME or not low < (low + high) / 2.0 < high:
            return root if low < root < high else high
        near = root + (high - low) * NEAR
        at = np.unique(
            np.concatenate(
                [np.linspace(low, high, BRACKETS + 1), near[(near > low) & (near < high)]]
            )
        )
        value = of(at)
        value[[0, -1]] = above, below
