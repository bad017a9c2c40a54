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
    """Return a result, or any value that one holds: complex numbers as pairs, exact ones as text, no value as None."""
    if is_declared(value):
        return _result(value, selection)
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, Enum):
        return value.name.lower().replace("_", "-")
    if isinstance(value, np.ndarray):
        return numbers(value)
    if isinstance(value, dict):
        return {key: plain(item, selection) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item, selection) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, complex):
        is_known = not np.isnan(value)
        return [value.real, value.imag] if is_known else [None, None]
    if isinstance(value, float):
        return finite(value)
    return value


def finite(value: float | None) -> float | None:
    """Return a number, or None where it is none."""
    return None if value is None or not math.isfinite(value) else float(value)


def numbers(array: np.ndarray) -> np.ndarray:
    """Return an array of real numbers: complex ones as pairs, both NaN where one part is not known."""
    if array.dtype.kind == "c":
        array = np.where(np.isnan(array), complex(np.nan, np.nan), array)
        return np.stack([array.real, array.imag], axis=-1)
    return array


def _result(value: Any, selection: Selection) -> Any:
    """Return a result as a dict; arrays over an axis of records are distributed over the records."""
    declared = quantities(type(value))
    records = {quantity.axes[0]: quantity for quantity in declared if quantity.record is not None}
    entries_by_key: dict[str, Any] = {}
    for declaration in sorted(declared, key=lambda quantity: quantity.record is None):
        held = _known(value, declaration)
        axis = next((axis for axis in declaration.axes if axis in records), None)
        if declaration.record is not None:
            entries = [plain(record, selection) for record in held]
            entries_by_key[declaration.key] = (
                [{declaration.record: entry} for entry in entries]
                if declaration.record
                else entries
            )
        elif axis is None or held is None:
            entries_by_key[declaration.key] = plain(
                _reduced(held, declaration, declaration.axes, selection), selection
            )
        else:
            position, remaining = (
                declaration.axes.index(axis),
                tuple(other_axis for other_axis in declaration.axes if other_axis != axis),
            )
            for number, entry in enumerate(entries_by_key[records[axis].key]):
                inside = _reduced(
                    np.take(held, number, axis=position), declaration, remaining, selection
                )
                entry[declaration.key] = plain(inside, selection)
    printed = {axis for quantity in declared for axis in quantity.printed}
    positions = {axis: selection.positions(axis) for axis in LISTED if axis in printed}
    return (
        entries_by_key[""]
        if "" in entries_by_key
        else {
            **{LISTED[axis]: held_positions for axis, held_positions in positions.items()},
            **entries_by_key,
        }
    )


def shown(value: Any, quantity: Quantity, selection: Selection) -> Any:
    """Return a quantity as every output shows it: reduced to what is reported, NaN where it is not known."""
    return _reduced(_known(value, quantity), quantity, quantity.axes, selection)


def _known(value: Any, quantity: Quantity) -> Any:
    """Return the quantity of a result, with NaN where its status says that it is not known."""
    held = getattr(value, quantity.name)
    if not quantity.known_by or held is None:
        return held
    status = np.asarray(getattr(value, quantity.known_by))
    bad = np.expand_dims(status != 0, tuple(range(status.ndim, held.ndim)))
    return np.where(bad, complex(np.nan, np.nan) if np.iscomplexobj(held) else np.nan, held)


def _reduced(value: Any, quantity: Quantity, axes: tuple[str, ...], selection: Selection) -> Any:
    return (
        selection.reduced(value, quantity, axes)
        if isinstance(value, np.ndarray) and value.ndim
        else value
    )
