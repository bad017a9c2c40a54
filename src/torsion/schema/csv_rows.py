"""The rows of one table as nodes of the list that they stand for, with all that is wrong with its cells."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from torsion import units
from torsion.components import KINDS
from torsion.errors import Fault, InputError, nearest, printable
from torsion.fields import shown
from torsion.schema.aliases import KINDS_BY_ALIAS, canonical_column
from torsion.schema.csv_columns import (
    BY_LOAD,
    BY_PARTS,
    BY_POLAR,
    CATALOGUE,
    FIGURES,
    HARMONICS,
    LABEL,
    LIBRARY,
    LOADS,
    PAIRS,
    SPEED_AND_TORQUE,
    TORSIOGRAM,
    TORSIOGRAM_NEEDS,
    columns_of,
)
from torsion.schema.csv_harmonics import by_load, harmonic, list_node
from torsion.schema.csv_numbers import Numbers, in_unit, is_number, numbers_of, unit_fault
from torsion.schema.csv_text import FORMULA_ERROR, Cell, rows_of
from torsion.schema.fault_text import Node, Source
from torsion.schema.other_words import key_for
from torsion.schema.shaft_sections import SECTIONS
from torsion.schema.yaml_source import parse_source, resolved

_HEAD = re.compile(r"(.*?)\s*[\[(](.+)[\])]")  # inertia [kg*m**2]
_FIRST = "kind"  # the column of a train that says the kind of every row
ROW = "size"  # the column of a library that says which row


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
    texts: (
        Mapping[str, str] | None
    )  # of tables that were read before; None: they are read from their files
    tables: dict[str, Source]
    faults: list[Fault]
    is_ended: bool = False  # a table whose rows cannot be read was met
    opened: tuple[
        str, ...
    ] = ()  # tables whose rows are being read, each named by a row of the one before it
    inner_rows: int = 0  # of all tables that a row of a table names
    rows: dict[tuple[str, str], list[Node]] = field(
        default_factory=dict
    )  # of every table, by its name and key


def _kind_of(cell: Cell | None) -> str:
    """Return the kind that the cell of a row names, by its own word or by another; empty without a cell."""
    word = "" if cell is None else cell.text.casefold()
    return KINDS_BY_ALIAS.get(word.replace(" ", "_"), word)


class Rows:
    """The rows of one table as nodes of the list at `key`; all that is wrong with its cells is noted."""

    def __init__(self, source: Source, key: str) -> None:
        self.source, self.key = source, key
        self.faults: list[Fault] = []
        self.separator, self.rows = rows_of(source, self.faults)
        self.columns: list[Column | None] = []
        self.numbers = Numbers()
        self.sizes: dict[str, int] = {}  # of a library or catalogue: the lines of the rows so far

    def nodes(self, reading: Reading) -> list[Node]:
        """Every row below the first; none where the first is at fault, which ends the reading."""
        if len(self.rows) < 2:
            what = "no rows below its names of columns" if self.rows else "nothing"
            place = Cell("", self.rows[0][0].line, 1) if self.rows else Cell("", 1, 1)
            self.fault(
                place,
                f"the table has {what}",
                f"first a row of {self._example()}, then the figures",
            )
            ended = True
        else:
            self.columns = [self._column(cell) for cell in self.rows[0]]
            self.numbers = self._read_signs()
            ended = self._head_is_faulty()
        found = (
            [] if ended else [node for row in self.rows[1:] if (node := self._row(row)) is not None]
        )
        if found and self.key == BY_LOAD:
            found = by_load(found, self._columns_named, self.fault)
        reading.faults += [replace(fault, file=self.source.name) for fault in self.faults]
        reading.is_ended |= ended or (
            self.key in FIGURES and self.key not in PAIRS and bool(self.faults)
        )
        return found

    def fault(self, cell: Cell, message: str, hint: str = "") -> None:
        self.faults.append(
            Fault((), printable(message, 200), hint, line=cell.line, column=cell.column)
        )

    def _example(self) -> str:
        if self.key == "train":
            return "`kind`, `name`, `inertia [kg*m**2]`, ..."
        if self.key.startswith("harmonics"):
            return (
                "`imep [bar]`, " * ("load" in self.key)
                + "`order`, `amplitude [bar]`, `phase [deg]`"
            )
        if self.key == SECTIONS:
            return "`length [mm]`, `diameter [mm]`, ..."
        if self.key == TORSIOGRAM:
            return "`speed [rpm]`, `amplitude [deg]`, ..."
        if self.key == LIBRARY:
            return "`size`, `stiffness [N*m/rad]`, `psi`, ..."
        if self.key.startswith(CATALOGUE):
            return "`name`, the keys of a component with their units, and `mass [kg]`, `cost`"
        return (
            "`speed [rpm]`, `torque [N*m]`"
            if self.key in PAIRS
            else "`order`, `torque [N*m]`, `phase [deg]`, ..."
        )

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
        known = {
            key: found for (kind, key), found in columns_of(self.key).items() if of in ("", kind)
        }
        name = canonical_column(name, known)
        if name not in known:
            near = nearest(name, known)
            every = f"there is {', '.join(known)}" if known else f"there is no kind `{of}`"
            self.fault(
                cell,
                f"unknown column `{printable(written)}`",
                key_for(name, list(known)) or (f"did you mean `{near}`?" if near else every),
            )
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
                self.fault(
                    cell,
                    f"the column `{column.key}` stands twice",
                    "a list is one cell: [0.9, 0.6]",
                )
            first.setdefault((column.of, column.key), cell)
            self._unit_is_sound(place, cell, column)
        for key in self._needed(first):
            if ("", key) not in first:
                hint = f"{', '.join(KINDS)}: what each row is" if key == _FIRST else self._example()
                self.fault(head[0], f"the column `{key}` is missing", hint)
        return len(self.faults) > before or any(
            column is None and cell.text for cell, column in zip(head, self.columns, strict=True)
        )

    @property
    def _columns_named(self) -> list[str]:
        return [column.key for column in self.columns if column is not None]

    def _needed(self, there: Mapping[tuple[str, str], Cell]) -> tuple[str, ...]:
        """The columns that the table must have, with what it has."""
        by_list = {"train": (_FIRST,), LIBRARY: (ROW,), TORSIOGRAM: TORSIOGRAM_NEEDS}
        by_list |= dict.fromkeys(PAIRS, tuple(SPEED_AND_TORQUE))
        if self.key not in FIGURES or self.key in by_list:
            return by_list.get(self.key, (LABEL,) if self.key.startswith(CATALOGUE) else ())
        loads = ([key for key in LOADS if ("", key) in there] or ["imep"])[: "load" in self.key]
        return (*loads, *(BY_PARTS if {("", "a"), ("", "b")} & there.keys() else BY_POLAR))

    def _unit_is_sound(self, place: int, cell: Cell, column: Column) -> None:
        """Note a unit that no such quantity has, and one that is missing where numbers stand below."""
        known = columns_of(self.key)
        expected = {
            unit for (_, key), found in known.items() if key == column.key for unit in found.units
        }
        if column.unit:
            faults = [
                fault
                for unit in sorted(expected)
                if (fault := unit_fault(column.unit, unit)) is not None
            ]
            if faults and len(faults) == len(expected):
                self.fault(
                    cell,
                    f"the unit of the column `{column.key}`: {faults[0].message}",
                    faults[0].hint,
                )
            return
        if expected - {"1"} and any(
            place < len(row) and is_number(self.numbers.plain(row[place].text))
            for row in self.rows[1:]
        ):
            unit = units.example(min(expected - {"1"})).partition(" ")[2]
            self.fault(
                cell, f"the column `{column.key}` has no unit", f"write `{column.key} [{unit}]`"
            )

    def _read_signs(self) -> Numbers:
        """How the numbers of the table are written; note what is wrong with their decimal signs."""
        texts = {
            place
            for place, column in enumerate(self.columns)
            if column is not None and column.is_text
        }
        cells = [
            cell for row in self.rows[1:] for place, cell in enumerate(row) if place not in texts
        ]
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
            hint = (
                "with decimal commas the cells are parted by semicolons"
                if comma
                else "leave cells empty, not out"
            )
            if any(cell.text[:1] in ("[", "{") and cell.text[-1] not in "]}" for cell in row):
                hint = f'put a list that holds the separator in quotes: "[0.9{self.separator} 0.6]"'
            self.fault(begin, f"this row has {count}", hint)
            return None
        filled = [
            (cell, column)
            for cell, column in zip(row, self.columns, strict=False)
            if self._is_filled(cell, column)
        ]
        nameless = next((cell for cell, column in filled if column is None), None)
        if nameless is not None:
            self.fault(
                nameless,
                f"{shown(nameless.text)} is in a column without a name",
                "name it in the first row",
            )
        kind = next(
            (cell for cell, column in filled if column and (column.of, column.key) == ("", _FIRST)),
            None,
        )
        if self.key == "train" and kind is None:
            self.fault(begin, "the row has no `kind`", f"one of {', '.join(KINDS)}")
            return None
        body = self._node({}, begin)
        for cell, column in filled:
            if column is not None and cell is not kind:
                self._state(body, cell, column, _kind_of(kind))
        own = ROW if self.key == LIBRARY else LABEL if self.key.startswith(CATALOGUE) else ""
        if own and not self._is_new(body, begin, own):
            return None
        if self.key in PAIRS:
            pair = [body.parts.get(key, self._node(None, begin)) for key in SPEED_AND_TORQUE]
            return list_node(self._node([], begin), pair)
        if self.key == HARMONICS:
            return harmonic(body, self._columns_named, self.fault)
        if kind is None:
            return body
        word = _kind_of(kind)
        entry = self._node({word: body.value}, begin)
        entry.parts[word], entry.keys[word] = body, (kind.line, kind.column)
        return entry

    def _is_filled(self, cell: Cell, column: Column | None) -> bool:
        """Whether a cell says something, as every one of a catalogue has to."""
        if self.key.startswith(CATALOGUE) and column is not None and not cell.text:
            self.fault(
                cell, f"`{column.key}` is empty", "every row of a catalogue states every column"
            )
        return bool(cell.text)

    def _is_new(self, body: Node, begin: Cell, key: str) -> bool:
        """Whether a row says by its own key which one it is, and no row before it is that one."""
        own = str(body.value.get(key, ""))
        if not own or own in self.sizes:
            message = (
                f"{key} {shown(own)} is in line {self.sizes[own]} already"
                if own
                else f"the row has no {key}"
            )
            self.fault(begin, message, f"one row a {key}")
            return False
        self.sizes[own] = begin.line
        return True

    def _node(self, value: Any, cell: Cell) -> Node:
        """A value with all that is in it, at the place of its cell."""
        inside = dict(
            value
            if isinstance(value, dict)
            else enumerate(value)
            if isinstance(value, list)
            else ()
        )
        parts: dict[str | int, Node] = {step: self._node(one, cell) for step, one in inside.items()}
        keys = dict.fromkeys(map(str, parts), (cell.line, cell.column))
        return Node(value, cell.line, cell.column, parts, keys, source=self.source)

    def _state(self, body: Node, cell: Cell, column: Column, kind: str) -> None:
        """Enter a cell under its key."""
        if column.of and column.of != kind:
            self.fault(
                cell,
                f"this column is of `{column.of}`, and the row is a `{printable(kind)}`",
                "leave it empty",
            )
            return
        if column.key in body.parts:
            self.fault(
                cell,
                f"`{column.key}` is given twice in this row",
                "leave one of the two cells empty",
            )
            return
        if FORMULA_ERROR.fullmatch(cell.text):
            self.fault(
                cell,
                f"`{cell.text}` is an error of the spreadsheet, no figure",
                "mend the formula, save again",
            )
        body.parts[column.key] = part = self._node(self._value(cell, column), cell)
        body.keys[column.key] = (cell.line, cell.column)
        body.value[column.key] = part.value

    def _value(self, cell: Cell, column: Column) -> Any:
        """What the cell says: text, a number with the unit of its column, or a list or mapping in brackets."""
        if column.is_text:
            return cell.text
        text = self.numbers.plain(cell.text)
        if text[0] not in "[{":
            return in_unit(resolved(text), text, column.unit)
        if slip := self.numbers.slip(cell):
            self.fault(*slip)
            return cell.text
        if text[-1] not in "]}":
            self.fault(
                cell,
                f"{shown(cell.text)} has no closing bracket",
                'put the whole cell in quotes: "[0.9, 0.6]"',
            )
            return cell.text
        try:
            value = parse_source(text, self.source.name).data
        except InputError as error:
            hint = error.faults[0].hint or "for example [0.9, 0.6]"
            self.fault(
                cell, f"this list or mapping cannot be read: {error.faults[0].message}", hint
            )
            return cell.text
        listed = isinstance(value, list)
        return [in_unit(one, str(one), column.unit) for one in value] if listed else value
