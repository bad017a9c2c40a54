"""Declared results as plain data: dicts, lists, texts, arrays of real numbers, and numbers that are finite or None."""

import math
from enum import Enum
from fractions import Fraction
from typing import Any

import numpy as np

from torsion.output.selection import Selection
from torsion.results import Quantity, is_declared, quantities

LISTED = {
    "named station": "station",
    "end span": "span",
    "element": "element",
}  # axes whose places a result names


def plain(value: Any, selection: Selection) -> Any:
    """A result, or any value that one holds: complex numbers as pairs, exact ones as text, no value as None."""
    if is_declared(value):
        return _result(value, selection)
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, Enum):
        return value.name.lower().replace("_", "-")
    if isinstance(value, np.ndarray):
        return numbers(value)
    if isinstance(value, dict):
        return {key: plain(one, selection) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one, selection) for one in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, complex):
        known = not np.isnan(value)
        return [value.real, value.imag] if known else [None, None]
    if isinstance(value, float):
        return finite(value)
    return value


def finite(value: float | None) -> float | None:
    """A number, or None where it is none."""
    return None if value is None or not math.isfinite(value) else float(value)


def numbers(array: np.ndarray) -> np.ndarray:
    """An array of real numbers: complex ones as pairs, both NaN where one part is not known."""
    if array.dtype.kind == "c":
        array = np.where(np.isnan(array), complex(np.nan, np.nan), array)
        return np.stack([array.real, array.imag], axis=-1)
    return array


def _result(value: Any, selection: Selection) -> Any:
    """A result as a dict; arrays over an axis of records are distributed over the records."""
    declared = quantities(type(value))
    records = {one.axes[0]: one for one in declared if one.record is not None}
    found: dict[str, Any] = {}
    for one in sorted(declared, key=lambda one: one.record is None):
        held = _known(value, one)
        axis = next((axis for axis in one.axes if axis in records), None)
        if one.record is not None:
            entries = [plain(record, selection) for record in held]
            found[one.key] = [{one.record: entry} for entry in entries] if one.record else entries
        elif axis is None or held is None:
            found[one.key] = plain(_reduced(held, one, one.axes, selection), selection)
        else:
            place, rest = one.axes.index(axis), tuple(other for other in one.axes if other != axis)
            for number, entry in enumerate(found[records[axis].key]):
                inside = _reduced(np.take(held, number, axis=place), one, rest, selection)
                entry[one.key] = plain(inside, selection)
    printed = {axis for one in declared for axis in one.printed}
    positions = {axis: selection.positions(axis) for axis in LISTED if axis in printed}
    return (
        found[""]
        if "" in found
        else {**{LISTED[axis]: at for axis, at in positions.items()}, **found}
    )


def shown(value: Any, one: Quantity, selection: Selection) -> Any:
    """A quantity of a result as every output shows it: reduced to what is reported, NaN where it is not known."""
    return _reduced(_known(value, one), one, one.axes, selection)


def _known(value: Any, one: Quantity) -> Any:
    """The quantity of a result, with NaN where its status says that it is not known."""
    held = getattr(value, one.name)
    if not one.known_by or held is None:
        return held
    status = np.asarray(getattr(value, one.known_by))
    bad = np.expand_dims(status != 0, tuple(range(status.ndim, held.ndim)))
    return np.where(bad, complex(np.nan, np.nan) if np.iscomplexobj(held) else np.nan, held)


def _reduced(value: Any, one: Quantity, axes: tuple[str, ...], selection: Selection) -> Any:
    return (
        selection.reduced(value, one, axes)
        if isinstance(value, np.ndarray) and value.ndim
        else value
    )
