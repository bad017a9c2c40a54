"""Sweeps of a chain from both ends side by side: the recurrence is the same, and a row costs little more than half."""

import numpy as np

from torsion.kernels.tree import FloatArray, IntArray


def both_ways(own: FloatArray, flexibility: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Dynamic stiffness (stations, 2m) of what lies behind each station in the sweep, itself included, and of the same
    seen through the next span (stations - 1, 2m), from `own` (stations, m) N m/rad.

    The first m columns go from the last station to the first, the others from the first to the last.
    """
    stations, columns = own.shape
    behind, through = np.empty((stations, 2 * columns)), np.empty((stations - 1, 2 * columns))
    behind[:, :columns], behind[:, columns:] = own[::-1], own
    spans = np.empty_like(through)
    spans[:, :columns], spans[:, columns:] = flexibility[:0:-1, None], flexibility[1:, None]
    add, reciprocal, rows = np.add, np.reciprocal, list(behind)
    here = rows[0]
    for span, seen, there in zip(spans, through, rows[1:], strict=True):
        reciprocal(here, seen)
        add(seen, span, seen)
        reciprocal(seen, seen)
        add(there, seen, there)
        here = there
    return behind, through


def spread(inner: FloatArray, outer: FloatArray, start: IntArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m): 1 at `start` (m,), from there products of `inner` inward and of `outer` outward, and the
    same inward of the start alone, where that is not zero.

    `inner` and `outer` (stations, m) at each station are for the span inward of it.
    """
    stations, columns = outer.shape
    column = np.arange(columns)
    angle = np.zeros((stations, 2 * columns))
    angle[stations - 1 - start, column] = 1.0
    angle[start, column + columns] = 1.0
    factor = np.empty((stations - 1, 2 * columns))
    factor[:, :columns], factor[:, columns:] = inner[:0:-1], outer[1:]
    add, multiply, rows, product = np.add, np.multiply, list(angle), np.empty(2 * columns)
    here = rows[0]
    for ratio, there in zip(factor, rows[1:], strict=True):
        multiply(here, ratio, product)
        add(there, product, there)
        here = there
    inward = angle[::-1, :columns]
    return np.where(inward != 0.0, inward, angle[:, columns:]), inward
