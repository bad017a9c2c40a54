"""A parameter with a value for every variant, which takes part in the lowering of components as one number does.

The components of a file take a `Column` where they take a number, so that `lower` itself says how a parameter enters
the train. A column is no float: what cannot take one (`float`, `math.sqrt`, an array, a comparison that variants answer
differently) raises an error, and the file is then read for each variant. Nothing is dropped silently.
"""

import operator
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np


class NotInColumns(Exception):
    """The variants are not one train with other numbers; the file has to be read for each of them."""


def _operation(
    apply: Callable[[Any, Any], Any], *, reflected: bool = False, compares: bool = False
) -> Any:
    def method(column: "Column", operand: object) -> Any:
        if not isinstance(operand, int | float | complex | Fraction | Column):
            return NotImplemented
        left, right = column.values, plain(operand)
        if not compares:
            return Column(apply(right, left) if reflected else apply(left, right))

        # The imaginary part is the step of a slope, no number of the file.
        answers = apply(np.real(left), np.real(right))
        if answers.any() != answers.all():
            raise NotInColumns("the variants answer a question of the lowering differently")
        return bool(answers.all())

    return method


_ARITHMETIC = operator.add, operator.sub, operator.mul, operator.truediv, operator.pow


class Column:
    """Values of one parameter, (variants,) real or complex; + - * / ** and comparisons work as on a number."""

    __slots__ = ("values",)
    __array_ufunc__ = None  # numpy leaves mixed operations to this class
    __hash__ = object.__hash__

    def __init__(self, values: np.ndarray) -> None:
        self.values = values

    def __repr__(self) -> str:
        return f"Column of {len(self.values)} values"

    def __array__(self, *_: object, **__: object) -> np.ndarray:
        raise TypeError("a column is not an element of an array")

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    def __neg__(self) -> "Column":
        return Column(-self.values)

    def __abs__(self) -> "Column":
        return -self if self < 0.0 else self

    __add__, __sub__, __mul__, __truediv__, __pow__ = map(_operation, _ARITHMETIC)
    __radd__, __rsub__, __rmul__, __rtruediv__, __rpow__ = (
        _operation(apply, reflected=True) for apply in _ARITHMETIC
    )
    __lt__, __le__, __gt__, __ge__, __eq__, __ne__ = (
        _operation(getattr(operator, name), compares=True)
        for name in ("lt", "le", "gt", "ge", "eq", "ne")
    )


def plain(value: Any) -> Any:
    """Return what numpy takes: the values of a column, a float in place of a fraction.

    >>> plain(2.0 * Column(np.array([1.0, 1.5]))), plain(Fraction(1, 2))
    (array([2., 3.]), 0.5)
    """
    if isinstance(value, Column):
        return value.values
    return float(value) if isinstance(value, Fraction) else value


@cache
def field_names(kind: type[object]) -> tuple[str, ...]:
    """Return the fields of a dataclass or a declaration; none of anything else."""
    if is_dataclass(kind):
        return tuple(field.name for field in fields(kind))
    return tuple(getattr(kind, "model_fields", ()))


def copied(record: Any, **values: Any) -> Any:
    """Return a record, a dataclass or a declaration, with other values of its fields."""
    if is_dataclass(record) and not isinstance(record, type):
        return replace(record, **values)
    copy = record.model_copy(update=values)
    # `model_copy` keeps what cached properties computed from the old values.
    for name in vars(copy).keys() - type(copy).model_fields.keys():
        del vars(copy)[name]
    return copy


Items = dict[Any, Any]


def opened(value: Any) -> tuple[Items, Callable[[Items], Any]]:
    """Return what a record, a mapping or a tuple consists of, and what makes one with other values of some items.

    >>> items, make = opened((1.0, 2.0))
    >>> items, make({1: 3.0})
    ({0: 1.0, 1: 2.0}, (1.0, 3.0))
    """
    if isinstance(value, Mapping):
        return dict(value), lambda items: {**value, **items}
    if isinstance(value, tuple):
        numbered, kind = dict(enumerate(value)), getattr(type(value), "_make", tuple)
        return numbered, lambda items: kind({**numbered, **items}.values())
    record_class: Any = type(value)
    fields_of = {name: getattr(value, name) for name in field_names(record_class)}
    return fields_of, lambda items: copied(value, **items)


Picker = Callable[[int], Any]


def picker(value: Any) -> Picker | None:
    """Return the function from the number of a variant to the record with its numbers; None without columns.

    >>> picker((1.0, Column(np.array([2.0, 3.0]))))(1)
    (1.0, 3.0)
    """
    if isinstance(value, Column):
        return lambda variant: value.values[variant].item()
    items, make = opened(value)
    inner = {key: pick for key, item in items.items() if (pick := picker(item))}
    if not inner:
        return None
    return lambda variant: make({key: pick(variant) for key, pick in inner.items()})


def joined(alternatives: list[Any], combine: Callable[[np.ndarray], np.ndarray]) -> Any:
    """Return one record of alternatives that differ in numbers, each of which becomes a column.

    combine: from a number of all alternatives (alternatives,) to its values (variants,). Texts of origin (`source`,
    `note`) may differ; NotInColumns is raised if anything else does.

    >>> joined([(1.0, 2.0), (1.0, 3.0)], lambda numbers: numbers[[1, 0, 1]])[1].values
    array([3., 2., 3.])
    """
    first, kinds = alternatives[0], {type(item) for item in alternatives}
    if len(kinds) == 1 and all(item is first or item == first for item in alternatives):
        return first
    if kinds == {float}:
        return Column(combine(np.array(alternatives)))
    rows = [opened(item)[0] for item in alternatives]
    if len(kinds) > 1 or not rows[0] or any(row.keys() != rows[0].keys() for row in rows):
        raise NotInColumns("alternatives differ in more than their numbers")
    names = rows[0].keys() - {"source", "note"}
    return opened(first)[1]({name: joined([row[name] for row in rows], combine) for name in names})
