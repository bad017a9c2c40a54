"""Tables of CSV files in the place of the lists of a scene: `train: {table: line.csv}`, `- table: line.csv`.

One row stands for one entry, as if it were written there: of a train a component, of `excitations`, `ripple` and
`excitation` a mapping, of `load` and `torque` speed and torque, of `gas` an order. The first row names the keys.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path as FilePath
from pkgutil import resolve_name
from typing import Any

from pydantic import BaseModel

from torsion import units
from torsion.components import KINDS, component
from torsion.errors import Fault, InputError, nearest, printable
from torsion.fields import Amount, Quantity, shown
from torsion.schema.csv_numbers import Numbers, numbers_of
from torsion.schema.csv_text import FORMULA_ERROR, Cell, rows_of, table_text
from torsion.schema.declaration_reader import items_of, keys_of
from torsion.schema.fault_text import Node, Source, input_error
from torsion.schema.yaml_source import parse_source, resolved

MAPPINGS = {  # lists of mappings: key, what declares an entry
    "excitations": "torsion.components.harmonic_torques:Excitation",
    "ripple": "torsion.components.harmonic_torques:Ripple",
    "excitation": "torsion.components.propeller:BladeTorque",
}
PAIRS = ("load", "torque")  # lists of [speed, torque]
SPEED_AND_TORQUE = {"speed": ("rad/s",), "torque": ("N*m", "1")}
BY_POLAR, BY_PARTS = ("order", "amplitude", "phase"), ("order", "a", "b")  # of a harmonic
HARMONIC = {"order": ("1",), "amplitude": ("N*m", "Pa"), "phase": ("rad",), "a": ("N*m", "Pa"), "b": ("N*m", "Pa")}
LOADS = {"imep": ("Pa",), "torque": ("N*m",), "speed": ("rad/s",)}  # at which a table of harmonics stands
OF_GAS = {  # what of an engine's gas may be the name of a file, by the key before it and its own
    ("gas", "table"): "harmonics", ("gas", "motored"): "harmonics", ("tables", "rows"): "harmonics",
    ("gas", "tables"): "harmonics by load",
}  # fmt: skip
FIGURES: dict[str, dict[str, tuple[str, ...]]] = {  # of lists without a declaration: columns with their units
    **dict.fromkeys(PAIRS, SPEED_AND_TORQUE), "harmonics": HARMONIC, "harmonics by load": HARMONIC | LOADS,
}  # fmt: skip
_HEAD = re.compile(r"(.*?)\s*[\[(](.+)[\])]")  # inertia [kg*m**2]
_FIRST = "kind"  # the column of a train that says the kind of every row


@dataclass(frozen=True)
class Column:
    """One key of every row: of every kind, or of one (`joint.kind`), its unit, and whether it is text."""

    key: str
    of: str
    unit: str
    is_text: bool


@dataclass
class Reading:
    """What was read of a scene: its tables met so far by name, and their faults."""

    source: Source
    texts: Mapping[str, str] | None  # of tables that were read before; None: they are read from their files
    tables: dict[str, Source]
    faults: list[Fault]
    is_ended: bool = False  # a table whose rows cannot be read was met


def with_tables(source: Source, texts: Mapping[str, str] | None = None) -> Source:
    """The same with the rows of every table in its place; raises InputError where a table has no rows to read.

    texts: the tables by the names that the scene gives them, where they were read before.
    """
    reading = Reading(source, texts, {}, [])
    root = _spliced(source.root, "", reading)
    read = replace(source, root=root, tables=tuple(reading.tables.items()), faults=tuple(reading.faults))
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
        return _list(node, _table(node, key, reading))
    if isinstance(node.value, list):
        parts: list[Node] = []
        for part in node.parts.values():
            is_table = key == "train" and table_name(part.value)
            parts += _table(part, key, reading) if is_table else [_spliced(part, key * (key == "tables"), reading)]
        return node if parts == list(node.parts.values()) else _list(node, parts)
    if isinstance(node.value, dict):
        inner = {}
        for step, part in node.parts.items():
            before, last = f"{key}.{step}".split(".")[-2:]  # a case writes `operation.load`
            name = OF_GAS.get((before, last)) if isinstance(part.value, str) else None
            inner[step] = _list(part, _table(part, name, reading)) if name else _spliced(part, last, reading)
        if inner != node.parts:
            value = node.value | {step: part.value for step, part in inner.items()}
            return replace(node, value=value, parts=inner)
    return node


def _list(node: Node, parts: list[Node]) -> Node:
    return replace(node, value=[part.value for part in parts], parts=dict(enumerate(parts)), keys={})


def _table(node: Node, key: str, reading: Reading) -> list[Node]:
    """The rows of the table that a node names, as entries of the list at `key`."""
    where = node if isinstance(node.value, str) else node.parts["table"]
    name = where.value
    if name not in reading.tables:
        file = FilePath(reading.source.name).parent / name
        fault: Fault | None = None
        try:
            text, fault = table_text(file) if reading.texts is None else (reading.texts[name], None)
        except (OSError, ValueError) as error:
            is_there = not isinstance(error, FileNotFoundError)
            why = f"cannot be read: {getattr(error, 'strerror', None) or error}" if is_there else "does not exist"
            hint = f"its path counts from the folder of this file, {file.parent.absolute()}"
            message = f"the table {shown(name)} {why}"
            reading.faults.append(Fault((), message, hint, line=where.line, column=where.column))
            reading.is_ended = True
            return []
        reading.tables[name] = Source(str(file), text)
        if fault is not None:
            reading.faults.append(replace(fault, file=str(file)))
            reading.is_ended = True
            return []
    return _Rows(reading.tables[name], key).nodes(reading)


class _Rows:
    """The rows of one table as nodes of the list at `key`; all that is wrong with its cells is noted."""

    def __init__(self, source: Source, key: str) -> None:
        self.source, self.key = source, key
        self.faults: list[Fault] = []
        self.separator, self.rows = rows_of(source, self.faults)
        self.columns: list[Column | None] = []
        self.numbers = Numbers()

    def nodes(self, reading: Reading) -> list[Node]:
        """Every row below the first; none where the first is at fault, which ends the reading."""
        if len(self.rows) < 2:
            what = "no rows below its names of columns" if self.rows else "nothing"
            place = Cell("", self.rows[0][0].line, 1) if self.rows else Cell("", 1, 1)
            self.fault(place, f"the table has {what}", f"first a row of {self._example()}, then the figures")
            ended = True
        else:
            self.columns = [self._column(cell) for cell in self.rows[0]]
            self.numbers = self._read_signs()
            ended = self._head_is_faulty()
        found = [] if ended else [node for row in self.rows[1:] if (node := self._row(row)) is not None]
        if found and self.key == "harmonics by load":
            found = self._by_load(found)
        reading.faults += [replace(fault, file=self.source.name) for fault in self.faults]
        reading.is_ended |= ended or (self.key in FIGURES and self.key not in PAIRS and bool(self.faults))
        return found

    def fault(self, cell: Cell, message: str, hint: str = "") -> None:
        self.faults.append(Fault((), printable(message, 200), hint, line=cell.line, column=cell.column))

    def _example(self) -> str:
        if self.key == "train":
            return "`kind`, `name`, `inertia [kg*m**2]`, ..."
        if self.key.startswith("harmonics"):
            return "`imep [bar]`, " * ("load" in self.key) + "`order`, `amplitude [bar]`, `phase [deg]`"
        return "`speed [rpm]`, `torque [N*m]`" if self.key in PAIRS else "`order`, `torque [N*m]`, `phase [deg]`, ..."

    def _column(self, cell: Cell) -> Column | None:
        """What a column states; None where it has no name, or none that is known."""
        head = _HEAD.fullmatch(cell.text)
        written, unit = (head[1], head[2].strip()) if head else (cell.text, "")
        of, _, name = written.strip().casefold().rpartition(".")
        name, of = name.strip().replace(" ", "_").replace("-", "_"), of.strip()
        if not name:
            return None
        if self.key == "train" and name == _FIRST and not of:
            return Column(_FIRST, "", "", True)
        known = {key: found for (kind, key), found in _keys(self.key).items() if of in ("", kind)}
        if name not in known:
            near = nearest(name, known)
            every = f"there is {', '.join(known)}" if known else f"there is no kind `{of}`"
            self.fault(cell, f"unknown column `{printable(written)}`", f"did you mean `{near}`?" if near else every)
            return None
        return Column(name, of, unit, known[name].is_text)

    def _head_is_faulty(self) -> bool:
        """Whether something is wrong with the names and units of the columns, every fault of which is noted."""
        before, head = len(self.faults), self.rows[0]
        first: dict[tuple[str, str], Cell] = {}
        for place, (cell, column) in enumerate(zip(head, self.columns, strict=True)):
            if column is None:
                continue
            if (column.of, column.key) in first:
                self.fault(cell, f"the column `{column.key}` stands twice", "a list is one cell: [0.9, 0.6]")
            first.setdefault((column.of, column.key), cell)
            self._unit_is_sound(place, cell, column)
        for key in self._needed(first):
            if ("", key) not in first:
                hint = f"{', '.join(KINDS)}: what each row is" if key == _FIRST else self._example()
                self.fault(head[0], f"the column `{key}` is missing", hint)
        return len(self.faults) > before or any(
            column is None and cell.text for cell, column in zip(head, self.columns, strict=True)
        )

    def _needed(self, there: Mapping[tuple[str, str], Cell]) -> tuple[str, ...]:
        """The columns that the table must have, with what it has."""
        if self.key in PAIRS or self.key == "train":
            return (_FIRST,) if self.key == "train" else tuple(SPEED_AND_TORQUE)
        if self.key not in FIGURES:
            return ()
        loads = ([key for key in LOADS if ("", key) in there] or ["imep"])[: "load" in self.key]
        return (*loads, *(BY_PARTS if {("", "a"), ("", "b")} & there.keys() else BY_POLAR))

    def _harmonic(self, body: Node) -> Node:
        """A row from its cells: [order, amplitude, phase], or a mapping where the table has `a` and `b`."""
        keys = BY_PARTS if any(column and column.key in ("a", "b") for column in self.columns) else BY_POLAR
        if lacking := [key for key in keys if key not in body.parts]:
            self.fault(Cell("", body.line, body.column), f"the row has no `{lacking[0]}`", f"it has {', '.join(keys)}")
        found = [body.parts[key] for key in keys if key in body.parts]
        return body if keys == BY_PARTS else _list(replace(body), found)

    def _by_load(self, rows: list[Node]) -> list[Node]:
        """Rows of the same load, or speed, as one table."""
        found: dict[str, tuple[Node, list[Node]]] = {}
        key = next(column.key for column in self.columns if column is not None and column.key in LOADS)
        for row in rows:
            load = row.parts.pop(key, None)
            if load is None:
                self.fault(Cell("", row.line, row.column), f"the row has no `{key}`", "every order stands at one")
            else:
                found.setdefault(str(row.value.pop(key)), (load, []))[1].append(self._harmonic(row))
        made = []
        for load, each in found.values():
            parts: dict[str | int, Node] = {key: load, "rows": _list(replace(load), each)}
            value = {step: part.value for step, part in parts.items()}
            places = dict.fromkeys(map(str, parts), (load.line, load.column))
            made.append(replace(load, value=value, parts=parts, keys=places))
        return made

    def _unit_is_sound(self, place: int, cell: Cell, column: Column) -> None:
        """Note a unit that no such quantity has, and one that is missing where numbers stand below."""
        known = _keys(self.key)
        expected = {unit for (_, key), found in known.items() if key == column.key for unit in found.units}
        if column.unit:
            faults = [fault for unit in sorted(expected) if (fault := _unit_fault(column.unit, unit)) is not None]
            if faults and len(faults) == len(expected):
                self.fault(cell, f"the unit of the column `{column.key}`: {faults[0].message}", faults[0].hint)
            return
        if expected - {"1"} and any(
            place < len(row) and _is_number(self.numbers.plain(row[place].text)) for row in self.rows[1:]
        ):
            unit = units.example(min(expected - {"1"})).partition(" ")[2]
            self.fault(cell, f"the column `{column.key}` has no unit", f"write `{column.key} [{unit}]`")

    def _read_signs(self) -> Numbers:
        """How the numbers of the table are written; note what is wrong with their decimal signs."""
        texts = {place for place, column in enumerate(self.columns) if column is not None and column.is_text}
        cells = [cell for row in self.rows[1:] for place, cell in enumerate(row) if place not in texts]
        found, slip = numbers_of(self.separator, cells)
        if slip is not None:
            self.fault(*slip)
        return found

    def _row(self, row: list[Cell]) -> Node | None:
        """One entry; None where the cells cannot be assigned to the columns."""
        begin = next(cell for cell in row if cell.text)
        if len(row) != len(self.columns):
            count = f"{len(row)} cell{'s' * (len(row) != 1)}, the first row {len(self.columns)}"
            comma = self.separator == "," and len(row) > len(self.columns)
            hint = "with decimal commas the cells are parted by semicolons" if comma else "leave cells empty, not out"
            if any(cell.text[:1] in ("[", "{") and cell.text[-1] not in "]}" for cell in row):
                hint = f'put a list that holds the separator in quotes: "[0.9{self.separator} 0.6]"'
            self.fault(begin, f"this row has {count}", hint)
            return None
        filled = [(cell, column) for cell, column in zip(row, self.columns, strict=False) if cell.text]
        nameless = next((cell for cell, column in filled if column is None), None)
        if nameless is not None:
            self.fault(
                nameless, f"{shown(nameless.text)} stands in a column without a name", "name it in the first row"
            )
        kind = next((cell for cell, column in filled if column and (column.of, column.key) == ("", _FIRST)), None)
        if self.key == "train" and kind is None:
            self.fault(begin, "the row has no `kind`", f"one of {', '.join(KINDS)}")
            return None
        body = self._node({}, begin)
        for cell, column in filled:
            if column is not None and cell is not kind:
                self._state(body, cell, column, "" if kind is None else kind.text.casefold())
        if self.key in PAIRS:
            pair = [body.parts.get(key, self._node(None, begin)) for key in SPEED_AND_TORQUE]
            return _list(self._node([], begin), pair)
        if self.key == "harmonics":
            return self._harmonic(body)
        if kind is None:
            return body
        word = kind.text.casefold()
        entry = self._node({word: body.value}, begin)
        entry.parts[word], entry.keys[word] = body, (kind.line, kind.column)
        return entry

    def _node(self, value: Any, cell: Cell) -> Node:
        """A value with all that is in it, at the place of its cell."""
        inside = dict(value if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ())
        parts: dict[str | int, Node] = {step: self._node(one, cell) for step, one in inside.items()}
        keys = dict.fromkeys(map(str, parts), (cell.line, cell.column))
        return Node(value, cell.line, cell.column, parts, keys, source=self.source)

    def _state(self, body: Node, cell: Cell, column: Column, kind: str) -> None:
        """Enter a cell under its key."""
        if column.of and column.of != kind:
            self.fault(cell, f"this column is of `{column.of}`, and the row is a `{printable(kind)}`", "leave it empty")
            return
        if column.key in body.parts:
            self.fault(cell, f"`{column.key}` is given twice in this row", "leave one of the two cells empty")
            return
        if FORMULA_ERROR.fullmatch(cell.text):
            self.fault(cell, f"`{cell.text}` is an error of the spreadsheet, no figure", "mend the formula, save again")
        body.parts[column.key] = part = self._node(self._value(cell, column), cell)
        body.keys[column.key] = (cell.line, cell.column)
        body.value[column.key] = part.value

    def _value(self, cell: Cell, column: Column) -> Any:
        """What the cell says: text, a number with the unit of its column, or a list or mapping in brackets."""
        if column.is_text:
            return cell.text
        text = self.numbers.plain(cell.text)
        if text[0] not in "[{":
            return _in_unit(resolved(text), text, column.unit)
        if slip := self.numbers.slip(cell):
            self.fault(*slip)
            return cell.text
        if text[-1] not in "]}":
            self.fault(cell, f"{shown(cell.text)} has no closing bracket", 'put the whole cell in quotes: "[0.9, 0.6]"')
            return cell.text
        try:
            value = parse_source(text, self.source.name).data
        except InputError as error:
            hint = error.faults[0].hint or "for example [0.9, 0.6]"
            self.fault(cell, f"this list or mapping cannot be read: {error.faults[0].message}", hint)
            return cell.text
        listed = isinstance(value, list)
        return [_in_unit(one, str(one), column.unit) for one in value] if listed else value


def _in_unit(value: Any, text: str, unit: str) -> Any:
    """A number with its unit; all else as it stands."""
    return f"{text} {unit}" if unit and _is_number(text) else value


def _is_number(text: str) -> bool:
    value = resolved(text)
    return isinstance(value, int | float) and not isinstance(value, bool)


def _unit_fault(written: str, unit: str) -> units.UnitFault | None:
    try:
        units.to_si(f"1 {written}", unit)
    except units.UnitFault as fault:
        return fault
    return None


@dataclass(frozen=True)
class _Key:
    """What the declaration of a key says of its column."""

    units: tuple[str, ...]
    is_text: bool


@cache
def _keys(key: str) -> dict[tuple[str, str], _Key]:
    """Every key of the entries of a list, with the kind of component that it is of."""
    if key in FIGURES:
        return {("", name): _Key(expected, False) for name, expected in FIGURES[key].items()}
    if key in MAPPINGS:
        return {("", name): found for name, found in _declared(resolve_name(MAPPINGS[key])).items()}
    return {(kind, name): found for kind in KINDS for name, found in _declared(component(kind)).items()}


def _declared(kind: type[BaseModel]) -> dict[str, _Key]:
    found = {}
    for key, field in keys_of(kind).items():
        items = list(items_of(field))
        expected = {item.unit for item in items if isinstance(item, Quantity)}
        expected |= {"N*m", "1"} if Amount in items else set()
        is_text = str in items and not expected and float not in items
        found[key] = _Key(tuple(sorted(expected)), is_text)
    return found
