"""Frozen dataclasses as plain data: written by their fields, read by pydantic's TypeAdapter.

A dataclass is a mapping of its fields, without those that have their default. A choice of several dataclasses is a
mapping with the name of one. Arrays stand in a list, each once, and a field holds the position of its array.
"""

import math
import zlib
from base64 import b64decode, b64encode
from collections.abc import Collection
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cache
from operator import itemgetter
from types import NoneType
from typing import Annotated, Any, TypeVar, cast, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    ConfigDict,
    GetCoreSchemaHandler,
    PlainValidator,
    TypeAdapter,
    ValidationError,
)
from pydantic_core import CoreSchema, core_schema

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.user_files import printable

DTYPES = {
    "f": "<f8",
    "i": "<i8",
    "u": "<i8",
    "b": "|b1",
}  # of a stored array, by the kind of the array in memory
NOT_KEPT = {"kept": False}  # metadata of a field with a default that is not written
Kind = TypeVar("Kind")
PLAIN: tuple[Any, ...] = (
    str,
    int,
    float,
    bool,
    NoneType,
    tuple,
)  # types of a default that is left out


@dataclass(frozen=True)
class Arrays:
    """The arrays of some data."""

    kept: list[Any] = field(default_factory=list)  # as they are written
    places: dict[tuple[str, tuple[int, ...], bytes], int] = field(default_factory=dict)
    read: dict[int, NDArray[Any]] = field(default_factory=dict)

    def place(self, array: NDArray[Any]) -> int:
        """Append the array unless it is there, compressed with its bytes in the order of their weight; its position."""
        stored = np.ascontiguousarray(array, dtype=DTYPES[array.dtype.kind])
        key = stored.dtype.str, array.shape, stored.tobytes()
        if key not in self.places:
            self.places[key] = len(self.kept)
            weights = np.frombuffer(key[2], dtype=np.uint8).reshape(-1, stored.itemsize).T.tobytes()
            packed = b64encode(zlib.compress(weights, 1)).decode()
            self.kept.append({"type": key[0], "shape": list(array.shape), "bytes": packed})
        return self.places[key]

    def at(self, position: object) -> NDArray[Any]:
        """Return the array at a position, the same object each time and read-only; raises ValueError."""
        if type(position) is not int or not 0 <= position < len(self.kept):
            raise ValueError(f"there is no array {position}")
        if position in self.read:
            return self.read[position]
        match self.kept[position]:
            case {"type": str(kind), "shape": list(shape), "bytes": str(text)} if (
                kind in DTYPES.values()
            ):
                if not all(type(size) is int and size >= 0 for size in shape):
                    raise ValueError("the shape of an array is none")
                dtype = np.dtype(kind)
                try:
                    weights = zlib.decompress(b64decode(text, validate=True))
                    by_weight = np.frombuffer(weights, dtype=np.uint8).reshape(dtype.itemsize, -1)
                    array = np.frombuffer(by_weight.T.tobytes(), dtype=dtype).reshape(shape)
                except (ValueError, zlib.error):
                    raise ValueError("the bytes of an array are damaged") from None
                self.read[position] = array
                return array
        raise ValueError("an array has a type, a shape and bytes")


class NamedChoice:
    """Annotation of a union of dataclasses: its data are a mapping {name of the class: fields}."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the validator that takes the class by its name."""
        choices: list[Any] = []
        for kind in get_args(source):
            entry = core_schema.typed_dict_field(handler.generate_schema(kind))
            named = core_schema.typed_dict_schema({kind.__name__: entry}, extra_behavior="forbid")
            choices.append(
                core_schema.no_info_after_validator_function(itemgetter(kind.__name__), named)
            )
        return core_schema.union_schema(choices)


BY_NAME = NamedChoice()
STORED = PlainValidator(
    lambda position, info: info.context.at(position)
)  # of a field with an array
StoredFloats = Annotated[FloatArray, STORED]
StoredIntegers = Annotated[IntArray, STORED]
StoredFlags = Annotated[BoolArray, STORED]


def plain(value: Any, arrays: Arrays, named: Collection[type]) -> Any:
    """Return a value as data for JSON; arrays are appended to `arrays`, classes in `named` stand by their names."""
    if isinstance(value, np.ndarray):
        return arrays.place(value)
    if is_dataclass(value) and not isinstance(value, type):
        data = {
            name: plain(item, arrays, named)
            for name, default in _stored_fields(type(value))
            if type(item := getattr(value, name)) is not type(default) or item != default
        }
        return {type(value).__name__: data} if type(value) in named else data
    if isinstance(value, tuple | list):
        return [plain(item, arrays, named) for item in value]
    number = value.item() if isinstance(value, np.generic) else value
    return str(number) if isinstance(number, float) and not math.isfinite(number) else number


@cache
def _stored_fields(kind: Any) -> list[tuple[str, Any]]:
    """Return names and defaults of the fields that are written; MISSING for a field that is always written."""
    return [
        (entry.name, entry.default if isinstance(entry.default, PLAIN) else MISSING)
        for entry in fields(kind)
        if entry.metadata.get("kept", True)
    ]


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    # A configuration reaches dataclasses only from a type around them.
    return TypeAdapter(tuple[kind], config=ConfigDict(extra="forbid"))


def restored(kind: type[Kind], data: Any, arrays: Arrays) -> Kind:
    """Return the dataclass of these data; raises ValueError if they are not what its types say."""
    try:
        (value,) = _adapter(cast(Any, kind)).validate_python([data], context=arrays)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        path = ".".join(map(str, fault["loc"][1:]))
        raise ValueError(
            printable(f"{path}: {fault['msg']}" if path else fault["msg"], 200)
        ) from None
    return cast(Kind, value)
