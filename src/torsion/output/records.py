"""Rows of tables that are results: the values of the quantities that the columns of a table name."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.output.numbers import unit_words
from torsion.results import Quantity, is_declared, quantities


@dataclass(frozen=True)
class Place:
    """A result at one place of an axis of its arrays; an axis that no quantity is called like is counted from 1."""

    result: Any
    axis: str
    index: int

    def __getattr__(self, name: str) -> Any:
        declared = declared_of(self.result)
        if name not in declared and name == self.axis:
            return self.index + 1
        values, axes = getattr(self.result, name), declared[name].axes
        if values is None or self.axis not in axes:
            return values
        return np.take(values, self.index, axes.index(self.axis))


def along(result: Any, axis: str, indices: Iterable[int] | None = None) -> list[Place]:
    """Return the places of an axis of a result, or those at the indices, as rows of a table."""
    declared = next(each for each in quantities(type(result)) if axis in each.axes)
    count = np.shape(getattr(result, declared.name))[declared.axes.index(axis)]
    return [Place(result, axis, index) for index in (range(count) if indices is None else indices)]


def declared_of(part: Any) -> dict[str, Quantity]:
    """Return the quantities that a result, or a place of it, declares, by name."""
    if isinstance(part, Place):
        number = Quantity("", (), "counted from 1", part.axis)
        return {part.axis: number, **declared_of(part.result)}
    return {quantity.name: quantity for quantity in quantities(type(part))}


def values_of_records(
    columns: Sequence[tuple[str, str]],
    rows: Sequence[Any],
    shown: Mapping[str, tuple[str, float]],
) -> tuple[list[str], list[Any]]:
    """Return the units in which columns (name of a quantity, unit) show the records, and the values of every row.

    `name@2` is the second value of an array, `2.name` a quantity of the second record of a row, which may be None.
    `shown` has the unit of the values that a unit of a column can show. Raises ValueError where a quantity is not
    declared, or declared in a unit that the column cannot show.
    """
    parts = list(zip(*(row if isinstance(row, tuple) else (row,) for row in rows), strict=True))
    count = sum(not name for name, _ in columns)
    first = [next((part for part in column if part is not None), None) for column in parts]
    records, others = first[: len(parts) - count], iter(parts[len(parts) - count :])
    found = sum(isinstance(part, Place) or is_declared(part) for part in first)
    if not records or found != len(records):
        raise ValueError(f"a row has not {count} values beside its records")
    level_of = {name: k for k, record in enumerate(records) for name in declared_of(record)}
    units, values = list[str](), list[Sequence[Any]]()
    for path, title in columns:
        if not path:
            units.append(title)
            values.append(next(others))
            continue
        *level_words, quantity = path.split(".")
        name, _, number = quantity.partition("@")
        level = int(level_words[0]) - 1 if level_words else level_of.get(name, -1)
        declared = declared_of(records[level])
        if name not in declared:
            raise ValueError(f"{type(records[-1]).__name__} declares no '{name}'")
        unit = declared[name].unit
        unit = "" if unit == "1" else unit
        units.append(title or unit_words(unit))
        can_show = unit if unit_words(unit) == units[-1].lstrip("~") else None
        if shown.get(units[-1], (can_show,))[0] != unit:
            raise ValueError(f"'{name}' is declared in {unit}, not in what {units[-1]} shows")
        held = [getattr(part, name, None) for part in parts[level]]
        if number and any(isinstance(value, Mapping) for value in held):
            held = [value and value[number] for value in held]
        elif number:  # None where an array has no such value
            k = int(number)
            held = [None if value is None or len(value) < k else value[k - 1] for value in held]
        values.append(held)
    return units, list(zip(*values, strict=True))
