"""How well angles and torques satisfy the equations of a tree: each equation relative to the terms in it."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.sweeps import Equations, Layout

BLOCK_VALUES = 2**14  # stations times columns treated at once: 256 KiB of each array


@dataclass(frozen=True)
class Amplitudes:
    """An answer, and its magnitudes."""

    angle: ComplexArray  # (stations, columns) rad
    torque: ComplexArray  # (stations, columns) N m
    angle_size: FloatArray
    torque_size: FloatArray


def equilibrium_residual(plan: Layout, given: Equations, angle: ComplexArray, torque: ComplexArray) -> FloatArray:
    """Worst relative residual, (columns,), over every station that is not fixed and every span.

    Computed from the answer alone, so that it also sees what the sweeps could not know. An equation whose terms are
    all zero is satisfied.
    """
    size, columns = angle.shape
    answer = Amplitudes(angle, torque, np.abs(angle), np.abs(torque))
    worst = np.zeros(columns)
    height = min(size, max(1, BLOCK_VALUES // max(columns, 1)))
    errors, (scales, sizes) = np.empty((height, columns), dtype=np.complex128), np.empty((2, height, columns))
    for start in range(0, size, height):
        block = slice(start, min(start + height, size))
        error, scale, relative = (part[: block.stop - start] for part in (errors, scales, sizes))
        stations = _of_stations, given.force, plan.held
        spans = _of_spans, given.twist, [parent < 0 for parent in plan.parent]
        for equations, acting, without in (stations, spans):
            equations(plan, given, answer, block, error, scale)
            for line, row in enumerate(acting[block]):
                if row is not None:
                    error[line] -= row
                    scale[line] += np.abs(row)
            np.abs(error, out=relative)
            np.divide(relative, scale, out=relative)
            relative[without[block]] = 0
            np.fmax(worst, np.fmax.reduce(relative, axis=0), out=worst)
    return worst


def _of_stations(
    plan: Layout, given: Equations, answer: Amplitudes, block: slice, error: ComplexArray, scale: FloatArray
) -> None:
    """Equilibrium of the torques on each station, and the magnitudes in it, (stations of block, columns) each."""
    np.multiply(given.own[block], answer.angle[block], out=error)
    np.abs(error, out=scale)
    error -= answer.torque[block]
    scale += answer.torque_size[block]
    for there, here in _runs((child, i) for i in range(block.start, block.stop) for child in plan.children[i]):
        mine = slice(here.start - block.start, here.stop - block.start)
        error[mine] += answer.torque[there]
        scale[mine] += answer.torque_size[there]


def _of_spans(
    plan: Layout, given: Equations, answer: Amplitudes, block: slice, error: ComplexArray, scale: FloatArray
) -> None:
    """Angles at both ends of each span and its own, and the magnitudes in them, (spans of block, columns) each."""
    hc = given.compliance[block]
    hc = hc[:, None] if hc.ndim == 1 else hc
    np.multiply(hc, answer.torque[block], out=error)
    if hc.shape[1] == 1:
        np.multiply(np.abs(hc), answer.torque_size[block], out=scale)
    else:
        np.abs(error, out=scale)
    error += answer.angle[block]
    scale += answer.angle_size[block]
    inner = plan.parent[block]
    for here, there in _runs((i, parent) for i, parent in enumerate(inner, block.start) if parent >= 0):
        mine = slice(here.start - block.start, here.stop - block.start)
        error[mine] -= answer.angle[there]
        scale[mine] += answer.angle_size[there]


def _runs(spans: Iterable[tuple[int, int]]) -> list[tuple[slice, slice]]:
    """Spans, (child, parent) each, in as few runs of both as they form in the order given; a chain is one run."""
    found: list[list[int]] = []
    for child, parent in spans:
        if found and found[-1][0] + found[-1][2] == child and found[-1][1] + found[-1][2] == parent:
            found[-1][2] += 1
        else:
            found.append([child, parent, 1])
    return [(slice(child, child + count), slice(parent, parent + count)) for child, parent, count in found]
