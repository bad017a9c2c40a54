"""Runs of many methods in turn, so that a slow minute of the machine falls on all alike."""

import gc
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np

from torsion.analyses.study.rows import TimedRow
from torsion.errors import SolveError
from torsion.findings import Progress

ROUNDING = 1e-12  # relative error from which a finer division cannot show more than rounding
SLOW, SLOW_ROUNDS = 0.3, 3  # s of one run, from which a method has its turn in so many rounds alone
RUNS_A_TURN = 5  # at most, of a method that is fast
TURN = 0.01  # s, filled with runs of a fast method


@dataclass(frozen=True)
class Effort:
    """How much is run."""

    rounds: int  # in which every method has its turn
    longest: float  # s of one run, after which a curve has no finer division
    segments: int  # lumped, most a shaft
    unknowns: int  # of finite elements, most a shaft: degree times elements
    degrees: tuple[int, ...]
    modes: int  # most of a superposition
    dense: int  # segments, most a shaft, of a dense solve
    speeds: int


FULL = Effort(7, 1.5, 1024, 128, tuple(range(1, 11)), 64, 256, 25)
QUICK = Effort(3, 0.3, 256, 24, (1, 2, 4, 8), 16, 64, 9)


@dataclass(frozen=True)
class Method:
    """One way to compute a quantity, in the two steps that are timed apart."""

    curve: str
    division: str
    size: int
    assemble: Callable[[], Any]
    solve: Callable[[Any], Any]
    errors: Callable[[Any], tuple[float, ...]]


@dataclass
class _Tried:
    method: Method
    errors: tuple[float, ...]
    first: float  # s of the run that warmed up, which is no sample
    assembly: list[float] = field(default_factory=list)
    solve: list[float] = field(default_factory=list)


def timed(
    curves: Sequence[Sequence[Method]], effort: Effort, what: str, progress: Progress
) -> tuple[tuple[TimedRow, ...], tuple[str, ...]]:
    """The rows of all curves, and what was not run, in words.

    Each method is run once for its errors, which warms up as well; then all have their turn in every round. A curve
    ends where a run takes longer than `effort.longest` or where two divisions in a row err by rounding alone.
    """
    tried, remarks, ended = list[_Tried](), list[str](), list[str]()
    for number, curve in enumerate(curves):
        progress(f"{what}: errors", 0.3 * number / len(curves))
        found, remark = _tried(curve, effort)
        tried += found
        remarks += [remark] if remark else []
        if not remark and len(found) < len(curve):
            ended.append(curve[0].curve)
    if ended:
        remarks.append(f"Finer divisions are not run where rounding alone is left: {', '.join(ended)}.")
    for turn in range(effort.rounds):
        gc.collect()
        for number, one in enumerate(tried):
            if turn >= SLOW_ROUNDS and one.first > SLOW:
                continue
            progress(f"{what}: times", 0.3 + 0.7 * (turn + number / len(tried)) / effort.rounds)
            _turn(one)
    rows = (
        TimedRow(one.method.curve, one.method.division, one.method.size, one.errors, tuple(one.assembly),
                 tuple(one.solve))
        for one in tried
    )  # fmt: skip
    return tuple(rows), tuple(remarks)


def _tried(curve: Sequence[Method], effort: Effort) -> tuple[list[_Tried], str]:
    """What was run of a curve, and why it ends before its end, unless rounding alone is left."""
    found = list[_Tried]()
    for number, method in enumerate(curve):
        try:
            answer, assembly, solve = _run(method)
            if assembly + solve > effort.longest:  # the first run of all loads what a method needs
                answer, assembly, solve = _run(method)
        except (SolveError, np.linalg.LinAlgError) as error:
            return found, f"{method.curve}, {method.division}: {error}"
        found.append(_Tried(method, method.errors(answer), assembly + solve))
        left = len(curve) - number - 1
        if left and found[-1].first > effort.longest:
            took = f"one run of {method.division} takes {found[-1].first:.2g} s"
            return found, f"{method.curve}: finer divisions are not run ({left}), as {took}."
        if left and len(found) > 1 and all(max(one.errors) < ROUNDING for one in found[-2:]):
            break
    return found, ""


def _turn(one: _Tried) -> None:
    """A run, or as many as fit into a turn where they are fast."""
    for _ in range(max(1, min(RUNS_A_TURN, int(TURN / one.first)))):
        _, assembly, solve = _run(one.method)
        one.assembly.append(assembly)
        one.solve.append(solve)


def _run(method: Method) -> tuple[Any, float, float]:
    """The answer, and seconds of assembly and solve."""
    was = gc.isenabled()
    gc.disable()
    try:
        start = perf_counter()
        made = method.assemble()
        between = perf_counter()
        answer = method.solve(made)
        return answer, between - start, perf_counter() - between
    finally:
        if was:
            gc.enable()
