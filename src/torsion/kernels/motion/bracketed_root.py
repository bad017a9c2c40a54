"""The first root of a function that is evaluated at many points at once."""

from collections.abc import Callable

import numpy as np

from torsion.arrays import FloatArray

SAME = 1e-14  # brackets as narrow are a root
BRACKETS = 8  # equal parts of a bracket
SIDE = 0.1 ** np.arange(1.0, 11.0, 1.5)
NEAR = np.concatenate([-SIDE, [0.0], SIDE])  # of a bracket: points about the guess of its root


def bracketed_root(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, *, nothing: float
) -> float:
    """Where a function that is negative at `high` first becomes so: brackets, each looked at in many points at once.

    The points stand about the root of the line through the ends, closer and closer, and evenly. `low` where the
    function is `nothing` or less there already.
    """
    points = np.linspace(low, high, BRACKETS + 1)
    value = function(points)
    if value[0] <= nothing:
        return low
    while True:
        end = int(np.argmax(value <= 0.0)) if (value <= 0.0).any() else len(points) - 1
        low, high = points[end - 1 : end + 1].tolist()
        above, below = value[end - 1 : end + 1].tolist()
        share = above / (above - below) if below < above else 0.5
        root = low + (high - low) * share
        if high - low <= SAME or not low < (low + high) / 2.0 < high:
            return float(root if low < root < high else high)
        near = root + (high - low) * NEAR
        inside = near[(near > low) & (near < high)]
        points = np.unique(np.concatenate([np.linspace(low, high, BRACKETS + 1), inside]))
        value = function(points)
        value[[0, -1]] = above, below
