"""Singular values of high relative accuracy: two LAPACK routines that scipy ships but does not wrap.

scipy publishes every LAPACK routine as a capsule for compiled code; ctypes can call the same pointer. A capsule tells
its signature, and one that does not use 32-bit `int *` is not called: slower public routines then do the same.
"""

import ctypes
from collections.abc import Callable
from functools import cache

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.tree import FloatArray

# Smallest tolerance that dstebz accepts; its own default is relative to the largest value and loses the small ones.
_STEBZ_TOLERANCE = 4.5e-308
_DGEJSV_FULL_ACCURACY = 2  # joba='F': columns are scaled, rows may be badly scaled too


@cache
def routine(name: str) -> Callable[..., None] | None:
    """LAPACK subroutine `name` of scipy's own library, or None where its capsule is absent or not `int *`.

    >>> routine("not_a_routine") is None
    True
    """
    from scipy.linalg import cython_lapack

    capsule = getattr(cython_lapack, "__pyx_capi__", {}).get(name)
    if capsule is None:
        return None
    name_of = ctypes.PYFUNCTYPE(ctypes.c_char_p, ctypes.py_object)(("PyCapsule_GetName", ctypes.pythonapi))
    address_of = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    signature: bytes = name_of(capsule)
    if not signature.startswith(b"void (") or not signature.endswith(b"int *)"):
        return None
    arguments = signature.count(b",") + 1
    prototype = ctypes.CFUNCTYPE(None, *([ctypes.c_void_p] * arguments))
    return prototype(address_of(capsule, signature))


def bidiagonal_singular_values(diagonal: FloatArray, off_diagonal: FloatArray) -> FloatArray:
    """Singular values (n,), descending, of the upper bidiagonal matrix, each to full relative accuracy.

    `diagonal` (n,), `off_diagonal` (n - 1,). dlasq1 (Fernando and Parlett 1994); without it, bisection on the
    Golub-Kahan matrix.
    """
    dlasq1 = routine("dlasq1")
    size = len(diagonal)
    if dlasq1 is None:
        return golub_kahan_singular_values(diagonal, off_diagonal)
    values = np.array(diagonal, dtype=np.float64)
    off = np.zeros(size)
    off[: size - 1] = off_diagonal
    work = np.empty(4 * size)
    order, info = ctypes.c_int(size), ctypes.c_int(0)
    dlasq1(ctypes.byref(order), _at(values), _at(off), _at(work), ctypes.byref(info))
    if info.value != 0:
        return golub_kahan_singular_values(diagonal, off_diagonal)
    return values


def golub_kahan_singular_values(diagonal: FloatArray, off_diagonal: FloatArray) -> FloatArray:
    """Like `bidiagonal_singular_values`, by bisection (dstebz) on the interleaved tridiagonal matrix; slower."""
    from scipy.linalg import eigh_tridiagonal

    size = len(diagonal)
    off = np.empty(2 * size - 1)
    off[0::2] = diagonal
    off[1::2] = off_diagonal
    values = eigh_tridiagonal(np.zeros(2 * size), off, eigvals_only=True, lapack_driver="stebz", tol=_STEBZ_TOLERANCE)
    return np.maximum(np.asarray(values, dtype=np.float64)[size:][::-1], 0.0)


def jacobi_svd(matrix: FloatArray, *, vectors: bool = False) -> tuple[FloatArray, FloatArray]:
    """Left singular vectors (rows, columns; empty unless `vectors`) and singular values (columns,), descending.

    One-sided Jacobi rotations, dgesvj (Drmac and Veselic 2008): relative accuracy wherever the columns are well
    conditioned once scaled. Needs at least as many rows as columns.
    """
    rows, columns = matrix.shape
    if rows < columns:
        raise ValueError(f"jacobi_svd needs rows >= columns, got {rows} x {columns}")
    dgesvj = routine("dgesvj")
    if dgesvj is None or columns == 0:
        return preconditioned_jacobi_svd(matrix, vectors=vectors)
    left = np.array(matrix, dtype=np.float64, order="F")
    values, right = np.empty(columns), np.empty((1, 1), order="F")
    work = np.zeros(max(6, rows + columns))
    m, n, none, one = ctypes.c_int(rows), ctypes.c_int(columns), ctypes.c_int(0), ctypes.c_int(1)
    length, info = ctypes.c_int(len(work)), ctypes.c_int(0)
    wanted = b"U" if vectors else b"N"
    dgesvj(
        *(b"G", wanted, b"N"),
        *(ctypes.byref(m), ctypes.byref(n), _at(left), ctypes.byref(m), _at(values)),
        *(ctypes.byref(none), _at(right), ctypes.byref(one), _at(work), ctypes.byref(length), ctypes.byref(info)),
    )
    if info.value != 0:
        return preconditioned_jacobi_svd(matrix, vectors=vectors)
    return (left if vectors else left[:, :0]), values * work[0]


def preconditioned_jacobi_svd(matrix: FloatArray, *, vectors: bool = False) -> tuple[FloatArray, FloatArray]:
    """Like `jacobi_svd`, through the public dgejsv (joba=2: its default loses the small values)."""
    from scipy.linalg import lapack

    if matrix.shape[1] == 0:
        return np.empty((matrix.shape[0], 0)), np.empty(0)
    values, left, _, work, _, info = lapack.dgejsv(
        matrix, joba=_DGEJSV_FULL_ACCURACY, jobu=0 if vectors else 3, jobv=3, jobr=1, jobt=0, jobp=0
    )
    if info != 0:
        raise SolveError(f"dgejsv did not converge (info {info}); check the train for spans of 0 or infinite stiffness")
    columns = len(values)
    return (left[:, :columns] if vectors else left[:, :0]), values * (work[0] / work[1])


def _at(array: FloatArray) -> int:
    """Address of an array that LAPACK may write to."""
    if array.dtype != np.float64 or not (array.flags.c_contiguous or array.flags.f_contiguous):
        raise ValueError("LAPACK needs contiguous float64")
    return array.ctypes.data
