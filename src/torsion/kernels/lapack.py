"""Routines of LAPACK that scipy ships but does not wrap, and singular values of high relative accuracy by them.

scipy publishes every routine as a capsule for compiled code; ctypes can call the same pointer. A capsule states its
signature, and one that is not the expected one, with 32-bit integers, is not called: slower public routines then do the
same.
"""

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError

# Smallest tolerance that dstebz accepts; its own default is relative to the largest value and loses the small ones.
_STEBZ_TOLERANCE = 4.5e-308
_DGEJSV_FULL_ACCURACY = 2  # joba='F': columns are scaled, rows may be badly scaled too
_AS_THEY_ARE = (bytes, ctypes.Array)
_KINDS: dict[str, Any] = {"i": ctypes.c_int, "d": ctypes.c_double}


def call(name: str, kinds: str, *arguments: Any) -> list[Any] | None:
    """Call the routine `name`; None where scipy has none of that signature.

    kinds: of the answer (v: void, i: int), a space, and of each argument: c char *, i int *, d double *. Numbers are
    handed over by reference, arrays by their memory. Returns the answer and then each number as it is afterwards.
    """
    function = routine(name, kinds)
    if function is None:
        return None
    numbers: list[Any] = []
    handed: list[Any] = []
    for kind, argument in zip(kinds[2:], arguments, strict=True):
        if isinstance(argument, np.ndarray):
            handed.append(_at(argument))
        elif isinstance(argument, _AS_THEY_ARE):
            handed.append(argument)
        else:
            numbers.append(_KINDS[kind](argument))
            handed.append(ctypes.byref(numbers[-1]))
    return [function(*handed), *(number.value for number in numbers)]


@cache
def routine(name: str, kinds: str) -> Callable[..., Any] | None:
    """LAPACK's `name` of scipy's own library, or None where its capsule is absent or not of these `kinds` (see `call`).

    >>> routine("not_a_routine", "v i") is None
    True
    """
    from scipy.linalg import cython_lapack

    capsule = getattr(cython_lapack, "__pyx_capi__", {}).get(name)
    if capsule is None:
        return None
    name_of = ctypes.PYFUNCTYPE(ctypes.c_char_p, ctypes.py_object)(
        ("PyCapsule_GetName", ctypes.pythonapi)
    )
    address_of = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    signature: bytes = name_of(capsule)
    if not is_expected(signature.decode("ascii"), kinds):
        return None
    prototype = ctypes.CFUNCTYPE(_KINDS.get(kinds[0]), *([ctypes.c_void_p] * (len(kinds) - 2)))
    return prototype(address_of(capsule, signature))


def is_expected(signature: str, kinds: str) -> bool:
    """Whether a capsule's signature is of these `kinds` (see `call`).

    >>> is_expected("int (int *, double *)", "i id"), is_expected("int (long *, double *)", "i id")
    (True, False)
    """
    head, _, rest = signature.partition(" (")
    letters = {"void": "v", "int": "i", "char *": "c", "int *": "i", "double *": "d"}
    given = [kind.strip() for kind in rest.rstrip(")").split(",")]
    found = [
        letters.get(head, "?"),
        " ",
        *("d" if kind.endswith("_d *") else letters.get(kind, "?") for kind in given),
    ]
    return "".join(found) == kinds


def bidiagonal_singular_values(diagonal: FloatArray, off_diagonal: FloatArray) -> FloatArray:
    """Singular values (n,), descending, of the upper bidiagonal matrix, each to full relative accuracy.

    `diagonal` (n,), `off_diagonal` (n - 1,). dlasq1 (Fernando and Parlett 1994); without it, bisection on the
    Golub-Kahan matrix.
    """
    size = len(diagonal)
    values, off, work = np.array(diagonal, dtype=np.float64), np.zeros(size), np.empty(4 * size)
    off[: size - 1] = off_diagonal
    found = call("dlasq1", "v idddi", size, values, off, work, 0)
    return (
        golub_kahan_singular_values(diagonal, off_diagonal)
        if found is None or found[-1] != 0
        else values
    )


def golub_kahan_singular_values(diagonal: FloatArray, off_diagonal: FloatArray) -> FloatArray:
    """Like `bidiagonal_singular_values`, by bisection (dstebz) on the interleaved tridiagonal matrix; slower."""
    from scipy.linalg import eigh_tridiagonal

    size = len(diagonal)
    off = np.empty(2 * size - 1)
    off[0::2] = diagonal
    off[1::2] = off_diagonal
    values = eigh_tridiagonal(
        np.zeros(2 * size), off, eigvals_only=True, lapack_driver="stebz", tol=_STEBZ_TOLERANCE
    )
    return np.maximum(np.asarray(values, dtype=np.float64)[size:][::-1], 0.0)


def jacobi_svd(matrix: FloatArray, vectors: str = "") -> tuple[FloatArray, FloatArray, FloatArray]:
    """Left singular vectors (rows, columns), singular values (columns,), descending, right ones (columns, columns).

    `vectors` holds "U" and "V" where those are wanted. One-sided Jacobi rotations, dgesvj (Drmac and Veselic 2008):
    relative accuracy wherever the columns are well conditioned once scaled. Needs at least as many rows as columns.
    """
    rows, columns = matrix.shape
    if rows < columns:
        raise ValueError(f"jacobi_svd needs rows >= columns, got {rows} x {columns}")
    left = np.array(matrix, dtype=np.float64, order="F")
    values, right = (
        np.empty(columns),
        np.empty((columns, columns) if "V" in vectors else (1, 1), order="F"),
    )
    work, jobs = (
        np.zeros(max(6, rows + columns)),
        (b"U" if "U" in vectors else b"N", b"V" if "V" in vectors else b"N"),
    )
    found = columns and call(
        "dgesvj",
        "v ccciididididii",
        b"G",
        *jobs,
        rows,
        columns,
        left,
        rows,
        values,
        0,
        right,
        max(len(right), 1),
        work,
        len(work),
        0,
    )
    if not found or found[-1] != 0:
        return preconditioned_jacobi_svd(matrix, vectors)
    return left, values * work[0], right


def preconditioned_jacobi_svd(
    matrix: FloatArray, vectors: str = ""
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Like `jacobi_svd`, through the public dgejsv (joba=2: its default loses the small values)."""
    from scipy.linalg import lapack

    columns = matrix.shape[1]
    if columns == 0:
        return np.empty((matrix.shape[0], 0)), np.empty(0), np.empty((0, 0))
    jobs = {"jobu": 0 if "U" in vectors else 3, "jobv": 0 if "V" in vectors else 3}
    values, left, right, work, _, info = lapack.dgejsv(
        matrix, joba=_DGEJSV_FULL_ACCURACY, jobr=1, jobt=0, jobp=0, **jobs
    )
    if info != 0:
        raise SolveError(
            f"dgejsv did not converge (info {info}); check the train for spans of 0 or infinite stiffness"
        )
    return left[:, :columns], values * (work[0] / work[1]), right


def _at(array: FloatArray) -> int:
    """Address of an array that LAPACK may write to."""
    if array.dtype != np.float64 or not (array.flags.c_contiguous or array.flags.f_contiguous):
        raise ValueError("LAPACK needs contiguous float64")
    address: int = array.__array_interface__["data"][
        0
    ]  # a quarter of the time of `array.ctypes.data`
    return address
