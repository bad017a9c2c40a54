"""Numbers as JSON has them: finite or null, complex ones as pairs, exact ones as text."""

import math
from fractions import Fraction
from typing import Any

import numpy as np

from torsion.kernels.tree_response import Status

WORDS = {status: status.name.lower().replace("_", "-") for status in Status}


def finite(value: float | None) -> float | None:
    """A number, or None where it is none."""
    return None if value is None or not math.isfinite(value) else float(value)


def numbers(values: Any) -> Any:
    """An array as nested lists; what is not finite is None."""
    array: Any = np.asarray(values)
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        known = np.isfinite(array)
        array = array.astype(object)
        array[~known] = None
    return array.tolist()


def exact(value: Fraction | None) -> str | None:
    """An exact number: "2", "21/8"."""
    return None if value is None else str(value)


def pairs(values: Any) -> Any:
    """A complex array as nested lists of [real, imaginary]."""
    array = np.asarray(values)
    return numbers(np.stack([array.real, array.imag], axis=-1))


def statuses(values: Any) -> Any:
    """An array of statuses as words."""
    table = np.array([WORDS[status] for status in Status], dtype=object)
    return table[np.asarray(values, dtype=np.int64)].tolist()
