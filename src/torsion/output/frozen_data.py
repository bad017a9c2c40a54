"""Frozen dataclasses as plain data and back, by the types of their fields alone.

A dataclass is a mapping of its fields, without those that have their default; one of several that may stand in a place
is in a mapping by its name. Arrays stand in a list of their own, each once, and where they belong is their place in it.
"""

import math
import re
import zlib
from base64 import b64decode, b64encode
from collections.abc import Callable, Sequence
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

NOT_FINITE = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}
DTYPES = {"f": "<f8", "i": "<i8", "u": "<i8", "b": "|b1"}  # of an array as it is kept, by the kind of its own
MOST_BYTES = 1_000_000_000  # of an array that is read
CONTROL = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff]")  # signs that no text of a scene has
NOT_KEPT = {"kept": False}  # metadata of a field with a default that is not written
PLAIN: tuple[Any, ...] = (str, int, float, bool, NoneType)  # what a default may be


class DamagedDataError(ValueError):
    """The data are not what the types say."""


@dataclass(frozen=True)
class Arrays:
    """The arrays of some data."""

    kept: list[dict[str, Any]] = field(default_factory=list)  # as they are written
    places: dict[tuple[str, tuple[int, ...], bytes], int] = field(default_factory=dict)
    read: dict[int, NDArray[Any]] = field(default_factory=dict)

    def place(self, array: NDArray[Any]) -> int:
        """Where it stands: its bytes in the order of their weight, compressed, in base64."""
        plain = np.ascontiguousarray(array, dtype=DTYPES[array.dtype.kind])
        key = plain.dtype.str, array.shape, plain.tobytes()
        if key not in self.places:
            self.places[key] = len(self.kept)
            weights = np.frombuffer(key[2], dtype=np.uint8).reshape(-1, plain.itemsize).T.tobytes()
            packed = b64encode(zlib.compress(weights, 1)).decode()
            self.kept.append({"type": key[0], "shape": list(array.shape), "bytes": packed})
        return self.places[key]

    def at(self, place: object) -> NDArray[Any]:
        """The array that stands there; the same one every time, and read-only."""
        if type(place) is not int or not 0 <= place < len(self.kept):
            raise DamagedDataError(f"there is no array {place}")
        if place not in self.read:
            self.read[place] = _array(self.kept[place])
        return self.read[place]


def _array(kept: object) -> NDArray[Any]:
    """An array from its text; raises DamagedDataError also where it is longer than it says."""
    match kept:
        case {"type": str(kind), "shape": list(shape), "bytes": str(text)} if kind in DTYPES.values():
            if not all(type(size) is int and size >= 0 for size in shape):
                raise DamagedDataError("the shape of an array is none")
            dtype = np.dtype(kind)
            size = math.prod(shape) * dtype.itemsize
            if size > MOST_BYTES:
                raise DamagedDataError("an array is larger than any of a report")
            try:
                opened = zlib.decompressobj()
                weights = opened.decompress(b64decode(text, validate=True), size + 1)
            except (ValueError, zlib.error):
                raise DamagedDataError("the bytes of an array are damaged") from None
            if len(weights) != size or not opened.eof:
                raise DamagedDataError("an array is not as long as its shape says")
            plain = np.frombuffer(weights, dtype=np.uint8).reshape(dtype.itemsize, -1).T.tobytes()
            return np.frombuffer(plain, dtype=dtype).reshape(shape)
    raise DamagedDataError("an array has a type, a shape and bytes")


@dataclass(frozen=True)
class Form:
    """How values of a type are written and read; `holds` says of a value whether it is one."""

    holds: Callable[[Any], bool]
    write: Callable[[Any, Arrays], Any]
    read: Callable[[Any, Arrays], Any]


@cache
def form(kind: Any) -> Form:
    """The form of a type: dataclasses, unions, tuples, arrays, choices, texts, numbers, true or false, and None."""
    origin, inside = get_origin(kind), get_args(kind)
    if is_dataclass(kind) and isinstance(kind, type):
        return Form(lambda value: isinstance(value, kind), _writer(kind), _reader(kind))
    if origin in (Union, UnionType):
        return _one_of(inside)
    if origin is np.ndarray:
        return Form(
            lambda value: isinstance(value, np.ndarray), lambda value, arrays: arrays.place(value),
            lambda data, arrays: arrays.at(data),
        )  # fmt: skip
    if origin is Literal:
        return _plain(
            lambda value: type(value) in (str, int) and value in inside, f"one of {', '.join(map(str, inside))}"
        )
    if origin is tuple and inside[-1] is not Ellipsis:
        return _row(inside)
    if origin in (tuple, Sequence):
        return _list(inside[0])
    return _simple(kind)


def _simple(kind: Any) -> Form:
    if kind is float:
        return Form(lambda value: _is_number(value, float), _written_number, _read_number)
    if kind is int:
        return Form(lambda value: _is_number(value, int), _written_number, _checked(lambda v: type(v) is int, "whole"))
    if kind is bool:
        holds = lambda value: isinstance(value, bool | np.bool_)  # noqa: E731
        return Form(holds, lambda value, _: bool(value), _checked(lambda v: type(v) is bool, "true or false"))
    if kind is str:
        read = _checked(lambda value: isinstance(value, str) and not CONTROL.search(value), "text")
        return Form(lambda value: isinstance(value, str), lambda value, _: value, read)
    if kind in (NoneType, None):
        return _plain(lambda value: value is None, "nothing")
    raise TypeError(f"{kind} has no form as data")


def _is_number(value: object, kind: type) -> bool:
    kinds = (int, np.integer) if kind is int else (int, float, np.integer, np.floating)
    return isinstance(value, kinds) and not isinstance(value, bool)


def _written_number(value: Any, _: Arrays) -> Any:
    number = value.item() if isinstance(value, np.generic) else value
    return number if math.isfinite(number) else str(number)


def _read_number(data: Any, _: Arrays) -> Any:
    if isinstance(data, str) and data in NOT_FINITE:
        return NOT_FINITE[data]
    if type(data) not in (int, float):
        raise DamagedDataError(f"{data!r:.40} is no number")
    return data


def _checked(holds: Callable[[Any], bool], words: str) -> Callable[[Any, Arrays], Any]:
    def read(data: Any, _: Arrays) -> Any:
        if not holds(data):
            raise DamagedDataError(f"{data!r:.40} is not {words}")
        return data

    return read


def _plain(holds: Callable[[Any], bool], words: str) -> Form:
    """Of what is the same as data."""
    return Form(holds, lambda value, _: value, _checked(holds, words))


def _list(kind: Any) -> Form:
    one = form(kind)

    def read(data: Any, arrays: Arrays) -> Any:
        if not isinstance(data, list):
            raise DamagedDataError(f"{data!r:.40} is no list")
        return tuple(one.read(item, arrays) for item in data)

    return Form(
        lambda value: isinstance(value, tuple | list), lambda v, arrays: [one.write(i, arrays) for i in v], read
    )


def _row(kinds: tuple[Any, ...]) -> Form:
    """Of a tuple with a type for each place."""
    every = [form(kind) for kind in kinds]

    def write(value: Any, arrays: Arrays) -> Any:
        return [one.write(item, arrays) for one, item in zip(every, value, strict=True)]

    def read(data: Any, arrays: Arrays) -> Any:
        if not isinstance(data, list) or len(data) != len(every):
            raise DamagedDataError(f"{data!r:.40} is no list of {len(every)}")
        return tuple(one.read(item, arrays) for one, item in zip(every, data, strict=True))

    return Form(lambda value: isinstance(value, tuple | list), write, read)


def _one_of(kinds: tuple[Any, ...]) -> Form:
    """Of a value of one of several types; where more than one is a dataclass, these stand by their names."""
    named = {kind.__name__: form(kind) for kind in kinds if is_dataclass(kind) and isinstance(kind, type)}
    named = named if len(named) > 1 else {}
    others = [form(kind) for kind in kinds if getattr(kind, "__name__", "") not in named]

    def write(value: Any, arrays: Arrays) -> Any:
        if (name := type(value).__name__) in named:
            return {name: named[name].write(value, arrays)}
        return next(one for one in others if one.holds(value)).write(value, arrays)

    def read(data: Any, arrays: Arrays) -> Any:
        if named and isinstance(data, dict) and len(data) == 1 and (name := next(iter(data))) in named:
            return named[name].read(data[name], arrays)
        error = DamagedDataError(f"{data!r:.40} is none of {', '.join(named)}")
        for one in others:
            try:
                return one.read(data, arrays)
            except DamagedDataError as refused:
                error = refused
        raise error

    return Form(lambda value: type(value).__name__ in named or any(one.holds(value) for one in others), write, read)


def _default(one: Field[Any]) -> Any:
    """What stands where the field is left out; MISSING where it never is."""
    return one.default if isinstance(one.default, (*PLAIN, tuple)) else MISSING


def _kept(kind: type) -> list[Field[Any]]:
    return [one for one in fields(kind) if one.metadata.get("kept", True)]


def _writer(kind: type) -> Callable[[Any, Arrays], Any]:
    hints = get_type_hints(kind)
    every = [(one.name, form(hints[one.name]), _default(one)) for one in _kept(kind)]

    def write(value: Any, arrays: Arrays) -> Any:
        held = ((name, one, default, getattr(value, name)) for name, one, default in every)
        return {
            name: one.write(item, arrays) for name, one, default, item in held
            if type(item) is not type(default) or item != default
        }  # fmt: skip

    return write


def _reader(kind: type) -> Callable[[Any, Arrays], Any]:
    hints = get_type_hints(kind)
    every = {one.name: form(hints[one.name]) for one in _kept(kind)}
    needed = {one.name for one in _kept(kind) if _default(one) is MISSING}

    def read(data: Any, arrays: Arrays) -> Any:
        if not isinstance(data, dict) or not needed <= data.keys() <= every.keys():
            raise DamagedDataError(f"{data!r:.40} is no {kind.__name__}")
        return kind(**{name: every[name].read(item, arrays) for name, item in data.items()})

    return read
