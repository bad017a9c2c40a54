"""The root and the minimum of a function between two bounds, for one pair of bounds or many side by side.

Brent (1973, Algorithms for Minimization without Derivatives, sections 4 and 5): interpolation that falls back on
halving, or on the golden section. scipy.optimize has the same for one pair; its import takes 0.2 s, which every command
would wait for.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Function = Callable[[Any], Any]  # of a number, or of (m,) numbers side by side

MOST_STEPS = 100
MOST_EVALUATIONS = 500
_EPS = float(np.finfo(np.float64).eps)
_GOLDEN = 0.5 * (3.0 - 5.0**0.5)
_FLAT = 2.2e-16**0.5  # relative distance at which a smooth function is as small as at its minimum


@np.errstate(all="ignore")
def find_root(
    function: Function,
    low: ArrayLike,
    high: ArrayLike,
    *,
    tolerance: float = 0.0,
    relative: float = 4.0 * _EPS,
) -> Any:
    """Return where a function changes its sign between `low` and `high`, numbers or (m,) each.

    To `tolerance` + `relative` |x|. Raises ValueError where both bounds give the same sign.

    >>> round(float(find_root(lambda x: x * x - 2.0, 0.0, 2.0)), 12)
    1.414213562373
    >>> find_root(lambda x: x * x - np.array([1.0, 4.0]), np.zeros(2), np.full(2, 5.0)).round(12)
    array([1., 2.])
    """
    before, x = np.broadcast_arrays(np.asarray(low, dtype=float), np.asarray(high, dtype=float))
    value_before, value = (np.asarray(function(point[()]), dtype=float) for point in (before, x))
    if np.any(value_before * value > 0.0):
        raise ValueError("the function has the same sign at both bounds")
    x, value = np.where(value_before == 0.0, (before, value_before), (x, value))
    opposite, value_opposite = before, value_before
    step = step_before = x - before
    for _ in range(MOST_STEPS):
        # The root lies between `x`, the better bound, and `opposite`; `before` is the last `x`.
        crossed = (value_before != 0.0) & (value != 0.0) & ((value_before < 0.0) != (value < 0.0))
        opposite, value_opposite, step, step_before = np.where(
            crossed,
            (before, value_before, x - before, x - before),
            (opposite, value_opposite, step, step_before),
        )
        swapped = np.abs(value_opposite) < np.abs(value)
        before, x, opposite = np.where(swapped, (x, opposite, x), (before, x, opposite))
        value_before, value, value_opposite = np.where(
            swapped, (value, value_opposite, value), (value_before, value, value_opposite)
        )

        room = 0.5 * (tolerance + relative * np.abs(x))
        half = 0.5 * (opposite - x)
        is_done = (value == 0.0) | (np.abs(half) < room)
        if is_done.all():
            break

        slope_before = (value_before - value) / (before - x)
        slope_opposite = (value_opposite - value) / (opposite - x)
        secant = -value * (x - before) / (value - value_before)
        quadratic = (
            -value
            * (value_opposite * slope_opposite - value_before * slope_before)
            / (slope_opposite * slope_before * (value_opposite - value_before))
        )
        trial = np.where(before == opposite, secant, quadratic)
        is_taken = (np.abs(step_before) > room) & (np.abs(value) < np.abs(value_before))
        is_taken &= 2.0 * np.abs(trial) < np.minimum(np.abs(step_before), 3.0 * np.abs(half) - room)
        step_before, step = np.where(is_taken, (step, trial), half)

        before, value_before = np.where(is_done, (before, value_before), (x, value))
        moved = x + np.where(np.abs(step) > room, step, np.where(half > 0.0, room, -room))
        x = np.where(is_done, x, moved)
        value = np.where(is_done, value, function(x[()]))
    return x[()]


def find_minimum(
    function: Function,
    low: float,
    high: float,
    *,
    tolerance: float = 1e-5,
    most: int = MOST_EVALUATIONS,
) -> tuple[float, float]:
    """Return the place of a local minimum between `low` and `high`, to `tolerance`, and the value there.

    At most `most` evaluations. Of several minima it is any.

    >>> place, value = find_minimum(lambda x: (x - 1.0) ** 2, 0.0, 3.0)
    >>> round(place, 6), round(value, 9)
    (1.0, 0.0)
    """
    best = second = third = low + _GOLDEN * (high - low)
    value = value_second = value_third = function(best)
    step = step_before = 0.0
    for _ in range(most - 1):
        middle, room = 0.5 * (low + high), _FLAT * abs(best) + tolerance / 3.0
        if abs(best - middle) <= 2.0 * room - 0.5 * (high - low):
            break

        # A parabola through the three best points, unless it leaves the bounds or moves too far.
        is_golden = abs(step_before) <= room
        if not is_golden:
            right = (best - second) * (value - value_third)
            left = (best - third) * (value - value_second)
            top, bottom = (best - third) * left - (best - second) * right, 2.0 * (left - right)
            top, bottom = -top if bottom > 0.0 else top, abs(bottom)
            is_golden = not (
                abs(top) < abs(0.5 * bottom * step_before)
                and bottom * (low - best) < top < bottom * (high - best)
            )
            step_before = step
            if not is_golden:
                step = top / bottom
                if min(best + step - low, high - best - step) < 2.0 * room:
                    step = room if middle >= best else -room
        if is_golden:
            step_before = (low if best >= middle else high) - best
            step = _GOLDEN * step_before

        trial = best + (1.0 if step >= 0.0 else -1.0) * max(abs(step), room)
        trial_value = function(trial)
        if trial_value <= value:
            low, high = (best, high) if trial >= best else (low, best)
            third, value_third, second, value_second = second, value_second, best, value
            best, value = trial, trial_value
            continue
        low, high = (trial, high) if trial < best else (low, trial)
        if trial_value <= value_second or second == best:
            third, value_third, second, value_second = second, value_second, trial, trial_value
        elif trial_value <= value_third or third in (best, second):
            third, value_third = trial, trial_value
    return best, value
