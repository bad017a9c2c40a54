"""A train of the file as components: the kind of every entry is decided first, then read in the words of that kind."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

from torsion.components import KINDS, UNBUILT, component
from torsion.components.component import Component
from torsion.errors import Fault, Path
from torsion.fields import shown
from torsion.schema.declaration_reader import declared, entries_of, unbuilt, unknown
from torsion.train import taken


def components(entries: object, path: Path, faults: list[Fault]) -> tuple[Component, ...]:
    """The sound components of a list; every fault of the others is noted."""
    if not isinstance(entries, list):
        faults.append(Fault(path, f"{shown(entries)} is not a list of components", "`- disc: {inertia: 1.2}`, ..."))
        return ()
    read = (_entry(entry, (*path, position), faults) for position, entry in enumerate(entries))
    return tuple(found for found in read if found is not None)


def repeated_names(entries: object) -> Iterator[Fault]:
    """Faults of names that are given twice, for a train that is too faulty to be looked at as a whole."""
    seen: dict[str, Path] = {}
    for name, path in _names(entries, ("train",)):
        if name in seen:
            yield taken(name, path[:-1], seen[name])
        seen.setdefault(name, path[:-1])


def _names(body: object, path: Path) -> Iterator[tuple[str, Path]]:
    for step, item in entries_of(body):
        if step == "name" and isinstance(item, str):
            yield item, (*path, step)
        yield from _names(item, (*path, step))


def kinds_by_name(entries: object) -> dict[str, tuple[str, bool]] | None:
    """The kind of every component by the name it goes by, and whether it is a point, of a train too faulty to lower.

    None where that is not known: a kind is unknown, and so what the others are numbered.
    """
    found: dict[str, tuple[str, bool]] = {}
    return found if _named(entries, found, Counter()) else None


def _named(entries: object, found: dict[str, tuple[str, bool]], numbers: Counter[str]) -> bool:
    for entry in entries if isinstance(entries, list) else [None]:
        kind, body = next(iter(entry.items())) if isinstance(entry, dict) and len(entry) == 1 else (None, None)
        if kind not in KINDS or not isinstance(body, dict | None):
            return False
        numbers[kind] += 1
        given = (body or {}).get("name")
        name = given if isinstance(given, str) else f"{kind}-{numbers[kind]}"
        is_point = component(kind).sort == "point"
        if name not in found or is_point:
            found[name] = kind, is_point
        branches = (body or {}).get("branches")
        inner = [body, *(branches if isinstance(branches, list) else [])]
        trains = [item["train"] for item in inner if isinstance(item, dict) and item.get("train") is not None]
        if not all(_named(train, found, numbers) for train in trains):
            return False
    return True


def one_component(kind: str, body: object, path: Path, faults: list[Fault]) -> Component | None:
    """A component of a kind; `path` ends with the kind. Trains within it are read first."""
    if kind in UNBUILT:
        faults.append(unbuilt(path, f"`{kind}`"))
        return None
    if kind not in KINDS:
        faults.append(unknown(path, "component", kind, list(KINDS)))
        return None
    before = len(faults)
    read = declared(component(kind), _with_trains(body, path, faults), path, faults)
    return read if len(faults) == before else None


def _entry(entry: object, path: Path, faults: list[Fault]) -> Component | None:
    """An entry is a mapping with one key, its kind."""
    if not isinstance(entry, dict) or not entry:
        hint = (
            f"write `- {entry}: {{...}}`" if isinstance(entry, str) and entry in KINDS else "`- disc: {inertia: 1.2}`"
        )
        faults.append(Fault(path, f"{shown(entry)} is not a component, a mapping with one key", hint))
        return None
    if len(entry) > 1:
        kinds = [key for key in entry if key in KINDS or key in UNBUILT]
        extra = next(key for key in entry if key != kinds[0]) if kinds else list(entry)[1]
        hint = "start each with its own `-`" if len(kinds) > 1 else "indent the keys of a component below its kind"
        message = f"a component is one key, its kind; there are {', '.join(f'`{key}`' for key in list(entry)[:5])}"
        faults.append(Fault((*path, extra), message, hint, at_key=True))
        return None
    ((kind, body),) = entry.items()
    return one_component(kind, body, (*path, kind), faults)


def _with_trains(body: Any, path: Path, faults: list[Fault]) -> Any:
    """The same with every train in it read into components."""
    if isinstance(body, list):
        return [_with_trains(item, (*path, position), faults) for position, item in enumerate(body)]
    if not isinstance(body, dict):
        return body
    return {
        key: components(item, (*path, key), faults)
        if key == "train" and item is not None
        else _with_trains(item, (*path, key), faults)
        for key, item in body.items()
    }
