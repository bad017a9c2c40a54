"""The results as JSON: declared, stable, every number finite or null; very long arrays in a file of their own.

Format 1 may gain keys; a key that is there keeps its meaning. Complex amplitudes are pairs [real, imaginary]; orders
and ratios are texts "a/b".
"""

import math
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack
from enum import Enum
from fractions import Fraction
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import from_json, to_json

import torsion
from torsion.analyses import ANALYSES
from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.stored.scene import Selection, scene, span_rows, station_rows
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
        held = reliable(value, declaration)
        axis = next((axis for axis in declaration.axes if axis in records), None)
        if declaration.record is not None:
            entries = [plain(record, selection) for record in held]
            if name := declaration.record:
                entries = [{name: entry} for entry in entries]
            entries_by_key[declaration.key] = entries
        elif axis is None or held is None:
            reduced = selection.reduced(held, declaration, declaration.axes)
            entries_by_key[declaration.key] = plain(reduced, selection)
        else:
            position = declaration.axes.index(axis)
            remaining = declaration.axes[:position] + declaration.axes[position + 1 :]
            for number, entry in enumerate(entries_by_key[records[axis].key]):
                inside = np.take(held, number, axis=position)
                reduced = selection.reduced(inside, declaration, remaining)
                entry[declaration.key] = plain(reduced, selection)
    if "" in entries_by_key:
        return entries_by_key[""]
    printed = {axis for quantity in declared for axis in quantity.printed}
    positions = {LISTED[axis]: selection.positions(axis) for axis in LISTED if axis in printed}
    return {**positions, **entries_by_key}


def reliable(value: Any, quantity: Quantity) -> Any:
    """Return the quantity of a result, with NaN where its status says that it is not known."""
    held = getattr(value, quantity.name)
    if not quantity.known_by or held is None:
        return held
    status = np.asarray(getattr(value, quantity.known_by))
    bad = np.expand_dims(status != 0, tuple(range(status.ndim, held.ndim)))
    return np.where(bad, complex(np.nan, np.nan) if np.iscomplexobj(held) else np.nan, held)


END = "\n}\n"  # of a file of results
SERIES = "series.npz"  # beside results.json
MOST_NUMBERS = 1_000_000  # of an array that is written as a list
MOST_LISTED = 3_000_000  # of all arrays that are written as lists, about 60 MB of text; of later ones MOST_OF_A_CASE
# Of the results in JSON, those that a command prints beside the head; `solve` prints all.
KEYS = {"joint": ("joints", "checks"), "check": ("check",)}
MOST_TEXT = 100_000_000  # bytes of results that are printed
LEAST_TEXT = 3  # bytes of a number in a list
MOST_OF_A_CASE = (
    2_000  # the same in `cases`, so that many of them do not make a file of many times the size
)


def listed(values: Any) -> Any:
    """Return the data as JSON has them: nested lists in place of arrays, None where a number is not finite."""
    return from_json(_json(values))


def _json(values: Any) -> bytes:
    return to_json(values, fallback=lambda array: array.tolist(), inf_nan_mode="null")


def replaced(values: Any, change: Callable[[str, NDArray[Any]], Any], path: str = "") -> Any:
    """Return the data with what `change` gives, from the path of its key and itself, in place of every array."""
    if isinstance(values, np.ndarray):
        return change(path, values)
    if isinstance(values, Mapping):
        head = f"{path}." if path else ""
        return {key: replaced(value, change, head + key) for key, value in values.items()}
    if isinstance(values, list | tuple):
        return [replaced(value, change, f"{path}[{k}]") for k, value in enumerate(values)]
    return values


def write_json(
    parts: Mapping[str, Callable[[], Any]],
    file: Path,
    most: int = MOST_NUMBERS,
    ending: Callable[[str, Iterable[str]], str] | None = None,
) -> list[Path]:
    """Write a file of one line for each key of `parts`, made when its turn comes; the paths of all that was written.

    Arrays of more than `most` numbers go into `series.npz` beside it, and the file says under which name; so do those
    of more than a few thousand once MOST_LISTED numbers of all arrays are written. Last come the lines that `ending`
    makes of the SHA-256 of all before them and of the names of the files that stand beside it by then.
    """
    series, opened, before = file.with_name(SERIES), ExitStack(), sha256()
    archive: list[zipfile.ZipFile] = []  # made with the first array that stands in it
    numbers_listed = 0

    def stored(name: str, array: NDArray[Any]) -> Any:
        nonlocal numbers_listed
        is_full = numbers_listed + array.size > MOST_LISTED
        is_short = is_full or name.startswith("cases.")
        if array.size <= (min(most, MOST_OF_A_CASE) if is_short else most):
            numbers_listed += array.size
            return array
        if not archive:
            archive.append(opened.enter_context(zipfile.ZipFile(series, "w")))
        with archive[0].open(f"{name}.npy", "w", force_zip64=True) as member:
            np.lib.format.write_array(member, array, allow_pickle=False)
        return {"file": SERIES, "array": name, "shape": list(array.shape)}

    with opened, file.open("wb") as target:
        for line in lines((key, replaced(make(), stored, key)) for key, make in parts.items()):
            before.update(line)
            target.write(line)
        paths = file.parent.rglob("*.*")
        names = [path.relative_to(file.parent).as_posix() for path in paths]
        end = END if ending is None else ending(before.hexdigest(), names)
        target.write(end.encode())
    return [file, series] if series.exists() else [file]


def lines(parts: Iterable[tuple[str, Any]]) -> Iterator[bytes]:
    """Yield the text of a JSON object in UTF-8, one line for each key, without its end."""
    for position, (key, value) in enumerate(parts):
        yield b"%b\n%b: %b" % (b"," if position else b"{", _json(key), _json(value))


FORMAT = 1
OF_ALL_CASES = ("format", "program", "legend", "cases")  # keys that no case has of its own
HEAD = ("format", "program", "legend", "scene", "plan")  # keys that every file of results has
LEGEND = {
    "time_factor": "exp(+i omega t); complex amplitudes (zero to peak) are [real, imaginary]; phase at angle zero",
    "stations_and_spans": "arrays over stations or spans follow the order of the lists `stations` and `spans`",
    "own_speed": "angles, torques and inertias are those at the station's own speed, a span's at its driving station",
    "torque_sign": "a span's torque is positive when its driving side pushes its driven side",
    "reference": "orders and speeds count from the component `scene.reference`",
    "status": "ok, near-singular or singular: how far a line can be trusted; where not ok, amplitudes are null",
    "long_shafts": "each segment of a shaft is a span, as `name [segment]`, however many there are",
    "series": f"an array of more than {MOST_NUMBERS} numbers, in `cases` of {MOST_OF_A_CASE}, stands in {SERIES} "
    "beside this file, and here instead {file, array, shape}: the file, the name of the array in it and its shape; "
    "null is NaN there, words are texts",
    "null": "no value, not a number, or infinite (a fixed station's inertia)",
}


def results(findings: Findings) -> dict[str, Any]:
    """Return everything that was found, in nested lists; what was not requested is null or an empty list."""
    return {key: listed(make()) for key, make in makers(findings).items()}


def text(findings: Findings, only: tuple[str, ...] = (), largest: int = MOST_TEXT) -> str:
    """Return the results as JSON text, one line for each top-level key; `only`: of those keys, and the head.

    It is for a stream, which has no file beside it for long series. Raises InputError for more than `largest` bytes.
    """
    sizes = list[int]()

    def excess() -> InputError:
        message = f"the results are more than {largest / 1e6:.6g} MB of JSON, too many for --json"
        hint = "use -o DIR, which writes long series to series.npz, or request fewer speeds, orders or modes"
        return InputError([Fault((), message, hint)])

    def count(_: str, array: NDArray[Any]) -> NDArray[Any]:
        sizes.append(LEAST_TEXT * array.size)
        if sum(sizes) > largest:
            raise excess()
        return array

    made = makers(findings, only)
    written = lines((key, replaced(make(), count)) for key, make in made.items())
    text = b"".join(written) + END.encode()
    if len(text) > largest:
        raise excess()
    return text.decode()


def makers(findings: Findings, only: tuple[str, ...] = ()) -> dict[str, Callable[[], Any]]:
    """Return what makes the value of every top-level key, with arrays in it; `only` of those, and of the head."""
    chosen = Selection(findings.system)
    names = [name for analysis in ANALYSES.values() for name in analysis.results]
    makers: dict[str, Callable[[], Any]] = {
        "format": lambda: FORMAT,
        "program": lambda: {"name": "torsion", "version": torsion.__version__},
        "legend": lambda: LEGEND,
        "scene": lambda: plain(scene(findings.study), chosen),
        "stations": lambda: plain(station_rows(findings.system), chosen),
        "spans": lambda: plain(span_rows(findings.system), chosen),
    }
    makers |= {
        name: partial(plain, findings.results.get(name), chosen) for name in (*names, "checks")
    }
    makers["plan"] = lambda: plain(findings.plan, chosen)
    makers["sources"] = lambda: [plain(used, chosen) for used in findings.plan.sources]
    makers["cases"] = lambda: {name: _of_case(case) for name, case in findings.cases.items()}
    return {key: make for key, make in makers.items() if not only or key in (*HEAD, *only)}


def _of_case(findings: Findings) -> dict[str, Any]:
    """Return every key of a case; of one without an answer its plan alone, which says why."""
    if not findings.is_answered:
        no_train: Any = None  # a plan runs over none
        return {"plan": plain(findings.plan, Selection(no_train))}
    return {key: make() for key, make in makers(findings).items() if key not in OF_ALL_CASES}
