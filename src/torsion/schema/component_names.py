"""Names of the components of a train that is too faulty to be lowered."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

from torsion.errors import Fault, Path
from torsion.model import KINDS
from torsion.schema.declaration_reader import entries_of
from torsion.train import taken


def repeated_names(entries: object) -> Iterator[Fault]:
    """Yield the faults of names that are given twice."""
    paths: dict[str, Path] = {}
    for path, value in _values(entries, ("train",), "name"):
        if isinstance(value, str):
            if value in paths:
                yield taken(value, path[:-1], paths[value])
            paths.setdefault(value, path[:-1])


def possible_names(entries: object) -> set[str] | None:
    """Return the names that components may go by, given or by kind and number.

    None where they are not known: a kind is unknown, and so what the others are numbered.
    """
    count, names = Counter[str](), set[str]()
    for _, train in [((), entries), *_values(entries, (), "train")]:
        for entry in train if isinstance(train, list) else [None]:
            if not isinstance(entry, dict) or len(entry) != 1 or not entry.keys() <= KINDS.keys():
                return None
            ((kind, body),) = entry.items()
            if not isinstance(body, dict | None):
                return None
            count[kind] += 1
            names.add(f"{kind}-{count[kind]}")
    return names | {name for _, name in _values(entries, (), "name") if isinstance(name, str)}


def _values(body: object, path: Path, key: str) -> Iterator[tuple[Path, Any]]:
    """Yield what stands anywhere in a body at a key, with its path."""
    for step, item in entries_of(body):
        if step == key:
            yield (*path, step), item
        yield from _values(item, (*path, step), key)
