"""Curves as SVG paths in tenths of px: broken where there is no value, and without points that nobody can see."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.output.figures.figure import runs

MOST_POINTS = 4  # in a column of one px
BESIDE, PASSES = (
    0.5,
    12,
)  # tenths of px beside a chord, which nobody can see; looks at a curve, at most
FAR = 2e5  # tenths of px: beyond the plot in any case


def decimated(x: FloatArray, y: FloatArray, columns: int) -> IntArray:
    """Return positions of the points to draw: all, or first, least, greatest and last of each of equal bins.

    The bins are of x where it goes on, otherwise of the number of points.

    >>> decimated(np.arange(100.0), np.sin(np.arange(100.0)), 2)
    array([ 0, 11, 33, 49, 50, 55, 77, 99])
    """
    count = x.size
    if count <= MOST_POINTS * columns:
        return np.arange(count)
    goes_on = bool(np.all(np.diff(x) >= 0)) and x[-1] > x[0]
    share = (x - x[0]) / (x[-1] - x[0]) if goes_on else np.arange(count) / count
    bins = np.minimum((share * columns).astype(np.int64), columns - 1)
    starts = np.flatnonzero(np.diff(bins, prepend=-1))
    ends = np.append(starts[1:], count) - 1
    by_size = np.lexsort((y, bins))  # bins stay where they are
    return np.unique(np.concatenate([starts, by_size[starts], by_size[ends], ends]))


def path(x: FloatArray, y: FloatArray, columns: int) -> str:
    """Return the path of points in tenths of px; NaN breaks the line."""
    pieces = []
    finite = np.isfinite(x) & np.isfinite(y)
    for first, last in runs(finite):
        across, up = x[first : last + 1], y[first : last + 1]
        kept = decimated(across, up, max(1, round(columns * across.size / x.size)))
        pieces.append(_piece(across[kept], up[kept]))
    return "".join(pieces)


def area(x: FloatArray, y: FloatArray, base: FloatArray, columns: int) -> str:
    """Return the path around the area between two lines over one coordinate."""
    pieces = []
    for first, last in runs(np.isfinite(x) & np.isfinite(y) & np.isfinite(base)):
        across = x[first : last + 1]
        upper, lower = (
            decimated(across, line[first : last + 1], columns) + first for line in (y, base)
        )
        forth, back = np.append(x[upper], x[lower][::-1]), np.append(y[upper], base[lower][::-1])
        pieces.append(_piece(forth, back) + "z")
    return "".join(pieces)


def _piece(x: FloatArray, y: FloatArray) -> str:
    """Return one line without a gap, by steps."""
    places = np.clip(x, -FAR, FAR) + 1j * np.clip(y, -FAR, FAR)
    # Without points next to the chord of their neighbours, unless the line turns back there.
    for start in (1, 2) * PASSES:  # every other point, so that its neighbours stay
        back = places[start:-1:2] - places[start - 1 : -2 : 2]
        chord = places[start + 1 :: 2] - places[start - 1 : -2 : 2]
        length, product = np.abs(chord), back * chord.conj()
        off, along = np.abs(product.imag), product.real
        is_between = (off <= BESIDE * length) & (along >= 0.0) & (along <= length**2)
        if start == 2 and not is_between.any():
            break
        kept = np.ones(places.size, dtype=bool)
        kept[start:-1:2] = ~is_between
        places = places[kept]
    signs = places.view(np.float64).reshape(-1, 2).round().astype(np.int64)
    steps = np.diff(signs, axis=0)
    steps = steps[steps.any(axis=1)]
    if steps.size == 0:
        return f"M{signs[0, 0] - 5} {signs[0, 1]}h10"
    return outline([signs[0].tolist(), *steps.tolist()])


def outline(start_and_steps: Sequence[Sequence[int]]) -> str:
    """Return a path from a place by steps, in as few signs as there can be.

    >>> outline([(10, 20), (5, -3), (-1, 0)])
    'M10 20l5-3-1 0'
    """
    (x, y), *steps = start_and_steps
    words = " ".join(str(step_length) for step in steps for step_length in step).replace(" -", "-")
    return f"M{x} {y}l{words}"
