"""Counts and twisted vectors of one bidiagonal factor in a few passes each: dlaneg and dlar1v of LAPACK.

scipy ships both without a wrapper of its own; they are called through the pointers it publishes for compiled code. The
matrix is L D L' with unit lower bidiagonal L: its Sturm count and its vectors need no entry of the product.
"""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from torsion.kernels.tree import FloatArray

_INTEGERS_OF_DLANEG = (0, 5)  # positions of the arguments that are `int *`; all others are `double *`
_INTEGERS_OF_DLAR1V = (0, 1, 2, 11, 12, 15, 16)
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


@cache
def are_available() -> bool:
    """Both routines are in this scipy, with 32-bit integers."""
    return _dlaneg() is not None and _dlar1v() is not None


def negative_count(factor: BidiagonalFactor, shift: float) -> int:
    """Number of eigenvalues of L D L' below `shift`, for entries that differ by a few units of rounding."""
    count = _dlaneg()
    assert count is not None
    size = ctypes.byref(ctypes.c_int(factor.size))
    pivot = ctypes.byref(ctypes.c_double(_SMALLEST_PIVOT))
    at = ctypes.byref(ctypes.c_double(shift))
    return int(count(size, factor.diagonal.ctypes.data, factor.square.ctypes.data, at, pivot, size))


def twisted_vector(factor: BidiagonalFactor, shift: float) -> Twisted:
    """The vector of L D L' next to `shift`, as products outward from the row with the smallest residual.

    Componentwise accurate where the eigenvalue is well apart (Parlett and Dhillon 1997).
    """
    solve = _dlar1v()
    assert solve is not None
    size = factor.size
    n, first, choose, count, twist = (ctypes.c_int(value) for value in (size, 1, 0, 0, 0))
    support = (ctypes.c_int * 2)()
    at, pivot, gap = (ctypes.c_double(value) for value in (shift, _SMALLEST_PIVOT, 0.0))
    norm, least, inverse, residual, correction = (ctypes.c_double() for _ in range(5))
    solve(
        *(ctypes.byref(value) for value in (n, first, n, at)),
        *(part.ctypes.data for part in (factor.diagonal, factor.lower, factor.product, factor.square)),
        *(ctypes.byref(pivot), ctypes.byref(gap), factor.vector.ctypes.data),
        *(ctypes.byref(value) for value in (choose, count, norm, least, twist)),
        support,
        *(ctypes.byref(value) for value in (inverse, residual, correction)),
        factor.work.ctypes.data,
    )
    return Twisted(factor.vector, correction.value, twist.value - 1, factor)


@cache
def _dlaneg() -> Callable[..., Any] | None:
    return _routine("dlaneg", ctypes.c_int, "int", 6, _INTEGERS_OF_DLANEG)


@cache
def _dlar1v() -> Callable[..., Any] | None:
    return _routine("dlar1v", None, "void", 21, _INTEGERS_OF_DLAR1V)


def _routine(
    name: str, returns: type[ctypes.c_int] | None, answer: str, arguments: int, integers: tuple[int, ...]
) -> Callable[..., Any] | None:
    """The routine `name`; None where its capsule is absent or its signature is not the one expected."""
    from scipy.linalg import cython_lapack

    capsule = getattr(cython_lapack, "__pyx_capi__", {}).get(name)
    if capsule is None:
        return None
    name_of = ctypes.PYFUNCTYPE(ctypes.c_char_p, ctypes.py_object)(("PyCapsule_GetName", ctypes.pythonapi))
    address_of = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    signature: bytes = name_of(capsule)
    if not is_expected(signature.decode("ascii"), answer, arguments, integers):
        return None
    prototype = ctypes.CFUNCTYPE(returns, *([ctypes.c_void_p] * arguments))
    return prototype(address_of(capsule, signature))


def is_expected(signature: str, answer: str, arguments: int, integers: tuple[int, ...]) -> bool:
    """Whether a capsule's signature has that answer and number of arguments, `int *` exactly at `integers`.

    >>> is_expected("int (int *, double *)", "int", 2, (0,)), is_expected("int (long *, double *)", "int", 2, (0,))
    (True, False)
    """
    head, _, rest = signature.partition(" (")
    kinds = [kind.strip() for kind in rest.rstrip(")").split(",")]
    if head != answer or len(kinds) != arguments:
        return False
    doubles = [kind for position, kind in enumerate(kinds) if position not in integers]
    return all(kinds[position] == "int *" for position in integers) and all(
        kind == "double *" or kind.endswith("_d *") for kind in doubles
    )
