"""Tables of CSV files in the place of the lists of a scene: `train: {table: line.csv}`, `- table: line.csv`.

One row stands for one entry, as if it were written there: of a train a component, of `excitations`, `ripple` and
`excitation` a mapping, of `load` and `torque` speed and torque, of `gas` an order. The first row names the keys, with
units. Of a library of couplings, `coupling: {from: series.csv, size: "40"}`, the one row of that size stands for its
keys. A `catalogue` of alternatives is opened here, and read where figures vary.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as FilePath

from torsion.errors import Fault, nearest
from torsion.fields import shown
from torsion.schema.csv_columns import (
    BY_LOAD,
    HARMONICS,
    LIBRARY,
    MAPPINGS,
    PAIRS,
    TORSIOGRAM,
)
from torsion.schema.csv_harmonics import list_node
from torsion.schema.csv_rows import ROW, Reading, Rows
from torsion.schema.csv_text import MOST_ROWS, first_comment, table_text
from torsion.schema.fault_text import Node, Source, input_error
from torsion.schema.shaft_sections import SECTIONS, has_sections, sections

BY_NAME = {  # what may be the name of a file, by the key before it and its own
    ("gas", "table"): HARMONICS,
    ("gas", "motored"): HARMONICS,
    ("tables", "rows"): HARMONICS,
    ("gas", "tables"): BY_LOAD,
    ("measured", TORSIOGRAM): TORSIOGRAM,
}
DEEPEST = 10  # tables within each other
INNER = ("tables", "measured")  # lists whose mappings name files


def with_tables(source: Source, texts: Mapping[str, str] | None = None) -> Source:
    """The same with the rows of every table in its place; raises InputError where a table has no rows to read.

    texts: the tables by the names that the scene gives them, where they were read before.
    """
    reading = Reading(source, texts, {}, [])
    root = _spliced(source.root, "", reading)
    read = replace(
        source, root=root, tables=tuple(reading.tables.items()), faults=tuple(reading.faults)
    )
    if reading.is_ended:
        raise input_error(reading.faults, read)
    return read


def table_name(value: object) -> str | None:
    """The file of `{table: file}`, which stands for the rows of that file; None of any other value."""
    is_one = isinstance(value, dict) and len(value) == 1 and isinstance(value.get("table"), str)
    return value["table"] if is_one else None  # type: ignore[index]


def _spliced(node: Node, key: str, reading: Reading) -> Node:
    """The node with every table below it replaced; the node itself where there is none. `key` is what it stands at."""
    is_listed = key == "train" or key in MAPPINGS
    if table_name(node.value) and (is_listed or key in PAIRS):
        return list_node(node, _table(node, key, reading))
    if isinstance(node.value, list):
        parts: list[Node] = []
        for part in node.parts.values():
            is_table = key == "train" and table_name(part.value)
            if key == "train" and has_sections(part):
                parts += _sections(part, reading)
            else:
                parts += (
                    _table(part, key, reading)
                    if is_table
                    else [_spliced(part, key * (key in INNER), reading)]
                )
        return node if parts == list(node.parts.values()) else list_node(node, parts)
    if key == LIBRARY and isinstance(node.value, dict) and {"from", ROW} <= node.value.keys():
        return _from_library(node, reading)
    if key == "shaft" and isinstance(node.value, dict) and SECTIONS in node.value:
        hint = "in a link, a case or the table of a train give one shaft a section"
        _end(node.parts[SECTIONS], "`sections` belong only in the list of a train", hint, reading)
        return node
    if isinstance(node.value, dict):
        inner, named = {}, node.parts.get("catalogue")
        if named is not None and isinstance(named.value, str):
            _opened(named.value, named, reading)
        for step, part in node.parts.items():
            before, last = f"{key}.{step}".split(".")[-2:]  # a case writes `operation.load`
            name = BY_NAME.get((before, last)) if isinstance(part.value, str) else None
            inner[step] = (
                list_node(part, _table(part, name, reading))
                if name
                else _spliced(part, last, reading)
            )
        if inner != node.parts:
            value = node.value | {step: part.value for step, part in inner.items()}
            return replace(node, value=value, parts=inner)
    return node


def _sections(entry: Node, reading: Reading) -> list[Node]:
    """The shafts for which a shaft of sections stands."""
    shaft = entry.parts["shaft"]
    listed, parts = shaft.parts[SECTIONS], dict(shaft.parts)
    if isinstance(listed.value, str) or table_name(listed.value):
        parts[SECTIONS] = list_node(listed, _table(listed, SECTIONS, reading))
        if reading.is_ended:
            return []
    whole = replace(entry, parts={"shaft": replace(shaft, parts=parts)})
    return sections(
        whole, reading.source, lambda node, message, hint: _end(node, message, hint, reading)
    )


def _table(node: Node, key: str, reading: Reading) -> list[Node]:
    """The rows of the table that a node names, as entries of the list at `key`."""
    where = node if isinstance(node.value, str) else node.parts["table"]
    if where.value in reading.opened or len(reading.opened) >= DEEPEST:
        beyond = f"more than {DEEPEST} tables are nested"
        what = (
            f"the table {shown(where.value)} contains itself"
            if where.value in reading.opened
            else beyond
        )
        _end(where, what, "write its rows out", reading)
        return []
    table = _opened(where.value, where, reading)
    if table is None:
        return []
    if (where.value, key) not in reading.rows:
        reading.rows[where.value, key] = Rows(table, key).nodes(reading)
    entries = reading.rows[where.value, key]
    reading.inner_rows += len(entries) * bool(reading.opened)
    if reading.inner_rows > MOST_ROWS:
        _end(where, f"tables within tables have more than {MOST_ROWS} rows", "", reading)
    before, reading.opened = reading.opened, (*reading.opened, where.value)
    nodes = [_spliced(entry, "", reading) for entry in entries if not reading.is_ended]
    reading.opened = before
    return nodes


def _opened(name: str, where: Node, reading: Reading) -> Source | None:
    """The text of the file that is named there; None, and the reading ended, where there is none."""
    if name not in reading.tables:
        file = FilePath(reading.source.name).parent / name
        fault: Fault | None = None
        try:
            text, fault = table_text(file) if reading.texts is None else (reading.texts[name], None)
        except (OSError, ValueError) as error:
            is_there = not isinstance(error, FileNotFoundError)
            why = (
                f"cannot be read: {getattr(error, 'strerror', None) or error}"
                if is_there
                else "does not exist"
            )
            hint = f"its path counts from the folder of this file, {file.parent.absolute()}"
            _end(where, f"the table {shown(name)} {why}", hint, reading)
            return None
        reading.tables[name] = Source(str(file), text)
        if fault is not None:
            reading.faults.append(replace(fault, file=str(file)))
            reading.is_ended = True
            return None
    return reading.tables[name]


def _end(where: Node, message: str, hint: str, reading: Reading) -> None:
    """Note a fault of the scene, or of the table that a value stands in, after which nothing can be read."""
    file = "" if where.source is None else where.source.name
    reading.faults.append(Fault((), message, hint, line=where.line, column=where.column, file=file))
    reading.is_ended = True


def _from_library(node: Node, reading: Reading) -> Node:
    """A coupling with the figures of its row beside its own keys, which are others."""
    name, size = node.parts["from"], node.parts[ROW]
    if not isinstance(name.value, str) or isinstance(size.value, bool | list | dict | None):
        return node  # its declaration says what is wrong
    table = _opened(name.value, name, reading)
    rows = [] if table is None else Rows(table, LIBRARY).nodes(reading)
    if reading.is_ended or table is None:
        return node
    sizes = [str(row.value[ROW]) for row in rows]
    if (wanted := str(size.value)) not in sizes:
        near = nearest(wanted, sizes)
        every = f"there is {', '.join(sizes)}"
        hint = f"did you mean `{near}`? {every}" if near else every
        _end(size, f"{shown(name.value)} has no size {shown(wanted)}", hint, reading)
        return node
    row = rows[sizes.index(wanted)]
    for key in node.parts.keys() & row.parts.keys() - {ROW, "source"}:
        line, column = node.keys.get(str(key), (size.line, size.column))
        message = f"`{key}` is given here, and as {shown(row.value[key])} by size {wanted} of {name.value}"
        _end(
            Node(None, line, column, source=node.source),
            message,
            "keep one; a case may `set` another value",
            reading,
        )
    said = row.parts.get("source")
    origin = f"{name.value}, size {wanted}: {said.value if said else first_comment(table.text) or 'no source stated'}"
    origin_node = replace(said or row.parts[ROW], value=origin)
    parts = row.parts | {"source": origin_node} | node.parts | {ROW: replace(size, value=wanted)}
    return replace(
        node,
        value={str(step): part.value for step, part in parts.items()},
        parts=parts,
        keys=row.keys | node.keys,
    )
