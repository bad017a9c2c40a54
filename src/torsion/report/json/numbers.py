"""Numbers as JSON has them: finite or null, complex ones as pairs, exact ones as text.

Arrays stay arrays here; `torsion.report.json.writing` makes lists of them where they are written.
"""

import math
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.kernels.response import Status

WORDS = {status: status.name.lower().replace("_", "-") for status in Status}


def finite(value: float | None) -> float | None:
    """A number, or None where it is none."""
    return None if value is None or not math.isfinite(value) else float(value)


def numbers(values: Any) -> NDArray[Any]:
    """An array; what is not finite in it is null in JSON."""
    return np.asarray(values)


def exact(value: Fraction | None) -> str | None:
    """An exact number: "2", "21/8"."""
    return None if value is None else str(value)


def pairs(values: Any) -> NDArray[Any]:
    """A complex array with [real, imaginary] as its last axis."""
    array = np.asarray(values, dtype=np.complex128)
    if array.ndim == 0 or array.strides[-1] != array.itemsize:
        array = np.ascontiguousarray(array)
    return array.view(np.float64).reshape(*np.shape(values), 2)


def statuses(values: Any) -> NDArray[Any]:
    """An array of statuses as words."""
    table = np.array([WORDS[status] for status in Status])
    return np.asarray(table[np.asarray(values, dtype=np.int64)])
