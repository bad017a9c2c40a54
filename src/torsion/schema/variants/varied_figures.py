"""Figures of a file that vary: those that it names or gives a tolerance, their laws, and what the file says at a value."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from torsion import units
from torsion.arrays import FloatArray
from torsion.errors import Fault, Path, Refusal
from torsion.model.parts import Part
from torsion.schema.table_rows import CATALOGUE, LABEL, STATED, Reading, Rows
from torsion.schema.variants.overlay import Overlay, in_words, multiplied, stiffness_paths
from torsion.study import Study
from torsion.user_files import Node, Source
from torsion.what_if.variants.laws import Choice, Law, factors

ENDS = np.array([1e-4, 1.0 - 1e-4])  # of a law without ends, where the file is read as a trial


@dataclass(frozen=True)
class Row:
    """One alternative of a list or a catalogue."""

    label: str
    puts: tuple[tuple[Path, Node], ...]
    amounts: Mapping[str, float]  # what else it states, such as mass and cost


@dataclass(frozen=True)
class Figure:
    """One figure that varies.

    A value of it is, of a law, the factor of what the file gives; of a range, a number in its unit; of a list or a
    catalogue, the number of the row, from 0.
    """

    name: str  # as the file names it
    law: Choice
    paths: tuple[
        tuple[Path, int], ...
    ]  # of its values, and the power of the factor that each takes
    column: int  # of the samples; figures that vary together share one
    nominal: float  # its value in the file as it stands; NaN where the file's is none of the alternatives
    rows: tuple[Row, ...] = ()
    key: str = ""  # of the settings that names it; empty where its tolerance does
    layer: int = 0  # figures of a higher one are about what those of a lower one put in the file

    @property
    def stage(self) -> tuple[int, bool]:
        """When it is put in the file: in a layer rows of lists before all else, as laws are about what those state."""
        return self.layer, not self.rows

    def at(self, unit: FloatArray) -> FloatArray:
        """The values at samples (count,) evenly distributed within 0 and 1."""
        if isinstance(self.law, Law) and self.law.is_relative:
            return factors(self.law, unit)
        if not self.places:
            low, high = self.law.ends
            return np.asarray(low + unit * (high - low))
        return self.all_values()[np.minimum((unit * self.places).astype(np.intp), self.places - 1)]

    @property
    def all_paths(self) -> tuple[Path, ...]:
        """Every place of the file that a value of it may change."""
        return tuple(
            path for path, _ in (*self.paths, *(put for row in self.rows for put in row.puts))
        )

    @property
    def places(self) -> int:
        """How many values it takes; 0 where any within its range, or by its law."""
        return len(self.rows) or (0 if self.law.first is None else self.law.places or 0)

    def all_values(self) -> FloatArray:
        """Return all values of a list, a catalogue or a range in steps."""
        if self.rows:
            return np.arange(float(len(self.rows)))
        (low, high), step = self.law.ends, self.law.step
        if step is not None:
            high = low + float(units.amount(str(step))[0]) * (self.places - 1)
        return np.linspace(low, high, self.places)

    @property
    def ends(self) -> FloatArray:
        """Its lowest and its highest value."""
        is_endless = isinstance(self.law, Law) and self.law.lognormal is not None
        return self.at(ENDS if is_endless else np.array([0.0, 1.0]))

    @property
    def numbers(self) -> tuple[FloatArray, str]:
        """Its values as numbers, and their unit; NaN where they are no numbers of one unit."""
        if not self.rows:
            return self.all_values(), self.law.unit
        stated = [
            amount_of(row.puts[0][1].value) if len(row.puts) == 1 else None for row in self.rows
        ]
        amounts = [amount for amount in stated if amount is not None]
        units_of = {unit for _, unit in amounts}
        if len(amounts) < len(stated) or len(units_of) != 1:
            return np.full(len(self.rows), np.nan), ""
        return np.array([amount for amount, _ in amounts]), units_of.pop()

    @property
    def in_file(self) -> float:
        """What the file gives, in the unit of its numbers; NaN where that is not known."""
        if not self.rows:
            return self.nominal
        return float(self.numbers[0][int(self.nominal)]) if self.nominal == self.nominal else np.nan

    def words(self, value: float) -> str:
        """A value of it as the file would state it."""
        if self.rows:
            return self.rows[int(value)].label
        return (
            f"{value:.6g} {self.law.unit}".strip()
            if self.law.first is not None
            else f"times {value:.6g}"
        )

    def puts(self, value: float, source: Source) -> Iterator[tuple[Path, Node]]:
        """What stands in the file with a value of it."""
        if self.rows:
            yield from self.rows[int(value)].puts
            return
        exact = Fraction(repr(float(value)))
        for path, power in self.paths:
            given = source.at(path) or Node(None, 1, 1)
            if self.law.first is not None:
                new: object = (
                    f"{repr(value).removesuffix('.0')} {self.law.unit}" if self.law.unit else value
                )
                if new == value and value.is_integer():  # of teeth, say
                    new = int(value)
            else:
                new = multiplied(given.value, exact if power > 0 else 1 / exact)
            yield path, Node(new, given.line, given.column)


def amount_of(value: object) -> tuple[float, str] | None:
    """A number of the file and its unit; None of anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        amount, unit = units.amount(value) if isinstance(value, str) else (value, "")
    except Refusal:
        return None
    return float(amount), unit


EXACT = "ratio", "order", "blade_order"  # keys of exact ratios and orders


def named(vary: Mapping[str, Choice], overlay: Overlay, section: Path) -> Iterator[Figure]:
    """The figures that the file names; `*` stands for every component that has the key and no line of its own."""
    taken: dict[Path, str] = {}
    for words, law in sorted(vary.items(), key=lambda item: item[0].startswith("*.")):
        fault = (*section, words)
        part = next(
            (part for part in overlay.study.train.parts if part.name == words.strip("\"'")), None
        )
        if law.catalogue is not None and part is not None:
            before = len(overlay.faults)
            rows = tuple(alternatives(law.catalogue, part, overlay.source, overlay.faults))
            matching = (
                k
                for k, row in enumerate(rows)
                if all(
                    path[-1] == "source"
                    or node.value == getattr(overlay.source.at(path), "value", None)
                    for path, node in row.puts
                )
            )
            if len(overlay.faults) == before:
                yield Figure(part.name, law, (), 0, float(next(matching, np.nan)), rows, words)
            continue
        with overlay.noting(fault):
            if words.startswith("*."):
                pairs = list(_of_all(words, law, overlay))
            else:
                pairs = [(words.replace('"', ""), overlay.path(words))]
            for name, path in pairs:
                given = overlay.source.at(path)
                if given is None:
                    hint = "give its value in the file; a path varies only a value of the file"
                    raise Refusal(f"the file does not give `{words}`", hint)
                if path not in taken:
                    taken[path] = words
                    yield replace(_figure(name, law, path, given), key=words)
                elif not words.startswith("*."):
                    raise Refusal(f"`{words}` varies as `{taken[path]}` already", "vary it once")


def _of_all(words: str, law: Choice, overlay: Overlay) -> Iterator[tuple[str, Path]]:
    """The figures of a key of any component; of a list each item, and none that is 0, which no factor varies."""
    key, has = words.removeprefix("*."), False
    for part in overlay.study.train.parts:
        given = overlay.source.at((*part.path, key))
        if given is None:
            continue
        has = True
        is_list = isinstance(given.value, list) and not any(
            isinstance(alternative, list) for alternative in law.values or ()
        )
        for step, node in given.parts.items() if is_list else [(None, given)]:
            amount = amount_of(node.value)
            if not law.is_relative or amount is None or amount[0] != 0.0:
                name, path = f"{part.name}.{key}", (*part.path, key)
                if isinstance(step, int):
                    name, path = f"{name}.{step + 1}", (*path, step)
                yield name, path
    if not has:
        raise Refusal(f"no component has a key `{key}`", "a key of the file")


def _figure(name: str, law: Choice, path: Path, given: Node) -> Figure:
    """The figure whose value stands there; raises Refusal where its law does not take such a value."""
    if law.values is not None:
        values = [list(value) if isinstance(value, tuple) else value for value in law.values]
        nodes = [Node(value, given.line, given.column) for value in values]
        rows = tuple(Row(in_words(node.value), ((path, node),), {}) for node in nodes)
        row = values.index(given.value) if given.value in values else np.nan
        return Figure(name, law, ((path, 1),), 0, float(row), rows)
    if law.catalogue is not None:
        hint = f"`{name.rpartition('.')[0]}`"
        raise Refusal("a catalogue is of a component, and of no key of it", hint)
    if path[-1] in EXACT:
        message = f"`{name}` is exact, and varies only by `values`"
        raise Refusal(message, "for example {values: [41/17, 43/17]}")
    if (made := multiplied(given.value, Fraction(3, 2))) is None or (
        made == given.value and law.first is None
    ):
        message = f"`{name}` is {in_words(given.value)}, which no factor varies"
        hint = "a number that is not 0, or `values`"
        if isinstance(given.value, list):
            hint = f"one of its items by number, as `{name}.1`"
        raise Refusal(message, hint)
    # What the file gives in the unit of a range; NaN where that is not known.
    nominal = 1.0 if law.first is None else np.nan
    with suppress(Refusal):
        if law.first is not None and isinstance(given.value, str):
            exact = None if law.unit else units.amount(given.value)[0]
            nominal = units.to_si(given.value, law.unit) if exact is None else float(exact)
        elif law.first is not None and not law.unit:
            nominal = float(given.value)
    return Figure(name, law, ((path, 1),), 0, nominal)


def with_tolerance(study: Study, overlay: Overlay) -> Iterator[Figure]:
    """The stiffness, or the inertia with its water, of every component with a tolerance."""
    for part in study.train.parts:
        if part.inertia_tolerance:
            made = (*part.path, "inertia"), (*part.path, "entrained")
            pairs = [(path, overlay.source.at(path)) for path in made]
            given = [
                (path, 1) for path, node in pairs if node is not None and "%" not in str(node.value)
            ]
            # Of any width, as of the stiffness.
            law = Law.model_construct(uniform=part.inertia_tolerance)
            yield Figure(f"{part.name}.inertia", law, tuple(given), 0, 1.0)
        if not part.stiffness_tolerance:
            continue
        law = Law.model_construct(uniform=part.stiffness_tolerance)
        if paths := [
            (path, -1 if path[-1] == "flexibility" else 1)
            for path in stiffness_paths(overlay, part)
        ]:
            key = "flexibility" if paths[0][1] < 0 else "stiffness"
            yield Figure(f"{part.name}.{key}", law, tuple(paths), 0, 1.0)


def alternatives(name: str, part: Part, source: Source, faults: list[Fault]) -> Iterator[Row]:
    """Every row of a catalogue of a component, with mass and cost; the reader of the source has opened the table."""
    reading = Reading(source, None, dict(source.tables), [])
    for row in Rows(reading.tables[name], CATALOGUE + part.kind).nodes(reading):
        label, stated = str(row.value[LABEL]), {}
        for key in STATED.keys() & row.parts.keys():
            cell = row.parts[key]
            try:
                # A mass in kg, or a cost in whatever it is counted.
                if STATED[key]:
                    stated[key] = units.to_si(str(cell.value), STATED[key][0])
                else:
                    stated[key] = float(units.amount(str(cell.value).partition(" ")[0])[0])
                if stated[key] < 0.0:
                    raise Refusal(f"a {key} of {cell.value} is below 0", "0 or more")
            except Refusal as fault:
                note = Fault((), fault.message, fault.hint, line=cell.line, column=cell.column)
                reading.faults.append(replace(note, file=reading.tables[name].name))
        changes = {key: node for key, node in row.parts.items() if key not in (LABEL, *STATED)}
        origin = changes.get("source")
        words = f"{name}, {label}" + ("" if origin is None else f": {origin.value}")
        changes["source"] = replace(origin or row.parts[LABEL], plain=words)
        yield Row(label, tuple(((*part.path, key), node) for key, node in changes.items()), stated)
    faults += reading.faults
