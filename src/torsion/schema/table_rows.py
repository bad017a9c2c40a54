"""The rows of one table as nodes of the list that they stand for, with all that is wrong with its cells.

The columns are the keys of the entries, from their declarations; the first row names them, with units.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pkgutil import resolve_name
from typing import Any

from pydantic import BaseModel

from torsion import units
from torsion.errors import Fault, InputError, nearest, printable
from torsion.fields import Amount, Quantity, shown
from torsion.model import KINDS, KINDS_BY_ALIAS, component_class
from torsion.schema.aliases import aliases_of
from torsion.schema.declaration_reader import items_of, key_for, keys_of
from torsion.schema.fault_text import Node, Source
from torsion.schema.yaml_source import is_number, parse_source, resolved
from torsion.tables import FORMULA_ERROR, Cell, Table, head_of, unit_fault

SECTIONS = "sections"  # of a shaft
TRAIN, KIND = "train", "kind"  # the column of a train that says the kind of every row
LIBRARY, ROW = (
    "coupling",
    "size",
)  # the kind that libraries have, and the column that says which row
CATALOGUE, LABEL = "catalogue of ", "name"  # and a kind: alternatives of one component
STATED = {"mass": ("kg",), "cost": ()}  # by a row of a catalogue beside keys and its name
PAIRS = ("load", "torque")  # lists of [speed, torque]
HARMONICS, BY_LOAD, TORSIOGRAM = "harmonics", "harmonics by load", "torsiogram"
BY_POLAR, BY_PARTS = ("order", "amplitude", "phase"), ("order", "a", "b")  # of a harmonic
LOADS = ("imep", "torque", "speed")  # at which a table of harmonics stands
Units = dict[str, tuple[str, ...]]  # SI units that a column may have, by its name
SPEED_AND_TORQUE: Units = {"speed": ("rad/s",), "torque": ("N*m", "1")}
HARMONIC: Units = {
    "order": ("1",),
    "amplitude": ("N*m", "Pa"),
    "phase": ("rad",),
    "a": ("N*m", "Pa"),
    "b": ("N*m", "Pa"),
}


@dataclass(frozen=True)
class ListKind:
    """A list of the file that a table may stand for: which columns it has."""

    example: str  # of its first row
    declared: tuple[str, ...] = ()  # what may declare an entry
    figures: Units = field(default_factory=dict)  # columns of a list without a declaration
    needed: tuple[str, ...] = ()
    label: str = ""  # the column that says which row it is


_TORQUES = "`order`, `torque [N*m]`, `phase [deg]`, ..."
_PAIR = ListKind(
    "`speed [rpm]`, `torque [N*m]`", figures=SPEED_AND_TORQUE, needed=("speed", "torque")
)
_RIPPLE, _BLADES = (
    "torsion.model.machine_torques:Ripple",
    "torsion.model.propeller:BladeTorque",
)
MAPPINGS = {  # lists of mappings
    "excitations": ListKind(_TORQUES, ("torsion.model.machine_torques:Excitation",)),
    "ripple": ListKind(_TORQUES, (_RIPPLE,)),
    "excitation": ListKind(_TORQUES, (_BLADES, _RIPPLE)),
    SECTIONS: ListKind("`length [mm]`, `diameter [mm]`, ...", (KINDS["shaft"],)),
}
LISTS = MAPPINGS | {
    TRAIN: ListKind("`kind`, `name`, `inertia [kg*m**2]`, ...", needed=(KIND,)),
    **dict.fromkeys(PAIRS, _PAIR),
    LIBRARY: ListKind(
        "`size`, `stiffness [N*m/rad]`, `psi`, ...", (KINDS[LIBRARY],), needed=(ROW,), label=ROW
    ),
    HARMONICS: ListKind("`order`, `amplitude [bar]`, `phase [deg]`", figures=HARMONIC),
    BY_LOAD: ListKind(
        "`imep [bar]`, `order`, `amplitude [bar]`, `phase [deg]`",
        figures=HARMONIC | {"imep": ("Pa",), "torque": ("N*m",), "speed": ("rad/s",)},
    ),
    TORSIOGRAM: ListKind(
        "`speed [rpm]`, `amplitude [deg]`, ...",
        figures={"speed": ("rad/s",), "amplitude": ("rad", "rad/s", "N*m"), "phase": ("rad",)},
        needed=("speed", "amplitude"),
    ),
}


def list_kind(key: str) -> ListKind:
    """The kind of the list at a key, or of a catalogue of a kind of component."""
    if not key.startswith(CATALOGUE):
        return LISTS[key]
    words = "`name`, the keys of a component with their units, and `mass [kg]`, `cost`"
    return ListKind(words, (KINDS[key.removeprefix(CATALOGUE)],), needed=(LABEL,), label=LABEL)


@dataclass(frozen=True)
class Stated:
    """What the declaration of a key says of its column."""

    units: tuple[str, ...]
    is_text: bool


@cache
def columns_of(key: str) -> dict[tuple[str, str], Stated]:
    """Every key of the entries of a list, with the kind of component that it is of."""
    if key == TRAIN:
        return {
            (kind, name): stated
            for kind in KINDS
            for name, stated in _declared(component_class(kind)).items()
        }
    kind_of_list, columns = list_kind(key), dict[str, Stated]()
    for declaration in kind_of_list.declared:
        columns |= _declared(resolve_name(declaration))
    if kind_of_list.label:
        columns.pop("from", None)
    if key == LIBRARY:
        columns[ROW] = Stated((), True)
    figures = kind_of_list.figures
    if key.startswith(CATALOGUE):
        columns.pop(ROW, None)
        figures = STATED
    columns |= {name: Stated(expected, False) for name, expected in figures.items()}
    return {("", name): stated for name, stated in columns.items()}


def _declared(kind: type[BaseModel]) -> dict[str, Stated]:
    """What a declaration says of the columns of its keys."""
    columns = {}
    for key, declaration in keys_of(kind).items():
        items = list(items_of(declaration))
        expected = {item.unit for item in items if isinstance(item, Quantity)}
        expected |= {"N*m", "1"} if Amount in items else set()
        is_mapping = any(isinstance(item, type) and issubclass(item, BaseModel) for item in items)
        is_text = str in items and not expected and float not in items and not is_mapping
        columns[key] = Stated(tuple(sorted(expected)), is_text)
    return columns


@dataclass(frozen=True)
class Column:
    """One key of every row: of every kind, or of one (`joint.kind`), its unit, and whether it is text."""

    key: str
    kind: str
    unit: str
    is_text: bool


@dataclass
class Reading:
    """What was read of a scene: its tables met so far by name, and their faults."""

    source: Source
    texts: Mapping[str, str] | None  # of tables that were read before; None: from their files
    tables: dict[str, Source]
    faults: list[Fault]
    is_ended: bool = False  # a table whose rows cannot be read was met
    in_table: bool = False  # what a row of a table states is being read
    rows: dict[tuple[str, str], list[Node]] = field(default_factory=dict)  # by table and key


def _kind_of(cell: Cell | None) -> str:
    """The kind that the cell of a row names, by its own word or by another; empty without a cell."""
    word = "" if cell is None else cell.text.casefold()
    return KINDS_BY_ALIAS.get(word.replace(" ", "_"), word)


class Rows:
    """The rows of one table as nodes of the list at `key`; all that is wrong with its cells is noted."""

    def __init__(self, source: Source, key: str) -> None:
        self.source, self.key, self.kind = source, key, list_kind(key)
        self.table = Table(source.text)
        self.fault = self.table.fault
        self.columns: list[Column | None] = []
        self.lines: dict[str, int] = {}  # of the rows so far, by their labels

    def nodes(self, reading: Reading) -> list[Node]:
        """Every row below the first; none where the first is at fault, which ends the reading."""
        rows, nodes = self.table.rows, list[Node]()
        if len(rows) < 2:
            what = "no rows below its names of columns" if rows else "nothing"
            hint = f"first a row of {self.kind.example}, then the figures"
            self.fault(Cell("", rows[0][0].line if rows else 1, 1), f"the table has {what}", hint)
            is_ended = True
        else:
            self.columns = [self._column(cell) for cell in rows[0]]
            texts = {k for k, column in enumerate(self.columns) if column and column.is_text}
            self.table.read_signs(
                cell for row in rows[1:] for k, cell in enumerate(row) if k not in texts
            )
            is_ended = self._head_is_faulty(rows[0])
        if not is_ended:
            nodes = [node for row in rows[1:] if (node := self._row(row)) is not None]
        if nodes and self.key == BY_LOAD:
            nodes = self._by_load(nodes)
        faults, figures = self.table.faults, self.kind.figures
        reading.faults += [replace(fault, file=self.source.name) for fault in faults]
        # A measured row has a meaning only beside all others: a fault in one ends the reading.
        is_measured = bool(figures) and figures is not SPEED_AND_TORQUE
        reading.is_ended |= is_ended or (is_measured and bool(faults))
        return nodes

    def _column(self, cell: Cell) -> Column | None:
        """What a column states; None where it has no name, or none that is known."""
        written, unit = head_of(cell.text)
        kind, _, name = (part.strip() for part in written.casefold().rpartition("."))
        name = re.sub("[ -]", "_", name)
        if not name:
            return None
        if self.key == TRAIN and name == KIND and not kind:
            return _KIND_COLUMN
        columns = {
            key: stated
            for (owner, key), stated in columns_of(self.key).items()
            if kind in ("", owner)
        }
        # A column may be named by another word for its key.
        aliases = {alias.casefold(): key for alias, key in aliases_of(columns).items()}
        name = aliases.get(name, name)
        if name in columns:
            return Column(name, kind, unit, columns[name].is_text)
        near = nearest(name, columns)
        hint = f"there is {', '.join(columns)}" if columns else f"there is no kind `{kind}`"
        hint = key_for(name, list(columns)) or (f"did you mean `{near}`?" if near else hint)
        self.fault(cell, f"unknown column `{printable(written)}`", hint)
        return None

    def _head_is_faulty(self, head: list[Cell]) -> bool:
        """Whether something is wrong with the names and units of the columns, every fault of which is noted."""
        before, first = len(self.table.faults), dict[tuple[str, str], Cell]()
        for number, (cell, column) in enumerate(zip(head, self.columns, strict=True)):
            if column is None:
                continue
            if (column.kind, column.key) in first:
                message = f"the column `{column.key}` stands twice"
                self.fault(cell, message, "a list is one cell: [0.9, 0.6]")
            first.setdefault((column.kind, column.key), cell)
            self._check_unit(number, cell, column)
        names, needed = {key for kind, key in first if not kind}, self.kind.needed
        if self.key in (HARMONICS, BY_LOAD):
            loads = ([key for key in LOADS if key in names] or ["imep"])[: self.key == BY_LOAD]
            needed = *loads, *(BY_PARTS if {"a", "b"} & names else BY_POLAR)
        for key in needed:
            if key not in names:
                hint = f"{', '.join(KINDS)}: what each row is" if key == KIND else self.kind.example
                self.fault(head[0], f"the column `{key}` is missing", hint)
        nameless = zip(head, self.columns, strict=True)
        return len(self.table.faults) > before or any(
            column is None and cell.text for cell, column in nameless
        )

    def _check_unit(self, column_number: int, cell: Cell, column: Column) -> None:
        """Note a unit that no such quantity has, and one that is missing where numbers stand below."""
        columns = columns_of(self.key)
        expected = {
            unit
            for (_, key), stated in columns.items()
            if key == column.key
            for unit in stated.units
        }
        if column.unit:
            faults = [unit_fault(column.unit, unit) for unit in sorted(expected)]
            if faults and (fault := faults[0]) is not None and None not in faults:
                self.fault(
                    cell, f"the unit of the column `{column.key}`: {fault.message}", fault.hint
                )
            return
        below = (row[column_number].text for row in self.table.rows[1:] if column_number < len(row))
        if expected - {"1"} and any(is_number(self.table.plain(text)) for text in below):
            unit = units.example(min(expected - {"1"})).partition(" ")[2]
            hint = f"write `{column.key} [{unit}]`"
            self.fault(cell, f"the column `{column.key}` has no unit", hint)

    def _row(self, row: list[Cell]) -> Node | None:
        """One entry; None where the cells cannot be assigned to the columns."""
        begin = next(cell for cell in row if cell.text)
        if len(row) != len(self.columns):
            self._refuse_count(row, begin)
            return None
        cells = list(zip(row, self.columns, strict=True))
        if self.key.startswith(CATALOGUE):
            for cell, column in cells:
                if column is not None and not cell.text:
                    hint = "every row of a catalogue states every column"
                    self.fault(cell, f"`{column.key}` is empty", hint)
        filled = [(cell, column) for cell, column in cells if cell.text]
        nameless = next((cell for cell, column in filled if column is None), None)
        if nameless is not None:
            message = f"{shown(nameless.text)} is in a column without a name"
            self.fault(nameless, message, "name it in the first row")
        kind = next((cell for cell, column in filled if column and column == _KIND_COLUMN), None)
        if self.key == TRAIN and kind is None:
            self.fault(begin, "the row has no `kind`", f"one of {', '.join(KINDS)}")
            return None

        body = self._node({}, begin)
        for cell, column in filled:
            if column is not None and cell is not kind:
                self._state(body, cell, column, _kind_of(kind))
        if self.kind.label and not self._is_new(body, begin, self.kind.label):
            return None
        if self.key in PAIRS:
            pair = [body.parts.get(key, self._node(None, begin)) for key in SPEED_AND_TORQUE]
            return self._node([], begin).as_list(pair)
        if self.key == HARMONICS:
            return self._harmonic(body)
        if kind is None:
            return body
        word = _kind_of(kind)
        entry = self._node({word: body.value}, begin)
        entry.parts[word], entry.keys[word] = body, (kind.line, kind.column)
        return entry

    def _refuse_count(self, row: list[Cell], begin: Cell) -> None:
        """Note a row that has not as many cells as the first."""
        separator, count = self.table.separator, len(self.columns)
        hint = "leave cells empty, not out"
        if separator == "," and len(row) > count:
            hint = "with decimal commas the cells are parted by semicolons"
        if any(cell.text[:1] in ("[", "{") and cell.text[-1] not in "]}" for cell in row):
            hint = f'put a list that holds the separator in quotes: "[0.9{separator} 0.6]"'
        cells = f"{len(row)} cell{'s' * (len(row) != 1)}"
        self.fault(begin, f"this row has {cells}, the first row {count}", hint)

    def _is_new(self, body: Node, begin: Cell, key: str) -> bool:
        """Whether a row says by its label which one it is, and no row before it is that one."""
        label = str(body.value.get(key, ""))
        if label and label not in self.lines:
            self.lines[label] = begin.line
            return True
        message = f"{key} {shown(label)} is in line {self.lines[label]} already" if label else ""
        self.fault(begin, message or f"the row has no {key}", f"one row a {key}")
        return False

    def _node(self, value: Any, cell: Cell) -> Node:
        """A value with all that is in it, at the place of its cell."""
        steps = (
            value
            if isinstance(value, dict)
            else enumerate(value if isinstance(value, list) else ())
        )
        parts = {step: self._node(item, cell) for step, item in dict(steps).items()}
        keys = dict.fromkeys(map(str, parts), (cell.line, cell.column))
        return Node(value, cell.line, cell.column, parts, keys, source=self.source)

    def _state(self, body: Node, cell: Cell, column: Column, kind: str) -> None:
        """Enter a cell under its key."""
        if column.kind and column.kind != kind:
            message = f"this column is of `{column.kind}`, and the row is a `{printable(kind)}`"
            self.fault(cell, message, "leave it empty")
        elif column.key in body.parts:
            message = f"`{column.key}` is given twice in this row"
            self.fault(cell, message, "leave one of the two cells empty")
        else:
            if FORMULA_ERROR.fullmatch(cell.text):
                message = f"`{cell.text}` is an error of the spreadsheet, no figure"
                self.fault(cell, message, "mend the formula, save again")
            body.parts[column.key] = part = self._node(self._value(cell, column), cell)
            body.keys[column.key] = (cell.line, cell.column)
            body.value[column.key] = part.value

    def _value(self, cell: Cell, column: Column) -> Any:
        """What the cell says: text, a number with the unit of its column, or a list or mapping in brackets."""
        if column.is_text:
            return cell.text
        text = self.table.plain(cell.text)
        if text[0] not in "[{":
            return _in_unit(resolved(text), text, column.unit)
        if self.table.refuse_joined(cell):
            return cell.text
        if text[-1] not in "]}":
            hint = 'put the whole cell in quotes: "[0.9, 0.6]"'
            self.fault(cell, f"{shown(cell.text)} has no closing bracket", hint)
            return cell.text
        try:
            value = parse_source(text, self.source.name).data
        except InputError as error:
            hint = error.faults[0].hint or "for example [0.9, 0.6]"
            message = f"this list or mapping cannot be read: {error.faults[0].message}"
            self.fault(cell, message, hint)
            return cell.text
        if isinstance(value, list):
            return [_in_unit(item, str(item), column.unit) for item in value]
        return value

    def _harmonic(self, body: Node) -> Node:
        """A row from its cells: [order, amplitude, phase], or a mapping where the table has `a` and `b`."""
        has_parts = any(column and column.key in ("a", "b") for column in self.columns)
        keys = BY_PARTS if has_parts else BY_POLAR
        if lacking := [key for key in keys if key not in body.parts]:
            cell = Cell("", body.line, body.column)
            self.fault(cell, f"the row has no `{lacking[0]}`", f"it has {', '.join(keys)}")
        parts = [body.parts[key] for key in keys if key in body.parts]
        return body if has_parts else body.as_list(parts)

    def _by_load(self, rows: Sequence[Node]) -> list[Node]:
        """Rows of the same load, or speed, as one table."""
        tables: dict[str, tuple[Node, list[Node]]] = {}
        key = next(column.key for column in self.columns if column and column.key in LOADS)
        for row in rows:
            load = row.parts.pop(key, None)
            if load is None:
                position = Cell("", row.line, row.column)
                self.fault(position, f"the row has no `{key}`", "every order stands at one")
            else:
                table = tables.setdefault(str(row.value.pop(key)), (load, []))
                table[1].append(self._harmonic(row))
        nodes = []
        for load, harmonics in tables.values():
            parts: dict[str | int, Node] = {key: load, "rows": load.as_list(harmonics)}
            places = dict.fromkeys(map(str, parts), (load.line, load.column))
            nodes.append(load.as_mapping(parts, keys=places))
        return nodes


_KIND_COLUMN = Column(KIND, "", "", True)


def _in_unit(value: Any, text: str, unit: str) -> Any:
    """A number with its unit; all else as it stands."""
    return f"{text} {unit}" if unit and is_number(text) else value
