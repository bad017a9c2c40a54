"""Rows of a CSV table as harmonics of an engine's gas: by order, and by load or speed and order."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from torsion.schema.csv_columns import BY_PARTS, BY_POLAR, LOADS
from torsion.schema.csv_text import Cell
from torsion.schema.fault_text import Node

Faulty = Callable[
    [Cell, str, str], None
]  # notes what is wrong with a cell, and what would be right


def list_node(node: Node, parts: list[Node]) -> Node:
    """The parts as a list in the place of a node."""
    return replace(
        node, value=[part.value for part in parts], parts=dict(enumerate(parts)), keys={}
    )


def harmonic(body: Node, columns: Sequence[str], fault: Faulty) -> Node:
    """A row from its cells: [order, amplitude, phase], or a mapping where the table has `a` and `b`."""
    keys = BY_PARTS if {"a", "b"} & set(columns) else BY_POLAR
    if lacking := [key for key in keys if key not in body.parts]:
        fault(
            Cell("", body.line, body.column),
            f"the row has no `{lacking[0]}`",
            f"it has {', '.join(keys)}",
        )
    found = [body.parts[key] for key in keys if key in body.parts]
    return body if keys == BY_PARTS else list_node(replace(body), found)


def by_load(rows: Sequence[Node], columns: Sequence[str], fault: Faulty) -> list[Node]:
    """Rows of the same load, or speed, as one table."""
    found: dict[str, tuple[Node, list[Node]]] = {}
    key = next(key for key in columns if key in LOADS)
    for row in rows:
        load = row.parts.pop(key, None)
        if load is None:
            fault(
                Cell("", row.line, row.column),
                f"the row has no `{key}`",
                "every order stands at one",
            )
        else:
            found.setdefault(str(row.value.pop(key)), (load, []))[1].append(
                harmonic(row, columns, fault)
            )
    made = []
    for load, each in found.values():
        parts: dict[str | int, Node] = {key: load, "rows": list_node(replace(load), each)}
        value = {step: part.value for step, part in parts.items()}
        places = dict.fromkeys(map(str, parts), (load.line, load.column))
        made.append(replace(load, value=value, parts=parts, keys=places))
    return made
