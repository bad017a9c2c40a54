"""Every method on one line: error, and the time of assembly and solution apart; the methods take turns."""

import gc
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from time import process_time
from typing import Any

import numpy as np

from benchmarks import accuracy_references as references
from benchmarks.accuracy_methods import MODES, Method
from benchmarks.accuracy_scenes import Line


@dataclass
class Row:
    """What one method at one fineness answered, and in what time."""

    family: str
    name: str
    error: float = float("nan")
    fault: str = ""
    assembly: list[float] = field(default_factory=list)  # s of the processor, of each call
    solution: list[float] = field(default_factory=list)  # s

    @property
    def total(self) -> list[float]:
        """Assembly and solution of each call, s."""
        return [a + s for a, s in zip(self.assembly, self.solution, strict=True)]

    @property
    def seconds(self) -> float:
        """The median of the whole calls."""
        return statistics.median(self.total)


@dataclass(frozen=True)
class Effort:
    """How much to do."""

    segments: tuple[int, ...]
    degrees: tuple[int, ...]
    unknowns: int  # of finite elements of a shaft, at most
    peer: tuple[int, ...]  # elements a line
    rounds: int
    patience: float  # s; a call that takes longer is made once more
    frequencies: int  # of a response


FULL = Effort(
    segments=(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024),
    degrees=tuple(range(1, 11)),
    unknowns=260,
    peer=(6, 12, 24, 48, 96, 192, 336),
    rounds=5,
    patience=0.4,
    frequencies=40,
)
QUICK = Effort(
    segments=(1, 4, 16, 64), degrees=(1, 2, 10), unknowns=70, peer=(6, 24, 96), rounds=2, patience=0.2, frequencies=8
)


def mode_rows(methods: Sequence[Method], exact: Sequence[Any], rounds: int, patience: float) -> list[Row]:
    """The largest relative error of the first ten frequencies."""

    def error(found: np.ndarray) -> float:
        return references.worst(found, exact)

    return _rows([(method, method.modes) for method in methods], error, rounds, patience)


def torque_rows(line: Line, methods: Sequence[Method], w: np.ndarray, rounds: int, patience: float) -> list[Row]:
    """The largest error of the torques at the middles of the shafts, over the largest of them at that frequency."""
    exact = references.middle_torques(line, w.tolist())
    largest = np.abs(exact).max(axis=0)

    def error(found: np.ndarray) -> float:
        return float((np.abs(found - exact) / largest).max())

    pairs = [(method, _at(method.torques, w)) for method in methods if method.torques is not None]
    return _rows(pairs, error, rounds, patience)


def frequencies(exact: Sequence[Any], count: int) -> np.ndarray:
    """Random rad/s, even in the logarithm, from half the first natural frequency to the tenth."""
    low, high = float(exact[0]) / 2, float(exact[MODES - 1])
    return 2 * np.pi * np.exp(np.random.default_rng(4).uniform(np.log(low), np.log(high), count))


def _at(torques: Callable[[Any, np.ndarray], np.ndarray], w: np.ndarray) -> Callable[[Any], np.ndarray]:
    return lambda assembled: torques(assembled, w)


def _rows(
    programs: Sequence[tuple[Method, Callable[[Any], np.ndarray]]],
    error: Callable[[np.ndarray], float],
    rounds: int,
    patience: float,
) -> list[Row]:
    """One call of each to warm up, from which the error is taken; then rounds in which each is called once.

    A call that took longer than the patience (s) is repeated once.
    """
    rows, turning = [], []
    for method, solve in programs:
        row = Row(method.family, method.name)
        try:
            row.error = error(_called(method, solve, row))
        except Exception as fault:  # peers fail in ways of their own; the page states each in its words
            row.fault = f"{type(fault).__name__}: {fault}".splitlines()[0][:100]
        rows.append(row)
        warm = row.total
        row.assembly.clear()
        row.solution.clear()
        if not row.fault and warm[0] < patience:
            turning.append((method, solve, row))
        elif not row.fault:
            _called(method, solve, row)
    for _ in range(rounds):
        gc.collect()
        for method, solve, row in turning:
            _called(method, solve, row)
    return rows


def _called(method: Method, solve: Callable[[Any], np.ndarray], row: Row) -> np.ndarray:
    gc.disable()
    try:
        start = process_time()
        assembled = method.assemble()
        middle = process_time()
        found = solve(assembled)
        stop = process_time()
    finally:
        gc.enable()
    row.assembly.append(middle - start)
    row.solution.append(stop - middle)
    return found


def best(rows: Sequence[Row], tolerance: float) -> Row | None:
    """The fastest row whose error is within the tolerance."""
    good = [row for row in rows if row.error <= tolerance]
    return min(good, key=lambda row: row.seconds, default=None)


def frontier(rows: Sequence[Row]) -> list[Row]:
    """The rows of an error below 1 that no other beats in both error and time, fastest first."""
    found: list[Row] = []
    for row in sorted((row for row in rows if row.error < 1.0), key=lambda row: (row.seconds, row.error)):
        if not found or row.error < found[-1].error:
            found.append(row)
    return found
