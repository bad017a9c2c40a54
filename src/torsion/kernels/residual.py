"""How well angles and torques satisfy the equations of a tree: each equation relative to the terms in it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.kernels.outward import Equations
from torsion.kernels.sweeps import Layout
from torsion.kernels.tree import ComplexArray, FloatArray

BLOCK_VALUES = 2**14  # stations times columns treated at once: 256 KiB of each array


@dataclass(frozen=True)
class Run:
    """Spans numbered in a row whose parents are numbered in a row as well; a chain is one run."""

    child: int
    parent: int
    count: int


@dataclass(frozen=True)
class Amplitudes:
    """An answer, and its magnitudes."""

    angle: ComplexArray  # (stations, columns) rad
    torque: ComplexArray  # (stations, columns) N m
    angle_size: FloatArray
    torque_size: FloatArray


@dataclass(frozen=True)
class Scratch:
    """Memory for the equations of one block, (stations of block, columns) each, used again and again."""

    error: ComplexArray
    scale: FloatArray  # sum of the magnitudes of the terms
    size: FloatArray

    @classmethod
    def of(cls, height: int, columns: int) -> "Scratch":
        """Scratch for blocks of `height` stations."""
        shape = height, columns
        return cls(np.empty(shape, dtype=np.complex128), np.empty(shape), np.empty(shape))

    def part(self, height: int) -> "Scratch":
        """The first lines."""
        return Scratch(self.error[:height], self.scale[:height], self.size[:height])


def runs(spans: Iterable[tuple[int, int]]) -> list[Run]:
    """Spans, (child, parent) each, in as few runs as they form in the order given."""
    found: list[list[int]] = []
    for child, parent in spans:
        if found and found[-1][0] + found[-1][2] == child and found[-1][1] + found[-1][2] == parent:
            found[-1][2] += 1
        else:
            found.append([child, parent, 1])
    return [Run(*run) for run in found]


def equilibrium_residual(plan: Layout, given: Equations, answer: Amplitudes) -> FloatArray:
    """Worst relative residual, (columns,), over every station that is not held and every span.

    Computed from the answer alone, so that it also sees what the sweeps could not know. An equation whose terms are
    all zero is satisfied.
    """
    size, columns = answer.angle.shape
    worst = np.zeros(columns)
    height = min(size, max(1, BLOCK_VALUES // max(columns, 1)))
    scratch = Scratch.of(height, columns)
    for start in range(0, size, height):
        block = slice(start, min(start + height, size))
        room = scratch.part(block.stop - start)
        for equations in (_of_stations, _of_spans):
            np.fmax(worst, np.fmax.reduce(equations(plan, given, answer, block, room), axis=0), out=worst)
    return worst


def _of_stations(plan: Layout, given: Equations, answer: Amplitudes, block: slice, room: Scratch) -> FloatArray:
    """Equilibrium of the torques on each station, (stations of block, columns)."""
    error = np.multiply(given.own[block], answer.angle[block], out=room.error)
    scale = np.abs(error, out=room.scale)
    error -= answer.torque[block]
    scale += answer.torque_size[block]
    for run in runs((child, i) for i in range(block.start, block.stop) for child in plan.children[i]):
        here, there = _rows(run.parent - block.start, run.count), _rows(run.child, run.count)
        error[here] += answer.torque[there]
        scale[here] += answer.torque_size[there]
    _take_in(room, given.force, block)
    return _relative(room, plan.held[block])


def _of_spans(plan: Layout, given: Equations, answer: Amplitudes, block: slice, room: Scratch) -> FloatArray:
    """Angles at both ends of each span and its own, (spans of block, columns)."""
    hc = given.compliance[block]
    hc = hc[:, None] if hc.ndim == 1 else hc
    error, scale = np.multiply(hc, answer.torque[block], out=room.error), room.scale
    if hc.shape[1] == 1:
        np.multiply(np.abs(hc), answer.torque_size[block], out=scale)
    else:
        np.abs(error, out=scale)
    error += answer.angle[block]
    scale += answer.angle_size[block]
    parents = plan.parent[block]
    for run in runs((i, parent) for i, parent in enumerate(parents, block.start) if parent >= 0):
        here, there = _rows(run.child - block.start, run.count), _rows(run.parent, run.count)
        error[here] -= answer.angle[there]
        scale[here] += answer.angle_size[there]
    _take_in(room, given.twist, block)
    return _relative(room, [parent < 0 for parent in parents])


def _rows(first: int, count: int) -> slice:
    return slice(first, first + count)


def _take_in(room: Scratch, given: Any, block: slice) -> None:
    """Subtract what is given of forces or twists."""
    for line, row in enumerate(given[block]):
        if row is not None:
            room.error[line] -= row
            room.scale[line] += np.abs(row)


def _relative(room: Scratch, without: list[bool]) -> FloatArray:
    """|error|/scale, 0 in the lines `without` an equation."""
    np.abs(room.error, out=room.size)
    np.divide(room.size, room.scale, out=room.size)
    if any(without):
        room.size[without] = 0
    return room.size
