"""Other words for kinds and keys: read, and replaced by the key of the format as soon as the file is read."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from torsion.errors import Fault
from torsion.model import KINDS, KINDS_BY_ALIAS
from torsion.model.component import component_class
from torsion.schema.declaration_reader import KEYS_BY_ALIAS, SECTIONS_BY_ALIAS, keys_of, mappings_of
from torsion.user_files import Node


def aliases_of(keys: Iterable[str]) -> dict[str, str]:
    """Return the aliases of the keys of a component or of a mapping within one."""
    names = set(keys)
    return {
        alias: key for alias, key in KEYS_BY_ALIAS.items() if key in names and alias not in names
    }


def replace_aliases(root: Node) -> Iterator[Fault]:
    """Replace every alias of a file by its key, at the place of the alias; yield the fault of both given."""
    analyses = root.parts.get("analyses")
    design = None if analyses is None else analyses.parts.get("design")
    nodes = {"": root, "operation": root.parts.get("operation"), "design": design}
    for section, node in nodes.items():
        if node is not None:
            yield from _rename(node, SECTIONS_BY_ALIAS[section])
    for section in ("train", "links"):
        if (entries := root.parts.get(section)) is not None:
            yield from _train_faults(entries)


def _train_faults(entries: Node) -> Iterator[Fault]:
    """Replace the aliases of a list of components or links."""
    for entry in entries.parts.values():
        yield from _rename(entry, KINDS_BY_ALIAS)
        for kind, body in entry.parts.items():
            if kind in KINDS:
                yield from _mapping_faults(body, (component_class(str(kind)),))


def _mapping_faults(node: Node, models: tuple[type[Any], ...]) -> Iterator[Fault]:
    """Replace the aliases of a mapping, or of every mapping in a list, that one of `models` declares."""
    if isinstance(node.plain, list):
        for part in node.parts.values():
            yield from _mapping_faults(part, models)
        return
    fields = [entry for model in models for entry in keys_of(model).items()]
    yield from _rename(node, aliases_of(key for key, _ in fields))
    for key, part in node.parts.items():
        if key == "train":
            yield from _train_faults(part)
        elif inner := tuple(
            model for name, field in fields if name == key for model in mappings_of(field)
        ):
            yield from _mapping_faults(part, inner)


def _rename(node: Node, aliases: Mapping[str, str]) -> Iterator[Fault]:
    """Replace the aliases among the keys of a mapping; of two words for one key the first stays, with a fault."""
    if not aliases.keys() & node.parts.keys():
        return
    entries, written = dict(node.parts), {word: word for word in node.parts if word not in aliases}
    node.parts.clear()
    for word, part in entries.items():
        key = aliases.get(str(word), word)
        if written.setdefault(key, word) != word:
            line, column = part.place
            message = f"`{word}` and `{written[key]}` are the same key"
            yield Fault((), message, "keep one of them", line=line, column=column)
        else:
            node.parts[key] = part
