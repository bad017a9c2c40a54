"""Nested data with arrays in it as JSON; arrays of very many numbers into a file of their own.

The data are dicts, lists, numbers, words and arrays; what is not finite in an array is null.
"""

import json
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

SERIES = "series.npz"  # beside results.json
MOST_NUMBERS = 1_000_000  # of an array that is written as a list
BLOCK = 10_000  # numbers turned into text at once


def listed(values: Any) -> Any:
    """The data with nested lists in place of arrays."""
    return replaced(values, lambda _, array: _listed(array))


def replaced(values: Any, change: Callable[[str, NDArray[Any]], Any], path: str = "") -> Any:
    """The data with what `change` gives, from the path of its key and itself, in place of every array."""
    if isinstance(values, np.ndarray):
        return change(path, values)
    if isinstance(values, Mapping):
        return {key: replaced(value, change, f"{path}.{key}" if path else key) for key, value in values.items()}
    if isinstance(values, list | tuple):
        return [replaced(value, change, f"{path}[{place}]") for place, value in enumerate(values)]
    return values


def pieces(values: Any) -> Iterator[str]:
    """The data as JSON text, piece by piece, so that long arrays are never in memory as text or lists."""
    if not _has_long(values):
        yield json.dumps(values, default=_listed, allow_nan=False)
    elif isinstance(values, Mapping):
        yield from _joined("{}", (chain([f"{json.dumps(key)}: "], pieces(value)) for key, value in values.items()))
    elif isinstance(values, np.ndarray) and values.ndim == 1:
        blocks = (values[start : start + BLOCK] for start in range(0, values.size, BLOCK))
        yield from _joined("[]", ([json.dumps(_listed(block), allow_nan=False)[1:-1]] for block in blocks))
    else:
        yield from _joined("[]", map(pieces, values))


def write_json(parts: Mapping[str, Callable[[], Any]], file: Path, most: int = MOST_NUMBERS) -> list[Path]:
    """Write a file of one line for each key of `parts`, made when its turn comes; the paths of all that was written.

    Arrays of more than `most` numbers go into `series.npz` beside it, and the file says under which name.
    """
    beside = file.with_name(SERIES)

    def stored(name: str, array: NDArray[Any]) -> Any:
        if array.size <= most:
            return array
        with zipfile.ZipFile(beside, "a") as archive, archive.open(f"{name}.npy", "w", force_zip64=True) as member:
            np.lib.format.write_array(member, array, allow_pickle=False)
        return {"file": SERIES, "array": name, "shape": list(array.shape)}

    with file.open("w", encoding="utf-8", newline="\n") as target:
        target.writelines(lines((key, replaced(make(), stored, key)) for key, make in parts.items()))
    return [file, beside] if beside.exists() else [file]


def lines(parts: Iterable[tuple[str, Any]]) -> Iterator[str]:
    """The text of a JSON object, one line for each key, piece by piece."""
    for place, (key, value) in enumerate(parts):
        yield f"{',' if place else '{'}\n{json.dumps(key)}: "
        yield from pieces(value)
    yield "\n}\n"


def _listed(array: NDArray[Any]) -> Any:
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        known = np.isfinite(array)
        array = array.astype(object)
        array[~known] = None
    return array.tolist()


def _has_long(values: Any) -> bool:
    """Whether an array of more than BLOCK numbers is among the data."""
    if isinstance(values, np.ndarray):
        return values.size > BLOCK
    inside = values.values() if isinstance(values, Mapping) else values if isinstance(values, list | tuple) else ()
    return any(map(_has_long, inside))


def _joined(brackets: str, parts: Iterable[Iterable[str]]) -> Iterator[str]:
    yield brackets[0]
    for place, part in enumerate(parts):
        if place:
            yield ", "
        yield from part
    yield brackets[1]
