"""A shaft from a table of its drawing: `shaft: {name: line, sections: [[length, diameter, bore], ...]}`.

Every row stands for a shaft `line [1]`, `line [2]`, ... with the other keys of the shaft, as if they were written one
after the other in its place; so every model, rule and table takes each section, and each value keeps its place.
"""

from collections.abc import Callable
from dataclasses import replace

from torsion.fields import shown
from torsion.model.component import section_name
from torsion.schema.fault_text import Node, Source

SECTIONS = "sections"
ROW = ("length", "diameter", "bore")  # of a row that is a list
OF_A_ROW = ("length", "step", "support", "notches", "hub")  # keys that the rows alone may have
Faulty = Callable[
    [Node, str, str], None
]  # notes what is wrong with a value, and what would be right


def has_sections(entry: Node) -> bool:
    """Whether an entry of a train is a shaft of sections."""
    return "shaft" in entry.parts and SECTIONS in entry.parts["shaft"].parts


def sections(entry: Node, source: Source, fault: Faulty) -> list[Node]:
    """The entries of a train for which a shaft stands, the tables of which were read; `source` is the scene's."""
    shaft = entry.parts["shaft"]
    listed, name = shaft.parts[SECTIONS], shaft.parts.get("name")
    if not isinstance(listed.value, list):
        fault(listed, f"{shown(listed.value)} is not a list of sections", EXAMPLE)
        return []
    if name is None or not isinstance(name.value, str) or not name.value:
        fault(
            name or shaft,
            "a shaft of `sections` needs a name",
            f"`name: line`: its sections are {_named(1)}, ...",
        )
        return []
    for key in OF_A_ROW:
        if key in shaft.parts:
            fault(
                shaft.parts[key],
                f"`{key}` belongs to one section",
                f"state it in its row, as `{{{key}: ...}}`",
            )
    common = {key: part for key, part in shaft.parts.items() if key not in (SECTIONS, "name")}
    entries = []
    for number, row in enumerate(listed.parts.values(), start=1):
        if (section := _row(row, fault)) is not None:
            kept = {
                key: part if row.source is None else replace(part, source=part.source or source)
                for key, part in common.items()
            }
            keys = {
                key: position for key, position in shaft.keys.items() if key in kept
            } | section.keys
            named = Node(section_name(name.value, number), row.line, row.column, source=row.source)
            body = section.as_mapping({"name": named, **kept, **section.parts}, keys=keys)
            at_body = {"shaft": (body.line, body.column)}
            entries.append(body.as_mapping({"shaft": body}, keys=at_body))
    if not entries:
        fault(listed, "there is no section", EXAMPLE)
    return entries


EXAMPLE = (
    "one row a section: [[0.6 m, 100 mm], [0.5 m, 200 mm, 80 mm]], rows in keys, or a CSV file"
)


def _named(number: int) -> str:
    return f"`{section_name('line', number)}`"


def _row(row: Node, fault: Faulty) -> Node | None:
    """A row by its keys; None where it is faulty."""
    if isinstance(row.value, list) and 2 <= len(row.value) <= len(ROW):
        parts: dict[str | int, Node] = dict(zip(ROW, row.parts.values(), strict=False))
        places = {str(key): (part.line, part.column) for key, part in parts.items()}
        return row.as_mapping(parts, keys=places)
    if isinstance(row.value, dict):
        for key in ("name", SECTIONS):
            if key in row.parts:
                fault(
                    row.parts[key],
                    f"a section has no `{key}`",
                    f"its name is {_named(1)}, {_named(2)}, ...",
                )
        return row
    fault(
        row,
        f"{shown(row.value)} is no section",
        "a row is [length, diameter], [length, diameter, bore], or by keys",
    )
    return None
