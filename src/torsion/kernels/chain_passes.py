"""Sweeps of a chain from both ends side by side: the recurrence is the same, and a row costs little more than half."""

from itertools import pairwise

import numpy as np

from torsion.kernels.tree import FloatArray, IntArray


def both_ways(own: FloatArray, flexibility: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Dynamic stiffness (stations, 2m) of what lies behind each station in the sweep, itself included; the inverse of
    that, and the same seen through the next span (stations - 1, 2m each), from `own` (stations, m) N m/rad.

    The first m columns go from the last station to the first, the others from the first to the last.
    """
    stations, columns = own.shape
    behind, (inverse, through) = np.empty((stations, 2 * columns)), np.empty((2, stations - 1, 2 * columns))
    behind[:, :columns], behind[:, columns:] = own[::-1], own
    through[:, :columns], through[:, columns:] = flexibility[:0:-1, None], flexibility[1:, None]
    add, reciprocal, rows = np.add, np.reciprocal, list(behind)
    here = rows[0]
    for turned, seen, there in zip(inverse, through, rows[1:], strict=True):
        reciprocal(here, turned)
        add(seen, turned, seen)
        reciprocal(seen, seen)
        add(there, seen, there)
        here = there
    return behind, inverse, through


def spread(inward: FloatArray, outward: FloatArray, start: IntArray) -> FloatArray:
    """Angles (stations, m): 1 at `start` (m,), from there products of `inward` inward and of `outward` outward.

    `inward` and `outward` (stations - 1, m) are for the span between a station and the next.
    """
    spans, columns = outward.shape
    is_inward = np.arange(spans)[:, None] < start
    factor = np.ones((spans, 2 * columns))
    np.copyto(factor[:, :columns], inward[::-1], where=is_inward[::-1])
    np.copyto(factor[:, columns:], outward, where=~is_inward)
    multiply, rows = np.multiply, list(factor)
    for before, here in pairwise(rows):
        multiply(before, here, here)
    angle = np.ones((spans + 1, columns))
    angle[:-1] = factor[::-1, :columns]
    angle[1:] *= factor[:, columns:]
    return angle
