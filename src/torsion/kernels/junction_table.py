"""Excess length of the junction of two round shafts of one bore, from a table of finite elements.

The table has the values at Chebyshev's points over bore / diameter, the logarithm of the height of the step / diameter,
and (fillet radius / height)^(2/3); the polynomial through them is evaluated (Berrut and Trefethen 2004, SIAM Rev.
46:501, eq. 4.2). The power is that of the field at a corner, so that the values are smooth over it.
"""

import math
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from torsion.arrays import FloatArray

# Bore, height of the step (both / diameter); radius / height.
LOWEST, HIGHEST = (0.0, 0.01, 0.0), (0.8, 1.5, 1.0)
SIZES = (7, 16, 8)
NODES = tuple(-np.cos(math.pi * np.arange(size) / (size - 1)) for size in SIZES)  # from -1 to 1
FILE = "junction_table.txt"


@dataclass(frozen=True)
class JunctionTable:
    """The values, and how far the polynomial was from the finite elements at places between them."""

    values: FloatArray  # SIZES; lengths of the smaller shaft / its diameter
    error: float  # largest at places between its own, with that of the elements themselves

    def excess_length(self, bore: float, height: float, fillet: float) -> float | None:
        """In units of the smaller diameter, as all three arguments; None outside of the table.

        >>> round(junction_table().excess_length(0.0, 0.5, 0.0), 4)
        0.1257
        """
        sizes = (bore, height, fillet / height if height else math.inf)
        if not all(
            low <= size <= high for low, size, high in zip(LOWEST, sizes, HIGHEST, strict=True)
        ):
            return None
        low, point, high = (np.array(_smooth(corner)) for corner in (LOWEST, sizes, HIGHEST))
        values = self.values
        for coordinate, nodes in zip((2.0 * point - low - high) / (high - low), NODES, strict=True):
            away, sign = coordinate - nodes, (-1.0) ** np.arange(len(nodes))
            sign[[0, -1]] /= 2.0
            weights = (np.abs(away) < 1e-14).astype(float)  # rounding of a place: it is a node
            if not weights.any():
                weights = sign / away
            values = np.tensordot(weights / weights.sum(), values, axes=1)
        return float(values)


@cache
def junction_table() -> JunctionTable:
    """The table as it was computed, read once."""
    text = files("torsion.kernels").joinpath(FILE).read_text(encoding="utf-8").split()
    return JunctionTable(np.array(text[1:], dtype=float).reshape(SIZES), float(text[0]))


def _smooth(sizes: tuple[float, float, float]) -> tuple[float, float, float]:
    bore, height, fillet = sizes
    return bore, math.log(height), fillet ** (2.0 / 3.0)
