"""Counts and twisted vectors of one bidiagonal factor in a few passes each: dlaneg and dlar1v of LAPACK.

The matrix is L D L' with unit lower bidiagonal L: its Sturm count and its vectors need no entry of the product.
"""

import ctypes
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.lapack import call, routine

_DLANEG, _DLAR1V = "i iddddi", "v iiiddddddddiiddiidddd"
_SMALLEST_PIVOT = 2.3e-308  # both take it; neither needs it, as their arithmetic is IEEE's


@dataclass(frozen=True)
class BidiagonalFactor:
    """L D L' of n rows in the four arrays that LAPACK reads, contiguous float64."""

    diagonal: FloatArray  # (n,) D
    lower: FloatArray  # (n,) L below its diagonal; the last is unused
    product: FloatArray  # (n,) L D
    square: FloatArray  # (n,) L L D
    vector: FloatArray  # (n,) written by each twisted factorisation
    work: FloatArray  # (4 n,) likewise

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.diagonal)


@dataclass(frozen=True)
class Twisted:
    """What one twisted factorisation at a shift gives; the arrays last until the next one of the same matrix."""

    vector: FloatArray  # (n,) 1 at the row of the twist
    correction: float  # of the shift by Rayleigh's quotient
    twist: int  # row from which the vector was built
    factor: BidiagonalFactor

    def passed_on(self) -> FloatArray:
        """(twist,) what each row before the twist adds to the diagonal of the next one when it is eliminated."""
        size = self.factor.size
        return self.factor.work[2 * size + 1 : 2 * size + 1 + self.twist]

    def taken_back(self) -> FloatArray:
        """(n - 1 - twist,) what each row from the twist on has added to it when the next one is eliminated."""
        size, rows = self.factor.size, slice(self.twist, self.factor.size - 1)
        upper, pivot = self.factor.work[size : 2 * size - 1][rows], self.factor.work[3 * size + 1 :][rows]
        with np.errstate(all="ignore"):
            taken: FloatArray = pivot * (upper / self.factor.lower[rows])
        stiff = np.isinf(pivot)  # the next row is at rest
        taken[stiff] = self.factor.diagonal[rows][stiff]
        return taken


def are_available() -> bool:
    """Both routines are in this scipy, with 32-bit integers."""
    return routine("dlaneg", _DLANEG) is not None and routine("dlar1v", _DLAR1V) is not None


def negative_count(factor: BidiagonalFactor, shift: float) -> int:
    """Number of eigenvalues of L D L' below `shift`, for entries that differ by a few units of rounding."""
    size = factor.size
    found = call("dlaneg", _DLANEG, size, factor.diagonal, factor.square, shift, _SMALLEST_PIVOT, size)
    assert found is not None
    return int(found[0])


def twisted_vector(factor: BidiagonalFactor, shift: float) -> Twisted:
    """The vector of L D L' next to `shift`, as products either way from the row with the smallest residual.

    Componentwise accurate where the eigenvalue is well apart (Parlett and Dhillon 1997).
    """
    size, support = factor.size, (ctypes.c_int * 2)()
    found = call(
        "dlar1v", _DLAR1V, size, 1, size, shift, factor.diagonal, factor.lower, factor.product, factor.square,
        _SMALLEST_PIVOT, 0.0, factor.vector, 0, 0, 0.0, 0.0, 0, support, 0.0, 0.0, 0.0, factor.work,
    )  # fmt: skip
    assert found is not None
    return Twisted(factor.vector, correction=found[-1], twist=found[-4] - 1, factor=factor)
