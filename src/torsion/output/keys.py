"""What stands where in the results, from the declarations: every key with its unit, axes and meaning."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from torsion.output.plain import LISTED
from torsion.results import is_list, parts, quantities

POSITIONS = {
    "named station": "positions in `stations` of the angles reported: those of the stations that the train names",
    "end span": "positions in `spans` of the torques reported: of an element its first and last",
    "element": "names of the elements; of each its largest span is reported",
}


@dataclass(frozen=True)
class Key:
    """A key of the results; `[]` in its path is every element of a list."""

    path: str
    unit: str
    axes: tuple[str, ...]  # of the nested lists that stand there
    meaning: str


def keys(results: Mapping[str, type]) -> tuple[Key, ...]:
    """Every key of the results under each name, a path `modes.frequency_Hz` or `checks[].value`."""
    return tuple(key for path, kind in results.items() for key in _of(kind, path, ()))


def _of(kind: type, path: str, above: tuple[type, ...]) -> Iterator[Key]:
    declared = quantities(kind)
    records = {one.axes[0]: one for one in declared if one.record is not None}
    shown = {axis for one in declared for axis in one.printed}
    for axis, name in LISTED.items():
        if axis in shown:
            yield Key(f"{path}.{name}", "", (axis,), POSITIONS[axis])
    for one in declared:
        inner = parts(kind, one)
        record = next((axis for axis in one.axes if axis in records and records[axis] is not one), None)
        at = path if record is None else f"{path}.{records[record].key}[]"
        at = f"{at}.{one.key}" if one.key else at
        at = f"{at}[]" if (inner is not None and is_list(kind, one)) or one.record else at
        if inner is None:
            axes = tuple(shown for shown in one.printed if shown not in records)
            yield Key(f"{at}.{one.record}" if one.record else at, one.unit, axes, one.meaning)
        elif inner not in above:
            yield from _of(inner, at, (*above, kind))
