"""Names of the components of a train that is too faulty to be lowered."""

from collections import Counter
from collections.abc import Iterator

from torsion.errors import Fault, Path
from torsion.model import KINDS, component
from torsion.schema.declaration_reader import entries_of
from torsion.train import taken


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
        kind, body = (
            next(iter(entry.items()))
            if isinstance(entry, dict) and len(entry) == 1
            else (None, None)
        )
        if kind not in KINDS or not isinstance(body, dict | None):
            return False
        numbers[kind] += 1
        given = (body or {}).get("name")
        name = given if isinstance(given, str) else f"{kind}-{numbers[kind]}"
        is_point = component(kind).sort == "point"
        if name not in found or is_point:
            found[name] = kind, is_point
        found |= dict.fromkeys(
            component(kind).points_within(name, body or {}), (f"throw of {name}", True)
        )
        branches = (body or {}).get("branches")
        halves, before = (body or {}).get("differential"), set(found)
        inner = [halves, body, *(branches if isinstance(branches, list) else [])]
        trains = [
            item["train"]
            for item in inner
            if isinstance(item, dict) and item.get("train") is not None
        ]
        if not all(_named(train, found, numbers) for train in trains):
            return False
        if isinstance(halves, dict):
            found |= {f"{half} opposed": found[half] for half in set(found) - before}
    return True
