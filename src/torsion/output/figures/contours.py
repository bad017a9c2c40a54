"""Lines on which values on a grid have one value."""

from collections.abc import Iterator

import numpy as np

from torsion.arrays import BoolArray, FloatArray


def level_line(
    x: FloatArray, y: FloatArray, values: FloatArray, level: float = 0.0
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield pieces (x, y) on which values (rows, columns), linear along the sides of each square, are the level."""
    z = values - level
    for row in range(z.shape[0] - 1):
        for column in np.flatnonzero(_changes(z[row : row + 2])).tolist():
            corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
            met = []
            for (r0, c0), (r1, c1) in zip(corners, corners[1:] + corners[:1], strict=True):
                a, b = float(z[r0, c0]), float(z[r1, c1])
                if (a > 0) != (b > 0):
                    share = a / (a - b)
                    met.append((x[c0] + share * (x[c1] - x[c0]), y[r0] + share * (y[r1] - y[r0])))
            for first, last in zip(met[::2], met[1::2], strict=False):
                yield np.array([first[0], last[0]]), np.array([first[1], last[1]])


def _changes(pair: FloatArray) -> BoolArray:
    """Return (columns - 1,) whether the sign changes in the square, all of whose values are known."""
    four = np.stack([pair[0, :-1], pair[0, 1:], pair[1, :-1], pair[1, 1:]])
    above = (four > 0).sum(axis=0)
    return np.asarray(np.isfinite(four).all(axis=0) & (above > 0) & (above < 4))
