"""Natural frequencies of a train with couplings whose stiffness follows the frequency: one certified root a mode.

For mode j, h(w) = ln w^2 - ln lambda_j(k(w)), with lambda_j the jth eigenvalue at the stiffness of w. The share of a
span in the elastic energy is d ln lambda_j/d ln k, and the shares add up to 1 at most: where d ln k/d ln w < 2 on every
piece of every table h rises strictly, so that there is exactly one root for each j. The same slope bounds how far the
root lies from a point near it, beside the Sturm counts that enclose lambda_j there.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any, Generic, Protocol, TypeVar, cast

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import reach, table_path, taken_at
from torsion.errors import SolveError
from torsion.kernels.stiffness_table import STEEPEST

BOUNDS, SHARED = ("frequency", "lower", "upper"), ("kinetic", "elastic", "nodes")
MOST_STEPS = 100  # of Newton, or of halving the bracket; 5 to 8 are usual
Modes = TypeVar("Modes", bound="Found")
ROUNDING = (
    16.0 * np.finfo(float).eps
)  # relative, of the stiffness read off a table and of a quotient of frequencies


class Found(Protocol):
    """What is read of modes here; they are results of another file."""

    @property
    def frequency(self) -> FloatArray:
        """(modes,) Hz, with its bounds."""

    @property
    def lower(self) -> FloatArray:
        """(modes,) Hz."""

    @property
    def upper(self) -> FloatArray:
        """(modes,) Hz."""

    @property
    def certified(self) -> bool:
        """Counts prove the bounds."""

    @property
    def elastic(self) -> FloatArray:
        """(spans, modes) shares of the elastic energy."""


Solve = Callable[[System, int | None], Modes]  # the lowest modes of a system of one stiffness


def tabled_modes(system: System, count: int | None, solve: Solve[Modes]) -> Modes:
    """The lowest `count` modes (None: all) of a system with tables over frequency, each at its own stiffness.

    Modes above the reach of the tables are left out. Raises SolveError where a mode lies below it, and where the
    stiffness rises too steeply for one root a mode.
    """
    _refuse_steep(system)
    low, high = reach(system)
    search = _Search(system, count, solve)
    first, last = search.at(low), search.at(high)
    found: list[tuple[Modes, int]] = []
    for mode in range(first.frequency.size):
        if _is_above(last, mode, high):
            if not _holds(system):
                break
            found.append((last, mode))
        elif not _is_above(first, mode, low):
            if not _holds(system):
                _refuse_below(system, mode, float(first.frequency[mode]), low)
            found.append((first, mode))
        else:
            found.append((search.root(mode, low, high), mode))
    return _combined(system, first, found)


def _holds(system: System) -> bool:
    """Beyond the reach the stiffness stays as it is."""
    return all(table.holds for table in system.tables_over("frequency").values())


def _is_above(found: Modes, mode: int, w: float) -> bool:
    """The eigenvalue at the stiffness of w lies above w^2, and so does the root."""
    return 2.0 * math.pi * float(found.frequency[mode]) > w


def _refuse_steep(system: System) -> None:
    for span, table in system.tables_over("frequency").items():
        if table.steepest >= STEEPEST:
            piece = int(np.argmax(table.slopes.max(axis=0)))
            ends = " to ".join(f"{w / (2.0 * math.pi):.6g}" for w in table.at[piece : piece + 2])
            message = f"the stiffness of '{system.spans[span].name}' rises faster than the square of the frequency"
            message += f" from {ends} Hz (d ln k/d ln ω = {table.steepest:.4g}, below 2 each mode has one frequency)"
            raise SolveError(
                message,
                "look for a slip in the table; the response is right",
                table_path(system, span),
            )


def _refuse_below(system: System, mode: int, hertz: float, low: float) -> None:
    span = next(
        s
        for s, table in system.tables_over("frequency").items()
        if not table.holds and table.at[0] == low
    )
    name, begins = system.spans[span].name, low / (2.0 * math.pi)
    message = f"mode {mode + 1} lies below {begins:.6g} Hz, where the table of '{name}' begins"
    hint = f"extend the table (at its first stiffness the mode is at {hertz:.6g} Hz), or `beyond: hold`"
    raise SolveError(message, hint, table_path(system, span))


class _Search(Generic[Modes]):
    """Modes at the stiffness of one frequency after another."""

    def __init__(self, system: System, count: int | None, solve: Solve[Modes]) -> None:
        self.system, self.count, self.solve = system, count, solve
        self.tables = system.tables_over("frequency")
        self.at = lru_cache(maxsize=4)(self._at)
        self.near: float | None = None  # rad/s of the root found last

    def _at(self, w: float) -> Modes:
        """All that are requested, at the stiffness of w (rad/s)."""
        return self.solve(taken_at(self.system, w), self.count)

    def root(self, mode: int, low: float, high: float) -> Modes:
        """The modes at the frequency of the mode, which lies in [low, high] rad/s, its bounds those of the root."""
        begin = low if self.near is None else self.near
        w = min(max(2.0 * math.pi * float(self.at(begin).frequency[mode]), low), high)
        for _ in range(MOST_STEPS):
            found = self.at(w)
            excess = math.log(w / (2.0 * math.pi * float(found.frequency[mode])))  # h/2
            low, high = (low, w) if excess > 0.0 else (w, high)
            rising = STEEPEST - sum(
                float(found.elastic[span, mode]) * table.slope(w)
                for span, table in self.tables.items()
            )
            before, w = w, w * math.exp(-2.0 * excess / rising)
            if not low <= w <= high:
                w = math.sqrt(low * high)
            if abs(w - before) <= ROUNDING / 4.0 * before:
                self.near = before
                return self._enclosed(mode, before, found)
        raise SolveError(
            f"mode {mode + 1} of a train with a table over frequency was not found to rounding"
        )

    def _enclosed(self, mode: int, w: float, found: Modes) -> Modes:
        """The same with the bounds of the root: h and the least that it rises by say how far off it is."""
        least = STEEPEST - max(table.steepest for table in self.tables.values())
        lower, upper = (
            math.log(w / (2.0 * math.pi * float(bound[mode])))
            for bound in (found.lower, found.upper)
        )
        off = 2.0 * (max(lower, -upper, 0.0) + ROUNDING) / least
        bounds = np.array([found.frequency, found.lower, found.upper])
        bounds[:, mode] = np.array([1.0, math.exp(-off), math.exp(off)]) * (w / (2.0 * math.pi))
        return _with(
            found,
            dict(zip(BOUNDS, bounds, strict=True)),
            {name: getattr(found, name) for name in SHARED},
        )


def _combined(system: System, first: Modes, found: list[tuple[Modes, int]]) -> Modes:
    """Each mode as found at its own stiffness, side by side; shares and nodes are those at that stiffness."""

    def columns(name: str) -> np.ndarray:
        none = getattr(first, name)[..., :0]
        return np.concatenate(
            [none, *(getattr(one, name)[..., mode : mode + 1] for one, mode in found)], axis=-1
        )

    certified = all(one.certified for one in (first, *(one for one, _ in found)))
    values: dict[str, Any] = {name: columns(name) for name in (*BOUNDS, "shape", "torque")}
    values |= {"certified": certified, "system": system, "distributed": None}
    return _with(first, values, {name: columns(name) for name in SHARED})


def _with(found: Modes, values: dict[str, Any], shared: dict[str, Any]) -> Modes:
    """The same with other values, and with shares and nodes that no longer follow from them."""
    again: Any = replace(found, **values)  # type: ignore[type-var]
    vars(again).update(shared)
    return cast("Modes", again)
