"""Tables of CSV files in the place of the lists of a scene: `train: {table: line.csv}`, `- table: line.csv`.

One row stands for one entry, as if it were written there: of a train a component, of `excitations`, `ripple` and
`excitation` a mapping, of `load` and `torque` speed and torque, of `gas` an order. The first row names the keys, with
units. Of a library of couplings, `coupling: {from: series.csv, size: "40"}`, the one row of that size stands for its
keys. A `catalogue` of alternatives is opened here, and read where figures vary.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as FilePath

from torsion.errors import nearest
from torsion.fields import shown
from torsion.model.component import section_name
from torsion.schema.fault_text import input_error
from torsion.schema.table_rows import (
    BY_LOAD,
    HARMONICS,
    LIBRARY,
    MAPPINGS,
    PAIRS,
    ROW,
    SECTIONS,
    TORSIOGRAM,
    TRAIN,
    Reading,
    Rows,
)
from torsion.tables import first_comment, table_text
from torsion.user_files import Node, Source

BY_NAME = {  # what may be the name of a file, by the key before it and its own
    ("gas", "table"): HARMONICS,
    ("gas", "motored"): HARMONICS,
    ("tables", "rows"): HARMONICS,
    ("gas", "tables"): BY_LOAD,
    ("measured", TORSIOGRAM): TORSIOGRAM,
}
SECTION = ("length", "diameter", "bore")  # of a row that is a list
FIRST, SECOND = (f"`{section_name('line', number)}`" for number in (1, 2))  # names of sections
OF_A_ROW = ("length", "step", "support", "notches", "hub")  # keys that the rows alone may have
EXAMPLE = (
    "one row a section: [[0.6 m, 100 mm], [0.5 m, 200 mm, 80 mm]], rows in keys, or a CSV file"
)
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
    if table_name(node.value) and (key == TRAIN or key in MAPPINGS or key in PAIRS):
        return node.as_list(_table(node, key, reading))
    if isinstance(node.plain, list):
        parts = list[Node]()  # of a train rows of a table, or sections of a shaft, for an item
        for item in node.parts.values():
            if key == TRAIN and "shaft" in item.parts and SECTIONS in item.parts["shaft"].parts:
                parts += _sections(item, reading)
            elif key == TRAIN and table_name(item.value):
                parts += _table(item, key, reading)
            else:
                parts.append(_spliced(item, key * (key in INNER), reading))
        return node.as_list(parts)
    if key == LIBRARY and {"from", ROW} <= node.parts.keys():
        return _from_library(node, reading)
    if key == "shaft" and SECTIONS in node.parts:
        hint = "in a link, a case or the table of a train give one shaft a section"
        reading.end(node.parts[SECTIONS], "`sections` belong only in the list of a train", hint)
        return node
    inner, catalogue = {}, node.parts.get("catalogue")
    if catalogue is not None and isinstance(catalogue.value, str):
        _opened(catalogue.value, catalogue, reading)
    for step, part in node.parts.items():
        before, last = f"{key}.{step}".split(".")[-2:]  # a case writes `operation.load`
        name = BY_NAME.get((before, last)) if isinstance(part.value, str) else None
        rows = None if name is None else _table(part, name, reading)
        inner[step] = _spliced(part, last, reading) if rows is None else part.as_list(rows)
    return replace(node, parts=inner)


def _sections(entry: Node, reading: Reading) -> list[Node]:
    """The shafts for which a shaft of sections stands, `line [1]`, `line [2]`, ..., each with the other keys of it."""
    shaft = entry.parts["shaft"]
    listed, name = shaft.parts[SECTIONS], shaft.parts.get("name")
    if isinstance(listed.value, str) or table_name(listed.value):
        listed = listed.as_list(_table(listed, SECTIONS, reading))
        if reading.is_ended:
            return []
    if not isinstance(listed.value, list):
        reading.end(listed, f"{shown(listed.value)} is not a list of sections", EXAMPLE)
        return []
    if name is None or not isinstance(name.value, str) or not name.value:
        hint = f"`name: line`: its sections are {FIRST}, ..."
        reading.end(name or shaft, "a shaft of `sections` needs a name", hint)
        return []
    for key in OF_A_ROW:
        if key in shaft.parts:
            hint = f"state it in its row, as `{{{key}: ...}}`"
            reading.end(shaft.parts[key], f"`{key}` belongs to one section", hint)
    common = {key: part for key, part in shaft.parts.items() if key not in (SECTIONS, "name")}
    entries = []
    for number, row in enumerate(listed.parts.values(), start=1):
        section = row
        if isinstance(row.value, list) and 2 <= len(row.value) <= len(SECTION):
            parts: dict[str | int, Node] = dict(zip(SECTION, row.parts.values(), strict=False))
            section = row.as_mapping(parts)
        elif not isinstance(row.value, dict):
            hint = "a row is [length, diameter], [length, diameter, bore], or by keys"
            reading.end(row, f"{shown(row.value)} is no section", hint)
            continue
        for key in {"name", SECTIONS} & section.parts.keys():
            hint = f"its name is {FIRST}, {SECOND}, ..."
            reading.end(section.parts[key], f"a section has no `{key}`", hint)
        # Beside the row of a table what the scene states stays in the scene.
        scene = None if row.source is None else reading.source
        kept = {key: replace(part, source=part.source or scene) for key, part in common.items()}
        named = Node(section_name(name.value, number), row.line, row.column, source=row.source)
        body = section.as_mapping({"name": named, **kept, **section.parts})
        entries.append(body.as_mapping({"shaft": body}))
    if not entries:
        reading.end(listed, "there is no section", EXAMPLE)
    return entries


def _table(node: Node, key: str, reading: Reading) -> list[Node]:
    """The rows of the table that a node names, as entries of the list at `key`."""
    where = node if isinstance(node.value, str) else node.parts["table"]
    if reading.in_table:
        reading.end(where, "a row of a table names a table", "write it in the model file")
        return []
    table = _opened(where.value, where, reading)
    if table is None:
        return []
    if (where.value, key) not in reading.rows:
        reading.rows[where.value, key] = Rows(table, key).nodes(reading)
    entries = reading.rows[where.value, key]
    reading.in_table = True
    nodes = [_spliced(entry, "", reading) for entry in entries if not reading.is_ended]
    reading.in_table = False
    return nodes


def _opened(name: str, where: Node, reading: Reading) -> Source | None:
    """The text of the file that is named there; None, and the reading ended, where there is none."""
    if name in reading.tables:
        return reading.tables[name]
    file, fault = FilePath(reading.source.name).parent / name, None
    try:
        text, fault = table_text(file) if reading.texts is None else (reading.texts[name], None)
    except (OSError, ValueError) as error:
        why = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        if isinstance(error, FileNotFoundError):
            why = "does not exist"
        hint = f"its path counts from the folder of this file, {file.parent.absolute()}"
        reading.end(where, f"the table {shown(name)} {why}", hint)
        return None
    table = reading.tables[name] = Source(str(file), text)
    if fault is None:
        return table
    reading.faults.append(replace(fault, file=str(file)))
    reading.is_ended = True
    return None


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
        listed_sizes = f"there is {', '.join(sizes)}"
        hint = f"did you mean `{near}`? {listed_sizes}" if near else listed_sizes
        reading.end(size, f"{shown(name.value)} has no size {shown(wanted)}", hint)
        return node
    row = rows[sizes.index(wanted)]
    for key in node.parts.keys() & row.parts.keys() - {ROW, "source"}:
        line, column = node.parts[key].place
        message = f"`{key}` is given here, and as {shown(row.value[key])} by size {wanted} of {name.value}"
        where = Node(None, line, column, source=node.source)
        reading.end(where, message, "keep one; a case may `set` another value")
    stated = row.parts.get("source")
    origin = stated.value if stated else first_comment(table.text) or "no source stated"
    source = replace(stated or row.parts[ROW], plain=f"{name.value}, size {wanted}: {origin}")
    parts = row.parts | {"source": source} | node.parts | {ROW: replace(size, plain=wanted)}
    return node.as_mapping(parts)
