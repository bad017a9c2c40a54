"""Where the natural frequencies of a tree with bars lie, by counts: brackets, bisection and proven enclosures."""

from dataclasses import dataclass

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.bars.counts import ARGUMENT, count_below, count_bounds, margins
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.tree import BoolArray, FloatArray, IntArray

SHARE_OF_LIMIT = 0.95  # of the frequency from which counts would need a correction
_OCTAVES = 332  # searched below the limit; with squares, end inertias and stiffnesses in range
_GRID = 2.0 ** np.arange(-166.0, 167.0)  # rad/s, where there is no limit
_POINTS = 15  # inside the bracket of one mode in one sweep of the multisection
_COLUMNS = 512  # frequencies in one sweep above which points cost more than sweeps (measured)
_POINTS_A_MODE = 3  # at least
_NEAR = 1e-2  # relative width of a bracket from which a mode alone in it, divided once more, is polished
_COINCIDENT = 1e-7  # relative width at which modes are no longer told apart by counts
_NARROWEST = 2.0**-51  # relative half width first tried
_WIDEST = 2.0**-36  # 1.5e-11; a value that is not proven there is taken to be wrong
_OVER_MARGIN = 1.25


def brackets(train: BarTree, mode: IntArray, *, tolerance: float | None = None) -> tuple[FloatArray, FloatArray]:
    """Bounds (m,) rad/s of the modes `mode` (m,), ascending, counted from 0 with the rigid ones.

    To a relative `tolerance`, by default near enough to polish. Raises SolveError for a mode above the limit.
    """
    grid = _grid(train)
    count = np.maximum.accumulate(count_below(train, grid))
    above = np.searchsorted(count, mode, side="right")
    if np.any(above == len(grid)):
        _refuse(train, grid[-1], int(np.count_nonzero(above < len(grid))))
    if np.any(above == 0):
        raise SolveError("a natural frequency is more than 300 octaves low; check the units of inertia and stiffness")
    found = _Brackets(grid[above - 1], grid[above], count[above - 1], count[above])
    done = np.zeros(len(mode), dtype=bool)
    while not done.all():
        left = np.flatnonzero(~done)
        before = found.take(left)
        after = _divided(train, mode[left], before)
        found.put(left, after)
        width = (after.high - after.low) / after.high
        if tolerance is None:
            done[left] = (before.alone & (width <= _NEAR)) | (width <= _COINCIDENT)
        else:
            done[left] = (width <= tolerance) | (after.high - after.low >= before.high - before.low)
    return found.low, found.high


@dataclass(frozen=True)
class _Brackets:
    """Bounds (m,) rad/s of modes, and the counts at them."""

    low: FloatArray
    high: FloatArray
    below: IntArray
    up_to: IntArray

    @property
    def alone(self) -> BoolArray:
        """Whether each bracket (m,) holds one mode."""
        single: BoolArray = self.up_to - self.below == 1
        return single

    def take(self, rows: IntArray) -> "_Brackets":
        """Some of them."""
        return _Brackets(self.low[rows], self.high[rows], self.below[rows], self.up_to[rows])

    def put(self, rows: IntArray, other: "_Brackets") -> None:
        """Replace some of them."""
        self.low[rows], self.high[rows] = other.low, other.high
        self.below[rows], self.up_to[rows] = other.below, other.up_to


def _grid(train: BarTree) -> FloatArray:
    top = SHARE_OF_LIMIT * train.bars.limit
    return top * 2.0 ** np.arange(-float(_OCTAVES), 1.0) if np.isfinite(top) else _GRID


def _refuse(train: BarTree, top: float, found: int) -> None:
    if not np.isfinite(train.bars.limit):
        raise SolveError("a natural frequency lies above 1e50 rad/s; check the units of inertia and stiffness")
    raise SolveError(
        f"only {found} of the natural frequencies asked for lie below {top:.6g} rad/s, for which the pieces of the"
        " shafts are short enough; divide the shafts more finely, or ask for fewer modes"
    )


def _divided(train: BarTree, mode: IntArray, found: _Brackets) -> _Brackets:
    """Narrower brackets of `mode` (m,): each divided by points in proportion to the modes that share it."""
    _, first, which, sharing = np.unique(found.low, return_index=True, return_inverse=True, return_counts=True)
    number = np.maximum(min(_POINTS, max(_POINTS_A_MODE, _COLUMNS // len(mode))), _POINTS_A_MODE * sharing)
    low, high = found.low[first], found.high[first]
    inside = [a + (b - a) * (np.arange(1, n + 1) / (n + 1)) for a, b, n in zip(low, high, number, strict=True)]
    counts = np.split(count_below(train, np.concatenate(inside)), np.cumsum(number)[:-1])
    members = np.split(np.argsort(which.reshape(-1), kind="stable"), np.cumsum(sharing)[:-1])
    narrower = found.take(np.arange(len(mode)))
    for begin, places, count, rows in zip(first.tolist(), inside, counts, members, strict=True):
        below, up_to = found.below[begin], found.up_to[begin]
        ladder = np.concatenate(([found.low[begin]], places, [found.high[begin]]))
        known = np.concatenate(([below], np.clip(np.maximum.accumulate(count), below, up_to), [up_to]))
        above = np.searchsorted(known, mode[rows], side="right")
        narrower.put(rows, _Brackets(ladder[above - 1], ladder[above], known[above - 1], known[above]))
    return narrower


def enclose(
    train: BarTree, frequency: FloatArray, rigid: int, passed: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Bounds `lower`, `upper` (m,) rad/s of the modes rigid, rigid + 1, ... and which (m,) of them are proven.

    `passed` (m,) N m of the shapes tells, to first order, the width in which a proof is expected to succeed.
    """
    square = frequency * frequency
    of_square, of_stiffness = margins(train, square)
    half = np.full(len(frequency), _NARROWEST) + _OVER_MARGIN * 0.5 * (of_square + ARGUMENT)
    if passed is not None:
        with np.errstate(invalid="ignore", over="ignore"):
            wider = half + _OVER_MARGIN * 0.5 * of_stiffness * passed / square
        half = np.where(wider <= _WIDEST, wider, half)
    lower, upper = frequency * (1.0 - half), frequency * (1.0 + half)
    proven, left = np.zeros(len(frequency), dtype=bool), np.arange(len(frequency))
    while len(left):
        low, high = frequency[left] * (1.0 - half[left]), frequency[left] * (1.0 + half[left])
        at_most, at_least = count_bounds(train, low, high)
        good = (at_most <= left + rigid) & (at_least > left + rigid)
        done = left[good]
        lower[done], upper[done], proven[done] = low[good], high[good], True
        half *= 2.0
        left = np.flatnonzero(~proven & (half <= _WIDEST))
    return lower, upper, proven
