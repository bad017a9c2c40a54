"""The rows of one table as nodes of the list that they stand for, with all that is wrong with its cells.

The columns are the keys of the entries, from their declarations; the first row names them, with units.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pkgutil import resolve_name
from typing import Any

from pydantic import BaseModel

from torsion import units
from torsion.errors import Fault, InputError, nearest
from torsion.fields import Amount, Quantity, shown
from torsion.model import KINDS, KINDS_BY_ALIAS
from torsion.model.component import component_class
from torsion.schema.aliases import aliases_of
from torsion.schema.declaration_reader import entries_of, items_of, key_for, keys_of
from torsion.schema.yaml_source import is_number, parse_source, resolved
from torsion.tables import FORMULA_ERROR, Cell, Table, head_of, unit_fault
from torsion.user_files import Node, Source, printable

SECTIONS = "sections"  # of a shaft
TRAIN, KIND = "train", "kind"  # the column of a train that says the kind of every row
LIBRARY, ROW = (
    "coupling",
    "size",
)  # the kind that libraries have, and the column that says which row
CATALOGUE, LABEL = "catalogue of ", "name"  # and a kind: alternatives of one component
PAIRS = ("load", "torque")  # lists of [speed, torque]
HARMONICS, BY_LOAD, TORSIOGRAM = "harmonics", "harmonics by load", "torsiogram"
BY_POLAR, BY_PARTS = ("order", "amplitude", "phase"), ("order", "a", "b")  # of a harmonic
LOADS = ("imep", "torque", "speed")  # at which a table of harmonics stands
Units = dict[str, tuple[str, ...]]  # SI units that a column may have, by its name
STATED: Units = {
    "mass": ("kg",),
    "cost": (),
}  # by a row of a catalogue beside keys and its name
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
    "torsion.model.machine:BladeTorque",
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
    **{
        CATALOGUE + kind: ListKind(
            "`name`, the keys of a component with their units, and `mass [kg]`, `cost`",
            (KINDS[kind],),
            STATED,
            (LABEL,),
            LABEL,
        )
        for kind in KINDS
    },
}


@dataclass(frozen=True)
class Column:
    """One key of every row: its possible SI units, whether it is text; in the first row of one kind, with its unit."""

    key: str
    units: tuple[str, ...]
    is_text: bool
    kind: str = ""  # of `joint.kind`; empty: of every kind
    unit: str = ""


_KIND_COLUMN = Column(KIND, (), True)


@cache
def columns_of(key: str) -> dict[tuple[str, str], Column]:
    """Every key of the entries of a list, with the kind of component that it is of."""
    kind_of_list, columns = LISTS[key], dict[tuple[str, str], Column]()
    declarations = [("", resolve_name(name)) for name in kind_of_list.declared]
    if key == TRAIN:
        declarations = [(kind, component_class(kind)) for kind in KINDS]
    for kind, declaration in declarations:
        for name, annotation in keys_of(declaration).items():
            items = list(items_of(annotation))
            expected = {item.unit for item in items if isinstance(item, Quantity)}
            expected |= {"N*m", "1"} if Amount in items else set()
            is_mapping = any(
                isinstance(item, type) and issubclass(item, BaseModel) for item in items
            )
            is_text = str in items and not expected and float not in items and not is_mapping
            columns[kind, name] = Column(name, tuple(sorted(expected)), is_text)
    if kind_of_list.label:
        columns.pop(("", "from"), None)
    if key == LIBRARY:
        columns["", ROW] = Column(ROW, (), True)
    elif kind_of_list.label:
        columns.pop(("", ROW), None)
    return columns | {
        ("", name): Column(name, expected, False) for name, expected in kind_of_list.figures.items()
    }


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

    def end(self, where: Node, message: str, hint: str) -> None:
        """Note a fault of the scene, or of the table that a value stands in, after which nothing can be read."""
        file = "" if where.source is None else where.source.name
        self.faults.append(
            Fault((), message, hint, line=where.line, column=where.column, file=file)
        )
        self.is_ended = True


class Rows(Table):
    """The rows of one table as nodes of the list at `key`; all that is wrong with its cells is noted."""

    def __init__(self, source: Source, key: str) -> None:
        super().__init__(source.text)
        self.source, self.key, self.kind = source, key, LISTS[key]
        self.columns: list[Column | None] = []
        self.lines: dict[str, int] = {}  # of the rows so far, by their labels

    def nodes(self, reading: Reading) -> list[Node]:
        """Every row below the first; none where the first is at fault, which ends the reading."""
        rows, nodes = self.rows, list[Node]()
        if len(rows) < 2:
            what = "no rows below its names of columns" if rows else "nothing"
            hint = f"first a row of {self.kind.example}, then the figures"
            self.fault(Cell("", rows[0][0].line if rows else 1, 1), f"the table has {what}", hint)
            is_ended = True
        else:
            self.columns = [self._column(cell) for cell in rows[0]]
            texts = {k for k, column in enumerate(self.columns) if column and column.is_text}
            self.read_signs(
                cell for row in rows[1:] for k, cell in enumerate(row) if k not in texts
            )
            before = len(self.faults)
            self._check_head(rows[0])
            nameless = zip(rows[0], self.columns, strict=True)
            is_ended = len(self.faults) > before or any(
                column is None and cell.text for cell, column in nameless
            )
        if not is_ended:
            nodes = [node for row in rows[1:] if (node := self._row(row)) is not None]
        if nodes and self.key == BY_LOAD:
            # Rows of the same load, or speed, are one table.
            tables: dict[str, tuple[Node, list[Node]]] = {}
            key = next(column.key for column in self.columns if column and column.key in LOADS)
            for row in nodes:
                if (load := row.parts.pop(key, None)) is None:
                    position = Cell("", row.line, row.column)
                    self.fault(position, f"the row has no `{key}`", "every order stands at one")
                else:
                    table = tables.setdefault(str(load.value), (load, []))
                    table[1].append(self._harmonic(row))
            nodes = [
                load.as_mapping({key: load, "rows": load.as_list(harmonics)})
                for load, harmonics in tables.values()
            ]
        reading.faults += [replace(fault, file=self.source.name) for fault in self.faults]
        # A measured row has a meaning only beside all others: a fault in one ends the reading.
        is_measured = self.key in (HARMONICS, BY_LOAD, TORSIOGRAM)
        reading.is_ended |= is_ended or (is_measured and bool(self.faults))
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
            key: column
            for (owner, key), column in columns_of(self.key).items()
            if kind in ("", owner)
        }
        # A column may be named by another word for its key.
        aliases = {alias.casefold(): key for alias, key in aliases_of(columns).items()}
        name = aliases.get(name, name)
        if name in columns:
            return replace(columns[name], kind=kind, unit=unit)
        near = nearest(name, columns)
        hint = f"there is {', '.join(columns)}" if columns else f"there is no kind `{kind}`"
        hint = key_for(name, list(columns)) or (f"did you mean `{near}`?" if near else hint)
        self.fault(cell, f"unknown column `{printable(written)}`", hint)
        return None

    def _check_head(self, head: list[Cell]) -> None:
        """Note every fault of the names and units of the columns: twice, missing, of another quantity, without unit."""
        names, needed = set[tuple[str, str]](), self.kind.needed
        for number, (cell, column) in enumerate(zip(head, self.columns, strict=True)):
            if column is None:
                continue
            if (column.kind, column.key) in names:
                message = f"the column `{column.key}` stands twice"
                self.fault(cell, message, "a list is one cell: [0.9, 0.6]")
            names.add((column.kind, column.key))
            # A column of every kind may have the unit of the key of any.
            expected = {
                unit
                for (_, key), of_kind in columns_of(self.key).items()
                if key == column.key
                for unit in of_kind.units
            }
            if column.unit:
                faults = [unit_fault(column.unit, unit) for unit in sorted(expected)]
                if faults and (fault := faults[0]) is not None and None not in faults:
                    message = f"the unit of the column `{column.key}`: {fault.message}"
                    self.fault(cell, message, fault.hint)
            elif expected - {"1"} and any(
                number < len(row) and is_number(self.plain(row[number].text))
                for row in self.rows[1:]
            ):
                unit = units.example(min(expected - {"1"})).partition(" ")[2]
                hint = f"write `{column.key} [{unit}]`"
                self.fault(cell, f"the column `{column.key}` has no unit", hint)
        keys = {key for kind, key in names if not kind}
        if self.key in (HARMONICS, BY_LOAD):
            loads = ([key for key in LOADS if key in keys] or ["imep"])[: self.key == BY_LOAD]
            needed = *loads, *(BY_PARTS if {"a", "b"} & keys else BY_POLAR)
        for key in needed:
            if key not in keys:
                hint = f"{', '.join(KINDS)}: what each row is" if key == KIND else self.kind.example
                self.fault(head[0], f"the column `{key}` is missing", hint)

    def _row(self, row: list[Cell]) -> Node | None:
        """One entry; None where the cells cannot be assigned to the columns."""
        begin, count = next(cell for cell in row if cell.text), len(self.columns)
        if len(row) != count:
            separator = self.separator
            is_open = (cell.text[:1] in ("[", "{") and cell.text[-1] not in "]}" for cell in row)
            hint = (
                f'put a list that holds the separator in quotes: "[0.9{separator} 0.6]"'
                if any(is_open)
                else "with decimal commas the cells are parted by semicolons"
                if separator == "," and len(row) > count
                else "leave cells empty, not out"
            )
            words = f"{len(row)} cell{'s' * (len(row) != 1)}"
            self.fault(begin, f"this row has {words}, the first row {count}", hint)
            return None
        cells = list(zip(row, self.columns, strict=True))
        empty = [(cell, column.key) for cell, column in cells if column and not cell.text]
        for cell, key in empty if self.key.startswith(CATALOGUE) else ():
            hint = "every row of a catalogue states every column"
            self.fault(cell, f"`{key}` is empty", hint)
        filled = [(cell, column) for cell, column in cells if cell.text]
        nameless = next((cell for cell, column in filled if column is None), None)
        if nameless is not None:
            message = f"{shown(nameless.text)} is in a column without a name"
            self.fault(nameless, message, "name it in the first row")
        kind = next((cell for cell, column in filled if column and column == _KIND_COLUMN), None)
        if self.key == TRAIN and kind is None:
            self.fault(begin, "the row has no `kind`", f"one of {', '.join(KINDS)}")
            return None

        # The kind by its own word or by another.
        word = "" if kind is None else kind.text.casefold()
        word = KINDS_BY_ALIAS.get(word.replace(" ", "_"), word)
        body = self._node({}, begin)
        for cell, column in filled:
            if column is not None and cell is not kind:
                self._state(body, cell, column, word)
        if label_key := self.kind.label:
            label = str(body.value.get(label_key, ""))
            if not label or label in self.lines:
                message = f"{label_key} {shown(label)} is in line {self.lines.get(label)} already"
                message = message if label else f"the row has no {label_key}"
                self.fault(begin, message, f"one row a {label_key}")
                return None
            self.lines[label] = begin.line
        if self.key in PAIRS:
            pair = [body.parts.get(key, self._node(None, begin)) for key in SPEED_AND_TORQUE]
            return self._node([], begin).as_list(pair)
        if self.key == HARMONICS:
            return self._harmonic(body)
        if kind is None:
            return body
        body.key_place = kind.line, kind.column
        return self._node({}, begin).as_mapping({word: body})

    def _node(self, value: Any, cell: Cell) -> Node:
        """A value with all that is in it, at the place of its cell."""
        parts = {step: self._node(item, cell) for step, item in entries_of(value)}
        return Node(value, cell.line, cell.column, parts, source=self.source)

    def _state(self, body: Node, cell: Cell, column: Column, kind: str) -> None:
        """Enter under its key what a cell says: text, a number with the unit of its column, or what brackets hold."""
        if column.kind and column.kind != kind:
            message = f"this column is of `{column.kind}`, and the row is a `{printable(kind)}`"
            self.fault(cell, message, "leave it empty")
            return
        if column.key in body.parts:
            message = f"`{column.key}` is given twice in this row"
            self.fault(cell, message, "leave one of the two cells empty")
            return
        if FORMULA_ERROR.fullmatch(cell.text):
            message = f"`{cell.text}` is an error of the spreadsheet, no figure"
            self.fault(cell, message, "mend the formula, save again")
        value: Any = cell.text
        text = cell.text if column.is_text else self.plain(cell.text)
        if not column.is_text and text[0] not in "[{":
            has_unit = column.unit and is_number(text)
            value = f"{text} {column.unit}" if has_unit else resolved(text)
        elif not column.is_text and not self.refuse_joined(cell):
            if text[-1] not in "]}":
                hint = 'put the whole cell in quotes: "[0.9, 0.6]"'
                self.fault(cell, f"{shown(cell.text)} has no closing bracket", hint)
            else:
                try:
                    value = parse_source(text, self.source.name).data
                except InputError as error:
                    hint = error.faults[0].hint or "for example [0.9, 0.6]"
                    message = f"this list or mapping cannot be read: {error.faults[0].message}"
                    self.fault(cell, message, hint)
                if isinstance(value, list) and column.unit:
                    value = [
                        f"{item} {column.unit}" if is_number(str(item)) else item for item in value
                    ]
        body.parts[column.key] = self._node(value, cell)

    def _harmonic(self, body: Node) -> Node:
        """A row from its cells: [order, amplitude, phase], or a mapping where the table has `a` and `b`."""
        has_parts = any(column and column.key in ("a", "b") for column in self.columns)
        keys = BY_PARTS if has_parts else BY_POLAR
        if lacking := [key for key in keys if key not in body.parts]:
            cell = Cell("", body.line, body.column)
            self.fault(cell, f"the row has no `{lacking[0]}`", f"it has {', '.join(keys)}")
        parts = [body.parts[key] for key in keys if key in body.parts]
        return body if has_parts else body.as_list(parts)
