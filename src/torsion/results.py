"""A quantity of a result, declared once: its unit, axes and meaning, which every output reads.

A result is a frozen dataclass whose fields (and properties) are declared so:

>>> @reported
... class Twist:
...     angle: float = result("rad", "twist of the whole train")
...     @derived("deg", "the same in degrees")
...     def degrees(self) -> float:
...         return math.degrees(self.angle)
>>> [(quantity.key, quantity.meaning) for quantity in quantities(Twist)]
[('angle_rad', 'twist of the whole train'), ('degrees_deg', 'the same in degrees')]
"""

import dataclasses
import inspect
import math
import typing
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from pkgutil import resolve_name
from typing import Any, TypeVar

import numpy as np

from torsion.errors import nearest

Value = TypeVar("Value")
Axes = tuple[str, ...]
BY_UNIT = "*"
MOST_NAMES = 12  # one after another in a sentence
RPM = 30.0 / math.pi  # of 1 rad/s
TO_DATAFRAME = "torsion.output.files.data_frames:data_frame"
LONGEST_LINE = 200  # characters of a result where text is shown
_SPELLED = str.maketrans({"*": "", "(": "", ")": "", "/": "_per_"})


@dataclass(frozen=True, slots=True)
class Quantity:
    """What is declared of a field or property of a result."""

    unit: str  # "" or "1" for none
    axes: Axes  # what each axis of the array in memory runs over
    meaning: str
    name: str = ""
    key: str = BY_UNIT  # its name in every output, by itself that with its unit; "" stands for the whole result
    printed: Axes = ()  # axes of the outputs, in their order; a span may be reduced to the element that it belongs to
    # The statuses, over the first axes of the array, that are 0 where its values are known.
    known_by: str = ""
    # Its axis runs over records that take the arrays over it: "", or the name of a value.
    record: str | None = None

    def named(self, name: str) -> "Quantity":
        """Return the quantity under the name of its field or property; its key ends in the unit, spelled like rad_per_s."""
        unit = self.unit.removeprefix("1").translate(_SPELLED).removeprefix("_")
        key = self.key
        if key == BY_UNIT:
            key = f"{name}_{unit}" if unit else name
        return dataclasses.replace(self, name=name, key=key, printed=self.printed or self.axes)


class Derived(cached_property[Value]):
    """A declared property; computed once, when an output or a reader first needs it."""

    declared: Quantity


def result(
    unit: str,
    axes: Axes | str = (),
    meaning: str = "",
    *,
    default: Any = dataclasses.MISSING,
    **traits: Any,
) -> Any:
    """Declare a field of a result: its unit, what the axes of its array run over, its meaning; `traits` as of Quantity.

    One axis needs no tuple; a single value has no axes: its meaning follows the unit, and stands alone without a unit.
    """
    if not (axes or meaning):
        unit, axes, meaning = "", (), unit
    elif isinstance(axes, str):
        axes, meaning = ((axes,), meaning) if meaning else ((), axes)
    declared = Quantity(unit, axes, meaning, **traits)
    return dataclasses.field(default=default, metadata={"declared": declared})


@typing.dataclass_transform(frozen_default=True, field_specifiers=(result,))
def reported(kind: type[Value]) -> type[Value]:
    """Declare a class of results: a frozen dataclass whose quantities every output reads, and that is `Keyed`."""
    for name, method in vars(Keyed).items():
        if callable(method) and getattr(kind, name, None) is getattr(object, name, None):
            setattr(kind, name, method)
    return dataclass(frozen=True, repr=False)(kind)


def derived(
    unit: str, axes: Axes | str = (), meaning: str = "", **traits: Any
) -> Callable[[Callable[[Any], Value]], Derived[Value]]:
    """Declare a property of a result that is an output too, as a field is."""

    def declare(function: Callable[[Any], Value]) -> Derived[Value]:
        made = Derived(function)
        made.declared = result(unit, axes, meaning, **traits).metadata["declared"]
        return made

    return declare


def one_line(text: str) -> str:
    """Return the text without line breaks, cut where it is too long."""
    text = " ".join(text.split())
    return text if len(text) <= LONGEST_LINE else f"{text[: LONGEST_LINE - 1]}…"


# Outputs stand above results, which know their functions by name alone.
class Keyed:
    """A result whose quantities have their keys of results.json as names too, and speeds a name in rpm.

    >>> @reported
    ... class Point(Keyed):
    ...     where: str = result("name of the shaft")
    ...     speed: float = result("rad/s", (), "speed of the shaft")
    >>> point = Point("pinion", math.pi)
    >>> point.speed_rad_per_s == math.pi, round(point.speed_rpm, 9), point
    (True, 30.0, Point: where pinion, speed_rad_per_s 3.14159)
    """

    def __getattr__(self, key: str) -> Any:
        declared = quantities(type(self))
        names = {
            quantity.key: quantity.name for quantity in declared if quantity.key != quantity.name
        }
        if key in names:
            return getattr(self, names[key])
        in_radians = f"{key.removesuffix('_rpm')}_rad_per_s"
        if key.endswith("_rpm") and in_radians in names:
            speed = getattr(self, names[in_radians])
            return None if speed is None else speed * RPM
        raise AttributeError(
            f"'{type(self).__name__}' has no attribute '{key}'", name=key, obj=self
        )

    def __dir__(self) -> list[str]:
        keys = (quantity.key for quantity in quantities(type(self)) if quantity.key)
        return sorted({*object.__dir__(self), *keys})

    def __repr__(self) -> str:
        """Return the class and the single values, by their keys, on one line."""
        fields = getattr(self, "__dataclass_fields__", {})
        words = (
            f"{quantity.key} {value:.6g}" if isinstance(value, float) else f"{quantity.key} {value}"
            for quantity in quantities(type(self))
            if quantity.name in fields
            and isinstance(value := getattr(self, quantity.name), str | int | float)
        )
        return one_line(f"{type(self).__name__}: {', '.join(words)}")

    def to_dict(self) -> dict[str, Any]:
        """Return the result by the keys of results.json, with lists in place of arrays."""
        columns: dict[str, Any] = resolve_name("torsion.output.files.data_frames:dictionary")(self)
        return columns

    def to_dataframe(self) -> Any:
        """Return a pandas.DataFrame with one row for each mode, check, or speed and order; raises ImportError."""
        return resolve_name(TO_DATAFRAME)(self)


class Displayed:
    """What a notebook shows as tables and a figure, and as one line where it shows text."""

    def __repr__(self) -> str:
        line: str = resolve_name("torsion.output.pages.notebook:line")(self)
        return line

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        """Return the line and the page; without it a notebook would keep every number of the arrays as text."""
        shown: dict[str, str] = resolve_name("torsion.output.pages.notebook:bundle")(self)
        return shown

    def _repr_html_(self) -> str:
        """Return HTML without scripts, which stands in any page."""
        return self._repr_mimebundle_()["text/html"]


def by_name(name: str, values: Mapping[str, Value], what: str = "component") -> Value:
    """Return the value of that name; raises KeyError with the nearest name.

    >>> by_name("springs", {"motor": 1, "spring": 2})
    Traceback (most recent call last):
        ...
    KeyError: "no component is called 'springs'; did you mean 'spring'?"
    """
    if name not in values:
        near = nearest(str(name), values)
        hint = f"did you mean '{near}'?" if near else f"there is {listed(values)}"
        raise KeyError(f"no {what} is called '{name}'; {hint}")
    return values[name]


def words(codes: Any, kind: type[Enum]) -> np.ndarray:
    """Return an array of codes as the words of their kind: near-singular."""
    table = np.array([code.name.lower().replace("_", "-") for code in kind])
    return np.asarray(table[np.asarray(codes, dtype=np.int64)])


def listed(names: Iterable[str], between: str = ", ", most: int = MOST_NAMES) -> str:
    """Return the first names, and how many more there are.

    >>> listed("abc"), listed((f"c{k}" for k in range(1, 9_985)), most=3)
    ('a, b, c', 'c1, c2, c3 and 9,981 more')
    """
    shown_names = list(names)
    if len(shown_names) <= most + 1:
        return between.join(shown_names)
    return f"{between.join(shown_names[:most])} and {len(shown_names) - most:,} more"


_DECLARED: dict[type, tuple[Quantity, ...]] = {}  # they are needed for every station and span


def quantities(kind: type) -> tuple[Quantity, ...]:
    """Return everything that a result declares, fields first, in the order in which it declares them."""
    if kind in _DECLARED:
        return _DECLARED[kind]
    fields = [
        field.metadata["declared"].named(field.name)
        for field in dataclasses.fields(kind)
        if "declared" in field.metadata
    ]
    properties = {
        name: value.declared.named(name)
        for base in reversed(kind.__mro__)
        for name, value in vars(base).items()
        if isinstance(value, Derived)
    }
    _DECLARED[kind] = (*fields, *properties.values())
    return _DECLARED[kind]


def is_declared(value: object) -> bool:
    """Return whether the value, or class, is a result with declared quantities."""
    kind = value if isinstance(value, type) else type(value)
    return dataclasses.is_dataclass(kind) and bool(quantities(kind))


def parts(kind: type, quantity: Quantity) -> type | None:
    """Return the class of the results that a quantity consists of; None where it consists of plain values."""
    hints = [_hint(kind, quantity.name)]
    for hint in hints:  # and the types within it, each behind those that it is one of
        if isinstance(hint, type) and is_declared(hint):
            return hint
        hints += typing.get_args(hint)
    return None


def is_list(kind: type, quantity: Quantity) -> bool:
    """Return whether a quantity holds any number of values, one after another."""
    return typing.get_origin(_hint(kind, quantity.name)) is tuple


def _hint(kind: type, name: str) -> Any:
    """Return the type of one field or property; those of the others may be known to the type checker alone."""
    attribute = getattr(kind, name, None)
    if isinstance(attribute, Derived):
        return typing.get_type_hints(attribute.func)["return"]
    holder = next(base for base in kind.__mro__ if name in inspect.get_annotations(base))
    alone = {
        "__annotations__": {name: inspect.get_annotations(holder)[name]},
        "__module__": holder.__module__,
    }
    return typing.get_type_hints(type(name, (), alone))[name]
