"""Components of a train as their declarations, each fault at its place."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from torsion.errors import Fault, Path
from torsion.fields import shown
from torsion.model import KINDS, component_class
from torsion.model.component import Component
from torsion.schema.declaration_reader import declared, entries_of, unknown_word
from torsion.schema.missing_marks import without_mark
from torsion.schema.other_words import word_for


def components(entries: object, path: Path, faults: list[Fault]) -> tuple[Component, ...]:
    """The sound components of a list; every fault of the others is noted."""
    if not isinstance(entries, list):
        hint = "`- disc: {inertia: 1.2}`, ..."
        if isinstance(entries, dict) and (
            kind := next((key for key in entries if key in KINDS), None)
        ):
            path, hint = (*path, kind), f"begin each component with a dash: `- {kind}: ...`"
        message = f"{shown(entries)} is not a list of components"
        faults.append(Fault(path, message, hint, at_key=path[-1] in KINDS))
        return ()
    read = (_entry(entry, (*path, position), faults) for position, entry in enumerate(entries))
    return tuple(component for component in read if component is not None)


def empty_lists(value: object, path: Path = ()) -> Iterator[Fault]:
    """The faults of components, and of halves of a differential, with an empty list at a key.

    A wheel of a gear may have no train behind it. A case may empty a list that it takes components from; a file that
    states an empty list has forgotten its entries.
    """
    for step, item in entries_of(value):
        if item == [] and path and path[-1] in (*KINDS, "differential"):
            yield Fault(
                (*path, step), f"`{step}` is an empty list", "list one, or leave the key out"
            )
        yield from empty_lists(item, (*path, step))


def one_component(kind: str, body: object, path: Path, faults: list[Fault]) -> Component | None:
    """A component of a kind; `path` ends with the kind. Trains within it are read first."""
    if kind not in KINDS:
        fault = unknown_word(path, "component", kind, list(KINDS))
        faults.append(replace(fault, hint=word_for("component", kind, fault.hint)))
        return None
    before = len(faults)
    read = declared(component_class(kind), _with_trains(body, path, faults), path, faults)
    return read if len(faults) == before else None


def _entry(entry: object, path: Path, faults: list[Fault]) -> Component | None:
    """An entry is a mapping with one key, its kind."""
    if not isinstance(entry, dict) or not entry:
        named = without_mark(f"{entry} {{", KINDS) if isinstance(entry, str) else None
        hint = f"write `- {named[0]}: {{...}}`" if named else "`- disc: {inertia: 1.2}`"
        faults.append(
            Fault(path, f"{shown(entry)} is not a component, a mapping with one key", hint)
        )
        return None
    if len(entry) > 1:
        kinds = [key for key in entry if key in KINDS]
        extra = next(key for key in entry if key != kinds[0]) if kinds else list(entry)[1]
        hint = (
            "start each with its own `-`"
            if len(kinds) > 1
            else "indent the keys of a component below its kind"
        )
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
