"""Natural frequencies of a train with couplings whose stiffness follows the frequency: one certified root a mode.

For mode j, h(w) = ln w^2 - ln lambda_j(k(w)), with lambda_j the jth eigenvalue at the stiffness of w. The share of a
span in the elastic energy is d ln lambda_j/d ln k, and the shares add up to 1 at most: where d ln k/d ln w < 2 on every
piece of every table h rises strictly, so that there is exactly one root for each j. The same slope bounds how far the
root lies from a point near it, in addition to the Sturm counts that enclose lambda_j there.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import reach, table_path, taken_at
from torsion.errors import SolveError
from torsion.kernels.stiffness_laws import STEEPEST, StiffnessTable

Modes = Any  # analyses.undamped_modes.Modes, whose module imports this one
Tables = Mapping[int, StiffnessTable]
TAU = 2.0 * math.pi
MOST_STEPS = 100
ROUNDING = 16.0 * np.finfo(float).eps  # relative, of a stiffness read off a table and of a quotient


def tabled_modes(
    system: System, count: int | None, solve: Callable[[System, int | None], Modes]
) -> Modes:
    """Return the lowest `count` modes (None: all) of a system with tables over frequency, each at its own stiffness.

    solve: the lowest modes of a system of one stiffness. Modes above the reach of the tables are left out. Raises
    SolveError where a mode lies below it, and where the stiffness rises too steeply for one root a mode.
    """
    tables = system.tables_over("frequency")
    for span, table in tables.items():
        if table.steepest >= STEEPEST:
            piece = int(np.argmax(table.slopes.max(axis=0)))
            ends = " to ".join(f"{w / TAU:.6g}" for w in table.at[piece : piece + 2])
            message = f"the stiffness of '{system.spans[span].name}' rises faster than the square of the frequency"
            message += f" from {ends} Hz (d ln k/d ln ω = {table.steepest:.4g}, below 2 each mode has one frequency)"
            hint = "look for a slip in the table; the response is right"
            raise SolveError(message, hint, table_path(system, span))
    holds = all(table.holds for table in tables.values())
    low, high = reach(system)
    modes_at = lru_cache(maxsize=4)(lambda w: solve(taken_at(system, w), count))
    first = modes_at(low)
    last = modes_at(high)

    columns: list[tuple[Modes, int]] = []
    for mode, lowest in enumerate((TAU * first.frequency).tolist()):
        if TAU * float(last.frequency[mode]) > high:
            if not holds:
                break
            columns.append((last, mode))
        elif lowest <= low:
            if not holds:
                ending = {span: table for span, table in tables.items() if not table.holds}
                span = max(ending, key=lambda span: ending[span].at[0])
                name = system.spans[span].name
                begin = ending[span].at[0] / TAU
                message = (
                    f"mode {mode + 1} lies below {begin:.6g} Hz, where the table of '{name}' begins"
                )
                hint = f"extend the table (at its first stiffness the mode is at {lowest / TAU:.6g} Hz), or `beyond: hold`"
                raise SolveError(message, hint, table_path(system, span))
            columns.append((first, mode))
        else:
            # Newton's method over ln w, where h is nearly straight, with the exact slope; halving where it leaves.
            begin, end, w = low, high, TAU * lowest
            for _ in range(MOST_STEPS):
                modes = modes_at(w)
                excess = math.log(w / (TAU * float(modes.frequency[mode])))
                begin, end = (begin, w) if excess > 0.0 else (w, end)
                slope = STEEPEST - sum(
                    float(modes.elastic[span, mode]) * table.slope(w)
                    for span, table in tables.items()
                )
                before, w = w, w * math.exp(-STEEPEST * excess / slope)
                if not begin <= w <= end:
                    w = math.sqrt(begin * end)
                if abs(w - before) <= 0.25 * ROUNDING * before:
                    break
            else:
                message = f"mode {mode + 1} was not found to rounding at the stiffness of a table"
                raise SolveError(message)
            columns.append((_enclosed(tables, modes, mode, before), mode))

    def combined(name: str) -> FloatArray:
        none = getattr(first, name)[..., :0]
        values = (getattr(modes, name)[..., [mode]] for modes, mode in columns)
        return np.concatenate([none, *values], axis=-1)

    names = ("frequency", "lower", "upper", "shape", "torque")
    result = replace(
        first,
        **{name: combined(name) for name in names},
        certified=all(modes.certified for modes in (first, *(modes for modes, _ in columns))),
        system=system,
        distributed=None,
    )
    # Shares and nodes are those at the stiffness of each mode.
    vars(result).update({name: combined(name) for name in ("kinetic", "elastic", "nodes")})
    return result


def _enclosed(tables: Tables, modes: Modes, mode: int, w: float) -> Modes:
    """Return the modes with the bounds of the root: h and the least slope of h bound its distance."""
    slope = STEEPEST - max(table.steepest for table in tables.values())
    lower, upper = (
        math.log(w / (TAU * float(bound[mode]))) for bound in (modes.lower, modes.upper)
    )
    distance = 2.0 * (max(lower, -upper, 0.0) + ROUNDING) / slope
    bounds = np.array([modes.frequency, modes.lower, modes.upper])
    bounds[:, mode] = np.exp([0.0, -distance, distance]) * (w / TAU)
    result = replace(modes, frequency=bounds[0], lower=bounds[1], upper=bounds[2])
    shared = {name: getattr(modes, name) for name in ("kinetic", "elastic", "nodes")}
    vars(result).update(shared)
    return result
